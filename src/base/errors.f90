!> The error of the program: a message and the exit code that it leads to.
!>
!> Every procedure that can fail ends with `type(error_type), allocatable, intent(out) :: error`;
!> not allocated means success. Only the main program ends the run.
module errors
  implicit none
  private
  public :: error_type, raise
  public :: analysis_failed, deck_is_wrong, system_failed

  integer, parameter :: analysis_failed = 1 !< exit code: the analysis stopped, results are kept
  integer, parameter :: deck_is_wrong = 2 !< exit code: bad deck or usage
  integer, parameter :: system_failed = 3 !< exit code: disk, memory or program

  type :: error_type
    integer :: exit_code = analysis_failed !< what the program returns to the shell
    character(:), allocatable :: message !< one or more lines
  end type error_type

contains

  !> Makes an error out of a message; `exit_code` is `analysis_failed` unless given.
  pure subroutine raise(error, message, exit_code)
    type(error_type), allocatable, intent(out) :: error !< the new error
    character(*), intent(in) :: message !< what went wrong, and where
    integer, intent(in), optional :: exit_code !< one of the codes above
    allocate (error)
    error%message = message
    if (present(exit_code)) error%exit_code = exit_code
  end subroutine raise
end module errors
