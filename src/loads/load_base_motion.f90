!> *BASE MOTION: uniform acceleration of the base; displacements are relative to it.
module load_base_motion
  use applied_load, only: load
  use kinds, only: rk
  implicit none
  private
  public :: base_motion

  type, extends(load) :: base_motion
    integer :: dof = 0 !< 1..3
  contains
    procedure :: add_base_acceleration
  end type base_motion

contains

  !> 1 m/s2; the factor of the step (amplitude times SCALE) multiplies it.
  pure subroutine add_base_acceleration(self, acceleration)
    class(base_motion), intent(in) :: self
    real(rk), intent(inout) :: acceleration(3)
    acceleration(self%dof) = acceleration(self%dof) + 1.0_rk
  end subroutine add_base_acceleration
end module load_base_motion
