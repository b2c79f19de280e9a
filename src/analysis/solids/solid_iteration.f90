!> Equilibrium of an increment with inelastic solids, and other guests with a history (theory.md,
!> 12):
!>
!>   K_eff x + joints(x) = rhs + w s(start + x)
!>
!> for the free unknowns x. The initial-stress force is s = K u - sum B^T sigma. A is the loss of
!> stiffness of the points, or zero. Each iteration solves (K_eff - w A) x + joints = rhs + w s,
!> joints included, and evaluates the laws for s' = s(start + x) - A x. The residual is w (s' - s).
!> Newton's method updates A and s in each iteration; with a fixed A the iteration on s is
!> accelerated. Without inelastic solids one solve is enough.
module solid_iteration
  use kinds, only: rk
  use errors, only: error_type, analysis_failed
  use problem_definition, only: problem
  use active_unknowns, only: find_active
  use analysis_state, only: state, motion
  use global_vectors, only: norm
  use material_points, only: time_increment
  use node_dofs, only: zero_vectors
  use lost_damping, only: damping_loss
  use inelastic_forces, only: block_answer, open_answers, update_points, recall_points, &
                              sum_excess, find_failure, complete_energies
  use guest_forces, only: has_histories, recall_guests, update_guests
  use equilibrium, only: equilibrium_solver, balance_outcome, is_dropped
  use increment_balance, only: increment_task
  use step_system, only: dam_system
  use anderson_mixing, only: mixer
  use conserving_stress, only: work_correction
  use solid_iterate, only: iterate_state, falls_too_slowly
  use solid_tangent, only: tangent_matrix
  use step_plan, only: step
  use tangent_choice, only: tangent, choose_tangents
  implicit none
  private
  public :: solid_solver

  !> Solver of increments.
  type :: solid_solver
    class(equilibrium_solver), allocatable :: solver !< with a linear bulk
    real(rk), allocatable :: values(:) !< of K_eff, without joints
    real(rk) :: weight = 1.0_rk !< of the forces of the solids
    real(rk) :: tolerance = 0.0_rk !< of the balance of all forces, over the reference force
    logical :: stops_early = .false. !< where the residual falls too slowly
    type(tangent), allocatable :: choices(:) !< tried one after the other
    type(tangent) :: chosen !< the present one
    type(time_increment) :: time
    type(tangent_matrix) :: matrix
    type(block_answer), allocatable :: answers(:) !< (blocks)
    real(rk), allocatable :: guest_excess(:, :) !< (3, nodes) of guests with a history [N]
    real(rk), allocatable :: excess(:) !< (num_total) initial-stress force of the last iterate [N]
    type(damping_loss) :: loss !< its force is part of `excess`
    type(work_correction) :: correction !< its weighted force is part of `excess` too
    type(mixer) :: mixer
  contains
    procedure :: open => open_solids
    procedure :: open_increment, solve_increment, effort, set_internal
    procedure :: has_inelastic, start_lost_damping
    procedure, private :: iterate_on_forces, start_iteration, solve_iterate, measure_iterate
    procedure, private :: choose_guess, linearise, evaluate
  end type solid_solver

  !> Iterations without factorisation are cheap: the limit is this many times higher.
  integer, parameter :: cheap_iterations = 5
  !> Floor of the increment of displacement, as a fraction of the displacements.
  real(rk), parameter :: smallest_increment = 1.0e-3_rk
  !> A residual below this is round-off; the correction is then not checked.
  real(rk), parameter :: roundoff = 1.0e-12_rk

contains

  !> Opens a step with the internal forces of its initial state.
  subroutine open_solids(self, model, system, plan, now)
    class(solid_solver), intent(inout) :: self
    type(problem), intent(in) :: model
    type(dam_system), intent(in) :: system
    type(step), intent(in) :: plan
    type(state), intent(inout) :: now
    self%tolerance = plan%controls%residual_tolerance
    self%stops_early = plan%procedure%has_inertia .and. .not. plan%is_direct
    self%choices = choose_tangents(model, plan)
    self%chosen = self%choices(1)
    call system%set_thermal(now%motion)
    call system%find_elastic(now%motion%q, now%motion%elastic)
    if (size(now%points) > 0 .or. has_histories(now%guests)) then
      if (.not. has_histories(now%guests)) self%mixer%rows = find_active(model, system%numbers)
      allocate (self%excess(system%matrix%num_total))
      self%guest_excess = zero_vectors(model%mesh%num_nodes)
      call open_answers(model%inelastic, self%answers)
      call recall_points(model, now%points, self%answers)
      call recall_guests(model, now%u, now%guests, self%guest_excess)
      call sum_excess(model, system%numbers, self%answers, self%guest_excess, self%excess)
    end if
    call self%set_internal(now%motion)
  end subroutine open_solids

  !> Adds the damping force that cracks have lost at the start of a dynamic step.
  subroutine start_lost_damping(self, model, system, plan, now)
    class(solid_solver), intent(inout) :: self
    type(problem), intent(in) :: model
    type(dam_system), intent(in) :: system
    type(step), intent(in) :: plan
    type(state), intent(inout) :: now !< with its velocities
    type(increment_task) :: task
    call self%loss%open(model, plan)
    if (.not. self%has_inelastic()) return
    task%velocity = now%motion%v
    task%x = 0.0_rk*now%motion%v
    call self%loss%add_force(model, system%numbers, task, now%points, self%answers, self%excess)
    call self%set_internal(now%motion)
  end subroutine start_lost_damping

  !> Whether any solid is inelastic, or another guest has a history.
  pure logical function has_inelastic(self)
    class(solid_solver), intent(in) :: self
    has_inelastic = allocated(self%excess)
  end function has_inelastic

  !> Internal force, sum of B^T sigma, from K q and the laws evaluated at q.
  pure subroutine set_internal(self, moving)
    class(solid_solver), intent(in) :: self
    type(motion), intent(inout) :: moving
    moving%internal = moving%elastic
    if (allocated(self%excess)) moving%internal = moving%internal - self%excess
    if (allocated(self%correction%force)) then
      moving%correction = self%correction%force
      moving%internal = moving%internal - self%correction%weight*self%correction%force
    end if
    if (allocated(self%loss%force)) moving%lost_damping = self%loss%force
  end subroutine set_internal

  !> Sets the time of the laws.
  subroutine open_increment(self, now, increment)
    class(solid_solver), intent(inout) :: self
    type(state), intent(in) :: now !< at the start of the increment
    real(rk), intent(in) :: increment !< [s]
    self%time%step = now%step
    self%time%increment = now%increment + 1
    self%time%step_time = now%step_time
    self%time%total_time = now%total_time
    self%time%size = increment
  end subroutine open_increment

  !> Iterations for the control of the increment size; cheap ones count less.
  pure integer function effort(self, iterations)
    class(solid_solver), intent(in) :: self
    integer, intent(in) :: iterations
    effort = iterations
    if (self%chosen%patience == 0 .or. .not. self%has_inelastic()) return
    effort = (iterations + cheap_iterations - 1)/cheap_iterations
  end function effort

  !> Solves for `task%x`, joints and points of `after`. No convergence is not an error.
  !> If a law requests a smaller increment, no other tangent is tried.
  subroutine solve_increment(self, model, system, task, before, after, outcome, error)
    class(solid_solver), intent(inout) :: self
    type(problem), intent(in) :: model
    type(dam_system), intent(in) :: system
    type(increment_task), intent(inout) :: task
    type(state), intent(in) :: before
    type(state), intent(inout) :: after
    type(balance_outcome), intent(out) :: outcome
    type(error_type), allocatable, intent(out) :: error
    integer :: i
    task%tolerance = self%tolerance
    self%solver%controls%residual_tolerance = task%share*self%tolerance
    if (task%is_refined) call task%balance%start_from(system%operator, after%joints)
    if (.not. self%has_inelastic()) then
      call self%solver%solve_balance(task%balance, model%joints, before%joints, after%joints, &
                                     task%x, outcome, error)
      return
    end if
    do i = 1, size(self%choices)
      self%chosen = self%choices(i)
      self%time%tangent = self%chosen%kind
      self%time%holds_switches = self%chosen%holds_switches
      call self%iterate_on_forces(model, system, task, before, after, outcome, error)
      outcome%has_held_switches = self%chosen%holds_switches
      if (allocated(error) .or. outcome%has_converged .or. is_dropped(self%solver%controls)) return
      if (.not. self%matrix%is_elastic) then
        call self%matrix%factorise_elastic(model, system, self%values, self%solver, error)
        if (allocated(error)) return
      end if
      if (outcome%size_ratio < 1.0_rk) return
    end do
  end subroutine solve_increment

  !> Iterates until residual and correction are within the tolerances.
  subroutine iterate_on_forces(self, model, system, task, before, after, outcome, error)
    class(solid_solver), intent(inout) :: self
    type(problem), intent(in) :: model
    type(dam_system), intent(in) :: system
    type(increment_task), intent(inout) :: task
    type(state), intent(in) :: before
    type(state), intent(inout) :: after
    type(balance_outcome), intent(out) :: outcome
    type(error_type), allocatable, intent(out) :: error
    type(iterate_state) :: now
    integer :: most_iterations
    most_iterations = self%solver%controls%max_iterations
    if (self%chosen%patience > 0) most_iterations = cheap_iterations*most_iterations
    now%task = task
    allocate (outcome%history(0))
    self%time%wants_energy = self%correction%is_active()
    call self%start_iteration(model, system, before, after, now)
    do while (outcome%iterations < most_iterations)
      if (is_dropped(self%solver%controls)) exit
      call self%solve_iterate(model, system, now, before, after, outcome, error)
      if (allocated(error) .or. now%is_lost) return
      call self%measure_iterate(system, before, now, outcome)
      if (outcome%has_converged) exit
      if (self%stops_early) then
        if (falls_too_slowly(outcome%history, self%solver%controls%residual_tolerance, &
                             most_iterations - outcome%iterations)) exit
      end if
      call self%choose_guess(model, system, after, now, error)
      if (allocated(error) .or. now%is_lost) return
    end do
    if (outcome%has_converged .and. .not. self%time%wants_energy) then
      self%time%wants_energy = .true.
      call self%solver%costs%start('recover', 'inelastic solids', 'inelastic')
      call complete_energies(model, self%time, before%points, after%points, self%answers)
      call self%solver%costs%stop()
    end if
    if (now%task%balance%is_partial) call self%solver%complete_solution(now%task%x, error)
    task%x = now%task%x
  end subroutine iterate_on_forces

  !> The first guess of s, with the last matrix. In a dynamic step where laws have an initial stress
  !> it is that of displacements that go on with their velocity: 10 % fewer iterations.
  subroutine start_iteration(self, model, system, before, after, now)
    class(solid_solver), intent(inout) :: self
    type(problem), intent(in) :: model
    type(dam_system), intent(in) :: system
    type(state), intent(in) :: before
    type(state), intent(inout) :: after
    type(iterate_state), intent(inout) :: now
    real(rk) :: product(size(before%motion%q))
    integer :: n
    n = system%matrix%num_free
    call self%mixer%forget()
    now%rhs = now%task%balance%rhs
    if (now%task%is_refined) then
      call self%matrix%multiply_lost(system%matrix, now%task%x, product)
      now%guess = self%excess(:n) - product(:n)
      now%moved = norm(now%task%start + now%task%x - before%motion%q)
      return
    end if
    now%task%x = 0.0_rk
    call self%matrix%multiply_lost(system%matrix, now%task%start - before%motion%q, product)
    now%guess = before%motion%elastic(:n) - before%motion%internal(:n) + product(:n)
    if (allocated(now%task%velocity) .and. any(abs(now%guess) > 0.0_rk)) then
      now%task%x(:n) = self%time%size*before%motion%v(:n)
      call self%evaluate(model, system, now%task, before, after)
      call self%matrix%multiply_lost(system%matrix, now%task%x, product)
      now%guess = self%excess(:n) - product(:n)
    end if
    now%force = norm(now%rhs + self%weight*now%guess)
    now%moved = norm(now%task%start - before%motion%q)
  end subroutine start_iteration

  !> Solves with the guess and evaluates the laws; `now%is_lost` if the iteration must stop.
  subroutine solve_iterate(self, model, system, now, before, after, outcome, error)
    class(solid_solver), intent(inout) :: self
    type(problem), intent(in) :: model
    type(dam_system), intent(in) :: system
    type(iterate_state), intent(inout) :: now
    type(state), intent(in) :: before
    type(state), intent(inout) :: after
    type(balance_outcome), intent(inout) :: outcome
    type(error_type), allocatable, intent(out) :: error
    type(balance_outcome) :: inner
    real(rk), dimension(system%matrix%num_total) :: product, last_x
    associate (task => now%task)
      last_x = task%x
      task%balance%rhs = now%rhs + self%weight*now%guess
      task%balance%is_repeated = now%has_solved
      task%balance%is_partial = now%has_solved .and. .not. task%counts_reactions
      if (outcome%iterations > 0) call task%balance%start_from(system%operator, after%joints)
      call self%solver%solve_balance(task%balance, model%joints, before%joints, after%joints, &
                                     task%x, inner, error)
      now%has_solved = .true.
      outcome%iterations = max(outcome%iterations + 1, inner%own_iterations())
      outcome%augmentations = outcome%augmentations + inner%augmentations
      outcome%penetration = inner%penetration
      outcome%gives_up = inner%gives_up
      outcome%worst_point = inner%worst_point
      outcome%residual = inner%residual
      now%is_lost = .not. inner%has_converged
      if (allocated(error) .or. now%is_lost) return
      call self%evaluate(model, system, task, before, after)
      call find_failure(model, self%answers, outcome%size_ratio, outcome%failure)
      now%is_lost = allocated(outcome%failure)
      call self%matrix%multiply_lost(system%matrix, task%x, product)
      now%answer = self%excess(:size(now%guess)) - product(:size(now%guess))
      now%moved = norm(task%x - last_x)
    end associate
  end subroutine solve_iterate

  !> Evaluates the laws at `task%start + task%x`.
  subroutine evaluate(self, model, system, task, before, after)
    class(solid_solver), intent(inout) :: self
    type(problem), intent(in) :: model
    type(dam_system), intent(in) :: system
    type(increment_task), intent(in) :: task
    type(state), intent(in) :: before
    type(state), intent(inout) :: after
    real(rk) :: u(3, model%mesh%num_nodes)
    call system%numbers%expand(task%start + task%x, u)
    call self%solver%costs%start('update', 'inelastic solids', 'inelastic')
    call update_points(model, u, before%origin, self%time, before%points, after%points, &
                       self%answers)
    call update_guests(model, u, self%time%size, before%guests, after%guests, self%guest_excess)
    call sum_excess(model, system%numbers, self%answers, self%guest_excess, self%excess)
    call self%correction%add_force(model, system%numbers, self%time, before%points, after%points, &
                                   self%answers, self%excess)
    call self%loss%add_force(model, system%numbers, task, before%points, self%answers, self%excess)
    call self%solver%costs%stop()
  end subroutine evaluate

  !> Residual, and an estimate of the next correction from the last one.
  subroutine measure_iterate(self, system, before, now, outcome)
    class(solid_solver), intent(in) :: self
    type(dam_system), intent(in) :: system
    type(state), intent(in) :: before
    type(iterate_state), intent(inout) :: now
    type(balance_outcome), intent(inout) :: outcome
    real(rk) :: reference, increment, q(size(before%motion%q)), product(size(before%motion%q))
    now%last_force = now%force
    now%force = self%weight*norm(now%answer - now%guess)
    q = now%task%start + now%task%x
    reference = now%task%reference_force
    if (now%task%counts_reactions) then
      call system%find_elastic(q, product)
      reference = max(reference, norm(product - self%excess))
    end if
    outcome%residual = now%force/max(reference, tiny(1.0_rk))
    outcome%history = [outcome%history, outcome%residual]
    outcome%worst_point = 0
    outcome%worst_unknown = maxloc(abs(now%answer - now%guess), 1)
    increment = max(norm(q - before%motion%q), smallest_increment*norm(q), tiny(1.0_rk))
    outcome%correction = now%moved/increment*min(1.0_rk, now%force/max(now%last_force, &
                                                                       tiny(1.0_rk)))
    associate (controls => self%solver%controls)
      outcome%has_converged = outcome%residual <= roundoff .or. &
                              (outcome%residual <= controls%residual_tolerance .and. &
                               outcome%correction <= controls%increment_tolerance)
    end associate
  end subroutine measure_iterate

  !> Chooses the next guess of s.
  subroutine choose_guess(self, model, system, after, now, error)
    class(solid_solver), intent(inout) :: self
    type(problem), intent(in) :: model
    type(dam_system), intent(in) :: system
    type(state), intent(in) :: after
    type(iterate_state), intent(inout) :: now
    type(error_type), allocatable, intent(out) :: error
    now%tries = now%tries + 1
    if (self%chosen%patience > 0 .and. .not. now%is_slow(self%chosen%patience)) then
      if (now%tries == 1) now%base_force = now%force
      call self%mixer%advance(now%answer - now%guess, now%guess)
    else if (self%chosen%patience == 0 .and. now%has_grown()) then
      now%share = 0.5_rk*now%share
      now%guess = now%base - (1.0_rk - now%share)*now%unbalance
    else
      call self%linearise(model, system, after, now, error)
    end if
  end subroutine choose_guess

  !> Takes the tangent at the present iterate.
  subroutine linearise(self, model, system, after, now, error)
    class(solid_solver), intent(inout) :: self
    type(problem), intent(in) :: model
    type(dam_system), intent(in) :: system
    type(state), intent(in) :: after
    type(iterate_state), intent(inout) :: now
    type(error_type), allocatable, intent(out) :: error
    real(rk) :: product(size(after%motion%q))
    integer :: n
    n = size(now%guess)
    now%unbalance = now%answer - now%guess
    now%base_force = now%force
    now%share = 1.0_rk
    now%tries = 0
    now%has_solved = .false.
    call self%mixer%forget()
    self%matrix%is_symmetric = self%chosen%is_symmetric()
    call self%matrix%factorise(model, system, self%answers, self%values, self%weight, self%solver, &
                               error)
    if (allocated(error)) then
      now%is_lost = error%exit_code == analysis_failed
      if (now%is_lost) deallocate (error)
      return
    end if
    call self%matrix%multiply_lost(system%matrix, now%task%x, product)
    now%base = self%excess(:n) - product(:n)
    now%guess = now%base
  end subroutine linearise
end module solid_iteration
