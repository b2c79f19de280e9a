!> What every material can do: stress from strain, for a block of points in one call.
module material_law
  use kinds, only: rk
  implicit none
  private
  public :: stress_law, material

  !> Stress from strain. Voigt order 11 22 33 12 13 23, engineering shear, tension positive.
  type, abstract :: stress_law
    integer :: num_state = 0 !< state variables per point
  contains
    procedure(elastic_stiffness), deferred :: elastic_stiffness
    procedure(update), deferred :: update
  end type stress_law

  abstract interface
    !> The undamaged stiffness, constant in the material.
    pure subroutine elastic_stiffness(self, d)
      import :: stress_law, rk
      implicit none
      class(stress_law), intent(in) :: self
      real(rk), intent(out) :: d(6, 6) !< [Pa]
    end subroutine elastic_stiffness

    !> Stress and state at the end of the increment, for a block of points.
    subroutine update(self, strain, length, old_state, new_state, stress, tangent, status)
      import :: stress_law, rk
      implicit none
      class(stress_law), intent(in) :: self
      real(rk), intent(in) :: strain(:, :) !< (6, points), end of the increment
      real(rk), intent(in) :: length(:) !< characteristic length of each point [m]
      real(rk), intent(in) :: old_state(:, :) !< (num_state, points), converged
      real(rk), intent(out) :: new_state(:, :) !< (num_state, points)
      real(rk), intent(out) :: stress(:, :) !< (6, points) [Pa]
      real(rk), intent(out) :: tangent(:, :, :) !< (6, 6, points) [Pa]
      integer, intent(out) :: status !< 0, or the first point that could not be integrated
    end subroutine update
  end interface

  !> A material of the deck.
  type :: material
    character(:), allocatable :: name !< upper case
    real(rk) :: density = 0.0_rk !< [kg/m3]; 0: massless
    real(rk) :: young = 0.0_rk !< E of the undamaged material [Pa], for defaults of joints
    real(rk) :: poisson = 0.0_rk
    real(rk) :: alpha = 0.0_rk, beta = 0.0_rk !< Rayleigh damping [1/s], [s]
    class(stress_law), allocatable :: law
  end type material
end module material_law
