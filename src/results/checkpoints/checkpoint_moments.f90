!> After which increments a checkpoint is due, and where a signal ends the run.
module checkpoint_moments
  use analysis_state, only: state
  use problem_definition, only: problem
  use result_writer, only: is_due
  use stop_signals, only: is_asked_to_stop, name_of_signal
  use write_text, only: as_text
  implicit none
  private
  public :: is_checkpoint_due, ends_here, text_of_end, text_after_modes

contains

  !> Whether *RESTART or a signal asks for a checkpoint. At the start of a step a signal waits for
  !> the first increment.
  logical function is_checkpoint_due(model, now) result(due)
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    due = .false.
    if (now%increment == 0) return
    due = is_asked_to_stop() .or. is_due(now, model%steps(now%step)%checkpoint_frequency)
  end function is_checkpoint_due

  !> Whether a signal ends the run after an increment whose motion is complete. At the end of the
  !> analysis the run is over in any case.
  logical function ends_here(model, now, has_motion) result(ends)
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    logical, intent(in) :: has_motion !< of all ranks, where vectors are divided
    ends = is_asked_to_stop() .and. .not. now%motion%modal%lacks_unknowns()
    if (now%is_last_of_step .and. now%step == size(model%steps)) ends = .false.
    if (allocated(model%mesh%is_node_here)) ends = ends .and. has_motion
  end function ends_here

  !> Why the run ends after an increment, and how it goes on.
  function text_of_end(model, now) result(text)
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    character(:), allocatable :: text
    text = 'stopped by '//name_of_signal()//' after increment '//as_text(now%increment)// &
           " of step '"//model%steps(now%step)%name//"', time "//as_text(now%total_time)// &
           '; keyway --continue goes on from here'
  end function text_of_end

  !> The same after a step that finds modes, which has no checkpoint.
  function text_after_modes(step) result(text)
    character(*), intent(in) :: step !< its name
    character(:), allocatable :: text
    text = 'stopped by '//name_of_signal()//" after step '"//step// &
           "'; keyway --continue goes on from the last checkpoint, if there is one"
  end function text_after_modes
end module checkpoint_moments
