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
  use step_equilibrium, only: factorise_closed
  use step_loads, only: step_time
  use step_system, only: build_structure, build_inertia
  use eigen_modes, only: find_modes
  use global_vectors, only: num_free_in_all
  use integrator_type, only: integrator
  use node_parts, only: gather_field
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

  !> Stiffness and mass.
  subroutine open_step(self, model, plan, now, results, error)
    class(frequency_method), intent(inout) :: self
    type(problem), intent(in) :: model
    type(step), intent(in) :: plan
    type(state), intent(inout) :: now
    class(listener), intent(inout) :: results
    type(error_type), allocatable, intent(out) :: error
    call build_structure(model, plan, self%system, results%costs, error)
    if (.not. allocated(error)) then
      call build_inertia(model, plan, self%system, results%costs, error)
    end if
    if (allocated(error)) return
    now%num_unknowns = num_free_in_all(self%system%matrix)
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
    real(rk), allocatable :: closed(:)
    integer :: k
    associate (system => self%system)
      call factorise_closed(model, system, results%costs, closed, balance, error)
      if (allocated(error)) return
      call results%costs%start('solve', 'modes', 'solver')
      call find_modes(system%matrix, system%numbers, closed, system%mass, &
                      balance%factor, plan%num_modes, modes, error)
      call results%costs%stop()
    end associate
    if (allocated(error)) return
    do k = 1, size(modes)
      call gather_field(model%mesh, modes(k)%shape)
    end do
    now%is_last_of_step = .true.
    call results%report_modes(model, now%step, modes, error)
  end subroutine report_modes
end module frequency_integrator
