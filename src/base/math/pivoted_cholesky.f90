!> Cholesky's factor with pivots of a symmetric matrix that round-off may make singular (LAPACK).
module pivoted_cholesky
  use kinds, only: rk
  implicit none
  private
  public :: pivoted_factor, factorise_kept, solve_half, solve_rest

  !> U^T U of the rows and columns that are kept.
  type :: pivoted_factor
    integer, allocatable :: kept(:) !< rows, in the order of the pivots
    real(rk), allocatable :: upper(:, :) !< (kept, kept) U; only the upper triangle is read
  end type pivoted_factor

  interface
    subroutine dpstrf(uplo, n, a, lda, piv, rank, tol, work, info)
      import :: rk
      implicit none
      character, intent(in) :: uplo
      integer, intent(in) :: n, lda
      real(rk), intent(inout) :: a(lda, n)
      integer, intent(out) :: piv(n), rank, info
      real(rk), intent(in) :: tol
      real(rk), intent(out) :: work(2*n)
    end subroutine dpstrf

    subroutine dtrsm(side, uplo, transa, diag, m, n, alpha, a, lda, b, ldb)
      import :: rk
      implicit none
      character, intent(in) :: side, uplo, transa, diag
      integer, intent(in) :: m, n, lda, ldb
      real(rk), intent(in) :: alpha, a(lda, m)
      real(rk), intent(inout) :: b(ldb, n)
    end subroutine dtrsm
  end interface

contains

  !> Factors a positive semidefinite matrix. Rows are kept as long as what the rows before leave of
  !> their diagonal is more than their noise.
  subroutine factorise_kept(matrix, noise, factor)
    real(rk), intent(in) :: matrix(:, :) !< (rows, rows)
    real(rk), intent(in) :: noise(:) !< (rows) of the diagonal; not positive: the row is left out
    type(pivoted_factor), intent(out) :: factor
    real(rk), allocatable :: scaled(:, :)
    real(rk) :: scale(size(noise)), work(2*size(noise))
    integer :: pivot(size(noise)), n, j, num_kept, info
    n = size(noise)
    scale = 0.0_rk
    where (noise > 0.0_rk) scale = 1.0_rk/sqrt(noise)
    allocate (scaled(n, n))
    do j = 1, n
      scaled(:, j) = scale*matrix(:, j)*scale(j)
    end do
    num_kept = 0
    if (n > 0) call dpstrf('U', n, scaled, n, pivot, num_kept, 1.0_rk, work, info)
    ! With no pivot above the tolerance LAPACK counts none or leaves the first one.
    if (num_kept == 1) then
      if (.not. scaled(1, 1) > 1.0_rk) num_kept = 0
    end if
    factor%kept = pivot(:num_kept)
    factor%upper = scaled(:num_kept, :num_kept)
    do j = 1, num_kept
      factor%upper(:, j) = factor%upper(:, j)/scale(pivot(j))
    end do
  end subroutine factorise_kept

  !> Replaces the columns of b by U^-T b.
  subroutine solve_half(factor, b)
    type(pivoted_factor), intent(in) :: factor
    real(rk), intent(inout), contiguous :: b(:, :) !< (kept, columns)
    call solve_triangle(factor%upper, 'T', b)
  end subroutine solve_half

  !> Replaces the columns of b by U^-1 b.
  subroutine solve_rest(factor, b)
    type(pivoted_factor), intent(in) :: factor
    real(rk), intent(inout), contiguous :: b(:, :) !< (kept, columns)
    call solve_triangle(factor%upper, 'N', b)
  end subroutine solve_rest

  subroutine solve_triangle(upper, transposition, b)
    real(rk), intent(in), contiguous :: upper(:, :)
    character, intent(in) :: transposition
    real(rk), intent(inout), contiguous :: b(:, :)
    integer :: n
    n = size(upper, 1)
    if (size(b) > 0) call dtrsm('L', 'U', transposition, 'N', n, size(b, 2), 1.0_rk, upper, n, b, n)
  end subroutine solve_triangle
end module pivoted_cholesky
