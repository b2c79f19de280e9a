!> Equilibrium of an implicit step, static or dynamic:
!>
!>   K_eff x + weight*B^T (area t(v)) = rhs,   v = offset + B x      (theory.md, 8)
!>
!> for the free unknowns x. Solvers: linear (without joints), condensed and full Newton.
module equilibrium
  use kinds, only: rk
  use errors, only: error_type
  use global_vectors, only: norm
  use matrix_pattern, only: pattern
  use joint_law, only: joint_state
  use joint_points, only: dam_joint
  use joint_operator, only: jump_operator
  use joint_forces, only: gather_jumps, gather_tractions, take_origins
  use active_solve, only: repeated_solve
  use linear_solver, only: equation_solver
  use ranks, only: num_ranks
  use refined_solve, only: exact_matrix
  use run_ledger, only: ledger
  use step_plan, only: step_controls
  use stop_signals, only: is_asked_to_stop
  use unknown_parts, only: unknown_part
  implicit none
  private
  public :: equilibrium_solver, force_balance, balance_outcome, is_dropped
  public :: unmet_criterion, of_increment, of_jumps, of_solves

  !> Right-hand side and starting values.
  type :: force_balance
    real(rk), allocatable :: rhs(:) !< (free unknowns) [N]
    real(rk), allocatable :: offset(:, :) !< (3, points) jumps at x = 0 [m]
    real(rk), allocatable :: guess(:, :) !< (3, points) jumps near the solution [m]
    !> (3, points) tractions near the solution; not allocated: those of the last increment [Pa]
    real(rk), allocatable :: guess_traction(:, :)
    logical :: starts_closed = .false. !< all joints closed and sticking in the first iterate
    real(rk) :: reference_force = 0.0_rk !< largest force of the bulk so far [N]
    !> The right-hand side differs from the last one in active unknowns alone
    logical :: is_repeated = .false.
    logical :: is_partial = .false. !< the solution is needed at active unknowns alone
    logical :: is_static = .false. !< no inertia holds a block that has left its supports
    logical :: is_estimate = .false. !< not worth the blocks of the compliance that are left out
  contains
    procedure :: set_jumps, start_from
  end type force_balance

  !> A criterion that a solution of the iteration does not meet.
  type :: unmet_criterion
    character(9) :: name = '' !< one of those below; '' for the residual
    real(rk) :: value = 0.0_rk, tolerance = 0.0_rk
  end type unmet_criterion

  !> The last correction; the jumps of the solution, which are not those of the laws; what the
  !> solves leave of the forces.
  character(*), parameter :: of_increment = 'increment', of_jumps = 'jumps', of_solves = 'solves'

  !> Outcome of the iteration.
  type :: balance_outcome
    logical :: has_converged = .false.
    integer :: iterations = 0
    integer :: sweeps = 0 !< of Gauss-Seidel where Newton's iteration did not converge
    integer :: passes = 0 !< with given limits of friction where the sweeps did not suffice
    integer :: augmentations = 0 !< of the contact; each starts a pass of iterations
    integer :: first_pass = 0 !< iterations before the first augmentation, 0 for none
    integer :: pass_start = 0 !< iterations before the present pass
    real(rk) :: penetration = 0.0_rk !< largest of points in contact, over the admissible one
    logical :: gives_up = .false. !< the penetration does not decrease
    real(rk) :: unbalance = 0.0_rk !< norm of the residual forces of the joints over that force
    !> The least stiffness alone holds a block that the loads drive: in the last iterate; the
    !> iteration moves the block further and further, always by the same
    logical :: is_driven = .false., is_loose = .false.
    logical :: has_held_switches = .false. !< of laws with discontinuous stress (theory.md, 12)
    real(rk) :: residual = 0.0_rk !< norm of the residual forces over the reference force
    real(rk) :: tolerance = 0.0_rk !< of the residual
    real(rk) :: correction = 0.0_rk !< Newton correction for the residual, over the increment
    type(unmet_criterion) :: unmet !< of a solution that is within the tolerances of *CONTROLS
    integer :: worst_point = 0 !< joint point with the largest residual
    integer :: worst_node = 0 !< with the largest residual of inelastic solids
    real(rk), allocatable :: history(:) !< residuals of the iterations on inelastic solids
    real(rk) :: size_ratio = 1.0_rk !< requested by a material, over this increment
    character(:), allocatable :: failure !< why a material or uplift requests a smaller increment
  contains
    procedure :: own_iterations
  end type balance_outcome

  type, abstract :: equilibrium_solver
    class(equation_solver), allocatable :: factor !< of the symmetric, positive definite matrix
    logical :: may_repeat = .false. !< solves may be repeated for active unknowns alone
    type(repeated_solve) :: repeated !< solves between two full ones
    type(exact_matrix) :: exact !< where the factor is in single precision
    type(step_controls) :: controls
    !> (free unknowns, rank) U: the matrix is K_eff + U U^T; not allocated for K_eff alone
    real(rk), allocatable :: low_rank(:, :)
    type(jump_operator) :: operator !< of the joints
    type(unknown_part) :: part !< unknowns of this rank, where vectors are divided
    real(rk) :: weight = 1.0_rk !< of the joint forces
    integer :: num_factorisations = 0
    !> The compliance of joints has the blocks that were left out at first, until the next matrix
    logical :: has_all_blocks = .false.
    !> Condition number of the first matrix with all joints closed; 0 without joints
    real(rk) :: condition = 0.0_rk
    type(ledger) :: costs !< a copy that books in the ledger of the run
  contains
    procedure(prepare_matrix), deferred :: prepare_matrix
    procedure(solve_balance), deferred :: solve_balance
    procedure :: complete_solution, keep_single, solve_with_factor, admissible_residual
    procedure :: take_all_blocks => take_no_blocks
  end type equilibrium_solver

  !> Residual that a solve with a factor in single precision may leave, over the tolerance.
  real(rk), parameter :: share_of_solve = 0.3_rk
  !> The same of an iteration, so that results differ less than the tolerance from exact ones.
  real(rk), parameter :: share_of_iteration = 0.01_rk*share_of_solve

  abstract interface
    !> Factors a new K_eff, after a change of the increment size.
    subroutine prepare_matrix(self, matrix, values, weight, joints, operator, error)
      import :: equilibrium_solver, pattern, rk, dam_joint, jump_operator, error_type
      implicit none
      class(equilibrium_solver), intent(inout) :: self
      type(pattern), intent(in) :: matrix
      real(rk), intent(in) :: values(:) !< K_eff without joints
      real(rk), intent(in) :: weight
      type(dam_joint), intent(in) :: joints(:)
      type(jump_operator), intent(in) :: operator
      type(error_type), allocatable, intent(out) :: error
    end subroutine prepare_matrix

    !> Solves the equilibrium. An iteration without convergence is not an error.
    subroutine solve_balance(self, balance, joints, old, new, x, outcome, error)
      import :: equilibrium_solver, force_balance, balance_outcome, rk, dam_joint, joint_state, &
        error_type
      implicit none
      class(equilibrium_solver), intent(inout) :: self
      type(force_balance), intent(in) :: balance
      type(dam_joint), intent(in) :: joints(:)
      type(joint_state), intent(in) :: old(:) !< converged histories
      type(joint_state), intent(inout) :: new(:) !< histories at the solution
      real(rk), intent(out) :: x(:) !< (all unknowns) prescribed ones return as zero
      type(balance_outcome), intent(out) :: outcome
      type(error_type), allocatable, intent(out) :: error
    end subroutine solve_balance
  end interface

contains

  !> Jumps at x = 0, and the first guess: the converged jumps.
  subroutine set_jumps(self, operator, q, old)
    class(force_balance), intent(inout) :: self
    type(jump_operator), intent(in) :: operator
    real(rk), intent(in) :: q(:) !< (all unknowns) at x = 0, supports in place [m]
    type(joint_state), intent(in) :: old(:) !< converged histories
    allocate (self%offset(3, operator%num_points), self%guess(3, operator%num_points))
    call operator%jumps(q, self%offset)
    call take_origins(operator, old, self%offset)
    call gather_jumps(operator, old, self%guess)
  end subroutine set_jumps

  !> Starts the iteration from the last iterate of the joints.
  subroutine start_from(self, operator, new)
    class(force_balance), intent(inout) :: self
    type(jump_operator), intent(in) :: operator
    type(joint_state), intent(in) :: new(:) !< histories of the iterate
    real(rk), dimension(3, operator%num_points) :: jump, traction
    call gather_jumps(operator, new, jump)
    call gather_tractions(operator, new, traction)
    self%starts_closed = .false.
    self%guess = jump
    self%guess_traction = traction
  end subroutine start_from

  !> Whether a signal ends the iteration of an increment, which is then dropped. Ranks get
  !> signals at different times: several ranks complete the increment.
  logical function is_dropped(controls)
    type(step_controls), intent(in) :: controls
    is_dropped = controls%may_be_dropped
    if (is_dropped) is_dropped = num_ranks() == 1
    if (is_dropped) is_dropped = is_asked_to_stop()
  end function is_dropped

  !> Iterations of the first pass, for the control of the increment size.
  pure integer function own_iterations(self) result(iterations)
    class(balance_outcome), intent(in) :: self
    iterations = self%iterations
    if (self%first_pass > 0) iterations = self%first_pass
  end function own_iterations

  !> Keeps a copy of the factor in single precision, or the factor itself but for the part that
  !> holds some unknowns, as *CONTROLS asks.
  subroutine keep_single(self, matrix, values, unknown)
    class(equilibrium_solver), intent(inout) :: self
    type(pattern), intent(in) :: matrix
    real(rk), intent(in) :: values(:) !< of the matrix that is factored
    integer, intent(in) :: unknown(:)
    logical :: has_copy
    has_copy = .false.
    if (self%controls%precision == 'MIXED') call self%factor%copy_single(has_copy)
    call self%repeated%open(self%factor, has_copy, &
                            values(matrix%column_start(:matrix%num_free)))
    if (self%controls%precision /= 'SINGLE') return
    call self%exact%round_factor(matrix, values, self%low_rank, unknown, self%factor)
  end subroutine keep_single

  !> Solves for `b`, in place, refined where the factor is in single precision; an iterative solver
  !> may leave a part of the admissible residual.
  subroutine solve_with_factor(self, admissible, b, error)
    class(equilibrium_solver), intent(inout) :: self
    real(rk), intent(in) :: admissible !< norm of the residual that may be left [N]
    real(rk), intent(inout) :: b(:, :) !< (free unknowns, right-hand sides)
    type(error_type), allocatable, intent(out) :: error
    integer :: k
    if (.not. self%exact%is_rounded()) then
      call self%factor%solve_within(share_of_iteration/share_of_solve*admissible, b, error)
      return
    end if
    do k = 1, size(b, 2)
      call self%exact%solve(self%factor, admissible, b(:, k), error)
      if (allocated(error)) return
    end do
  end subroutine solve_with_factor

  !> Computes the blocks of the compliance of joints that are left out, in solvers that leave any.
  subroutine take_no_blocks(self, error)
    class(equilibrium_solver), intent(inout) :: self
    type(error_type), allocatable, intent(out) :: error
  end subroutine take_no_blocks

  !> Norm of the residual that a solve may leave. In statics the forces of a small increment are
  !> small beside those so far, and the tolerance of its correction counts.
  real(rk) function admissible_residual(self, balance)
    class(equilibrium_solver), intent(in) :: self
    type(force_balance), intent(in) :: balance
    real(rk) :: force
    force = norm(self%part, balance%rhs)
    associate (controls => self%controls)
      admissible_residual = controls%residual_tolerance*max(balance%reference_force, force)
      if (balance%is_static .and. force > 0.0_rk) then
        admissible_residual = min(admissible_residual, controls%increment_tolerance*force)
      end if
    end associate
    admissible_residual = share_of_solve*admissible_residual
  end function admissible_residual

  !> Completes a solution at active unknowns alone.
  subroutine complete_solution(self, x, error)
    class(equilibrium_solver), intent(inout) :: self
    real(rk), intent(inout) :: x(:) !< (all unknowns)
    type(error_type), allocatable, intent(out) :: error
    if (.not. self%repeated%is_there(self%factor)) return
    call self%costs%start('solve backward', 'structure', 'solver')
    call self%repeated%complete(self%factor, x(:size(self%factor%order)), error)
    call self%costs%stop()
  end subroutine complete_solution
end module equilibrium
