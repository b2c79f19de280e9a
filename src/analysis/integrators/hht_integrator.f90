!> Dynamic steps by the method of Hilber, Hughes & Taylor (theory.md, 7). The effective matrix is
!> factored once for an increment size; a model of elastic solids without joints is not iterated.
module hht_integrator
  use kinds, only: rk
  use errors, only: error_type
  use global_vectors, only: multiply
  use problem_definition, only: problem
  use step_plan, only: step
  use analysis_state, only: state
  use state_transfer, only: start_motion, store_motion, sum_contact
  use increment_listener, only: listener
  use joint_forces, only: gather_tractions
  use joint_water, only: update_uplift
  use equilibrium, only: balance_outcome
  use step_equilibrium, only: make_equilibrium, prepare_equilibrium
  use step_system, only: dam_system, build_structure, build_inertia, build_damping, &
                         build_loads
  use step_loads, only: step_time, external_force, prescribed_values
  use initial_acceleration, only: find_acceleration
  use hht_scheme, only: hht, make_scheme
  use tangent_choice, only: choose_tangents
  use energy_account, only: open_account, add_dynamic_work
  use solid_iteration, only: solid_solver
  use integrator_type, only: integrator
  implicit none
  private
  public :: hht_method

  type, extends(integrator) :: hht_method
    type(hht) :: scheme !< of the present increment size
  contains
    procedure :: open_step
    procedure :: start_increment
    procedure :: advance
    procedure, private :: take_increment
  end type hht_method

  interface
    !> Goes from `before` to `after`. Without convergence `after` is of no use.
    module subroutine take_increment(self, model, when, before, after, outcome, error)
      implicit none
      class(hht_method), intent(inout) :: self
      type(problem), intent(in) :: model
      type(step_time), intent(in) :: when !< the end of the increment
      type(state), intent(in) :: before
      type(state), intent(inout) :: after
      type(balance_outcome), intent(out) :: outcome
      type(error_type), allocatable, intent(out) :: error
    end subroutine take_increment
  end interface

contains

  subroutine open_step(self, model, plan, now, results, error)
    class(hht_method), intent(inout) :: self
    type(problem), intent(in) :: model
    type(step), intent(in) :: plan
    type(state), intent(inout) :: now
    class(listener), intent(inout) :: results
    type(error_type), allocatable, intent(out) :: error
    associate (costs => results%costs)
      call build_structure(model, plan, self%system, costs, error)
      if (.not. allocated(error)) call build_inertia(model, plan, self%system, costs, error)
      if (.not. allocated(error)) call build_damping(model, plan, self%system, costs, error)
      if (allocated(error)) return
    end associate
    call build_loads(model, plan, now%u, self%system, results%costs)
    now%num_unknowns = self%system%matrix%num_free
    call start_motion(self%system%numbers, model%joints, now, has_inertia=.true.)
    call self%solids%open(model, self%system, choose_tangents(model, plan), now)
    call results%costs%start('solve', 'initial acceleration', 'solver')
    call start_dynamic(self%system, model, plan, now, error)
    call results%costs%stop()
    if (allocated(error)) return
    call results%costs%start('recover', 'energy', 'solver')
    call open_account(model, self%system%diagonal, now, now%total_time <= 0.0_rk)
    call results%costs%stop()
    if (now%increment == 0) then ! not where a loaded state goes on in the middle of the step
      call store_motion(self%system%numbers, now)
      call results%increment_done(model, now, error)
      if (allocated(error)) return
    end if
    call results%costs%start('analyse', 'structure', 'solver')
    call make_equilibrium(plan, self%system, all(self%solids%choices%is_symmetric()), &
                          self%solids%solver, error)
    call results%costs%stop()
    if (.not. allocated(error)) self%solids%solver%costs = results%costs
  end subroutine open_step

  !> Forces at the start of the step and the acceleration that balances them. Supports that follow
  !> an amplitude start with its velocity.
  subroutine start_dynamic(system, model, plan, now, error)
    type(dam_system), intent(inout) :: system
    type(problem), intent(in) :: model
    type(step), intent(in) :: plan
    type(state), intent(inout) :: now
    type(error_type), allocatable, intent(out) :: error
    type(step_time) :: when
    logical :: has_changed
    when = step_time(is_dynamic=.true., start=now%total_time, duration=plan%duration)
    associate (own => now%motion)
      call update_uplift(model, system%operator, now%joints, system%groups, has_changed)
      call external_force(system%groups, model%amplitudes, when, own%external)
      call start_supports(model, system, when, 1.0e-3_rk*plan%first_increment, own%v)
      call multiply(system%matrix, system%mass, own%v, own%momentum)
      if (size(system%damping) > 0) then
        call multiply(system%matrix, system%damping, own%v, own%viscous)
      end if
      call sum_contact(system%operator, now)
      call gather_tractions(system%operator, now%joints, own%carried)
      call find_acceleration(system%matrix, system%mass, system%numbers%node, &
                             own%external - own%internal - own%viscous - own%contact, own%a, error)
      call multiply(system%matrix, system%mass, own%a, own%inertia)
      own%balanced = own%inertia
      call multiply(system%matrix, system%stiffness, own%v, own%elastic_rate)
      call multiply(system%matrix, system%stiffness, own%a, own%elastic_jerk)
      if (size(system%damping) > 0) then
        call multiply(system%matrix, system%damping, own%a, own%viscous_rate)
      end if
    end associate
  end subroutine start_dynamic

  !> Velocities of supports that follow an amplitude; the others stand still.
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

  !> Factors the effective matrix when the size of the increment is a new one.
  subroutine start_increment(self, model, plan, size, results, error)
    class(hht_method), intent(inout) :: self
    type(problem), intent(in) :: model
    type(step), intent(in) :: plan
    real(rk), intent(in) :: size
    class(listener), intent(inout) :: results
    type(error_type), allocatable, intent(out) :: error
    if (abs(size - self%scheme%dt) <= 1.0e-12_rk*size) return
    self%scheme = make_scheme(plan%alpha, size, plan%controls%joint_forces)
    call effective_values(self%system, self%scheme, self%solids%values)
    self%solids%weight = 1.0_rk + plan%alpha
    self%solids%matrix%is_elastic = .true.
    call results%costs%start('iterate', 'structure', 'solver')
    call prepare_equilibrium(model, self%system, self%solids%values, self%scheme%joint_weight, &
                             self%solids%solver, error)
    call results%costs%stop()
  end subroutine start_increment

  !> Values of K_eff, without joints.
  subroutine effective_values(system, scheme, values)
    type(dam_system), intent(in) :: system
    type(hht), intent(in) :: scheme
    real(rk), allocatable, intent(out) :: values(:)
    values = (1.0_rk + scheme%alpha)*system%stiffness + scheme%acceleration_of_x*system%mass
    if (size(system%damping) > 0) then
      values = values + (1.0_rk + scheme%alpha)*scheme%velocity_of_x*system%damping
    end if
  end subroutine effective_values

  !> One increment with the water where the joints were open at its start.
  subroutine advance(self, model, when, before, after, results, outcome, error)
    class(hht_method), intent(inout) :: self
    type(problem), intent(in) :: model
    type(step_time), intent(in) :: when
    type(state), intent(in) :: before
    type(state), intent(inout) :: after
    class(listener), intent(inout) :: results
    type(balance_outcome), intent(out) :: outcome
    type(error_type), allocatable, intent(out) :: error
    logical :: has_changed
    call results%costs%start('iterate', 'structure', 'solver')
    call results%costs%start('update', 'uplift', 'load')
    call update_uplift(model, self%system%operator, before%joints, self%system%groups, has_changed)
    call results%costs%stop()
    call self%take_increment(model, when, before, after, outcome, error)
    call results%costs%stop('iterate structure')
    if (allocated(error) .or. .not. outcome%has_converged) return
    after%joint_condition = max(after%joint_condition, self%solids%solver%condition)
    call results%costs%start('recover', 'energy', 'solver')
    call add_dynamic_work(self%scheme, model, self%system, before, after)
    call results%costs%stop()
  end subroutine advance
end module hht_integrator
