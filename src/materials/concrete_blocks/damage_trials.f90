!> Elastic states of blocks of points, in loops over the points that compilers turn into vector
!> operations.
!>
!> Virgin points, which are most points of a dam, have a cheap elastic check. Principal stresses
!> cost more than all other operations at an elastic point; an upper bound of the largest one is
!> enough: s_1 = -p + 2/3 q cos(theta), cos(3 theta) = x = 27/2 J_3/q^3, and cos(acos(x)/3) <=
!> min(1, 1/2 + sqrt((1 + x)/6)), exact in uniaxial tension and compression.
!>
!> Trial states of the other points have their principal values: those of a deviator with q = 1 are
!> 2/3 cos(theta) and 2/3 cos(theta -/+ 120 deg). c = cos(theta) is the root of 4 c^3 - 3 c = x in
!> [1/2, 1]. From the bound above Newton's iterates decrease to it; where |x| < 0.9 four of them
!> have all digits (an error of 0.06 at most becomes 6e-3, 4e-5, 3e-9, 1e-17).
!>
!> Else two values are near to each other, and x has lost digits of their difference. The sine s of
!> the angle to the nearer axis, theta or 60 deg - theta, is then the root of 3 s - 4 s^3 = y, with
!> y = sin(3 theta) from a sum of squares that loses none: for the discriminant, 4/27 y^2, is three
!> times that of all (S_i T_j - S_j T_i)^2, i < j, with T the deviator of S^2 (the Gram determinant
!> of 1, S, S^2). From y/3 + 4/81 y^3 three of Newton's steps have all digits
!> (y < 0.44; an error of 4e-4 at most becomes 1e-7, 5e-15).
module damage_trials
  use damage_model, only: concrete_model
  use kinds, only: rk
  implicit none
  private
  public :: screen_points, trial_block, find_trials

  integer, parameter :: num_steps = 4 !< of Newton's method for c
  real(rk), parameter :: safe_cosine = 0.9_rk !< limit of |x|
  real(rk), parameter :: half_root = sqrt(0.75_rk) !< sin(120 deg)

  !> Trial states.
  type :: trial_block
    real(rk), allocatable :: q(:), p(:) !< (points) [Pa]
    real(rk), allocatable :: deviator(:, :) !< (6, points) over q
    real(rk), allocatable :: shape(:, :) !< (3, points) its principal values, the largest first
  end type trial_block

contains

  !> Elastic stress and energy of virgin points, and whether they are certainly elastic.
  pure subroutine screen_points(model, factor, strain, stress, energy, is_within)
    type(concrete_model), intent(in) :: model
    !> (points) The least one of the strength in tension, that of the widest band (see place_knots)
    real(rk), intent(in) :: factor(:)
    real(rk), intent(in), contiguous :: strain(:, :) !< (6, points)
    real(rk), intent(inout), contiguous :: stress(:, :) !< (6, points) [Pa]
    real(rk), intent(out) :: energy(:) !< (points) stored [J/m3]
    logical, intent(out) :: is_within(:) !< (points) inside the virgin surface; false: unknown
    real(rk) :: lame, shear, volume, p, s1, s2, s3, square, third, q, largest, excess
    real(rk) :: slope, limit
    integer :: i
    lame = model%bulk - 2.0_rk/3.0_rk*model%shear
    shear = model%shear
    limit = (1.0_rk - model%alpha)*model%compression%strength(1)
    !$omp simd private(volume, p, s1, s2, s3, square, third, q, largest, excess, slope)
    do i = 1, size(strain, 2)
      volume = strain(1, i) + strain(2, i) + strain(3, i)
      stress(1, i) = lame*volume + 2.0_rk*shear*strain(1, i)
      stress(2, i) = lame*volume + 2.0_rk*shear*strain(2, i)
      stress(3, i) = lame*volume + 2.0_rk*shear*strain(3, i)
      stress(4, i) = shear*strain(4, i)
      stress(5, i) = shear*strain(5, i)
      stress(6, i) = shear*strain(6, i)
      p = -model%bulk*volume
      s1 = stress(1, i) + p
      s2 = stress(2, i) + p
      s3 = stress(3, i) + p
      square = 0.5_rk*(s1**2 + s2**2 + s3**2) &
               + stress(4, i)**2 + stress(5, i)**2 + stress(6, i)**2
      third = s1*(s2*s3 - stress(6, i)**2) - s2*stress(5, i)**2 - s3*stress(4, i)**2 &
              + 2.0_rk*stress(4, i)*stress(5, i)*stress(6, i)
      energy(i) = 0.5_rk*square/shear + 0.5_rk*model%bulk*volume**2
      q = sqrt(3.0_rk*square)
      excess = max(0.0_rk, 1.0_rk + 13.5_rk*third/(q**3 + tiny(q)))
      largest = 2.0_rk/3.0_rk*q*min(1.0_rk, 0.5_rk + sqrt(excess/6.0_rk)) - p
      ! beta of Eq. 23, not negative by the checks of the tables.
      slope = limit/(factor(i)*model%tension%strength(1)) - (1.0_rk + model%alpha)
      is_within(i) = q - 3.0_rk*model%alpha*p + slope*max(0.0_rk, largest) &
                     - model%gamma*max(0.0_rk, -largest) <= limit
    end do
  end subroutine screen_points

  !> Trial states of the points of a list.
  pure subroutine find_trials(model, points, strain, internal, trials)
    type(concrete_model), intent(in) :: model
    integer, intent(in) :: points(:)
    real(rk), intent(in), contiguous :: strain(:, :) !< (6, all points)
    real(rk), intent(in), contiguous :: internal(:, :) !< (1-6: plastic strain, all points)
    type(trial_block), intent(out) :: trials
    real(rk) :: cosine(size(points))
    integer :: k, n, near(size(points)), num_near
    n = size(points)
    allocate (trials%q(n), trials%p(n), trials%deviator(6, n), trials%shape(3, n))
    call find_deviators(model, points, strain, internal, trials%p, trials%q, trials%deviator)
    call find_cosines(trials%deviator, cosine)
    call find_shapes(cosine, trials%shape)
    num_near = 0
    do k = 1, n
      if (abs(cosine(k)) < safe_cosine) cycle
      num_near = num_near + 1
      near(num_near) = k
    end do
    call find_near_shapes(near(:num_near), trials%deviator, cosine, trials%shape)
    do k = 1, n
      if (.not. trials%q(k) > tiny(1.0_rk)) trials%shape(:, k) = 0.0_rk
    end do
  end subroutine find_trials

  !> Pressure, q, and S/q.
  pure subroutine find_deviators(model, points, strain, internal, p, q, deviator)
    type(concrete_model), intent(in) :: model
    integer, intent(in) :: points(:)
    real(rk), intent(in), contiguous :: strain(:, :), internal(:, :)
    real(rk), intent(out), contiguous :: p(:), q(:), deviator(:, :)
    real(rk) :: lame, shear, mean, s1, s2, s3, s4, s5, s6, inverse
    integer :: k, i
    lame = model%bulk - 2.0_rk/3.0_rk*model%shear
    shear = model%shear
    !$omp simd private(i, mean, s1, s2, s3, s4, s5, s6, inverse)
    do k = 1, size(points)
      i = points(k)
      s1 = strain(1, i) - internal(1, i)
      s2 = strain(2, i) - internal(2, i)
      s3 = strain(3, i) - internal(3, i)
      s4 = shear*(strain(4, i) - internal(4, i))
      s5 = shear*(strain(5, i) - internal(5, i))
      s6 = shear*(strain(6, i) - internal(6, i))
      mean = lame*(s1 + s2 + s3)
      s1 = 2.0_rk*shear*s1 + mean
      s2 = 2.0_rk*shear*s2 + mean
      s3 = 2.0_rk*shear*s3 + mean
      p(k) = -(s1 + s2 + s3)/3.0_rk
      s1 = s1 + p(k)
      s2 = s2 + p(k)
      s3 = s3 + p(k)
      ! The trace is then zero to round-off of the deviator: see deviator_of.
      mean = (s1 + s2 + s3)/3.0_rk
      s1 = s1 - mean
      s2 = s2 - mean
      s3 = s3 - mean
      q(k) = sqrt(0.5_rk*((s1 - s2)**2 + (s2 - s3)**2 + (s3 - s1)**2) &
                  + 3.0_rk*(s4**2 + s5**2 + s6**2))
      inverse = 1.0_rk/max(q(k), tiny(mean))
      deviator(1, k) = s1*inverse
      deviator(2, k) = s2*inverse
      deviator(3, k) = s3*inverse
      deviator(4, k) = s4*inverse
      deviator(5, k) = s5*inverse
      deviator(6, k) = s6*inverse
    end do
  end subroutine find_deviators

  !> x = 27/2 J_3, between -1 and 1 but for round-off.
  pure subroutine find_cosines(s, x)
    real(rk), intent(in), contiguous :: s(:, :) !< (6, points) deviators with q = 1
    real(rk), intent(out), contiguous :: x(:) !< (points)
    integer :: k
    !$omp simd
    do k = 1, size(x)
      x(k) = 13.5_rk*(s(1, k)*(s(2, k)*s(3, k) - s(6, k)**2) - s(2, k)*s(5, k)**2 &
                      - s(3, k)*s(4, k)**2 + 2.0_rk*s(4, k)*s(5, k)*s(6, k))
    end do
  end subroutine find_cosines

  !> Principal values, exact to round-off for |x| < safe_cosine.
  pure subroutine find_shapes(x, shape)
    real(rk), intent(in), contiguous :: x(:) !< (points)
    real(rk), intent(out), contiguous :: shape(:, :) !< (3, points)
    real(rk) :: c, sine
    integer :: k, i
    !$omp simd private(c, sine, i)
    do k = 1, size(x)
      c = min(1.0_rk, 0.5_rk + sqrt(max(0.0_rk, 1.0_rk + x(k))/6.0_rk))
      do i = 1, num_steps
        c = (8.0_rk*c**3 + x(k))/max(1.0_rk, 12.0_rk*c**2 - 3.0_rk) ! > 1 where it counts
      end do
      sine = half_root*sqrt(max(0.0_rk, (1.0_rk - c)*(1.0_rk + c)))
      shape(1, k) = 2.0_rk/3.0_rk*c
      shape(2, k) = 2.0_rk/3.0_rk*(sine - 0.5_rk*c)
      shape(3, k) = -2.0_rk/3.0_rk*(sine + 0.5_rk*c)
    end do
  end subroutine find_shapes

  !> Principal values of deviators of which two are near to each other.
  pure subroutine find_near_shapes(list, deviator, x, shape)
    integer, intent(in) :: list(:)
    real(rk), intent(in), contiguous :: deviator(:, :) !< (6, points) with q = 1
    real(rk), intent(in), contiguous :: x(:) !< (points) cos(3 theta)
    real(rk), intent(inout), contiguous :: shape(:, :) !< (3, points)
    real(rk) :: d(size(list), 6), values(size(list), 3), turn(size(list)), y, s, c, part
    integer :: k
    do k = 1, size(list)
      d(k, :) = deviator(:, list(k))
      turn(k) = sign(1.0_rk, x(list(k)))
    end do
    !$omp simd private(y, s, c, part)
    do k = 1, size(list)
      y = 4.5_rk*sqrt(sum_of_squares(d(k, 1), d(k, 2), d(k, 3), d(k, 4), d(k, 5), d(k, 6)))
      s = y*(1.0_rk/3.0_rk + 4.0_rk/81.0_rk*y**2)
      s = (y - 8.0_rk*s**3)/(3.0_rk - 12.0_rk*s**2)
      s = (y - 8.0_rk*s**3)/(3.0_rk - 12.0_rk*s**2)
      s = (y - 8.0_rk*s**3)/(3.0_rk - 12.0_rk*s**2)
      c = 1.0_rk/3.0_rk*sqrt((1.0_rk - s)*(1.0_rk + s))
      part = 2.0_rk/3.0_rk*half_root*s
      values(k, 1) = merge(2.0_rk*c, c + part, turn(k) > 0.0_rk)
      values(k, 2) = turn(k)*(part - c)
      values(k, 3) = merge(-c - part, -2.0_rk*c, turn(k) > 0.0_rk)
    end do
    do k = 1, size(list)
      shape(:, list(k)) = values(k, :)
    end do
  end subroutine find_near_shapes

  !> sum (S_i T_j - S_j T_i)^2 over pairs of components of a tensor with nine components, T being
  !> the deviator of S^2.
  pure real(rk) function sum_of_squares(s1, s2, s3, s4, s5, s6) result(whole)
    real(rk), intent(in) :: s1, s2, s3, s4, s5, s6 !< with q = 1
    real(rk) :: t1, t2, t3, t4, t5, t6, mean
    t1 = s1**2 + s4**2 + s5**2
    t2 = s4**2 + s2**2 + s6**2
    t3 = s5**2 + s6**2 + s3**2
    mean = (t1 + t2 + t3)/3.0_rk
    t1 = t1 - mean
    t2 = t2 - mean
    t3 = t3 - mean
    t4 = s1*s4 + s4*s2 + s5*s6
    t5 = s1*s5 + s4*s6 + s5*s3
    t6 = s4*s5 + s2*s6 + s6*s3
    whole = (s1*t2 - s2*t1)**2 + (s1*t3 - s3*t1)**2 + (s2*t3 - s3*t2)**2 &
            + 2.0_rk*((s1*t4 - s4*t1)**2 + (s1*t5 - s5*t1)**2 + (s1*t6 - s6*t1)**2 &
                      + (s2*t4 - s4*t2)**2 + (s2*t5 - s5*t2)**2 + (s2*t6 - s6*t2)**2 &
                      + (s3*t4 - s4*t3)**2 + (s3*t5 - s5*t3)**2 + (s3*t6 - s6*t3)**2) &
            + 4.0_rk*((s4*t5 - s5*t4)**2 + (s4*t6 - s6*t4)**2 + (s5*t6 - s6*t5)**2)
  end function sum_of_squares
end module damage_trials
