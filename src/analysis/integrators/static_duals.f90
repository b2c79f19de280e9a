!> The dual solutions of a static step (theory.md, 14.2): unit forces where and as the displacement
!> is largest, and on the two faces of the joint where the opening is largest. Without a solution
!> there is no estimate of these errors.
module static_duals
  use analysis_state, only: state
  use dual_solutions, only: dual_solution, of_displacement, of_opening
  use equilibrium, only: balance_outcome, equilibrium_solver, force_balance
  use equilibrium_catalogue, only: condensed_solver
  use errors, only: error_type
  use global_vectors, only: dot, largest_entry
  use joint_forces, only: gather_tractions
  use joint_law, only: joint_state, state_open, state_slip
  use joint_opening, only: opening_of
  use kinds, only: rk
  use node_dofs, only: zero_vectors
  use node_parts, only: find_largest, gather_field
  use problem_definition, only: problem
  use step_plan, only: step_controls
  use step_system, only: dam_system
  implicit none
  private
  public :: find_duals, is_affordable

  !> The unit force over the largest force of the step: joints change little under it.
  real(rk), parameter :: share_of_force = 1.0e-3_rk
  !> Tolerance of the responses over that of the step.
  real(rk), parameter :: tighter = 1.0e-2_rk
  !> Responses need no less, and round-off may not allow it: for the residual, and for the last
  !> correction over the response, which is round-off where the converged state is solved for again.
  real(rk), parameter :: least_tolerance = 1.0e-10_rk, least_correction = 1.0e-3_rk

  !> An equilibrium beside the converged one.
  type :: response
    real(rk), allocatable :: x(:) !< (num_total) change of the unknowns [m]
    type(joint_state), allocatable :: joints(:)
    logical :: is_found = .false.
  end type response

contains

  !> Whether a solution costs little: the full solver of joints factors in every iteration.
  pure logical function is_affordable(model, controls)
    type(problem), intent(in) :: model
    type(step_controls), intent(in) :: controls
    is_affordable = size(model%joints) == 0 .or. controls%joint_solver == condensed_solver &
                    .or. controls%joint_solver == 'AUTO'
  end function is_affordable

  !> The dual solutions of a converged state of linear solids.
  subroutine find_duals(model, system, solver, now, duals)
    type(problem), intent(in) :: model
    type(dam_system), intent(in) :: system
    class(equilibrium_solver), intent(inout) :: solver
    type(state), intent(in) :: now
    type(dual_solution), allocatable, intent(out) :: duals(:)
    real(rk), allocatable :: force(:, :)
    type(response) :: rest
    integer :: k
    allocate (duals(0))
    call add_displacement(model, system, now, duals, force)
    if (system%operator%num_points > 0) call add_opening(system, now, duals, force)
    if (size(duals) == 0) return
    if (system%operator%num_points == 0) then
      call respond_linearly(model, system, solver, residual_of(system, now), force, duals)
      return
    end if
    call respond(model, system, solver, 0.0_rk*force(:, 1), now, rest)
    do k = 1, size(duals)
      if (rest%is_found) then
        call respond_with_joints(model, system, solver, force(:, k), now, rest, duals(k))
      end if
    end do
    duals = pack_found(duals)
  end subroutine find_duals

  !> Those with a solution.
  function pack_found(duals) result(found)
    type(dual_solution), intent(in) :: duals(:)
    type(dual_solution), allocatable :: found(:)
    integer :: k
    allocate (found(0))
    do k = 1, size(duals)
      if (allocated(duals(k)%u)) found = [found, duals(k)]
    end do
  end function pack_found

  !> Forces that the iteration has left without balance.
  function residual_of(system, now) result(residual)
    type(dam_system), intent(in) :: system
    type(state), intent(in) :: now
    real(rk) :: residual(system%matrix%num_free)
    associate (own => now%motion, n => system%matrix%num_free)
      residual = own%external(:n) - own%internal(:n) - own%contact(:n)
    end associate
  end function residual_of

  !> A unit force at the node and in the direction of the largest displacement.
  subroutine add_displacement(model, system, now, duals, force)
    type(problem), intent(in) :: model
    type(dam_system), intent(in) :: system
    type(state), intent(in) :: now
    type(dual_solution), allocatable, intent(inout) :: duals(:)
    real(rk), allocatable, intent(out) :: force(:, :) !< (num_total, goals) [N]
    real(rk), allocatable :: at_nodes(:, :), q(:)
    type(dual_solution) :: own
    real(rk) :: u(3)
    integer :: node
    allocate (force(system%matrix%num_total, 0), q(system%matrix%num_total))
    call find_largest(now%u, node, u)
    own%goal = of_displacement
    own%value = norm2(u)
    if (own%value <= 0.0_rk) return
    at_nodes = zero_vectors(model%mesh%num_nodes)
    at_nodes(:, node) = u/own%value
    call system%numbers%reduce(at_nodes, q)
    call add_goal(own, q, duals, force)
  end subroutine add_displacement

  !> Unit forces that open the point with the largest opening.
  subroutine add_opening(system, now, duals, force)
    type(dam_system), intent(in) :: system
    type(state), intent(in) :: now
    type(dual_solution), allocatable, intent(inout) :: duals(:)
    real(rk), allocatable, intent(inout) :: force(:, :) !< (num_total, goals) [N]
    real(rk) :: traction(3, system%operator%num_points), q(system%matrix%num_total)
    real(rk), allocatable :: opening(:)
    type(dual_solution) :: own
    integer :: j, p, point
    own%goal = of_opening
    point = 0
    do j = 1, size(now%joints)
      opening = opening_of(now%joints(j)%jump(1, :), now%joints(j)%gap)
      p = maxloc(opening, dim=1)
      if (p == 0) cycle
      if (opening(p) <= own%value) cycle
      own%value = opening(p)
      point = system%operator%first_point(j) + p - 1
    end do
    if (point == 0) return
    traction = 0.0_rk
    traction(1, point) = 1.0_rk/system%operator%area(point)
    q = 0.0_rk
    call system%operator%add_forces(traction, q)
    call add_goal(own, q, duals, force)
  end subroutine add_opening

  !> Appends a goal and its force.
  subroutine add_goal(own, q, duals, force)
    type(dual_solution), intent(in) :: own
    real(rk), intent(in) :: q(:) !< (num_total) [N]
    type(dual_solution), allocatable, intent(inout) :: duals(:)
    real(rk), allocatable, intent(inout) :: force(:, :) !< (num_total, goals) [N]
    duals = [duals, own]
    force = reshape([force, q], [size(q), size(duals)])
  end subroutine add_goal

  !> The responses of a structure without joints.
  subroutine respond_linearly(model, system, solver, residual, force, duals)
    type(problem), intent(in) :: model
    type(dam_system), intent(in) :: system
    class(equilibrium_solver), intent(inout) :: solver
    real(rk), intent(in) :: residual(:) !< (num_free) [N]
    real(rk), intent(in) :: force(:, :) !< (num_total, goals) [N]
    type(dual_solution), allocatable, intent(inout) :: duals(:)
    type(error_type), allocatable :: failure
    real(rk), allocatable :: x(:, :)
    integer :: k
    x = force(:size(residual), :)
    call solver%factor%solve(x, failure)
    if (allocated(failure)) then
      duals = duals(:0)
      return
    end if
    do k = 1, size(duals)
      call spread_response(model, system, x(:, k), duals(k))
      duals(k)%iteration = abs(dot(system%matrix%part, residual, x(:, k)))
    end do
  end subroutine respond_linearly

  !> The displacements of nodes of a response.
  subroutine spread_response(model, system, x, own)
    type(problem), intent(in) :: model
    type(dam_system), intent(in) :: system
    real(rk), intent(in) :: x(:) !< (num_free) [m/N]
    type(dual_solution), intent(inout) :: own
    real(rk) :: q(system%matrix%num_total)
    q = 0.0_rk
    q(:size(x)) = x
    allocate (own%u(3, system%numbers%num_nodes))
    call system%numbers%expand(q, own%u)
    call gather_field(model%mesh, own%u)
  end subroutine spread_response

  !> One more equilibrium, from the converged one on.
  subroutine respond(model, system, solver, load, now, found)
    type(problem), intent(in) :: model
    type(dam_system), intent(in) :: system
    class(equilibrium_solver), intent(inout) :: solver
    real(rk), intent(in) :: load(:) !< (num_total) beyond those of the step [N]
    type(state), intent(in) :: now
    type(response), intent(out) :: found
    type(force_balance) :: balance
    type(balance_outcome) :: outcome
    type(error_type), allocatable :: failure
    type(step_controls) :: kept
    associate (n => system%matrix%num_free)
      balance%rhs = load(:n) + now%motion%external(:n) - now%motion%internal(:n)
    end associate
    balance%reference_force = now%largest_force
    balance%is_static = .true.
    balance%is_estimate = .true.
    call balance%set_jumps(system%operator, now%motion%q, now%joints)
    allocate (found%x(size(load)))
    found%joints = now%joints
    kept = solver%controls
    solver%controls%residual_tolerance = min(kept%residual_tolerance, &
                                             max(tighter*kept%residual_tolerance, least_tolerance))
    solver%controls%increment_tolerance = max(kept%increment_tolerance, least_correction)
    solver%controls%most_unsaved = huge(1)
    call solver%solve_balance(balance, model%joints, now%joints, found%joints, found%x, outcome, &
                              failure)
    solver%controls = kept
    found%is_found = outcome%has_converged .and. .not. allocated(failure)
  end subroutine respond

  !> The response to a unit force at the state that the joints are in, and the errors that it shows.
  subroutine respond_with_joints(model, system, solver, force, now, rest, own)
    type(problem), intent(in) :: model
    type(dam_system), intent(in) :: system
    class(equilibrium_solver), intent(inout) :: solver
    real(rk), intent(in) :: force(:) !< (num_total) unit force [N]
    type(state), intent(in) :: now
    type(response), intent(in) :: rest !< without a further force
    type(dual_solution), intent(inout) :: own !< keeps no displacements where none are found
    type(response) :: pulled
    real(rk), dimension(3, system%operator%num_points) :: traction, at_rest
    real(rk) :: scale
    scale = share_of_force*now%largest_force/largest_entry(system%matrix%part, abs(force))
    call respond(model, system, solver, scale*force, now, pulled)
    if (.not. pulled%is_found) return
    associate (n => system%matrix%num_free)
      call spread_response(model, system, (pulled%x(:n) - rest%x(:n))/scale, own)
      own%iteration = abs(dot(system%matrix%part, force(:n), rest%x(:n)))
    end associate
    call gather_tractions(system%operator, pulled%joints, traction)
    call gather_tractions(system%operator, rest%joints, at_rest)
    own%joints = abs(work_of_springs(system, now%joints, (traction - at_rest)/scale))
  end subroutine respond_with_joints

  !> The work of the dual tractions along the displacements of the springs of closed joints: what
  !> rigid springs would change in the result, to first order.
  real(rk) function work_of_springs(system, joints, traction) result(work)
    type(dam_system), intent(in) :: system
    type(joint_state), intent(in) :: joints(:)
    real(rk), intent(in) :: traction(:, :) !< (3, points) under a unit force [Pa/N]
    real(rk) :: spring(3)
    integer :: j, p, point
    work = 0.0_rk
    do j = 1, size(joints)
      associate (own => joints(j))
        do p = 1, size(own%gap)
          if (own%status(p) == state_open) cycle
          spring(1) = opening_of(own%jump(1, p), own%gap(p))
          spring(2:) = own%jump(2:, p) - own%slip(:, p)
          if (own%status(p) == state_slip) spring(2:) = 0.0_rk
          point = system%operator%first_point(j) + p - 1
          work = work + system%operator%area(point)*dot(spring, traction(:, point))
        end do
      end associate
    end do
  end function work_of_springs
end module static_duals
