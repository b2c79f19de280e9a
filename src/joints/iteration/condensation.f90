!> Equilibrium condensed on the joints (theory.md, 8): K_0 = K_eff with all joints closed is
!> factored once for an increment size; Newton's method iterates on the jumps alone.
module condensation
  use kinds, only: rk
  use errors, only: error_type
  use matrix_pattern, only: pattern
  use global_vectors, only: norm
  use joint_law, only: joint_state
  use joint_points, only: dam_joint
  use joint_operator, only: jump_operator
  use joint_forces, only: joint_field, reference_stiffness, gather_jumps, gather_tractions
  use joint_iteration, only: start_iteration, excess_traction, closed_tangent
  use joint_compliance, only: find_compliance, find_contact_scale
  use matrix_condition, only: estimate_condition
  use solver_low_rank, only: add_low_rank
  use blas_threads, only: use_many_threads, use_one_thread
  use jump_block, only: jump_schur_block, extract_schur_block, schur_compliance
  use newton_condensed, only: condensed_joints, iterate_on_jumps
  use equilibrium, only: equilibrium_solver, force_balance, balance_outcome
  implicit none
  private
  public :: condensed_equilibrium

  type, extends(equilibrium_solver) :: condensed_equilibrium
    type(condensed_joints) :: condensed
    type(jump_schur_block) :: jumps !< saves one of the two solves of an increment
  contains
    procedure :: prepare_matrix, solve_balance
    procedure, private :: solve_from, has_drifted, begin_solve, end_solve
  end type condensed_equilibrium

  !> Admissible drift of the jumps, as a fraction of the residual tolerance.
  real(rk), parameter :: allowed_drift = 0.1_rk

contains

  !> Factors K_0 and computes the compliances G, C and the scale r of the contact.
  subroutine prepare_matrix(self, matrix, values, weight, joints, operator, error)
    class(condensed_equilibrium), intent(inout) :: self
    type(pattern), intent(in) :: matrix
    real(rk), intent(in) :: values(:) !< K_eff
    real(rk), intent(in) :: weight
    type(dam_joint), intent(in) :: joints(:)
    type(jump_operator), intent(in) :: operator
    type(error_type), allocatable, intent(out) :: error
    real(rk), allocatable :: closed(:)
    integer :: levels
    self%operator = operator
    self%weight = weight
    self%condensed%weight = weight
    call reference_stiffness(joints, operator, self%condensed%k_ref)
    allocate (closed, source=values)
    call operator%add_stiffness(weight*closed_tangent(self%condensed%k_ref), matrix, closed)
    call self%costs%start('factor', 'structure', 'solver')
    call add_low_rank(self%low_rank, self%factor)
    call self%factor%factorise(matrix, closed, error)
    self%num_factorisations = self%num_factorisations + 1
    call self%costs%stop()
    if (allocated(error)) return
    if (.not. self%condition > 0.0_rk) then
      call self%costs%start('solve', 'condition number', 'solver')
      call estimate_condition(matrix, closed, self%factor, self%condition, error)
      call self%costs%stop()
      if (allocated(error)) return
    end if
    call self%costs%start('condense', 'joints', 'joint')
    call extract_schur_block(self%factor, operator, matrix%num_free, matrix%num_last, self%jumps)
    if (self%jumps%is_there) then
      call use_many_threads(levels)
      call schur_compliance(self%jumps, operator, self%condensed%compliance)
      call use_one_thread(levels)
    else
      call find_compliance(self%factor, operator, matrix%num_free, self%condensed%compliance, error)
    end if
    if (allocated(error)) then
      call self%costs%stop()
      return
    end if
    call use_many_threads(levels)
    call find_contact_scale(self%condensed%compliance, operator, self%condensed%k_ref, weight, &
                            self%condensed%scale, self%condensed%open_compliance)
    call use_one_thread(levels)
    call self%costs%stop()
  end subroutine prepare_matrix

  !> Solves the equilibrium; solves again from the jumps found if they have drifted.
  subroutine solve_balance(self, balance, joints, old, new, x, outcome, error)
    class(condensed_equilibrium), intent(inout) :: self
    type(force_balance), intent(in) :: balance
    type(dam_joint), intent(in) :: joints(:)
    type(joint_state), intent(in) :: old(:)
    type(joint_state), intent(inout) :: new(:)
    real(rk), intent(out) :: x(:)
    type(balance_outcome), intent(out) :: outcome
    type(error_type), allocatable, intent(out) :: error
    type(force_balance) :: nearer
    integer :: iterations
    call self%solve_from(balance, joints, old, new, x, outcome, error)
    if (allocated(error) .or. .not. outcome%has_converged) return
    if (.not. self%has_drifted(balance, new, x)) return
    nearer = balance
    call nearer%start_from(self%operator, new)
    iterations = outcome%iterations
    call self%solve_from(nearer, joints, old, new, x, outcome, error)
    outcome%iterations = outcome%iterations + iterations
  end subroutine solve_balance

  !> Whether the jumps of the solution differ from those at which the laws were evaluated. A block
  !> without contact in one iterate moves far, and the way back loses digits.
  logical function has_drifted(self, balance, new, x)
    class(condensed_equilibrium), intent(in) :: self
    type(force_balance), intent(in) :: balance
    type(joint_state), intent(in) :: new(:)
    real(rk), intent(in) :: x(:)
    real(rk), dimension(3, self%operator%num_points) :: jump, drift, traction
    real(rk) :: force
    call self%operator%jumps(x, drift)
    call gather_jumps(self%operator, new, jump)
    call gather_tractions(self%operator, new, traction)
    drift = self%condensed%k_ref*(drift + balance%offset - jump)
    associate (area => spread(self%operator%area, 1, 3))
      force = max(norm(area*traction), balance%reference_force)
      has_drifted = norm(area*drift) > allowed_drift*self%controls%residual_tolerance*force
    end associate
  end function has_drifted

  !> Newton's method on the jumps between forward and backward substitution. Without the Schur block
  !> it takes two full solves: one for the guess, one for the change.
  subroutine solve_from(self, balance, joints, old, new, x, outcome, error)
    class(condensed_equilibrium), intent(inout) :: self
    type(force_balance), intent(in) :: balance
    type(dam_joint), intent(in) :: joints(:)
    type(joint_state), intent(in) :: old(:)
    type(joint_state), intent(inout) :: new(:)
    real(rk), intent(out) :: x(:)
    type(balance_outcome), intent(out) :: outcome
    type(error_type), allocatable, intent(out) :: error
    type(joint_field) :: field
    real(rk), dimension(3, self%operator%num_points) :: first_excess, excess
    real(rk), allocatable :: half(:)
    associate (k_ref => self%condensed%k_ref, operator => self%operator)
      call start_iteration(balance, joints, operator, k_ref, self%condensed%scale, old, field, new)
      first_excess = excess_traction(k_ref, field%jump, balance%offset, field%iterate)
      call self%begin_solve(balance%rhs, first_excess, half, x, error)
      if (allocated(error)) return
      call operator%jumps(x, field%response)
      field%response = field%response + balance%offset
      call self%costs%start('iterate', 'joints', 'joint')
      call iterate_on_jumps(self%condensed, self%controls, joints, operator, old, field, new, &
                            outcome)
      call self%costs%stop()
      if (.not. outcome%has_converged) return
      excess = excess_traction(k_ref, field%jump, balance%offset, field%iterate)
    end associate
    call self%end_solve(excess - first_excess, half, x, error)
  end subroutine solve_from

  !> Response to the guess: forward substitution and jumps, or all unknowns.
  subroutine begin_solve(self, rhs, excess, half, x, error)
    class(condensed_equilibrium), intent(inout) :: self
    real(rk), intent(in) :: rhs(:) !< (free unknowns)
    real(rk), intent(in) :: excess(:, :) !< (3, points) [Pa]
    real(rk), allocatable, intent(out) :: half(:) !< (free unknowns) after forward substitution
    real(rk), intent(out) :: x(:) !< (all unknowns)
    type(error_type), allocatable, intent(out) :: error
    if (.not. self%jumps%is_there) then
      call respond(self, rhs, excess, self%operator, x, error)
      return
    end if
    x = 0.0_rk
    call self%operator%add_forces(self%weight*excess, x)
    half = rhs + x(:size(rhs))
    call self%costs%start('solve forward', 'structure', 'solver')
    call self%factor%forward_substitute(half, error)
    x = 0.0_rk
    call self%jumps%store_jumps(half, x)
    call self%costs%stop()
  end subroutine begin_solve

  !> All unknowns, with the change of the joint forces since the guess.
  subroutine end_solve(self, change, half, x, error)
    class(condensed_equilibrium), intent(inout) :: self
    real(rk), intent(in) :: change(:, :) !< (3, points) of the excess traction [Pa]
    real(rk), allocatable, intent(inout) :: half(:)
    real(rk), intent(inout) :: x(:) !< (all unknowns)
    type(error_type), allocatable, intent(out) :: error
    real(rk) :: correction(size(x)), no_load(self%jumps%num_free)
    if (self%jumps%is_there) then
      correction = 0.0_rk
      call self%operator%add_forces(self%weight*change, correction)
      call self%costs%start('solve backward', 'structure', 'solver')
      call self%jumps%add_jump_forces(correction, half)
      call self%factor%backward_substitute(half, error)
      x = 0.0_rk
      x(:size(half)) = half
      call self%costs%stop()
    else if (any(abs(change) > 0.0_rk)) then
      no_load = 0.0_rk
      call respond(self, no_load, change, self%operator, correction, error)
      x = x + correction
    end if
  end subroutine end_solve

  !> x = K_0^-1 (rhs + weight*B^T area*excess).
  subroutine respond(self, rhs, excess, operator, x, error)
    type(condensed_equilibrium), intent(inout) :: self
    real(rk), intent(in) :: rhs(:) !< (free unknowns)
    real(rk), intent(in) :: excess(:, :) !< (3, points) [Pa]
    type(jump_operator), intent(in) :: operator
    real(rk), intent(out) :: x(:) !< (all unknowns)
    type(error_type), allocatable, intent(out) :: error
    real(rk), allocatable :: b(:, :)
    x = 0.0_rk
    call operator%add_forces(self%weight*excess, x)
    b = reshape(rhs + x(:size(rhs)), [size(rhs), 1])
    call self%costs%start('solve', 'structure', 'solver')
    call self%factor%solve(b, error)
    call self%costs%stop()
    x = 0.0_rk
    x(:size(rhs)) = b(:, 1)
  end subroutine respond
end module condensation
