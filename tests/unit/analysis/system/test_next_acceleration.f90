!> The expected acceleration of motions that go on, alternate or grow.
program test_next_acceleration
  use analysis_state, only: motion
  use kinds, only: rk
  use matrix_pattern, only: pattern
  use next_acceleration, only: expected_acceleration, find_trend
  use testing, only: check_close, test_log
  implicit none
  type(test_log) :: log
  type(pattern) :: matrix
  integer, parameter :: n = 7 !< free unknowns; one more is prescribed
  !> Round-off of the least squares of two vectors that are not parallel.
  real(rk), parameter :: roundoff = 1.0e-12_rk
  log%suite = 'next_acceleration'
  matrix%num_free = n
  call alternates()
  call decays()
  call grows()
  call starts()
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1
contains

  !> Newmark's alternating acceleration beside a constant one: that of two increments ago returns.
  subroutine alternates()
    real(rk) :: one(n), other(n), a(n)
    one = shape_of(1)
    other = shape_of(2)
    a = after([one + other, one - other, one + other])
    call check_close(log, maxval(abs(a - (one - other))), 0.0_rk, roundoff, 'alternates')
  end subroutine alternates

  !> Two shapes that decay by 0.9 and by -0.8 an increment.
  subroutine decays()
    real(rk) :: one(n), other(n), a(n)
    one = shape_of(1)
    other = shape_of(2)
    a = after([one + other, 0.9_rk*one - 0.8_rk*other, 0.81_rk*one + 0.64_rk*other])
    call check_close(log, maxval(abs(a - (0.729_rk*one - 0.512_rk*other))), 0.0_rk, roundoff, &
                     'decays')
  end subroutine decays

  !> An acceleration that doubles is expected to stay.
  subroutine grows()
    real(rk) :: one(n), a(n)
    one = shape_of(1)
    a = after([one, 2.0_rk*one, 4.0_rk*one])
    call check_close(log, maxval(abs(a - 4.0_rk*one)), 0.0_rk, roundoff, 'grows')
  end subroutine grows

  !> One increment shows one factor.
  subroutine starts()
    type(motion) :: old, new
    real(rk) :: one(n)
    one = shape_of(1)
    old%a = [one, 9.0_rk]
    new%a = [-0.5_rk*one, 9.0_rk]
    call find_trend(old, new, matrix)
    call check_close(log, maxval(abs(expected_acceleration(new, matrix) - 0.25_rk*one)), 0.0_rk, &
                     roundoff, 'starts')
  end subroutine starts

  !> The acceleration that is expected after three of them.
  function after(past) result(a)
    real(rk), intent(in) :: past(3*n)
    real(rk) :: a(n)
    type(motion) :: old, new
    integer :: k
    new%a = [past(:n), 9.0_rk]
    do k = 2, 3
      old = new
      new%a = [past((k - 1)*n + 1:k*n), 9.0_rk]
      call find_trend(old, new, matrix)
    end do
    a = expected_acceleration(new, matrix)
  end function after

  !> Some vector.
  function shape_of(number) result(x)
    integer, intent(in) :: number
    real(rk) :: x(n)
    integer :: k
    x = [(cos(real(number*k*k, rk)), k=1, n)]
  end function shape_of
end program test_next_acceleration
