!> What every writer of results can do. The defaults do nothing.
module result_writer
  use kinds, only: rk
  use errors, only: error_type
  use problem_definition, only: problem
  use analysis_state, only: state, vibration_mode
  use run_ledger, only: ledger
  use run_records, only: run_record
  implicit none
  private
  public :: writer, is_due, starts_analysis

  type, abstract :: writer
    logical :: is_idle = .false. !< since it was opened: the model gives it nothing to write
  contains
    procedure(open_writer), deferred :: open
    procedure(write_increment), deferred :: write_increment
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
      type(run_record), intent(inout) :: record !< stresses are made on demand
      type(error_type), allocatable, intent(out) :: error
    end subroutine write_increment
  end interface

contains

  !> A *FREQUENCY step has found its modes.
  subroutine write_modes(self, model, step, modes, record, error)
    class(writer), intent(inout) :: self
    type(problem), intent(in) :: model
    integer, intent(in) :: step
    type(vibration_mode), intent(in) :: modes(:)
    type(run_record), intent(inout) :: record
    type(error_type), allocatable, intent(out) :: error
  end subroutine write_modes

  !> A step has ended, or the run stops in it: the envelopes of the step.
  subroutine write_envelopes(self, model, record, error)
    class(writer), intent(inout) :: self
    type(problem), intent(in) :: model
    type(run_record), intent(inout) :: record
    type(error_type), allocatable, intent(out) :: error
  end subroutine write_envelopes

  !> The analysis has ended, well or not: the ledger of the run, before `finish`.
  subroutine write_costs(self, costs)
    class(writer), intent(inout) :: self
    type(ledger), intent(in) :: costs
  end subroutine write_costs

  !> The analysis has ended, well or not: everything must be on the disk.
  subroutine finish(self, error)
    class(writer), intent(inout) :: self
    type(error_type), allocatable, intent(out) :: error
  end subroutine finish

  !> Is this increment one of a request? Every `frequency`-th, and the last of a step; where a run
  !> stops early the last one reached is told once more and due for those that have not got it.
  !> Increment 0 repeats the end of the step before; it counts only where there is none. Frequency 0
  !> is never.
  pure logical function is_due(now, frequency)
    type(state), intent(in) :: now
    integer, intent(in) :: frequency
    if (frequency <= 0) then
      is_due = .false.
    else if (now%is_stop) then
      is_due = mod(now%increment, frequency) /= 0
    else if (now%increment == 0) then
      is_due = starts_analysis(now)
    else
      is_due = now%is_last_of_step .or. mod(now%increment, frequency) == 0
    end if
  end function is_due

  !> True for the state from which the whole analysis starts.
  pure logical function starts_analysis(now)
    type(state), intent(in) :: now
    starts_analysis = now%increment == 0 .and. now%total_time <= 0.0_rk
  end function starts_analysis
end module result_writer
