!> The balance condensed on the joints (theory.md, section 8): K_0 = K_eff with all joints closed is
!> factored once for an increment size, and Newton runs on the jumps alone.
module condensation
  use kinds, only: rk
  use errors, only: error_type
  use matrix_pattern, only: pattern
  use joint_law, only: joint_state
  use joint_points, only: joint
  use joint_operator, only: jump_operator
  use joint_forces, only: joint_field, reference_stiffness
  use joint_iteration, only: start_iteration, relief, closed_tangent
  use joint_compliance, only: find_compliance, friction_scale
  use newton_condensed, only: condensed_joints, iterate
  use equilibrium, only: equilibrium_solver, force_balance, balance_outcome
  implicit none
  private
  public :: condensed_equilibrium

  type, extends(equilibrium_solver) :: condensed_equilibrium
    type(condensed_joints) :: condensed
  contains
    procedure :: prepare, solve
  end type condensed_equilibrium

contains

  !> Factors K_0, finds its compliance on the joints and the scale of the friction iteration.
  subroutine prepare(self, matrix, values, weight, joints, operator, error)
    class(condensed_equilibrium), intent(inout) :: self
    type(pattern), intent(in) :: matrix
    real(rk), intent(in) :: values(:) !< K_eff
    real(rk), intent(in) :: weight
    type(joint), intent(in) :: joints(:)
    type(jump_operator), intent(in) :: operator
    type(error_type), allocatable, intent(out) :: error
    real(rk), allocatable :: closed(:)
    self%operator = operator
    self%weight = weight
    self%condensed%weight = weight
    call reference_stiffness(joints, operator, self%condensed%reference)
    allocate (closed, source=values)
    call operator%add_stiffness(weight*closed_tangent(self%condensed%reference), matrix, closed)
    call self%costs%start('factorise', 'solver')
    call self%factor%factorise(matrix, closed, error)
    self%num_factorisations = self%num_factorisations + 1
    call self%costs%stop('factorise')
    if (allocated(error)) return
    call self%costs%start('compliance', 'joint')
    call find_compliance(self%factor, operator, matrix%num_free, self%condensed%compliance, error)
    if (allocated(error)) return
    call friction_scale(self%condensed%compliance, operator, self%condensed%reference, weight, &
                        self%condensed%scale)
    call self%costs%stop('compliance')
    call self%costs%set_memory('compliance', 'joint', 8.0e-6_rk*size(self%condensed%compliance))
  end subroutine prepare

  !> One solve for the guess, Newton on the jumps, one solve for what has changed.
  subroutine solve(self, balance, joints, old, new, x, outcome, error)
    class(condensed_equilibrium), intent(inout) :: self
    type(force_balance), intent(in) :: balance
    type(joint), intent(in) :: joints(:)
    type(joint_state), intent(in) :: old(:)
    type(joint_state), intent(inout) :: new(:)
    real(rk), intent(out) :: x(:)
    type(balance_outcome), intent(out) :: outcome
    type(error_type), allocatable, intent(out) :: error
    type(joint_field) :: field
    real(rk), dimension(3, self%operator%num_points) :: first_excess, excess
    real(rk), allocatable :: correction(:)
    associate (reference => self%condensed%reference, operator => self%operator)
      call start_iteration(balance, joints, operator, reference, self%condensed%scale, old, &
                           field, new)
      first_excess = relief(reference, field%jump, balance%offset, field%iterate)
      call respond(self, balance%rhs, first_excess, operator, x, error)
      if (allocated(error)) return
      call operator%jumps(x, field%response)
      field%response = field%response + balance%offset
      call self%costs%start('joints', 'joint')
      call iterate(self%condensed, self%controls, joints, operator, old, field, new, outcome)
      call self%costs%stop('joints')
      if (.not. outcome%has_converged) return
      excess = relief(reference, field%jump, balance%offset, field%iterate)
    end associate
    if (.not. any(abs(excess - first_excess) > 0.0_rk)) return
    allocate (correction(size(x)))
    call respond(self, 0.0_rk*balance%rhs, excess - first_excess, self%operator, correction, error)
    x = x + correction
  end subroutine solve

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
    call self%costs%start('solve', 'solver')
    call self%factor%solve(b, error)
    call self%costs%stop('solve')
    x = 0.0_rk
    x(:size(rhs)) = b(:, 1)
  end subroutine respond
end module condensation
