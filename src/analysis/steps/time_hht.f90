!> A dynamic step by the method of Hilber, Hughes & Taylor. The effective matrix is factored once
!> for an increment size; a scene of elastic solids without joints is never iterated.
module time_hht
  use kinds, only: rk
  use errors, only: error_type
  use matrix_pattern, only: multiply, diagonal
  use problem_definition, only: problem
  use step_plan, only: step
  use analysis_state, only: state
  use increment_listener, only: listener
  use joint_forces, only: gather_tractions
  use joint_water, only: lead_water, show_water
  use equilibrium, only: balance_outcome
  use step_equilibrium, only: make_equilibrium, prepare_equilibrium
  use step_system, only: dam_system, build_structure, add_couplings, build_inertia, &
                         build_damping, build_loads
  use step_loads, only: step_time, external_force, prescribed_values
  use step_control, only: increment_control, start_control
  use step_report, only: close_increment, give_up
  use user_increments, only: begin_user_increment
  use motion_state, only: motion, start_motion, show_motion, sum_contact
  use initial_acceleration, only: find_acceleration
  use hht_scheme, only: make_scheme
  use tangent_choice, only: choose_tangents
  use hht_increment, only: stepper, effective_values, take_increment
  use energy_account, only: open_account, add_dynamic_work
  implicit none
  private
  public :: run_dynamic

contains

  !> Runs one step from the state `now` to its end, or to the last increment that converged.
  subroutine run_dynamic(scene, plan, now, results, error)
    type(problem), intent(in) :: scene
    type(step), intent(in) :: plan
    type(state), intent(inout) :: now
    class(listener), intent(inout) :: results
    type(error_type), allocatable, intent(out) :: error
    type(dam_system) :: system
    type(motion) :: moving
    type(stepper) :: tool
    call results%costs%start('assemble', 'structure', 'solver')
    call build_structure(scene, plan, system, error)
    if (.not. allocated(error)) call build_inertia(scene, plan, system, error)
    if (.not. allocated(error)) call build_damping(scene, plan, system, error)
    if (allocated(error)) return
    call results%costs%start('assemble', 'loads', 'load')
    call build_loads(scene, plan, now%u, system)
    call results%costs%stop()
    call results%costs%stop()
    call add_couplings(scene, system, results%costs)
    now%num_unknowns = system%matrix%num_free
    call start_motion(system%numbers, scene%joints, now, moving)
    allocate (moving%stiffness(system%matrix%num_total))
    call diagonal(system%matrix, system%stiffness, moving%stiffness)
    call tool%solids%open(scene, system, choose_tangents(scene, plan), moving)
    call results%costs%start('solve', 'initial acceleration', 'solver')
    call start_dynamic(scene, plan, system, now%total_time, moving, error)
    call results%costs%stop()
    if (allocated(error)) return
    call results%costs%start('recover', 'energy', 'solver')
    call open_account(scene, moving, now%total_time <= 0.0_rk, now%energy)
    call results%costs%stop()
    call show_motion(system%numbers, moving, now)
    call results%increment_done(scene, now, error)
    if (allocated(error)) return
    call results%costs%start('analyse', 'structure', 'solver')
    call make_equilibrium(plan, system, all(tool%solids%choices%is_symmetric()), &
                          tool%solids%solver, error)
    call results%costs%stop()
    if (allocated(error)) return
    tool%solids%solver%costs = results%costs
    call walk(scene, plan, system, tool, moving, now, results, error)
  end subroutine run_dynamic

  !> Forces at the start of the step and the acceleration that balances them. Supports that follow
  !> an amplitude start with its velocity.
  subroutine start_dynamic(scene, plan, system, start, moving, error)
    type(problem), intent(in) :: scene
    type(step), intent(in) :: plan
    type(dam_system), intent(inout) :: system
    real(rk), intent(in) :: start !< total time [s]
    type(motion), intent(inout) :: moving
    type(error_type), allocatable, intent(out) :: error
    type(step_time) :: when
    real(rk), allocatable :: acting(:)
    logical :: has_changed
    when = step_time(is_dynamic=.true., start=start, duration=plan%duration)
    call lead_water(scene, system%operator, moving%joints, system%groups, has_changed)
    call external_force(system%groups, scene%amplitudes, when, moving%external)
    call start_supports(scene, system, when, 1.0e-3_rk*plan%first_increment, moving%v)
    call multiply(system%matrix, system%stiffness, moving%q, moving%elastic)
    call multiply(system%matrix, system%mass, moving%v, moving%momentum)
    if (size(system%damping) > 0) then
      call multiply(system%matrix, system%damping, moving%v, moving%viscous)
    end if
    call sum_contact(system%operator, moving)
    call gather_tractions(system%operator, moving%joints, moving%carried)
    acting = moving%external - moving%elastic - moving%viscous - moving%contact
    if (size(moving%released) > 0) acting = acting + moving%released
    call find_acceleration(system%matrix, system%mass, system%numbers%node, acting, moving%a, error)
    call multiply(system%matrix, system%mass, moving%a, moving%inertia)
    moving%balanced = moving%inertia
    call multiply(system%matrix, system%stiffness, moving%v, moving%elastic_rate)
    call multiply(system%matrix, system%stiffness, moving%a, moving%elastic_jerk)
    if (size(system%damping) > 0) then
      call multiply(system%matrix, system%damping, moving%a, moving%viscous_rate)
    end if
  end subroutine start_dynamic

  !> Velocities of supports that follow an amplitude; the others stand still.
  subroutine start_supports(scene, system, when, instant, v)
    type(problem), intent(in) :: scene
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
    call prescribed_values(system%supports, scene%amplitudes, when, first)
    call prescribed_values(system%supports, scene%amplitudes, later, last)
    do i = 1, size(system%supports)
      associate (k => system%supports(i)%unknown)
        v(k) = (last(k) - first(k))/instant
      end associate
    end do
  end subroutine start_supports

  !> Increments until the end of the step.
  subroutine walk(scene, plan, system, tool, start, now, results, error)
    type(problem), intent(in) :: scene
    type(step), intent(in) :: plan
    type(dam_system), intent(inout) :: system
    type(stepper), intent(inout) :: tool
    type(motion), intent(in) :: start
    type(state), intent(inout) :: now
    class(listener), intent(inout) :: results
    type(error_type), allocatable, intent(out) :: error
    type(increment_control) :: control
    type(balance_outcome) :: outcome
    type(motion), allocatable :: moving, trial
    type(step_time) :: when
    real(rk) :: dt
    logical :: gives_up, has_changed
    when = step_time(is_dynamic=.true., start=now%total_time, duration=plan%duration)
    allocate (moving, trial, source=start)
    call start_control(plan, .true., control)
    do while (now%step_time < plan%duration)
      dt = control%next_size(now%step_time)
      call when%advance(now%step_time, dt)
      call begin_user_increment(scene, now, dt, error)
      if (allocated(error)) return
      call prepare_size(scene, plan, system, dt, results, tool, error)
      if (allocated(error)) return
      call tool%solids%open_increment(now, dt)
      call results%costs%start('iterate', 'structure', 'solver')
      call results%costs%start('update', 'uplift', 'load')
      call lead_water(scene, system%operator, moving%joints, system%groups, has_changed)
      call results%costs%stop()
      call take_increment(scene, system, tool, when, moving, trial, outcome, error)
      call results%costs%stop('iterate structure')
      if (allocated(error)) return
      if (.not. outcome%has_converged) then
        call control%cut(dt, outcome%size_ratio, gives_up)
        if (gives_up) call give_up(scene, system, outcome, control, now, error)
        if (gives_up) return
        cycle
      end if
      call results%costs%start('recover', 'energy', 'solver')
      call add_dynamic_work(tool%scheme, scene, system%matrix%num_free, moving, trial, &
                            now%energy)
      call results%costs%stop()
      call swap(moving, trial)
      call show_motion(system%numbers, moving, now)
      call show_water(scene, plan%loads, system%groups, when, now%joints, results%costs)
      now%joint_condition = max(now%joint_condition, tool%solids%solver%condition)
      call control%accept(tool%solids%effort(outcome%own_iterations()))
      call close_increment(scene, plan, when, control, outcome, now, results, error)
      if (allocated(error)) return
    end do
  end subroutine walk

  !> Factors the effective matrix when the size of the increment is a new one.
  subroutine prepare_size(scene, plan, system, dt, results, tool, error)
    type(problem), intent(in) :: scene
    type(step), intent(in) :: plan
    type(dam_system), intent(in) :: system
    real(rk), intent(in) :: dt !< [s]
    class(listener), intent(inout) :: results
    type(stepper), intent(inout) :: tool
    type(error_type), allocatable, intent(out) :: error
    if (abs(dt - tool%scheme%dt) <= 1.0e-12_rk*dt) return
    tool%scheme = make_scheme(plan%alpha, dt, plan%controls%joint_forces)
    call effective_values(system, tool%scheme, tool%solids%values)
    tool%solids%weight = 1.0_rk + plan%alpha
    tool%solids%matrix%is_elastic = .true.
    call results%costs%start('iterate', 'structure', 'solver')
    call prepare_equilibrium(scene, system, tool%solids%values, tool%scheme%joint_weight, &
                             tool%solids%solver, error)
    call results%costs%stop()
  end subroutine prepare_size

  !> Accepts the trial, without a copy.
  subroutine swap(converged, trial)
    type(motion), allocatable, intent(inout) :: converged, trial
    type(motion), allocatable :: other
    call move_alloc(converged, other)
    call move_alloc(trial, converged)
    call move_alloc(other, trial)
  end subroutine swap
end module time_hht
