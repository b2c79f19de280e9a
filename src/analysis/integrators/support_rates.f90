!> Velocities and accelerations of supports that move in a dynamic step (theory.md, 7.1).
!>
!> They are central differences of the history over two increments. By Newmark's formulas each
!> corner of a history would start a swing of the support that no force damps.
module support_rates
  use amplitudes, only: amplitude, slope_at
  use kinds, only: rk
  use problem_definition, only: problem
  use step_loads, only: factor_at, step_time, support
  use step_system, only: dam_system
  implicit none
  private
  public :: find_support_rates, find_slopes, has_moving_supports

  !> Times that differ by less, over an increment, are one.
  real(rk), parameter :: roundoff = 1.0e-6_rk

contains

  !> Whether a support moves in the step: with an amplitude, or at once.
  pure logical function has_moving_supports(system)
    type(dam_system), intent(in) :: system
    associate (supports => system%supports)
      has_moving_supports = any(supports%amplitude > 0 .or. &
                                abs(supports%value - supports%start_value) > 0.0_rk)
    end associate
  end function has_moving_supports

  !> Rates of all supports at a time; zero for those without an amplitude.
  subroutine find_support_rates(model, system, when, increment, v, a)
    type(problem), intent(in) :: model
    type(dam_system), intent(in) :: system
    type(step_time), intent(in) :: when
    real(rk), intent(in) :: increment !< [s]
    real(rk), intent(inout) :: v(:), a(:) !< (num_total) [m/s], [m/s2]; others are kept
    integer :: i
    do i = 1, size(system%supports)
      associate (item => system%supports(i))
        v(item%unknown) = 0.0_rk
        a(item%unknown) = 0.0_rk
        if (item%amplitude == 0) cycle
        call differentiate(item, model%amplitudes, when, increment, v(item%unknown), &
                           a(item%unknown))
      end associate
    end do
  end subroutine find_support_rates

  !> Velocities of the supports as their histories have them; zero for those without an amplitude.
  subroutine find_slopes(model, system, when, v)
    type(problem), intent(in) :: model
    type(dam_system), intent(in) :: system
    type(step_time), intent(in) :: when
    real(rk), intent(out) :: v(:) !< (num_total); zero in other unknowns [m/s]
    integer :: i
    v = 0.0_rk
    do i = 1, size(system%supports)
      associate (item => system%supports(i))
        if (item%amplitude == 0) cycle
        associate (own => model%amplitudes(item%amplitude))
          v(item%unknown) = item%value*slope_at(own, when%clock(own%uses_total_time))
        end associate
      end associate
    end do
  end subroutine find_slopes

  !> Rates of one support. Where its history begins or ends, with the analysis or, in the time of a
  !> step, with the step, they are those of the parabola through the nearest three points; the
  !> velocity is not above the slope of the chord there, so that a motion that starts smoothly
  !> starts from rest.
  pure subroutine differentiate(item, histories, when, increment, v, a)
    type(support), intent(in) :: item
    type(amplitude), intent(in) :: histories(:)
    type(step_time), intent(in) :: when
    real(rk), intent(in) :: increment !< [s]
    real(rk), intent(out) :: v, a
    real(rk) :: u(-1:1), h, shift
    type(step_time) :: instant
    integer :: i
    h = increment
    instant = when
    if (histories(item%amplitude)%uses_total_time) then
      instant%now = max(when%now, h - when%start)
    else
      h = min(h, 0.5_rk*when%duration)
      instant%now = min(max(when%now, h), when%duration - h)
    end if
    shift = when%now - instant%now
    do i = -1, 1
      instant%now = when%now - shift + i*h
      u(i) = factor_at(item%start_value, item%value, item%amplitude, histories, instant)
    end do
    a = (u(1) - 2.0_rk*u(0) + u(-1))/h**2
    v = (u(1) - u(-1))/(2.0_rk*h) + a*shift
    if (shift < -roundoff*h) v = nearer_zero(v, (u(0) - u(-1))/h)
    if (shift > roundoff*h) v = nearer_zero(v, (u(1) - u(0))/h)
  end subroutine differentiate

  !> Of two slopes the one nearer to zero; zero where their signs differ.
  pure real(rk) function nearer_zero(x, y) result(slope)
    real(rk), intent(in) :: x, y
    slope = 0.0_rk
    if (x*y > 0.0_rk) slope = sign(min(abs(x), abs(y)), x)
  end function nearer_zero
end module support_rates
