!> One analysis: opens the results, runs the steps, and closes the results even after a failure.
module run_analysis
  use kinds, only: rk
  use errors, only: error_type, raise, system_failed
  use diagnostics, only: diagnostic_list
  use file_system, only: base_name, make_folder
  use ledger_text, only: text_of_ledger
  use run_ledger, only: ledger
  use timer, only: peak_memory, wall_clock
  use write_text, only: as_text
  use problem_definition, only: problem
  use analysis_state, only: state
  use initial_state, only: start_analysis
  use step_loop, only: run_all_steps
  use shared_costs, only: share_costs
  use result_files, only: result_folder
  use cli, only: command_line
  use user_routines, only: end_user_routines
  implicit none
  private
  public :: run_problem

contains

  !> Runs a problem with the options of the command line. After an error the results are readable.
  subroutine run_problem(model, given, remarks, echo, costs, started_at, error)
    type(problem), intent(in) :: model
    type(command_line), intent(in) :: given
    type(diagnostic_list), intent(in) :: remarks !< warnings of the deck
    character(*), intent(in) :: echo !< the deck with its defaults, for the log
    type(ledger), intent(in) :: costs !< open since the start of the program
    real(rk), intent(in) :: started_at !< wall clock [s]
    type(error_type), allocatable, intent(out) :: error
    type(result_folder) :: results
    type(state), allocatable :: now
    type(error_type), allocatable :: failure
    call make_folder(given%folder, error)
    if (allocated(error)) return
    call results%log%open(given%is_quiet, error, &
                          given%folder//'/'//base_name(model%deck_file)//'.log')
    if (allocated(error)) return
    call results%log%note(echo)
    results%costs = costs
    call share_costs(model, costs)
    call results%open(model, given%folder, remarks, error)
    if (allocated(error)) return
    call costs%start('assemble', 'initial state', 'solver')
    call start_analysis(model, now, error)
    call costs%stop()
    if (.not. allocated(error)) call run_all_steps(model, now, results, error)
    call end_user_routines(model, now%total_time, results%log, failure)
    if (allocated(failure) .and. .not. allocated(error)) call move_alloc(failure, error)
    call costs%stop_all()
    if (allocated(error)) then
      call results%log%note(error%message)
      call results%finish(model, now, 'stopped', error%message, failure)
      call results%log%note(text_of_ledger(costs))
    else
      call results%finish(model, now, 'finished', '', failure)
      call results%log%say('finished in '//as_text(wall_clock() - started_at)//' s, '// &
                           as_text(peak_memory())//' MB')
      call results%log%say(text_of_ledger(costs))
    end if
    call results%log%close()
    if (allocated(failure) .and. .not. allocated(error)) call move_alloc(failure, error)
    if (allocated(error) .or. .not. results%log%has_failed) return
    call raise(error, "cannot write the log in '"//given%folder//"' (disk full?)", system_failed)
  end subroutine run_problem
end module run_analysis
