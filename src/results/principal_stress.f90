!> Principal values of a symmetric tensor, order 11 22 33 12 13 23.
module principal_stress
  use kinds, only: rk
  implicit none
  private
  public :: principal_values

  real(rk), parameter :: third_of_turn = 2.0943951023931953_rk !< 2 pi / 3
  !> Closer to a double root than this the cosine formula loses half the digits.
  real(rk), parameter :: nearly_double = 1.0e-4_rk

contains

  !> Principal values, the largest (tension) first. The cosine formula, and Jacobi's rotations where
  !> two values nearly coincide.
  pure function principal_values(s) result(values)
    real(rk), intent(in) :: s(6)
    real(rk) :: values(3)
    real(rk) :: mean, p, half_det, angle, d(3)
    mean = (s(1) + s(2) + s(3))/3.0_rk
    d = s(:3) - mean
    p = sqrt((sum(d**2) + 2.0_rk*sum(s(4:)**2))/6.0_rk)
    values = mean
    if (p <= tiny(1.0_rk)**0.25_rk) return
    d = d/p
    half_det = 0.5_rk*(d(1)*d(2)*d(3) + &
                       (2.0_rk*(s(4)/p)*(s(5)/p)*(s(6)/p) - d(1)*(s(6)/p)**2 &
                        - d(2)*(s(5)/p)**2 - d(3)*(s(4)/p)**2))
    if (abs(half_det) > 1.0_rk - nearly_double) then
      values = values_by_rotation(s)
    else
      angle = acos(half_det)/3.0_rk
      values(1) = mean + 2.0_rk*p*cos(angle)
      values(3) = mean + 2.0_rk*p*cos(angle + third_of_turn)
      values(2) = 3.0_rk*mean - values(1) - values(3)
    end if
  end function principal_values

  !> Jacobi's method; a handful of sweeps reach roundoff.
  pure function values_by_rotation(s) result(values)
    real(rk), intent(in) :: s(6)
    real(rk) :: values(3)
    real(rk) :: a(3, 3)
    integer :: sweep, i, j
    a = reshape([s(1), s(4), s(5), s(4), s(2), s(6), s(5), s(6), s(3)], [3, 3])
    do sweep = 1, 12
      if (abs(a(1, 2)) + abs(a(1, 3)) + abs(a(2, 3)) <= 0.0_rk) exit
      do i = 1, 2
        do j = i + 1, 3
          call rotate(a, i, j)
        end do
      end do
    end do
    values = [a(1, 1), a(2, 2), a(3, 3)]
    if (values(1) < values(2)) values([1, 2]) = values([2, 1])
    if (values(2) < values(3)) values([2, 3]) = values([3, 2])
    if (values(1) < values(2)) values([1, 2]) = values([2, 1])
  end function values_by_rotation

  !> One rotation that clears a(i, j).
  pure subroutine rotate(a, i, j)
    real(rk), intent(inout) :: a(3, 3)
    integer, intent(in) :: i, j
    real(rk) :: t, c, s, ratio, column(3), row(3)
    if (abs(a(i, j)) <= epsilon(1.0_rk)**2*(abs(a(i, i)) + abs(a(j, j)))) a(i, j) = 0.0_rk
    if (abs(a(i, j)) <= 0.0_rk) then
      a(j, i) = 0.0_rk
      return
    end if
    ratio = (a(j, j) - a(i, i))/(2.0_rk*a(i, j))
    t = sign(1.0_rk, ratio)/(abs(ratio) + hypot(1.0_rk, ratio))
    c = 1.0_rk/hypot(1.0_rk, t)
    s = t*c
    column = a(:, i)
    a(:, i) = c*column - s*a(:, j)
    a(:, j) = s*column + c*a(:, j)
    row = a(i, :)
    a(i, :) = c*row - s*a(j, :)
    a(j, :) = s*row + c*a(j, :)
    a(i, j) = 0.0_rk
    a(j, i) = 0.0_rk
  end subroutine rotate
end module principal_stress
