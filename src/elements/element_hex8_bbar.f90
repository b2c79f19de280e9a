!> C3D8B: the hexahedron whose volume strain is the mean over the element (B-bar), which keeps
!> nearly incompressible materials from locking. Abaqus calls this element C3D8.
!>
!> Source: Hughes, Int. J. Num. Meth. Engng 15 (1980) 1413, with the mean over the volume.
module element_hex8_bbar
  use kinds, only: rk
  use element_formulation, only: solid_element
  use element_hex8, only: hex8_gradients
  use shape_hex8, only: hex8_dofs, mean_gradient, strain_rows
  implicit none
  private
  public :: bbar_hexahedron

  type, extends(solid_element) :: bbar_hexahedron
  contains
    procedure :: strain_operator
  end type bbar_hexahedron

contains

  !> B with its volumetric part replaced by the mean one.
  subroutine strain_operator(self, x, d, b, weight, status)
    class(bbar_hexahedron), intent(in) :: self
    real(rk), contiguous, intent(in) :: x(:, :, :)
    real(rk), intent(in) :: d(6, 6)
    real(rk), contiguous, intent(out) :: b(:, :, :, :)
    real(rk), contiguous, intent(out) :: weight(:, :)
    integer, intent(out) :: status(:)
    real(rk) :: gradient(3, 8, 8), mean(3, 8), volume, difference(hex8_dofs)
    integer :: e, q, i
    do e = 1, size(x, 3)
      call hex8_gradients(x(:, :, e), gradient, weight(:, e), status(e))
      if (status(e) /= 0) cycle
      call mean_gradient(gradient, weight(:, e), mean, volume)
      do q = 1, self%num_points
        call strain_rows(gradient(:, :, q), b(:, :, q, e))
        difference = reshape(mean - gradient(:, :, q), [hex8_dofs])/3.0_rk
        do i = 1, 3
          b(i, :, q, e) = b(i, :, q, e) + difference
        end do
      end do
    end do
  end subroutine strain_operator
end module element_hex8_bbar
