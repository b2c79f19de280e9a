!> Factors of small dense matrices in single precision (LAPACK), for preconditioners.
module single_factor
  use, intrinsic :: iso_c_binding, only: c_float, c_int
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

    !> x = L^-1 x, L with a unit diagonal.
    subroutine keyway_solve_unit_lower(rows, values, x) bind(c)
      import :: c_float, c_int
      implicit none
      integer(c_int), value :: rows
      real(c_float), intent(in) :: values(rows, rows)
      real(c_float), intent(inout) :: x(rows)
    end subroutine keyway_solve_unit_lower

    !> x = U^-1 x.
    subroutine keyway_solve_upper(rows, values, x) bind(c)
      import :: c_float, c_int
      implicit none
      integer(c_int), value :: rows
      real(c_float), intent(in) :: values(rows, rows)
      real(c_float), intent(inout) :: x(rows)
    end subroutine keyway_solve_upper
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
    real(single) :: x(size(b)), moved
    real(rk) :: largest
    integer :: n, i
    n = size(b)
    if (n == 0) return
    b = factor%scale*b
    largest = max(maxval(abs(b)), tiny(1.0_rk))
    x = real(b/largest, single)
    do i = 1, n
      moved = x(i)
      x(i) = x(factor%pivot(i))
      x(factor%pivot(i)) = moved
    end do
    call keyway_solve_unit_lower(n, factor%values, x)
    call keyway_solve_upper(n, factor%values, x)
    b = largest*real(x, rk)
  end subroutine solve_single
end module single_factor
