!> Velocities and accelerations of supports that move in a dynamic step (theory.md, 7.1).
!>
!> They are central differences of the history over two increments. By Newmark's formulas each
!> corner of a history would start a swing of the support that no force damps.
module support_rates
  use amplitudes, only: amplitude, slope_at
  use kinds, only: rk
  use problem_definition, only: problem
  use ranks, only: is_true_everywhere
  use step_loads, only: factor_at, step_time, support
  use step_system, only: dam_system
  implicit none
  private
  public :: find_support_rates, find_slopes, has_moving_supports

  !> Times that differ by less, over an increment, are one.
  real(rk), parameter :: roundoff = 1.0e-6_rk

contains

  !> Whether a support moves in the step: with an amplitude, or at once.
  logical function has_moving_supports(system)
    type(dam_system), intent(in) :: system
    associate (supports => system%supports)
      has_moving_supports = any(supports%amplitude > 0 .or. &
                                abs(supports%value - supports%start_value) > 0.0_rk)
    end associate
    has_moving_supports = .not. is_true_everywhere(.not. has_moving_supports)
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

  !> Rates of one support. Where its history begins or ends, they are those of the parabola through
  !> the nearest three points; the velocity is not above the slope of the chord there, so that a
  !> motion that starts smoothly starts from rest.
  pure subroutine differentiate(item, histories, when, increment, v, a)
    type(support), intent(in) :: item
    type(amplitude), intent(in) :: histories(:)
    type(step_time), intent(in) :: when
    real(rk), intent(in) :: increment !< [s]
    real(rk), intent(out) :: v, a
    real(rk) :: u(-1:1), h, shift, span(2)
    type(step_time) :: instant
    integer :: i
    h = increment
    instant = when
    span = span_of_history(histories(item%amplitude), when, h)
    h = min(h, 0.5_rk*(span(2) - span(1)))
    instant%now = min(max(when%now, span(1) + h), span(2) - h)
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

  !> Beginning and end of a history since the start of the step [s]: in the time of a step those of
  !> the step. In total time it begins with the analysis, or with the step where its table does, and
  !> ends where a table ends that lasts at least as long as the step. At the ends of other tables
  !> the support starts or stops within the step.
  pure function span_of_history(history, when, increment) result(span)
    type(amplitude), intent(in) :: history
    type(step_time), intent(in) :: when
    real(rk), intent(in) :: increment !< [s]
    real(rk) :: span(2)
    integer :: n
    span = [0.0_rk, when%duration]
    if (.not. history%uses_total_time) return
    n = size(history%time)
    associate (first => history%time(1) - when%start, last => history%time(n) - when%start)
      span = [-when%start, huge(1.0_rk)]
      if (n == 1) return
      if (first <= roundoff*increment) span(1) = max(span(1), first)
      if (last >= when%duration - roundoff*increment) span(2) = max(last, when%duration)
    end associate
  end function span_of_history

  !> Of two slopes the one nearer to zero; zero where their signs differ.
  pure real(rk) function nearer_zero(x, y) result(slope)
    real(rk), intent(in) :: x, y
    slope = 0.0_rk
    if (x*y > 0.0_rk) slope = sign(min(abs(x), abs(y)), x)
  end function nearer_zero
end module support_rates
