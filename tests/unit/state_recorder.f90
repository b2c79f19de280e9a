!> A listener that keeps every state of a run.
module state_recorder
  use errors, only: error_type
  use problem_definition, only: problem
  use analysis_state, only: state
  use row_model, only: recorder
  implicit none
  private
  public :: recorder_of_states

  !> Keeps all states.
  type, extends(recorder) :: recorder_of_states
    type(state), allocatable :: states(:)
  contains
    procedure :: increment_done => keep_state
  end type recorder_of_states

contains

  !> Keeps a copy.
  subroutine keep_state(self, model, now, error)
    class(recorder_of_states), intent(inout) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(error_type), allocatable, intent(out) :: error
    type(state), allocatable :: longer(:)
    integer :: n
    n = 0
    if (allocated(self%states)) n = size(self%states)
    allocate (longer(n + 1))
    if (n > 0) longer(:n) = self%states
    longer(n + 1) = now
    call move_alloc(longer, self%states)
    if (size(model%steps) == 0) allocate (error)
  end subroutine keep_state
end module state_recorder
