!> What blocks of a compliance leave out, learned from responses: exact on the space of the forces
!> that were seen, and the oldest are forgotten.
program test_learned_response
  use kinds, only: rk
  use learned_response, only: most_kept, response_memory
  use testing, only: check, check_close, repeat_chance, test_log
  implicit none
  integer, parameter :: n = 150, num_forces = 10
  real(rk), parameter :: roundoff = 1.0e-11_rk !< some thousand operations
  type(test_log) :: log
  type(response_memory) :: memory
  real(rk) :: matrix(n, n), force(n, num_forces), weight(num_forces)
  integer :: k
  log%suite = 'learned_response'
  call repeat_chance(3)
  call random_number(matrix)
  call random_number(force)
  call random_number(weight)
  call check(log, maxval(abs(found(force(:, 1)))) <= 0.0_rk, 'nothing is known at first')
  do k = 1, num_forces
    call memory%learn(force(:, k), matmul(matrix, force(:, k)))
  end do
  call check_close(log, error_of(matmul(force, weight)), 0.0_rk, roundoff, 'a combination')
  call memory%learn(force(:, 2), matmul(matrix, force(:, 2)))
  call memory%learn(0.0_rk*force(:, 2), 0.0_rk*force(:, 2))
  call check(log, memory%num_kept == num_forces, 'what is not new is not kept')
  call forget_the_oldest()
  call memory%forget()
  call check(log, maxval(abs(found(force(:, 1)))) <= 0.0_rk, 'forgotten')
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> E x as it is known.
  function found(x) result(y)
    real(rk), intent(in) :: x(n)
    real(rk) :: y(n)
    y = 0.0_rk
    call memory%add_to(x, y)
  end function found

  !> Error of E x over E x.
  real(rk) function error_of(x)
    real(rk), intent(in) :: x(n)
    error_of = norm2(found(x) - matmul(matrix, x))/norm2(matmul(matrix, x))
  end function error_of

  !> More forces than are kept: the last ones are exact.
  subroutine forget_the_oldest()
    real(rk) :: more(n, most_kept + 7)
    integer :: k
    call random_number(more)
    do k = 1, size(more, 2)
      call memory%learn(more(:, k), matmul(matrix, more(:, k)))
    end do
    call check(log, memory%num_kept == most_kept, 'no more are kept')
    call check_close(log, error_of(more(:, size(more, 2))), 0.0_rk, roundoff, 'the last force')
  end subroutine forget_the_oldest
end program test_learned_response
