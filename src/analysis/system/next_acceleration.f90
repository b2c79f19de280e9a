!> The acceleration that a motion has at the end of the next increment if it goes on as it did
!> (theory.md, 12): a combination of the last two. Newmark's method without much dissipation lets
!> the acceleration alternate from increment to increment, which one of them alone does not show.
module next_acceleration
  use analysis_state, only: motion
  use global_vectors, only: dot, length
  use kinds, only: rk
  use matrix_pattern, only: pattern
  implicit none
  private
  public :: find_trend, expected_acceleration

  !> Accelerations are parallel where the determinant of their products is below this fraction.
  real(rk), parameter :: least_determinant = 1.0e-6_rk

contains

  !> The combination of the accelerations at the start of the last increment and of the one before
  !> it that comes nearest to that at its end, by least squares.
  subroutine find_trend(old, new, matrix)
    type(motion), intent(in) :: old !< at the start of the increment
    type(motion), intent(inout) :: new !< at its end
    type(pattern), intent(in) :: matrix
    real(rk) :: g(3), r(2), determinant
    new%last_a = old%a
    associate (n => matrix%num_free, part => matrix%part)
      g(1) = dot(part, old%a(:n), old%a(:n))
      r(1) = dot(part, old%a(:n), new%a(:n))
      new%acceleration_ratio = r(1)/max(g(1), tiny(1.0_rk))
      new%last_ratio = 0.0_rk
      if (.not. allocated(old%last_a)) return
      g(2) = dot(part, old%last_a(:n), old%a(:n))
      g(3) = dot(part, old%last_a(:n), old%last_a(:n))
      r(2) = dot(part, old%last_a(:n), new%a(:n))
    end associate
    determinant = g(1)*g(3) - g(2)**2
    if (.not. determinant > least_determinant*g(1)*g(3)) return
    new%acceleration_ratio = (g(3)*r(1) - g(2)*r(2))/determinant
    new%last_ratio = (g(1)*r(2) - g(2)*r(1))/determinant
  end subroutine find_trend

  !> The acceleration at the end of the next increment; not larger than the larger one of the last
  !> two.
  function expected_acceleration(now, matrix) result(a)
    type(motion), intent(in) :: now
    type(pattern), intent(in) :: matrix
    real(rk) :: a(matrix%num_free) !< [m/s2]
    real(rk) :: most, own
    associate (n => matrix%num_free, part => matrix%part)
      a = now%acceleration_ratio*now%a(:n)
      most = length(part, now%a(:n))
      if (allocated(now%last_a)) then
        a = a + now%last_ratio*now%last_a(:n)
        most = max(most, length(part, now%last_a(:n)))
      end if
    end associate
    own = length(matrix%part, a)
    if (own > most) a = (most/own)*a
  end function expected_acceleration
end module next_acceleration
