!> C3D8: the hexahedron with full 2 x 2 x 2 integration, as in the paper and in CalculiX.
module element_hex8
  use kinds, only: rk
  use element_formulation, only: solid_element
  use hex8_slopes, only: slopes_at_points
  use shape_hex8, only: strain_rows
  implicit none
  private
  public :: full_hexahedron, hex8_gradients

  type, extends(solid_element) :: full_hexahedron
  contains
    procedure :: strain_operator
  end type full_hexahedron

contains

  !> B = sym(grad N) at each point.
  subroutine strain_operator(self, x, d, b, weight, status)
    class(full_hexahedron), intent(in) :: self
    real(rk), contiguous, intent(in) :: x(:, :, :)
    real(rk), intent(in) :: d(6, 6)
    real(rk), contiguous, intent(out) :: b(:, :, :, :)
    real(rk), contiguous, intent(out) :: weight(:, :)
    integer, intent(out) :: status(:)
    real(rk) :: gradient(3, 8, 8)
    integer :: e, q
    do e = 1, size(x, 3)
      call hex8_gradients(x(:, :, e), gradient, weight(:, e), status(e))
      do q = 1, self%num_points
        call strain_rows(gradient(:, :, q), b(:, :, q, e))
      end do
    end do
  end subroutine strain_operator

  !> Gradients and volumes at the 2 x 2 x 2 points of one element.
  pure subroutine hex8_gradients(x, gradient, weight, status)
    real(rk), intent(in) :: x(3, 8) !< corners [m]
    real(rk), intent(out) :: gradient(3, 8, 8) !< (direction, node, point) [1/m]
    real(rk), intent(out) :: weight(8) !< [m3]
    integer, intent(out) :: status !< 0, or the worst corner when a point's Jacobian is <= 0
    real(rk) :: slope(8, 3, 8)
    integer :: q
    call slopes_at_points(x, slope, weight, status)
    do q = 1, 8
      gradient(:, :, q) = slope(q, :, :)
    end do
  end subroutine hex8_gradients
end module element_hex8
