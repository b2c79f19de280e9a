!> The contract of solid elements: each gives its strain-displacement operator at its points.
!>
!> Stiffness, forces and strains are generic: K = sum w B^T D B (+ hourglass control),
!> f = sum w B^T sigma, eps = B u. One call handles a block of elements. Strains of a few
!> displacements are had without B where that is cheaper.
module element_formulation
  use kinds, only: rk
  use shape_hex8, only: gradient_at, hex8_dofs, point_derivative, point_shape
  implicit none
  private
  public :: solid_element, strains_of_element

  type, abstract :: solid_element
    character(8) :: name = '' !< as in the deck: 'C3D8', ...
    integer :: num_points = 8 !< integration points
    !> The strain is the symmetric gradient at each of the 2 x 2 x 2 points, and there is no
    !> hourglass control: hex8_slopes has faster ways to strains and stiffness
    logical :: has_plain_strain = .false.
    !> The stresses of neighbours hardly differ at their corners, whatever the error: jumps of
    !> stresses do not measure it
    logical :: has_small_jumps = .false.
  contains
    procedure(strain_operator), deferred :: strain_operator
    procedure :: find_strains => apply_operator
    procedure :: add_stabilisation
    procedure :: thermal_strain => mean_expansion
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

  !> Strains of one element under some displacements. Default: B u.
  subroutine apply_operator(self, x, d, moved, strain)
    class(solid_element), intent(in) :: self
    real(rk), intent(in) :: x(3, 8) !< [m]
    real(rk), intent(in) :: d(6, 6) !< elastic stiffness (incompatible modes need it) [Pa]
    real(rk), contiguous, intent(in) :: moved(:, :) !< (24, fields) [m]
    real(rk), contiguous, intent(out) :: strain(:, :, :) !< (6, points, fields)
    real(rk) :: b(6, hex8_dofs, self%num_points, 1), weight(self%num_points, 1)
    integer :: status(1), k
    call self%strain_operator(reshape(x, [3, 8, 1]), d, b, weight, status)
    do k = 1, size(moved, 2)
      call strains_of_element(b(:, :, :, 1), moved(:, k), strain(:, :, k))
    end do
  end subroutine apply_operator

  !> eps = B u at the points of one element.
  pure subroutine strains_of_element(b, u, strain)
    real(rk), contiguous, intent(in) :: b(:, :, :) !< (6, 24, points) [1/m]
    real(rk), intent(in) :: u(hex8_dofs) !< [m]
    real(rk), contiguous, intent(out) :: strain(:, :) !< (6, points)
    integer :: q, i
    strain = 0.0_rk
    do q = 1, size(b, 3)
      do i = 1, hex8_dofs
        strain(:, q) = strain(:, q) + b(:, i, q)*u(i)
      end do
    end do
  end subroutine strains_of_element

  !> Adds the stiffness of hourglass control, if the element needs it.
  subroutine add_stabilisation(self, x, d, ke)
    class(solid_element), intent(in) :: self
    real(rk), contiguous, intent(in) :: x(:, :, :) !< (3, 8, elements) [m]
    real(rk), intent(in) :: d(6, 6) !< elastic stiffness [Pa]
    real(rk), contiguous, intent(inout) :: ke(:, :, :) !< (24, 24, elements) [N/m]
  end subroutine add_stabilisation

  !> Thermal strains at the points from the expansions of the nodes. Default: the mean over the
  !> element, as in Abaqus and CalculiX; strains that vary in the element cannot follow B u.
  subroutine mean_expansion(self, x, d, nodal, expansion, strain)
    class(solid_element), intent(in) :: self
    real(rk), contiguous, intent(in) :: x(:, :, :) !< (3, 8, elements) [m]
    real(rk), intent(in) :: d(6, 6) !< elastic stiffness [Pa]
    real(rk), contiguous, intent(in) :: nodal(:, :) !< (8, elements) expansion in all directions
    real(rk), contiguous, intent(out) :: expansion(:, :) !< (points, elements)
    real(rk), contiguous, intent(out) :: strain(:, :, :) !< (6, points, elements) taken from B u
    real(rk) :: gradient(3, 8), volume(8)
    integer :: e, q
    strain = 0.0_rk
    do e = 1, size(x, 3)
      do q = 1, 8
        call gradient_at(x(:, :, e), point_derivative(:, q, :), gradient, volume(q))
      end do
      ! Sums of differences: equal expansions of all nodes have exactly this mean.
      expansion(:, e) = nodal(1, e) + dot_product(matmul(nodal(:, e) - nodal(1, e), point_shape), &
                                                  volume)/sum(volume)
      do q = 1, self%num_points
        strain(1:3, q, e) = expansion(q, e)
      end do
    end do
  end subroutine mean_expansion
end module element_formulation
