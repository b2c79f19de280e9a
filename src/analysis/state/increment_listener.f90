!> The interface through which the solvers report increments to the results layer.
module increment_listener
  use, intrinsic :: iso_c_binding, only: c_int
  use kinds, only: rk
  use errors, only: error_type, raise
  use logging, only: run_log
  use run_ledger, only: ledger
  use problem_definition, only: problem
  use analysis_state, only: motion, state, vibration_mode
  use dual_solutions, only: dual_solution
  use motion_parts, only: gather_motion
  use ranks, only: add_over_ranks, is_first_rank, largest_of_ranks, num_ranks, &
                   number_of_first_rank, share_error
  use stop_signals, only: name_of_signal, stop_signal, take_signal
  implicit none
  private
  public :: listener

  !> Solvers also write messages to its log, and their computing time to its ledger.
  type, abstract :: listener
    type(run_log) :: log
    type(ledger) :: costs !< records nothing until it is opened
    !> Largest displacement of a dynamic step so far [m], its error in time [m], and the error of
    !> histories over the largest motion; zero where the step makes no estimate
    real(rk) :: time_error(3) = 0.0_rk
    !> Largest opening of a dynamic step so far [m], the error in time of openings [m], and their
    !> quotient; zero where the step makes no estimate
    real(rk) :: opening_error(3) = 0.0_rk
    !> Errors of the mesh in a dynamic step: of the largest displacement, of openings; -1: not known
    !> [m]
    real(rk) :: mesh_error(2) = -1.0_rk
    !> Of the end of a linear static step; allocated until the results have taken them
    type(dual_solution), allocatable :: duals(:)
    !> Of all ranks, where vectors are divided and a checkpoint is due; on the first rank
    type(motion), allocatable :: whole_motion
  contains
    procedure(increment_done), deferred :: increment_done
    procedure :: increment_dropped
    procedure :: wants_motion => always_wants_motion
    procedure :: wants_checkpoint => never_wants_checkpoint
    procedure(modes_found), deferred :: modes_found
    procedure :: weigh_modes
    procedure, non_overridable :: needs_motion, report_increment, report_modes, &
      stiffening_of_modes
  end type listener

  abstract interface
    !> An increment has converged; increment 0 is the state at the start of a dynamic step.
    subroutine increment_done(self, model, now, error)
      import :: listener, problem, state, error_type
      implicit none
      class(listener), intent(inout) :: self
      type(problem), intent(in) :: model
      type(state), intent(in) :: now
      type(error_type), allocatable, intent(out) :: error
    end subroutine increment_done

    !> A *FREQUENCY step has found its modes.
    subroutine modes_found(self, model, step, modes, error)
      import :: listener, problem, vibration_mode, error_type
      implicit none
      class(listener), intent(inout) :: self
      type(problem), intent(in) :: model
      integer, intent(in) :: step
      type(vibration_mode), intent(in) :: modes(:)
      type(error_type), allocatable, intent(out) :: error
    end subroutine modes_found
  end interface

contains

  !> Whether the results of an increment need the motion of the nodes. `now` has its counters.
  logical function always_wants_motion(self, model, now) result(wants)
    class(listener), intent(in) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    wants = .true.
  end function always_wants_motion

  !> Whether the results write a checkpoint after an increment.
  logical function never_wants_checkpoint(self, model, now) result(wants)
    class(listener), intent(in) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    wants = .false.
  end function never_wants_checkpoint

  !> The answer of `wants_motion`. The results are one rank's; all ranks have the answer of rank 0.
  logical function needs_motion(self, model, now) result(needs)
    class(listener), intent(in) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    needs = number_of_first_rank(merge(1, 0, self%wants_motion(model, now))) == 1
  end function needs_motion

  !> How much stiffer the mesh makes each mode; without results that know stresses: nothing.
  subroutine weigh_modes(self, model, shape, stiffening)
    class(listener), intent(inout) :: self
    type(problem), intent(in) :: model
    real(rk), intent(in) :: shape(:, :, :) !< (3, nodes, modes) unit modal mass
    !> (modes) squared circular frequencies of the mesh less those of the structure [1/s2]
    real(rk), allocatable, intent(out) :: stiffening(:) !< not allocated where it is not known
  end subroutine weigh_modes

  !> Answers of `weigh_modes`. The results are one rank's; all ranks have the answer of rank 0.
  subroutine stiffening_of_modes(self, model, shape, stiffening)
    class(listener), intent(inout) :: self
    type(problem), intent(in) :: model
    real(rk), intent(in) :: shape(:, :, :) !< (3, nodes, modes) unit modal mass
    real(rk), allocatable, intent(out) :: stiffening(:) !< (modes) [1/s2], see `weigh_modes`
    real(rk) :: shared(size(shape, 3) + 1)
    call self%weigh_modes(model, shape, stiffening)
    if (num_ranks() == 1) return
    shared = 0.0_rk
    if (is_first_rank() .and. allocated(stiffening)) shared = [stiffening, 1.0_rk]
    call add_over_ranks(shared)
    if (allocated(stiffening)) deallocate (stiffening)
    if (shared(size(shared)) > 0.5_rk) stiffening = shared(:size(shape, 3))
  end subroutine stiffening_of_modes

  !> Reports an increment. The results are one rank's; their failure is that of all ranks. A signal
  !> to any rank stops the run after the next increment.
  subroutine report_increment(self, model, now, error)
    class(listener), intent(inout) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(error_type), allocatable, intent(out) :: error
    call bring_motion(self, model, now)
    call self%increment_done(model, now, error)
    call share_error(error)
    if (allocated(self%whole_motion)) deallocate (self%whole_motion)
    if (allocated(error) .or. num_ranks() == 1) return
    call take_signal(int(largest_of_ranks(stop_signal()), c_int))
  end subroutine report_increment

  !> Puts the motion together on the first rank where it is divided and a checkpoint is due.
  subroutine bring_motion(self, model, now)
    class(listener), intent(inout) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    if (.not. allocated(model%mesh%is_node_here)) return
    if (number_of_first_rank(merge(1, 0, self%wants_checkpoint(model, now))) == 0) return
    allocate (self%whole_motion)
    call gather_motion(model, now, self%whole_motion)
  end subroutine bring_motion

  !> Reports modes, as `report_increment` does an increment.
  subroutine report_modes(self, model, step, modes, error)
    class(listener), intent(inout) :: self
    type(problem), intent(in) :: model
    integer, intent(in) :: step
    type(vibration_mode), intent(in) :: modes(:)
    type(error_type), allocatable, intent(out) :: error
    call self%modes_found(model, step, modes, error)
    call share_error(error)
  end subroutine report_modes

  !> A signal has ended the increment after `now`; the error ends the run.
  subroutine increment_dropped(self, model, now, error)
    class(listener), intent(inout) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now !< as it was accepted
    type(error_type), allocatable, intent(out) :: error
    call raise(error, 'stopped by '//name_of_signal())
  end subroutine increment_dropped
end module increment_listener
