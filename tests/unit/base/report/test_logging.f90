!> The log file holds every line but those on progress.
program test_logging
  use errors, only: error_type, system_failed
  use logging, only: run_log
  use testing, only: check, check_text, test_log
  implicit none
  type(test_log) :: log
  log%suite = 'logging'
  call log_file()
  call unwritable_log()
  call full_disk()
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
    call journal%progress('for the reader of stderr alone')
    call journal%note('third')
    call journal%close()
    open (newunit=unit, file='logging_test.log', action='read')
    read (unit, '(a)') line
    call check_text(log, trim(line), 'first', 'said')
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
end program test_logging
