!> Cholesky's factor with pivots: of matrices of full rank, of less rank, and of zeros.
program test_pivoted_cholesky
  use kinds, only: rk
  use pivoted_cholesky, only: factorise_kept, pivoted_factor, solve_half, solve_rest
  use testing, only: check, check_close, test_log
  implicit none

  type(test_log) :: log

  log%suite = 'pivoted_cholesky'
  call check_rank(6, 6)
  call check_rank(6, 2)
  call check_rank(6, 1)
  call check_rank(6, 0)
  call check_rank(1, 1)
  call check_rank(0, 0)
  call check_left_out()
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> A = B B^T with B of some columns: as many rows are kept, and A = (U^-T A_k)^T (U^-T A_k).
  subroutine check_rank(n, rank)
    integer, intent(in) :: n, rank
    real(rk) :: b(n, rank), a(n, n)
    real(rk), allocatable :: half(:, :)
    type(pivoted_factor) :: factor
    integer :: i, j
    do j = 1, rank
      b(:, j) = [(sin(1.3_rk*i + 0.7_rk*i*j), i=1, n)]
    end do
    a = matmul(b, transpose(b))
    call factorise_kept(a, spread(1.0e-12_rk, 1, n), factor)
    call check(log, size(factor%kept) == rank, 'rows that are kept')
    half = a(factor%kept, :)
    call solve_half(factor, half)
    call check_close(log, norm2(matmul(transpose(half), half) - a), 0.0_rk, 1.0e-12_rk, 'U^T U')
    half = a(factor%kept, factor%kept)
    call solve_half(factor, half)
    call solve_rest(factor, half)
    do i = 1, rank
      half(i, i) = half(i, i) - 1.0_rk
    end do
    call check_close(log, norm2(half), 0.0_rk, 1.0e-9_rk, 'inverse')
  end subroutine check_rank

  !> A row without noise is left out, whatever its diagonal.
  subroutine check_left_out()
    real(rk) :: a(3, 3)
    type(pivoted_factor) :: factor
    a = reshape([4.0_rk, 1.0_rk, 0.0_rk, 1.0_rk, 3.0_rk, 1.0_rk, 0.0_rk, 1.0_rk, 2.0_rk], [3, 3])
    call factorise_kept(a, [1.0e-9_rk, 0.0_rk, 1.0e-9_rk], factor)
    call check(log, size(factor%kept) == 2 .and. .not. any(factor%kept == 2), 'row left out')
  end subroutine check_left_out
end program test_pivoted_cholesky
