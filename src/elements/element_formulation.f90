!> The contract of solid elements: each gives its strain-displacement operator at its points.
!>
!> Stiffness, forces and strains are generic: K = sum w B^T D B (+ hourglass control),
!> f = sum w B^T sigma, eps = B u. One call handles a block of elements.
module element_formulation
  use kinds, only: rk
  implicit none
  private
  public :: solid_element

  type, abstract :: solid_element
    character(8) :: name = '' !< as in the deck: 'C3D8', ...
    integer :: num_points = 8 !< integration points
  contains
    procedure(strain_operator), deferred :: strain_operator
    procedure :: add_stabilisation
  end type solid_element

  abstract interface
    !> B and the volume of each point, for a block of elements.
    subroutine strain_operator(self, x, d, b, weight, status)
      import :: solid_element, rk
      implicit none
      class(solid_element), intent(in) :: self
      real(rk), contiguous, intent(in) :: x(:, :, :) !< (3, 8, elements) node coordinates [m]
      real(rk), intent(in) :: d(6, 6) !< elastic stiffness (incompatible modes need it) [Pa]
      real(rk), contiguous, intent(out) :: b(:, :, :, :) !< (6, 24, points, elements) [1/m]
      real(rk), contiguous, intent(out) :: weight(:, :) !< (points, elements) volumes [m3]
      integer, intent(out) :: status(:) !< (elements) 0, or the worst corner when a Jacobian is <= 0
    end subroutine strain_operator
  end interface

contains

  !> Adds the stiffness of hourglass control, if the element needs it.
  subroutine add_stabilisation(self, x, d, ke)
    class(solid_element), intent(in) :: self
    real(rk), contiguous, intent(in) :: x(:, :, :) !< (3, 8, elements) [m]
    real(rk), intent(in) :: d(6, 6) !< elastic stiffness [Pa]
    real(rk), contiguous, intent(inout) :: ke(:, :, :) !< (24, 24, elements) [N/m]
  end subroutine add_stabilisation
end module element_formulation
