!> The matrices of a reduced model for one increment size (theory.md, 7.4).
!>
!> With open joints the jumps at the end of an increment are those without joint forces less
!> C w (area t1): C = B (Phi Z Phi^T + R/r) B^T, with Z the inverse of K_eff of the modes, r that
!> of the rest over its stiffness. The
!> iteration on the joints needs G, the same with the closed joints: G = (I + C w area k_ref)^-1 C.
module reduced_scheme
  use block_compliance, only: few_points, take_blocks
  use blas_threads, only: use_many_threads, use_one_thread
  use contact_scaling, only: find_contact_scale
  use dense_factor, only: factorise_dense, lu_factor, solve_factored
  use dense_products, only: times, times_vector
  use equilibrium, only: balance_outcome, force_balance
  use hht_scheme, only: hht
  use joint_forces, only: reference_stiffness
  use joint_iteration, only: joint_increment, start_iteration
  use joint_law, only: joint_state
  use joint_operator, only: joint_springs, jump_operator
  use joint_points, only: dam_joint
  use joint_policy, only: jumps_of
  use joint_rows, only: num_rows
  use kinds, only: rk
  use newton_condensed, only: condensed_joints, iterate_on_jumps
  use point_groups, only: group_list, group_points
  use reduced_basis, only: reduced_model
  use step_plan, only: step_controls
  use tangent_equations, only: joint_tangent
  implicit none
  private
  public :: reduced_matrices, force_of

  !> Coupling of the blocks of G that are kept, and error of these blocks.
  real(rk), parameter :: allowed_error = 5.0e-10_rk

  type :: reduced_matrices
    type(hht) :: scheme
    type(jump_operator) :: operator
    real(rk), allocatable :: inverse(:, :) !< (modes, modes) Z [1/(1/s2)]
    real(rk), allocatable :: rest(:) !< (columns of P R P^T) K_eff of the rest over its stiffness
    real(rk), allocatable :: compliance(:, :) !< (rows, rows) C [m/N]
    !> (rows) jumps that the tractions at the start of the step prevent, C w area t [m]
    real(rk), allocatable :: held_jump(:)
    type(condensed_joints) :: joints !< with G
  contains
    procedure :: prepare, solve_joints
  end type reduced_matrices

contains

  !> Forms Z, C and G.
  subroutine prepare(self, basis, scheme, joints, operator)
    class(reduced_matrices), intent(inout) :: self
    type(reduced_model), intent(in) :: basis
    type(hht), intent(in) :: scheme
    type(dam_joint), intent(in) :: joints(:)
    type(jump_operator), intent(in) :: operator
    real(rk), allocatable :: jump(:, :)
    integer :: levels
    self%scheme = scheme
    self%operator = operator
    if (operator%num_points > few_points) call use_many_threads(levels)
    call invert_modes(basis, scheme, self%inverse)
    self%rest = basis%rest_mass*scheme%acceleration_of_x &
                + (1.0_rk + scheme%alpha)*(basis%rest_stiffness &
                                           + scheme%velocity_of_x*basis%rest_damping)
    jump = basis%path(:num_rows(operator%num_points), :)
    self%compliance = times(jump, times(self%inverse, transpose(jump)))
    call add_rest(basis, self%rest, self%compliance)
    self%held_jump = times_vector(self%compliance, &
                                  scheme%joint_weight*force_of(operator, basis%start_traction))
    if (operator%num_points > 0) call close_joints(self, joints, operator)
    if (operator%num_points > few_points) call use_one_thread(levels)
  end subroutine prepare

  !> Z, from K_eff of the modes.
  subroutine invert_modes(basis, scheme, inverse)
    type(reduced_model), intent(in) :: basis
    type(hht), intent(in) :: scheme
    real(rk), allocatable, intent(out) :: inverse(:, :)
    type(lu_factor) :: factor
    real(rk), allocatable :: matrix(:, :)
    integer :: k
    matrix = (1.0_rk + scheme%alpha)*scheme%velocity_of_x*basis%damping
    inverse = 0.0_rk*matrix
    do k = 1, basis%num_modes
      matrix(k, k) = matrix(k, k) + scheme%acceleration_of_x &
                     + (1.0_rk + scheme%alpha)*basis%lambda(k)
      inverse(k, k) = 1.0_rk
    end do
    call factorise_dense(matrix, factor)
    call solve_factored(factor, inverse)
  end subroutine invert_modes

  !> Adds what the rest gives to C.
  subroutine add_rest(basis, rest, compliance)
    type(reduced_model), intent(in) :: basis
    real(rk), intent(in) :: rest(:) !< (columns of P R P^T) K_eff over the stiffness
    real(rk), intent(inout) :: compliance(:, :) !< (rows, rows) [m/N]
    integer :: first, column
    do first = 0, size(rest) - 1, size(basis%residual, 1)
      do column = 1, size(compliance, 2)
        compliance(:, column) = compliance(:, column) &
                                + basis%residual(:size(compliance, 1), first + column) &
                                /rest(first + column)
      end do
    end do
  end subroutine add_rest

  !> G and what the iteration on joints needs beside it.
  subroutine close_joints(self, joints, operator)
    class(reduced_matrices), intent(inout) :: self
    type(dam_joint), intent(in) :: joints(:)
    type(jump_operator), intent(in) :: operator
    type(lu_factor) :: factor
    type(group_list) :: groups
    type(joint_tangent) :: no_tangent
    real(rk), allocatable :: matrix(:, :), closed(:, :)
    real(rk) :: spring(num_rows(operator%num_points))
    integer :: row
    associate (own => self%joints, weight => self%scheme%joint_weight)
      own%weight = weight
      call reference_stiffness(joints, operator, own%k_ref)
      spring = joint_springs(operator, own%k_ref, weight)
      allocate (matrix, mold=self%compliance)
      do row = 1, size(spring)
        matrix(:, row) = self%compliance(:, row)/spring(row)
        matrix(row, row) = 1.0_rk + matrix(row, row)
      end do
      closed = self%compliance
      call factorise_dense(matrix, factor)
      call solve_factored(factor, closed)
      closed = 0.5_rk*(closed + transpose(closed))
      call group_points(operator%first_point, operator%x, groups)
      call take_blocks(closed, spring, groups, allowed_error, own%blocks)
      call find_contact_scale(own%blocks, operator, own%k_ref, weight, own%scale, own%opened)
      own%tangent = no_tangent
    end associate
  end subroutine close_joints

  !> Forces of the joints in rows.
  pure function force_of(operator, traction) result(force)
    type(jump_operator), intent(in) :: operator
    real(rk), intent(in) :: traction(:, :) !< (3, points) [Pa]
    real(rk) :: force(size(traction)) !< [N]
    force = reshape(spread(operator%area, 1, 3)*traction, [size(traction)])
  end function force_of

  !> Joint states at the end of an increment, and the tractions of the equilibrium there.
  subroutine solve_joints(self, controls, balance, joints, old, new, traction, outcome)
    class(reduced_matrices), intent(inout), target :: self
    type(step_controls), intent(in), target :: controls
    type(force_balance), intent(in) :: balance !< its offset: jumps without joint forces
    type(dam_joint), intent(in), target :: joints(:)
    type(joint_state), intent(in), target :: old(:)
    type(joint_state), intent(inout), target :: new(:)
    real(rk), intent(out) :: traction(:, :) !< (3, points) [Pa]
    type(balance_outcome), intent(out) :: outcome
    type(joint_increment) :: now
    call now%view(controls, joints, self%operator, self%joints%k_ref, old, new)
    call start_iteration(balance, self%joints%scale, now)
    now%field%response = balance%offset &
                         - jumps_of(self%joints, self%operator%area, &
                                    self%joints%k_ref*(balance%offset - now%field%jump) &
                                    + now%field%iterate)
    call iterate_on_jumps(self%joints, now)
    traction = now%field%iterate
    outcome = now%outcome
  end subroutine solve_joints
end module reduced_scheme
