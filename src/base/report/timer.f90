!> Wall clock, and memory of the process.
module timer
  use kinds, only: long, rk
  implicit none
  private
  public :: wall_clock, peak_memory

  real(rk), parameter :: kilobytes_per_megabyte = 1024.0_rk

contains

  !> Seconds since some fixed instant.
  real(rk) function wall_clock() result(seconds)
    integer(long) :: ticks, rate
    call system_clock(ticks, rate)
    seconds = real(ticks, rk)/real(rate, rk)
  end function wall_clock

  !> Peak memory of the process so far [MB]; 0 if the system does not report it.
  real(rk) function peak_memory() result(megabytes)
    character(*), parameter :: wanted = 'VmHWM:'
    character(256) :: line
    integer :: unit, status
    megabytes = 0.0_rk
    open (newunit=unit, file='/proc/self/status', status='old', action='read', iostat=status)
    if (status /= 0) return
    do
      read (unit, '(a)', iostat=status) line
      if (status /= 0) exit
      if (index(line, wanted) /= 1) cycle
      read (line(len(wanted) + 1:), *, iostat=status) megabytes ! followed by 'kB'
      if (status == 0) megabytes = megabytes/kilobytes_per_megabyte
      exit
    end do
    close (unit)
  end function peak_memory
end module timer
