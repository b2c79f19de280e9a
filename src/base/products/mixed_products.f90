!> Products of matrices in single precision with vectors in double precision. Sums are in double
!> precision, so that the product is that of the rounded matrix.
module mixed_products
  use, intrinsic :: iso_c_binding, only: c_double, c_float, c_int
  use kinds, only: rk
  implicit none
  private
  public :: rounded, mixed_times, mixed_transposed_times

  interface
    subroutine keyway_add_product(rows, columns, a, x, y) bind(c)
      import :: c_double, c_float, c_int
      implicit none
      integer(c_int), value :: rows, columns
      real(c_float), intent(in) :: a(rows, columns)
      real(c_double), intent(in) :: x(columns)
      real(c_double), intent(inout) :: y(rows)
    end subroutine keyway_add_product

    subroutine keyway_transposed_product(rows, columns, a, x, y) bind(c)
      import :: c_double, c_float, c_int
      implicit none
      integer(c_int), value :: rows, columns
      real(c_float), intent(in) :: a(rows, columns)
      real(c_double), intent(in) :: x(rows)
      real(c_double), intent(out) :: y(columns)
    end subroutine keyway_transposed_product
  end interface

contains

  !> The values that single precision can hold.
  elemental real(rk) function rounded(value)
    real(rk), intent(in) :: value
    rounded = real(real(value, c_float), rk)
  end function rounded

  !> A x.
  function mixed_times(a, x) result(product)
    real(c_float), intent(in), contiguous :: a(:, :)
    real(rk), intent(in), contiguous :: x(:)
    real(rk) :: product(size(a, 1))
    product = 0.0_rk
    call keyway_add_product(size(a, 1), size(a, 2), a, x, product)
  end function mixed_times

  !> A^T x.
  function mixed_transposed_times(a, x) result(product)
    real(c_float), intent(in), contiguous :: a(:, :)
    real(rk), intent(in), contiguous :: x(:)
    real(rk) :: product(size(a, 2))
    call keyway_transposed_product(size(a, 1), size(a, 2), a, x, product)
  end function mixed_transposed_times
end module mixed_products
