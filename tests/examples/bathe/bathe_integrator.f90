!> Dynamic steps by the composite method of Bathe: the worked example of a time integrator.
!>
!> An increment has two parts. The first, of length gamma dt, is the trapezoidal rule; the second is
!> the three-point backward Euler formula (K.-J. Bathe, Conserving energy and momentum in nonlinear
!> dynamics: A simple implicit time integration scheme, Computers & Structures 85 (2007) 437-445).
!> With gamma = 2 - sqrt(2) both parts have the same effective matrix. In each part, x is the change
!> of the unknowns, and
!>
!>   v = v^ + c x,   a = a^ + c^2 x,   c = 2/(gamma dt)
!>   (c^2 M + c C + K) x + B^T (area t) = f - M a^ - C v^ - K u0 + s
!>
!> with the forces of joints t, of inelastic solids s and of loads f at the end of the part. The
!> scheme is of second order, has no parameter, and damps motion that dt does not resolve within one
!> increment.
module bathe_integrator
  use kinds, only: rk
  use errors, only: deck_is_wrong, error_type, raise
  use global_vectors, only: length, multiply, work
  use problem_definition, only: problem
  use step_plan, only: step
  use analysis_state, only: motion, state
  use state_transfer, only: sum_contact
  use increment_listener, only: listener
  use joint_water, only: update_uplift
  use equilibrium, only: balance_outcome
  use step_equilibrium, only: add_moving_supports, prepare_equilibrium, set_modal_damping
  use step_system, only: dam_system
  use step_loads, only: external_force, prescribed_values, step_time
  use dynamic_step, only: largest_force, open_dynamic_step
  use energy_account, only: add_dynamic_work
  use increment_balance, only: increment_task
  use integrator_type, only: integrator
  implicit none
  private
  public :: make_bathe

  real(rk), parameter :: gamma = 2.0_rk - sqrt(2.0_rk) !< length of the first part over dt

  type, extends(integrator) :: bathe_method
    real(rk) :: dt = 0.0_rk !< [s]
    real(rk) :: c = 0.0_rk !< velocity of x [1/s]
    type(state), allocatable :: middle !< end of the first part
  contains
    procedure :: open_step
    procedure :: start_increment
    procedure :: advance
  end type bathe_method

contains

  !> The method, before it has a step.
  subroutine make_bathe(method)
    class(integrator), allocatable, intent(out) :: method
    allocate (bathe_method :: method)
  end subroutine make_bathe

  subroutine open_step(self, model, plan, now, results, error)
    class(bathe_method), intent(inout) :: self
    type(problem), intent(in) :: model
    type(step), intent(in) :: plan
    type(state), intent(inout) :: now
    class(listener), intent(inout) :: results
    type(error_type), allocatable, intent(out) :: error
    if (allocated(now%origin) .or. allocated(now%heat%reference)) then
      call raise(error, 'SCHEME=BATHE has no strains without stress: no *MODEL CHANGE and no '// &
                 '*TEMPERATURE with *EXPANSION', deck_is_wrong)
      return
    end if
    call open_dynamic_step(model, plan, self%system, self%solids, now, results, error)
    if (allocated(error)) return
    allocate (self%middle, source=now)
  end subroutine open_step

  !> Factors the effective matrix when the size of the increment has changed.
  subroutine start_increment(self, model, plan, dt, results, error)
    class(bathe_method), intent(inout) :: self
    type(problem), intent(in) :: model
    type(step), intent(in) :: plan
    real(rk), intent(in) :: dt
    class(listener), intent(inout) :: results
    type(error_type), allocatable, intent(out) :: error
    if (abs(dt - self%dt) <= 1.0e-12_rk*dt) return
    self%dt = dt
    self%c = 2.0_rk/(gamma*dt)
    associate (system => self%system, c => self%c)
      self%solids%values = system%stiffness + c**2*system%mass
      call system%add_damping(c, self%solids%values)
    end associate
    call self%solids%matrix%start_elastic(dt)
    call results%costs%start('iterate', 'structure', 'solver')
    call set_modal_damping(self%system, self%c, self%solids%solver)
    call prepare_equilibrium(model, self%system, self%solids%values, 1.0_rk, self%solids%solver, &
                             error)
    call results%costs%stop()
  end subroutine start_increment

  !> Both parts of an increment.
  subroutine advance(self, model, when, before, after, results, outcome, error)
    class(bathe_method), intent(inout) :: self
    type(problem), intent(in) :: model
    type(step_time), intent(in) :: when
    type(state), intent(in) :: before
    type(state), intent(inout) :: after
    class(listener), intent(inout) :: results
    type(balance_outcome), intent(out) :: outcome
    type(error_type), allocatable, intent(out) :: error
    type(state), allocatable :: middle
    type(balance_outcome) :: first
    type(step_time) :: halfway, last
    call move_alloc(self%middle, middle)
    halfway = when
    call halfway%set_end(before%step_time, gamma*when%increment)
    last = when
    last%increment = when%now - halfway%now
    middle%increment_status = before%increment_status
    call predict_trapezoidal(self%c, before%motion, middle%motion)
    call solve_part(self, model, halfway, before, middle, results, outcome, error)
    if (.not. allocated(error) .and. outcome%has_converged) then
      first = outcome
      call add_work(self, model, before, middle, 0.0_rk, results)
      middle%step_time = halfway%now
      middle%total_time = when%start + halfway%now
      after%energy = middle%energy
      call predict_euler(self%c, when%increment, before%motion, middle%motion, after%motion)
      call solve_part(self, model, last, middle, after, results, outcome, error)
      outcome%iterations = max(outcome%iterations, first%iterations)
      outcome%residual = max(outcome%residual, first%residual)
    end if
    if (.not. allocated(error) .and. outcome%has_converged) then
      call add_work(self, model, middle, after, &
                    euler_excess(when%increment, before%motion, middle%motion, after%motion), &
                    results)
    end if
    call move_alloc(middle, self%middle)
  end subroutine advance

  !> Adds the work of a part to the energies of its end.
  subroutine add_work(self, model, before, after, excess, results)
    class(bathe_method), intent(in) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: before
    type(state), intent(inout) :: after
    real(rk), intent(in) :: excess !< change of the kinetic energy beyond du . M a_mean [J]
    class(listener), intent(inout) :: results
    call results%costs%start('recover', 'energy', 'solver')
    call add_dynamic_work(model, self%system, before, after, excess)
    call results%costs%stop()
  end subroutine add_work

  !> v^ and a^ of the first part. The trapezoidal rule is v = 2 x/h - v0 and a = 2 (v - v0)/h - a0.
  subroutine predict_trapezoidal(c, before, after)
    real(rk), intent(in) :: c !< 2/h [1/s]
    type(motion), intent(in) :: before
    type(motion), intent(inout) :: after
    after%q = before%q
    after%v = -before%v
    after%a = -2.0_rk*c*before%v - before%a
  end subroutine predict_trapezoidal

  !> v^ and a^ of the second part: v = c1 u0 + c2 u1 + c u2 and a = c1 v0 + c2 v1 + c v2, where
  !> c1 + c2 + c = 0.
  subroutine predict_euler(c, dt, before, middle, after)
    real(rk), intent(in) :: c !< [1/s]
    real(rk), intent(in) :: dt !< [s]
    type(motion), intent(in) :: before, middle
    type(motion), intent(inout) :: after
    real(rk) :: c1, c2
    c1 = (1.0_rk - gamma)/(gamma*dt)
    c2 = -1.0_rk/((1.0_rk - gamma)*gamma*dt)
    after%q = middle%q
    after%v = c1*(before%q - middle%q)
    after%a = c1*before%v + c2*middle%v + c*after%v
  end subroutine predict_euler

  !> Goes from `before` to `after`, which contains the prediction. Water is where the joints were
  !> open at the start. Without convergence `after` is invalid.
  subroutine solve_part(self, model, when, before, after, results, outcome, error)
    class(bathe_method), intent(inout) :: self
    type(problem), intent(in) :: model
    type(step_time), intent(in) :: when !< the end of the part
    type(state), intent(in) :: before
    type(state), intent(inout) :: after
    class(listener), intent(inout) :: results
    type(balance_outcome), intent(out) :: outcome
    type(error_type), allocatable, intent(out) :: error
    type(increment_task) :: task
    real(rk) :: acceleration(self%system%matrix%num_total)
    logical :: has_changed
    call results%costs%start('iterate', 'structure', 'solver')
    call update_uplift(model, self%system%operator, before%joints, self%system%groups, &
                       results%costs, has_changed)
    call self%solids%open_increment(before, when%increment)
    call pose_task(self, model, when, before, after, acceleration, task)
    do
      call self%solids%solve_increment(model, self%system, task, before, after, outcome, error)
      if (allocated(error) .or. .not. outcome%has_converged) exit
      call correct(self, task, acceleration, when%increment, after, outcome)
      if (.not. task%is_refined) exit
    end do
    call results%costs%stop('iterate structure')
  end subroutine solve_part

  !> The problem of a part: loads and supports at its end.
  subroutine pose_task(self, model, when, before, after, acceleration, task)
    class(bathe_method), intent(in) :: self
    type(problem), intent(in) :: model
    type(step_time), intent(in) :: when !< the end of the part
    type(state), intent(in) :: before
    type(state), intent(inout) :: after !< predicted
    real(rk), intent(out) :: acceleration(:) !< (num_total) at x = 0, supports in place [m/s2]
    type(increment_task), intent(out) :: task
    real(rk) :: moved(size(acceleration)) ! x of the supports
    associate (system => self%system, new => after%motion, n => self%system%matrix%num_free)
      call external_force(system%groups, model%amplitudes, when, new%external)
      moved = new%q
      call prescribed_values(system%supports, model%amplitudes, when, moved)
      moved = moved - new%q
      call find_rate_forces(system, new)
      task%balance%rhs = new%external(:n) - new%inertia(:n) - new%viscous(:n) &
                         - before%motion%elastic(:n)
      call add_moving_supports(system, self%solids%values, moved, task%balance%rhs)
      task%start = new%q + moved
      task%velocity = new%v + self%c*moved
      task%velocity_of_x = self%c
      acceleration = new%a + self%c**2*moved
      task%balance%reference_force = largest_force(before%motion, system%matrix, 1.0_rk, &
                                                   when%increment)
      if (self%solids%has_inelastic()) then
        task%reference_force = max(task%balance%reference_force, before%largest_force, &
                                   length(system%matrix%part, new%external(:n)))
      end if
      call task%balance%set_jumps(system%operator, task%start, before%joints)
      allocate (task%x(system%matrix%num_total))
    end associate
  end subroutine pose_task

  !> Motion and forces at the end of a part, and their residual.
  subroutine correct(self, task, acceleration, dt, after, outcome)
    class(bathe_method), intent(in) :: self
    type(increment_task), intent(inout) :: task
    real(rk), intent(in) :: acceleration(:) !< (num_total) at x = 0 [m/s2]
    real(rk), intent(in) :: dt !< length of the part [s]
    type(state), intent(inout) :: after
    type(balance_outcome), intent(inout) :: outcome
    associate (system => self%system, new => after%motion, n => self%system%matrix%num_free)
      new%q = task%start + task%x
      new%v = task%velocity + self%c*task%x
      new%a = acceleration + self%c**2*task%x
      call find_rate_forces(system, new)
      call multiply(system%matrix, system%stiffness, new%q, new%elastic)
      call self%solids%set_internal(new)
      call sum_contact(system%operator, after)
      new%balanced = new%external - new%viscous - new%internal - new%contact
      after%largest_force = max(task%balance%reference_force, task%reference_force, &
                                length(system%matrix%part, new%internal), &
                                largest_force(new, system%matrix, 1.0_rk, dt))
      after%joint_condition = max(after%joint_condition, self%solids%solver%condition)
      call task%check_balance(system%matrix%part, new%balanced(:n) - new%inertia(:n), &
                              after%largest_force, outcome)
    end associate
  end subroutine correct

  !> M v, M a and C v.
  subroutine find_rate_forces(system, moving)
    type(dam_system), intent(in) :: system
    type(motion), intent(inout) :: moving
    call multiply(system%mass_pattern, system%mass_entries, moving%v, moving%momentum)
    call multiply(system%mass_pattern, system%mass_entries, moving%a, moving%inertia)
    call system%find_damping_force(moving%v, moving%viscous)
  end subroutine find_rate_forces

  !> Change of the kinetic energy in the second part beyond du . M a_mean. In the first part the two
  !> are equal. With du = h/2 (v1 + v2) + e_u and dv = h/2 (a1 + a2) + e_v it is
  !> e_v . M v_mean - e_u . M a_mean.
  real(rk) function euler_excess(dt, before, middle, after) result(excess)
    real(rk), intent(in) :: dt !< of the increment [s]
    type(motion), intent(in) :: before, middle, after
    real(rk), dimension(size(after%q)) :: e_u, e_v
    e_u = beyond_trapezoidal(dt, before%v, middle%v, after%v)
    e_v = beyond_trapezoidal(dt, before%a, middle%a, after%a)
    excess = work(e_v, middle%momentum, after%momentum) - work(e_u, middle%inertia, after%inertia)
  end function euler_excess

  !> Integral of a rate over the second part by the formulas of the scheme, less that of the
  !> trapezoidal rule.
  elemental real(rk) function beyond_trapezoidal(dt, rate0, rate1, rate2) result(rest)
    real(rk), intent(in) :: dt !< [s]
    real(rk), intent(in) :: rate0, rate1, rate2 !< at the start, in the middle, at the end
    rest = 0.5_rk*dt*(gamma*rate2 + 0.5_rk*gamma*(1.0_rk - gamma)*(rate0 + rate1) &
                      - (1.0_rk - gamma)*(rate1 + rate2))
  end function beyond_trapezoidal
end module bathe_integrator
