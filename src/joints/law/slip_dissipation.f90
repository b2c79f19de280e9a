!> Work dissipated by friction along a straight path of the relative displacement.
!>
!> The slip limit changes linearly along the path. While the direction of slip is constant, the
!> result is exact for any size of the increment. The elastic part of the motion dissipates nothing.
module slip_dissipation
  use kinds, only: rk
  implicit none
  private
  public :: sliding_work, closing_work, opening_work

contains

  !> Dissipation per area of a joint that stays closed [J/m2].
  pure real(rk) function sliding_work(start, start_limit, trial, limit, k) result(work)
    real(rk), intent(in) :: start(2) !< tangential traction at the start [Pa]
    real(rk), intent(in) :: start_limit !< mu p + c at the start [Pa]
    real(rk), intent(in) :: trial(2) !< elastic trial traction at the end [Pa]
    real(rk), intent(in) :: limit !< mu p + c at the end [Pa]
    real(rk), intent(in) :: k !< tangential stiffness [Pa/m]
    real(rk) :: onset_limit
    work = 0.0_rk
    if (norm2(trial) <= limit) return
    onset_limit = start_limit + onset(start, start_limit, trial, limit)*(limit - start_limit)
    work = 0.5_rk*(onset_limit + limit)*(norm2(trial) - limit)/k
  end function sliding_work

  !> Fraction of the path at which slip begins: |traction| = limit. Traction and limit are linear.
  pure real(rk) function onset(start, start_limit, trial, limit)
    real(rk), intent(in) :: start(2), start_limit, trial(2), limit
    real(rk) :: a, b, c, root
    a = sum((trial - start)**2) - (limit - start_limit)**2
    b = dot_product(start, trial - start) - start_limit*(limit - start_limit)
    c = min(0.0_rk, sum(start**2) - start_limit**2)
    root = sqrt(max(0.0_rk, b**2 - a*c))
    onset = 0.0_rk
    if (b >= 0.0_rk) then
      if (b + root > 0.0_rk) onset = -c/(b + root)
    else if (a > 0.0_rk) then
      onset = (root - b)/a
    end if
    onset = min(1.0_rk, max(0.0_rk, onset))
  end function onset

  !> Dissipation of a joint that closes along the path: only slip after contact counts, and the
  !> limit grows from zero.
  pure real(rk) function closing_work(trial, limit, contact, k) result(work)
    real(rk), intent(in) :: trial(2) !< elastic trial traction at the end [Pa]
    real(rk), intent(in) :: limit !< mu p + c at the end [Pa]
    real(rk), intent(in) :: contact !< fraction of the path at which the joint closes
    real(rk), intent(in) :: k !< tangential stiffness [Pa/m]
    work = 0.5_rk*limit*max(0.0_rk, (1.0_rk - contact)*norm2(trial) - limit)/k
  end function closing_work

  !> Dissipation of a joint that opens along the path: slip until the opening, and the energy of the
  !> tangential springs at the opening (cohesion).
  pure real(rk) function opening_work(start, start_limit, motion, cohesion, k) result(work)
    real(rk), intent(in) :: start(2) !< tangential traction at the start [Pa]
    real(rk), intent(in) :: start_limit !< mu p + c at the start [Pa]
    real(rk), intent(in) :: motion(2) !< tangential displacement up to the opening [m]
    real(rk), intent(in) :: cohesion !< limit at the opening [Pa]
    real(rk), intent(in) :: k !< tangential stiffness [Pa/m]
    real(rk) :: trial(2)
    trial = start + k*motion
    work = sliding_work(start, start_limit, trial, cohesion, k) &
           + 0.5_rk*min(norm2(trial), cohesion)**2/k
  end function opening_work
end module slip_dissipation
