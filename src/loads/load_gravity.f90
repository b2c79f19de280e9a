!> *DLOAD, GRAV: the weight of elements that have a density.
module load_gravity
  use applied_load, only: load
  use dam_mesh, only: fe_mesh
  use element_matrices, only: nodal_volumes
  use kinds, only: rk
  implicit none
  private
  public :: gravity_load

  type, extends(load) :: gravity_load
    integer, allocatable :: elements(:) !< positions of solids
    real(rk) :: acceleration(3) = 0.0_rk !< g times the unit direction [m/s2]
  contains
    procedure :: add_force
  end type gravity_load

contains

  !> Consistent body force: rho g times the integral of N_a, exact for trilinear geometry.
  subroutine add_force(self, mesh, density, force)
    class(gravity_load), intent(in) :: self
    type(fe_mesh), intent(in) :: mesh
    real(rk), intent(in) :: density(:)
    real(rk), intent(inout) :: force(:, :)
    real(rk) :: x(3, 8, 1), volume(8, 1)
    integer :: i, e, a, node
    do i = 1, size(self%elements)
      e = self%elements(i)
      if (density(e) <= 0.0_rk) cycle
      x(:, :, 1) = mesh%x(:, mesh%nodes(:, e))
      call nodal_volumes(x, volume)
      do a = 1, 8
        node = mesh%nodes(a, e)
        force(:, node) = force(:, node) + density(e)*volume(a, 1)*self%acceleration
      end do
    end do
  end subroutine add_force
end module load_gravity
