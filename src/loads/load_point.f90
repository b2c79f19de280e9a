!> *CLOAD: forces on nodes.
module load_point
  use applied_load, only: load
  use dam_mesh, only: fe_mesh
  use kinds, only: rk
  implicit none
  private
  public :: point_load

  type, extends(load) :: point_load
    integer, allocatable :: nodes(:) !< positions
    real(rk), allocatable :: force(:, :) !< (3, nodes) on each [N]
  contains
    procedure :: add_force
  end type point_load

contains

  !> The force on each node; a node named twice is loaded twice.
  subroutine add_force(self, mesh, density, force)
    class(point_load), intent(in) :: self
    type(fe_mesh), intent(in) :: mesh
    real(rk), intent(in) :: density(:)
    real(rk), intent(inout) :: force(:, :)
    integer :: i
    do i = 1, size(self%nodes)
      force(:, self%nodes(i)) = force(:, self%nodes(i)) + self%force(:, i)
    end do
  end subroutine add_force
end module load_point
