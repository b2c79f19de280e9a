!> Equilibrium without joints: one solve, no iteration. The matrix may be unsymmetric.
module equilibrium_linear
  use kinds, only: rk
  use errors, only: error_type
  use matrix_pattern, only: pattern
  use joint_law, only: joint_state
  use joint_points, only: dam_joint
  use joint_operator, only: jump_operator
  use linear_solver, only: equation_solver
  use solver_low_rank, only: add_low_rank
  use solver_catalogue, only: make_solver, unsymmetric_solver
  use equilibrium, only: equilibrium_solver, force_balance, balance_outcome
  implicit none
  private
  public :: linear_equilibrium

  type, extends(equilibrium_solver) :: linear_equilibrium
    class(equation_solver), allocatable :: unsymmetric_factor
    logical :: is_unsymmetric = .false. !< of the last matrix
  contains
    procedure :: prepare_matrix, solve_balance
  end type linear_equilibrium

contains

  !> Factors K_eff.
  subroutine prepare_matrix(self, matrix, values, weight, joints, operator, error)
    class(linear_equilibrium), intent(inout) :: self
    type(pattern), intent(in) :: matrix
    real(rk), intent(in) :: values(:) !< K_eff
    real(rk), intent(in) :: weight
    type(dam_joint), intent(in) :: joints(:) !< none
    type(jump_operator), intent(in) :: operator
    type(error_type), allocatable, intent(out) :: error
    self%weight = weight
    if (size(joints) == 0) self%operator = operator
    self%is_unsymmetric = .not. matrix%is_symmetric
    if (self%is_unsymmetric .and. .not. allocated(self%unsymmetric_factor)) then
      call self%costs%start('analyse', 'structure', 'solver')
      call make_solver(unsymmetric_solver, self%unsymmetric_factor, error, matrix%is_shared)
      if (.not. allocated(error)) call self%unsymmetric_factor%analyse(matrix, error)
      call self%costs%stop()
      if (allocated(error)) return
    end if
    call self%costs%start('factor', 'structure', 'solver')
    if (.not. self%is_unsymmetric) then
      call add_low_rank(self%low_rank, self%factor)
      call self%exact%forget()
      call self%factor%factorise(matrix, values, error)
      if (.not. allocated(error)) call self%keep_single(matrix, values, [integer ::])
    else
      call add_low_rank(self%low_rank, self%unsymmetric_factor)
      call self%unsymmetric_factor%factorise(matrix, values, error)
    end if
    call self%costs%stop()
    self%num_factorisations = self%num_factorisations + 1
  end subroutine prepare_matrix

  !> x = K_eff^-1 rhs.
  subroutine solve_balance(self, balance, joints, old, new, x, outcome, error)
    class(linear_equilibrium), intent(inout) :: self
    type(force_balance), intent(in) :: balance
    type(dam_joint), intent(in) :: joints(:) !< none
    type(joint_state), intent(in) :: old(:)
    type(joint_state), intent(inout) :: new(:)
    real(rk), intent(out) :: x(:)
    type(balance_outcome), intent(out) :: outcome
    type(error_type), allocatable, intent(out) :: error
    real(rk), allocatable :: b(:, :)
    b = reshape(balance%rhs, [size(balance%rhs), 1])
    x = 0.0_rk
    call self%costs%start('solve', 'structure', 'solver')
    if (self%is_unsymmetric) then
      call self%unsymmetric_factor%solve(b, error)
    else if (self%repeated%is_there(self%factor)) then
      if (.not. balance%is_repeated) then
        call self%repeated%start(self%factor, self%admissible_residual(balance), balance%rhs, error)
      end if
      if (.not. allocated(error)) call self%repeated%forward(self%factor, b(:, 1), error)
      if (.not. allocated(error)) then
        call self%repeated%backward(self%factor, b(:, 1), balance%is_partial, x(:size(b, 1)), error)
      end if
      b(:, 1) = x(:size(b, 1))
    else
      call self%solve_with_factor(self%admissible_residual(balance), b, error)
    end if
    call self%costs%stop()
    x(:size(b, 1)) = b(:, 1)
    if (size(joints) > 0) new = old
    outcome%has_converged = .true.
    outcome%iterations = 1
  end subroutine solve_balance
end module equilibrium_linear
