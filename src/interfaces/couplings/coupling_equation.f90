!> The equations of the deck as relations between displacements, which the numbering eliminates like
!> those of ties (different_meshes.md, 13.10).
module coupling_equation
  use dam_mesh, only: node_tie
  use guest_type, only: guest
  use row_tables, only: row_table
  use write_text, only: as_text
  implicit none
  private
  public :: equation_set

  type, extends(guest) :: equation_set
    type(node_tie) :: rows
  contains
    procedure :: add_bonds
    procedure :: add_ties
    procedure :: describe
  end type equation_set

contains

  !> The nodes of each equation.
  subroutine add_bonds(self, groups)
    class(equation_set), intent(in) :: self
    type(row_table), intent(inout) :: groups
    integer :: k
    associate (rows => self%rows)
      do k = 1, size(rows%node)
        call groups%append([rows%node(k), rows%item(rows%first(k):rows%first(k + 1) - 1)])
      end do
    end associate
  end subroutine add_bonds

  subroutine add_ties(self, ties)
    class(equation_set), intent(in) :: self
    type(node_tie), allocatable, intent(inout) :: ties(:)
    ties = [ties, self%rows]
  end subroutine add_ties

  function describe(self) result(text)
    class(equation_set), intent(in) :: self
    character(:), allocatable :: text
    text = as_text(size(self%rows%node))//' displacements follow others'
  end function describe
end module coupling_equation
