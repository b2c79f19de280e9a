!> What blocks of a compliance leave out, learned from responses: nearly exact on the space of the
!> forces that were seen; the oldest are forgotten, and errors of responses do not grow.
program test_learned_response
  use kinds, only: rk
  use learned_response, only: most_kept, response_memory
  use testing, only: check, check_close, repeat_chance, test_log
  implicit none
  integer, parameter :: n = 150, num_forces = 10
  !> The share 1e-6 of the forces' length leaves 1e-6 over the least eigenvalue of F^T F, some 0.03.
  real(rk), parameter :: left = 1.0e-4_rk
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
  call check_close(log, error_of(matmul(force, weight)), 0.0_rk, left, 'a combination')
  call memory%learn(0.0_rk*force(:, 2), 0.0_rk*force(:, 2))
  call check(log, memory%num_kept == num_forces, 'no forces are not kept')
  call forget_the_oldest()
  call memory%forget()
  call check(log, maxval(abs(found(force(:, 1)))) <= 0.0_rk, 'forgotten')
  call take_nearly_dependent_forces()
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
    call check_close(log, error_of(more(:, size(more, 2))), 0.0_rk, left, 'the last force')
  end subroutine forget_the_oldest

  !> Each force is one of a few and 0.2 % of others; each response is wrong by 0.1 % of the largest
  !> that forces of this length have. In an orthonormal basis of the forces the errors are 500 times
  !> as large, and grow with each force that takes the place of an old one.
  subroutine take_nearly_dependent_forces()
    real(rk) :: x(n), error(n), largest
    integer :: k
    ! The matrix has positive entries: it answers most to equal forces.
    largest = norm2(sum(matrix, 2))/sqrt(real(n, rk))
    do k = 1, 10*most_kept
      call random_number(weight)
      call random_number(error)
      x = matmul(force, weight)
      x = x + 2.0e-3_rk*norm2(x)*(error - 0.5_rk)/norm2(error - 0.5_rk)
      call random_number(error)
      error = error - 0.5_rk
      call memory%learn(x, matmul(matrix, x) + 1.0e-3_rk*largest*norm2(x)*error/norm2(error))
    end do
    call random_number(x)
    x = x - 0.5_rk
    call check(log, norm2(found(x)) < 0.5_rk*largest*norm2(x), &
               'errors of responses stay smaller than responses')
    call check_close(log, error_of(force(:, 1)), 0.0_rk, 5.0e-3_rk, 'error of responses')
  end subroutine take_nearly_dependent_forces
end program test_learned_response
