!> Factors of small dense matrices in single precision (LAPACK), for preconditioners.
module single_factor
  use, intrinsic :: iso_fortran_env, only: single => real32
  use kinds, only: rk
  implicit none
  private
  public :: single_lu, factorise_single, solve_single

  !> P S A = L U, with S the reciprocals of the largest entries of the rows.
  type :: single_lu
    logical :: is_there = .false.
    real(single), allocatable :: values(:, :)
    real(rk), allocatable :: scale(:) !< (rows) S
    integer, allocatable :: pivot(:)
  end type single_lu

  interface
    subroutine sgetrf(m, n, a, lda, ipiv, info)
      import :: single
      implicit none
      integer, intent(in) :: m, n, lda
      real(single), intent(inout) :: a(lda, n)
      integer, intent(out) :: ipiv(n), info
    end subroutine sgetrf

    subroutine sgetrs(trans, n, nrhs, a, lda, ipiv, b, ldb, info)
      import :: single
      implicit none
      character, intent(in) :: trans
      integer, intent(in) :: n, nrhs, lda, ldb, ipiv(n)
      real(single), intent(in) :: a(lda, n)
      real(single), intent(inout) :: b(ldb, nrhs)
      integer, intent(out) :: info
    end subroutine sgetrs
  end interface

contains

  !> Factors a square matrix; not `is_there` where it is singular in single precision.
  subroutine factorise_single(matrix, factor)
    real(rk), intent(in) :: matrix(:, :)
    type(single_lu), intent(out) :: factor
    integer :: n, j, info
    n = size(matrix, 1)
    allocate (factor%values(n, n), factor%scale(n), factor%pivot(n))
    factor%scale = tiny(1.0_rk)
    do j = 1, n
      factor%scale = max(factor%scale, abs(matrix(:, j)))
    end do
    factor%scale = 1.0_rk/factor%scale
    do j = 1, n
      factor%values(:, j) = real(factor%scale*matrix(:, j), single)
    end do
    info = 0
    if (n > 0) call sgetrf(n, n, factor%values, n, factor%pivot, info)
    factor%is_there = info == 0
  end subroutine factorise_single

  !> Solves in place.
  subroutine solve_single(factor, b)
    type(single_lu), intent(in) :: factor
    real(rk), intent(inout) :: b(:) !< (rows)
    real(single) :: x(size(b), 1)
    real(rk) :: largest
    integer :: n, info
    n = size(b)
    if (n == 0) return
    b = factor%scale*b
    largest = max(maxval(abs(b)), tiny(1.0_rk))
    x(:, 1) = real(b/largest, single)
    call sgetrs('N', n, 1, factor%values, n, factor%pivot, x, n, info)
    b = largest*real(x(:, 1), rk)
  end subroutine solve_single
end module single_factor
