!> Products of matrices in single and double precision with vectors in double precision, and
!> solutions with factors in single precision, for all remainders of the numbers of rows and columns
!> by four.
program test_mixed_products
  use, intrinsic :: iso_fortran_env, only: single => real32
  use dense_products, only: add_times_vector, times_vector
  use kinds, only: rk
  use mixed_products, only: mixed_times, mixed_transposed_times, rounded
  use single_factor, only: factorise_single, single_lu, solve_single
  use testing, only: check, check_close, test_log
  implicit none

  type(test_log) :: log
  integer :: m, n

  log%suite = 'mixed_products'
  do n = 0, 9
    do m = 1, 9
      call compare(m, n)
    end do
    call solve(n)
  end do
  call compare(101, 57)
  call solve(101)
  call check(log, abs(rounded(0.1_rk) - 0.1_rk) > 1.0e-10_rk, 'rounded')
  call check(log,.not. abs(rounded(0.25_rk) - 0.25_rk) > 0.0_rk, 'not rounded')
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> Against matmul in double precision; sums in another order differ by round-off alone.
  subroutine compare(rows, columns)
    integer, intent(in) :: rows, columns
    real(rk) :: a(rows, columns), x(columns), y(rows)
    integer :: i, j
    do j = 1, columns
      a(:, j) = [(rounded(sin(1.3_rk*i + 0.7_rk*i*j)), i=1, rows)]
    end do
    x = [(cos(0.9_rk*j), j=1, columns)]
    y = [(sin(0.4_rk*i), i=1, rows)]
    call check_close(log, norm2(mixed_times(real(a, single), x) - matmul(a, x)), 0.0_rk, &
                     1.0e-14_rk*(1 + rows*columns), 'product')
    call check_close(log, norm2(mixed_transposed_times(real(a, single), y) - matmul(y, a)), &
                     0.0_rk, 1.0e-14_rk*(1 + rows*columns), 'transposed product')
    call check_close(log, norm2(times_vector(a, x) - matmul(a, x)), 0.0_rk, &
                     1.0e-14_rk*(1 + rows*columns), 'product in double precision')
    y = matmul(a, x)
    call add_times_vector(a, x, y)
    call check_close(log, norm2(y - 2.0_rk*matmul(a, x)), 0.0_rk, &
                     1.0e-14_rk*(1 + rows*columns), 'added product')
  end subroutine compare

  !> A matrix that needs exchanges of rows: the last row is the largest in the first column. Its
  !> condition is below 10, so that some digits less than those of single precision are left.
  subroutine solve(rows)
    integer, intent(in) :: rows
    real(rk) :: a(rows, rows), x(rows), b(rows)
    type(single_lu) :: factor
    integer :: i, j
    do j = 1, rows
      a(:, j) = [(sin(1.3_rk*i + 0.7_rk*i*j)/(2*rows), i=1, rows)]
      a(1 + mod(j + rows - 2, rows), j) = 1.0_rk + a(1 + mod(j + rows - 2, rows), j)
    end do
    x = [(cos(0.9_rk*j), j=1, rows)]
    b = matmul(a, x)
    call factorise_single(a, factor)
    call check(log, factor%is_there, 'factor')
    call solve_single(factor, b)
    call check_close(log, norm2(b - x), 0.0_rk, 1.0e-5_rk*(1 + norm2(x)), 'solution')
  end subroutine solve
end program test_mixed_products
