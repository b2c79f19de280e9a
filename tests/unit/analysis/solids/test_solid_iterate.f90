!> When the iteration on solids ends early.
program test_solid_iterate
  use kinds, only: rk
  use solid_iterate, only: falls_too_slowly
  use testing, only: check, test_log
  implicit none
  type(test_log) :: log
  log%suite = 'solid_iterate'
  call rates()
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> Geometric sequences that end above or below the tolerance.
  subroutine rates()
    real(rk), parameter :: tolerance = 1.0e-6_rk
    real(rk) :: half(16)
    half = residuals(0.5_rk, 16)
    call check(log,.not. falls_too_slowly(half(:15), tolerance, 1), 'a short history')
    call check(log,.not. falls_too_slowly(half, tolerance, 6), '2**(-21) is enough')
    call check(log, falls_too_slowly(half, tolerance, 3), '2**(-18) is too much')
    call check(log, falls_too_slowly(residuals(1.0_rk, 20), tolerance, 1000), 'a residual stays')
    call check(log, falls_too_slowly(residuals(1.1_rk, 20), tolerance, 50), 'a residual grows')
    call check(log, falls_too_slowly([half, spread(half(16), 1, 15)], tolerance, 50), &
               'only the last iterations count')
  end subroutine rates

  !> 1, ratio, ratio**2 ..
  pure function residuals(ratio, n) result(history)
    real(rk), intent(in) :: ratio
    integer, intent(in) :: n
    real(rk) :: history(n)
    integer :: i
    history = [(ratio**(i - 1), i=1, n)]
  end function residuals
end program test_solid_iterate
