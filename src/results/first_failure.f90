!> What remains of several failures at the end of a run: the first.
module first_failure
  use errors, only: error_type
  implicit none
  private
  public :: keep_first

contains

  !> Keeps the first of two failures.
  subroutine keep_first(error, failure)
    type(error_type), allocatable, intent(inout) :: error, failure
    if (allocated(failure) .and. .not. allocated(error)) call move_alloc(failure, error)
  end subroutine keep_first
end module first_failure
