!> The error of the program: a message and the exit code that it leads to.
!>
!> Every procedure that can fail ends with `type(error_type), allocatable, intent(out) :: error`;
!> not allocated means success. Only the main program ends the run.
module errors
  implicit none
  private
  public :: error_type, raise, raise_unwritten, keep_first
  public :: analysis_failed, deck_is_wrong, system_failed

  integer, parameter :: analysis_failed = 1 !< exit code: the analysis stopped, results are kept
  integer, parameter :: deck_is_wrong = 2 !< exit code: bad deck or usage
  integer, parameter :: system_failed = 3 !< exit code: disk, memory or program

  type :: error_type
    integer :: exit_code = analysis_failed !< what the program returns to the shell
    character(:), allocatable :: message !< one or more lines
    logical :: is_of_disk = .false. !< a file of the results could not be written
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

  !> Makes the error of a file that could not be written.
  pure subroutine raise_unwritten(error, path, reason)
    type(error_type), allocatable, intent(out) :: error
    character(*), intent(in) :: path
    character(*), intent(in), optional :: reason !< of the system
    if (present(reason)) then
      call raise(error, "cannot write '"//path//"': "//reason, system_failed)
    else
      call raise(error, "cannot write '"//path//"' (disk full?)", system_failed)
    end if
    error%is_of_disk = .true.
  end subroutine raise_unwritten

  !> Keeps the first of two failures.
  pure subroutine keep_first(error, failure)
    type(error_type), allocatable, intent(inout) :: error, failure
    if (allocated(failure) .and. .not. allocated(error)) call move_alloc(failure, error)
  end subroutine keep_first
end module errors
