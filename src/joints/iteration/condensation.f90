!> Equilibrium condensed on the joints (theory.md, 8): K_0 = K_eff with all joints closed is
!> factored once for an increment size; Newton's method iterates on the jumps alone.
module condensation
  use kinds, only: rk
  use errors, only: error_type
  use matrix_pattern, only: pattern
  use global_vectors, only: norm
  use joint_law, only: joint_state
  use joint_points, only: dam_joint
  use joint_operator, only: jump_operator, joint_springs
  use joint_forces, only: joint_field, reference_stiffness, gather_jumps, gather_tractions
  use joint_iteration, only: start_iteration, excess_traction, closed_tangent
  use block_compliance, only: few_points, take_blocks
  use contact_scaling, only: find_contact_scale
  use joint_compliance, only: find_compliance
  use point_groups, only: group_list, group_points
  use selected_compliance, only: select_compliance
  use matrix_condition, only: estimate_condition
  use solver_low_rank, only: add_low_rank
  use blas_threads, only: use_many_threads, use_one_thread
  use jump_block, only: jump_schur_block, extract_schur_block, schur_compliance
  use joint_problem, only: saved_operator, saved_problem, save_problem, free_path
  use newton_condensed, only: condensed_joints, closed_response, iterate_on_jumps, linearise_again
  use tangent_equations, only: joint_tangent
  use equilibrium, only: equilibrium_solver, force_balance, balance_outcome
  implicit none
  private
  public :: condensed_equilibrium

  type, extends(equilibrium_solver) :: condensed_equilibrium
    type(condensed_joints) :: condensed
    type(jump_schur_block) :: jumps !< saves one of the two solves of an increment
    integer, private :: num_held = 0 !< prescribed unknowns
  contains
    procedure :: prepare_matrix, solve_balance
    procedure, private :: condense, solve_from, has_drifted, begin_solve, end_solve, jump_drift
    procedure, private :: find_drift
  end type condensed_equilibrium

  !> Admissible drift of the jumps, as a fraction of the residual tolerance.
  real(rk), parameter :: allowed_drift = 0.1_rk
  !> Coupling of the blocks of G that are kept.
  real(rk), parameter :: smallest_coupling = 1.0e-4_rk
  !> Most corrections for the blocks of G that are left out.
  integer, parameter :: most_passes = 12
  !> Most points for which all blocks of G are kept where an increment needs them.
  integer, parameter :: most_completed = 3000

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
    call self%condense(matrix%num_free, error)
    call self%costs%stop()
  end subroutine prepare_matrix

  !> Computes G, C and r.
  subroutine condense(self, num_free, error)
    class(condensed_equilibrium), intent(inout) :: self
    integer, intent(in) :: num_free
    type(error_type), allocatable, intent(out) :: error
    type(group_list) :: groups
    type(joint_tangent) :: no_tangent
    real(rk), allocatable :: spring(:)
    integer :: missing, levels
    associate (operator => self%operator, condensed => self%condensed)
      call group_points(operator%first_point, operator%x, groups)
      spring = joint_springs(operator, condensed%k_ref, self%weight)
      missing = 1
      if (self%jumps%top%is_there) then
        call use_many_threads(levels)
        call select_compliance(self%jumps%top, operator, spring, groups, smallest_coupling, &
                               condensed%blocks, missing, error)
        call use_one_thread(levels)
        if (allocated(error)) return
      end if
      if (missing > 0) then
        call condense_densely(self, num_free, spring, groups, &
                              merge(smallest_coupling, 0.0_rk, self%jumps%is_there), error)
      end if
      if (allocated(error)) return
      call find_contact_scale(condensed%blocks, operator, condensed%k_ref, self%weight, &
                              condensed%scale, condensed%opened)
      condensed%tangent = no_tangent
    end associate
  end subroutine condense

  !> Computes all of G, and keeps the blocks that matter.
  subroutine condense_densely(self, num_free, spring, groups, smallest, error)
    class(condensed_equilibrium), intent(inout) :: self
    integer, intent(in) :: num_free
    real(rk), intent(in) :: spring(:) !< (rows) [m/N]
    type(group_list), intent(in) :: groups
    real(rk), intent(in) :: smallest !< coupling of a block that is kept
    type(error_type), allocatable, intent(out) :: error
    real(rk), allocatable :: dense(:, :)
    integer :: levels
    if (self%jumps%is_there .and. .not. self%jumps%top%is_there) then
      if (self%operator%num_points > few_points) call use_many_threads(levels)
      call schur_compliance(self%jumps, self%operator, dense)
      if (self%operator%num_points > few_points) call use_one_thread(levels)
    else
      call find_compliance(self%factor, self%operator, num_free, dense, error)
      if (allocated(error)) return
    end if
    call take_blocks(dense, spring, groups, smallest, self%condensed%blocks)
  end subroutine condense_densely

  !> Computes the blocks of G that were left out: joints of a static step, and joints that carry a
  !> whole block, see each other further than neighbours.
  subroutine complete_blocks(self, num_free, was_complete, error)
    class(condensed_equilibrium), intent(inout) :: self
    integer, intent(in) :: num_free
    logical, intent(out) :: was_complete !< or is too large
    type(error_type), allocatable, intent(out) :: error
    type(group_list) :: groups
    was_complete = self%condensed%blocks%is_complete &
                   .or. self%operator%num_points > most_completed
    if (was_complete) return
    groups = self%condensed%blocks%groups
    call condense_densely(self, num_free, joint_springs(self%operator, self%condensed%k_ref, &
                                                        self%weight), groups, 0.0_rk, error)
  end subroutine complete_blocks

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
    logical :: was_complete
    call self%solve_from(balance, joints, old, new, x, outcome, error)
    if (allocated(error)) return
    if (.not. (outcome%has_converged .or. outcome%gives_up)) then
      call complete_blocks(self, size(balance%rhs), was_complete, error)
      if (allocated(error) .or. was_complete) return
      iterations = outcome%iterations
      call self%solve_from(balance, joints, old, new, x, outcome, error)
      outcome%iterations = outcome%iterations + iterations
    end if
    if (allocated(error) .or. .not. outcome%has_converged) return
    if (.not. self%has_drifted(balance, new, x)) return
    nearer = balance
    nearer%is_repeated = .true.
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
    real(rk), dimension(3, self%operator%num_points) :: jump, drift
    call self%operator%jumps(x, drift)
    call gather_jumps(self%operator, new, jump)
    has_drifted = self%jump_drift(balance, new, drift + balance%offset - jump) &
                  > allowed_drift*self%controls%residual_tolerance
  end function has_drifted

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

  !> Newton's method on the jumps between forward and backward substitution, again while the
  !> blocks of G that are left out move the jumps. Without the Schur block it takes two full solves:
  !> one for the guess, one for the change.
  subroutine solve_from(self, balance, joints, old, new, x, outcome, error)
    class(condensed_equilibrium), intent(inout) :: self
    type(force_balance), intent(in) :: balance
    type(dam_joint), intent(in) :: joints(:)
    type(joint_state), intent(in) :: old(:)
    type(joint_state), intent(inout) :: new(:)
    real(rk), intent(out) :: x(:)
    type(balance_outcome), intent(out) :: outcome
    type(error_type), allocatable, intent(out) :: error
    type(joint_field) :: field, start
    real(rk), dimension(3, self%operator%num_points) :: excess, last_excess
    real(rk), allocatable :: half(:)
    integer :: pass, iterations
    iterations = 0
    associate (k_ref => self%condensed%k_ref, operator => self%operator)
      call start_iteration(balance, joints, operator, k_ref, self%condensed%scale, old, field, new)
      last_excess = excess_traction(k_ref, field%jump, balance%offset, field%iterate)
      call self%begin_solve(balance, last_excess, half, x, error)
      if (allocated(error)) return
      call operator%jumps(x, field%response)
      field%response = field%response + balance%offset
      do pass = 1, most_passes
        call self%costs%start('iterate', 'joints', 'joint')
        if (self%controls%most_unsaved < huge(1)) start = field
        call iterate_on_jumps(self%condensed, self%controls, joints, operator, old, field, new, &
                              outcome)
        call self%costs%stop()
        if (outcome%iterations > self%controls%most_unsaved) then
          call save_increment(self, balance, joints, old, start, error)
          if (allocated(error)) return
        end if
        iterations = iterations + outcome%iterations
        outcome%iterations = iterations
        if (.not. outcome%has_converged) return
        excess = excess_traction(k_ref, field%jump, balance%offset, field%iterate)
        if (self%condensed%blocks%is_complete) exit
        call self%find_drift(balance, new, excess - last_excess, half, field)
        last_excess = excess
        if (field%drift <= allowed_drift*self%controls%residual_tolerance) exit
        call linearise_again(self%condensed, joints, operator, old, field, new)
      end do
    end associate
    outcome%has_converged = pass <= most_passes
    call self%end_solve(balance%is_partial, excess - last_excess, half, x, error)
  end subroutine solve_from

  !> Saves an increment as a problem of its own (--save-joint-problems).
  subroutine save_increment(self, balance, joints, old, start, error)
    class(condensed_equilibrium), intent(in) :: self
    type(force_balance), intent(in) :: balance
    type(dam_joint), intent(in) :: joints(:)
    type(joint_state), intent(in) :: old(:)
    type(joint_field), intent(in) :: start !< of the iteration
    type(error_type), allocatable, intent(out) :: error
    type(saved_operator) :: common
    type(saved_problem) :: problem
    character(:), allocatable :: path
    path = free_path(self%controls%stem_of_problems)
    if (len(path) == 0) return
    common%weight = self%weight
    common%compliance = self%condensed%blocks%as_dense()
    common%operator = self%operator
    problem = saved_problem(self%controls, joints, old, balance, &
                            closed_response(self%condensed, self%operator%area, start))
    problem%balance%guess = start%jump
    problem%balance%guess_traction = start%multiplier
    call save_problem(path, common, problem, error)
  end subroutine save_increment

  !> Jumps from the Schur block after a pass, and how far they are from those of the blocks of G.
  subroutine find_drift(self, balance, new, change, half, field)
    class(condensed_equilibrium), intent(inout) :: self
    type(force_balance), intent(in) :: balance
    type(joint_state), intent(in) :: new(:)
    real(rk), intent(in) :: change(:, :) !< (3, points) of the excess traction [Pa]
    real(rk), intent(inout) :: half(:) !< (free unknowns) after forward substitution
    type(joint_field), intent(inout) :: field
    real(rk) :: x(size(balance%rhs) + self%num_held)
    call self%costs%start('correct', 'joints', 'joint')
    x = 0.0_rk
    call self%operator%add_forces(self%weight*change, x)
    call self%jumps%add_jump_forces(x, half)
    x = 0.0_rk
    call self%jumps%store_jumps(half, x)
    call self%operator%jumps(x, field%response)
    field%response = field%response + balance%offset
    field%drift = self%jump_drift(balance, new, field%response - field%jump)
    call self%costs%stop()
  end subroutine find_drift

  !> Response to the guess: forward substitution and jumps, or all unknowns.
  subroutine begin_solve(self, balance, excess, half, x, error)
    class(condensed_equilibrium), intent(inout) :: self
    type(force_balance), intent(in) :: balance
    real(rk), intent(in) :: excess(:, :) !< (3, points) [Pa]
    real(rk), allocatable, intent(out) :: half(:) !< (free unknowns) after forward substitution
    real(rk), intent(out) :: x(:) !< (all unknowns)
    type(error_type), allocatable, intent(out) :: error
    if (.not. self%jumps%is_there) then
      call respond(self, balance%rhs, excess, self%operator, x, error)
      return
    end if
    x = 0.0_rk
    call self%operator%add_forces(self%weight*excess, x)
    half = balance%rhs + x(:size(balance%rhs))
    call self%costs%start('solve forward', 'structure', 'solver')
    if (self%repeated%is_there(self%factor)) then
      if (.not. balance%is_repeated) call self%repeated%start(self%factor, half, error)
      call self%repeated%forward(self%factor, half, error)
    else
      call self%factor%forward_substitute(half, error)
    end if
    x = 0.0_rk
    call self%jumps%store_jumps(half, x)
    call self%costs%stop()
  end subroutine begin_solve

  !> All unknowns, with the change of the joint forces since the guess.
  subroutine end_solve(self, is_partial, change, half, x, error)
    class(condensed_equilibrium), intent(inout) :: self
    logical, intent(in) :: is_partial !< active unknowns alone
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
      x = 0.0_rk
      if (self%repeated%is_there(self%factor)) then
        call self%repeated%backward(self%factor, half, is_partial, x(:size(half)), error)
      else
        call self%factor%backward_substitute(half, error)
        x(:size(half)) = half
      end if
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
