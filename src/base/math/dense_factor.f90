!> Factors of small dense matrices (LAPACK).
module dense_factor
  use kinds, only: rk
  implicit none
  private
  public :: lu_factor, factorise_dense, solve_factored, solve_lower, solve_lower_transposed
  public :: gram

  !> P A = L U.
  type :: lu_factor
    real(rk), allocatable :: values(:, :)
    integer, allocatable :: pivot(:)
    logical :: is_singular = .false.
  end type lu_factor

  interface
    subroutine dgetrf(m, n, a, lda, ipiv, info)
      import :: rk
      implicit none
      integer, intent(in) :: m, n, lda
      real(rk), intent(inout) :: a(lda, n)
      integer, intent(out) :: ipiv(n), info
    end subroutine dgetrf

    subroutine dgetrs(trans, n, nrhs, a, lda, ipiv, b, ldb, info)
      import :: rk
      implicit none
      character, intent(in) :: trans
      integer, intent(in) :: n, nrhs, lda, ldb, ipiv(n)
      real(rk), intent(in) :: a(lda, n)
      real(rk), intent(inout) :: b(ldb, nrhs)
      integer, intent(out) :: info
    end subroutine dgetrs

    subroutine dtrsm(side, uplo, trans, diag, m, n, alpha, a, lda, b, ldb)
      import :: rk
      implicit none
      character, intent(in) :: side, uplo, trans, diag
      integer, intent(in) :: m, n, lda, ldb
      real(rk), intent(in) :: alpha, a(lda, m)
      real(rk), intent(inout) :: b(ldb, n)
    end subroutine dtrsm

    subroutine dsyrk(uplo, trans, n, k, alpha, a, lda, beta, c, ldc)
      import :: rk
      implicit none
      character, intent(in) :: uplo, trans
      integer, intent(in) :: n, k, lda, ldc
      real(rk), intent(in) :: alpha, beta, a(lda, n)
      real(rk), intent(inout) :: c(ldc, n)
    end subroutine dsyrk
  end interface

contains

  !> Z^T Z, both triangles.
  subroutine gram(z, product)
    real(rk), intent(in), contiguous :: z(:, :)
    real(rk), intent(out), contiguous :: product(:, :) !< (columns, columns)
    integer :: n, j
    n = size(z, 2)
    if (n == 0) return
    product = 0.0_rk
    call dsyrk('L', 'T', n, size(z, 1), 1.0_rk, z, size(z, 1), 0.0_rk, product, n)
    do j = 2, n
      product(:j - 1, j) = product(j, :j - 1)
    end do
  end subroutine gram

  !> Factors a square matrix; the matrix is moved into the factor.
  subroutine factorise_dense(matrix, factor)
    real(rk), allocatable, intent(inout) :: matrix(:, :) !< not allocated afterwards
    type(lu_factor), intent(out) :: factor
    integer :: n, info
    call move_alloc(matrix, factor%values)
    n = size(factor%values, 1)
    allocate (factor%pivot(n))
    if (n == 0) return
    call dgetrf(n, n, factor%values, n, factor%pivot, info)
    factor%is_singular = info /= 0
  end subroutine factorise_dense

  !> Solves for each column of `b`, in place.
  subroutine solve_factored(factor, b)
    type(lu_factor), intent(in) :: factor
    real(rk), intent(inout), contiguous :: b(:, :) !< (rows, right-hand sides)
    integer :: n, info
    n = size(factor%values, 1)
    if (n == 0) return
    call dgetrs('N', n, size(b, 2), factor%values, n, factor%pivot, b, n, info)
  end subroutine solve_factored

  !> Replaces `b` by L^-1 b.
  subroutine solve_lower(lower, b)
    real(rk), intent(in), contiguous :: lower(:, :) !< only its lower triangle is read
    real(rk), intent(inout), contiguous :: b(:, :) !< (rows, right-hand sides)
    integer :: n
    n = size(lower, 1)
    if (n > 0) call dtrsm('L', 'L', 'N', 'N', n, size(b, 2), 1.0_rk, lower, n, b, n)
  end subroutine solve_lower

  !> Replaces `b` by L^-T b.
  subroutine solve_lower_transposed(lower, b)
    real(rk), intent(in), contiguous :: lower(:, :) !< only its lower triangle is read
    real(rk), intent(inout), contiguous :: b(:, :) !< (rows, right-hand sides)
    integer :: n
    n = size(lower, 1)
    if (n > 0) call dtrsm('L', 'L', 'T', 'N', n, size(b, 2), 1.0_rk, lower, n, b, n)
  end subroutine solve_lower_transposed
end module dense_factor
