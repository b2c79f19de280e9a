!> The interface of all writers of results. The defaults do nothing.
module result_writer
  use kinds, only: rk
  use errors, only: error_type
  use problem_definition, only: problem
  use analysis_state, only: state, vibration_mode
  use archive_type, only: archive
  use earlier_files, only: missing_files
  use file_identity, only: file_path
  use run_ledger, only: ledger
  use run_records, only: run_record
  implicit none
  private
  public :: writer, is_due, meets, starts_analysis

  real(rk), parameter :: round_off = 1.0e-6_rk !< of a number of increments

  type, abstract :: writer
    logical :: is_idle = .false. !< set by `open`: the model has nothing for this writer
  contains
    procedure(open_writer), deferred :: open
    procedure(write_increment), deferred :: write_increment
    procedure :: list_paths
    procedure :: save_position
    procedure :: load_position
    procedure :: go_on
    procedure :: note_missing
    procedure :: start_undo
    procedure :: renew
    procedure :: write_modes
    procedure :: write_envelopes
    procedure :: write_costs
    procedure :: finish
  end type writer

  abstract interface
    !> The run begins.
    subroutine open_writer(self, model, stem, record, error)
      import :: writer, problem, run_record, error_type
      implicit none
      class(writer), intent(inout) :: self
      type(problem), intent(in) :: model
      character(*), intent(in) :: stem !< folder and name of the job
      type(run_record), intent(inout) :: record
      type(error_type), allocatable, intent(out) :: error
    end subroutine open_writer

    !> An increment has converged.
    subroutine write_increment(self, model, now, record, error)
      import :: writer, problem, state, run_record, error_type
      implicit none
      class(writer), intent(inout) :: self
      type(problem), intent(in) :: model
      type(state), intent(in) :: now
      type(run_record), intent(inout) :: record !< computes stresses on demand
      type(error_type), allocatable, intent(out) :: error
    end subroutine write_increment
  end interface

contains

  !> Adds the paths of the files that it will write, where other files may be.
  subroutine list_paths(self, model, stem, record, paths)
    class(writer), intent(inout) :: self
    type(problem), intent(in) :: model
    character(*), intent(in) :: stem !< folder and name of the job
    type(run_record), intent(inout) :: record !< open
    type(file_path), allocatable, intent(inout) :: paths(:)
  end subroutine list_paths

  !> Completes the files on disk and stores in a checkpoint where they end.
  subroutine save_position(self, file, error)
    class(writer), intent(inout) :: self
    class(archive), intent(inout) :: file !< open for writing, in a group of this writer
    type(error_type), allocatable, intent(out) :: error
  end subroutine save_position

  !> Reads from a checkpoint where the files ended, and changes no file.
  subroutine load_position(self, file)
    class(writer), intent(inout) :: self
    class(archive), intent(inout) :: file !< open for reading, in the group of this writer
  end subroutine load_position

  !> The run goes on from the checkpoint that was loaded: takes the place of `open`.
  subroutine go_on(self, model, stem, record, error)
    class(writer), intent(inout) :: self
    type(problem), intent(in) :: model
    character(*), intent(in) :: stem !< folder and name of the job
    type(run_record), intent(inout) :: record !< of the checkpoint
    type(error_type), allocatable, intent(out) :: error
    call self%open(model, stem, record, error)
  end subroutine go_on

  !> Notes files from before the checkpoint that do not exist, beyond those of the record.
  subroutine note_missing(self, missing)
    class(writer), intent(in) :: self
    type(missing_files), intent(inout) :: missing
  end subroutine note_missing

  !> What is written from now on can be undone.
  subroutine start_undo(self, journal, number, error)
    class(writer), intent(inout) :: self
    character(*), intent(in) :: journal !< path
    integer, intent(in) :: number !< of the checkpoint
    type(error_type), allocatable, intent(out) :: error
  end subroutine start_undo

  !> The run goes on, with a deck whose later steps may have changed: writes what has changed in the
  !> files before the checkpoint, after `start_undo`, so that a kill can be undone.
  subroutine renew(self, model, record, error)
    class(writer), intent(inout) :: self
    type(problem), intent(in) :: model
    type(run_record), intent(in) :: record !< of the checkpoint
    type(error_type), allocatable, intent(out) :: error
  end subroutine renew

  !> A *FREQUENCY step has found its modes.
  subroutine write_modes(self, model, step, modes, record, error)
    class(writer), intent(inout) :: self
    type(problem), intent(in) :: model
    integer, intent(in) :: step
    type(vibration_mode), intent(in) :: modes(:)
    type(run_record), intent(inout) :: record
    type(error_type), allocatable, intent(out) :: error
  end subroutine write_modes

  !> Writes the envelopes of a step that has ended or in which the run stops.
  subroutine write_envelopes(self, model, record, error)
    class(writer), intent(inout) :: self
    type(problem), intent(in) :: model
    type(run_record), intent(inout) :: record
    type(error_type), allocatable, intent(out) :: error
  end subroutine write_envelopes

  !> Writes the ledger of the run, before `finish`, also after a failure.
  subroutine write_costs(self, costs)
    class(writer), intent(inout) :: self
    type(ledger), intent(in) :: costs
  end subroutine write_costs

  !> Completes the files on disk, also after a failure.
  subroutine finish(self, error)
    class(writer), intent(inout) :: self
    type(error_type), allocatable, intent(out) :: error
  end subroutine finish

  !> Does a request write this increment? True for every `frequency`-th increment and the last of a
  !> step. When a run stops early, the last increment is sent again to requests that have not
  !> written it. Increment 0 repeats the end of the previous step; only the first step writes it.
  !> Frequency 0 writes nothing.
  pure logical function is_due(now, frequency)
    type(state), intent(in) :: now
    integer, intent(in) :: frequency
    if (frequency <= 0) then
      is_due = .false.
    else if (now%is_stop) then
      is_due = .not. meets(now, frequency)
    else if (now%increment == 0) then
      is_due = starts_analysis(now)
    else
      is_due = now%is_last_of_step .or. meets(now, frequency)
    end if
  end function is_due

  !> Does an increment end a multiple of `frequency`? Increments that follow the estimated error are
  !> counted in time: multiples of so many first increments.
  elemental logical function meets(now, frequency)
    type(state), intent(in) :: now
    integer, intent(in) :: frequency
    real(rk) :: interval
    meets = mod(now%increment, frequency) == 0
    if (.not. now%control%first > 0.0_rk .or. frequency == 1) return
    interval = frequency*now%control%first
    meets = floor(now%step_time/interval + round_off) &
            > floor((now%step_time - now%increment_size)/interval + round_off)
  end function meets

  !> True for the state from which the whole analysis starts.
  pure logical function starts_analysis(now)
    type(state), intent(in) :: now
    starts_analysis = now%increment == 0 .and. now%total_time <= 0.0_rk
  end function starts_analysis
end module result_writer
