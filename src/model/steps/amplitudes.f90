!> Histories that scale loads: linear between points, constant outside.
module amplitudes
  use kinds, only: rk
  implicit none
  private
  public :: amplitude, amplitude_at, slope_at, spacing_of, spacing_of_times, one_g

  real(rk), parameter :: one_g = 9.81_rk !< unit of records of ground motion [m/s2]

  type :: amplitude
    character(:), allocatable :: name !< upper case
    real(rk), allocatable :: time(:) !< ascending [s]
    real(rk), allocatable :: value(:) !< same size as `time`
    logical :: uses_total_time = .false. !< else the time within the step
  end type amplitude

contains

  !> Value of the history at time `t`.
  pure real(rk) function amplitude_at(history, t) result(value)
    type(amplitude), intent(in) :: history
    real(rk), intent(in) :: t !< [s], step or total time as in `uses_total_time`
    integer :: low
    real(rk) :: share
    associate (last => size(history%time))
      if (t <= history%time(1)) then
        value = history%value(1)
      else if (t >= history%time(last)) then
        value = history%value(last)
      else
        low = point_before(history, t)
        share = (t - history%time(low))/(history%time(low + 1) - history%time(low))
        value = history%value(low) + share*(history%value(low + 1) - history%value(low))
      end if
    end associate
  end function amplitude_at

  !> Slope of the history at time `t` [1/s].
  pure real(rk) function slope_at(history, t) result(slope)
    type(amplitude), intent(in) :: history
    real(rk), intent(in) :: t !< [s], step or total time as in `uses_total_time`
    integer :: low
    slope = 0.0_rk
    if (t <= history%time(1) .or. t >= history%time(size(history%time))) return
    low = point_before(history, t)
    slope = (history%value(low + 1) - history%value(low)) &
            /(history%time(low + 1) - history%time(low))
  end function slope_at

  !> The last point that is not after a time between the first and the last.
  pure integer function point_before(history, t) result(low)
    type(amplitude), intent(in) :: history
    real(rk), intent(in) :: t !< [s]
    integer :: high, middle
    high = size(history%time)
    low = 1
    do while (high - low > 1)
      middle = (low + high)/2
      if (history%time(middle) <= t) low = middle
      if (history%time(middle) > t) high = middle
    end do
  end function point_before

  !> The shortest sampling interval: longer increments would miss values. Half the time from the
  !> value before to the value after: a jump is no sampling. Without limit for less than three
  !> points.
  pure real(rk) function spacing_of(history) result(spacing)
    type(amplitude), intent(in) :: history
    spacing = spacing_of_times(history%time)
  end function spacing_of

  !> The same of the rows of a table.
  pure real(rk) function spacing_of_times(time) result(spacing)
    real(rk), intent(in) :: time(:) !< ascending [s]
    integer :: n
    n = size(time)
    spacing = 0.5_rk*huge(1.0_rk) ! the caller adds round-off
    if (n > 2) spacing = 0.5_rk*minval(time(3:) - time(:n - 2))
  end function spacing_of_times
end module amplitudes
