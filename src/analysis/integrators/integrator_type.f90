!> The contract of time integrators: how a step is opened, advanced by one increment and closed.
!>
!> The step loop owns the two states, the sizes of increments, cuts and reports. An integrator owns
!> the equations of the step and fills the trial state. A new integrator is one file and one line of
!> integrator_catalogue.
module integrator_type
  use kinds, only: rk
  use errors, only: error_type
  use problem_definition, only: problem
  use step_plan, only: step
  use analysis_state, only: state
  use increment_listener, only: listener
  use state_transfer, only: store_motion
  use equilibrium, only: balance_outcome
  use step_loads, only: step_time
  use step_system, only: dam_system
  use solid_iteration, only: solid_solver
  implicit none
  private
  public :: integrator

  type, abstract :: integrator
    type(dam_system) :: system !< matrices, loads and supports of the step
    type(solid_solver) :: solids !< solves an increment, joints and inelastic solids included
  contains
    procedure(open_step), deferred :: open_step
    procedure :: resume => no_resumption
    procedure :: start_increment => no_preparation
    procedure(advance), deferred :: advance
    procedure :: store_state => store_nodes
    procedure :: is_hopeless => is_never_hopeless
    procedure :: explain_failure => no_explanation
    procedure :: close_step => no_end
  end type integrator

  abstract interface
    !> Builds and factors the equations of a step, and the forces of the state that it starts from.
    subroutine open_step(self, model, plan, now, results, error)
      import :: integrator, problem, step, state, listener, error_type
      implicit none
      class(integrator), intent(inout) :: self
      type(problem), intent(in) :: model
      type(step), intent(in) :: plan
      type(state), intent(inout) :: now !< at the start of the step
      class(listener), intent(inout) :: results
      type(error_type), allocatable, intent(out) :: error
    end subroutine open_step

    !> Goes from `before` to `after` in one increment, energies included. An iteration that does not
    !> converge is no error; `after` is then invalid.
    subroutine advance(self, model, when, before, after, results, outcome, error)
      import :: integrator, problem, step_time, state, listener, balance_outcome, error_type
      implicit none
      class(integrator), intent(inout) :: self
      type(problem), intent(in) :: model
      type(step_time), intent(in) :: when !< the end of the increment
      type(state), intent(in) :: before
      type(state), intent(inout) :: after !< comes with the status of `before`
      class(listener), intent(inout) :: results
      type(balance_outcome), intent(out) :: outcome
      type(error_type), allocatable, intent(out) :: error
    end subroutine advance
  end interface

contains

  !> Takes a state that was loaded in its step, after `open_step` has built the equations.
  subroutine no_resumption(self, now, error)
    class(integrator), intent(inout) :: self
    type(state), intent(inout) :: now
    type(error_type), allocatable, intent(out) :: error
  end subroutine no_resumption

  !> Prepares for an increment of this size.
  subroutine no_preparation(self, model, plan, dt, results, error)
    class(integrator), intent(inout) :: self
    type(problem), intent(in) :: model
    type(step), intent(in) :: plan
    real(rk), intent(in) :: dt !< [s]
    class(listener), intent(inout) :: results
    type(error_type), allocatable, intent(out) :: error
  end subroutine no_preparation

  !> Writes the motion of a converged increment to the nodes.
  subroutine store_nodes(self, model, when, now, results, error)
    class(integrator), intent(inout) :: self
    type(problem), intent(in) :: model
    type(step_time), intent(in) :: when !< the end of the increment
    type(state), intent(inout) :: now !< with its counters
    class(listener), intent(inout) :: results
    type(error_type), allocatable, intent(out) :: error
    call store_motion(model%mesh, self%system%numbers, now)
  end subroutine store_nodes

  !> Whether an increment has no equilibrium for certain.
  logical function is_never_hopeless(self, model, plan, when, before)
    class(integrator), intent(in) :: self
    type(problem), intent(in) :: model
    type(step), intent(in) :: plan
    type(step_time), intent(in) :: when !< its end
    type(state), intent(in) :: before !< last equilibrium
    is_never_hopeless = .false.
  end function is_never_hopeless

  !> Adds a cause to the message of an increment that cannot be made smaller.
  subroutine no_explanation(self, model, plan, when, before, after, error)
    class(integrator), intent(in) :: self
    type(problem), intent(in) :: model
    type(step), intent(in) :: plan
    type(step_time), intent(in) :: when !< of the increment that failed
    type(state), intent(in) :: before !< last equilibrium
    type(state), intent(in) :: after !< where the iteration has ended
    type(error_type), allocatable, intent(inout) :: error
  end subroutine no_explanation

  !> Ends a step whose increments are done.
  subroutine no_end(self, model, plan, now, results, error)
    class(integrator), intent(inout) :: self
    type(problem), intent(in) :: model
    type(step), intent(in) :: plan
    type(state), intent(inout) :: now
    class(listener), intent(inout) :: results
    type(error_type), allocatable, intent(out) :: error
  end subroutine no_end
end module integrator_type
