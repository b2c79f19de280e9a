!> A checkpoint of a run: the state, the record, the summary, and where the files of results end.
module run_checkpoint
  use analysis_state, only: motion, state
  use checkpoint_files, only: checkpoint_path, new_checkpoint_path, new_journal_path, &
                              keep_checkpoint, keep_journal, take_journal
  use checkpoint_faces, only: renew_faces, save_faces
  use checkpoint_identity, only: check_identity, save_identity
  use errors, only: deck_is_wrong, error_type, keep_first, raise, system_failed
  use hdf5_archive, only: hdf5_store
  use problem_definition, only: problem
  use record_archive, only: load_record, save_record
  use run_records, only: run_record
  use run_summaries, only: run_summary
  use state_archive, only: load_state, save_state
  use summary_archive, only: load_summary, save_summary
  use whole_files, only: remove_file
  use write_text, only: as_text
  use writer_catalogue, only: writer_item
  implicit none
  private
  public :: run_position, label_of, save_checkpoint, load_checkpoint
  public :: load_chosen_state, restart_journals

  !> Where a checkpoint is written, and its number in the run.
  type :: checkpoint_label
    character(:), allocatable :: stem !< folder and name of the job
    integer :: number = 0 !< from 1
  end type checkpoint_label

  !> What a checkpoint stores of a run.
  type :: run_position
    type(state), allocatable :: now
    type(run_record) :: record
    type(run_summary) :: summary
    integer :: num_warnings = 0 !< of the record in the checkpoint
    integer :: number = 0 !< of the checkpoint, from 1
    logical :: is_old = .false. !< it is the one before the last
  end type run_position

contains

  !> The label of a checkpoint. With its constructor as an argument gfortran 12 spoils memory.
  function label_of(stem, number) result(label)
    character(*), intent(in) :: stem !< folder and name of the job
    integer, intent(in) :: number !< from 1
    type(checkpoint_label) :: label
    label%stem = stem
    label%number = number
  end function label_of

  !> Writes the checkpoint, and starts the journal of what later writes replace in job.h5.
  subroutine save_checkpoint(label, model, now, record, summary, writers, error, whole)
    type(checkpoint_label), intent(in) :: label
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(run_record), intent(in) :: record
    type(run_summary), intent(in) :: summary
    type(writer_item), intent(inout) :: writers(:)
    type(error_type), allocatable, intent(out) :: error
    type(motion), intent(in), optional :: whole !< of all ranks, where vectors are divided
    type(error_type), allocatable :: failure
    type(hdf5_store) :: file
    call file%create(new_checkpoint_path(label%stem))
    call file%put('number', label%number)
    call file%put('step', now%step)
    call save_identity(model, file)
    call save_faces(record%skin, file)
    call save_state(now, file, error, whole)
    if (.not. allocated(error)) call save_record(record, file, error)
    if (.not. allocated(error)) call save_summary(summary, file, error)
    if (.not. allocated(error)) call save_positions(writers, file, error)
    call file%close(failure)
    call keep_first(error, failure)
    if (.not. allocated(error)) call start_journals(label%stem, label%number, writers, error)
    if (.not. allocated(error)) call keep_checkpoint(label%stem, error)
    if (.not. allocated(error)) call keep_journal(label%stem, error)
    if (allocated(error)) call remove_file(new_checkpoint_path(label%stem))
  end subroutine save_checkpoint

  !> Starts the journal of the last checkpoint anew, when a run goes on from there. Then what has
  !> changed in the model is written.
  subroutine restart_journals(stem, number, model, record, writers, error)
    character(*), intent(in) :: stem
    integer, intent(in) :: number !< of the checkpoint
    type(problem), intent(in) :: model
    type(run_record), intent(in) :: record
    type(writer_item), intent(inout) :: writers(:)
    type(error_type), allocatable, intent(out) :: error
    integer :: w
    call start_journals(stem, number, writers, error)
    if (.not. allocated(error)) call take_journal(stem, error)
    do w = 1, size(writers)
      if (allocated(error)) return
      if (.not. writers(w)%item%is_idle) call writers(w)%item%renew(model, record, error)
    end do
  end subroutine restart_journals

  !> Starts the journal of a checkpoint, under another name than that of the last one.
  subroutine start_journals(stem, number, writers, error)
    character(*), intent(in) :: stem
    integer, intent(in) :: number !< of the checkpoint
    type(writer_item), intent(inout) :: writers(:)
    type(error_type), allocatable, intent(out) :: error
    integer :: w
    do w = 1, size(writers)
      if (writers(w)%item%is_idle) cycle
      call writers(w)%item%start_undo(new_journal_path(stem), number, error)
      if (allocated(error)) return
    end do
  end subroutine start_journals

  !> Stores where the files of all writers end.
  subroutine save_positions(writers, file, error)
    type(writer_item), intent(inout) :: writers(:)
    type(hdf5_store), intent(inout) :: file
    type(error_type), allocatable, intent(out) :: error
    integer :: w
    do w = 1, size(writers)
      call file%open_group('writer_'//as_text(w))
      call file%put('is_idle', writers(w)%item%is_idle)
      if (.not. writers(w)%item%is_idle) call writers(w)%item%save_position(file, error)
      call file%close_group()
      if (allocated(error)) return
    end do
    call file%report(error)
  end subroutine save_positions

  !> Loads the last checkpoint; when it is damaged, the one before. No file is changed.
  subroutine load_checkpoint(stem, model, fresh, writers, found, remark, error)
    character(*), intent(in) :: stem !< folder and name of the job
    type(problem), intent(in) :: model
    type(run_position), intent(in) :: fresh !< the start of the analysis, which fixes sizes
    type(writer_item), intent(inout) :: writers(:)
    type(run_position), intent(out) :: found
    character(:), allocatable, intent(out) :: remark !< '' or why the last one was not used
    type(error_type), allocatable, intent(out) :: error
    type(error_type), allocatable :: failure
    logical :: is_there(2)
    integer :: i
    remark = ''
    do i = 1, 2
      inquire (file=checkpoint_path(stem, i == 2), exist=is_there(i))
      if (.not. is_there(i)) cycle
      found = fresh
      found%is_old = i == 2
      call load_one(checkpoint_path(stem, i == 2), model, writers, found, failure, error)
      if (allocated(error)) return
      if (.not. allocated(failure)) return
      if (remark == '') remark = failure%message
    end do
    if (any(is_there)) then
      call raise(error, 'keyway: --continue: '//remark, system_failed)
    else
      call raise(error, "keyway: --continue: there is no checkpoint '"// &
                 checkpoint_path(stem, is_old=.false.)//"': its run had no *RESTART, WRITE, or "// &
                 'ended before the first checkpoint; start without --continue', deck_is_wrong)
    end if
  end subroutine load_checkpoint

  !> Loads the state alone, for a process that writes no results, from the checkpoint that the
  !> process with the results has chosen by `load_checkpoint`.
  subroutine load_chosen_state(stem, is_old, now, error)
    character(*), intent(in) :: stem !< folder and name of the job
    logical, intent(in) :: is_old !< the checkpoint before the last
    type(state), intent(inout) :: now !< as `start_analysis` makes it; then as saved
    type(error_type), allocatable, intent(out) :: error
    type(error_type), allocatable :: failure
    type(hdf5_store) :: file
    call file%open(checkpoint_path(stem, is_old))
    call load_state(now, file, error)
    call file%close(failure)
    call keep_first(error, failure)
  end subroutine load_chosen_state

  !> Loads one checkpoint.
  subroutine load_one(path, model, writers, found, failure, error)
    character(*), intent(in) :: path
    type(problem), intent(in) :: model
    type(writer_item), intent(inout) :: writers(:)
    type(run_position), intent(inout) :: found !< the start of the analysis
    type(error_type), allocatable, intent(out) :: failure !< the file is damaged
    type(error_type), allocatable, intent(out) :: error !< the file belongs to another run
    type(error_type), allocatable :: ignored
    type(hdf5_store) :: file
    integer :: step
    step = 0
    call file%open(path)
    call file%get('number', found%number)
    call file%get('step', step)
    call file%report(failure)
    if (.not. allocated(failure)) call check_identity(model, file, step, error)
    if (allocated(error)) then
      if (error%exit_code /= deck_is_wrong) call move_alloc(error, failure)
    end if
    if (.not. (allocated(failure) .or. allocated(error))) then
      call load_state(found%now, file, failure)
      if (.not. allocated(failure)) call load_record(found%record, file, failure)
      found%record%path = found%now%path
      found%num_warnings = size(found%record%warnings)
      if (.not. allocated(failure)) then
        call renew_faces(model, found%now, file, found%record)
        call file%report(failure)
      end if
      if (.not. allocated(failure)) call load_summary(found%summary, file, failure)
      if (.not. allocated(failure)) call load_positions(writers, file, failure)
    end if
    call file%close(ignored)
  end subroutine load_one

  !> Reads where the files of all writers ended.
  subroutine load_positions(writers, file, error)
    type(writer_item), intent(inout) :: writers(:)
    type(hdf5_store), intent(inout) :: file
    type(error_type), allocatable, intent(out) :: error
    logical :: is_idle
    integer :: w
    is_idle = .true.
    do w = 1, size(writers)
      call file%open_group('writer_'//as_text(w))
      call file%get('is_idle', is_idle)
      if (.not. is_idle) call writers(w)%item%load_position(file)
      call file%close_group()
    end do
    call file%report(error)
  end subroutine load_positions
end module run_checkpoint
