!> Parts common to all dynamic schemes: the start of a step and the reference force.
module dynamic_step
  use kinds, only: rk
  use errors, only: error_type
  use global_vectors, only: length, multiply, num_free_in_all
  use problem_definition, only: problem
  use step_plan, only: step
  use analysis_state, only: motion, state
  use state_transfer, only: start_motion, store_motion, sum_contact
  use increment_listener, only: listener
  use modal_damping, only: build_modal_damping, remark_on_modes
  use joint_water, only: resume_uplift, update_uplift
  use step_equilibrium, only: make_equilibrium
  use guest_forces, only: has_histories
  use step_system, only: dam_system, build_structure, build_inertia, build_damping, &
                         build_loads, build_origins
  use step_loads, only: step_time, external_force
  use start_acceleration, only: find_start
  use support_rates, only: find_support_rates
  use energy_account, only: open_account
  use renumbered_motion, only: renumber
  use matrix_pattern, only: pattern
  use run_ledger, only: ledger
  use motion_goes_on, only: has_same_unknowns, keep_accelerations, keep_joints, unbalanced_force
  use solid_iteration, only: solid_solver
  implicit none
  private
  public :: build_dynamic_step, open_dynamic_step, make_step_solver, largest_force

  !> In free flight all forces are round-off: the residual is then measured against this fraction of
  !> the force that would stop the dam within the increment.
  real(rk), parameter :: stopping_share = 1.0e-3_rk
  !> A change of the forces between two steps, over the forces, that is none.
  real(rk), parameter :: round_off = 1.0e-9_rk

contains

  !> Builds the equations of a step, its motion and its solids.
  subroutine build_dynamic_step(model, plan, system, solids, now, last, results, error)
    type(problem), intent(in) :: model
    type(step), intent(in) :: plan
    type(dam_system), intent(inout) :: system
    type(solid_solver), intent(inout) :: solids
    type(state), intent(inout) :: now !< at the start of the step
    type(motion), intent(out) :: last !< at the end of the step before, in unknowns of this one
    class(listener), intent(inout) :: results
    type(error_type), allocatable, intent(out) :: error
    last = now%motion
    associate (costs => results%costs)
      call build_structure(model, plan, system, costs, error)
      if (.not. allocated(error)) call build_inertia(model, plan, system, costs, error)
      if (.not. allocated(error)) call build_damping(model, plan, system, costs, error)
      if (.not. allocated(error)) call build_modal_damping(model, plan, system, costs, error)
      if (.not. allocated(error)) call build_origins(model, now, system, costs, error)
      if (allocated(error)) return
      call note_modes(plan, system, results)
      call build_loads(model, plan, now%u, system, costs)
    end associate
    now%num_unknowns = num_free_in_all(system%matrix)
    call start_motion(system%numbers, model%joints, now, has_inertia=.true.)
    call keep_joints(last, plan, system%operator%num_points, now)
    if (.not. now%has_opened_step) call take_unknowns(model, system, now%step, last)
    call solids%open(model, system, plan, now)
  end subroutine build_dynamic_step

  !> The motion of the step before in the unknowns of this one.
  subroutine take_unknowns(model, system, number, last)
    type(problem), intent(in) :: model
    type(dam_system), intent(in) :: system
    integer, intent(in) :: number !< of the step
    type(motion), intent(inout) :: last !< at the end of the step before
    real(rk) :: passed_on(system%matrix%num_total)
    logical :: has_joints
    passed_on = 0.0_rk
    has_joints = allocated(last%carried)
    if (has_joints) has_joints = size(last%carried, 2) == system%operator%num_points
    if (has_joints) call system%operator%add_forces(last%carried, passed_on)
    call renumber(model, number, system%numbers, passed_on, last)
  end subroutine take_unknowns

  !> Says in the log where more modes are damped than the deck names.
  subroutine note_modes(plan, system, results)
    type(step), intent(in) :: plan
    type(dam_system), intent(in) :: system
    class(listener), intent(inout) :: results
    character(:), allocatable :: remark
    remark = remark_on_modes(plan, system)
    if (remark /= '') call results%log%note(remark)
  end subroutine note_modes

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
    type(motion) :: last
    call build_dynamic_step(model, plan, system, solids, now, last, results, error)
    if (allocated(error)) return
    call results%costs%start('solve', 'initial acceleration', 'solver')
    call start_forces(system, solids, model, plan, last, now, results%costs, error)
    call results%costs%stop()
    if (allocated(error)) return
    call results%costs%start('recover', 'energy', 'solver')
    call open_account(model, system, now, now%total_time <= 0.0_rk, plan%changes_stage)
    call results%costs%stop()
    if (.not. now%has_opened_step) then
      call store_motion(model%mesh, system%numbers, now)
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
    solids%solver%may_repeat = has_active_part .and. plan%controls%precision /= 'SINGLE'
  end subroutine make_step_solver

  !> Forces at the start of the step and the acceleration that balances them: all of them, or after
  !> another dynamic step what has changed. Supports that follow an amplitude start with its
  !> velocity. A state that was loaded within the step has its acceleration.
  subroutine start_forces(system, solids, model, plan, last, now, costs, error)
    type(dam_system), intent(inout) :: system
    type(solid_solver), intent(inout) :: solids
    type(problem), intent(in) :: model
    type(step), intent(in) :: plan
    type(motion), intent(in) :: last !< at the end of the step before
    type(state), intent(inout) :: now
    type(ledger), intent(in) :: costs
    type(error_type), allocatable, intent(out) :: error
    type(step_time) :: when
    logical :: has_changed, goes_on
    when = step_time(is_dynamic=.true., start=now%total_time, duration=plan%duration)
    associate (own => now%motion)
      goes_on = has_same_unknowns(last, plan, system%matrix%part, own)
      if (goes_on) then
        call resume_uplift(model, system%operator, now%joints, system%groups, costs)
      else
        call update_uplift(model, system%operator, now%joints, system%groups, costs, has_changed)
      end if
      call external_force(system%groups, model%amplitudes, when, own%external)
      call find_support_rates(model, system, when, plan%first_increment, own%v, own%a)
      call solids%start_lost_damping(model, system, plan, last, goes_on, now)
      call multiply(system%matrix, system%mass, own%v, own%momentum)
      call system%find_damping_force(own%v, own%viscous)
      call sum_contact(system%operator, now)
      if (goes_on) then
        call keep_accelerations(last, own)
        if (.not. now%has_opened_step) then
          call change_acceleration(model, system, plan, last, now, error)
        end if
        call multiply(system%matrix, system%mass, own%a, own%inertia)
        own%balanced = own%inertia + (last%balanced - last%inertia)
      else
        if (.not. now%has_opened_step) call start_anew(model, system, plan, now, error)
        call multiply(system%matrix, system%mass, own%a, own%inertia)
        own%balanced = own%inertia
      end if
    end associate
  end subroutine start_forces

  !> The acceleration that balances all forces, those by the acceleration of supports among them.
  !> Joints act by the tractions that the step before has passed on, if any.
  subroutine start_anew(model, system, plan, now, error)
    type(problem), intent(in) :: model
    type(dam_system), intent(in) :: system
    type(step), intent(in) :: plan
    type(state), intent(inout) :: now
    type(error_type), allocatable, intent(out) :: error
    real(rk), dimension(size(now%motion%a)) :: given, force, passed_on, a
    associate (own => now%motion, n => system%matrix%num_free)
      given = own%a
      given(:n) = 0.0_rk
      call multiply(system%matrix, system%mass, given, force)
      force = unbalanced_force(own) - force
      if (allocated(own%carried)) then
        passed_on = 0.0_rk
        call system%operator%add_forces(own%carried, passed_on)
        force = force + own%contact - passed_on
      end if
      call find_start(model, system, plan, now, force, a, error)
      if (.not. allocated(error)) own%a = [a(:n), given(n + 1:)]
    end associate
  end subroutine start_anew

  !> Adds the acceleration by what has changed since the step before: forces, mass and the
  !> acceleration of supports, if that is more than round-off.
  subroutine change_acceleration(model, system, plan, last, now, error)
    type(problem), intent(in) :: model
    type(dam_system), intent(in) :: system
    type(step), intent(in) :: plan
    type(motion), intent(in) :: last !< at the end of the step before
    type(state), intent(inout) :: now
    type(error_type), allocatable, intent(out) :: error
    real(rk), dimension(size(now%motion%a)) :: change, more
    associate (own => now%motion, n => system%matrix%num_free, part => system%matrix%part)
      call multiply(system%matrix, system%mass, own%a, change)
      change = unbalanced_force(own) - unbalanced_force(last) + last%inertia - change
      if (length(part, change(:n)) <= round_off*max(length(part, own%external(:n)), &
                                                    length(part, own%internal(:n)))) return
      call find_start(model, system, plan, now, change, more, error)
      if (.not. allocated(error)) own%a(:n) = own%a(:n) + more(:n)
    end associate
  end subroutine change_acceleration

  !> The largest force in the balance: the reference of the residual [N].
  real(rk) function largest_force(moving, matrix, joint_weight, dt) result(force)
    type(motion), intent(in) :: moving
    type(pattern), intent(in) :: matrix
    real(rk), intent(in) :: joint_weight !< of the joint forces in the balance
    real(rk), intent(in) :: dt !< [s]
    associate (n => matrix%num_free, part => matrix%part)
      force = max(length(part, moving%external(:n)), length(part, moving%internal(:n)), &
                  length(part, moving%inertia(:n)), length(part, moving%viscous(:n)), &
                  joint_weight*length(part, moving%contact(:n)), &
                  stopping_share*length(part, moving%momentum(:n))/dt)
    end associate
  end function largest_force
end module dynamic_step
