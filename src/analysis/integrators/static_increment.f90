!> One static increment:
!>
!>   K x + B^T (area t) = f1 - K q0 + s
!>
!> for the increment x of the unknowns, with the initial-stress force s of inelastic solids
!> (theory.md, 12).
module static_increment
  use kinds, only: rk
  use errors, only: error_type
  use global_vectors, only: norm
  use problem_definition, only: problem
  use joint_law, only: joint_state
  use joint_operator, only: jump_operator
  use joint_forces, only: gather_jumps, gather_tractions, reference_stiffness
  use analysis_state, only: motion, state
  use state_transfer, only: sum_contact
  use equilibrium, only: balance_outcome
  use step_equilibrium, only: add_moving_supports
  use step_system, only: dam_system
  use step_loads, only: step_time, external_force, prescribed_values
  use increment_balance, only: increment_task
  use solid_iteration, only: solid_solver
  implicit none
  private
  public :: take_static_increment

  !> Floor of the reference force, as a fraction of norm(diag(K) q) and of the forces of closed
  !> joints at the jumps.
  real(rk), parameter :: idle_share = 1.0e-6_rk

contains

  !> Goes from `before` to `after`. Without convergence `after` is invalid.
  subroutine take_static_increment(model, system, solids, when, before, after, outcome, error)
    type(problem), intent(in) :: model
    type(dam_system), intent(in) :: system
    type(solid_solver), intent(inout) :: solids
    type(step_time), intent(in) :: when
    type(state), intent(in) :: before
    type(state), intent(inout) :: after
    type(balance_outcome), intent(out) :: outcome
    type(error_type), allocatable, intent(out) :: error
    type(increment_task) :: task
    call pose_task(model, system, solids, when, before, after, task)
    associate (new => after%motion, n => system%matrix%num_free)
      do
        call solids%solve_increment(model, system, task, before, after, outcome, error)
        if (allocated(error) .or. .not. outcome%has_converged) return
        new%q = task%start + task%x
        call system%find_elastic(new%q, new%elastic)
        call solids%set_internal(new)
        call sum_contact(system%operator, after)
        new%balanced = 0.0_rk
        after%largest_force = reference_force(model, system, solids, before, after)
        call task%check_balance(system%matrix%part, &
                                new%external(:n) - new%internal(:n) - new%contact(:n), &
                                after%largest_force, outcome)
        if (.not. task%is_refined) exit
      end do
    end associate
  end subroutine take_static_increment

  !> The problem of the increment: loads and supports at its end.
  subroutine pose_task(model, system, solids, when, before, after, task)
    type(problem), intent(in) :: model
    type(dam_system), intent(in) :: system
    type(solid_solver), intent(in) :: solids
    type(step_time), intent(in) :: when
    type(state), intent(in) :: before
    type(state), intent(inout) :: after
    type(increment_task), intent(out) :: task
    real(rk), allocatable :: moved(:)
    associate (old => before%motion, new => after%motion, n => system%matrix%num_free)
      call external_force(system%groups, model%amplitudes, when, new%external)
      call fade_release(when, old, new)
      new%q = old%q
      call prescribed_values(system%supports, model%amplitudes, when, new%q)
      moved = new%q - old%q
      task%balance%rhs = new%external(:n) - old%elastic(:n)
      call system%add_warming(old, 1.0_rk, task%balance%rhs)
      call add_moving_supports(system, system%stiffness, moved, task%balance%rhs)
      task%balance%reference_force = norm(system%matrix%part, task%balance%rhs)
      call task%balance%set_jumps(system%operator, new%q, before%joints)
      task%balance%starts_closed = .not. has_traction(system%operator, before%joints)
      task%balance%is_static = .true.
      task%start = new%q
      task%counts_reactions = .true.
      if (solids%has_inelastic()) task%reference_force = known_force(system, before, after)
      allocate (task%x(size(moved)))
    end associate
  end subroutine pose_task

  !> The force that balances the change of a stage falls linearly to zero at the end of the step.
  subroutine fade_release(when, old, new)
    type(step_time), intent(in) :: when !< the end of the increment
    type(motion), intent(in) :: old
    type(motion), intent(inout) :: new
    real(rk) :: rest
    if (.not. allocated(old%release)) return
    rest = when%duration - when%now
    new%release = old%release*(rest/(rest + when%increment))
    new%external = new%external + new%release
  end subroutine fade_release

  !> The largest of the forces before and after, reactions included. For a dam without stress (its
  !> load returned to zero, or it moves with its supports) the reference is the round-off of the
  !> forces of its motion. The matrix with closed joints has the round-off of their forces at open
  !> jumps. For cracking solids the largest force so far is kept.
  real(rk) function reference_force(model, system, solids, before, after) result(force)
    type(problem), intent(in) :: model
    type(dam_system), intent(in) :: system
    type(solid_solver), intent(in) :: solids
    type(state), intent(in) :: before, after
    associate (old => before%motion, new => after%motion, diagonal => system%diagonal, &
               part => system%matrix%part)
      force = max(norm(part, old%external), norm(part, new%external), norm(part, old%internal), &
                  norm(part, new%internal), norm(part, old%contact), norm(part, new%contact), &
                  idle_share*norm(part, diagonal*old%q), idle_share*norm(part, diagonal*new%q), &
                  idle_share*closed_force(model, system, after))
    end associate
    if (solids%has_inelastic()) force = max(force, before%largest_force)
  end function reference_force

  !> The force of closed joints at the jumps of a state.
  real(rk) function closed_force(model, system, now) result(force)
    type(problem), intent(in) :: model
    type(dam_system), intent(in) :: system
    type(state), intent(in) :: now
    real(rk), allocatable :: k_ref(:, :)
    real(rk) :: jump(3, system%operator%num_points)
    call reference_stiffness(model%joints, system%operator, k_ref)
    call gather_jumps(system%operator, now%joints, jump)
    force = norm(spread(system%operator%area, 1, 3)*k_ref*jump)
  end function closed_force

  !> The part of the reference force that is known before the increment is solved.
  real(rk) function known_force(system, before, after) result(force)
    type(dam_system), intent(in) :: system
    type(state), intent(in) :: before, after
    associate (old => before%motion, new => after%motion, diagonal => system%diagonal, &
               part => system%matrix%part)
      force = max(before%largest_force, norm(part, new%external), norm(part, old%external), &
                  norm(part, old%internal), norm(part, old%contact), &
                  idle_share*norm(part, diagonal*old%q))
    end associate
  end function known_force

  !> Whether any point of a joint has a traction.
  logical function has_traction(operator, joints)
    type(jump_operator), intent(in) :: operator
    type(joint_state), intent(in) :: joints(:)
    real(rk) :: traction(3, operator%num_points)
    call gather_tractions(operator, joints, traction)
    has_traction = any(abs(traction) > 0.0_rk)
  end function has_traction
end module static_increment
