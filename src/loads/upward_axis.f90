!> Which axis of the model points up.
module upward_axis
  use applied_load, only: load_slot
  use kinds, only: rk
  use load_gravity, only: gravity_load
  use load_reservoir, only: reservoir_load
  implicit none
  private
  public :: find_upward_axis

  integer, parameter :: usual_axis = 3 !< where neither water nor weight acts

contains

  !> The axis of the first reservoir; without one, that of the largest weight.
  integer function find_upward_axis(loads) result(axis)
    type(load_slot), intent(in) :: loads(:)
    real(rk) :: largest
    integer :: i
    axis = usual_axis
    largest = 0.0_rk
    do i = 1, size(loads)
      select type (item => loads(i)%item)
      type is (reservoir_load)
        axis = item%water%up
        return
      type is (gravity_load)
        if (norm2(item%acceleration) <= largest) cycle
        largest = norm2(item%acceleration)
        axis = maxloc(abs(item%acceleration), dim=1)
      end select
    end do
  end function find_upward_axis
end module upward_axis
