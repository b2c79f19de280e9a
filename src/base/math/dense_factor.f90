!> Factors of small dense matrices (LAPACK).
module dense_factor
  use kinds, only: rk
  implicit none
  private
  public :: lu_factor, factorise_dense, solve_factored, solve_lower, solve_lower_transposed
  public :: invert_from_lower

  integer, parameter :: tile = 64 !< rows that are copied together

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

    subroutine dtrsv(uplo, trans, diag, n, a, lda, x, incx)
      import :: rk
      implicit none
      character, intent(in) :: uplo, trans, diag
      integer, intent(in) :: n, lda, incx
      real(rk), intent(in) :: a(lda, n)
      real(rk), intent(inout) :: x(n)
    end subroutine dtrsv

    subroutine dpotri(uplo, n, a, lda, info)
      import :: rk
      implicit none
      character, intent(in) :: uplo
      integer, intent(in) :: n, lda
      real(rk), intent(inout) :: a(lda, n)
      integer, intent(out) :: info
    end subroutine dpotri
  end interface

contains

  !> Replaces L by the inverse of L L^T, both triangles.
  subroutine invert_from_lower(a)
    real(rk), intent(inout), contiguous :: a(:, :) !< only the lower triangle of L is read
    integer :: n, first, last, j, info
    n = size(a, 1)
    if (n == 0) return
    call dpotri('L', n, a, n, info)
    do first = 1, n, tile
      last = min(first + tile - 1, n)
      do j = first, n ! rows of the lower triangle stay in the cache
        a(first:min(last, j - 1), j) = a(j, first:min(last, j - 1))
      end do
    end do
  end subroutine invert_from_lower

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
    real(rk), intent(inout), contiguous :: b(:)
    if (size(b) > 0) call dtrsv('L', 'N', 'N', size(b), lower, size(b), b, 1)
  end subroutine solve_lower

  !> Replaces `b` by L^-T b.
  subroutine solve_lower_transposed(lower, b)
    real(rk), intent(in), contiguous :: lower(:, :) !< only its lower triangle is read
    real(rk), intent(inout), contiguous :: b(:)
    if (size(b) > 0) call dtrsv('L', 'T', 'N', size(b), lower, size(b), b, 1)
  end subroutine solve_lower_transposed
end module dense_factor
