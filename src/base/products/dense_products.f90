!> Products of large dense matrices (BLAS, and our own where it is faster).
module dense_products
  use, intrinsic :: iso_c_binding, only: c_double, c_int
  use, intrinsic :: iso_fortran_env, only: single => real32
  use kinds, only: rk
  implicit none
  private
  public :: times, transposed_times, subtract_times, times_vector, transposed_times_vector, &
            single_times_vector, transposed_single_times_vector, &
            add_times_vector, add_single_times_vector, &
            add_transposed_times, add_transposed_single_times

  ! The arguments are those of the BLAS.
  ! allow(assumed-size)
  interface
    subroutine dgemm(transa, transb, m, n, k, alpha, a, lda, b, ldb, beta, c, ldc)
      import :: rk
      implicit none
      character, intent(in) :: transa, transb
      integer, intent(in) :: m, n, k, lda, ldb, ldc
      real(rk), intent(in) :: alpha, beta
      real(rk), intent(in) :: a(lda, *), b(ldb, *)
      real(rk), intent(inout) :: c(ldc, n)
    end subroutine dgemm

    subroutine dgemv(trans, m, n, alpha, a, lda, x, incx, beta, y, incy)
      import :: rk
      implicit none
      character, intent(in) :: trans
      integer, intent(in) :: m, n, lda, incx, incy
      real(rk), intent(in) :: alpha, beta
      real(rk), intent(in) :: a(lda, *), x(*)
      real(rk), intent(inout) :: y(*)
    end subroutine dgemv

    subroutine sgemv(trans, m, n, alpha, a, lda, x, incx, beta, y, incy)
      import :: single
      implicit none
      character, intent(in) :: trans
      integer, intent(in) :: m, n, lda, incx, incy
      real(single), intent(in) :: alpha, beta
      real(single), intent(in) :: a(lda, *), x(*)
      real(single), intent(inout) :: y(*)
    end subroutine sgemv

    !> y = y + A x in 0.6 to 0.9 of the time of dgemv.
    subroutine keyway_add_double_product(rows, columns, a, x, y) bind(c)
      import :: c_double, c_int
      implicit none
      integer(c_int), value :: rows, columns
      real(c_double), intent(in) :: a(rows, columns)
      real(c_double), intent(in) :: x(columns)
      real(c_double), intent(inout) :: y(rows)
    end subroutine keyway_add_double_product
  end interface

contains

  !> A B.
  function times(a, b) result(product)
    real(rk), intent(in), contiguous :: a(:, :), b(:, :)
    real(rk) :: product(size(a, 1), size(b, 2))
    product = 0.0_rk
    if (size(product) == 0 .or. size(b, 1) == 0) return
    call dgemm('N', 'N', size(a, 1), size(b, 2), size(b, 1), 1.0_rk, a, size(a, 1), b, &
               size(b, 1), 0.0_rk, product, size(a, 1))
  end function times

  !> A^T B.
  function transposed_times(a, b) result(product)
    real(rk), intent(in), contiguous :: a(:, :), b(:, :)
    real(rk) :: product(size(a, 2), size(b, 2))
    product = 0.0_rk
    if (size(product) == 0 .or. size(b, 1) == 0) return
    call dgemm('T', 'N', size(a, 2), size(b, 2), size(b, 1), 1.0_rk, a, size(a, 1), b, &
               size(b, 1), 0.0_rk, product, size(a, 2))
  end function transposed_times

  !> C = C - A B.
  subroutine subtract_times(a, b, c)
    real(rk), intent(in), contiguous :: a(:, :), b(:, :)
    real(rk), intent(inout), contiguous :: c(:, :)
    if (size(c) == 0 .or. size(b, 1) == 0) return
    call dgemm('N', 'N', size(a, 1), size(b, 2), size(b, 1), -1.0_rk, a, size(a, 1), b, &
               size(b, 1), 1.0_rk, c, size(a, 1))
  end subroutine subtract_times

  !> A x.
  function times_vector(a, x) result(product)
    real(rk), intent(in), contiguous :: a(:, :), x(:)
    real(rk) :: product(size(a, 1))
    product = 0.0_rk
    call keyway_add_double_product(size(a, 1), size(a, 2), a, x, product)
  end function times_vector

  !> y = y + A x.
  subroutine add_times_vector(a, x, y)
    real(rk), intent(in), contiguous :: a(:, :), x(:)
    real(rk), intent(inout), contiguous :: y(:)
    call keyway_add_double_product(size(a, 1), size(a, 2), a, x, y)
  end subroutine add_times_vector

  !> y = y + A x in single precision.
  subroutine add_single_times_vector(a, x, y)
    real(single), intent(in), contiguous :: a(:, :), x(:)
    real(single), intent(inout), contiguous :: y(:)
    if (size(a) > 0) call sgemv('N', size(a, 1), size(a, 2), 1.0_single, a, size(a, 1), x, 1, &
                                1.0_single, y, 1)
  end subroutine add_single_times_vector

  !> A^T x.
  function transposed_times_vector(a, x) result(product)
    real(rk), intent(in), contiguous :: a(:, :), x(:)
    real(rk) :: product(size(a, 2))
    product = 0.0_rk
    if (size(a) == 0) return
    call dgemv('T', size(a, 1), size(a, 2), 1.0_rk, a, size(a, 1), x, 1, 0.0_rk, product, 1)
  end function transposed_times_vector

  !> y = y + A^T x, with x on some adjacent rows alone.
  subroutine add_transposed_times(rows, a, first, x, y)
    integer, intent(in) :: rows !< of A
    real(rk), intent(in), contiguous :: x(:)
    real(rk), intent(inout), contiguous :: y(:) !< (columns)
    real(rk), intent(in) :: a(rows, size(y))
    integer, intent(in) :: first !< row of x(1)
    if (size(y) > 0) call dgemv('T', size(x), size(y), 1.0_rk, a(first, 1), rows, x, 1, &
                                1.0_rk, y, 1)
  end subroutine add_transposed_times

  !> y = y + A^T x in single precision, with x on some adjacent rows alone.
  subroutine add_transposed_single_times(rows, a, first, x, y)
    integer, intent(in) :: rows !< of A
    real(single), intent(in), contiguous :: x(:)
    real(single), intent(inout), contiguous :: y(:) !< (columns)
    real(single), intent(in) :: a(rows, size(y))
    integer, intent(in) :: first !< row of x(1)
    if (size(y) > 0) call sgemv('T', size(x), size(y), 1.0_single, a(first, 1), rows, x, 1, &
                                1.0_single, y, 1)
  end subroutine add_transposed_single_times

  !> A x with A and the sums in single precision.
  function single_times_vector(a, x) result(product)
    real(single), intent(in), contiguous :: a(:, :)
    real(rk), intent(in) :: x(:)
    real(rk) :: product(size(a, 1))
    real(single) :: rounded(size(a, 1))
    rounded = 0.0_single
    if (size(a) > 0) call sgemv('N', size(a, 1), size(a, 2), 1.0_single, a, size(a, 1), &
                                real(x, single), 1, 0.0_single, rounded, 1)
    product = real(rounded, rk)
  end function single_times_vector

  !> A^T x with A and the sums in single precision.
  function transposed_single_times_vector(a, x) result(product)
    real(single), intent(in), contiguous :: a(:, :)
    real(rk), intent(in) :: x(:)
    real(rk) :: product(size(a, 2))
    real(single) :: rounded(size(a, 2))
    rounded = 0.0_single
    if (size(a) > 0) call sgemv('T', size(a, 1), size(a, 2), 1.0_single, a, size(a, 1), &
                                real(x, single), 1, 0.0_single, rounded, 1)
    product = real(rounded, rk)
  end function transposed_single_times_vector
end module dense_products
