!> Return maps of points side by side: the search of `find_flow` (damage_return) for the flow that
!> ends on the yield surface, with the same samples, steps and tolerances.
!>
!> Each round evaluates all points of the block; those that have arrived leave it. A point that does
!> not arrive is left to the procedure for one point.
module flow_search
  use damage_flows, only: find_kinematics, find_parts, find_residuals, flow_block, keep_flows, &
                          keep_values, most_points, no_knot
  use damage_model, only: concrete_model, placed_curves
  use damage_return, only: acceptable, largest_bend, overshoot, tolerance
  use kinds, only: rk
  implicit none
  private
  public :: flow_ends, find_flows

  integer, parameter :: max_rounds = 40 !< few points need more
  real(rk), parameter :: crowded = 0.75_rk !< share of points under way with which a block stays

  !> Kinds of samples: F increases; F decreases; F t/c decreases.
  real(rk), parameter :: rises = 0.0_rk, falls = 1.0_rk, falls_scaled = 2.0_rk

  !> Ends of return maps, by the place of the point.
  type :: flow_ends
    logical :: has_converged(most_points)
    real(rk), dimension(most_points) :: x, q, p, radius, share, kappa_t, kappa_c, d_t, d_c, width
  end type flow_ends

  !> Brackets of the root in y, and a function with the root of F, nearly linear in x, at x.
  type :: search_block
    logical :: is_open(most_points) !< under way
    real(rk), dimension(most_points) :: low, high !< F > 0, F < 0; a negative high: none yet
    real(rk), dimension(most_points) :: size_before !< |F| of the last evaluation [Pa]
    real(rk), dimension(most_points) :: x, value, slope, kind !< of this evaluation; dx/dvalue
    real(rk), dimension(most_points) :: last_x, last_value, last_slope, last_kind
    real(rk), dimension(most_points) :: root !< x of the root by both samples
  end type search_block

contains

  !> Finds the flow at all points of a block.
  pure subroutine find_flows(model, placed, b, ends)
    type(concrete_model), intent(in) :: model
    type(placed_curves), intent(inout) :: placed
    type(flow_block), intent(inout) :: b !< with trial states and parts of curves; is consumed
    type(flow_ends), intent(inout) :: ends
    type(search_block) :: search
    integer :: round, n
    n = b%num_points
    b%y(:n) = 0.0_rk
    b%is_same_part(:n) = .false.
    search%is_open(:n) = .true.
    search%low(:n) = 0.0_rk
    search%high(:n) = -1.0_rk
    search%size_before(:n) = huge(1.0_rk)
    search%x(:n) = 0.0_rk
    search%value(:n) = 0.0_rk
    search%slope(:n) = 0.0_rk
    search%kind(:n) = rises
    do round = 1, max_rounds
      call find_kinematics(model, b)
      if (round > 1) call find_parts(model, placed, b)
      call find_residuals(model, b)
      call take_ends(b, search, ends)
      n = count(search%is_open(:b%num_points))
      if (n == 0) return
      call take_samples(b, search)
      call find_roots(b, search)
      call choose_steps(model, b, search)
      if (n < crowded*b%num_points) call close_ranks(b, search)
    end do
  end subroutine find_flows

  !> Takes the flow of points where |F| is admissible: a fraction of the strength in compression, or
  !> round-off of the trial state, but at most the acceptable value.
  pure subroutine take_ends(b, search, ends)
    type(flow_block), intent(in) :: b
    type(search_block), intent(inout) :: search
    type(flow_ends), intent(inout) :: ends
    real(rk) :: limit(most_points)
    integer :: k, i
    associate (c => b%compression, t => b%tension)
      !$omp simd
      do k = 1, b%num_points
        limit(k) = epsilon(1.0_rk)*(1.0_rk + b%by_largest(k))*(b%q_trial(k) + abs(b%p_trial(k)))
        limit(k) = min(max(limit(k), tolerance*c%strength(k)), acceptable*c%strength(k))
      end do
      do k = 1, b%num_points
        if (.not. search%is_open(k) .or. .not. abs(b%f(k)) <= limit(k)) cycle
        search%is_open(k) = .false.
        i = b%place(k)
        ends%has_converged(i) = .true.
        ends%x(i) = b%x(k)
        ends%q(i) = b%q(k)
        ends%p(i) = b%p(k)
        ends%radius(i) = b%radius(k)
        ends%share(i) = b%share(k)
        ends%kappa_t(i) = t%measure(k)
        ends%kappa_c(i) = c%measure(k)
        ends%d_t(i) = t%damage(k) + t%damage_slope(k)*(t%measure(k) - t%start(k))
        ends%d_c(i) = c%damage(k) + c%damage_slope(k)*(c%measure(k) - c%start(k))
      end do
    end associate
  end subroutine take_ends

  !> Samples of F, or of F t/c (see sample_of).
  pure subroutine take_samples(b, search)
    type(flow_block), intent(in) :: b
    type(search_block), intent(inout) :: search
    real(rk) :: ratio, scaled, rate, does_fall, is_scaled
    integer :: k
    associate (s => search, t => b%tension, c => b%compression)
      !$omp simd
      do k = 1, b%num_points
        s%last_x(k) = s%x(k)
        s%last_value(k) = s%value(k)
        s%last_slope(k) = s%slope(k)
        s%last_kind(k) = s%kind(k)
      end do
      !$omp simd private(ratio, scaled, rate, does_fall, is_scaled)
      do k = 1, b%num_points
        s%x(k) = b%x(k)
        ratio = t%strength(k)/c%strength(k)
        scaled = b%f_rate(k) + b%f(k)*(t%strength_slope(k)*t%measure_rate(k)/t%strength(k) &
                                       - c%strength_slope(k)*c%measure_rate(k)/c%strength(k))
        does_fall = one_below(b%f_rate(k))
        is_scaled = does_fall*one_below(b%by_tension(k))*one_below(scaled)
        rate = merge(b%f_rate(k), -1.0_rk, does_fall > 0.5_rk)
        rate = merge(scaled*ratio, rate, is_scaled > 0.5_rk)
        s%slope(k) = 1.0_rk/rate
        s%value(k) = b%f(k)*merge(ratio, 1.0_rk, is_scaled > 0.5_rk)
        s%kind(k) = does_fall + is_scaled
      end do
    end associate
  end subroutine take_samples

  !> Roots of the cubic polynomials x(value) through two samples, or Newton's steps (see root_near).
  pure subroutine find_roots(b, search)
    type(flow_block), intent(in) :: b
    type(search_block), intent(inout) :: search
    real(rk) :: same(most_points), step, gap, chord, bend, has_two
    integer :: k
    do k = 1, b%num_points
      same(k) = merge(1.0_rk, 0.0_rk, b%is_same_part(k))
    end do
    associate (s => search)
      !$omp simd private(step, gap, chord, bend, has_two)
      do k = 1, b%num_points
        step = -s%value(k)*s%slope(k)
        gap = s%last_value(k) - s%value(k)
        has_two = same(k)*one_below(rises - s%kind(k))*one_below(abs(s%value(k)) - abs(gap)) &
                  *one_below(abs(s%kind(k) - s%last_kind(k)) - 0.5_rk)
        gap = merge(gap, 1.0_rk, has_two > 0.5_rk)
        chord = (s%last_x(k) - s%x(k))/gap
        bend = (s%value(k)/gap)**2*((chord - s%slope(k))*gap - (s%last_slope(k) - 2.0_rk*chord &
                                                                + s%slope(k))*s%last_value(k))
        bend = has_two*bend
        bend = merge(bend, 0.0_rk, abs(bend) <= largest_bend*abs(step))
        s%root(k) = merge(s%x(k) + step + bend, no_knot, s%kind(k) > rises)
      end do
    end associate
  end subroutine find_roots

  !> Next y: up to a root or to the next knot of a curve while F has been positive; within the
  !> bracket after that, by bisection where |F| has not become half (see find_flow). A point that
  !> cannot move is left to find_flow, which sees the same.
  pure subroutine choose_steps(model, b, search)
    type(concrete_model), intent(in) :: model
    type(flow_block), intent(inout) :: b
    type(search_block), intent(inout) :: search
    real(rk) :: stiffness, limit(most_points), x, y, middle, inside, fast, outside, low, high
    integer :: k
    stiffness = 3.0_rk*model%shear + model%bulk*model%tan_dilation
    call limit_steps(b, limit)
    associate (s => search)
      !$omp simd private(x, y, middle, inside, fast, outside, low, high)
      do k = 1, b%num_points
        low = merge(b%y(k), s%low(k), b%f(k) > 0.0_rk)
        high = merge(s%high(k), b%y(k), b%f(k) > 0.0_rk)
        inside = 1.0_rk - one_below(high)
        fast = one_below(rises - s%kind(k))*one_below(abs(b%f(k)) - 0.5_rk*s%size_before(k))
        x = min(s%root(k), limit(k) + inside*no_knot)
        x = merge(2.0_rk*b%x(k) + b%f(k)/stiffness, x, x >= no_knot)
        y = x/max(b%rounding(k), b%radius(k) + b%q(k)*b%q_rate(k)/b%radius(k)*(x - b%x(k)))
        y = merge(low, y, inside*(1.0_rk - fast) > 0.5_rk)
        middle = 0.5_rk*(low + high)
        outside = 1.0_rk - one_below(low - y)*one_below(y - high)
        y = merge(middle, y, inside*outside > 0.5_rk)
        s%size_before(k) = abs(b%f(k))
        s%low(k) = low
        s%high(k) = high
        b%y(k) = y
      end do
    end associate
    do k = 1, b%num_points
      if (b%y(k) <= search%low(k)) search%is_open(k) = .false.
      if (search%high(k) >= 0.0_rk .and. b%y(k) >= search%high(k)) search%is_open(k) = .false.
    end do
  end subroutine choose_steps

  !> x of the next knot of a curve.
  pure subroutine limit_steps(b, limit)
    type(flow_block), intent(in) :: b
    real(rk), intent(out) :: limit(:) !< (points)
    real(rk), parameter :: smallest = tiny(1.0_rk)**0.25_rk
    real(rk) :: gap_t, gap_c, rate_t, rate_c, to_t, to_c
    logical :: meets_t, meets_c
    integer :: k
    associate (t => b%tension, c => b%compression)
      !$omp simd private(gap_t, gap_c, rate_t, rate_c, to_t, to_c, meets_t, meets_c)
      do k = 1, b%num_points
        rate_t = t%measure_rate(k)
        rate_c = c%measure_rate(k)
        gap_t = t%finish(k) - t%measure(k) + overshoot*(t%finish(k) - t%start(k))
        gap_c = c%finish(k) - c%measure(k) + overshoot*(c%finish(k) - c%start(k))
        meets_t = rate_t > gap_t*smallest .and. t%finish(k) < no_knot
        meets_c = rate_c > gap_c*smallest .and. c%finish(k) < no_knot
        to_t = merge(gap_t/merge(rate_t, 1.0_rk, meets_t), no_knot, meets_t)
        to_c = merge(gap_c/merge(rate_c, 1.0_rk, meets_c), no_knot, meets_c)
        limit(k) = b%x(k) + min(to_t, to_c)
      end do
    end associate
  end subroutine limit_steps

  !> 1 below zero, else 0: a condition that compilers do not turn into a branch.
  pure real(rk) function one_below(value)
    real(rk), intent(in) :: value
    one_below = 0.5_rk - sign(0.5_rk, value + tiny(value)) ! -0 is not below
  end function one_below

  !> Keeps the points under way alone.
  pure subroutine close_ranks(b, search)
    type(flow_block), intent(inout) :: b
    type(search_block), intent(inout) :: search
    integer :: list(most_points), n, k
    n = 0
    do k = 1, b%num_points
      if (.not. search%is_open(k)) cycle
      n = n + 1
      list(n) = k
    end do
    call keep_flows(list(:n), b)
    associate (s => search)
      s%is_open(:n) = .true.
      call keep_values(list(:n), s%low)
      call keep_values(list(:n), s%high)
      call keep_values(list(:n), s%size_before)
      call keep_values(list(:n), s%x)
      call keep_values(list(:n), s%value)
      call keep_values(list(:n), s%slope)
      call keep_values(list(:n), s%kind)
    end associate
  end subroutine close_ranks
end module flow_search
