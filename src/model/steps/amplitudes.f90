!> Histories that scale loads: linear between points, constant outside.
module amplitudes
  use kinds, only: rk
  implicit none
  private
  public :: amplitude, amplitude_at, one_g

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
    integer :: low, high, middle
    real(rk) :: share
    high = size(history%time)
    low = 1
    if (t <= history%time(1)) then
      value = history%value(1)
    else if (t >= history%time(high)) then
      value = history%value(high)
    else
      do while (high - low > 1)
        middle = (low + high)/2
        if (history%time(middle) <= t) low = middle
        if (history%time(middle) > t) high = middle
      end do
      share = (t - history%time(low))/(history%time(high) - history%time(low))
      value = history%value(low) + share*(history%value(high) - history%value(low))
    end if
  end function amplitude_at
end module amplitudes
