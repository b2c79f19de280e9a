!> The log file holds every line; the ledger adds up.
program test_logging
  use errors, only: error_type, system_failed
  use kinds, only: rk
  use logging, only: run_log
  use testing, only: check, check_close, check_text, test_log
  use timer, only: ledger, peak_memory, wall_clock
  implicit none
  type(test_log) :: log
  log%suite = 'logging'
  call log_file()
  call unwritable_log()
  call full_disk()
  call parts_of_a_run()
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> Quiet or not, the file holds what was said.
  subroutine log_file()
    type(run_log) :: journal
    type(error_type), allocatable :: error
    character(80) :: line
    integer :: unit
    call journal%open(.true., error, 'logging_test.log')
    call check(log,.not. allocated(error), 'opens')
    call journal%say('first')
    call journal%progress('second')
    call journal%note('third')
    call journal%close()
    open (newunit=unit, file='logging_test.log', action='read')
    read (unit, '(a)') line
    call check_text(log, trim(line), 'first', 'said')
    read (unit, '(a)') line
    call check_text(log, trim(line), 'second', 'progress')
    read (unit, '(a)') line
    call check_text(log, trim(line), 'third', 'noted')
    close (unit, status='delete')
  end subroutine log_file

  !> A log that cannot be written is an error of the system.
  subroutine unwritable_log()
    type(run_log) :: journal
    type(error_type), allocatable :: error
    call journal%open(.true., error, 'no_such_folder/x.log')
    call check(log, allocated(error), 'fails')
    if (allocated(error)) call check(log, error%exit_code == system_failed, 'exit code')
    call journal%say('nobody hears this')
    call journal%close()
  end subroutine unwritable_log

  !> A line that the disk does not take is not lost in silence.
  subroutine full_disk()
    type(run_log) :: journal
    type(error_type), allocatable :: error
    call journal%open(.true., error, '/dev/full')
    call check(log,.not. allocated(error), 'the device opens')
    call check(log,.not. journal%has_failed, 'nothing is lost yet')
    call journal%note('nobody reads this')
    call check(log, journal%has_failed, 'a lost line is known')
    call journal%close()
  end subroutine full_disk

  !> Time, calls and memory by part.
  subroutine parts_of_a_run()
    type(ledger) :: book
    real(rk) :: began
    integer :: i
    began = wall_clock()
    do i = 1, 3
      call book%start('factorise', 'solver')
      call book%stop('factorise')
    end do
    call book%stop('factorise')
    call book%stop('never started')
    call book%add_time('read', 'deck', 2.0_rk, 5)
    call book%add_memory('factorise', 'solver', 44.0_rk)
    call check(log, size(book%parts) == 2, 'two parts')
    call check(log, book%parts(1)%num_calls == 3, 'calls')
    call check(log, book%parts(1)%memory >= 44.0_rk, 'memory')
    call check(log, book%parts(1)%wall_time >= 0.0_rk .and. &
               book%parts(1)%wall_time <= wall_clock() - began, 'time')
    call check_close(log, book%parts(2)%wall_time, 2.0_rk, 0.0_rk, 'time measured elsewhere')
    call check(log, peak_memory() > 0.1_rk, 'peak memory')
  end subroutine parts_of_a_run
end program test_logging
