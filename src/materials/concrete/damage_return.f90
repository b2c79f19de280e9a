!> Return map of plastic-damage concrete: one scalar equation for the multiplier x of Eq. 24.
!>
!> The flow of Eq. 25 is coaxial and its deviator parallel to S, so with x given everything at the
!> end of the increment follows from the trial state (theory.md, (11.13)): q from
!>     q (1 + 3 mu x/sqrt(a^2 + q^2)) = q_tr,
!> S = S_tr q/q_tr, p = p_tr + K tan(psi) x, the weight r, both measures of plastic strain, both
!> strengths. F(x) = 0 remains. F(0) > 0, and F < 0 for large x if tan(psi) > 0 and a > 0, because p
!> increases without limit and q vanishes. A root therefore exists, also at the apex and in
!> hydrostatic tension. The smallest root is taken: up to it the path stays on the softening branch.
module damage_return
  use damage_curves, only: curve_value, value_of_curve
  use damage_model, only: concrete_model, placed_curves
  use damage_split, only: tension_at
  use damage_yield, only: tension_share, yield_at, yield_value
  use kinds, only: rk
  implicit none
  private
  public :: trial_state, flow_state, flow_by, find_flow

  real(rk), parameter :: tolerance = 1.0e-13_rk !< |F| over the strength in compression
  real(rk), parameter :: acceptable = 1.0e-9_rk !< the same, where round-off prevents more
  integer, parameter :: max_steps = 400 !< a table of 100 rows, and bisection to roundoff
  integer, parameter :: max_inner = 60
  real(rk), parameter :: roundoff = 2.0_rk*epsilon(1.0_rk) !< of the equation for q
  real(rk), parameter :: overshoot = 1.0e-6_rk !< beyond a knot, onto the next branch

  !> Elastic trial state.
  type :: trial_state
    real(rk) :: q = 0.0_rk, p = 0.0_rk !< [Pa]
    real(rk) :: shape(3) = 0.0_rk !< principal deviator over q, largest first; 0 where q is 0
    real(rk) :: measures(2) = 0.0_rk !< kappa_t, kappa_c before the increment
  end type trial_state

  !> The state after flow by x, with derivatives by x (named `_rate`).
  type :: flow_state
    real(rk) :: x = 0.0_rk
    real(rk) :: q = 0.0_rk, q_rate = 0.0_rk, p = 0.0_rk !< p_rate is K tan psi
    real(rk) :: radius = 0.0_rk !< sqrt(a^2 + q^2)
    real(rk) :: stiffening = 1.0_rk !< dq_tr/dq at constant x
    real(rk) :: s(3) = 0.0_rk, s_rate(3) = 0.0_rk !< principal effective stresses
    real(rk) :: share = 0.0_rk, share_by(3) = 0.0_rk !< r, dr/ds_i
    real(rk) :: largest_flow = 0.0_rk, smallest_flow = 0.0_rk !< <n_1>, <-n_3>
    real(rk) :: measures(2) = 0.0_rk, measure_rates(2) = 0.0_rk !< kappa_t, kappa_c
    integer :: rows(2) = 1 !< of the curves
    type(curve_value) :: tension, compression
    type(yield_value) :: f
    real(rk) :: f_rate = 0.0_rk
  end type flow_state

contains

  !> The state after flow by x.
  pure subroutine flow_by(model, placed, trial, x, flow)
    type(concrete_model), intent(in) :: model
    type(placed_curves), intent(in) :: placed
    type(trial_state), intent(in) :: trial
    real(rk), intent(in) :: x !< multiplier, >= 0
    type(flow_state), intent(inout) :: flow !< on entry with guesses of its rows
    real(rk) :: inverse, slope, direction, direction_rate, share_rate, smallest, smallest_rate
    flow%x = x
    call reduce_deviator(placed%rounding, trial%q, 3.0_rk*model%shear*x, flow)
    inverse = 1.0_rk/flow%radius
    flow%q_rate = -3.0_rk*model%shear*flow%q*inverse/flow%stiffening
    slope = 1.5_rk*inverse
    flow%p = trial%p + model%bulk*model%tan_dilation*x
    flow%s = flow%q*trial%shape - flow%p
    flow%s_rate = flow%q_rate*trial%shape - model%bulk*model%tan_dilation
    call tension_share(flow%s, flow%share, flow%share_by)
    share_rate = dot_product(flow%share_by, flow%s_rate)
    ! (q/sqrt(a^2 + q^2))' = a^2 q'/sqrt(a^2 + q^2)^3
    direction = slope*flow%q
    direction_rate = slope*flow%q_rate*(placed%rounding*inverse)**2
    flow%largest_flow = direction*trial%shape(1) + model%tan_dilation/3.0_rk
    smallest = direction*trial%shape(3) + model%tan_dilation/3.0_rk
    smallest_rate = merge(-direction_rate*trial%shape(3), 0.0_rk, smallest < 0.0_rk)
    flow%smallest_flow = max(0.0_rk, -smallest)
    flow%measures = trial%measures + x*[flow%share*flow%largest_flow, &
                                        (1.0_rk - flow%share)*flow%smallest_flow]
    flow%measure_rates = [flow%share*(flow%largest_flow + x*direction_rate*trial%shape(1)), &
                          (1.0_rk - flow%share)*(flow%smallest_flow + x*smallest_rate)] &
                         + x*share_rate*[flow%largest_flow, -flow%smallest_flow]
    call evaluate_residual(model, placed, flow)
  end subroutine flow_by

  !> q after flow by x. The left side of the equation for q is increasing and concave, so Newton's
  !> iterates increase to the root from below; from above the first step goes below the root. The
  !> first guess takes q/sqrt(a^2 + q^2) of the last x, which hardly changes unless q is small.
  pure subroutine reduce_deviator(rounding, q_trial, flow_modulus, flow)
    real(rk), intent(in) :: rounding, q_trial !< a, q_tr [Pa]
    real(rk), intent(in) :: flow_modulus !< 3 mu x [Pa]
    type(flow_state), intent(inout) :: flow !< q, radius and stiffening are set
    real(rk) :: square, q, excess, inverse, least
    integer :: i
    square = rounding**2
    least = max(q_trial - flow_modulus, q_trial*rounding/(rounding + flow_modulus))
    q = least
    if (flow%radius > 0.0_rk) q = max(least, q_trial - flow_modulus*flow%q/flow%radius)
    do i = 1, max_inner
      flow%radius = sqrt(square + q**2)
      inverse = 1.0_rk/flow%radius
      flow%stiffening = 1.0_rk + flow_modulus*square*inverse*inverse*inverse
      flow%q = q
      excess = q_trial - q*(1.0_rk + flow_modulus*inverse)
      if (excess <= roundoff*q_trial .and. (i > 1 .or. excess >= -roundoff*q_trial)) exit
      q = max(least, q + excess/flow%stiffening)
    end do
  end subroutine reduce_deviator

  !> Evaluates F and its derivative by x.
  pure subroutine evaluate_residual(model, placed, flow)
    type(concrete_model), intent(in) :: model
    type(placed_curves), intent(in) :: placed
    type(flow_state), intent(inout) :: flow
    call tension_at(model, placed, flow%measures(1), flow%rows(1), flow%tension)
    call value_of_curve(model%compression, placed%compression, 1.0_rk, flow%measures(2), &
                        flow%rows(2), flow%compression)
    flow%f = yield_at(model, flow%q, flow%p, flow%s(1), flow%tension%strength, &
                      flow%compression%strength)
    flow%f_rate = flow%f%by_q*flow%q_rate + flow%f%by_p*model%bulk*model%tan_dilation &
                  + flow%f%by_largest*flow%s_rate(1) &
                  + flow%f%by_tension*flow%tension%strength_slope*flow%measure_rates(1) &
                  + flow%f%by_compression*flow%compression%strength_slope*flow%measure_rates(2)
  end subroutine evaluate_residual

  !> Finds the flow that ends on the yield surface.
  !>
  !> Newton's steps from x = 0 upward, at most to the next knot of a curve, until F is negative;
  !> then within the bracket by Newton's method, or by bisection where it is slow.
  pure subroutine find_flow(model, placed, trial, flow, has_converged)
    type(concrete_model), intent(in) :: model
    type(placed_curves), intent(in) :: placed
    type(trial_state), intent(in) :: trial
    type(flow_state), intent(inout) :: flow !< on entry flow_by(0)
    logical, intent(out) :: has_converged
    real(rk) :: low, high, x, f_before
    integer :: i
    low = 0.0_rk
    high = -1.0_rk
    f_before = huge(x)
    do i = 1, max_steps
      has_converged = abs(flow%f%value) <= residual_limit(trial, flow)
      if (has_converged) return
      if (flow%f%value > 0.0_rk) then
        low = flow%x
      else
        high = flow%x
      end if
      if (high < 0.0_rk) then
        x = next_step(model, placed, flow)
      else
        x = low
        if (flow%f_rate < 0.0_rk .and. abs(flow%f%value) < 0.5_rk*f_before) then
          x = newton_point(flow)
        end if
        if (x <= low .or. x >= high) x = 0.5_rk*(low + high)
        if (x <= low .or. x >= high) exit
      end if
      f_before = abs(flow%f%value)
      call flow_by(model, placed, trial, x, flow)
    end do
    has_converged = abs(flow%f%value) <= acceptable*flow%compression%strength
  end subroutine find_flow

  !> Admissible |F|: a fraction of the strength in compression, or round-off of the trial state, but
  !> at most the acceptable value.
  pure real(rk) function residual_limit(trial, flow) result(limit)
    type(trial_state), intent(in) :: trial
    type(flow_state), intent(in) :: flow
    limit = epsilon(limit)*(1.0_rk + flow%f%by_largest)*(trial%q + abs(trial%p))
    limit = min(max(limit, tolerance*flow%compression%strength), &
                acceptable*flow%compression%strength)
  end function residual_limit

  !> The next multiplier in the search for a negative F.
  pure real(rk) function next_step(model, placed, flow) result(x)
    type(concrete_model), intent(in) :: model
    type(placed_curves), intent(in) :: placed
    type(flow_state), intent(in) :: flow !< with F > 0
    real(rk) :: knot
    x = huge(x)
    if (flow%f_rate < 0.0_rk) x = newton_point(flow)
    knot = min(step_to_knot(placed%tension, flow, 1), step_to_knot(placed%compression, flow, 2))
    x = min(x, flow%x + knot)
    if (x < huge(x)) return
    x = 2.0_rk*flow%x + flow%f%value/(3.0_rk*model%shear + model%bulk*model%tan_dilation)
  end function next_step

  !> Newton's next multiplier for decreasing F. In tension F is approximately c/t s_1 - c, a
  !> hyperbola in the decreasing strength t; F t/c is nearly linear and has the same roots.
  pure real(rk) function newton_point(flow) result(x)
    type(flow_state), intent(in) :: flow
    real(rk) :: rate, scaled
    rate = flow%f_rate
    if (flow%f%by_tension < 0.0_rk) then
      scaled = rate + flow%f%value &
               *(flow%tension%strength_slope*flow%measure_rates(1)/flow%tension%strength &
                 - flow%compression%strength_slope*flow%measure_rates(2) &
                 /flow%compression%strength)
      if (scaled < 0.0_rk) rate = scaled
    end if
    x = flow%x - flow%f%value/rate
  end function newton_point

  !> Increment of the multiplier to the next knot of a measure; huge without one.
  pure real(rk) function step_to_knot(knots, flow, measure) result(step)
    real(rk), intent(in) :: knots(:)
    type(flow_state), intent(in) :: flow
    integer, intent(in) :: measure !< 1 tension, 2 compression
    real(rk) :: gap
    step = huge(step)
    if (flow%rows(measure) == size(knots)) return
    gap = knots(flow%rows(measure) + 1) - flow%measures(measure)
    gap = gap + overshoot*(knots(flow%rows(measure) + 1) - knots(flow%rows(measure)))
    if (flow%measure_rates(measure) > gap*tiny(gap)**0.25_rk) step = gap/flow%measure_rates(measure)
  end function step_to_knot
end module damage_return
