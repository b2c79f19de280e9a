!> Dynamic steps by the method of Hilber, Hughes & Taylor (theory.md, 7). The effective matrix is
!> factored once for an increment size; a model of elastic solids without joints is not iterated.
module hht_integrator
  use kinds, only: rk
  use errors, only: error_type
  use global_vectors, only: dot, multiply, work
  use problem_definition, only: problem
  use resumed_modes, only: resume_modal_error
  use step_plan, only: step
  use analysis_state, only: motion, state
  use state_transfer, only: sum_contact
  use increment_listener, only: listener
  use joint_forces, only: gather_tractions
  use joint_water, only: update_uplift
  use dual_solutions, only: of_displacement, of_opening
  use equilibrium, only: balance_outcome, equilibrium_solver
  use guest_forces, only: has_histories
  use step_equilibrium, only: prepare_equilibrium, set_modal_damping
  use step_system, only: dam_system
  use step_loads, only: step_time, external_force, prescribed_values
  use dynamic_step, only: make_step_solver, open_dynamic_step
  use hht_scheme, only: hht, make_scheme
  use kept_solvers, only: solver_shelf
  use energy_account, only: add_dynamic_work
  use solid_iteration, only: solid_solver
  use support_rates, only: find_slopes, has_moving_supports
  use state_transfer, only: store_motion
  use opening_error, only: count_broken, error_of_opening, mesh_error_of_opening, note_opening, &
                           rocks
  use time_error, only: error_modes, make_error_modes, note_largest, &
                        note_lost_forces, start_mesh_error, start_modal_error, take_modal_error
  use integrator_type, only: integrator
  use matrix_pattern, only: pattern
  use node_parts, only: gather_field
  use ranks, only: is_first_rank
  use unknown_parts, only: unknown_part
  implicit none
  private
  public :: make_hht

  type, extends(integrator) :: hht_method
    type(hht) :: scheme !< of the present increment size
    type(solver_shelf) :: shelf !< solvers of other sizes, with *CONTROLS, ACCURACY
    logical :: has_active_part = .false. !< solves are repeated for the unknowns of inelastic solids
    type(error_modes) :: modes !< of the estimate of the error in time; empty without it
  contains
    procedure :: open_step
    procedure :: resume
    procedure :: start_increment
    procedure :: advance
    procedure :: store_state
    procedure, private :: take_increment
  end type hht_method

  interface
    !> Goes from `before` to `after`. Without convergence `after` is invalid.
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

  !> The method, before it has a step.
  subroutine make_hht(method)
    class(integrator), allocatable, intent(out) :: method
    allocate (hht_method :: method)
  end subroutine make_hht

  subroutine open_step(self, model, plan, now, results, error)
    class(hht_method), intent(inout) :: self
    type(problem), intent(in) :: model
    type(step), intent(in) :: plan
    type(state), intent(inout) :: now
    class(listener), intent(inout) :: results
    type(error_type), allocatable, intent(out) :: error
    call open_dynamic_step(model, plan, self%system, self%solids, now, results, error)
    if (allocated(error)) return
    call start_rates(self%system, now)
    self%has_active_part = self%solids%has_inelastic() .and. .not. has_histories(now%guests)
    if (self%solids%has_inelastic() .or. .not. plan%estimates_by_modes()) return
    call results%costs%start('estimate', 'time', 'output')
    call make_error_modes(model, self%system, self%solids%solver, self%modes)
    if (allocated(self%modes%square)) call follow_modes(self, model, plan, now)
    call results%costs%stop()
    if (allocated(self%modes%square)) call weigh_shapes(self, model, now, results)
  end subroutine open_step

  !> The errors in time of a checkpoint belong to its modes.
  subroutine resume(self, now, error)
    class(hht_method), intent(inout) :: self
    type(state), intent(inout) :: now
    type(error_type), allocatable, intent(out) :: error
    if (allocated(self%modes%square)) call resume_modal_error(self%modes, now%motion, now%timing)
  end subroutine resume

  !> Starts the exact motion of the modes.
  subroutine follow_modes(self, model, plan, now)
    type(hht_method), intent(in) :: self
    type(problem), intent(in) :: model
    type(step), intent(in) :: plan
    type(state), intent(inout) :: now
    type(step_time) :: start
    real(rk) :: placed(size(now%motion%q))
    start = step_time(is_dynamic=.true., start=now%total_time, duration=plan%duration)
    placed = now%motion%q
    call prescribed_values(self%system%supports, model%amplitudes, start, placed)
    call start_modal_error(self%modes, now%motion, placed, now%timing)
    now%timing%num_broken = count_broken(now%joints)
  end subroutine follow_modes

  !> Prepares the estimate of the error of the mesh.
  subroutine weigh_shapes(self, model, now, results)
    type(hht_method), intent(in) :: self
    type(problem), intent(in) :: model
    type(state), intent(inout) :: now
    class(listener), intent(inout) :: results
    real(rk), allocatable :: shape(:, :, :), field(:, :), q(:), stiffening(:)
    integer :: k
    call results%costs%start('estimate', 'mesh', 'output')
    associate (modes => self%modes, numbers => self%system%numbers)
      allocate (shape(3, merge(numbers%num_nodes, 0, is_first_rank()), size(modes%square)))
      allocate (q(numbers%num_total), source=0.0_rk)
      allocate (field(3, numbers%num_nodes))
      do k = 1, size(modes%square)
        q(:size(modes%shape, 1)) = modes%shape(:, k)
        call numbers%expand(q, field)
        call gather_field(model%mesh, field)
        if (is_first_rank()) shape(:, :, k) = field
      end do
      call results%stiffening_of_modes(model, shape, stiffening)
      if (allocated(stiffening)) call start_mesh_error(modes, stiffening, now%timing)
    end associate
    call results%costs%stop()
  end subroutine weigh_shapes

  !> Writes the motion of a converged increment to the nodes, and reports its error.
  subroutine store_state(self, model, when, now, results, error)
    class(hht_method), intent(inout) :: self
    type(problem), intent(in) :: model
    type(step_time), intent(in) :: when
    type(state), intent(inout) :: now
    class(listener), intent(inout) :: results
    type(error_type), allocatable, intent(out) :: error
    real(rk), allocatable :: moved(:)
    real(rk) :: slopes(size(now%motion%q))
    call store_motion(model%mesh, self%system%numbers, now)
    if (.not. allocated(self%modes%square)) return
    call results%costs%start('estimate', 'time', 'output')
    associate (own => now%timing)
      call find_slopes(model, self%system, when, slopes)
      call take_modal_error(self%modes, self%scheme%dt, now%motion, slopes, own, moved)
      call note_largest(model%mesh, self%system%numbers, self%modes, now%u, own)
      results%time_error = [own%largest, abs(own%at_largest), &
                            own%most/max(tiny(1.0_rk), own%motion)]
      results%mesh_error = -1.0_rk
      if (size(now%joints) == 0 .and. allocated(own%softer)) then
        results%mesh_error(of_displacement) = abs(own%mesh_at_largest)
      else if (size(now%joints) > 0) then
        call note_lost_forces(self%modes, now%motion, own)
        call note_opening(now%joints, now%motion%jump_rate, self%scheme%dt, moved, own)
        results%opening_error = error_of_opening(own)
        results%mesh_error(of_opening) = mesh_error_of_opening(own)
        ! Bodies that rock or slide do not follow the modes.
        if (rocks(own) .or. now%energy%shows_sliding()) results%time_error(2:3) = -1.0_rk
      end if
    end associate
    call results%costs%stop()
  end subroutine store_state

  !> The vectors that HHT passes from one increment to the next, at the start of a step.
  subroutine start_rates(system, now)
    type(dam_system), intent(in) :: system
    type(state), intent(inout) :: now
    associate (own => now%motion, n => system%matrix%num_total, p => system%operator%num_points)
      allocate (own%viscous_rate(n), source=0.0_rk)
      if (.not. allocated(own%carried)) then
        allocate (own%carried(3, p), own%jump_rate(3, p), source=0.0_rk)
        call gather_tractions(system%operator, now%joints, own%carried)
      end if
      call system%find_damping_force(own%a, own%viscous_rate)
    end associate
  end subroutine start_rates

  !> Factors the effective matrix when the size of the increment has changed.
  subroutine start_increment(self, model, plan, dt, results, error)
    class(hht_method), intent(inout) :: self
    type(problem), intent(in) :: model
    type(step), intent(in) :: plan
    real(rk), intent(in) :: dt
    class(listener), intent(inout) :: results
    type(error_type), allocatable, intent(out) :: error
    logical :: is_kept
    if (self%scheme%is_for(dt)) return
    is_kept = .false.
    if (plan%follows_accuracy()) then
      call change_solver(self, model, plan, dt, results, is_kept, error)
      if (allocated(error)) return
    end if
    self%scheme = make_scheme(plan%alpha, dt, plan%controls%joint_forces)
    self%system%mass = [real(rk) ::] ! the start of the step has needed all values
    call effective_values(self%system, self%scheme, self%solids%values)
    self%solids%weight = 1.0_rk + plan%alpha
    call self%solids%correction%open(model, 1.0_rk/(self%scheme%gamma*self%solids%weight))
    call self%solids%matrix%start_elastic(dt)
    if (is_kept) return
    call results%costs%start('iterate', 'structure', 'solver')
    call set_modal_damping(self%system, self%solids%weight*self%scheme%velocity_of_x, &
                           self%solids%solver)
    call prepare_equilibrium(model, self%system, self%solids%values, self%scheme%joint_weight, &
                             self%solids%solver, error)
    call results%costs%stop()
  end subroutine start_increment

  !> Keeps the solver of the last size, and takes that of the new size or makes one. A factor that
  !> cracks have changed is not kept.
  subroutine change_solver(self, model, plan, dt, results, is_kept, error)
    class(hht_method), intent(inout) :: self
    type(problem), intent(in) :: model
    type(step), intent(in) :: plan
    real(rk), intent(in) :: dt !< [s]
    class(listener), intent(inout) :: results
    logical, intent(out) :: is_kept !< the new solver has its factor
    type(error_type), allocatable, intent(out) :: error
    class(equilibrium_solver), allocatable :: next
    real(rk) :: condition
    is_kept = .false.
    if (.not. self%scheme%dt > 0.0_rk) return
    call self%shelf%take(dt, next)
    is_kept = allocated(next)
    if (.not. (is_kept .or. is_power(dt/plan%first_increment))) return
    condition = self%solids%solver%condition
    if (self%solids%matrix%is_elastic) call self%shelf%put(self%scheme%dt, self%solids%solver)
    if (is_kept) call move_alloc(next, self%solids%solver)
    if (allocated(self%solids%solver)) return
    call make_step_solver(plan, self%system, self%has_active_part, self%solids, results, &
                          error)
    if (.not. allocated(error)) self%solids%solver%condition = condition
  end subroutine change_solver

  !> Whether a number is a power of two, as the sizes are that a step returns to.
  pure logical function is_power(ratio)
    real(rk), intent(in) :: ratio
    real(rk) :: exponent
    exponent = log(ratio)/log(2.0_rk)
    is_power = abs(exponent - anint(exponent)) < 1.0e-6_rk
  end function is_power

  !> Values of K_eff, without joints.
  subroutine effective_values(system, scheme, values)
    type(dam_system), intent(in) :: system
    type(hht), intent(in) :: scheme
    real(rk), allocatable, intent(out) :: values(:)
    values = (1.0_rk + scheme%alpha)*system%stiffness
    call system%add_mass(scheme%acceleration_of_x, values)
    call system%add_damping((1.0_rk + scheme%alpha)*scheme%velocity_of_x, values)
  end subroutine effective_values

  !> One increment. Water is where the joints were open at its start.
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
    real(rk) :: excess
    call results%costs%start('iterate', 'structure', 'solver')
    call update_uplift(model, self%system%operator, before%joints, self%system%groups, &
                       results%costs, has_changed)
    call self%take_increment(model, when, before, after, outcome, error)
    call results%costs%stop('iterate structure')
    if (allocated(error) .or. .not. outcome%has_converged) return
    after%joint_condition = max(after%joint_condition, self%solids%solver%condition)
    call results%costs%start('recover', 'energy', 'solver')
    excess = newmark_excess(self%scheme, self%system%matrix, before%motion, after%motion)
    if (has_moving_supports(self%system)) then
      after%energy%external = after%energy%external &
                              + kinetic_excess(self%system%matrix%part, before%motion, &
                                               after%motion) - excess
    end if
    call add_dynamic_work(model, self%system, before, after, excess)
    call results%costs%stop()
  end subroutine advance

  !> Change of the kinetic energy beyond du . M a_mean in free unknowns (7.4). Supports have a part
  !> only where they move, and then other rates than those of Newmark's formulas.
  real(rk) function newmark_excess(scheme, matrix, old, new) result(excess)
    type(hht), intent(in) :: scheme
    type(pattern), intent(in) :: matrix
    type(motion), intent(in) :: old, new
    real(rk) :: du_dma, da_ma, da_dma
    associate (n => matrix%num_free, part => matrix%part)
      du_dma = dot(part, new%q(:n) - old%q(:n), new%inertia(:n) - old%inertia(:n))
      da_ma = work(part, new%a(:n) - old%a(:n), old%inertia(:n), new%inertia(:n))
      da_dma = dot(part, new%a(:n) - old%a(:n), new%inertia(:n) - old%inertia(:n))
    end associate
    associate (g => scheme%gamma - 0.5_rk, b => scheme%beta - 0.5_rk*scheme%gamma)
      excess = g*du_dma - b*scheme%dt**2*(da_ma + g*da_dma)
    end associate
  end function newmark_excess

  !> Change of the kinetic energy beyond du . M a_mean, from its values.
  real(rk) function kinetic_excess(part, old, new) result(excess)
    type(unknown_part), intent(in) :: part
    type(motion), intent(in) :: old, new
    excess = 0.5_rk*(dot(part, new%v, new%momentum) - dot(part, old%v, old%momentum)) &
             - work(part, new%q - old%q, old%inertia, new%inertia)
  end function kinetic_excess
end module hht_integrator
