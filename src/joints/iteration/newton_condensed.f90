!> Newton's iteration on the jumps alone, through the compliance G = B K_0^-1 B^T of the structure
!> with closed joints (theory.md, (8.1)).
!>
!> With D = weight*area*(k_ref - tangent) a correction d of the jumps satisfies
!>   d = r + G D d,   r the correction with closed joints.
!> The equations are solved for z = D d on the rows where D is not zero: (I - D G) z = D r.
!> The iterates are those of full Newton.
module newton_condensed
  use kinds, only: rk
  use joint_rows, only: num_axes, row_of, point_of, axis_of
  use joint_law, only: joint_state
  use joint_points, only: dam_joint
  use joint_operator, only: jump_operator
  use joint_forces, only: joint_field, linear_tractions
  use contact_sweeps, only: gather_points, swept_points, sweep_contacts
  use joint_compliance, only: contact_scale
  use joint_iteration, only: measure_residual, measure_correction, take_step, linearise, &
                             is_cycling, augment_contact
  use dense_factor, only: lu_factor, factorise_dense, solve_factored
  use equilibrium, only: balance_outcome
  use step_plan, only: step_controls
  implicit none
  private
  public :: condensed_joints, iterate_on_jumps

  type :: condensed_joints
    real(rk) :: weight = 1.0_rk !< of the joint forces in the balance
    real(rk), allocatable :: compliance(:, :) !< G (rows, rows) [m/N]
    real(rk), allocatable :: k_ref(:, :) !< (3, points) k_ref [Pa/m]
    real(rk), allocatable :: open_compliance(:, :) !< C (rows, rows) with open joints [m/N]
    type(contact_scale) :: scale !< r of the augmented contact
  end type condensed_joints

  !> A tangent that differs from k_ref on some rows.
  type :: changed_tangent
    real(rk), allocatable :: change(:, :, :) !< (3, 3, points) D [N/m]
    integer, allocatable :: row(:) !< rows of D that are not zero
    type(lu_factor) :: factor !< of I - D G on these rows
  end type changed_tangent

  !> Sweeps before the second iteration, and most sweeps before one. On the saved problems
  !> (docs/studies/joint_problems.md) 10 to 80 sweeps find the states.
  integer, parameter :: first_sweeps = 10, most_sweeps = 160

  !> Most iterations over those of *CONTROLS; beyond those the least residual is not older than
  !> `gaining` iterations.
  integer, parameter :: most_attempts = 2, gaining = 5

  real(rk), parameter :: roundoff = 4.0_rk*epsilon(1.0_rk)

contains

  !> Newton's iteration; where it does not converge, sweeps from the start of the increment and
  !> Newton's iteration again, each time with twice as many sweeps as before. On return `field%jump`
  !> and `field%iterate` hold the jumps and tractions of the solution, `new` the histories there.
  subroutine iterate_on_jumps(self, controls, joints, operator, old, field, new, outcome)
    type(condensed_joints), intent(in) :: self
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
      call sweep_contacts(self%open_compliance, points, closed_jump, num_sweeps, force, field)
      field%is_open = .true. ! what the sweeps open does not count as an opening of the iteration
      call linearise(joints, operator, old, self%k_ref, field, new)
      field%response = closed_jump + jumps_of(self, operator%area, &
                                              self%k_ref*field%jump - field%iterate)
      outcome%pass_start = outcome%iterations
      outcome%sweeps = outcome%sweeps + num_sweeps
      num_sweeps = 2*num_sweeps
    end do
  end subroutine iterate_on_jumps

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
    real(rk) :: force(size(traction))
    force = reshape(self%weight*spread(area, 1, 3)*traction, [size(traction)])
    jump = reshape(matmul(self%compliance, force), shape(jump))
  end function jumps_of

  !> Iterates until residual and correction are within the tolerances, or in a cycle.
  subroutine iterate_newton(self, controls, joints, operator, old, field, new, outcome)
    type(condensed_joints), intent(in) :: self
    type(step_controls), intent(in) :: controls
    type(dam_joint), intent(in) :: joints(:)
    type(jump_operator), intent(in) :: operator
    type(joint_state), intent(in) :: old(:)
    type(joint_field), intent(inout) :: field !< linearised; its response is for k_ref
    type(joint_state), intent(inout) :: new(:)
    type(balance_outcome), intent(inout) :: outcome
    type(changed_tangent) :: tangent
    real(rk), dimension(3, operator%num_points) :: correction, linear
    real(rk) :: residual(most_attempts*controls%max_iterations)
    integer :: iteration, least
    least = 1
    do while (goes_on(outcome, controls%max_iterations, least))
      outcome%iterations = outcome%iterations + 1
      call factorise_change(self, operator%area, field%tangent, tangent)
      if (tangent%factor%is_singular) return ! a smaller increment may avoid it
      call solve_correction(self, tangent, field%response - field%jump, correction)
      call linear_tractions(field, correction, linear)
      call take_step(joints, operator, old, self%k_ref, correction, linear, field, new)
      call measure_residual(operator, self%k_ref, field, linear, outcome)
      if (outcome%residual <= controls%residual_tolerance) then
        call solve_correction(self, tangent, excess_jump(field%traction), correction)
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
    !> Jumps caused by tractions beyond those of the linearised equilibrium.
    function excess_jump(traction) result(answer)
      real(rk), intent(in) :: traction(:, :) !< (3, points) [Pa]
      real(rk) :: answer(3, size(traction, 2)) !< [m]
      real(rk) :: flat(size(traction)), force, negligible
      integer :: row, p, i
      flat = 0.0_rk
      do row = 1, size(flat)
        p = point_of(row)
        i = axis_of(row)
        force = linear(i, p) - traction(i, p)
        negligible = roundoff*(abs(linear(i, p)) + abs(traction(i, p)))
        if (abs(force) <= negligible) cycle ! most points are linear
        flat = flat + self%weight*operator%area(p)*force*self%compliance(:, row)
      end do
      answer = reshape(flat, shape(answer))
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

  !> Selects the rows whose tangent differs from k_ref and factors I - D G on them.
  subroutine factorise_change(self, area, tangent, changed)
    type(condensed_joints), intent(in) :: self
    real(rk), intent(in) :: area(:) !< (points) [m2]
    real(rk), intent(in) :: tangent(:, :, :) !< (3, 3, points) [Pa/m]
    type(changed_tangent), intent(out) :: changed
    real(rk), allocatable :: matrix(:, :)
    integer, allocatable :: point(:), axis(:)
    integer :: p, i, k, l, first, num_rows
    allocate (changed%change(3, 3, size(area)), changed%row(size(self%compliance, 1)))
    num_rows = 0
    do p = 1, size(area)
      changed%change(:, :, p) = -tangent(:, :, p)
      do i = 1, num_axes
        changed%change(i, i, p) = changed%change(i, i, p) + self%k_ref(i, p)
        if (.not. any(abs(changed%change(i, :, p)) > 0.0_rk)) cycle
        num_rows = num_rows + 1
        changed%row(num_rows) = row_of(p, i)
      end do
      changed%change(:, :, p) = self%weight*area(p)*changed%change(:, :, p)
    end do
    changed%row = changed%row(:num_rows)
    point = point_of(changed%row)
    axis = axis_of(changed%row)
    allocate (matrix(num_rows, num_rows))
    do l = 1, num_rows
      do k = 1, num_rows
        first = changed%row(k) - axis(k) + 1
        matrix(k, l) = -dot_product(changed%change(axis(k), :, point(k)), &
                                    self%compliance(first:first + num_axes - 1, changed%row(l)))
      end do
      matrix(l, l) = matrix(l, l) + 1.0_rk
    end do
    call factorise_dense(matrix, changed%factor)
  end subroutine factorise_change

  !> The correction d of the jumps: d = r + G z on the rows that differ from k_ref.
  subroutine solve_correction(self, changed, response, correction)
    type(condensed_joints), intent(in) :: self
    type(changed_tangent), intent(in) :: changed
    real(rk), intent(in) :: response(:, :) !< (3, points) r [m]
    real(rk), intent(out), target, contiguous :: correction(:, :) !< (3, points) d [m]
    real(rk), pointer :: flat(:)
    real(rk) :: z(size(changed%row), 1)
    integer :: k, p
    do k = 1, size(changed%row)
      p = point_of(changed%row(k))
      z(k, 1) = dot_product(changed%change(axis_of(changed%row(k)), :, p), response(:, p))
    end do
    call solve_factored(changed%factor, z)
    correction = response
    flat(1:size(correction)) => correction
    do k = 1, size(changed%row)
      flat = flat + self%compliance(:, changed%row(k))*z(k, 1)
    end do
  end subroutine solve_correction
end module newton_condensed
