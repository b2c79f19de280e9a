!> The contract of loads, an extension of guests. A load is a constant pattern; its factor in time
!> belongs to the step.
module applied_load
  use dam_mesh, only: fe_mesh
  use guest_type, only: guest
  use joint_points, only: dam_joint
  use kinds, only: rk
  implicit none
  private
  public :: load, load_slot

  type, abstract, extends(guest) :: load
    character(:), allocatable :: family !< its keyword, for OP=NEW: 'CLOAD', 'DLOAD', ...
    character(:), allocatable :: target !< identity for OP=MOD: same target, new magnitude
    integer :: wet_joint = 0 !< position of the joint with the water of this load, 0 for none
    logical :: follows_opening = .false. !< its forces depend on the open points
  contains
    procedure :: joint_pressure
    procedure :: follow_joint
  end type load

  !> One load of a list.
  type :: load_slot
    class(load), allocatable :: item
  end type load_slot
contains

  !> Pressure of the water at the points of `wet_joint`, at factor 1.
  pure subroutine joint_pressure(self, is_open, pressure)
    class(load), intent(in) :: self
    logical, intent(in) :: is_open(:) !< (points)
    real(rk), intent(out) :: pressure(:) !< (points) [Pa]
    pressure = 0.0_rk
  end subroutine joint_pressure

  !> Areas and nodes of the points of `wet_joint` have changed, or some points have come or gone.
  subroutine follow_joint(self, mesh, joint)
    class(load), intent(inout) :: self
    type(fe_mesh), intent(in) :: mesh
    type(dam_joint), intent(in) :: joint
  end subroutine follow_joint
end module applied_load
