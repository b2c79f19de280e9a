!> The listener that writes all results of a run into one folder.
!>
!> Order of use: `prepare`; `open`, or `load` and `go_on` from a checkpoint; the calls of the
!> solvers; `finish` (also after a failure).
module result_files
  use kinds, only: rk
  use errors, only: error_type, keep_first, raise, raise_unwritten
  use diagnostics, only: diagnostic_list
  use timer, only: wall_clock
  use write_text, only: as_text
  use problem_definition, only: problem
  use analysis_state, only: state, vibration_mode
  use increment_listener, only: listener
  use run_progress, only: progress_clock
  use goal_errors, only: find_stiffening, note_duals, note_motion_errors
  use run_records, only: run_record
  use run_summaries, only: run_summary
  use result_writer, only: is_due, starts_analysis
  use requested_fields, only: needs_nodes
  use missing_results, only: warn_of_missing
  use writer_catalogue, only: writer_item, list_writers
  use summary_json, only: write_summary
  use input_files, only: inputs_of, refuse_inputs
  use sha256, only: digest_of_file
  use earlier_files, only: mark_summary, remove_earlier_files
  use file_identity, only: add_path, file_path
  use file_system, only: base_name
  use stop_signals, only: is_asked_to_stop, name_of_signal
  use checkpoint_moments, only: ends_here, is_checkpoint_due, text_after_modes, text_of_end
  use checkpoint_files, only: list_checkpoint_files, remove_checkpoints, restore_results, &
                              return_to_old
  use run_checkpoint, only: label_of, load_checkpoint, restart_journals, run_position, &
                            save_checkpoint
  implicit none
  private
  public :: result_folder

  real(rk), parameter :: seconds_between_summaries = 5.0_rk

  type, extends(listener) :: result_folder
    type(run_summary) :: summary
    type(run_record) :: record
    character(:), allocatable :: stem !< folder and name of the job
    logical, private :: is_open = .false., has_unwritten_envelopes = .false.
    type(progress_clock) :: clock
    real(rk), private :: summarised_at = 0.0_rk !< wall clock [s]
    integer, private :: num_warnings_printed = 0, num_checkpoints = 0
    integer, private :: last_ended = -1 !< step whose end is the last checkpoint, -1: another moment
    logical :: is_from_old = .false. !< the last checkpoint is damaged
    type(writer_item), allocatable, private :: writers(:)
  contains
    procedure :: prepare, load, go_on
    procedure :: open => open_results
    procedure :: increment_done, increment_dropped, wants_motion, wants_checkpoint, modes_found
    procedure :: weigh_modes
    procedure :: finish
    procedure, private :: start_step, keep_or_stop, keep
    procedure, private :: write_increment, write_last, write_envelopes
    procedure, private :: print_warnings
    procedure, private :: summarise
  end type result_folder

contains

  !> Prepares the results in memory. Fails where a file that was read would be written over; nothing
  !> is written.
  subroutine prepare(self, model, folder, remarks, error)
    class(result_folder), intent(inout) :: self
    type(problem), intent(in) :: model
    character(*), intent(in) :: folder
    type(diagnostic_list), intent(in) :: remarks !< warnings of the deck
    type(error_type), allocatable, intent(out) :: error
    type(file_path), allocatable :: paths(:)
    integer :: w
    call self%costs%start('open', 'results', 'output')
    self%summary%remarks = remarks
    self%summary%message = ''
    self%summary%deck_digest = digest_of_file(model%deck_file)
    allocate (self%summary%steps(0))
    self%stem = folder//'/'//base_name(model%deck_file)
    call self%record%open(model)
    call list_writers(self%writers)
    allocate (paths(0))
    call add_path(paths, self%stem//'.json')
    call add_path(paths, self%stem//'.log')
    call add_path(paths, self%stem//'.lock')
    call list_checkpoint_files(self%stem, paths)
    do w = 1, size(self%writers)
      call self%writers(w)%item%list_paths(model, self%stem, self%record, paths)
    end do
    call refuse_inputs(model, paths, error)
    call self%costs%stop()
  end subroutine prepare

  !> Opens all files of a new run, and removes those of an earlier one.
  subroutine open_results(self, model, error)
    class(result_folder), intent(inout) :: self
    type(problem), intent(in) :: model
    type(error_type), allocatable, intent(out) :: error
    integer :: w
    call self%costs%start('open', 'results', 'output')
    call remove_earlier_files(self%stem, inputs_of(model))
    call remove_checkpoints(self%stem)
    do w = 1, size(self%writers)
      call self%writers(w)%item%open(model, self%stem, self%record, error)
      if (allocated(error)) exit
    end do
    self%is_open = .not. allocated(error)
    call self%costs%stop()
    if (self%is_open) call self%summarise(model, error)
  end subroutine open_results

  !> Loads the checkpoint of the run that is to go on. Changes no file.
  subroutine load(self, model, now, remark, error)
    class(result_folder), intent(inout) :: self
    type(problem), intent(in) :: model
    type(state), allocatable, intent(inout) :: now !< as `start_analysis` makes it; then as saved
    character(:), allocatable, intent(out) :: remark !< '' or why an older checkpoint is used
    type(error_type), allocatable, intent(out) :: error
    type(run_position) :: fresh, found
    fresh%now = now
    fresh%record = self%record
    fresh%summary = self%summary
    call load_checkpoint(self%stem, model, fresh, self%writers, found, remark, error)
    if (allocated(error)) return
    call move_alloc(found%now, now)
    self%record = found%record
    self%summary = found%summary
    self%num_checkpoints = found%number
    self%last_ended = merge(now%step, -1, now%is_last_of_step)
    self%is_from_old = found%is_old
    self%num_warnings_printed = found%num_warnings
    self%has_unwritten_envelopes = .not. now%is_last_of_step .and. now%step == self%record%step &
                                   .and. size(self%record%active) > 0
  end subroutine load

  !> Sets all files back to the checkpoint that was loaded, and opens them.
  subroutine go_on(self, model, error)
    class(result_folder), intent(inout) :: self
    type(problem), intent(in) :: model
    type(error_type), allocatable, intent(out) :: error
    integer :: w
    call self%costs%start('open', 'results', 'output')
    call restore_results(self%stem, self%num_checkpoints, error)
    if (self%is_from_old .and. .not. allocated(error)) call return_to_old(self%stem)
    do w = 1, size(self%writers)
      if (allocated(error)) exit
      call self%writers(w)%item%go_on(model, self%stem, self%record, error)
    end do
    self%is_open = .not. allocated(error)
    if (self%is_open) call restart_journals(self%stem, self%num_checkpoints, model, self%record, &
                                            self%writers, error)
    call self%costs%stop()
    if (allocated(error)) return
    call warn_of_missing(self%stem, self%writers, self%record)
    call self%summarise(model, error)
  end subroutine go_on

  !> Records, writes and logs a converged increment.
  subroutine increment_done(self, model, now, error)
    class(result_folder), intent(inout) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(error_type), allocatable, intent(out) :: error
    if (now%step /= self%record%step) call self%start_step(model, now%step)
    call self%clock%note(model, now)
    call self%costs%start('recover', 'extremes', 'output')
    call self%record%note(model, now, self%costs)
    call note_motion_errors(self%time_error, self%opening_error, self%mesh_error, self%record%goals)
    call note_duals(model, now, self%costs, self%duals, self%record%stresses, self%record%goals)
    self%has_unwritten_envelopes = size(self%record%active) > 0
    call self%summary%note(now)
    call self%costs%stop()
    call self%write_increment(model, now, error)
    if (allocated(error)) return
    if (now%is_last_of_step) call self%write_envelopes(model, error)
    if (allocated(error)) return
    call self%record%stresses%free_points()
    call self%costs%start('write', 'log', 'output')
    if (now%increment > 0 .or. starts_analysis(now)) then
      call self%clock%show(model, now, self%record, self%log)
    end if
    call self%print_warnings()
    call self%costs%stop()
    if (self%log%has_failed) call raise_unwritten(error, self%stem//'.log')
    if (allocated(error)) return
    if (wall_clock() - self%summarised_at > seconds_between_summaries) then
      call self%summarise(model, error)
    end if
    if (.not. allocated(error)) call self%keep_or_stop(model, now, error)
  end subroutine increment_done

  logical function wants_motion(self, model, now)
    class(result_folder), intent(in) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    wants_motion = is_asked_to_stop() .or. needs_nodes(model, now, self%record)
  end function wants_motion

  logical function wants_checkpoint(self, model, now)
    class(result_folder), intent(in) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    wants_checkpoint = is_checkpoint_due(model, now)
  end function wants_checkpoint

  !> Writes a checkpoint where one is due, and ends the run where a signal asks to stop.
  subroutine keep_or_stop(self, model, now, error)
    class(result_folder), intent(inout) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(error_type), allocatable, intent(out) :: error
    logical :: is_stop
    if (.not. is_checkpoint_due(model, now)) return
    is_stop = ends_here(model, now, allocated(self%whole_motion))
    if (.not. (is_stop .or. is_due(now, model%steps(now%step)%checkpoint_frequency))) return
    call self%keep(model, now, error)
    if (is_stop .and. .not. allocated(error)) call raise(error, text_of_end(model, now))
  end subroutine keep_or_stop

  !> Writes a checkpoint.
  subroutine keep(self, model, now, error)
    class(result_folder), intent(inout) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(error_type), allocatable, intent(out) :: error
    call self%costs%start('write', 'checkpoint', 'output')
    self%num_checkpoints = self%num_checkpoints + 1
    call save_checkpoint(label_of(self%stem, self%num_checkpoints), model, now, &
                         self%record, self%summary, self%writers, error, self%whole_motion)
    self%last_ended = merge(now%step, -1, now%is_last_of_step)
    call self%costs%stop()
  end subroutine keep

  !> A signal has ended the increment after `now`: writes the checkpoint, and ends the run. A
  !> checkpoint of the end of the step before is kept: a continued run may change the step.
  subroutine increment_dropped(self, model, now, error)
    class(result_folder), intent(inout) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now !< as it was accepted
    type(error_type), allocatable, intent(out) :: error
    character(:), allocatable :: place
    if (now%increment > 0 .or. self%last_ended /= now%step - 1) call self%keep(model, now, error)
    if (allocated(error)) return
    place = 'after increment '//as_text(now%increment)
    if (now%increment == 0) place = 'at the start'
    call raise(error, 'stopped by '//name_of_signal()//' '//place//" of step '"// &
               model%steps(now%step)%name//"', time "//as_text(now%total_time)// &
               '; the next increment is dropped; keyway --continue goes on from here')
  end subroutine increment_dropped

  !> Calls every writer, each with its line in the ledger.
  subroutine write_increment(self, model, now, error)
    class(result_folder), intent(inout) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(error_type), allocatable, intent(out) :: error
    integer :: w
    do w = 1, size(self%writers)
      associate (part => self%writers(w))
        if (part%item%is_idle) cycle
        call self%costs%start('write', part%label, 'output')
        call part%item%write_increment(model, now, self%record, error)
        call self%costs%stop()
      end associate
      if (allocated(error)) return
    end do
  end subroutine write_increment

  !> Writes the last increment for requests that have not written it, when a run stops in a step.
  subroutine write_last(self, model, now, error)
    class(result_folder), intent(inout) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(error_type), allocatable, intent(out) :: error
    type(state) :: last
    if (now%step /= self%record%step .or. now%increment == 0 .or. now%is_last_of_step) return
    last = now
    last%is_stop = .true.
    call self%write_increment(model, last, error)
  end subroutine write_last

  !> A *FREQUENCY step has found its modes.
  subroutine modes_found(self, model, step, modes, error)
    class(result_folder), intent(inout) :: self
    type(problem), intent(in) :: model
    integer, intent(in) :: step
    type(vibration_mode), intent(in) :: modes(:)
    type(error_type), allocatable, intent(out) :: error
    integer :: i, w
    call self%start_step(model, step)
    call self%summary%note_modes(modes)
    do i = 1, size(modes)
      call self%log%say('step '//as_text(step)//'  mode '//as_text(i)//'  '// &
                        as_text(modes(i)%hz)//' Hz')
    end do
    do w = 1, size(self%writers)
      if (self%writers(w)%item%is_idle) cycle
      call self%costs%start('write', self%writers(w)%label, 'output')
      call self%writers(w)%item%write_modes(model, step, modes, self%record, error)
      call self%costs%stop()
      if (allocated(error)) return
    end do
    call self%summarise(model, error)
    if (allocated(error) .or. step == size(model%steps)) return
    if (is_asked_to_stop()) call raise(error, text_after_modes(model%steps(step)%name))
  end subroutine modes_found

  !> The error of the mesh in each mode.
  subroutine weigh_modes(self, model, shape, stiffening)
    class(result_folder), intent(inout) :: self
    type(problem), intent(in) :: model
    real(rk), intent(in) :: shape(:, :, :) !< (3, nodes, modes)
    real(rk), allocatable, intent(out) :: stiffening(:) !< (modes) [1/s2], see `find_stiffening`
    call find_stiffening(model, self%record%stresses, shape, stiffening)
  end subroutine weigh_modes

  !> A step begins.
  subroutine start_step(self, model, step)
    class(result_folder), intent(inout) :: self
    type(problem), intent(in) :: model
    integer, intent(in) :: step
    call self%costs%start('open', 'results', 'output')
    call self%record%begin_step(model, step)
    call self%summary%begin_step(model, step)
    call self%costs%stop()
  end subroutine start_step

  !> Writes the envelopes of the step, once.
  subroutine write_envelopes(self, model, error)
    class(result_folder), intent(inout) :: self
    type(problem), intent(in) :: model
    type(error_type), allocatable, intent(out) :: error
    integer :: w
    if (.not. self%has_unwritten_envelopes) return
    self%has_unwritten_envelopes = .false.
    do w = 1, size(self%writers)
      if (self%writers(w)%item%is_idle) cycle
      call self%costs%start('write', self%writers(w)%label, 'output')
      call self%writers(w)%item%write_envelopes(model, self%record, error)
      call self%costs%stop()
      if (allocated(error)) return
    end do
  end subroutine write_envelopes

  !> Completes all files that can be written at the end of a run; returns the first failure. After a
  !> failure the summary says that the run has stopped, whatever the status was.
  subroutine finish(self, model, now, status, message, error)
    class(result_folder), intent(inout) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now !< the last state reached
    character(*), intent(in) :: status !< 'finished' or 'stopped'
    character(*), intent(in) :: message !< why it stopped; '' when it finished
    type(error_type), allocatable, intent(out) :: error
    type(error_type), allocatable :: failure
    integer :: w
    if (.not. self%is_open) return
    self%is_open = .false.
    self%summary%status = status
    self%summary%message = message
    if (status == 'stopped') call self%write_last(model, now, error)
    call self%write_envelopes(model, failure)
    call keep_first(error, failure)
    do w = 1, size(self%writers)
      if (self%writers(w)%item%is_idle) cycle
      call self%costs%start('write', self%writers(w)%label, 'output')
      call self%writers(w)%item%write_costs(self%costs)
      call self%writers(w)%item%finish(failure)
      call keep_first(error, failure)
      call self%costs%stop()
    end do
    call self%print_warnings()
    call self%summarise(model, failure)
    call keep_first(error, failure)
    if (.not. allocated(error)) return
    if (message == '') call mark_summary(self%stem//'.json', error%message)
    if (message /= '') call mark_summary(self%stem//'.json', message)
  end subroutine finish

  !> Prints the new warnings of the run.
  subroutine print_warnings(self)
    class(result_folder), intent(inout) :: self
    integer :: i
    do i = self%num_warnings_printed + 1, size(self%record%warnings)
      call self%log%say('warning: '//self%record%warnings(i)%text)
    end do
    self%num_warnings_printed = size(self%record%warnings)
  end subroutine print_warnings

  !> Writes job.json.
  subroutine summarise(self, model, error)
    class(result_folder), intent(inout) :: self
    type(problem), intent(in) :: model
    type(error_type), allocatable, intent(out) :: error
    call self%costs%start('write', 'JSON', 'output')
    call write_summary(self%stem//'.json', model, self%summary, self%record, self%costs, error)
    call self%costs%stop()
    self%summarised_at = wall_clock()
  end subroutine summarise
end module result_files
