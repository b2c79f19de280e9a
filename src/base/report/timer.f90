!> Wall clock, and memory of the process.
module timer
  use, intrinsic :: iso_c_binding, only: c_long
  use kinds, only: long, rk
  implicit none
  private
  public :: wall_clock, peak_memory

  real(rk), parameter :: kilobytes_per_megabyte = 1024.0_rk

  interface
    !> In kB, -1 if the system does not report it (process_limits.c).
    function c_peak_memory() result(kilobytes) bind(c, name='keyway_peak_memory')
      import :: c_long
      implicit none
      integer(c_long) :: kilobytes
    end function c_peak_memory
  end interface

contains

  !> Seconds since some fixed instant.
  real(rk) function wall_clock() result(seconds)
    integer(long) :: ticks, rate
    call system_clock(ticks, rate)
    seconds = real(ticks, rk)/real(rate, rk)
  end function wall_clock

  !> Peak memory of the process so far [MB]; 0 if the system does not report it.
  real(rk) function peak_memory() result(megabytes)
    megabytes = max(real(c_peak_memory(), rk), 0.0_rk)/kilobytes_per_megabyte
  end function peak_memory
end module timer
