!> Equilibrium with joints by full Newton: the tangent of the joints is assembled and factored in
!> each iteration, by CHOLMOD when it is symmetric and by UMFPACK when friction slides or the
!> tangent of the solids is not symmetric.
module newton_full
  use kinds, only: rk
  use errors, only: error_type, analysis_failed
  use matrix_pattern, only: pattern, full_pattern, spread_values
  use joint_law, only: joint_state
  use joint_points, only: dam_joint
  use joint_operator, only: jump_operator, joint_springs
  use joint_forces, only: joint_field, reference_stiffness, linear_tractions
  use joint_iteration, only: joint_increment, iteration_history, start_iteration, take_step, &
                             closed_tangent, measure_residual, measure_correction, goes_on, &
                             close_iteration
  use joint_policy, only: joint_process, iterate_joints, jumps_of, share_of
  use block_compliance, only: take_blocks
  use contact_scaling, only: find_contact_scale
  use joint_compliance, only: find_compliance
  use point_groups, only: group_list, single_group
  use linear_solver, only: equation_solver
  use matrix_condition, only: estimate_condition
  use solver_low_rank, only: add_low_rank
  use solver_catalogue, only: make_solver, unsymmetric_solver
  use equilibrium, only: equilibrium_solver, force_balance, balance_outcome, is_dropped
  implicit none
  private
  public :: full_equilibrium

  !> Newton's iteration on all unknowns, for the policy of the iteration.
  type, extends(joint_process) :: full_process
    class(full_equilibrium), pointer :: solver => null() !< during an increment
    type(force_balance) :: balance
  contains
    procedure :: run_newton
    procedure :: find_response, find_closed
  end type full_process

  type, extends(equilibrium_solver) :: full_equilibrium
    type(pattern) :: matrix !< of K_eff: lower triangle, or both
    type(pattern) :: full_matrix !< both triangles, built when first needed
    class(equation_solver), allocatable :: unsymmetric_factor
    real(rk), allocatable :: values(:) !< K_eff
    type(full_process) :: process
    logical :: is_unsymmetric = .false. !< of the last tangent
  contains
    procedure :: prepare_matrix, solve_balance
    procedure, private :: factorise_tangent, back_substitute
  end type full_equilibrium

contains

  !> Stores K_eff and computes r, with one factorisation for the closed joints. An unsymmetric
  !> tangent leaves r unchanged.
  subroutine prepare_matrix(self, matrix, values, weight, joints, operator, error)
    class(full_equilibrium), intent(inout) :: self
    type(pattern), intent(in) :: matrix
    real(rk), intent(in) :: values(:) !< K_eff
    real(rk), intent(in) :: weight
    type(dam_joint), intent(in) :: joints(:)
    type(jump_operator), intent(in) :: operator
    type(error_type), allocatable, intent(out) :: error
    type(group_list) :: all_points
    real(rk), allocatable :: compliance(:, :), closed(:)
    self%operator = operator
    self%weight = weight
    self%process%weight = weight
    self%matrix = matrix
    self%values = values
    if (.not. matrix%is_symmetric) return
    call reference_stiffness(joints, operator, self%process%k_ref)
    call self%factorise_tangent(operator, closed_tangent(self%process%k_ref), error)
    if (allocated(error)) return
    if (.not. self%condition > 0.0_rk) then
      allocate (closed, source=values)
      call operator%add_stiffness(weight*closed_tangent(self%process%k_ref), matrix, closed)
      call self%costs%start('solve', 'condition number', 'solver')
      call estimate_condition(matrix, closed, self%factor, self%condition, error)
      call self%costs%stop()
      if (allocated(error)) return
    end if
    call self%costs%start('condense', 'joints', 'joint')
    call find_compliance(self%factor, operator, matrix%num_free, compliance, error)
    if (.not. allocated(error)) then
      call single_group(operator%num_points, all_points)
      call take_blocks(compliance, joint_springs(operator, self%process%k_ref, weight), &
                       all_points, 0.0_rk, self%process%blocks)
      deallocate (compliance)
      call find_contact_scale(self%process%blocks, operator, self%process%k_ref, weight, &
                              self%process%scale, self%process%opened)
    end if
    call self%costs%stop()
  end subroutine prepare_matrix

  !> Iterates on all unknowns.
  subroutine solve_balance(self, balance, joints, old, new, x, outcome, error)
    class(full_equilibrium), intent(inout) :: self
    type(force_balance), intent(in) :: balance
    type(dam_joint), intent(in) :: joints(:)
    type(joint_state), intent(in) :: old(:)
    type(joint_state), intent(inout) :: new(:)
    real(rk), intent(out) :: x(:)
    type(balance_outcome), intent(out) :: outcome
    type(error_type), allocatable, intent(out) :: error
    self%process%balance = balance
    self%process%x = spread(0.0_rk, 1, size(x))
    if (allocated(self%process%closed_jump)) deallocate (self%process%closed_jump)
    call iterate_on_all(self, joints, old, new, outcome)
    x = self%process%x
    call move_alloc(self%process%failure, error)
  end subroutine solve_balance

  !> Iterates by the policy of all solvers.
  subroutine iterate_on_all(self, joints, old, new, outcome)
    class(full_equilibrium), intent(inout), target :: self
    type(dam_joint), intent(in), target :: joints(:)
    type(joint_state), intent(in), target :: old(:)
    type(joint_state), intent(inout), target :: new(:)
    type(balance_outcome), intent(inout) :: outcome
    type(joint_increment) :: now
    associate (own => self%process)
      own%solver => self
      call now%view(self%controls, joints, self%operator, own%k_ref, old, new)
      call start_iteration(own%balance, own%scale, now)
      call iterate_joints(own, now)
      nullify (own%solver)
    end associate
    outcome = now%outcome
  end subroutine iterate_on_all

  !> Iterates until residual and correction are within the tolerances, or in a cycle.
  subroutine run_newton(self, now)
    class(full_process), intent(inout) :: self
    type(joint_increment), intent(inout) :: now
    real(rk), dimension(3, now%operator%num_points) :: correction, linear, answer
    type(iteration_history) :: history
    real(rk) :: unused(size(self%x))
    allocate (history%unbalance(0), history%step(0))
    associate (solver => self%solver, balance => self%balance, operator => now%operator, &
               field => now%field, outcome => now%outcome)
      do while (goes_on(history, now))
        if (is_dropped(now%controls)) return
        outcome%iterations = outcome%iterations + 1
        call solver%factorise_tangent(operator, field%tangent, self%failure)
        if (allocated(self%failure)) then
          ! A smaller increment may avoid a singular tangent.
          if (self%failure%exit_code == analysis_failed) deallocate (self%failure)
          return
        end if
        call linear_tractions(field, balance%offset - field%jump, linear)
        call solver%back_substitute(balance%rhs, -linear, operator, self%x, answer, self%failure)
        if (allocated(self%failure)) return
        correction = balance%offset + answer - field%jump
        call linear_tractions(field, correction, linear)
        if (.not. allocated(self%closed_jump)) then
          call store_closed(self, operator, field, balance%offset + answer, linear)
        end if
        call take_step(correction, linear, now)
        call measure_residual(linear, now)
        if (outcome%residual <= now%controls%residual_tolerance) then
          call solver%back_substitute(0.0_rk*balance%rhs, linear - field%traction, operator, &
                                      unused, answer, self%failure)
          if (allocated(self%failure)) return
          call measure_correction(answer, now)
        end if
        call close_iteration(now, history)
      end do
    end associate
    now%field%iterate = linear
  end subroutine run_newton

  !> Stores jumps with closed joints, from the first equilibrium of the structure.
  subroutine store_closed(self, operator, field, jump, linear)
    class(full_process), intent(inout) :: self
    type(jump_operator), intent(in) :: operator
    type(joint_field), intent(in) :: field !< before the first step
    real(rk), intent(in) :: jump(:, :) !< (3, points) [m]
    real(rk), intent(in) :: linear(:, :) !< (3, points) tractions with these jumps [Pa]
    associate (share => share_of(self%weight, operator))
      self%closed_jump = jump - jumps_of(self, operator%area, self%k_ref*jump - linear)
      self%force = share*field%multiplier
      if (self%balance%starts_closed) self%force = share*linear
    end associate
  end subroutine store_closed

  !> Nothing: the first iteration has stored them.
  subroutine find_closed(self, operator)
    class(full_process), intent(inout) :: self
    type(jump_operator), intent(in) :: operator
    if (.not. allocated(self%closed_jump)) allocate (self%closed_jump(3, operator%num_points))
  end subroutine find_closed

  !> Nothing: each iteration solves for all unknowns.
  subroutine find_response(self, now)
    class(full_process), intent(in) :: self
    type(joint_increment), intent(inout) :: now
    if (size(self%x) > 0) now%field%response = now%field%jump
  end subroutine find_response

  !> Factors K_eff + weight*B^T area*tangent B.
  subroutine factorise_tangent(self, operator, tangent, error)
    class(full_equilibrium), intent(inout) :: self
    type(jump_operator), intent(in) :: operator
    real(rk), intent(in) :: tangent(:, :, :) !< (3, 3, points) [Pa/m]
    type(error_type), allocatable, intent(out) :: error
    real(rk), allocatable :: values(:)
    integer :: p
    self%is_unsymmetric = .not. self%matrix%is_symmetric
    do p = 1, operator%num_points
      self%is_unsymmetric = self%is_unsymmetric .or. &
                            any(abs(tangent(:, :, p) - transpose(tangent(:, :, p))) > 0.0_rk)
    end do
    self%num_factorisations = self%num_factorisations + 1
    call self%costs%start('factor', 'structure', 'solver')
    if (.not. self%is_unsymmetric) then
      allocate (values, source=self%values)
      call operator%add_stiffness(self%weight*tangent, self%matrix, values)
      call add_low_rank(self%low_rank, self%factor)
      call self%factor%factorise(self%matrix, values, error)
      call self%costs%stop()
      return
    end if
    if (.not. allocated(self%unsymmetric_factor)) call start_unsymmetric(self, error)
    if (allocated(error)) then
      call self%costs%stop()
      return
    end if
    allocate (values(size(self%full_matrix%row)))
    if (self%matrix%is_symmetric) then
      call spread_values(self%matrix, self%values, self%full_matrix, values)
    else
      values = self%values
    end if
    call operator%add_stiffness(self%weight*tangent, self%full_matrix, values)
    call add_low_rank(self%low_rank, self%unsymmetric_factor)
    call self%unsymmetric_factor%factorise(self%full_matrix, values, error)
    call self%costs%stop()
  end subroutine factorise_tangent

  !> Makes the pattern of both triangles and its solver.
  subroutine start_unsymmetric(self, error)
    class(full_equilibrium), intent(inout) :: self
    type(error_type), allocatable, intent(out) :: error
    call self%costs%start('analyse', 'structure', 'solver')
    if (self%matrix%is_symmetric) then
      call full_pattern(self%matrix, self%full_matrix)
    else
      self%full_matrix = self%matrix
    end if
    call make_solver(unsymmetric_solver, self%unsymmetric_factor, error, self%matrix%is_shared)
    if (.not. allocated(error)) call self%unsymmetric_factor%analyse(self%full_matrix, error)
    call self%costs%stop()
  end subroutine start_unsymmetric

  !> x and B x for the right-hand side rhs + weight*B^T area*traction, by the last factor.
  subroutine back_substitute(self, rhs, traction, operator, x, answer, error)
    class(full_equilibrium), intent(inout) :: self
    real(rk), intent(in) :: rhs(:) !< (free unknowns)
    real(rk), intent(in) :: traction(:, :) !< (3, points) [Pa]
    type(jump_operator), intent(in) :: operator
    real(rk), intent(out) :: x(:) !< (all unknowns)
    real(rk), intent(out) :: answer(:, :) !< (3, points) B x [m]
    type(error_type), allocatable, intent(out) :: error
    real(rk), allocatable :: b(:, :)
    x = 0.0_rk
    call operator%add_forces(self%weight*traction, x)
    b = reshape(rhs + x(:size(rhs)), [size(rhs), 1])
    call self%costs%start('solve', 'structure', 'solver')
    if (self%is_unsymmetric) then
      call self%unsymmetric_factor%solve(b, error)
    else
      call self%factor%solve(b, error)
    end if
    call self%costs%stop()
    x = 0.0_rk
    x(:size(rhs)) = b(:, 1)
    call operator%jumps(x, answer)
  end subroutine back_substitute
end module newton_full
