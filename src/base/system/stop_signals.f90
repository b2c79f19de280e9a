!> Signals that ask a run to stop: Ctrl-C, the end of a job's time, the limit of file sizes.
module stop_signals
  use, intrinsic :: iso_c_binding, only: c_char, c_int, c_null_char
  implicit none
  private
  public :: catch_signals, outlive_signal, take_signal, stop_signal, is_asked_to_stop
  public :: name_of_signal, has_met_file_limit

  interface
    !> Catches signals; a crash marks the summary at `path` (system_calls.c).
    subroutine c_catch_signals(path) bind(c, name='keyway_catch_signals')
      import :: c_char
      implicit none
      ! allow(assumed-size)
      character(kind=c_char), intent(in) :: path(*)
    end subroutine c_catch_signals

    !> From now on the first signal that asks to stop does not end this process; a second one does.
    !> The process that has the results ends the run after its increment.
    subroutine outlive_signal() bind(c, name='keyway_outlive_signal')
      implicit none
    end subroutine outlive_signal

    !> The first signal that has arrived, 0 for none.
    function c_stop_signal() result(number) bind(c, name='keyway_stop_signal')
      import :: c_int
      implicit none
      integer(c_int) :: number
    end function c_stop_signal

    !> A signal that has asked another process of the run to stop; 0 for none.
    subroutine take_signal(number) bind(c, name='keyway_take_signal')
      import :: c_int
      implicit none
      integer(c_int), value :: number
    end subroutine take_signal

    !> Not 0 when a write has met the limit of file sizes.
    function c_has_met_limit() result(answer) bind(c, name='keyway_has_met_limit')
      import :: c_int
      implicit none
      integer(c_int) :: answer
    end function c_has_met_limit
  end interface

contains

  !> From now on a signal asks the run to stop after its increment; a second signal ends the program
  !> at once. A crash marks the summary of the run as stopped.
  subroutine catch_signals(summary)
    character(*), intent(in) :: summary !< path of job.json; '' after the end of the run
    call c_catch_signals(summary//c_null_char)
  end subroutine catch_signals

  !> The first signal that has asked the run to stop, 0 for none.
  integer function stop_signal() result(number)
    number = int(c_stop_signal())
  end function stop_signal

  !> Whether a signal has asked the run to stop.
  logical function is_asked_to_stop()
    is_asked_to_stop = c_stop_signal() /= 0
  end function is_asked_to_stop

  !> The signal that asked to stop, as users name it.
  function name_of_signal() result(name)
    character(:), allocatable :: name
    character(12) :: digits
    integer, parameter :: hang_up = 1, interrupt = 2, terminate = 15, time_limit = 24 ! of Linux
    select case (c_stop_signal())
    case (interrupt)
      name = 'SIGINT (Ctrl-C)'
    case (terminate)
      name = 'SIGTERM'
    case (hang_up)
      name = 'SIGHUP'
    case (time_limit)
      name = 'SIGXCPU (limit of processor time)'
    case default
      write (digits, '(i0)') c_stop_signal()
      name = 'signal '//trim(digits)
    end select
  end function name_of_signal

  !> Whether a file has met the limit of file sizes (ulimit -f).
  logical function has_met_file_limit()
    has_met_file_limit = c_has_met_limit() /= 0
  end function has_met_file_limit
end module stop_signals
