!> Factors of small dense matrices (LAPACK).
module dense_factor
  use kinds, only: rk
  implicit none
  private
  public :: lu_factor, factorise_dense, solve_dense

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
  end interface

contains

  !> Factors a square matrix, which is moved into the factor.
  subroutine factorise_dense(matrix, factor)
    real(rk), allocatable, intent(inout) :: matrix(:, :) !< gone afterwards
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
  subroutine solve_dense(factor, b)
    type(lu_factor), intent(in) :: factor
    real(rk), intent(inout), contiguous :: b(:, :) !< (rows, right-hand sides)
    integer :: n, info
    n = size(factor%values, 1)
    if (n == 0) return
    call dgetrs('N', n, size(b, 2), factor%values, n, factor%pivot, b, n, info)
  end subroutine solve_dense
end module dense_factor
