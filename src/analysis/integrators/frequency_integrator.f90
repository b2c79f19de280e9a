!> Frequency steps: modes of the model with closed joints and undamaged elements (theory.md, 9).
module frequency_integrator
  use kinds, only: rk
  use errors, only: error_type
  use problem_definition, only: problem
  use step_plan, only: step
  use analysis_state, only: state, vibration_mode
  use increment_listener, only: listener
  use equilibrium, only: balance_outcome
  use equilibrium_linear, only: linear_equilibrium
  use solver_catalogue, only: make_solver, symmetric_solver
  use step_equilibrium, only: prepare_equilibrium
  use step_loads, only: step_time
  use step_system, only: build_structure, build_inertia
  use joint_forces, only: reference_stiffness
  use joint_iteration, only: closed_tangent
  use eigen_modes, only: find_modes
  use integrator_type, only: integrator
  implicit none
  private
  public :: make_frequency

  type, extends(integrator) :: frequency_method
  contains
    procedure :: open_step
    procedure :: advance
    procedure :: close_step => report_modes
  end type frequency_method

contains

  !> The method, before it has a step.
  subroutine make_frequency(method)
    class(integrator), allocatable, intent(out) :: method
    allocate (frequency_method :: method)
  end subroutine make_frequency

  !> Stiffness with closed joints, and mass.
  subroutine open_step(self, model, plan, now, results, error)
    class(frequency_method), intent(inout) :: self
    type(problem), intent(in) :: model
    type(step), intent(in) :: plan
    type(state), intent(inout) :: now
    class(listener), intent(inout) :: results
    type(error_type), allocatable, intent(out) :: error
    real(rk), allocatable :: reference(:, :)
    call build_structure(model, plan, self%system, results%costs, error)
    if (.not. allocated(error)) then
      call build_inertia(model, plan, self%system, results%costs, error)
    end if
    if (allocated(error)) return
    associate (system => self%system)
      call reference_stiffness(model%joints, system%operator, reference)
      call system%operator%add_stiffness(closed_tangent(reference), system%matrix, system%stiffness)
    end associate
    now%num_unknowns = self%system%matrix%num_free
  end subroutine open_step

  !> A frequency step has no increments.
  subroutine advance(self, model, when, before, after, results, outcome, error)
    class(frequency_method), intent(inout) :: self
    type(problem), intent(in) :: model
    type(step_time), intent(in) :: when
    type(state), intent(in) :: before
    type(state), intent(inout) :: after
    class(listener), intent(inout) :: results
    type(balance_outcome), intent(out) :: outcome
    type(error_type), allocatable, intent(out) :: error
    outcome%has_converged = .true.
  end subroutine advance

  !> Finds the modes and reports them.
  subroutine report_modes(self, model, plan, now, results, error)
    class(frequency_method), intent(inout) :: self
    type(problem), intent(in) :: model
    type(step), intent(in) :: plan
    type(state), intent(inout) :: now
    class(listener), intent(inout) :: results
    type(error_type), allocatable, intent(out) :: error
    type(linear_equilibrium) :: balance
    type(vibration_mode), allocatable :: modes(:)
    associate (system => self%system)
      call results%costs%start('analyse', 'structure', 'solver')
      call make_solver(symmetric_solver, balance%factor, error)
      if (.not. allocated(error)) call balance%factor%analyse(system%matrix, error)
      call results%costs%stop()
      if (allocated(error)) return
      balance%costs = results%costs
      call results%costs%start('solve', 'modes', 'solver')
      call prepare_equilibrium(model, system, system%stiffness, 1.0_rk, balance, error)
      if (allocated(error)) return
      call find_modes(system%matrix, system%numbers, system%stiffness, system%mass, &
                      balance%factor, plan%num_modes, modes, error)
      call results%costs%stop()
    end associate
    if (allocated(error)) return
    now%is_last_of_step = .true.
    call results%modes_found(model, now%step, modes, error)
  end subroutine report_modes
end module frequency_integrator
