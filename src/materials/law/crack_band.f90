!> Width of the crack band of an element, and its limits (theory.md, 11.5).
module crack_band
  use kinds, only: rk
  use tensor6, only: principal_values
  implicit none
  private
  public :: band_width, extreme_widths

contains

  !> Width of the band of a crack with the normal n: |J^T n|, theory.md, (11.11). For a cube this is
  !> its side in every direction, for a brick its length across the crack.
  pure real(rk) function band_width(edges, normal)
    real(rk), intent(in) :: edges(3, 3) !< columns: the edges of the element at the point [m]
    real(rk), intent(in) :: normal(3) !< unit vector
    band_width = norm2(matmul(normal, edges))
  end function band_width

  !> Smallest and largest width over all directions of the crack: the extreme singular values of the
  !> edges.
  pure subroutine extreme_widths(edges, smallest, largest)
    real(rk), intent(in) :: edges(3, 3) !< as in `band_width` [m]
    real(rk), intent(out) :: smallest, largest !< [m]
    real(rk) :: square(3, 3), values(3)
    square = matmul(edges, transpose(edges))
    values = principal_values([square(1, 1), square(2, 2), square(3, 3), &
                               square(1, 2), square(1, 3), square(2, 3)])
    smallest = sqrt(max(0.0_rk, values(3)))
    largest = sqrt(max(0.0_rk, values(1)))
  end subroutine extreme_widths
end module crack_band
