!> A static step: loads and supports follow their rule of time, increments are as large as the
!> joints and the solids allow. A scene of elastic solids without joints is factored once and not
!> iterated.
module time_static
  use kinds, only: rk
  use errors, only: error_type
  use matrix_pattern, only: multiply, diagonal
  use problem_definition, only: problem
  use step_plan, only: step
  use joint_forces, only: gather_jumps, gather_tractions
  use free_blocks, only: name_free_block
  use joint_water, only: lead_water, show_water
  use analysis_state, only: state
  use increment_listener, only: listener
  use equilibrium, only: force_balance, balance_outcome
  use step_equilibrium, only: make_equilibrium, prepare_equilibrium, add_moving_supports, &
                              check_bulk
  use step_system, only: dam_system, build_structure, add_couplings, build_loads
  use step_loads, only: step_time, external_force, prescribed_values
  use step_control, only: increment_control, start_control
  use step_report, only: close_increment, give_up
  use user_increments, only: begin_user_increment
  use motion_state, only: motion, start_motion, show_motion, sum_contact, solid_force
  use solid_iteration, only: solid_solver, increment_task
  use tangent_choice, only: tangent, choose_tangents
  use energy_account, only: open_account, add_static_work
  implicit none
  private
  public :: run_static

  !> Of the force that would hold all unknowns but one: below, only round-off is left.
  real(rk), parameter :: idle_share = 1.0e-6_rk

  !> So often an increment is solved anew because water has got further into a joint, or less far.
  integer, parameter :: most_passes = 50

contains

  !> Runs one step from the state `now` to its end, or to the last increment that converged.
  subroutine run_static(scene, plan, now, results, error)
    type(problem), intent(in) :: scene
    type(step), intent(in) :: plan
    type(state), intent(inout) :: now
    class(listener), intent(inout) :: results
    type(error_type), allocatable, intent(out) :: error
    type(dam_system) :: system
    type(motion) :: moving
    type(solid_solver) :: solids
    type(tangent), allocatable :: choices(:)
    call results%costs%start('assemble', 'structure', 'solver')
    call build_structure(scene, plan, system, error)
    if (allocated(error)) return
    call results%costs%start('assemble', 'loads', 'load')
    call build_loads(scene, plan, now%u, system)
    call results%costs%stop()
    call results%costs%stop()
    call add_couplings(scene, system, results%costs)
    call results%costs%start('analyse', 'structure', 'solver')
    choices = choose_tangents(scene, plan)
    call make_equilibrium(plan, system, all(choices%is_symmetric()), solids%solver, error)
    call results%costs%stop()
    if (allocated(error)) return
    solids%solver%costs = results%costs
    call results%costs%start('iterate', 'structure', 'solver')
    call prepare_equilibrium(scene, system, system%stiffness, 1.0_rk, solids%solver, error)
    call results%costs%stop()
    if (allocated(error)) return
    now%num_unknowns = system%matrix%num_free
    now%joint_condition = max(now%joint_condition, solids%solver%condition)
    now%v = 0.0_rk
    now%a = 0.0_rk
    call start_motion(system%numbers, scene%joints, now, moving)
    allocate (moving%stiffness(system%matrix%num_total))
    call diagonal(system%matrix, system%stiffness, moving%stiffness)
    call solids%open(scene, system, choices, moving)
    if (size(moving%points) > 0) solids%values = system%stiffness
    call start_forces(scene, plan, system, now, moving)
    call results%costs%start('recover', 'energy', 'solver')
    call open_account(scene, moving, now%total_time <= 0.0_rk, now%energy)
    call results%costs%stop()
    call walk(scene, plan, system, solids, moving, now, results, error)
  end subroutine run_static

  !> Forces at the start of the step, and what they lack to a balance: initial conditions may leave
  !> something, and so does the motion of a step before.
  subroutine start_forces(scene, plan, system, now, moving)
    type(problem), intent(in) :: scene
    type(step), intent(in) :: plan
    type(dam_system), intent(inout) :: system
    type(state), intent(in) :: now
    type(motion), intent(inout) :: moving
    logical :: has_changed
    call lead_water(scene, system%operator, moving%joints, system%groups, has_changed)
    call external_force(system%groups, scene%amplitudes, &
                        step_time(start=now%total_time, duration=plan%duration), moving%external)
    call multiply(system%matrix, system%stiffness, moving%q, moving%elastic)
    call sum_contact(system%operator, moving)
    moving%balanced = moving%external - moving%elastic - moving%contact
    if (size(moving%released) > 0) moving%balanced = moving%balanced + moving%released
  end subroutine start_forces

  !> Increments until the end of the step.
  subroutine walk(scene, plan, system, solids, moving, now, results, error)
    type(problem), intent(in) :: scene
    type(step), intent(in) :: plan
    type(dam_system), intent(inout) :: system
    type(solid_solver), intent(inout) :: solids
    type(motion), intent(inout) :: moving
    type(state), intent(inout) :: now
    class(listener), intent(inout) :: results
    type(error_type), allocatable, intent(out) :: error
    type(increment_control) :: control
    type(balance_outcome) :: outcome
    type(motion) :: trial
    type(step_time) :: when
    real(rk) :: size_of_increment
    logical :: gives_up
    when = step_time(start=now%total_time, duration=plan%duration)
    call start_control(plan, .false., control)
    do while (now%step_time < plan%duration)
      size_of_increment = control%next_size(now%step_time)
      call when%advance(now%step_time, size_of_increment)
      call begin_user_increment(scene, now, size_of_increment, error)
      if (allocated(error)) return
      call results%costs%start('iterate', 'structure', 'solver')
      call solids%open_increment(now, size_of_increment)
      call settle_water(scene, system, solids, when, moving, trial, outcome, error)
      call results%costs%stop('iterate structure')
      if (allocated(error)) return
      if (.not. outcome%has_converged) then
        call control%cut(size_of_increment, outcome%size_ratio, gives_up)
        if (gives_up) call give_up(scene, system, outcome, control, now, error)
        if (gives_up .and. .not. allocated(outcome%failure)) then
          call name_free_block(scene, plan, system, moving%joints, trial%joints, when, &
                               error)
        end if
        if (gives_up) return
        cycle
      end if
      call results%costs%start('recover', 'energy', 'solver')
      call add_static_work(scene, system%matrix%num_free, moving, trial, now%energy)
      call results%costs%stop()
      moving = trial
      call show_motion(system%numbers, moving, now)
      call show_water(scene, plan%loads, system%groups, when, now%joints, results%costs)
      call control%accept(solids%effort(outcome%own_iterations()))
      call close_increment(scene, plan, when, control, outcome, now, results, error)
      if (allocated(error)) return
    end do
  end subroutine walk

  !> One increment with the water where the joints are open at its end.
  subroutine settle_water(scene, system, solids, when, before, after, outcome, error)
    type(problem), intent(in) :: scene
    type(dam_system), intent(inout) :: system
    type(solid_solver), intent(inout) :: solids
    type(step_time), intent(in) :: when !< the end of the increment
    type(motion), intent(in) :: before
    type(motion), intent(inout) :: after
    type(balance_outcome), intent(out) :: outcome
    type(error_type), allocatable, intent(out) :: error
    logical :: has_changed
    integer :: pass
    call solids%solver%costs%start('update', 'uplift', 'load')
    call lead_water(scene, system%operator, before%joints, system%groups, has_changed)
    call solids%solver%costs%stop()
    do pass = 1, most_passes
      call take_increment(scene, system, solids, when, before, after, outcome, error)
      if (allocated(error) .or. .not. outcome%has_converged) return
      call solids%solver%costs%start('update', 'uplift', 'load')
      call lead_water(scene, system%operator, after%joints, system%groups, has_changed)
      call solids%solver%costs%stop()
      if (.not. has_changed) return
    end do
    outcome%has_converged = .false.
    outcome%failure = 'water and opening of joints (*JOINT LAW, PROFILE=OPEN) do not '// &
                      'settle: points open and close by turns'
  end subroutine settle_water

  !> One increment: K x + B^T (area t) = f1 - K q0 + released for the increment x of the unknowns.
  subroutine take_increment(scene, system, solids, when, before, after, outcome, error)
    type(problem), intent(in) :: scene
    type(dam_system), intent(in) :: system
    type(solid_solver), intent(inout) :: solids
    type(step_time), intent(in) :: when
    type(motion), intent(in) :: before
    type(motion), intent(out) :: after
    type(balance_outcome), intent(out) :: outcome
    type(error_type), allocatable, intent(out) :: error
    type(increment_task) :: task
    real(rk), allocatable :: moved(:), unbalance(:)
    integer :: n
    n = system%matrix%num_free
    after = before
    call external_force(system%groups, scene%amplitudes, when, after%external)
    call prescribed_values(system%supports, scene%amplitudes, when, after%q)
    moved = after%q - before%q
    task%balance%rhs = after%external(:n) - before%elastic(:n)
    call add_moving_supports(system, system%stiffness, moved, task%balance%rhs)
    task%balance%reference = norm2(task%balance%rhs)
    call set_jumps(system, before, after%q, task%balance)
    task%start = after%q
    task%reference = known_force(before, after)
    task%counts_reactions = .true.
    allocate (task%x(size(moved)))
    call solids%solve(scene, system, task, before, after, outcome, error)
    if (allocated(error) .or. .not. outcome%has_converged) return
    after%q = after%q + task%x
    call multiply(system%matrix, system%stiffness, after%q, after%elastic)
    call sum_contact(system%operator, after)
    after%balanced = 0.0_rk
    unbalance = after%external(:n) - after%elastic(:n) - after%contact(:n)
    if (size(after%released) > 0) unbalance = unbalance + after%released(:n)
    after%largest_force = reference_force(before, after)
    call check_bulk(unbalance, after%largest_force, solids%solver%controls%residual_tolerance, &
                    outcome)
  end subroutine take_increment

  !> The largest of the forces before and after, reactions included. A body that carries nothing
  !> (its load went back to zero, or it moves with its supports) is measured by what its stiffness
  !> makes of the last digits of its motion.
  !> Solids that crack may carry nothing in the end: they are measured by what they have carried.
  pure real(rk) function reference_force(before, after) result(force)
    type(motion), intent(in) :: before, after
    force = max(norm2(before%external), norm2(after%external), solid_force(before), &
                solid_force(after), norm2(before%contact), norm2(after%contact), &
                idle_share*norm2(before%stiffness*before%q), &
                idle_share*norm2(after%stiffness*after%q))
    if (size(after%released) > 0) force = max(force, before%largest_force)
  end function reference_force

  !> What of it is known before the increment is solved.
  pure real(rk) function known_force(before, after) result(force)
    type(motion), intent(in) :: before, after
    force = 0.0_rk
    if (size(before%released) == 0) return
    force = max(before%largest_force, norm2(after%external), norm2(before%external), &
                solid_force(before), norm2(before%contact), &
                idle_share*norm2(before%stiffness*before%q))
  end function known_force

  !> Jumps before the free unknowns move, and the first guess: the converged ones. A joint that has
  !> carried nothing yet starts bonded.
  subroutine set_jumps(system, before, q, balance)
    type(dam_system), intent(in) :: system
    type(motion), intent(in) :: before
    real(rk), intent(in) :: q(:) !< supports at the end of the increment
    type(force_balance), intent(inout) :: balance
    real(rk), allocatable :: traction(:, :)
    allocate (balance%offset(3, system%operator%num_points), &
              balance%guess(3, system%operator%num_points), &
              traction(3, system%operator%num_points))
    call system%operator%jumps(q, balance%offset)
    call gather_jumps(system%operator, before%joints, balance%guess)
    call gather_tractions(system%operator, before%joints, traction)
    balance%starts_bonded = .not. any(abs(traction) > 0.0_rk)
  end subroutine set_jumps
end module time_static
