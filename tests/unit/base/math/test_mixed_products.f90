!> Products of matrices in single precision with vectors in double precision: those of the rounded
!> matrix, for all remainders of the numbers of rows and columns by four.
program test_mixed_products
  use, intrinsic :: iso_fortran_env, only: single => real32
  use kinds, only: rk
  use mixed_products, only: mixed_times, mixed_transposed_times, rounded
  use testing, only: check, check_close, test_log
  implicit none

  type(test_log) :: log
  integer :: m, n

  log%suite = 'mixed_products'
  do n = 0, 9
    do m = 1, 9
      call compare(m, n)
    end do
  end do
  call compare(101, 57)
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
  end subroutine compare
end program test_mixed_products
