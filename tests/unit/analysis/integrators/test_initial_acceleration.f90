!> M a = r where M leaves directions without mass: a node of solids beside one that moves water
!> along its normal only.
program test_initial_acceleration
  use kinds, only: rk
  use errors, only: error_type
  use testing, only: test_log, check, check_close
  use matrix_pattern, only: pattern
  use initial_acceleration, only: find_acceleration
  implicit none
  type(test_log) :: log
  type(pattern) :: matrix
  real(rk), parameter :: n(3) = [2.0_rk, -1.0_rk, 2.0_rk]/3.0_rk
  real(rk), parameter :: solid(3, 3) = reshape([4.0_rk, 1.0_rk, 0.5_rk, 1.0_rk, 3.0_rk, 0.2_rk, &
                                                0.5_rk, 0.2_rk, 2.0_rk], [3, 3])
  real(rk), parameter :: known(3) = [1.0_rk, -2.0_rk, 0.5_rk]
  integer, parameter :: node(6) = [1, 1, 1, 2, 2, 2]
  real(rk) :: mass(12), r(6), a(6), along(3, 3)
  type(error_type), allocatable :: error
  integer :: i, j
  log%suite = 'initial_acceleration'
  along = spread(n, 2, 3)*spread(n, 1, 3)
  call fill_pattern(matrix)
  mass = [((solid(i, j), i=j, 3), j=1, 3), ((along(i, j), i=j, 3), j=1, 3)]
  r(:3) = matmul(solid, known)
  ! The second node is pushed along its normal and, a million times harder, across it.
  r(4:) = 5.0_rk*n + 1.0e6_rk*[1.0_rk, 2.0_rk, 0.0_rk] ! the latter stands on n
  call find_acceleration(matrix, mass, node, r, a, error)
  call check(log, allocated(error) .eqv. .false., 'there is an acceleration')
  ! The iteration ends at 1e-13 of all forces, 2e6 N: 1e-6 leaves five times that.
  call check_close(log, maxval(abs(a(:3) - known)), 0.0_rk, 1.0e-6_rk, 'where there is mass')
  call check_close(log, dot_product(a(4:), n), 5.0_rk, 1.0e-6_rk, 'along the normal')
  call check_close(log, norm2(a(4:)), 5.0_rk, 1.0e-6_rk, 'none where there is no mass')
  mass(7:) = 0.0_rk
  call find_acceleration(matrix, mass, node, r, a, error)
  call check_close(log, maxval(abs(a(:3) - known)), 0.0_rk, 1.0e-12_rk, 'a definite mass')
  call check(log, all(abs(a(4:)) <= 0.0_rk), 'a node without mass stays')
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1
contains
  !> Two nodes of three unknowns that are not coupled.
  subroutine fill_pattern(matrix)
    type(pattern), intent(out) :: matrix
    matrix%num_free = 6
    matrix%num_total = 6
    matrix%column_start = [1, 4, 6, 7, 10, 12, 13]
    matrix%row = [1, 2, 3, 2, 3, 3, 4, 5, 6, 5, 6, 6]
    matrix%free_entries = [3, 2, 1, 3, 2, 1]
    matrix%alike = matrix%free_entries
  end subroutine fill_pattern
end program test_initial_acceleration
