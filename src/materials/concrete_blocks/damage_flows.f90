!> Plastic flow at points of concrete side by side: what `flow_by` of damage_return finds for one
!> point, in loops over the points that compilers turn into vector operations.
!>
!> Nothing in these loops branches: a case that does not hold at a point is computed with harmless
!> numbers and left out by `merge`.
module damage_flows
  use damage_curves, only: row_below, strength_curve
  use damage_model, only: concrete_model, place_curves, placed_curves
  use kinds, only: rk
  implicit none
  private
  public :: flow_block, most_points, no_knot
  public :: find_kinematics, find_parts, find_residuals, keep_flows, keep_values

  integer, parameter :: most_points = 64 !< of a block: its numbers fit the fastest cache
  !> In place of the end of the last part of a curve, and of a multiplier without limit.
  real(rk), parameter :: no_knot = 1.0e10_rk
  real(rk), parameter :: whole_strength(most_points) = 1.0_rk !< factor in compression

  !> The straight part of a curve that each point is on (see value_of_curve).
  type :: curve_parts
    integer, dimension(most_points) :: row
    real(rk), dimension(most_points) :: start, finish !< plastic strain at its ends
    real(rk), dimension(most_points) :: nominal, nominal_slope !< strength at its start [Pa]
    real(rk), dimension(most_points) :: damage, damage_slope !< at its start
    real(rk), dimension(most_points) :: measure, measure_rate !< kappa; its derivative by x
    real(rk), dimension(most_points) :: strength, strength_slope !< effective, there [Pa]
  end type curve_parts

  !> Points with their trial states and the flow by x; derivatives by x are named `_rate`. Names are
  !> those of trial_state and flow_state.
  type :: flow_block
    integer :: num_points = 0
    integer, dimension(most_points) :: place !< of the point in the list of the caller
    logical, dimension(most_points) :: is_same_part !< as in the last evaluation, on both curves
    real(rk), dimension(most_points) :: width !< of the crack band [m]
    real(rk), dimension(most_points) :: factor, rounding !< of the placed curves
    real(rk), dimension(most_points) :: q_trial, p_trial !< [Pa]
    real(rk), dimension(most_points) :: shape1, shape2, shape3 !< principal S_tr/q_tr
    real(rk), dimension(most_points) :: cracking, crushing !< kappa before the increment
    real(rk), dimension(most_points) :: y, x, q, q_rate, p, radius
    real(rk), dimension(most_points) :: largest, largest_rate !< s_1
    real(rk), dimension(most_points) :: share !< r
    real(rk), dimension(most_points) :: f, f_rate !< F
    real(rk), dimension(most_points) :: by_largest, by_tension !< dF/ds_1, dF/dt
    type(curve_parts) :: tension, compression
  end type flow_block

contains

  !> Stress and measures of plastic strain after flow by y = x/sqrt(a^2 + q^2).
  pure subroutine find_kinematics(model, b)
    type(concrete_model), intent(in) :: model
    type(flow_block), intent(inout) :: b
    real(rk) :: triple, growth, third, inverse, rounded, s1, s2, s3, t1, t2, t3, whole, share
    real(rk) :: share_rate, direction, turn, most, least, least_rate
    integer :: k
    triple = 3.0_rk*model%shear
    growth = model%bulk*model%tan_dilation
    third = model%tan_dilation/3.0_rk
    !$omp simd private(inverse, rounded, s1, s2, s3, t1, t2, t3, whole, share, share_rate) &
    !$omp private(direction, turn, most, least, least_rate)
    do k = 1, b%num_points
      b%q(k) = b%q_trial(k)/(1.0_rk + triple*b%y(k))
      b%radius(k) = sqrt(b%rounding(k)**2 + b%q(k)**2)
      inverse = 1.0_rk/b%radius(k)
      rounded = (b%rounding(k)*inverse)**2
      b%x(k) = b%y(k)*b%radius(k)
      b%q_rate(k) = -triple*b%q(k)*inverse/(1.0_rk + triple*b%y(k)*rounded)
      b%p(k) = b%p_trial(k) + growth*b%x(k)
      s1 = b%q(k)*b%shape1(k) - b%p(k)
      s2 = b%q(k)*b%shape2(k) - b%p(k)
      s3 = b%q(k)*b%shape3(k) - b%p(k)
      t1 = b%q_rate(k)*b%shape1(k) - growth
      t2 = b%q_rate(k)*b%shape2(k) - growth
      t3 = b%q_rate(k)*b%shape3(k) - growth
      b%largest(k) = s1
      b%largest_rate(k) = t1
      whole = abs(s1) + abs(s2) + abs(s3)
      whole = merge(1.0_rk/max(whole, tiny(whole)), 0.0_rk, whole > tiny(whole))
      share = (max(s1, 0.0_rk) + max(s2, 0.0_rk) + max(s3, 0.0_rk))*whole
      b%share(k) = share
      share_rate = whole*(merge(1.0_rk - share, share, s1 > 0.0_rk)*t1 &
                          + merge(1.0_rk - share, share, s2 > 0.0_rk)*t2 &
                          + merge(1.0_rk - share, share, s3 > 0.0_rk)*t3)
      direction = 1.5_rk*inverse*b%q(k)
      turn = 1.5_rk*inverse*b%q_rate(k)*rounded
      most = direction*b%shape1(k) + third
      least = -(direction*b%shape3(k) + third)
      least_rate = merge(-turn*b%shape3(k), 0.0_rk, least > 0.0_rk)
      least = max(0.0_rk, least)
      b%tension%measure(k) = b%cracking(k) + b%x(k)*share*most
      b%compression%measure(k) = b%crushing(k) + b%x(k)*(1.0_rk - share)*least
      b%tension%measure_rate(k) = share*(most + b%x(k)*turn*b%shape1(k)) &
                                  + b%x(k)*share_rate*most
      b%compression%measure_rate(k) = (1.0_rk - share)*(least + b%x(k)*least_rate) &
                                      - b%x(k)*share_rate*least
    end do
  end subroutine find_kinematics

  !> The parts of the curves for the present measures. Row 0 is none yet.
  pure subroutine find_parts(model, placed, b)
    type(concrete_model), intent(in) :: model
    type(placed_curves), intent(inout) :: placed !< curves, kept by the caller
    type(flow_block), intent(inout) :: b
    logical :: is_left, is_crushed
    integer :: k
    do k = 1, b%num_points
      is_left = leaves_part(b%tension, k)
      is_crushed = leaves_part(b%compression, k)
      b%is_same_part(k) = .not. (is_left .or. is_crushed)
      if (b%is_same_part(k)) cycle
      call place_curves(model, b%width(k), placed)
      b%factor(k) = placed%factor
      b%rounding(k) = placed%rounding
      if (is_left) call take_part(model%tension, placed%tension, k, b%tension)
      if (is_crushed) call take_part(model%compression, placed%compression, k, b%compression)
    end do
  end subroutine find_parts

  !> Whether a measure is not on its part.
  pure logical function leaves_part(parts, k)
    type(curve_parts), intent(in) :: parts
    integer, intent(in) :: k
    leaves_part = parts%row(k) == 0
    if (leaves_part) return
    leaves_part = parts%measure(k) < parts%start(k) .or. parts%measure(k) >= parts%finish(k)
  end function leaves_part

  !> Finds the part of a curve for the measure of one point.
  pure subroutine take_part(curve, knots, k, parts)
    type(strength_curve), intent(in) :: curve
    real(rk), intent(in) :: knots(:)
    integer, intent(in) :: k
    type(curve_parts), intent(inout) :: parts
    real(rk) :: inverse
    integer :: row
    row = row_below(knots, parts%measure(k), max(1, parts%row(k)))
    parts%row(k) = row
    parts%start(k) = knots(row)
    parts%finish(k) = no_knot
    parts%nominal(k) = curve%strength(row)
    parts%damage(k) = curve%damage(row)
    parts%nominal_slope(k) = 0.0_rk
    parts%damage_slope(k) = 0.0_rk
    if (row == size(knots)) return
    inverse = 1.0_rk/(knots(row + 1) - knots(row))
    parts%finish(k) = knots(row + 1)
    parts%nominal_slope(k) = (curve%strength(row + 1) - curve%strength(row))*inverse
    parts%damage_slope(k) = (curve%damage(row + 1) - curve%damage(row))*inverse
  end subroutine take_part

  !> Effective strengths and their slopes.
  pure subroutine find_strengths(num_points, factor, parts)
    integer, intent(in) :: num_points
    real(rk), intent(in) :: factor(:) !< (points) of the strength
    type(curve_parts), intent(inout) :: parts
    real(rk) :: step, strength, inverse
    integer :: k
    !$omp simd private(step, strength, inverse)
    do k = 1, num_points
      step = parts%measure(k) - parts%start(k)
      strength = parts%nominal(k) + parts%nominal_slope(k)*step
      inverse = 1.0_rk/(1.0_rk - (parts%damage(k) + parts%damage_slope(k)*step))
      parts%strength(k) = strength*factor(k)*inverse
      parts%strength_slope(k) = (parts%nominal_slope(k) &
                                 + strength*inverse*parts%damage_slope(k))*factor(k)*inverse
    end do
  end subroutine find_strengths

  !> The strength in tension with RECOVERY=ENERGY and its slope (see tension_at of damage_split).
  pure subroutine add_lateral_tension(model, num_points, parts)
    type(concrete_model), intent(in) :: model
    integer, intent(in) :: num_points
    type(curve_parts), intent(inout) :: parts !< with the strengths of the curve
    real(rk) :: c, soft, weight, rate, a, b, own, own_rate, axial, axial_rate, k, k_rate, inverse
    integer :: i
    c = 2.0_rk*model%poisson**2/(1.0_rk - model%poisson)
    soft = 1.0_rk - model%compression_recovery
    weight = model%poisson/(1.0_rk - model%poisson)*(1.0_rk - 2.0_rk*model%alpha) &
             /((1.0_rk - model%alpha)*model%compression%strength(1))
    !$omp simd private(rate, a, b, own, own_rate, axial, axial_rate, k, k_rate, inverse)
    do i = 1, num_points
      rate = parts%damage_slope(i)
      a = 1.0_rk - (parts%damage(i) + rate*(parts%measure(i) - parts%start(i)))
      b = 1.0_rk - soft*(1.0_rk - a)
      own = (1.0_rk - c)*a*b/(b - c*a) ! left_t of left_after; left_c is b
      own_rate = -own**2/(1.0_rk - c)*(1.0_rk/a**2 - c*soft/b**2)*rate
      axial = parts%strength(i)*a/own
      axial_rate = (parts%strength_slope(i)*a - parts%strength(i)*rate - axial*own_rate)/own
      k = weight*(1.0_rk - own/b)
      k_rate = -weight*(own*soft*rate/b + own_rate)/b
      inverse = 1.0_rk/(1.0_rk + k*axial)
      parts%strength(i) = axial*inverse
      parts%strength_slope(i) = (axial_rate - axial**2*k_rate)*inverse**2
    end do
  end subroutine add_lateral_tension

  !> F of Eqs. 19-23 and its derivative by x (see yield_at).
  pure subroutine find_residuals(model, b)
    type(concrete_model), intent(in) :: model
    type(flow_block), intent(inout) :: b
    real(rk) :: scale, by_p, growth, ratio, beta, opens, by_compression
    integer :: k
    scale = 1.0_rk/(1.0_rk - model%alpha)
    by_p = -3.0_rk*model%alpha*scale
    growth = model%bulk*model%tan_dilation
    call find_strengths(b%num_points, b%factor, b%tension)
    if (model%splits_energy) call add_lateral_tension(model, b%num_points, b%tension)
    call find_strengths(b%num_points, whole_strength, b%compression)
    associate (t => b%tension, c => b%compression)
      !$omp simd private(ratio, beta, opens, by_compression)
      do k = 1, b%num_points
        ratio = c%strength(k)/t%strength(k)
        beta = ratio*(1.0_rk - model%alpha) - (1.0_rk + model%alpha)
        opens = merge(1.0_rk, 0.0_rk, b%largest(k) > 0.0_rk .and. beta > 0.0_rk)
        b%by_largest(k) = scale*merge(max(beta, 0.0_rk), model%gamma, b%largest(k) > 0.0_rk)
        b%by_tension(k) = -opens*ratio/t%strength(k)*b%largest(k)
        by_compression = opens*b%largest(k)/t%strength(k) - 1.0_rk
        b%f(k) = scale*b%q(k) + by_p*b%p(k) - c%strength(k) + b%by_largest(k)*b%largest(k)
        b%f_rate(k) = scale*b%q_rate(k) + by_p*growth + b%by_largest(k)*b%largest_rate(k) &
                      + b%by_tension(k)*t%strength_slope(k)*t%measure_rate(k) &
                      + by_compression*c%strength_slope(k)*c%measure_rate(k)
      end do
    end associate
  end subroutine find_residuals

  !> Keeps some points, with their trial states and parts of curves; the flow is lost.
  pure subroutine keep_flows(list, b)
    integer, intent(in) :: list(:) !< ascending positions in the block
    type(flow_block), intent(inout) :: b
    b%num_points = size(list)
    b%place(:size(list)) = b%place(list)
    call keep_values(list, b%width)
    call keep_values(list, b%factor)
    call keep_values(list, b%rounding)
    call keep_values(list, b%q_trial)
    call keep_values(list, b%p_trial)
    call keep_values(list, b%shape1)
    call keep_values(list, b%shape2)
    call keep_values(list, b%shape3)
    call keep_values(list, b%cracking)
    call keep_values(list, b%crushing)
    call keep_values(list, b%y)
    call keep_parts(list, b%tension)
    call keep_parts(list, b%compression)
  end subroutine keep_flows

  !> Keeps parts of a curve.
  pure subroutine keep_parts(list, parts)
    integer, intent(in) :: list(:)
    type(curve_parts), intent(inout) :: parts
    parts%row(:size(list)) = parts%row(list)
    call keep_values(list, parts%start)
    call keep_values(list, parts%finish)
    call keep_values(list, parts%nominal)
    call keep_values(list, parts%nominal_slope)
    call keep_values(list, parts%damage)
    call keep_values(list, parts%damage_slope)
  end subroutine keep_parts

  !> Keeps values at ascending positions.
  pure subroutine keep_values(list, values)
    integer, intent(in) :: list(:)
    real(rk), intent(inout) :: values(:)
    integer :: k
    do k = 1, size(list)
      values(k) = values(list(k))
    end do
  end subroutine keep_values
end module damage_flows
