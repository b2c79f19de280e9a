!> The opening of a joint, in one place: for laws, iterations and results.
module joint_opening
  use kinds, only: rk
  implicit none
  private
  public :: opening_of

contains

  !> Signed opening of a point, positive when open, negative when pressed together [m].
  pure elemental real(rk) function opening_of(normal_jump, gap) result(opening)
    real(rk), intent(in) :: normal_jump !< relative displacement along the normal, jump(1) [m]
    real(rk), intent(in) :: gap !< at the start [m]
    opening = normal_jump + gap
  end function opening_of
end module joint_opening
