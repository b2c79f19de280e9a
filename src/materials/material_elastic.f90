!> Isotropic linear elasticity.
module material_elastic
  use kinds, only: rk
  use material_law, only: stress_law
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
  subroutine update(self, strain, length, old_state, new_state, stress, tangent, status)
    class(elastic_law), intent(in) :: self
    real(rk), intent(in) :: strain(:, :)
    real(rk), intent(in) :: length(:)
    real(rk), intent(in) :: old_state(:, :)
    real(rk), intent(out) :: new_state(:, :)
    real(rk), intent(out) :: stress(:, :)
    real(rk), intent(out) :: tangent(:, :, :)
    integer, intent(out) :: status
    real(rk) :: d(6, 6)
    call self%elastic_stiffness(d)
    new_state = old_state
    stress = matmul(d, strain)
    tangent = spread(d, 3, size(length))
    status = 0
  end subroutine update
end module material_elastic
