!> Return map of plastic-damage concrete: one scalar equation for the multiplier x of Eq. 24.
!>
!> The flow of Eq. 25 is coaxial and its deviator parallel to S, so with x given everything at the
!> end of the increment follows from the trial state (theory.md, (11.13)): q from
!>     q (1 + 3 mu x/sqrt(a^2 + q^2)) = q_tr,
!> S = S_tr q/q_tr, p = p_tr + K tan(psi) x, the weight r, both measures of plastic strain, both
!> strengths. F(x) = 0 remains. F(0) > 0, and F < 0 for large x if tan(psi) > 0 and a > 0, because p
!> increases without limit and q vanishes. A root therefore exists, also at the apex and in
!> hydrostatic tension. The smallest root is taken: up to it the path stays on the softening branch.
!>
!> The unknown of the program is y = x/sqrt(a^2 + q^2), with which x increases:
!> q = q_tr/(1 + 3 mu y) and x = y sqrt(a^2 + q^2) are explicit.
module damage_return
  use damage_curves, only: curve_value, value_of_curve
  use damage_model, only: concrete_model, placed_curves
  use damage_split, only: tension_at
  use damage_yield, only: tension_share, yield_at, yield_value
  use kinds, only: rk
  implicit none
  private
  public :: trial_state, flow_state, flow_by, find_flow
  public :: tolerance, acceptable, largest_bend, overshoot

  real(rk), parameter :: tolerance = 1.0e-13_rk !< |F| over the strength in compression
  real(rk), parameter :: acceptable = 1.0e-9_rk !< the same, where round-off prevents more
  integer, parameter :: max_steps = 400 !< a table of 100 rows, and bisection to roundoff
  real(rk), parameter :: largest_bend = 0.5_rk !< of a step, over Newton's
  real(rk), parameter :: overshoot = 1.0e-6_rk !< beyond a knot, onto the next branch

  !> Elastic trial state.
  type :: trial_state
    real(rk) :: q = 0.0_rk, p = 0.0_rk !< [Pa]
    real(rk) :: shape(3) = 0.0_rk !< principal deviator over q, largest first; 0 where q is 0
    real(rk) :: measures(2) = 0.0_rk !< kappa_t, kappa_c before the increment
  end type trial_state

  !> The state after flow by x, with derivatives by x (named `_rate`).
  type :: flow_state
    real(rk) :: x = 0.0_rk, y = 0.0_rk !< y = x/radius [1/Pa]
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

  !> A function with the root of F, nearly linear in x, at one x.
  type :: root_sample
    real(rk) :: x = 0.0_rk, value = 0.0_rk, slope = 0.0_rk !< slope: dx/dvalue
    logical :: falls = .false. !< F decreases
    logical :: is_scaled = .false. !< F t/c in place of F
    integer :: rows(2) = 0 !< of the curves
  end type root_sample

contains

  !> The state after flow by x = y sqrt(a^2 + q^2).
  pure subroutine flow_by(model, placed, trial, y, flow)
    type(concrete_model), intent(in) :: model
    type(placed_curves), intent(in) :: placed
    type(trial_state), intent(in) :: trial
    real(rk), intent(in) :: y !< >= 0 [1/Pa]
    type(flow_state), intent(inout) :: flow !< on entry with guesses of its rows
    real(rk) :: inverse, slope, direction, direction_rate, share_rate, smallest, smallest_rate
    flow%y = y
    flow%q = trial%q/(1.0_rk + 3.0_rk*model%shear*y)
    flow%radius = sqrt(placed%rounding**2 + flow%q**2)
    inverse = 1.0_rk/flow%radius
    flow%x = y*flow%radius
    flow%stiffening = 1.0_rk + 3.0_rk*model%shear*y*(placed%rounding*inverse)**2
    flow%q_rate = -3.0_rk*model%shear*flow%q*inverse/flow%stiffening
    slope = 1.5_rk*inverse
    flow%p = trial%p + model%bulk*model%tan_dilation*flow%x
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
    flow%measures = trial%measures + flow%x*[flow%share*flow%largest_flow, &
                                             (1.0_rk - flow%share)*flow%smallest_flow]
    flow%measure_rates = [flow%share*(flow%largest_flow &
                                      + flow%x*direction_rate*trial%shape(1)), &
                          (1.0_rk - flow%share)*(flow%smallest_flow + flow%x*smallest_rate)] &
                         + flow%x*share_rate*[flow%largest_flow, -flow%smallest_flow]
    call evaluate_residual(model, placed, flow)
  end subroutine flow_by

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
    type(root_sample) :: now, last
    real(rk) :: low, high, y, f_before
    integer :: i
    low = 0.0_rk
    high = -1.0_rk
    f_before = huge(y)
    do i = 1, max_steps
      has_converged = abs(flow%f%value) <= residual_limit(trial, flow)
      if (has_converged) return
      last = now
      now = sample_of(flow)
      if (flow%f%value > 0.0_rk) then
        low = flow%y
      else
        high = flow%y
      end if
      if (high < 0.0_rk) then
        y = y_near(placed, flow, next_step(model, placed, flow, now, last))
        if (y <= low) exit
      else
        y = low
        if (now%falls .and. abs(flow%f%value) < 0.5_rk*f_before) then
          y = y_near(placed, flow, root_near(now, last))
        end if
        if (y <= low .or. y >= high) y = 0.5_rk*(low + high)
        if (y <= low .or. y >= high) exit
      end if
      f_before = abs(flow%f%value)
      call flow_by(model, placed, trial, y, flow)
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
  pure real(rk) function next_step(model, placed, flow, now, last) result(x)
    type(concrete_model), intent(in) :: model
    type(placed_curves), intent(in) :: placed
    type(flow_state), intent(in) :: flow !< with F > 0
    type(root_sample), intent(in) :: now, last !< of this flow and of that before it
    real(rk) :: knot
    x = huge(x)
    if (now%falls) x = root_near(now, last)
    knot = min(step_to_knot(placed%tension, flow, 1), step_to_knot(placed%compression, flow, 2))
    x = min(x, flow%x + knot)
    if (x < huge(x)) return
    x = 2.0_rk*flow%x + flow%f%value/(3.0_rk*model%shear + model%bulk*model%tan_dilation)
  end function next_step

  !> y of a multiplier, from the derivative of sqrt(a^2 + q^2). The error is of second order in the
  !> change of x, and small unless q is as small as a.
  pure real(rk) function y_near(placed, flow, x) result(y)
    type(placed_curves), intent(in) :: placed
    type(flow_state), intent(in) :: flow
    real(rk), intent(in) :: x
    y = x/max(placed%rounding, flow%radius + flow%q*flow%q_rate/flow%radius*(x - flow%x))
  end function y_near

  !> In tension F is approximately c/t s_1 - c, a hyperbola in the decreasing strength t; F t/c is
  !> nearly linear and has the same roots.
  pure function sample_of(flow) result(sample)
    type(flow_state), intent(in) :: flow
    type(root_sample) :: sample
    real(rk) :: scaled, ratio
    sample%x = flow%x
    sample%falls = flow%f_rate < 0.0_rk
    if (.not. sample%falls) return
    sample%rows = flow%rows
    sample%value = flow%f%value
    sample%slope = 1.0_rk/flow%f_rate
    if (flow%f%by_tension >= 0.0_rk) return
    scaled = flow%f_rate + flow%f%value &
             *(flow%tension%strength_slope*flow%measure_rates(1)/flow%tension%strength &
               - flow%compression%strength_slope*flow%measure_rates(2) &
               /flow%compression%strength)
    if (scaled >= 0.0_rk) return
    sample%is_scaled = .true.
    ratio = flow%tension%strength/flow%compression%strength
    sample%value = flow%f%value*ratio
    sample%slope = 1.0_rk/(scaled*ratio)
  end function sample_of

  !> Root of the cubic polynomial x(value) through two samples of the same rows of the curves, or
  !> Newton's step from the present one.
  pure real(rk) function root_near(now, last) result(x)
    type(root_sample), intent(in) :: now, last
    real(rk) :: step, gap, chord, bend
    step = -now%value*now%slope
    x = now%x + step
    if (.not. last%falls .or. any(now%rows /= last%rows)) return
    gap = last%value - now%value
    if ((now%is_scaled .neqv. last%is_scaled) .or. .not. abs(gap) > abs(now%value)) return
    chord = (last%x - now%x)/gap
    bend = (now%value/gap)**2*((chord - now%slope)*gap &
                               - (last%slope - 2.0_rk*chord + now%slope)*last%value)
    if (abs(bend) <= largest_bend*abs(step)) x = x + bend
  end function root_near

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
