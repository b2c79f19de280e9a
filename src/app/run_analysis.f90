!> One analysis: opens the results, runs the steps, and closes the results even after a failure.
module run_analysis
  use kinds, only: rk
  use errors, only: error_type, keep_first, raise_unwritten
  use diagnostic_text, only: remarks_for_log
  use diagnostics, only: diagnostic_list
  use disk_advice, only: explain_failed_write
  use divided_run, only: chosen_checkpoint
  use earlier_files, only: mark_summary
  use file_system, only: make_folder
  use run_lock, only: job_lock
  use stop_signals, only: catch_signals
  use ledger_text, only: text_of_ledger
  use rank_balance, only: gather_balance
  use ranks, only: num_ranks, share_error
  use run_ledger, only: ledger
  use timer, only: peak_memory, wall_clock
  use write_text, only: as_text
  use problem_definition, only: problem
  use analysis_state, only: state
  use initial_state, only: start_analysis
  use step_loop, only: run_all_steps
  use shared_costs, only: share_costs
  use result_files, only: result_folder
  use checkpoint_files, only: has_checkpoint
  use cli, only: command_line
  use model_summary, only: summary_of_joints
  use run_closing, only: closing_lines
  use user_routines, only: close_user_routines, end_user_routines
  implicit none
  private
  public :: run_problem

contains

  !> Runs a problem with the options of the command line. After an error the results are readable.
  subroutine run_problem(model, given, remarks, echo, costs, started_at, lock, error)
    type(problem), intent(inout) :: model
    type(command_line), intent(in) :: given
    type(diagnostic_list), intent(in) :: remarks !< warnings of the deck
    character(*), intent(in) :: echo !< the deck with its defaults, for the log
    type(ledger), intent(in) :: costs !< open since the start of the program
    real(rk), intent(in) :: started_at !< wall clock [s]
    type(job_lock), intent(inout) :: lock !< taken already where there is a UMAT
    type(error_type), allocatable, intent(out) :: error
    type(result_folder) :: results
    results%costs = costs
    call results%clock%open(started_at)
    call share_costs(model, costs)
    call results%prepare(model, given%folder, remarks, error)
    if (.not. allocated(error)) call make_folder(given%folder, error)
    if (.not. allocated(error)) call lock%take(results%stem//'.lock', error)
    if (allocated(error)) then
      call explain_failed_write(error, results%stem, given%is_continued)
      call share_error(error)
      call close_user_routines(model)
      return
    end if
    call run_alone(model, given, echo, costs, started_at, lock%earlier, results, error)
    call catch_signals('')
  end subroutine run_problem

  !> Opens the results, runs the steps and closes the results.
  subroutine run_alone(model, given, echo, costs, started_at, earlier, results, error)
    type(problem), intent(inout) :: model
    type(command_line), intent(in) :: given
    character(*), intent(in) :: echo
    type(ledger), intent(in) :: costs
    real(rk), intent(in) :: started_at !< wall clock [s]
    character(*), intent(in) :: earlier !< process whose run of the job did not end, '' for none
    type(result_folder), intent(inout) :: results
    type(error_type), allocatable, intent(out) :: error
    type(state), allocatable :: now
    type(error_type), allocatable :: failure
    call open_run(model, given, echo, earlier, costs, results, now, error)
    call share_error(error)
    if (allocated(error)) then
      call close_user_routines(model)
      call explain_failed_write(error, results%stem, given%is_continued)
      call mark_unopened(results%stem, given%is_continued)
      return
    end if
    if (.not. allocated(now)) then
      call costs%start('assemble', 'initial state', 'solver')
      call start_analysis(model, now, error)
      call costs%stop()
    end if
    if (.not. allocated(error)) call run_all_steps(model, now, results, error)
    call share_error(error)
    if (.not. allocated(error) .and. allocated(model%mesh%rank_of_element)) then
      call gather_balance(costs, model%mesh%rank_of_element, results%summary%balance)
    end if
    call end_user_routines(model, now%total_time, results%log, failure)
    call keep_first(error, failure)
    call costs%stop_all()
    if (allocated(error)) then
      call explain_failed_write(error, results%stem, .true.)
      call results%log%note(error%message)
      call results%summary%note_stop(model, now)
      call results%finish(model, now, 'stopped', error%message, failure)
      call close_stopped_log(model, now, costs, results)
    else
      call results%finish(model, now, 'finished', '', failure)
      call results%log%say(closing_lines(model, results%summary, results%record, costs))
      call results%log%say('finished in '//as_text(wall_clock() - started_at)//' s, '// &
                           as_text(peak_memory())//' MB')
      if (num_ranks() > 1) call results%log%say(results%summary%balance%lines())
      call results%log%say(text_of_ledger(costs))
    end if
    call results%log%close()
    if (allocated(error)) return
    if (results%log%has_failed .and. .not. allocated(failure)) then
      call raise_unwritten(failure, results%stem//'.log')
    end if
    if (.not. allocated(failure)) return
    call move_alloc(failure, error)
    call explain_failed_write(error, results%stem, .true.)
    call mark_summary(results%stem//'.json', error%message)
  end subroutine run_alone

  !> What a run that stopped has found, and its costs. They are on the screen, too, where it has
  !> found something; the reason comes after them.
  subroutine close_stopped_log(model, now, costs, results)
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(ledger), intent(in) :: costs
    type(result_folder), intent(inout) :: results
    character(:), allocatable :: found
    found = closing_lines(model, results%summary, results%record, costs)
    if (results%record%displacement%at(1)%is_found) then
      call results%log%say('the run stopped at time '//as_text(now%total_time)// &
                           ', after these'//new_line('a')//found)
    else
      call results%log%note(found)
    end if
    call results%log%note(text_of_ledger(costs))
  end subroutine close_stopped_log

  !> The summary of an earlier run in the folder, when a run could not open its results.
  subroutine mark_unopened(stem, is_continued)
    character(*), intent(in) :: stem !< folder and name of the job
    logical, intent(in) :: is_continued
    if (is_continued) then
      call mark_summary(stem//'.json', 'the run was killed, and keyway --continue could not '// &
                        'go on with it', only_running=.true.)
    else
      call mark_summary(stem//'.json', 'a later run could not open its results; some files of '// &
                        'this run are removed')
    end if
  end subroutine mark_unopened

  !> Opens log and results, of a new run or of one that goes on.
  subroutine open_run(model, given, echo, earlier, costs, results, now, error)
    type(problem), intent(in) :: model
    type(command_line), intent(in) :: given
    character(*), intent(in) :: echo
    character(*), intent(in) :: earlier
    type(ledger), intent(in) :: costs
    type(result_folder), intent(inout) :: results
    type(state), allocatable, intent(out) :: now !< of the checkpoint; not allocated in a new run
    type(error_type), allocatable, intent(out) :: error
    character(:), allocatable :: remark
    logical :: is_old
    if (given%is_continued) then
      call costs%start('assemble', 'initial state', 'solver')
      call start_analysis(model, now, error)
      call costs%stop()
      if (.not. allocated(error)) call results%load(model, now, remark, error)
      call share_error(error)
      if (allocated(error)) return
      is_old = chosen_checkpoint(results%is_from_old)
      call share_error(error) ! of the other ranks, before files are set back
      if (allocated(error)) return
    end if
    call catch_signals(results%stem//'.json')
    call results%log%open(given%is_quiet, error, results%stem//'.log', given%is_continued)
    if (allocated(error)) return
    call results%log%note(echo//remarks_for_log(results%summary%remarks))
    if (size(model%joints) > 0) call results%log%note(summary_of_joints(model))
    if (earlier /= '') then
      call results%log%say('the earlier run of this job (process and host: '//earlier// &
                           ') was killed')
    end if
    if (.not. given%is_continued) then
      if (has_checkpoint(results%stem)) then
        call results%log%say('the checkpoint of an earlier run of this job is removed, because '// &
                             'this run starts from the beginning (without --continue)')
      end if
      call results%open(model, error)
      return
    end if
    if (remark /= '') call results%log%say('warning: '//remark// &
                                           '; the checkpoint before it is used')
    call results%log%say('goes on from increment '//as_text(now%increment)//" of step '"// &
                         model%steps(now%step)%name//"', time "//as_text(now%total_time))
    call results%go_on(model, error)
  end subroutine open_run
end module run_analysis
