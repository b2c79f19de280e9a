!> Equilibrium condensed on the joints (theory.md, 8): K_0 = K_eff with all joints closed is
!> factored once for an increment size; Newton's method iterates on the jumps alone.
module condensation
  use kinds, only: rk
  use errors, only: error_type
  use anderson_mixing, only: mixer
  use matrix_pattern, only: pattern
  use global_vectors, only: norm
  use joint_law, only: joint_state
  use joint_points, only: dam_joint
  use joint_rows, only: num_rows
  use joint_operator, only: jump_operator, joint_springs
  use joint_forces, only: joint_field, reference_stiffness, gather_jumps, gather_tractions
  use joint_iteration, only: joint_increment, start_iteration, excess_traction, closed_tangent
  use contact_scaling, only: find_contact_scale
  use joint_compliance, only: find_all_blocks, solved_response
  use near_compliance, only: find_near_rows
  use point_groups, only: group_list, group_points
  use selected_compliance, only: select_compliance
  use matrix_condition, only: estimate_condition
  use solver_low_rank, only: add_low_rank
  use blas_threads, only: use_many_threads, use_one_thread
  use jump_block, only: jump_schur_block, schur_response, extract_schur_block
  use joint_problem, only: saved_operator, saved_problem, save_problem, free_path
  use newton_condensed, only: condensed_joints, closed_response, iterate_on_jumps, linearise_again
  use tangent_equations, only: joint_tangent
  use equilibrium, only: equilibrium_solver, force_balance, balance_outcome
  use equilibrium, only: unmet_criterion, of_jumps, of_solves
  implicit none
  private
  public :: condensed_equilibrium

  type, extends(equilibrium_solver) :: condensed_equilibrium
    type(condensed_joints) :: condensed
    type(jump_schur_block) :: jumps !< saves one of the two solves of an increment
    !> G as an operator, by the Schur block or by solves
    type(schur_response), private :: response
    type(solved_response), private :: solved
    integer, private :: num_held = 0 !< prescribed unknowns
    logical, private :: takes_all_blocks = .false. !< of the next matrix
    logical, private :: uses_response = .false. !< in the place of the blocks of G
    !> The blocks learn what they leave out, in place of Anderson's acceleration
    logical, private :: learns = .false.
    integer, private :: num_passes = 0 !< beyond the first of a solve, in time, with these blocks
    !> (3, points) excess traction of the last solution [Pa]
    real(rk), allocatable, private :: excess(:, :)
    !> (free unknowns) with a factor in single precision: a vector near the solution, and K_0 times
    !> it. The equations are solved for the rest. Zero with a factor in double precision.
    real(rk), allocatable, private :: base(:), base_force(:)
    !> Norm of the residual that solves may leave, for a factor in single precision [N]
    real(rk), private :: admissible = 0.0_rk
  contains
    procedure :: prepare_matrix, solve_balance, take_all_blocks
    procedure, private :: condense, solve_from, jump_drift, refine, find_base
    procedure, private :: solution_drift, admissible_drift
  end type condensed_equilibrium

  !> Admissible drift of the jumps, as a fraction of the residual tolerance. The residual itself is
  !> mostly far below the tolerance where passes have made up for blocks that are left out.
  real(rk), parameter :: allowed_drift = 0.5_rk
  !> Coupling of the blocks of G that are kept, and error of these blocks.
  real(rk), parameter :: smallest_coupling = 5.0e-10_rk
  !> Most corrections of a solution with a factor in single precision.
  integer, parameter :: most_refinements = 10
  !> A pass by the Schur block takes as long as so many columns of the blocks that were left out,
  !> which are computed when passes have taken as long. By iterations a pass takes as long as one.
  integer, parameter :: columns_of_a_pass = 16
  !> Most points for which all blocks of G are kept where an increment needs them.
  integer, parameter :: most_completed = 3000

  interface
    !> One solve: forward substitution, the iteration on the jumps, backward substitution.
    !> Iterations count from those of `outcome` on.
    module subroutine solve_from(self, balance, joints, old, new, x, outcome, error)
      implicit none
      class(condensed_equilibrium), intent(inout), target :: self
      type(force_balance), intent(in) :: balance
      type(dam_joint), intent(in), target :: joints(:)
      type(joint_state), intent(in), target :: old(:)
      type(joint_state), intent(inout), target :: new(:)
      real(rk), intent(out) :: x(:)
      type(balance_outcome), intent(inout) :: outcome
      type(error_type), allocatable, intent(out) :: error
    end subroutine solve_from
  end interface

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
    self%operator = operator
    self%num_held = matrix%num_total - matrix%num_free
    self%weight = weight
    self%condensed%weight = weight
    call reference_stiffness(joints, operator, self%condensed%k_ref)
    allocate (closed, source=values)
    call operator%add_stiffness(weight*closed_tangent(self%condensed%k_ref), matrix, closed)
    call self%costs%start('factor', 'structure', 'solver')
    call add_low_rank(self%low_rank, self%factor)
    call self%exact%forget()
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
    call extract_schur_block(self%factor, operator, matrix, self%jumps)
    call self%condense(matrix, closed, error)
    call self%costs%stop()
    if (allocated(error)) return
    call self%keep_single(matrix, closed, pack(operator%unknown, &
                                               operator%unknown <= matrix%num_free))
  end subroutine prepare_matrix

  !> Computes G, C and r.
  subroutine condense(self, matrix, closed, error)
    class(condensed_equilibrium), intent(inout) :: self
    type(pattern), intent(in) :: matrix
    real(rk), intent(in) :: closed(:) !< values of K_0
    type(error_type), allocatable, intent(out) :: error
    type(group_list) :: groups
    real(rk), allocatable :: spring(:)
    integer :: missing, levels
    associate (operator => self%operator, condensed => self%condensed)
      call group_points(operator%first_point, operator%x, groups)
      spring = joint_springs(operator, condensed%k_ref, self%weight)
      missing = 1
      if (self%factor%has_patches()) then
        missing = 0
        call find_near_rows(self%factor, matrix, closed, operator, spring, groups, &
                            condensed%blocks, error)
        if (allocated(error)) return
      else if (self%jumps%top%is_there) then
        call use_many_threads(levels)
        call select_compliance(self%jumps%top, operator, spring, groups, smallest_coupling, &
                               condensed%blocks, missing, error)
        call use_one_thread(levels)
        if (allocated(error)) return
      end if
      if (missing > 0) then
        call find_all_blocks(self%factor, self%jumps, operator, spring, groups, &
                             merge(smallest_coupling, 0.0_rk, self%jumps%is_there), &
                             condensed%blocks, error)
      end if
      if (allocated(error)) return
    end associate
    call start_from_blocks(self)
    self%num_passes = 0
    self%has_all_blocks = .false.
    if (self%takes_all_blocks) call self%take_all_blocks(error)
    self%takes_all_blocks = .false.
  end subroutine condense

  !> Computes C and r from G; factors with the own blocks of another G are forgotten.
  subroutine start_from_blocks(self)
    class(condensed_equilibrium), intent(inout) :: self
    type(joint_tangent) :: no_tangent
    associate (condensed => self%condensed)
      call find_contact_scale(condensed%blocks, self%operator, condensed%k_ref, self%weight, &
                              condensed%scale, condensed%opened)
      condensed%tangent = no_tangent
    end associate
  end subroutine start_from_blocks

  !> Computes the blocks of G that were left out. Own blocks change: in their last digits, or all of
  !> them where they were those of a part of the structure. Factors with the old ones are forgotten.
  subroutine complete(self, smallest, error)
    class(condensed_equilibrium), intent(inout) :: self
    real(rk), intent(in) :: smallest !< coupling of a block that is kept
    type(error_type), allocatable, intent(out) :: error
    type(group_list) :: groups
    type(joint_tangent) :: no_tangent
    groups = self%condensed%blocks%groups
    call find_all_blocks(self%factor, self%jumps, self%operator, &
                         joint_springs(self%operator, self%condensed%k_ref, self%weight), groups, &
                         smallest, self%condensed%blocks, error)
    if (allocated(error)) return
    self%condensed%tangent = no_tangent
    if (self%factor%has_patches()) call start_from_blocks(self)
  end subroutine complete

  !> Computes all blocks, at once or with the first matrix. The state remembers it: a continued run
  !> takes the same ones.
  subroutine take_all_blocks(self, error)
    class(condensed_equilibrium), intent(inout) :: self
    type(error_type), allocatable, intent(out) :: error
    self%takes_all_blocks = .not. allocated(self%condensed%k_ref)
    if (self%takes_all_blocks) return
    call complete(self, 0.0_rk, error)
    self%has_all_blocks = .not. allocated(error)
  end subroutine take_all_blocks

  !> Computes the blocks that were left out where many passes have made up for them.
  subroutine replace_passes(self, error)
    class(condensed_equilibrium), intent(inout) :: self
    type(error_type), allocatable, intent(out) :: error
    if (self%num_passes <= num_rows(self%operator%num_points) &
        /merge(1, columns_of_a_pass, self%factor%has_patches()) &
        .or. self%condensed%blocks%left_out <= smallest_coupling &
        .or. self%operator%num_points > most_completed .or. self%exact%is_rounded()) return
    self%num_passes = -huge(1)
    call self%costs%start('condense', 'joints', 'joint')
    call complete(self, smallest_coupling, error)
    call self%costs%stop()
  end subroutine replace_passes

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
    self%admissible = self%admissible_residual(balance)
    if (allocated(self%base)) deallocate (self%base, self%base_force)
    call replace_passes(self, error)
    if (allocated(error)) return
    call self%solve_from(balance, joints, old, new, x, outcome, error)
    if (allocated(error)) return
    if (.not. (outcome%has_converged .or. outcome%gives_up .or. balance%is_estimate)) then
      call solve_again(self, balance, joints, old, new, x, outcome, error)
    end if
    if (.not. allocated(error) .and. outcome%has_converged) then
      if (self%exact%is_rounded()) then
        call self%refine(balance, joints, old, new, x, outcome, error)
      else if (self%solution_drift(balance, new, x) > self%admissible_drift()) then
        nearer = balance
        nearer%is_repeated = .true.
        call nearer%start_from(self%operator, new)
        call self%solve_from(nearer, joints, old, new, x, outcome, error)
      end if
    end if
    call end_products(self, error)
  end subroutine solve_balance

  !> Solves with all blocks of G, or with products with G in their place, where blocks are left out:
  !> joints of a static step, and joints that carry a whole block, see each other further than
  !> neighbours. In motion few increments need it, and products take less time than all blocks.
  subroutine solve_again(self, balance, joints, old, new, x, outcome, error)
    class(condensed_equilibrium), intent(inout) :: self
    type(force_balance), intent(in) :: balance
    type(dam_joint), intent(in) :: joints(:)
    type(joint_state), intent(in) :: old(:)
    type(joint_state), intent(inout) :: new(:)
    real(rk), intent(inout) :: x(:)
    type(balance_outcome), intent(inout) :: outcome
    type(error_type), allocatable, intent(out) :: error
    logical :: are_left_out, are_many
    are_left_out = self%condensed%blocks%left_out > smallest_coupling
    are_many = self%operator%num_points > most_completed
    if (self%jumps%top%is_there) then
      self%uses_response = are_many .or. .not. are_left_out
    else
      self%uses_response = are_left_out .and. (are_many .or. .not. balance%is_static) .and. &
                           self%factor%has_patches() .and. .not. self%exact%is_rounded()
    end if
    if (.not. self%uses_response) then
      if (are_many .or. .not. are_left_out) return
      call self%take_all_blocks(error)
      if (allocated(error)) return
    end if
    call self%solve_from(balance, joints, old, new, x, outcome, error)
  end subroutine solve_again

  !> Ends products with G in the place of the blocks; `error` is the failure of one.
  subroutine end_products(self, error)
    class(condensed_equilibrium), intent(inout) :: self
    type(error_type), allocatable, intent(inout) :: error
    if (.not. self%uses_response) return
    self%uses_response = .false.
    self%condensed%blocks%exact => null()
    if (.not. allocated(error)) call move_alloc(self%response%failure, error)
    if (.not. allocated(error)) call move_alloc(self%solved%failure, error)
  end subroutine end_products

  !> Solves again from a solution of a factor in single precision, until its residual is admissible
  !> and its jumps are those of the laws.
  subroutine refine(self, balance, joints, old, new, x, outcome, error)
    class(condensed_equilibrium), intent(inout) :: self
    type(force_balance), intent(in) :: balance
    type(dam_joint), intent(in) :: joints(:)
    type(joint_state), intent(in) :: old(:)
    type(joint_state), intent(inout) :: new(:)
    real(rk), intent(inout) :: x(:)
    type(balance_outcome), intent(inout) :: outcome
    type(error_type), allocatable, intent(out) :: error
    type(force_balance) :: nearer
    real(rk) :: residual, admissible, drift, force
    integer :: pass
    logical :: is_near
    nearer = balance
    do pass = 1, most_refinements
      call self%find_base(balance, x, residual)
      drift = self%solution_drift(balance, new, x)
      is_near = drift <= self%admissible_drift()
      admissible = max(self%admissible, self%exact%smallest_residual(self%base))
      if (is_near .and. residual <= admissible) exit
      call nearer%start_from(self%operator, new)
      call self%solve_from(nearer, joints, old, new, x, outcome, error)
      if (allocated(error) .or. .not. outcome%has_converged) return
    end do
    outcome%has_converged = pass <= most_refinements
    if (.not. outcome%has_converged) then
      force = max(balance%reference_force, norm(self%part, balance%rhs), tiny(1.0_rk))
      outcome%unmet = unmet_criterion(of_solves, residual/force, admissible/force)
      if (.not. is_near) outcome%unmet = unmet_criterion(of_jumps, drift, self%admissible_drift())
    end if
    call self%exact%remember(self%base, self%base_force)
  end subroutine refine

  !> Takes the last solution as the base of the next one.
  subroutine find_base(self, balance, x, residual)
    class(condensed_equilibrium), intent(inout) :: self
    type(force_balance), intent(in) :: balance
    real(rk), intent(in) :: x(:) !< (all unknowns)
    real(rk), intent(out) :: residual !< norm of that of the linear equations [N]
    real(rk) :: force(size(x))
    associate (n => size(balance%rhs))
      force = 0.0_rk
      call self%operator%add_forces(self%weight*self%excess, force)
      self%base = x(:n)
      if (.not. allocated(self%base_force)) allocate (self%base_force(n))
      call self%exact%find_product(self%base, self%base_force)
      residual = norm(self%part, balance%rhs + force(:n) - self%base_force)
    end associate
  end subroutine find_base

  !> How far the jumps of the solution are from those at which the laws were evaluated. A block
  !> without contact in one iterate moves far, and the way back loses digits.
  real(rk) function solution_drift(self, balance, new, x)
    class(condensed_equilibrium), intent(in) :: self
    type(force_balance), intent(in) :: balance
    type(joint_state), intent(in) :: new(:)
    real(rk), intent(in) :: x(:)
    real(rk), dimension(3, self%operator%num_points) :: jump, drift
    call self%operator%jumps(x, drift)
    call gather_jumps(self%operator, new, jump)
    solution_drift = self%jump_drift(balance, new, drift + balance%offset - jump)
  end function solution_drift

  !> Drift that a solution may have.
  pure real(rk) function admissible_drift(self)
    class(condensed_equilibrium), intent(in) :: self
    admissible_drift = allowed_drift*self%controls%residual_tolerance
  end function admissible_drift

  !> Force of a drift of the jumps on closed joints, over the joint forces.
  real(rk) function jump_drift(self, balance, new, drift)
    class(condensed_equilibrium), intent(in) :: self
    type(force_balance), intent(in) :: balance
    type(joint_state), intent(in) :: new(:)
    real(rk), intent(in) :: drift(:, :) !< (3, points) [m]
    real(rk) :: traction(3, self%operator%num_points)
    call gather_tractions(self%operator, new, traction)
    associate (area => spread(self%operator%area, 1, 3))
      jump_drift = norm(area*self%condensed%k_ref*drift) &
                   /max(norm(area*traction), balance%reference_force, tiny(1.0_rk))
    end associate
  end function jump_drift
end module condensation
