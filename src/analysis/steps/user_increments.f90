!> Tells the user's UEXTERNALDB where each increment starts and ends; without one, nothing is done.
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

  !> An increment starts, or starts again with a smaller size.
  subroutine begin_user_increment(scene, now, size, error)
    type(problem), intent(in) :: scene
    type(state), intent(in) :: now !< the last that converged
    real(rk), intent(in) :: size !< of the increment [s]
    type(error_type), allocatable, intent(out) :: error
    if (.not. associated(scene%umat)) return
    call scene%umat%call_external(at_increment_start, [now%step_time, now%total_time], size, &
                                  now%step, now%increment + 1, error)
  end subroutine begin_user_increment

  !> An increment has converged. What was learnt of the UMAT in it goes to the log.
  subroutine end_user_increment(scene, now, results, error)
    type(problem), intent(in) :: scene
    type(state), intent(in) :: now !< its end
    class(listener), intent(inout) :: results
    type(error_type), allocatable, intent(out) :: error
    character(:), allocatable :: note
    if (.not. associated(scene%umat)) return
    call scene%umat%call_external(at_increment_end, [now%step_time, now%total_time], &
                                  now%increment_size, now%step, now%increment, error)
    note = scene%umat%new_notes()
    if (len(note) > 0) call results%log%say(note)
  end subroutine end_user_increment
end module user_increments
