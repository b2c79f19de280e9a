!> Widths of crack bands against closed forms.
program test_crack_band
  use crack_band, only: band_width, extreme_widths
  use kinds, only: rk
  use testing, only: check_close, test_log
  implicit none
  real(rk), parameter :: roundoff = 1.0e-14_rk !< a few operations on numbers near 1
  type(test_log) :: log

  log%suite = 'crack_band'
  call bricks(log)
  call sheared_brick(log)
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> A cube has its side in all directions, a long brick its length only along.
  subroutine bricks(log)
    type(test_log), intent(inout) :: log
    real(rk) :: edges(3, 3), smallest, largest
    edges = reshape([1, 0, 0, 0, 1, 0, 0, 0, 1], [3, 3])
    call check_close(log, band_width(edges, [0.6_rk, 0.0_rk, 0.8_rk]), 1.0_rk, roundoff, 'cube')
    call extreme_widths(edges, smallest, largest)
    call check_close(log, largest, 1.0_rk, roundoff, 'cube, largest')
    call check_close(log, smallest, 1.0_rk, roundoff, 'cube, smallest')
    edges(3, 3) = 5.0_rk
    call check_close(log, band_width(edges, [0.0_rk, 0.0_rk, 1.0_rk]), 5.0_rk, roundoff, 'along')
    call check_close(log, band_width(edges, [1.0_rk, 0.0_rk, 0.0_rk]), 1.0_rk, roundoff, 'across')
    call extreme_widths(edges, smallest, largest)
    call check_close(log, largest, 5.0_rk, 5.0_rk*roundoff, 'long brick, largest')
    call check_close(log, smallest, 1.0_rk, 25.0_rk*roundoff, 'long brick, smallest')
  end subroutine bricks

  !> Columns (1, 0), (s, 1): the singular values of a simple shear s are
  !> sqrt(1 + s^2/4) +- s/2 (their product is 1, their difference s).
  subroutine sheared_brick(log)
    type(test_log), intent(inout) :: log
    real(rk) :: edges(3, 3), smallest, largest
    real(rk), parameter :: s = 1.5_rk
    edges = reshape([1.0_rk, 0.0_rk, 0.0_rk, s, 1.0_rk, 0.0_rk, 0.0_rk, 0.0_rk, 0.7_rk], [3, 3])
    call extreme_widths(edges, smallest, largest)
    call check_close(log, largest, sqrt(1.0_rk + s**2/4.0_rk) + s/2.0_rk, 4.0_rk*roundoff, &
                     'sheared brick, largest')
    call check_close(log, smallest, sqrt(1.0_rk + s**2/4.0_rk) - s/2.0_rk, 16.0_rk*roundoff, &
                     'sheared brick, smallest')
  end subroutine sheared_brick
end program test_crack_band
