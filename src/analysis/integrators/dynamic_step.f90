!> Parts common to all dynamic schemes: the start of a step and the reference force.
module dynamic_step
  use kinds, only: rk
  use errors, only: error_type
  use global_vectors, only: length, multiply
  use problem_definition, only: problem
  use step_plan, only: step
  use analysis_state, only: motion, state
  use state_transfer, only: start_motion, store_motion, sum_contact
  use increment_listener, only: listener
  use modal_damping, only: build_modal_damping
  use joint_water, only: update_uplift
  use step_equilibrium, only: make_equilibrium
  use guest_forces, only: has_histories
  use step_system, only: dam_system, build_structure, build_inertia, build_damping, &
                         build_loads, build_origins
  use step_loads, only: step_time, external_force, prescribed_values
  use start_acceleration, only: find_start
  use energy_account, only: open_account
  use run_ledger, only: ledger
  use solid_iteration, only: solid_solver
  implicit none
  private
  public :: build_dynamic_step, open_dynamic_step, make_step_solver, largest_force

  !> In free flight all forces are round-off: the residual is then measured against this fraction of
  !> the force that would stop the dam within the increment.
  real(rk), parameter :: stopping_share = 1.0e-3_rk

contains

  !> Builds the equations of a step, its motion and its solids.
  subroutine build_dynamic_step(model, plan, system, solids, now, results, error)
    type(problem), intent(in) :: model
    type(step), intent(in) :: plan
    type(dam_system), intent(inout) :: system
    type(solid_solver), intent(inout) :: solids
    type(state), intent(inout) :: now !< at the start of the step
    class(listener), intent(inout) :: results
    type(error_type), allocatable, intent(out) :: error
    associate (costs => results%costs)
      call build_structure(model, plan, system, costs, error)
      if (.not. allocated(error)) call build_inertia(model, plan, system, costs, error)
      if (.not. allocated(error)) call build_damping(model, plan, system, costs, error)
      if (.not. allocated(error)) call build_modal_damping(model, plan, system, costs, error)
      if (.not. allocated(error)) call build_origins(model, now, system, costs, error)
      if (allocated(error)) return
      call build_loads(model, plan, now%u, system, costs)
    end associate
    now%num_unknowns = system%matrix%num_free
    call start_motion(system%numbers, model%joints, now, has_inertia=.true.)
    call solids%open(model, system, plan, now)
  end subroutine build_dynamic_step

  !> Builds the equations of a step, finds the acceleration that it starts with, opens the energy
  !> balance, reports the start to the listener and prepares the solver. The integrator computes
  !> K_eff later.
  subroutine open_dynamic_step(model, plan, system, solids, now, results, error)
    type(problem), intent(in) :: model
    type(step), intent(in) :: plan
    type(dam_system), intent(inout) :: system
    type(solid_solver), intent(inout) :: solids
    type(state), intent(inout) :: now !< at the start of the step
    class(listener), intent(inout) :: results
    type(error_type), allocatable, intent(out) :: error
    call build_dynamic_step(model, plan, system, solids, now, results, error)
    if (allocated(error)) return
    call results%costs%start('solve', 'initial acceleration', 'solver')
    call start_forces(system, solids, model, plan, now, results%costs, error)
    call results%costs%stop()
    if (allocated(error)) return
    call results%costs%start('recover', 'energy', 'solver')
    call open_account(model, system, now, now%total_time <= 0.0_rk, plan%changes_stage)
    call results%costs%stop()
    if (now%increment == 0) then ! not after a restart within the step
      call store_motion(system%numbers, now)
      call results%report_increment(model, now, error)
      if (allocated(error)) return
    end if
    call make_step_solver(plan, system, solids%has_inelastic() .and. &
                          .not. has_histories(now%guests), solids, results, error)
  end subroutine open_dynamic_step

  !> Makes a solver and plans its factor.
  subroutine make_step_solver(plan, system, has_active_part, solids, results, error)
    type(step), intent(in) :: plan
    type(dam_system), intent(in) :: system
    logical, intent(in) :: has_active_part !< solves are repeated for unknowns of inelastic solids
    type(solid_solver), intent(inout) :: solids
    class(listener), intent(inout) :: results
    type(error_type), allocatable, intent(out) :: error
    call results%costs%start('analyse', 'structure', 'solver')
    call make_equilibrium(plan, system, all(solids%choices%is_symmetric()), solids%solver, error)
    call results%costs%stop()
    if (allocated(error)) return
    solids%solver%costs = results%costs
    ! Refined solves are complete ones.
    solids%solver%may_repeat = has_active_part .and. .not. plan%controls%keeps_single
  end subroutine make_step_solver

  !> Forces at the start of the step and the acceleration that balances them. Supports that follow
  !> an amplitude start with its velocity.
  subroutine start_forces(system, solids, model, plan, now, costs, error)
    type(dam_system), intent(inout) :: system
    type(solid_solver), intent(inout) :: solids
    type(problem), intent(in) :: model
    type(step), intent(in) :: plan
    type(state), intent(inout) :: now
    type(ledger), intent(in) :: costs
    type(error_type), allocatable, intent(out) :: error
    type(step_time) :: when
    logical :: has_changed
    when = step_time(is_dynamic=.true., start=now%total_time, duration=plan%duration)
    associate (own => now%motion)
      call update_uplift(model, system%operator, now%joints, system%groups, costs, has_changed)
      call external_force(system%groups, model%amplitudes, when, own%external)
      call start_supports(model, system, when, 1.0e-3_rk*plan%first_increment, own%v)
      call solids%start_lost_damping(model, system, plan, now)
      call multiply(system%matrix, system%mass, own%v, own%momentum)
      call system%find_damping_force(own%v, own%viscous)
      call sum_contact(system%operator, now)
      call find_start(model, system, now%joints, own%external, &
                      own%external - own%internal - own%viscous - own%contact, own%a, error)
      if (allocated(error)) return
      call multiply(system%matrix, system%mass, own%a, own%inertia)
      own%balanced = own%inertia
    end associate
  end subroutine start_forces

  !> Velocities of supports that follow an amplitude; other supports have none.
  subroutine start_supports(model, system, when, instant, v)
    type(problem), intent(in) :: model
    type(dam_system), intent(in) :: system
    type(step_time), intent(in) :: when
    real(rk), intent(in) :: instant !< a small part of the increment [s]
    real(rk), intent(inout) :: v(:)
    real(rk) :: first(size(v)), last(size(v))
    type(step_time) :: later
    integer :: i
    first = 0.0_rk
    last = 0.0_rk
    later = when
    later%now = when%now + instant
    call prescribed_values(system%supports, model%amplitudes, when, first)
    call prescribed_values(system%supports, model%amplitudes, later, last)
    do i = 1, size(system%supports)
      associate (k => system%supports(i)%unknown)
        v(k) = (last(k) - first(k))/instant
      end associate
    end do
  end subroutine start_supports

  !> The largest force in the balance: the reference of the residual [N].
  real(rk) function largest_force(moving, num_free, joint_weight, dt) result(force)
    type(motion), intent(in) :: moving
    integer, intent(in) :: num_free
    real(rk), intent(in) :: joint_weight !< of the joint forces in the balance
    real(rk), intent(in) :: dt !< [s]
    force = max(length(moving%external(:num_free)), length(moving%internal(:num_free)), &
                length(moving%inertia(:num_free)), length(moving%viscous(:num_free)), &
                joint_weight*length(moving%contact(:num_free)), &
                stopping_share*length(moving%momentum(:num_free))/dt)
  end function largest_force
end module dynamic_step
