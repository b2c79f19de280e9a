!> Calls the user's UEXTERNALDB at the start and end of each increment, if there is one.
module user_increments
  use analysis_state, only: state
  use errors, only: error_type
  use increment_listener, only: listener
  use kinds, only: rk
  use problem_definition, only: problem
  use umat_loader, only: at_increment_end, at_increment_start
  implicit none
  private
  public :: begin_user_increment, end_user_increment

contains

  !> Start of an increment, also after a cutback.
  subroutine begin_user_increment(model, now, size, error)
    type(problem), intent(in) :: model
    type(state), intent(in) :: now !< last converged
    real(rk), intent(in) :: size !< of the increment [s]
    type(error_type), allocatable, intent(out) :: error
    if (.not. associated(model%umat)) return
    call model%umat%call_external(at_increment_start, [now%step_time, now%total_time], size, &
                                  now%step, now%increment + 1, error)
  end subroutine begin_user_increment

  !> End of a converged increment. New notes about the UMAT go to the log.
  subroutine end_user_increment(model, now, results, error)
    type(problem), intent(in) :: model
    type(state), intent(in) :: now !< its end
    class(listener), intent(inout) :: results
    type(error_type), allocatable, intent(out) :: error
    character(:), allocatable :: note
    if (.not. associated(model%umat)) return
    call model%umat%call_external(at_increment_end, [now%step_time, now%total_time], &
                                  now%increment_size, now%step, now%increment, error)
    note = model%umat%new_notes()
    if (len(note) > 0) call results%log%say(note)
  end subroutine end_user_increment
end module user_increments
