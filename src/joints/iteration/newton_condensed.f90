!> Newton's iteration on the jumps alone, through the compliance G = B K_0^-1 B^T of the structure
!> with closed joints (theory.md, (8.1)).
!>
!> With D = weight*area*(k_ref - tangent) a correction d of the jumps satisfies
!>   d = r + G D d,   r the correction with closed joints.
!> The equations are solved for z = D d on the rows where D is not zero: (I - D G) z = D r. What
!> their solution leaves, D d - z, counts as a force of the linearised equilibrium, so that the
!> equilibrium of the structure is exact in every iterate.
module newton_condensed
  use kinds, only: rk
  use block_compliance, only: compliance_blocks
  use contact_scaling, only: contact_scale, open_group
  use tangent_equations, only: joint_tangent
  use joint_law, only: joint_state
  use joint_points, only: dam_joint
  use joint_operator, only: jump_operator
  use joint_forces, only: joint_field, linear_tractions
  use contact_sweeps, only: gather_points, swept_points, sweep_contacts
  use joint_iteration, only: measure_residual, measure_correction, take_step, linearise, &
                             is_cycling, augment_contact, smallest_force
  use equilibrium, only: balance_outcome
  use step_plan, only: step_controls
  implicit none
  private
  public :: condensed_joints, iterate_on_jumps, linearise_again

  type :: condensed_joints
    real(rk) :: weight = 1.0_rk !< of the joint forces in the balance
    type(compliance_blocks) :: blocks !< G
    real(rk), allocatable :: k_ref(:, :) !< (3, points) k_ref [Pa/m]
    type(open_group), allocatable :: opened(:) !< (groups) C with open joints
    type(contact_scale) :: scale !< r of the augmented contact
    type(joint_tangent) :: tangent !< of the last iteration
  end type condensed_joints

  !> Sweeps before the second iteration, and most sweeps before one. On the saved problems
  !> (docs/studies/joint_problems.md) 10 to 80 sweeps find the states.
  integer, parameter :: first_sweeps = 10, most_sweeps = 160

  !> Most iterations over those of *CONTROLS; beyond those the least residual is not older than
  !> `gaining` iterations.
  integer, parameter :: most_attempts = 2, gaining = 5

  !> Newton's linear equations are solved to this share of their right-hand side, or of the
  !> admissible residual.
  real(rk), parameter :: linear_share = 1.0e-3_rk, admissible_share = 0.1_rk
  !> The correction that decides convergence needs some digits.
  real(rk), parameter :: judged_share = 1.0e-4_rk

  real(rk), parameter :: roundoff = 4.0_rk*epsilon(1.0_rk)

contains

  !> Newton's iteration; where it does not converge, sweeps from the start of the increment and
  !> Newton's iteration again, each time with twice as many sweeps as before. On return `field%jump`
  !> and `field%iterate` hold the jumps and tractions of the solution, `new` the histories there.
  subroutine iterate_on_jumps(self, controls, joints, operator, old, field, new, outcome)
    type(condensed_joints), intent(inout) :: self
    type(step_controls), intent(in) :: controls
    type(dam_joint), intent(in) :: joints(:)
    type(jump_operator), intent(in) :: operator
    type(joint_state), intent(in) :: old(:)
    type(joint_field), intent(inout) :: field !< linearised; its response is for k_ref
    type(joint_state), intent(inout) :: new(:)
    type(balance_outcome), intent(out) :: outcome
    type(swept_points) :: points
    real(rk), dimension(3, operator%num_points) :: closed_jump, start_excess, force
    integer :: num_sweeps
    closed_jump = field%response
    start_excess = self%k_ref*field%jump - field%iterate
    force = field%multiplier
    if (all_closed(self, field)) force = self%k_ref*closed_jump
    num_sweeps = first_sweeps
    do
      call iterate_newton(self, controls, joints, operator, old, field, new, outcome)
      if (outcome%has_converged .or. outcome%gives_up .or. num_sweeps > most_sweeps) return
      if (num_sweeps == first_sweeps) then
        closed_jump = closed_jump - jumps_of(self, operator%area, start_excess)
        force = self%weight*spread(operator%area, 1, 3)*force
      end if
      field%scale = self%scale
      call gather_points(joints, operator, self%k_ref, self%weight, old, new, points)
      call sweep_contacts(self%blocks, self%opened, points, closed_jump, num_sweeps, force, field)
      field%is_open = .true. ! what the sweeps open does not count as an opening of the iteration
      call linearise(joints, operator, old, self%k_ref, field, new)
      field%response = closed_jump + jumps_of(self, operator%area, &
                                              self%k_ref*field%jump - field%iterate)
      outcome%pass_start = outcome%iterations
      outcome%sweeps = outcome%sweeps + num_sweeps
      num_sweeps = 2*num_sweeps
    end do
  end subroutine iterate_on_jumps

  !> Linearises the joints at the end of an iteration. The response on entry is that to the forces
  !> at the end.
  subroutine linearise_again(self, joints, operator, old, field, new)
    type(condensed_joints), intent(in) :: self
    type(dam_joint), intent(in) :: joints(:)
    type(jump_operator), intent(in) :: operator
    type(joint_state), intent(in) :: old(:)
    type(joint_field), intent(inout) :: field
    type(joint_state), intent(inout) :: new(:)
    field%multiplier = field%iterate
    call linearise(joints, operator, old, self%k_ref, field, new)
    field%response = field%response &
                     + jumps_of(self, operator%area, field%multiplier - field%iterate)
  end subroutine linearise_again

  !> Whether the iteration starts with closed, sticking joints.
  pure logical function all_closed(self, field)
    type(condensed_joints), intent(in) :: self
    type(joint_field), intent(in) :: field
    all_closed = .not. any(abs(field%iterate - self%k_ref*field%jump) > 0.0_rk)
  end function all_closed

  !> Jumps that tractions cause with closed joints.
  function jumps_of(self, area, traction) result(jump)
    type(condensed_joints), intent(in) :: self
    real(rk), intent(in) :: area(:) !< (points) [m2]
    real(rk), intent(in) :: traction(:, :) !< (3, points) [Pa]
    real(rk) :: jump(3, size(area)) !< [m]
    real(rk) :: force(size(traction)), answer(size(traction))
    force = reshape(self%weight*spread(area, 1, 3)*traction, [size(traction)])
    call self%blocks%product(force, answer)
    jump = reshape(answer, shape(jump))
  end function jumps_of

  !> Iterates until residual and correction are within the tolerances, or in a cycle.
  subroutine iterate_newton(self, controls, joints, operator, old, field, new, outcome)
    type(condensed_joints), intent(inout) :: self
    type(step_controls), intent(in) :: controls
    type(dam_joint), intent(in) :: joints(:)
    type(jump_operator), intent(in) :: operator
    type(joint_state), intent(in) :: old(:)
    type(joint_field), intent(inout) :: field !< linearised; its response is for k_ref
    type(joint_state), intent(inout) :: new(:)
    type(balance_outcome), intent(inout) :: outcome
    real(rk), dimension(3, operator%num_points) :: correction, linear, rest
    real(rk) :: residual(most_attempts*controls%max_iterations)
    integer :: iteration, least
    least = 1
    iteration = 0
    do while (goes_on(outcome, controls%max_iterations, least))
      outcome%iterations = outcome%iterations + 1
      call self%tangent%set_tangent(self%blocks, self%k_ref, self%weight*operator%area, &
                                    field%tangent)
      if (self%tangent%is_singular) return ! a smaller increment may avoid it
      call solve_correction(self, field%response - field%jump, linear_share, &
                            negligible_force(), correction, rest)
      call linear_tractions(field, correction, linear)
      linear = linear + rest/spread(self%weight*operator%area, 1, 3)
      call take_step(joints, operator, old, self%k_ref, correction, linear, field, new)
      call measure_residual(operator, self%k_ref, field, linear, outcome)
      if (outcome%residual <= controls%residual_tolerance) then
        call solve_correction(self, excess_jump(field%traction), judged_share, 0.0_rk, &
                              correction, rest)
        call measure_correction(field, self%k_ref, correction, &
                                controls%increment_tolerance, outcome)
      end if
      if (outcome%has_converged) then
        call augment_contact(joints, operator, old, self%k_ref, field, new, outcome)
        if (outcome%has_converged .or. outcome%gives_up) exit
      end if
      iteration = outcome%iterations - outcome%pass_start
      if (iteration > 0) then
        residual(iteration) = outcome%residual
        least = minloc(residual(:iteration), 1)
        if (is_cycling(residual(:iteration))) return
      end if
      field%response = field%response + excess_jump(field%iterate)
    end do
    field%iterate = linear
  contains
    !> Residual of the linear equations that need not be solved for. Where the residual is within
    !> its tolerance, the correction is not, and needs more digits.
    real(rk) function negligible_force()
      negligible_force = 0.0_rk ! [N]
      if (iteration > 0 .and. outcome%residual <= controls%residual_tolerance) return
      negligible_force = admissible_share*controls%residual_tolerance*smallest_force(field)
    end function negligible_force

    !> Jumps caused by tractions beyond those of the linearised equilibrium; most points are
    !> linear.
    function excess_jump(traction) result(answer)
      real(rk), intent(in) :: traction(:, :) !< (3, points) [Pa]
      real(rk) :: answer(3, size(traction, 2)) !< [m]
      answer = linear - traction
      where (abs(answer) <= roundoff*(abs(linear) + abs(traction))) answer = 0.0_rk
      answer = jumps_of(self, operator%area, answer)
    end function excess_jump
  end subroutine iterate_newton

  !> Whether Newton's iteration goes on: up to the number of *CONTROLS, and beyond it while the
  !> residual decreases.
  pure logical function goes_on(outcome, most, least)
    type(balance_outcome), intent(in) :: outcome
    integer, intent(in) :: most !< ITERATIONS
    integer, intent(in) :: least !< iteration with the least residual
    integer :: iteration
    iteration = outcome%iterations - outcome%pass_start
    goes_on = iteration < most .or. (iteration < most_attempts*most .and. &
                                     iteration - least < gaining)
  end function goes_on

  !> The correction d of the jumps, and D d - z.
  subroutine solve_correction(self, response, tolerance, smallest, correction, rest)
    type(condensed_joints), intent(in) :: self
    real(rk), intent(in) :: response(:, :) !< (3, points) r [m]
    real(rk), intent(in) :: tolerance, smallest !< of the residual, relative and absolute [N]
    real(rk), intent(out) :: correction(:, :) !< (3, points) d [m]
    real(rk), intent(out) :: rest(:, :) !< (3, points) [N]
    real(rk), dimension(size(response)) :: d, left
    call self%tangent%solve(self%blocks, reshape(response, [size(response)]), tolerance, &
                            self%weight*smallest, d, left)
    correction = reshape(d, shape(correction))
    rest = reshape(left, shape(rest))
  end subroutine solve_correction
end module newton_condensed
