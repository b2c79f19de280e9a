!> The iteration on initial-stress forces within an increment (theory.md, 12).
submodule(solid_iteration) force_iteration
  use dof_numbering, only: numbering
  use global_vectors, only: largest_entry, norm
  use ranks, only: is_true_everywhere, largest_of_ranks
  use unknown_parts, only: unknown_part
  implicit none

  !> Floor of the increment of displacement, as a fraction of the displacements.
  real(rk), parameter :: smallest_increment = 1.0e-3_rk
  !> A residual below this is round-off; the correction is then not checked.
  real(rk), parameter :: roundoff = 1.0e-12_rk

contains

  !> Iterates until residual and correction are within the tolerances.
  module subroutine iterate_on_forces(self, model, system, task, before, after, outcome, error)
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
    self%has_stopped = .false.
    self%time%wants_energy = self%correction%is_active()
    call start_iteration(self, model, system, before, after, now)
    do while (outcome%iterations < most_iterations)
      if (is_dropped(self%solver%controls)) exit
      call solve_iterate(self, model, system, now, before, after, outcome, error)
      if (allocated(error) .or. now%is_lost) return
      call measure_iterate(self, system, before, now, outcome)
      if (outcome%has_converged) then
        call check_others(self, model, system, before, after, now, outcome, error)
        if (allocated(error) .or. now%is_lost) return
      end if
      outcome%history = [outcome%history, outcome%residual]
      if (outcome%has_converged) exit
      if (self%stops_early) then
        self%has_stopped = falls_too_slowly(outcome%history(now%first:), &
                                            self%solver%controls%residual_tolerance, &
                                            most_iterations - outcome%iterations)
        if (self%has_stopped) exit
      end if
      call choose_elements(self, model, system, before, now)
      call choose_guess(self, model, system, now, error)
      if (allocated(error) .or. now%is_lost) return
    end do
    if (outcome%has_converged .and. .not. self%time%wants_energy) then
      self%time%wants_energy = .true.
      call self%solver%costs%start('recover', 'inelastic solids', 'inelastic')
      call complete_energies(model, self%time, before%points, after%points, self%answers)
      call self%solver%costs%stop()
    end if
    call self%solver%complete_solution(now%task%x, error)
    task%x = now%task%x
  end subroutine iterate_on_forces

  !> The first guess of s, with the last matrix. In a dynamic step where laws have an initial stress
  !> it is that of a motion that goes on.
  subroutine start_iteration(self, model, system, before, after, now)
    class(solid_solver), intent(inout) :: self
    type(problem), intent(in) :: model
    type(dam_system), intent(in) :: system
    type(state), intent(in) :: before
    type(state), intent(inout) :: after
    type(iterate_state), intent(inout) :: now
    real(rk) :: product(size(before%motion%q))
    logical :: is_predicted
    integer :: n
    n = system%matrix%num_free
    call self%mixer%forget()
    now%rhs = now%task%balance%rhs
    if (now%task%is_refined) then
      now%guess = remaining_excess(self, system, now%task%x)
      now%moved = norm(system%matrix%part, now%task%start + now%task%x - before%motion%q)
      return
    end if
    call self%elements%release(self%answers)
    now%task%x = 0.0_rk
    call self%matrix%multiply_lost(system%matrix, now%task%start - before%motion%q, product)
    now%guess = before%motion%elastic(:n) - before%motion%internal(:n) + product(:n)
    is_predicted = allocated(now%task%predicted)
    if (is_predicted) is_predicted = has_forces(now%guess)
    if (is_predicted) then
      now%task%x(:n) = now%task%predicted
      if (self%may_choose) call choose_from_answers(self, model, before)
      call evaluate(self, model, system, now%task, before, after)
      now%guess = remaining_excess(self, system, now%task%x)
      self%elements%is_made = .false. ! for the iterations: made from these answers
      call choose_elements(self, model, system, before, now)
    end if
    now%force = norm(system%matrix%part, now%rhs + self%weight*now%guess)
    now%moved = norm(system%matrix%part, now%task%start - before%motion%q)
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
    real(rk) :: last_x(system%matrix%num_total)
    associate (task => now%task)
      last_x = task%x
      task%balance%rhs = now%rhs + self%weight*now%guess
      task%balance%is_repeated = now%has_solved
      task%balance%is_partial = self%elements%is_made .and. self%solver%may_repeat
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
      outcome%correction = inner%correction
      outcome%unmet = inner%unmet
      now%is_lost = .not. inner%has_converged
      if (allocated(error) .or. now%is_lost) return
      now%moved = norm(system%matrix%part, task%x - last_x)
      now%last_force = now%force
      call find_answer(self, model, system, before, after, now, outcome)
    end associate
  end subroutine solve_iterate

  !> Evaluates the laws at the iterate for s'.
  subroutine find_answer(self, model, system, before, after, now, outcome)
    class(solid_solver), intent(inout) :: self
    type(problem), intent(in) :: model
    type(dam_system), intent(in) :: system
    type(state), intent(in) :: before
    type(state), intent(inout) :: after
    type(iterate_state), intent(inout) :: now
    type(balance_outcome), intent(inout) :: outcome
    call evaluate(self, model, system, now%task, before, after)
    call find_failure(model, self%answers, outcome%size_ratio, outcome%failure)
    now%is_lost = allocated(outcome%failure)
    now%answer = remaining_excess(self, system, now%task%x)
  end subroutine find_answer

  !> s(start + x) - A x: the initial-stress force of the last evaluation without what the matrix has
  !> of it.
  function remaining_excess(self, system, x) result(force)
    class(solid_solver), intent(in) :: self
    type(dam_system), intent(in) :: system
    real(rk), intent(in) :: x(:) !< (num_total) of the evaluation [m]
    real(rk) :: force(system%matrix%num_free) !< [N]
    real(rk) :: product(system%matrix%num_total)
    call self%matrix%multiply_lost(system%matrix, x, product)
    force = self%excess(:size(force)) - product(:size(force))
  end function remaining_excess

  !> Chooses the elements and unknowns that the next iterations change: after the first update of
  !> an increment, and when further elements are no longer elastic. A matrix of lost stiffness may
  !> hold any inelastic element.
  subroutine choose_elements(self, model, system, before, now)
    class(solid_solver), intent(inout) :: self
    type(problem), intent(in) :: model
    type(dam_system), intent(in) :: system
    type(state), intent(in) :: before
    type(iterate_state), intent(inout) :: now
    if (.not. self%may_choose .or. (self%elements%is_made .and. .not. now%has_further)) return
    if (.not. self%elements%is_made) call choose_from_answers(self, model, before)
    call self%mixer%forget()
    call self%mixer%choose_rows(system%matrix%part, &
                                find_active(model, system%numbers, self%elements%takes_part))
    now%has_further = .false.
    now%has_solved = .false.
    if (.not. self%solver%may_repeat) return
    associate (repeated => self%solver%repeated)
      call repeated%choose(self%solver%factor, self%mixer%rows, &
                           now%task%x(:system%matrix%num_free))
    end associate
  end subroutine choose_elements

  !> Chooses the elements that take part from the last update.
  subroutine choose_from_answers(self, model, before)
    class(solid_solver), intent(inout) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: before
    call self%elements%choose(model, before%points, wants_all=.not. self%matrix%is_elastic, &
                              answers=self%answers)
  end subroutine choose_from_answers

  !> Updates the elements that have not taken part, at the complete solution. Where one is no longer
  !> elastic it takes part from now on, and the iterate is measured again. Else the forces are those
  !> of the last evaluation: elastic elements add none.
  subroutine check_others(self, model, system, before, after, now, outcome, error)
    class(solid_solver), intent(inout) :: self
    type(problem), intent(in) :: model
    type(dam_system), intent(in) :: system
    type(state), intent(in) :: before
    type(state), intent(inout) :: after
    type(iterate_state), intent(inout) :: now
    type(balance_outcome), intent(inout) :: outcome
    type(error_type), allocatable, intent(out) :: error
    if (.not. self%elements%is_made) return
    call self%solver%complete_solution(now%task%x, error)
    if (allocated(error)) return
    call self%elements%ask_others(self%answers)
    call self%solver%costs%start('update', 'inelastic solids', 'inelastic')
    call update_laws(self, model, system, now%task, before, after)
    call find_failure(model, self%answers, outcome%size_ratio, outcome%failure)
    now%is_lost = allocated(outcome%failure)
    if (now%is_lost) outcome%has_converged = .false.
    call self%elements%extend(model, self%answers, now%has_further)
    call self%solver%costs%stop()
    if (.not. now%has_further .or. now%is_lost) return
    ! Tangents that forces have been added to are not used again.
    call evaluate(self, model, system, now%task, before, after)
    now%answer = remaining_excess(self, system, now%task%x)
    call measure_iterate(self, system, before, now, outcome)
    now%first = size(outcome%history) + 1
  end subroutine check_others

  !> Evaluates the laws at `task%start + task%x`, and their forces.
  subroutine evaluate(self, model, system, task, before, after)
    class(solid_solver), intent(inout) :: self
    type(problem), intent(in) :: model
    type(dam_system), intent(in) :: system
    type(increment_task), intent(in) :: task
    type(state), intent(in) :: before
    type(state), intent(inout) :: after
    call self%solver%costs%start('update', 'inelastic solids', 'inelastic')
    call update_laws(self, model, system, task, before, after)
    call sum_forces(self, model, system, task, before, after)
    call self%solver%costs%stop()
  end subroutine evaluate

  !> Updates the points of the elements that take part, and other guests with a history.
  subroutine update_laws(self, model, system, task, before, after)
    class(solid_solver), intent(inout) :: self
    type(problem), intent(in) :: model
    type(dam_system), intent(in) :: system
    type(increment_task), intent(in) :: task
    type(state), intent(in) :: before
    type(state), intent(inout) :: after
    real(rk) :: u(3, model%mesh%num_nodes)
    call system%numbers%expand(task%start + task%x, u)
    call update_points(model, u, before%origin, self%time, before%points, after%points, &
                       self%answers)
    call update_guests(model, u, self%time%size, before%guests, after%guests, self%guest_excess)
  end subroutine update_laws

  !> The initial-stress force of the last updates.
  subroutine sum_forces(self, model, system, task, before, after)
    class(solid_solver), intent(inout) :: self
    type(problem), intent(in) :: model
    type(dam_system), intent(in) :: system
    type(increment_task), intent(in) :: task
    type(state), intent(in) :: before
    type(state), intent(inout) :: after
    call sum_excess(model, system%numbers, system%matrix%part, self%answers, self%guest_excess, &
                    self%excess)
    call self%correction%add_force(model, system, self%time, before%points, after%points, &
                                   self%answers, self%excess)
    call self%loss%add_force(model, system, task, before%points, self%answers, self%excess)
  end subroutine sum_forces

  !> Residual, and an estimate of the next correction from the last one.
  subroutine measure_iterate(self, system, before, now, outcome)
    class(solid_solver), intent(in) :: self
    type(dam_system), intent(in) :: system
    type(state), intent(in) :: before
    type(iterate_state), intent(inout) :: now
    type(balance_outcome), intent(inout) :: outcome
    real(rk) :: reference, increment, q(size(before%motion%q)), product(size(before%motion%q))
    q = now%task%start + now%task%x
    reference = now%task%reference_force
    associate (part => system%matrix%part)
      now%force = self%weight*norm(part, now%answer - now%guess)
      if (now%task%counts_reactions) then
        call system%find_elastic(q, product)
        reference = max(reference, norm(part, product - self%excess))
      end if
      increment = max(norm(part, q - before%motion%q), smallest_increment*norm(part, q), &
                      tiny(1.0_rk))
      outcome%worst_node = node_of_largest(part, system%numbers, now%answer - now%guess)
    end associate
    outcome%residual = now%force/max(reference, tiny(1.0_rk))
    outcome%worst_point = 0
    outcome%correction = now%moved/increment*min(1.0_rk, now%force/max(now%last_force, &
                                                                       tiny(1.0_rk)))
    associate (controls => self%solver%controls)
      outcome%has_converged = outcome%residual <= roundoff .or. &
                              (outcome%residual <= controls%residual_tolerance .and. &
                               outcome%correction <= controls%increment_tolerance)
    end associate
  end subroutine measure_iterate

  !> The node of the largest entry, on all ranks; 0 without entries.
  integer function node_of_largest(part, numbers, force) result(node)
    type(unknown_part), intent(in) :: part
    type(numbering), intent(in) :: numbers
    real(rk), intent(in) :: force(:) !< (num_free) [N]
    real(rk) :: largest
    largest = largest_entry(part, abs(force))
    node = 0
    if (maxval(abs(force)) >= largest .and. size(force) > 0) then
      node = numbers%node(maxloc(abs(force), 1))
    end if
    node = largest_of_ranks(node)
  end function node_of_largest

  !> Whether a force is not zero, on any rank.
  logical function has_forces(force)
    real(rk), intent(in) :: force(:) !< (num_free) [N]
    has_forces = .not. is_true_everywhere(.not. any(abs(force) > 0.0_rk))
  end function has_forces

  !> Chooses the next guess of s.
  subroutine choose_guess(self, model, system, now, error)
    class(solid_solver), intent(inout) :: self
    type(problem), intent(in) :: model
    type(dam_system), intent(in) :: system
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
      call linearise(self, model, system, now, error)
    end if
  end subroutine choose_guess

  !> Takes the tangent at the present iterate.
  subroutine linearise(self, model, system, now, error)
    class(solid_solver), intent(inout) :: self
    type(problem), intent(in) :: model
    type(dam_system), intent(in) :: system
    type(iterate_state), intent(inout) :: now
    type(error_type), allocatable, intent(out) :: error
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
    now%base = remaining_excess(self, system, now%task%x)
    now%guess = now%base
  end subroutine linearise
end submodule force_iteration
