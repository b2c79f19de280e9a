!> Velocities and accelerations of supports that follow an amplitude (theory.md, 7.1).
!>
!> They are central differences of the history over two increments. By Newmark's formulas each
!> corner of a history would start a swing of the support that no force damps.
module support_rates
  use kinds, only: rk
  use problem_definition, only: problem
  use step_loads, only: prescribed_values, step_time
  use step_system, only: dam_system
  implicit none
  private
  public :: find_support_rates, has_moving_supports

contains

  !> Whether a support of the step follows an amplitude.
  pure logical function has_moving_supports(system)
    type(dam_system), intent(in) :: system
    has_moving_supports = any(system%supports%amplitude > 0)
  end function has_moving_supports

  !> Rates of all supports at a time; zero for those without an amplitude. At both ends of the step
  !> they are those of the parabola through the nearest three points of the history; the velocity is
  !> not above the slope of the last chord, so that a motion that starts smoothly starts from rest.
  subroutine find_support_rates(model, system, when, increment, v, a)
    type(problem), intent(in) :: model
    type(dam_system), intent(in) :: system
    type(step_time), intent(in) :: when
    real(rk), intent(in) :: increment !< [s]
    real(rk), intent(inout) :: v(:), a(:) !< (num_total) [m/s], [m/s2]; others are kept
    real(rk) :: u(size(v), -1:1), h
    type(step_time) :: middle, instant
    integer :: i
    h = min(increment, 0.5_rk*when%duration)
    middle = when
    middle%now = min(max(when%now, h), when%duration - h)
    instant = middle
    do i = -1, 1
      instant%now = middle%now + i*h
      call prescribed_values(system%supports, model%amplitudes, instant, u(:, i))
    end do
    do i = 1, size(system%supports)
      associate (k => system%supports(i)%unknown)
        v(k) = 0.0_rk
        a(k) = 0.0_rk
        if (system%supports(i)%amplitude == 0) cycle
        a(k) = (u(k, 1) - 2.0_rk*u(k, 0) + u(k, -1))/h**2
        v(k) = (u(k, 1) - u(k, -1))/(2.0_rk*h) + a(k)*(when%now - middle%now)
        if (when%now < middle%now) v(k) = nearer_zero(v(k), (u(k, 0) - u(k, -1))/h)
        if (when%now > middle%now) v(k) = nearer_zero(v(k), (u(k, 1) - u(k, 0))/h)
      end associate
    end do
  end subroutine find_support_rates

  !> Of two slopes the one nearer to zero; zero where their signs differ.
  pure real(rk) function nearer_zero(x, y) result(slope)
    real(rk), intent(in) :: x, y
    slope = 0.0_rk
    if (x*y > 0.0_rk) slope = sign(min(abs(x), abs(y)), x)
  end function nearer_zero
end module support_rates
