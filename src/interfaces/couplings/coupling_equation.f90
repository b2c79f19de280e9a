!> The equations of the deck as relations between displacements, which the numbering eliminates like
!> those of ties (different_meshes.md, 13.10).
module coupling_equation
  use eliminated_rows, only: row_guest
  use write_text, only: as_text
  implicit none
  private
  public :: equation_set

  type, extends(row_guest) :: equation_set
  contains
    procedure :: describe
  end type equation_set

contains

  !> The equations in the summary of the model.
  function describe(self) result(text)
    class(equation_set), intent(in) :: self
    character(:), allocatable :: text
    text = as_text(size(self%rows%node))//' displacements follow others'
  end function describe
end module coupling_equation
