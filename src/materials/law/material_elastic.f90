!> Isotropic linear elasticity.
module material_elastic
  use kinds, only: rk
  use material_law, only: stress_law
  use material_points, only: point_set, point_state, time_increment, update_report, no_tangent, &
                             stored_energy
  implicit none
  private
  public :: elastic_law

  type, extends(stress_law) :: elastic_law
    real(rk) :: young = 0.0_rk !< E [Pa]
    real(rk) :: poisson = 0.0_rk !< -1 < nu < 0.5
  contains
    procedure :: elastic_stiffness
    procedure :: update
  end type elastic_law

contains

  !> Hooke's law, order 11 22 33 12 13 23 with engineering shear.
  pure subroutine elastic_stiffness(self, d)
    class(elastic_law), intent(in) :: self
    real(rk), intent(out) :: d(6, 6)
    real(rk) :: lambda, shear
    integer :: i
    shear = self%young/(2.0_rk*(1.0_rk + self%poisson))
    lambda = 2.0_rk*shear*self%poisson/(1.0_rk - 2.0_rk*self%poisson)
    d = 0.0_rk
    d(1:3, 1:3) = lambda
    do i = 1, 3
      d(i, i) = lambda + 2.0_rk*shear
      d(i + 3, i + 3) = shear
    end do
  end subroutine elastic_stiffness

  !> Stress = D strain at each point; there is no history.
  subroutine update(self, points, time, old, new, tangent, report)
    class(elastic_law), intent(in) :: self
    type(point_set), intent(in) :: points
    type(time_increment), intent(in) :: time
    type(point_state), intent(in) :: old
    type(point_state), intent(inout) :: new
    real(rk), intent(inout) :: tangent(:, :, :)
    type(update_report), intent(out) :: report
    real(rk) :: d(6, 6)
    call self%elastic_stiffness(d)
    new%internal = old%internal
    new%is_elastic = .true.
    new%stress = matmul(d, new%strain)
    new%energy(stored_energy, :) = 0.5_rk*sum(new%stress*new%strain, 1)
    if (time%tangent /= no_tangent) tangent = spread(d, 3, points%num_points)
    report%failed_point = 0
  end subroutine update
end module material_elastic
