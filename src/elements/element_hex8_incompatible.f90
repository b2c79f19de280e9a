!> C3D8I: the hexahedron with incompatible modes, which bends without locking.
!>
!> The modes 1 - xi_i**2 are differentiated with the Jacobian of the centre, scaled by the ratio of
!> determinants, so that their mean strain is zero and the patch test passes. Condensation with the
!> elastic stiffness leaves an operator B of the 24 displacements.
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

contains

  !> B + B_i A with the amplitudes A = -K_ii**-1 K_iu of the modes.
  subroutine strain_operator(self, x, d, b, weight, status)
    class(incompatible_hexahedron), intent(in) :: self
    real(rk), contiguous, intent(in) :: x(:, :, :)
    real(rk), intent(in) :: d(6, 6)
    real(rk), contiguous, intent(out) :: b(:, :, :, :)
    real(rk), contiguous, intent(out) :: weight(:, :)
    integer, intent(out) :: status(:)
    real(rk) :: gradient(3, 8, 8), mode(6, 9, 8), amplitude(9, hex8_dofs)
    integer :: e, q
    do e = 1, size(x, 3)
      call hex8_gradients(x(:, :, e), gradient, weight(:, e), status(e))
      if (status(e) /= 0) cycle
      do q = 1, self%num_points
        call strain_rows(gradient(:, :, q), b(:, :, q, e))
      end do
      call mode_strains(x(:, :, e), weight(:, e), mode)
      call mode_amplitudes(mode, b(:, :, :, e), d, weight(:, e), amplitude)
      do q = 1, self%num_points
        b(:, :, q, e) = b(:, :, q, e) + matmul(mode(:, :, q), amplitude)
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
    real(rk) :: slope(8, 3, 8), weight(8), mode(6, 9, 8)
    integer :: k, status
    call slopes_at_points(x, slope, weight, status)
    call mode_strains(x, weight, mode)
    do k = 1, size(moved, 2)
      call strains_of_slopes(slope, moved(:, k), strain(:, :, k))
    end do
    call relax(mode, d, weight, strain)
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
    real(rk) :: gradient(3, 8, 8), weight(8), mode(6, 9, 8)
    integer :: e, status
    do e = 1, size(x, 3)
      expansion(:, e) = nodal(1, e) + matmul(nodal(:, e) - nodal(1, e), point_shape)
      strain(1:3, :, e) = spread(expansion(:, e), 1, 3)
      strain(4:6, :, e) = 0.0_rk
      if (all(abs(nodal(2:, e) - nodal(1, e)) <= 0.0_rk)) cycle
      call hex8_gradients(x(:, :, e), gradient, weight, status)
      if (status /= 0) cycle
      call mode_strains(x(:, :, e), weight, mode)
      call relax(mode, d, weight, strain(:, :, e:e))
    end do
  end subroutine thermal_strain

  !> Adds the strains of the modes that follow given strains.
  pure subroutine relax(mode, d, weight, strain)
    real(rk), intent(in) :: mode(6, 9, 8), d(6, 6), weight(8)
    real(rk), intent(inout) :: strain(:, :, :) !< (6, 8, fields)
    real(rk) :: k(9, 9), stress(9, 6, 8), amplitude(9, size(strain, 3))
    integer :: i, q
    call condense_modes(mode, d, weight, stress, k)
    amplitude = 0.0_rk
    do i = 1, size(strain, 3)
      do q = 1, 8
        amplitude(:, i) = amplitude(:, i) + matmul(stress(:, :, q), strain(:, q, i))
      end do
    end do
    call solve_positive(size(amplitude, 2), k, amplitude)
    do i = 1, size(strain, 3)
      do q = 1, 8
        strain(:, q, i) = strain(:, q, i) + matmul(mode(:, :, q), amplitude(:, i))
      end do
    end do
  end subroutine relax

  !> Strains of the nine modes at the points.
  pure subroutine mode_strains(x, weight, mode)
    real(rk), intent(in) :: x(3, 8) !< [m]
    real(rk), intent(in) :: weight(8) !< determinants at the points [m3]
    real(rk), intent(out) :: mode(6, 9, 8) !< [1/m]
    real(rk) :: inverse(3, 3), centre_determinant, gradient(3, 3)
    integer :: q, i
    call invert3(transpose(matmul(x, derivative_at([0.0_rk, 0.0_rk, 0.0_rk]))), inverse, &
                 centre_determinant)
    do q = 1, 8
      do i = 1, 3
        gradient(:, i) = -2.0_rk*hex_point(i, q)*(centre_determinant/weight(q))*inverse(:, i)
      end do
      call strain_rows(gradient, mode(:, :, q))
    end do
  end subroutine mode_strains

  !> A = -K_ii**-1 K_iu.
  pure subroutine mode_amplitudes(mode, b, d, weight, amplitude)
    real(rk), intent(in) :: mode(6, 9, 8), b(6, hex8_dofs, 8), d(6, 6), weight(8)
    real(rk), intent(out) :: amplitude(9, hex8_dofs)
    real(rk) :: k(9, 9), stress(9, 6, 8)
    integer :: q
    call condense_modes(mode, d, weight, stress, k)
    amplitude = 0.0_rk
    do q = 1, 8
      amplitude = amplitude + matmul(stress(:, :, q), b(:, :, q))
    end do
    call solve_positive(hex8_dofs, k, amplitude)
  end subroutine mode_amplitudes

  !> K_ii, and the negative stresses of the modes times the volumes of the points.
  pure subroutine condense_modes(mode, d, weight, stress, k)
    real(rk), intent(in) :: mode(6, 9, 8), d(6, 6), weight(8)
    real(rk), intent(out) :: stress(9, 6, 8), k(9, 9)
    integer :: q
    k = 0.0_rk
    do q = 1, 8
      stress(:, :, q) = -weight(q)*matmul(transpose(mode(:, :, q)), d)
      k = k - matmul(stress(:, :, q), mode(:, :, q))
    end do
  end subroutine condense_modes

  !> Solves K X = B in place by Cholesky's factor; K is positive definite and overwritten.
  pure subroutine solve_positive(n, k, b)
    integer, intent(in) :: n !< columns
    real(rk), intent(inout) :: k(9, 9), b(9, n)
    integer :: i, j
    do j = 1, 9
      k(j, j) = sqrt(k(j, j) - sum(k(j, :j - 1)**2))
      do i = j + 1, 9
        k(i, j) = (k(i, j) - sum(k(i, :j - 1)*k(j, :j - 1)))/k(j, j)
      end do
    end do
    do i = 1, 9
      b(i, :) = (b(i, :) - matmul(k(i, :i - 1), b(:i - 1, :)))/k(i, i)
    end do
    do i = 9, 1, -1
      b(i, :) = (b(i, :) - matmul(k(i + 1:, i), b(i + 1:, :)))/k(i, i)
    end do
  end subroutine solve_positive
end module element_hex8_incompatible
