!> C3D8I: the hexahedron with incompatible modes, which bends without locking.
!>
!> The modes 1 - xi_i**2 are differentiated with the Jacobian of the centre, scaled by the ratio of
!> determinants, so that their mean strain is zero and the patch test passes. Condensation with the
!> elastic stiffness leaves an operator B of the 24 displacements. The strains of a mode at the
!> points differ by a factor alone: sums over points are taken of the factors.
!> Source: Taylor, Beresford, Wilson, Int. J. Num. Meth. Engng 10 (1976) 1211.
module element_hex8_incompatible
  use kinds, only: rk
  use element_formulation, only: solid_element
  use element_hex8, only: hex8_gradients
  use gauss_rules, only: hex_point
  use hex8_slopes, only: slopes_at_points, strains_of_slopes
  use shape_hex8, only: derivative_at, hex8_dofs, point_shape, strain_rows
  use small_matrix, only: invert3
  implicit none
  private
  public :: incompatible_hexahedron

  type, extends(solid_element) :: incompatible_hexahedron
  contains
    procedure :: strain_operator
    procedure :: find_strains
    procedure :: thermal_strain
  end type incompatible_hexahedron

  integer, parameter :: num_modes = 9 !< three along each natural coordinate, one a direction

  !> The modes of one element: those along coordinate i are number 3 i - 2 to 3 i.
  type :: mode_set
    real(rk) :: strain(6, num_modes) !< where the slope is 1 [1/m]
    real(rk) :: slope(3, 8) !< (coordinates, points)
    real(rk) :: weighted(3, 8) !< slope times the volume of the point [m3]
    real(rk) :: stress(num_modes, 6) !< where the slope is 1 [Pa/m]
    real(rk) :: factor(num_modes, num_modes) !< Cholesky's lower factor of K_ii
  end type mode_set

contains

  !> B + B_i A with the amplitudes A = -K_ii**-1 K_iu of the modes.
  subroutine strain_operator(self, x, d, b, weight, status)
    class(incompatible_hexahedron), intent(in) :: self
    real(rk), contiguous, intent(in) :: x(:, :, :)
    real(rk), intent(in) :: d(6, 6)
    real(rk), contiguous, intent(out) :: b(:, :, :, :)
    real(rk), contiguous, intent(out) :: weight(:, :)
    integer, intent(out) :: status(:)
    real(rk) :: gradient(3, 8, 8), moment(6, hex8_dofs, 3)
    type(mode_set) :: modes
    integer :: e, i, q
    do e = 1, size(x, 3)
      call hex8_gradients(x(:, :, e), gradient, weight(:, e), status(e))
      if (status(e) /= 0) cycle
      call find_modes(x(:, :, e), d, weight(:, e), modes)
      moment = 0.0_rk
      do q = 1, self%num_points
        call strain_rows(gradient(:, :, q), b(:, :, q, e))
        do i = 1, 3
          moment(:, :, i) = moment(:, :, i) + modes%weighted(i, q)*b(:, :, q, e)
        end do
      end do
      call follow(modes, hex8_dofs, moment)
      do q = 1, self%num_points
        do i = 1, 3
          b(:, :, q, e) = b(:, :, q, e) + modes%slope(i, q)*moment(:, :, i)
        end do
      end do
    end do
  end subroutine strain_operator

  !> The strains of the displacements and those of the modes that follow them.
  subroutine find_strains(self, x, d, moved, strain)
    class(incompatible_hexahedron), intent(in) :: self
    real(rk), intent(in) :: x(3, 8)
    real(rk), intent(in) :: d(6, 6)
    real(rk), contiguous, intent(in) :: moved(:, :)
    real(rk), contiguous, intent(out) :: strain(:, :, :)
    real(rk) :: slope(8, 3, 8), weight(8)
    type(mode_set) :: modes
    integer :: k, status
    call slopes_at_points(x, slope, weight, status)
    call find_modes(x, d, weight, modes)
    do k = 1, size(moved, 2)
      call strains_of_slopes(slope, moved(:, k), strain(:, :, k))
      call relax(modes, strain(:, :, k))
    end do
  end subroutine find_strains

  !> The expansion at each point, and that less the strains of the modes that follow it: a free
  !> element whose temperature is linear has no stress.
  subroutine thermal_strain(self, x, d, nodal, expansion, strain)
    class(incompatible_hexahedron), intent(in) :: self
    real(rk), contiguous, intent(in) :: x(:, :, :)
    real(rk), intent(in) :: d(6, 6)
    real(rk), contiguous, intent(in) :: nodal(:, :)
    real(rk), contiguous, intent(out) :: expansion(:, :)
    real(rk), contiguous, intent(out) :: strain(:, :, :)
    real(rk) :: gradient(3, 8, 8), weight(8)
    type(mode_set) :: modes
    integer :: e, status
    do e = 1, size(x, 3)
      expansion(:, e) = nodal(1, e) + matmul(nodal(:, e) - nodal(1, e), point_shape)
      strain(1:3, :, e) = spread(expansion(:, e), 1, 3)
      strain(4:6, :, e) = 0.0_rk
      if (all(abs(nodal(2:, e) - nodal(1, e)) <= 0.0_rk)) cycle
      call hex8_gradients(x(:, :, e), gradient, weight, status)
      if (status /= 0) cycle
      call find_modes(x(:, :, e), d, weight, modes)
      call relax(modes, strain(:, :, e))
    end do
  end subroutine thermal_strain

  !> Adds the strains of the modes that follow given strains.
  pure subroutine relax(modes, strain)
    type(mode_set), intent(in) :: modes
    real(rk), intent(inout) :: strain(6, 8)
    real(rk) :: moment(6, 1, 3)
    moment(:, 1, :) = matmul(strain, transpose(modes%weighted))
    call follow(modes, 1, moment)
    strain = strain + matmul(moment(:, 1, :), modes%slope)
  end subroutine relax

  !> Replaces the moments of strains along each coordinate by the strains with slope 1 of the modes
  !> that follow.
  pure subroutine follow(modes, n, moment)
    type(mode_set), intent(in) :: modes
    integer, intent(in) :: n !< strains at once
    real(rk), intent(inout) :: moment(6, n, 3)
    real(rk) :: amplitude(num_modes)
    integer :: c, i, k, m
    do c = 1, n
      amplitude = 0.0_rk
      do i = 1, 3
        m = 3*i - 2
        do k = 1, 6
          amplitude(m:m + 2) = amplitude(m:m + 2) - modes%stress(m:m + 2, k)*moment(k, c, i)
        end do
      end do
      call solve_factored(modes%factor, amplitude)
      do i = 1, 3
        m = 3*i - 2
        moment(:, c, i) = modes%strain(:, m)*amplitude(m) &
                          + modes%strain(:, m + 1)*amplitude(m + 1) &
                          + modes%strain(:, m + 2)*amplitude(m + 2)
      end do
    end do
  end subroutine follow

  !> The modes of an element and the factor of their stiffness.
  pure subroutine find_modes(x, d, weight, modes)
    real(rk), intent(in) :: x(3, 8) !< [m]
    real(rk), intent(in) :: d(6, 6) !< [Pa]
    real(rk), intent(in) :: weight(8) !< determinants at the points [m3]
    type(mode_set), intent(out) :: modes
    real(rk) :: inverse(3, 3), centre_determinant, coupling
    integer :: i, j, m, n
    call invert3(transpose(matmul(x, derivative_at([0.0_rk, 0.0_rk, 0.0_rk]))), inverse, &
                 centre_determinant)
    call strain_rows(inverse, modes%strain)
    modes%weighted = -2.0_rk*centre_determinant*hex_point
    modes%slope = modes%weighted/spread(weight, 1, 3)
    modes%stress = matmul(transpose(modes%strain), d)
    do j = 1, 3
      n = 3*j - 2
      do i = j, 3
        m = 3*i - 2
        coupling = sum(modes%weighted(i, :)*modes%slope(j, :))
        modes%factor(m:m + 2, n:n + 2) = coupling*matmul(modes%stress(m:m + 2, :), &
                                                         modes%strain(:, n:n + 2))
      end do
    end do
    call factor_positive(modes%factor)
  end subroutine find_modes

  !> Replaces the lower half of a positive definite matrix by Cholesky's factor.
  pure subroutine factor_positive(k)
    real(rk), intent(inout) :: k(num_modes, num_modes)
    integer :: i, j
    do j = 1, num_modes
      k(j, j) = sqrt(k(j, j) - sum(k(j, :j - 1)**2))
      do i = j + 1, num_modes
        k(i, j) = (k(i, j) - sum(k(i, :j - 1)*k(j, :j - 1)))/k(j, j)
      end do
    end do
  end subroutine factor_positive

  !> Solves in place with Cholesky's factor.
  pure subroutine solve_factored(factor, b)
    real(rk), intent(in) :: factor(num_modes, num_modes)
    real(rk), intent(inout) :: b(num_modes)
    integer :: i
    do i = 1, num_modes
      b(i) = b(i)/factor(i, i)
      b(i + 1:) = b(i + 1:) - factor(i + 1:, i)*b(i)
    end do
    do i = num_modes, 1, -1
      b(i) = (b(i) - sum(factor(i + 1:, i)*b(i + 1:)))/factor(i, i)
    end do
  end subroutine solve_factored
end module element_hex8_incompatible
