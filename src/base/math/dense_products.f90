!> Products of large dense matrices (BLAS).
module dense_products
  use kinds, only: rk
  implicit none
  private
  public :: times, transposed_times

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
end module dense_products
