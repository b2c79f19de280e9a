!> The program: command line, one analysis, exit code.
program keyway
  use check_deck, only: check_and_report
  use cli, only: command_line, parse_command_line, print_answer
  use, intrinsic :: iso_fortran_env, only: error_unit
  use errors, only: error_type
  implicit none
  type(command_line) :: options
  type(error_type), allocatable :: error
  logical :: is_answered

  call parse_command_line(options, error)
  call end_on(error)
  call print_answer(options, is_answered, error)
  call end_on(error)
  if (is_answered) stop
  call check_and_report(options, error)
  call end_on(error)

contains

  !> Ends the program when there is an error.
  subroutine end_on(error)
    type(error_type), allocatable, intent(in) :: error
    if (.not. allocated(error)) return
    if (len(error%message) > 0) write (error_unit, '(a)') error%message
    select case (error%exit_code)
    case (1)
      stop 1, quiet=.true.
    case (2)
      stop 2, quiet=.true.
    case default
      stop 3, quiet=.true.
    end select
  end subroutine end_on
end program keyway
