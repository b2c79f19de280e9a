!> Symmetric tensors as six numbers, ordered 11 22 33 12 13 23; shear components are those of the
!> tensor (stress), not engineering shear.
module tensor6
  use kinds, only: rk
  use small_matrix, only: cross_product
  implicit none
  private
  public :: trace, second_invariant, third_invariant, von_mises, principal_values, principal_axes
  public :: find_principal_values
  public :: as_matrix, sum_tensors

  real(rk), parameter :: sin_of_third = sqrt(0.75_rk) !< of a turn
  integer, parameter :: at_once = 128 !< tensors whose numbers stay in the nearest cache
  real(rk), parameter :: safe_cosine = 0.99_rk !< below, 1 - c**2 of its third loses one digit
  real(rk), parameter :: smallest_j2 = 1.0e-180_rk !< below, third powers of stresses lose digits
  real(rk), parameter :: largest_j2 = 1.0e180_rk !< above, third powers overflow

contains

  !> Sum of the direct components.
  pure real(rk) function trace(t)
    real(rk), intent(in) :: t(6)
    trace = t(1) + t(2) + t(3)
  end function trace

  !> J2 = s:s/2 of the deviator s.
  pure real(rk) function second_invariant(t) result(j2)
    real(rk), intent(in) :: t(6)
    j2 = ((t(1) - t(2))**2 + (t(2) - t(3))**2 + (t(3) - t(1))**2)/6.0_rk + sum(t(4:6)**2)
  end function second_invariant

  !> J3 = det s of the deviator s.
  pure real(rk) function third_invariant(t) result(j3)
    real(rk), intent(in) :: t(6)
    real(rk) :: s(3)
    s = t(1:3) - trace(t)/3.0_rk
    j3 = s(1)*s(2)*s(3) + 2.0_rk*t(4)*t(5)*t(6) - s(1)*t(6)**2 - s(2)*t(5)**2 - s(3)*t(4)**2
  end function third_invariant

  !> Equivalent stress of von Mises.
  pure real(rk) function von_mises(t)
    real(rk), intent(in) :: t(6)
    von_mises = sqrt(3.0_rk*second_invariant(t))
  end function von_mises

  !> The tensor as a 3 x 3 matrix.
  pure function as_matrix(t) result(matrix)
    real(rk), intent(in) :: t(6)
    real(rk) :: matrix(3, 3)
    matrix(:, 1) = t([1, 4, 5])
    matrix(:, 2) = t([4, 2, 6])
    matrix(:, 3) = t([5, 6, 3])
  end function as_matrix

  !> Sums of tensors, each with its own factors: tensors times factors.
  pure subroutine sum_tensors(num_tensors, tensors, factors, num_sums, sums)
    integer, intent(in) :: num_tensors, num_sums
    real(rk), intent(in) :: tensors(6, num_tensors)
    real(rk), intent(in) :: factors(num_tensors, num_sums)
    real(rk), intent(out) :: sums(6, num_sums)
    real(rk) :: own(6)
    integer :: i, k
    do k = 1, num_sums
      own = 0.0_rk
      do i = 1, num_tensors
        own = own + factors(i, k)*tensors(:, i)
      end do
      sums(:, k) = own
    end do
  end subroutine sum_tensors

  !> Principal values, the largest first; accurate to roundoff also where values coincide.
  !>
  !> Well separated values come from the Lode angle alone, the others from `values_from_plane`.
  pure function principal_values(t) result(values)
    real(rk), intent(in) :: t(6)
    real(rk) :: values(3)
    real(rk) :: mean, j2, radius, cosine, third, single, half
    mean = trace(t)/3.0_rk
    j2 = second_invariant(t)
    cosine = 1.0_rk
    if (j2 > smallest_j2 .and. j2 < largest_j2) then
      radius = 2.0_rk*sqrt(j2/3.0_rk)
      cosine = 4.0_rk*third_invariant(t)/radius**3
    end if
    if (abs(cosine) < safe_cosine) then
      third = cosine_of_third(abs(cosine))
      single = sign(radius*third, cosine)
      half = sin_of_third*radius*sqrt(1.0_rk - third**2)
      values(1) = mean + max(single, half - 0.5_rk*single)
      values(2) = mean - 0.5_rk*single - sign(half, -cosine)
      values(3) = mean + min(single, -half - 0.5_rk*single)
    else
      values = values_from_plane(t)
    end if
  end function principal_values

  !> Principal values of many tensors: the numbers of `principal_values`, by a loop that the
  !> compiler turns into operations on several tensors at once.
  pure subroutine find_principal_values(num_tensors, tensors, values)
    integer, intent(in) :: num_tensors
    real(rk), intent(in) :: tensors(6, num_tensors)
    real(rk), intent(out) :: values(3, num_tensors) !< the largest first
    real(rk) :: turned(at_once, 6), found(at_once, 3), cosine(at_once)
    integer :: i, j, k, n
    do k = 0, num_tensors - 1, at_once
      n = min(at_once, num_tensors - k)
      do i = 1, n
        do j = 1, 6
          turned(i, j) = tensors(j, k + i)
        end do
      end do
      call take_lode_angles(n, turned, found, cosine)
      do i = 1, n
        if (abs(cosine(i)) < safe_cosine) then
          values(:, k + i) = found(i, :)
        else
          values(:, k + i) = values_from_plane(tensors(:, k + i))
        end if
      end do
    end do
  end subroutine find_principal_values

  !> Principal values from the Lode angle, as in `principal_values`; a cosine of 1 where they are
  !> not to be used.
  pure subroutine take_lode_angles(n, t, values, cosine)
    integer, intent(in) :: n
    real(rk), intent(in) :: t(at_once, 6) !< n tensors
    real(rk), intent(out) :: values(at_once, 3), cosine(at_once) !< of n tensors
    real(rk) :: mean, j2, j3, s1, s2, s3, radius, third, single, half, one
    integer :: i
    do i = 1, n
      mean = (t(i, 1) + t(i, 2) + t(i, 3))/3.0_rk
      j2 = ((t(i, 1) - t(i, 2))**2 + (t(i, 2) - t(i, 3))**2 + (t(i, 3) - t(i, 1))**2)/6.0_rk &
           + (t(i, 4)**2 + t(i, 5)**2 + t(i, 6)**2)
      one = merge(1.0_rk, 0.0_rk, j2 > smallest_j2 .and. j2 < largest_j2) ! third powers overflow
      s1 = one*(t(i, 1) - mean)
      s2 = one*(t(i, 2) - mean)
      s3 = one*(t(i, 3) - mean)
      j3 = s1*s2*s3 + 2.0_rk*(one*t(i, 4))*(one*t(i, 5))*(one*t(i, 6)) &
           - s1*(one*t(i, 6))**2 - s2*(one*t(i, 5))**2 - s3*(one*t(i, 4))**2
      radius = 2.0_rk*sqrt(min(max(j2, smallest_j2), largest_j2)/3.0_rk)
      cosine(i) = merge(4.0_rk*j3/radius**3, 1.0_rk, one > 0.0_rk)
      third = cosine_of_third(min(abs(cosine(i)), 1.0_rk))
      single = sign(radius*third, cosine(i))
      half = sin_of_third*radius*sqrt(max(0.0_rk, 1.0_rk - third**2))
      values(i, 1) = mean + max(single, half - 0.5_rk*single)
      values(i, 2) = mean - 0.5_rk*single - sign(half, -cosine(i))
      values(i, 3) = mean + min(single, -half - 0.5_rk*single)
    end do
  end subroutine take_lode_angles

  !> Principal values, of which two may be close to each other, and all tiny or huge.
  !>
  !> Scherzinger and Dohrmann, Comput. Methods Appl. Mech. Engrg. 197 (2008) 4007-4015: the value
  !> farthest from the two others comes from the Lode angle, the two others from the 2 x 2 problem
  !> normal to its axis.
  pure function values_from_plane(t) result(values)
    real(rk), intent(in) :: t(6)
    real(rk) :: values(3)
    real(rk) :: mean, scale, s(6), single
    logical :: is_pressure
    call find_single_value(t, mean, scale, s, single, is_pressure)
    values = mean
    if (.not. is_pressure) values = mean + scale*values_around(s, single)
  end function values_from_plane

  !> The principal value of the deviator that is farthest from the two others.
  pure subroutine find_single_value(t, mean, scale, s, single, is_pressure)
    real(rk), intent(in) :: t(6)
    real(rk), intent(out) :: mean, scale !< t = mean + scale*s
    real(rk), intent(out) :: s(6) !< deviator, its largest component is 1
    real(rk), intent(out) :: single !< of s
    logical, intent(out) :: is_pressure !< there is no deviator but what the mean lost in rounding
    real(rk) :: j2, cosine
    mean = trace(t)/3.0_rk
    s(1:3) = t(1:3) - mean
    s(4:6) = t(4:6)
    scale = max(abs(s(1)), abs(s(2)), abs(s(3)), abs(s(4)), abs(s(5)), abs(s(6)))
    single = 0.0_rk
    is_pressure = scale < tiny(1.0_rk)
    if (is_pressure) return
    s = s/scale
    j2 = second_invariant(s)/3.0_rk
    is_pressure = j2 < epsilon(j2)**2
    if (is_pressure) return
    cosine = 0.5_rk*third_invariant(s)/(j2*sqrt(j2))
    single = sign(2.0_rk*sqrt(j2)*cosine_of_third(min(1.0_rk, abs(cosine))), cosine)
  end subroutine find_single_value

  !> cos(a/3) from cos(a) for a of 0 to 90 degrees: the root c of 4 c**3 - 3 c = cos(a) near 1.
  !> The cubic has an error below 5e-5, and a step of Newton squares it, times 1.7.
  elemental real(rk) function cosine_of_third(cosine) result(c)
    real(rk), intent(in) :: cosine !< 0 to 1
    c = 0.86607_rk + cosine*(0.16533_rk - cosine*(0.04069_rk - cosine*0.00932_rk))
    c = closer_third(closer_third(c, cosine), cosine)
  end function cosine_of_third

  !> A step of Newton to the root of 4 c**3 - 3 c = cos(a).
  elemental real(rk) function closer_third(c, cosine) result(closer)
    real(rk), intent(in) :: c, cosine
    closer = c - ((4.0_rk*c*c - 3.0_rk)*c - cosine)/(12.0_rk*c*c - 3.0_rk)
  end function closer_third

  !> Principal values, the largest first, and an orthonormal basis of principal directions; accurate
  !> to roundoff also where values coincide; the directions of equal values are then arbitrary.
  !>
  !> The value farthest from the two others comes from the Lode angle, the others and their
  !> directions from the 2 x 2 problem normal to its axis (as in `principal_values`).
  pure subroutine principal_axes(t, values, axes)
    real(rk), intent(in) :: t(6)
    real(rk), intent(out) :: values(3)
    real(rk), intent(out) :: axes(3, 3) !< columns in the order of the values
    real(rk) :: mean, scale, s(6), single, pair(2), plane(3, 2), columns(3, 3)
    logical :: is_pressure
    call find_single_value(t, mean, scale, s, single, is_pressure)
    values = mean
    axes = 0.0_rk
    axes(1, 1) = 1.0_rk
    axes(2, 2) = 1.0_rk
    axes(3, 3) = 1.0_rk
    if (is_pressure) return
    columns = as_matrix(s)
    call span_normal_plane(columns, single, plane(:, 1), plane(:, 2))
    call rotate_in_plane(columns, plane, pair)
    if (single > 0.0_rk) then
      values = mean + scale*[single, pair]
      axes(:, 1) = cross_product(plane(:, 1), plane(:, 2))
      axes(:, 2:3) = plane
    else
      values = mean + scale*[pair, single]
      axes(:, 1:2) = plane
      axes(:, 3) = cross_product(plane(:, 1), plane(:, 2))
    end if
  end subroutine principal_axes

  !> Rotates two axes in their plane to the principal directions of the tensor in this plane.
  pure subroutine rotate_in_plane(matrix, plane, pair)
    real(rk), intent(in) :: matrix(3, 3)
    real(rk), intent(inout) :: plane(3, 2) !< unit vectors normal to each other
    real(rk), intent(out) :: pair(2) !< principal values, the larger first
    real(rk) :: image(3), a, b, c, half, radius, cosine, sine, first(3)
    image = matrix(:, 1)*plane(1, 1) + matrix(:, 2)*plane(2, 1) + matrix(:, 3)*plane(3, 1)
    a = dot_product(plane(:, 1), image)
    image = matrix(:, 1)*plane(1, 2) + matrix(:, 2)*plane(2, 2) + matrix(:, 3)*plane(3, 2)
    b = dot_product(plane(:, 2), image)
    c = dot_product(plane(:, 1), image)
    half = 0.5_rk*(a - b)
    radius = sqrt(half**2 + c**2)
    pair = 0.5_rk*(a + b) + [radius, -radius]
    if (.not. radius > tiny(radius)) return
    if (half >= 0.0_rk) then
      cosine = sqrt(0.5_rk*(1.0_rk + half/radius))
      sine = 0.5_rk*c/(radius*cosine)
    else
      sine = sign(sqrt(0.5_rk*(1.0_rk - half/radius)), c)
      cosine = 0.5_rk*c/(radius*sine)
    end if
    first = plane(:, 1)
    plane(:, 1) = cosine*first + sine*plane(:, 2)
    plane(:, 2) = cosine*plane(:, 2) - sine*first
  end subroutine rotate_in_plane

  !> All principal values of a deviator, from the value farthest from the two others.
  pure function values_around(s, single) result(values)
    real(rk), intent(in) :: s(6) !< deviator
    real(rk), intent(in) :: single !< the known value
    real(rk) :: values(3)
    real(rk) :: first(3), second(3), matrix(3, 3), in_plane(2)
    matrix = as_matrix(s)
    call span_normal_plane(matrix, single, first, second)
    in_plane = values_of_pair(dot_product(first, matmul(matrix, first)), &
                              dot_product(second, matmul(matrix, second)), &
                              dot_product(first, matmul(matrix, second)))
    if (single > 0.0_rk) then
      values = [single, in_plane]
    else
      values = [in_plane, single]
    end if
  end function values_around

  !> Two unit vectors normal to each other and to the axis of a single principal value. The columns
  !> of tensor - value*identity lie in their plane. The longest column gives the first vector; the
  !> axis is normal to this column and to the column that differs most from it in direction.
  pure subroutine span_normal_plane(matrix, value, first, second)
    real(rk), intent(in) :: matrix(3, 3), value !< the tensor and its principal value
    real(rk), intent(out) :: first(3), second(3)
    real(rk) :: columns(3, 3), axis(3), other(3), squares(3)
    integer, parameter :: next(3) = [2, 3, 1]
    integer :: i, pivot
    columns = matrix
    do i = 1, 3
      columns(i, i) = columns(i, i) - value
      squares(i) = columns(1, i)**2 + columns(2, i)**2 + columns(3, i)**2
    end do
    pivot = 1
    if (squares(2) > squares(1)) pivot = 2
    if (squares(3) > squares(pivot)) pivot = 3
    first = columns(:, pivot)/sqrt(squares(pivot))
    axis = cross_product(first, columns(:, next(pivot)))
    other = cross_product(first, columns(:, next(next(pivot))))
    if (square_of(other) > square_of(axis)) axis = other
    second = cross_product(axis/sqrt(square_of(axis)), first)
  end subroutine span_normal_plane

  !> v . v, without the call of norm2.
  pure real(rk) function square_of(v)
    real(rk), intent(in) :: v(3)
    square_of = v(1)**2 + v(2)**2 + v(3)**2
  end function square_of

  !> Eigenvalues of [a c; c b], the larger first, without cancellation.
  pure function values_of_pair(a, b, c) result(values)
    real(rk), intent(in) :: a, b, c
    real(rk) :: values(2), middle, radius
    middle = 0.5_rk*(a + b)
    radius = sqrt((0.5_rk*(a - b))**2 + c**2)
    values = [middle + radius, middle - radius]
  end function values_of_pair
end module tensor6
