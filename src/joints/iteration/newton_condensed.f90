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
  use tangent_equations, only: joint_tangent
  use joint_operator, only: jump_operator
  use joint_forces, only: joint_field, linear_tractions
  use joint_iteration, only: joint_increment, iteration_history, measure_residual, &
                             measure_correction, take_step, linearise, goes_on, close_iteration, &
                             smallest_force
  use joint_policy, only: joint_process, iterate_joints, jumps_of, share_of
  use equilibrium, only: balance_outcome, is_dropped
  implicit none
  private
  public :: condensed_joints, iterate_on_jumps, start_policy, linearise_again
  public :: closed_response, open_response

  type, extends(joint_process) :: condensed_joints
    type(joint_tangent) :: tangent !< of the last iteration
    !> An equilibrium is found roughly where its residual is this share of the largest one of the
    !> iteration, or this residual; 0 for the tolerances of *CONTROLS. Blocks of G that are left out
    !> are then made up for.
    real(rk) :: rough_share = 0.0_rk, rough_residual = 0.0_rk
    logical :: is_rough = .false. !< the last equilibrium was found roughly
    logical :: keeps_factors = .false. !< those of the last iteration fit the next one
    !> (3, points) response [m] and excess traction [Pa] when the iteration starts
    real(rk), allocatable :: start_response(:, :), start_excess(:, :)
  contains
    procedure :: run_newton
    procedure :: find_response, find_closed
  end type condensed_joints

  !> Newton's linear equations are solved to this share of their right-hand side, or of the
  !> admissible residual. In statics blocks that only joints hold are soft: what 1e-3 leaves moved
  !> them so far that an arch of 16 blocks took 87 iterations in place of 9.
  real(rk), parameter :: solved_in_statics = 1.0e-6_rk, solved_in_time = 1.0e-3_rk
  real(rk), parameter :: admissible_share = 0.1_rk
  real(rk), parameter :: stalled = 0.5_rk !< a residual over the one before it that hardly falls
  !> The correction that decides convergence needs some digits, more of them where a small force
  !> may move a block far.
  real(rk), parameter :: judged_in_statics = 1.0e-4_rk, judged_in_time = 1.0e-2_rk

  real(rk), parameter :: roundoff = 4.0_rk*epsilon(1.0_rk)

contains

  !> Iterates on the jumps by the policy of all solvers. On return the field of `now` has the jumps
  !> and tractions of the solution, its `new` the histories there.
  subroutine iterate_on_jumps(self, now)
    class(condensed_joints), intent(inout) :: self
    type(joint_increment), intent(inout) :: now !< linearised; its response is for k_ref
    type(balance_outcome) :: nothing
    now%outcome = nothing
    call start_policy(self, now%operator, now%field)
    call iterate_joints(self, now)
  end subroutine iterate_on_jumps

  !> Stores the start of the iteration.
  subroutine start_policy(self, operator, field)
    class(condensed_joints), intent(inout) :: self
    type(jump_operator), intent(in) :: operator
    type(joint_field), intent(in) :: field !< linearised; its response is for k_ref
    self%tangent%is_first = .not. self%keeps_factors
    self%start_response = field%response
    self%start_excess = self%k_ref*field%jump - field%iterate
    self%force = share_of(self%weight, operator)*field%multiplier
  end subroutine start_policy

  !> Jumps with closed joints; where the iteration starts closed, their forces.
  subroutine find_closed(self, operator)
    class(condensed_joints), intent(inout) :: self
    type(jump_operator), intent(in) :: operator
    self%closed_jump = self%start_response - jumps_of(self, operator%area, self%start_excess)
    if (any(abs(self%start_excess) > 0.0_rk)) return
    self%force = share_of(self%weight, operator)*self%k_ref*self%closed_jump
  end subroutine find_closed

  !> The response to the linearised joints of a field with new jumps.
  subroutine find_response(self, now)
    class(condensed_joints), intent(in) :: self
    type(joint_increment), intent(inout) :: now
    now%field%response = open_response(self, now%operator%area, self%closed_jump, now%field)
  end subroutine find_response

  !> Jumps with closed, sticking joints, from the response to the linearised joints.
  function closed_response(self, area, field) result(jump)
    class(condensed_joints), intent(in) :: self
    real(rk), intent(in) :: area(:) !< (points) [m2]
    type(joint_field), intent(in) :: field
    real(rk) :: jump(3, size(area)) !< [m]
    jump = field%response - jumps_of(self, area, self%k_ref*field%jump - field%iterate)
  end function closed_response

  !> Response to the linearised joints, from the jumps with closed, sticking joints.
  function open_response(self, area, closed_jump, field) result(jump)
    class(condensed_joints), intent(in) :: self
    real(rk), intent(in) :: area(:) !< (points) [m2]
    real(rk), intent(in) :: closed_jump(:, :) !< (3, points) [m]
    type(joint_field), intent(in) :: field
    real(rk) :: jump(3, size(area)) !< [m]
    jump = closed_jump + jumps_of(self, area, self%k_ref*field%jump - field%iterate)
  end function open_response

  !> Linearises the joints at the end of an iteration. The response on entry is that to the forces
  !> at the end.
  subroutine linearise_again(self, now)
    type(condensed_joints), intent(in) :: self
    type(joint_increment), intent(inout) :: now
    now%field%multiplier = now%field%iterate
    call linearise(now)
    associate (field => now%field)
      field%response = field%response &
                       + jumps_of(self, now%operator%area, field%multiplier - field%iterate)
    end associate
  end subroutine linearise_again

  !> Iterates until residual and correction are within the tolerances, or in a cycle.
  subroutine run_newton(self, now)
    class(condensed_joints), intent(inout) :: self
    type(joint_increment), intent(inout) :: now !< linearised; its response is for k_ref
    type(iteration_history) :: history
    real(rk) :: most ! of all residuals
    real(rk), dimension(3, now%operator%num_points) :: correction, linear, rest
    allocate (history%unbalance(0), history%step(0))
    most = 0.0_rk
    self%is_rough = .false.
    associate (field => now%field, outcome => now%outcome, area => now%operator%area)
      do while (goes_on(history, now))
        if (is_dropped(now%controls)) return
        outcome%iterations = outcome%iterations + 1
        self%tangent%is_single = .not. field%is_static
        self%tangent%is_static = field%is_static
        call self%tangent%set_tangent(self%blocks, self%k_ref, self%weight*area, field%tangent)
        if (self%tangent%is_singular) return ! a smaller increment may avoid it
        call solve_correction(self, field%response - field%jump, &
                              merge(solved_in_statics, solved_in_time, field%is_static), &
                              negligible_force(), correction, rest)
        call linear_tractions(field, correction, linear)
        linear = linear + rest/spread(self%weight*area, 1, 3)
        call take_step(correction, linear, now)
        call measure_residual(linear, now)
        most = max(most, outcome%residual)
        self%is_rough = is_near_enough()
        if (self%is_rough) then
          outcome%has_converged = .true.
          exit
        end if
        if (outcome%residual <= now%controls%residual_tolerance) then
          call judge_correction(self, excess_jump(field%traction), field%is_static, correction)
          call measure_correction(correction, now)
        end if
        call close_iteration(now, history)
        if (.not. history%has_ended) field%response = field%response + excess_jump(field%iterate)
      end do
    end associate
    now%field%iterate = linear
  contains
    !> Whether a rough equilibrium is found that is not an exact one.
    pure logical function is_near_enough()
      is_near_enough = now%outcome%residual <= max(self%rough_share*most, self%rough_residual) &
                       .and. now%outcome%residual > now%controls%residual_tolerance &
                       .and. .not. allocated(now%field%tresca%bound)
    end function is_near_enough

    !> Residual of the linear equations that need not be solved for. Where the residual is within
    !> its tolerance, the correction is not, and needs more digits. Where the residual hardly falls,
    !> a point may slide or stick by what was not solved for.
    real(rk) function negligible_force()
      integer :: n
      negligible_force = 0.0_rk ! [N]
      n = size(history%unbalance)
      associate (tolerance => now%controls%residual_tolerance)
        if (n > 0 .and. now%outcome%residual <= tolerance) return
        if (n > 1) then
          if (history%unbalance(n) > stalled*history%unbalance(n - 1)) return
        end if
        negligible_force = admissible_share*tolerance*smallest_force(now%field)
      end associate
    end function negligible_force

    !> Jumps caused by tractions beyond those of the linearised equilibrium; most points are
    !> linear.
    function excess_jump(traction) result(answer)
      real(rk), intent(in) :: traction(:, :) !< (3, points) [Pa]
      real(rk) :: answer(3, size(traction, 2)) !< [m]
      answer = linear - traction
      where (abs(answer) <= roundoff*(abs(linear) + abs(traction))) answer = 0.0_rk
      answer = jumps_of(self, now%operator%area, answer)
    end function excess_jump
  end subroutine run_newton

  !> The correction d of the jumps that decides convergence, to some digits.
  subroutine judge_correction(self, response, is_static, correction)
    class(condensed_joints), intent(in) :: self
    real(rk), intent(in) :: response(:, :) !< (3, points) r [m]
    logical, intent(in) :: is_static
    real(rk), intent(out) :: correction(:, :) !< (3, points) d [m]
    real(rk) :: rest(size(response)), d(size(response))
    associate (r => reshape(response, [size(response)]))
      if (is_static .or. self%blocks%groups%num_groups == 1) then
        call self%tangent%solve(self%blocks, r, judged_in_statics, 0.0_rk, d, rest)
      else
        call self%tangent%estimate(self%blocks, r, judged_in_time, d)
      end if
    end associate
    correction = reshape(d, shape(correction))
  end subroutine judge_correction

  !> The correction d of the jumps, and D d - z.
  subroutine solve_correction(self, response, tolerance, smallest, correction, rest)
    class(condensed_joints), intent(in) :: self
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
