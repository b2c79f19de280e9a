!> Static steps. Loads and supports follow their rule of time; increments are as large as the
!> convergence of joints and solids allows. A model of elastic solids without joints is factored
!> once and not iterated.
module static_integrator
  use kinds, only: rk
  use errors, only: error_type
  use problem_definition, only: problem
  use step_plan, only: step, step_before
  use free_blocks, only: exceeds_joints, name_free_block
  use joint_law, only: joint_state
  use joint_water, only: press_grout, update_uplift
  use ranks, only: is_true_everywhere
  use analysis_state, only: state
  use state_transfer, only: start_motion, store_motion, sum_contact
  use increment_listener, only: listener
  use equilibrium, only: balance_outcome
  use global_vectors, only: num_free_in_all
  use guest_forces, only: has_histories
  use step_equilibrium, only: make_equilibrium, prepare_equilibrium
  use step_system, only: build_structure, build_loads, build_origins
  use step_loads, only: load_group, step_time, external_force, gather_loads
  use tangent_choice, only: tangent, choose_tangents
  use energy_account, only: open_account, add_static_work
  use integrator_type, only: integrator
  use static_duals, only: find_duals, is_affordable
  use static_increment, only: take_static_increment
  implicit none
  private
  public :: make_static

  type, extends(integrator) :: static_method
  contains
    procedure :: open_step
    procedure :: advance
    procedure :: store_state
    procedure :: is_hopeless
    procedure :: explain_failure
  end type static_method

  !> Most repetitions of an increment until uplift and joint opening agree.
  integer, parameter :: most_passes = 50

contains

  !> The method, before it has a step.
  subroutine make_static(method)
    class(integrator), allocatable, intent(out) :: method
    allocate (static_method :: method)
  end subroutine make_static

  subroutine open_step(self, model, plan, now, results, error)
    class(static_method), intent(inout) :: self
    type(problem), intent(in) :: model
    type(step), intent(in) :: plan
    type(state), intent(inout) :: now
    class(listener), intent(inout) :: results
    type(error_type), allocatable, intent(out) :: error
    type(tangent), allocatable :: choices(:)
    call build_structure(model, plan, self%system, results%costs, error)
    if (allocated(error)) return
    call build_origins(model, now, self%system, results%costs, error)
    if (allocated(error)) return
    call build_loads(model, plan, now%u, self%system, results%costs)
    call press_grout(plan, self%system%operator, self%system%matrix%num_total, now%joints, &
                     self%system%groups)
    call results%costs%start('analyse', 'structure', 'solver')
    choices = choose_tangents(model, plan)
    call make_equilibrium(plan, self%system, all(choices%is_symmetric()), self%solids%solver, error)
    call results%costs%stop()
    if (allocated(error)) return
    self%solids%solver%costs = results%costs
    call results%costs%start('iterate', 'structure', 'solver')
    call prepare_equilibrium(model, self%system, self%system%stiffness, 1.0_rk, &
                             self%solids%solver, error)
    call results%costs%stop()
    if (allocated(error)) return
    now%num_unknowns = num_free_in_all(self%system%matrix)
    now%joint_condition = max(now%joint_condition, self%solids%solver%condition)
    call start_motion(self%system%numbers, model%joints, now, has_inertia=.false.)
    call self%solids%open(model, self%system, plan, now)
    if (self%solids%has_inelastic()) self%solids%values = self%system%stiffness
    call start_forces(self, model, plan, now)
    call results%costs%start('recover', 'energy', 'solver')
    call open_account(model, self%system, now, now%total_time <= 0.0_rk, plan%changes_stage)
    call results%costs%stop()
  end subroutine open_step

  !> Forces at the start of the step and their residual: initial conditions may leave one, and so
  !> does the motion of a dynamic step before. What a support that goes has carried, or elements and
  !> joints that change, is released over the step; loads that begin at the start are not.
  subroutine start_forces(self, model, plan, now)
    type(static_method), intent(inout) :: self
    type(problem), intent(in) :: model
    type(step), intent(in) :: plan
    type(state), intent(inout) :: now
    logical :: has_changed
    associate (own => now%motion)
      call update_uplift(model, self%system%operator, now%joints, self%system%groups, &
                         self%solids%solver%costs, has_changed)
      call external_force(self%system%groups, model%amplitudes, &
                          step_time(start=now%total_time, duration=plan%duration), own%external)
      call sum_contact(self%system%operator, now)
      own%balanced = own%external - own%internal - own%contact
      if (plan%changes_stage) then
        call find_loads_before(self, model, now, own%release)
        own%release = own%internal + own%contact - own%release
      else
        call find_freed(self, model, plan, now, own%release)
        if (.not. allocated(own%release)) return
      end if
      own%release(self%system%matrix%num_free + 1:) = 0.0_rk
      own%external = own%external + own%release
      own%balanced = own%balanced + own%release
    end associate
  end subroutine start_forces

  !> What supports have carried that are not there any more; not allocated without such supports.
  !> After a dynamic step the reaction contains inertia and damping, which do not act any more:
  !> without them it balances the loads of that step.
  subroutine find_freed(self, model, plan, now, release)
    type(static_method), intent(in) :: self
    type(problem), intent(in) :: model
    type(step), intent(in) :: plan
    type(state), intent(in) :: now !< at the start of the step
    real(rk), allocatable, intent(out) :: release(:) !< (num_total) [N]
    real(rk), allocatable :: reaction(:, :), loads(:)
    integer :: k
    if (.not. allocated(now%reaction)) return
    reaction = now%reaction
    do k = 1, size(plan%fixities)
      reaction(plan%fixities(k)%dof, plan%fixities(k)%node) = 0.0_rk
    end do
    if (is_true_everywhere(all(abs(reaction) <= 0.0_rk))) return
    allocate (release(self%system%matrix%num_total))
    call self%system%numbers%reduce(reaction, release)
    if (.not. follows_motion(model, now%step)) return
    call find_loads_before(self, model, now, loads)
    associate (own => now%motion)
      release = merge(own%internal + own%contact - loads, 0.0_rk, abs(release) > 0.0_rk)
    end associate
  end subroutine find_freed

  !> The loads of the step before at its end, base motion left out, in the unknowns of this step.
  subroutine find_loads_before(self, model, now, force)
    type(static_method), intent(in) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now !< at the start of the step
    real(rk), allocatable, intent(out) :: force(:) !< (num_total) [N]
    type(load_group), allocatable :: groups(:)
    type(step_time) :: when
    logical :: has_changed
    integer :: before
    allocate (force(self%system%matrix%num_total), source=0.0_rk)
    before = step_before(model%steps, now%step)
    if (before == 0) return
    associate (plan => model%steps(before), system => self%system)
      call gather_loads(model, plan, system%numbers, system%matrix, [real(rk) ::], groups, &
                        self%solids%solver%costs)
      call update_uplift(model, system%operator, now%joints, groups, self%solids%solver%costs, &
                         has_changed)
      when = step_time(is_dynamic=plan%procedure%has_inertia, now=plan%duration, &
                       start=now%total_time - plan%duration, duration=plan%duration)
      call external_force(groups, model%amplitudes, when, force)
    end associate
  end subroutine find_loads_before

  !> Whether the last step before that took time was dynamic.
  pure logical function follows_motion(model, number)
    type(problem), intent(in) :: model
    integer, intent(in) :: number !< of the step
    integer :: before
    follows_motion = .false.
    before = step_before(model%steps, number)
    if (before > 0) follows_motion = model%steps(before)%procedure%has_inertia
  end function follows_motion

  !> One increment. Water is where the joints are open at its end.
  subroutine advance(self, model, when, before, after, results, outcome, error)
    class(static_method), intent(inout) :: self
    type(problem), intent(in) :: model
    type(step_time), intent(in) :: when
    type(state), intent(in) :: before
    type(state), intent(inout) :: after
    class(listener), intent(inout) :: results
    type(balance_outcome), intent(out) :: outcome
    type(error_type), allocatable, intent(out) :: error
    call results%costs%start('iterate', 'structure', 'solver')
    call match_uplift(self, model, when, before, after, outcome, error)
    call results%costs%stop('iterate structure')
    if (allocated(error) .or. .not. outcome%has_converged) return
    call results%costs%start('recover', 'energy', 'solver')
    call add_static_work(model, self%system, before, after)
    call results%costs%stop()
  end subroutine advance

  !> Repeats the increment until the uplift agrees with the opening of the joints at its end.
  subroutine match_uplift(self, model, when, before, after, outcome, error)
    class(static_method), intent(inout) :: self
    type(problem), intent(in) :: model
    type(step_time), intent(in) :: when
    type(state), intent(in) :: before
    type(state), intent(inout) :: after
    type(balance_outcome), intent(out) :: outcome
    type(error_type), allocatable, intent(out) :: error
    logical :: has_changed
    integer :: pass
    associate (system => self%system)
      call update_water(before%joints)
      do pass = 1, most_passes
        call take_static_increment(model, system, self%solids, when, before, after, outcome, error)
        if (allocated(error) .or. .not. outcome%has_converged) return
        call update_water(after%joints)
        if (.not. has_changed) return
      end do
    end associate
    outcome%has_converged = .false.
    outcome%failure = 'uplift and opening of joints (*JOINT LAW, PROFILE=OPEN) do not agree: '// &
                      'points open and close alternately'
  contains
    !> Water where the joints are open in these states.
    subroutine update_water(states)
      type(joint_state), intent(in) :: states(:)
      call update_uplift(model, self%system%operator, states, self%system%groups, &
                         self%solids%solver%costs, has_changed)
    end subroutine update_water
  end subroutine match_uplift

  !> Writes the motion to the nodes; at the end of the step the dual solutions follow.
  subroutine store_state(self, model, when, now, results, error)
    class(static_method), intent(inout) :: self
    type(problem), intent(in) :: model
    type(step_time), intent(in) :: when
    type(state), intent(inout) :: now
    class(listener), intent(inout) :: results
    type(error_type), allocatable, intent(out) :: error
    call store_motion(model%mesh, self%system%numbers, now)
    if (.not. now%is_last_of_step) return
    if (has_left_elasticity(self, now) .or. allocated(now%origin)) return
    if (allocated(now%heat%reference)) return
    associate (controls => model%steps(now%step)%controls)
      if (.not. (controls%estimates_errors .and. is_affordable(model, controls))) return
    end associate
    call results%costs%start('estimate', 'mesh', 'output')
    call find_duals(model, self%system, self%solids%solver, now, results%duals)
    call results%costs%stop()
  end subroutine store_state

  !> Whether a solid, or another guest with a history, may not be elastic.
  logical function has_left_elasticity(self, now)
    class(static_method), intent(in) :: self
    type(state), intent(in) :: now
    logical :: are_elastic
    integer :: i
    has_left_elasticity = has_histories(now%guests)
    are_elastic = all([(all(now%points(i)%is_elastic), i=1, size(now%points))])
    are_elastic = is_true_everywhere(are_elastic)
    has_left_elasticity = has_left_elasticity .or. .not. are_elastic
    if (self%solids%has_inelastic()) then
      has_left_elasticity = has_left_elasticity .or. .not. self%solids%matrix%is_elastic
    end if
  end function has_left_elasticity

  !> Whether the loads exceed what the joints can carry.
  logical function is_hopeless(self, model, plan, when, before)
    class(static_method), intent(in) :: self
    type(problem), intent(in) :: model
    type(step), intent(in) :: plan
    type(step_time), intent(in) :: when
    type(state), intent(in) :: before
    is_hopeless = exceeds_joints(model, plan, self%system, before%joints, when)
  end function is_hopeless

  !> Names the block whose motion the joints do not restrain.
  subroutine explain_failure(self, model, plan, when, before, after, error)
    class(static_method), intent(in) :: self
    type(problem), intent(in) :: model
    type(step), intent(in) :: plan
    type(step_time), intent(in) :: when
    type(state), intent(in) :: before, after
    type(error_type), allocatable, intent(inout) :: error
    call name_free_block(model, plan, self%system, before%joints, after%joints, when, error)
  end subroutine explain_failure
end module static_integrator
