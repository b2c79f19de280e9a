!> C3D8R: the hexahedron with one point, the mean gradient, and hourglass control by stiffness.
!>
!> Source: Flanagan & Belytschko, Int. J. Num. Meth. Engng 17 (1981) 679. The size of the hourglass
!> stiffness, 0.0005 E V b:b on base vectors of entries 1 and -1, is CalculiX's, so that both
!> programs give the same results. This stiffness is soft: C3D8R needs several elements through
!> the thickness in bending.
module element_hex8_reduced
  use kinds, only: rk
  use element_formulation, only: solid_element
  use node_dofs, only: num_directions
  use element_hex8, only: hex8_gradients
  use shape_hex8, only: corner, hex8_dofs, mean_gradient, strain_rows
  implicit none
  private
  public :: reduced_hexahedron

  real(rk), parameter :: hourglass_factor = 0.0005_rk

  type, extends(solid_element) :: reduced_hexahedron
  contains
    procedure :: strain_operator
    procedure :: add_stabilisation
  end type reduced_hexahedron

contains

  !> B of the mean gradient; the whole volume at one point.
  subroutine strain_operator(self, x, d, b, weight, status)
    class(reduced_hexahedron), intent(in) :: self
    real(rk), contiguous, intent(in) :: x(:, :, :)
    real(rk), intent(in) :: d(6, 6)
    real(rk), contiguous, intent(out) :: b(:, :, :, :)
    real(rk), contiguous, intent(out) :: weight(:, :)
    integer, intent(out) :: status(:)
    real(rk) :: mean(3, 8)
    integer :: e
    do e = 1, size(x, 3)
      call mean_operator(x(:, :, e), mean, weight(self%num_points, e), status(e))
      call strain_rows(mean, b(:, :, self%num_points, e))
    end do
  end subroutine strain_operator

  !> Mean gradient and volume of one element.
  pure subroutine mean_operator(x, mean, volume, status)
    real(rk), intent(in) :: x(3, 8)
    real(rk), intent(out) :: mean(3, 8), volume
    integer, intent(out) :: status
    real(rk) :: gradient(3, 8, 8), weight(8)
    call hex8_gradients(x, gradient, weight, status)
    mean = 0.0_rk
    volume = 0.0_rk
    if (status == 0) call mean_gradient(gradient, weight, mean, volume)
  end subroutine mean_operator

  !> Adds E V b:b gamma gamma^T on each direction for the four hourglass vectors gamma, which are
  !> orthogonal to all linear fields.
  subroutine add_stabilisation(self, x, d, ke)
    class(reduced_hexahedron), intent(in) :: self
    real(rk), contiguous, intent(in) :: x(:, :, :)
    real(rk), intent(in) :: d(6, 6)
    real(rk), contiguous, intent(inout) :: ke(:, :, :)
    real(rk) :: base(8, 4), young
    integer :: e
    base(:, 1) = corner(2, :)*corner(3, :)
    base(:, 2) = corner(1, :)*corner(3, :)
    base(:, 3) = corner(1, :)*corner(2, :)
    base(:, 4) = corner(1, :)*corner(2, :)*corner(3, :)
    young = d(4, 4)*(3.0_rk*d(1, 2) + 2.0_rk*d(4, 4))/(d(1, 2) + d(4, 4))
    do e = 1, size(x, 3)
      call add_hourglass(x(:, :, e), base, hourglass_factor*self%num_points*young, ke(:, :, e))
    end do
  end subroutine add_stabilisation

  !> The same for one element.
  pure subroutine add_hourglass(x, base, modulus, ke)
    real(rk), intent(in) :: x(3, 8), base(8, 4), modulus
    real(rk), intent(inout) :: ke(hex8_dofs, hex8_dofs)
    real(rk) :: mean(3, 8), volume, gamma(8, 4), block(8, 8)
    integer :: status, i
    call mean_operator(x, mean, volume, status)
    if (status /= 0) return
    gamma = base - matmul(transpose(mean), matmul(x, base))
    block = modulus*volume*sum(mean**2)*matmul(gamma, transpose(gamma))
    do i = 1, num_directions
      associate (part => ke(i::num_directions, i::num_directions))
        part = part + block
      end associate
    end do
  end subroutine add_hourglass
end module element_hex8_reduced
