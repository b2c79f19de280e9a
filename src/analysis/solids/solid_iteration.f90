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
  use changing_elements, only: element_choice
  use analysis_state, only: state, motion
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
  use step_plan, only: step, step_before
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
    logical :: may_cut = .false. !< the present increment
    logical :: has_stopped = .false. !< early, in the last iteration
    type(tangent), allocatable :: choices(:) !< tried one after the other
    type(tangent) :: chosen !< the present one
    type(time_increment) :: time
    type(tangent_matrix) :: matrix
    type(block_answer), allocatable :: answers(:) !< (blocks)
    type(element_choice) :: elements !< that take part in the iteration
    logical :: may_choose = .false. !< elements; else all take part
    real(rk), allocatable :: guest_excess(:, :) !< (3, nodes) of guests with a history [N]
    real(rk), allocatable :: excess(:) !< (num_total) initial-stress force of the last iterate [N]
    type(damping_loss) :: loss !< its force is part of `excess`
    type(work_correction) :: correction !< its weighted force is part of `excess` too
    type(mixer) :: mixer
  contains
    procedure :: open => open_solids
    procedure :: open_increment, solve_increment, effort, set_internal
    procedure :: has_inelastic, start_lost_damping
  end type solid_solver

  !> Iterations without factorisation are cheap: the limit is this many times higher.
  integer, parameter :: cheap_iterations = 5

  interface
    !> Iterates until residual and correction are within the tolerances.
    module subroutine iterate_on_forces(self, model, system, task, before, after, outcome, error)
      implicit none
      class(solid_solver), intent(inout) :: self
      type(problem), intent(in) :: model
      type(dam_system), intent(in) :: system
      type(increment_task), intent(inout) :: task
      type(state), intent(in) :: before
      type(state), intent(inout) :: after
      type(balance_outcome), intent(out) :: outcome
      type(error_type), allocatable, intent(out) :: error
    end subroutine iterate_on_forces
  end interface

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
    self%mixer%starts_afresh = self%stops_early
    self%may_choose = plan%procedure%has_inertia .and. .not. has_histories(now%guests)
    call system%set_thermal(now%motion)
    call system%find_elastic(now%motion%q, now%motion%elastic)
    if (size(now%points) > 0 .or. has_histories(now%guests)) then
      self%mixer%part = system%matrix%part
      if (.not. has_histories(now%guests)) then
        call self%mixer%choose_rows(system%matrix%part, find_active(model, system%numbers))
      end if
      allocate (self%excess(system%matrix%num_total))
      self%guest_excess = zero_vectors(model%mesh%num_nodes)
      call open_answers(model%inelastic, self%answers)
      call recall_points(model, now%points, self%answers)
      call recall_guests(model, now%u, now%guests, self%guest_excess)
      call sum_excess(model, system%numbers, system%matrix%part, self%answers, &
                      self%guest_excess, self%excess)
    end if
    call self%set_internal(now%motion)
  end subroutine open_solids

  !> Adds the damping force that cracks have lost at the start of a dynamic step. A step that goes
  !> on with the motion and the damping of the step before keeps the force of its last increment.
  subroutine start_lost_damping(self, model, system, plan, last, goes_on, now)
    class(solid_solver), intent(inout) :: self
    type(problem), intent(in) :: model
    type(dam_system), intent(in) :: system
    type(step), intent(in) :: plan
    type(motion), intent(in) :: last !< at the end of the step before
    logical, intent(in) :: goes_on !< with the motion of the step before
    type(state), intent(inout) :: now !< with its velocities
    type(increment_task) :: task
    logical :: is_kept
    call self%loss%open(model, plan)
    if (.not. self%has_inelastic()) return
    is_kept = goes_on .and. allocated(last%lost_damping)
    if (is_kept .and. .not. now%has_opened_step) then ! else the motion is that of this step
      is_kept = self%loss%is_same(model, model%steps(step_before(model%steps, now%step)))
    end if
    if (is_kept) then
      self%loss%force = last%lost_damping
      self%excess = self%excess + self%loss%force
      call self%set_internal(now%motion)
      return
    end if
    task%velocity = now%motion%v
    task%x = 0.0_rk*now%motion%v
    call self%loss%add_force(model, system, task, now%points, self%answers, self%excess)
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
    self%may_cut = now%control%may_cut(increment)
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
  !> If a law requests a smaller increment, no other tangent is tried, nor where the residual falls
  !> too slowly in an increment that can be cut; held switches are another problem.
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
      outcome%tolerance = self%solver%controls%residual_tolerance
      return
    end if
    do i = 1, size(self%choices)
      self%chosen = self%choices(i)
      self%time%tangent = self%chosen%kind
      self%time%holds_switches = self%chosen%holds_switches
      call iterate_on_forces(self, model, system, task, before, after, outcome, error)
      outcome%has_held_switches = self%chosen%holds_switches
      outcome%tolerance = self%solver%controls%residual_tolerance
      if (allocated(error) .or. outcome%has_converged) return
      if (is_dropped(self%solver%controls)) return
      if (.not. self%matrix%is_elastic) then
        call self%matrix%factorise_elastic(model, system, self%values, self%solver, error)
        if (allocated(error)) return
      end if
      if (outcome%size_ratio < 1.0_rk .or. i == size(self%choices)) return
      if (self%has_stopped .and. self%may_cut .and. .not. self%choices(i + 1)%holds_switches) return
    end do
  end subroutine solve_increment
end module solid_iteration
