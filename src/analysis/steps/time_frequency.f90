!> A frequency step: modes of the model with closed joints (theory.md, 9).
module time_frequency
  use errors, only: error_type
  use problem_definition, only: problem
  use step_plan, only: step
  use analysis_state, only: state, vibration_mode
  use increment_listener, only: listener
  use solver_catalogue, only: make_solver, symmetric_solver
  use equilibrium_linear, only: linear_equilibrium
  use step_equilibrium, only: prepare_equilibrium
  use step_system, only: dam_system, build_structure, add_couplings, build_inertia
  use joint_forces, only: reference_stiffness
  use joint_iteration, only: closed_tangent
  use eigen_modes, only: find_modes
  use kinds, only: rk
  implicit none
  private
  public :: run_frequency

contains

  !> Finds the modes of one step and tells the listener of them.
  subroutine run_frequency(scene, plan, now, results, error)
    type(problem), intent(in) :: scene
    type(step), intent(in) :: plan
    type(state), intent(inout) :: now
    class(listener), intent(inout) :: results
    type(error_type), allocatable, intent(out) :: error
    type(dam_system) :: system
    type(linear_equilibrium) :: balance
    type(vibration_mode), allocatable :: modes(:)
    real(rk), allocatable :: reference(:, :)
    call results%costs%start('assemble', 'structure', 'solver')
    call build_structure(scene, plan, system, error)
    if (.not. allocated(error)) call build_inertia(scene, plan, system, error)
    if (allocated(error)) return
    call reference_stiffness(scene%joints, system%operator, reference)
    call system%operator%add_stiffness(closed_tangent(reference), system%matrix, system%stiffness)
    call results%costs%stop()
    call add_couplings(scene, system, results%costs)
    call results%costs%start('analyse', 'structure', 'solver')
    call make_solver(symmetric_solver, balance%factor, error)
    if (.not. allocated(error)) call balance%factor%analyse(system%matrix, error)
    call results%costs%stop()
    if (allocated(error)) return
    balance%costs = results%costs
    call results%costs%start('solve', 'modes', 'solver')
    call prepare_equilibrium(scene, system, system%stiffness, 1.0_rk, balance, error)
    if (allocated(error)) return
    call find_modes(system%matrix, system%numbers, system%stiffness, system%mass, balance%factor, &
                    plan%num_modes, modes, error)
    call results%costs%stop()
    if (allocated(error)) return
    now%num_unknowns = system%matrix%num_free
    now%is_last_of_step = .true.
    call results%modes_found(scene, now%step, modes, error)
  end subroutine run_frequency
end module time_frequency
