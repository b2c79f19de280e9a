!> The history of a joint: what its points change in time.
!>
!> Every component of `joint_state` has a line in save and in load; tests/tools/test_archives.py
!> compares them with the type.
module joint_history
  use archive_type, only: archive
  use guest_history, only: history
  use kinds, only: rk
  implicit none
  private
  public :: joint_state, allocate_state
  public :: state_open, state_stick, state_slip, state_bonded
  public :: phase_absent, phase_contact, phase_full, absent_points, is_bare, takes_grout
  public :: openings_to_part

  integer, parameter :: state_open = 0, state_stick = 1, state_slip = 2, state_bonded = 3

  !> A point that the iteration of an increment opens so many times has parted (theory.md, 2.3).
  integer, parameter :: openings_to_part = 2

  !> What a point may do, in models with stages.
  integer, parameter :: phase_absent = 0 !< nothing: an element behind the point is absent
  integer, parameter :: phase_contact = 1 !< contact and friction: the point is not grouted yet
  integer, parameter :: phase_full = 2 !< all of its law

  !> History of all points of one joint, converged or trial. A new component gets a line in save and
  !> load.
  type, extends(history) :: joint_state
    real(rk), allocatable :: gap(:) !< (points) at the start; the opening is jump(1) + gap [m]
    !> (points) multiplier of the contact over the normal stiffness, <= 0: contact begins where the
    !> opening is -shift, so that the joint carries pressure without penetration [m]
    real(rk), allocatable :: shift(:)
    !> (3, points) relative displacement, since `origin` where the joint has one [m]
    real(rk), allocatable :: jump(:, :)
    real(rk), allocatable :: traction(:, :) !< (3, points) by the law at `jump` [Pa]
    real(rk), allocatable :: slip(:, :) !< (2, points) irrecoverable sliding [m]
    logical, allocatable :: is_broken(:) !< tensile strength lost
    !> (points) What the law reports: open (the point touches and carries nothing), stick or slip
    !> (pressed), bonded (it can carry tension)
    integer, allocatable :: status(:)
    !> (points) How often the iteration of this increment has opened the point. The law decides at
    !> which number the point fails, and what the point loses.
    integer, allocatable :: num_openings(:)
    real(rk), allocatable :: friction_work(:) !< dissipated so far [J/m2]
    real(rk), allocatable :: fracture_work(:) !< dissipated when the strength was lost [J/m2]
    real(rk), allocatable :: internal(:, :) !< (variables, points) the law's own history
    real(rk), allocatable :: water(:) !< (points) water pressure, in joints with water
    !> (points) open for the water of the increment; in joints whose water follows openings
    logical, allocatable :: lets_water_in(:)
    !> (3, points) relative displacement of the nodes where that of the law is zero: when the point
    !> appeared, or was grouted [m]; in models with stages only
    real(rk), allocatable :: origin(:, :)
    integer, allocatable :: phase(:) !< (points) in models with stages only
    !> (points) filled with grout under pressure at the start of the step; until it hardens
    logical, allocatable :: is_pressed(:)
    !> (3, parts, points) the origin of each part, whose mean over the area is `origin`; where parts
    !> of points come and go [m]
    real(rk), allocatable :: part_origin(:, :, :)
  contains
    procedure :: save => save_joint
    procedure :: load => load_joint
  end type joint_state

contains

  !> Writes the history of one joint into the present group.
  subroutine save_joint(self, file)
    class(joint_state), intent(in) :: self
    class(archive), intent(inout) :: file
    call file%put('gap', self%gap)
    call file%put('shift', self%shift)
    call file%put('jump', self%jump)
    call file%put('traction', self%traction)
    call file%put('slip', self%slip)
    call file%put('is_broken', self%is_broken)
    call file%put('status', self%status)
    call file%put('num_openings', self%num_openings)
    call file%put('friction_work', self%friction_work)
    call file%put('fracture_work', self%fracture_work)
    call file%put('internal', self%internal)
    call file%put('water', self%water)
    call file%put('lets_water_in', self%lets_water_in)
    call file%put('origin', self%origin)
    call file%put('phase', self%phase)
    call file%put('is_pressed', self%is_pressed)
    call file%put('part_origin', self%part_origin)
  end subroutine save_joint

  !> Reads the history of one joint from the present group. The history must be in its initial
  !> state, which fixes the sizes.
  subroutine load_joint(self, file)
    class(joint_state), intent(inout) :: self
    class(archive), intent(inout) :: file
    call file%get('gap', self%gap)
    call file%get('shift', self%shift)
    call file%get('jump', self%jump)
    call file%get('traction', self%traction)
    call file%get('slip', self%slip)
    call file%get('is_broken', self%is_broken)
    call file%get('status', self%status)
    call file%get('num_openings', self%num_openings)
    call file%get('friction_work', self%friction_work)
    call file%get('fracture_work', self%fracture_work)
    call file%get('internal', self%internal)
    if (.not. allocated(self%gap)) return
    call file%get('water', self%water, shape(self%gap))
    call file%get('lets_water_in', self%lets_water_in, shape(self%gap))
    call file%get('origin', self%origin, [3, size(self%gap)])
    call file%get('phase', self%phase, shape(self%gap))
    call file%get('is_pressed', self%is_pressed)
    call file%get('part_origin', self%part_origin)
  end subroutine load_joint

  !> Whether a point has contact and friction alone: a joint before it is grouted.
  pure logical function is_bare(state, point)
    type(joint_state), intent(in) :: state
    integer, intent(in) :: point
    is_bare = .false.
    if (allocated(state%phase)) is_bare = state%phase(point) /= phase_full
  end function is_bare

  !> The points that do nothing, since an element behind them is absent.
  pure function absent_points(state) result(is_absent)
    type(joint_state), intent(in) :: state
    logical :: is_absent(size(state%gap))
    is_absent = .false.
    if (allocated(state%phase)) is_absent = state%phase == phase_absent
  end function absent_points

  !> The points that a *GROUT fills: those that are there, but for intact ones.
  pure function takes_grout(state) result(takes)
    type(joint_state), intent(in) :: state !< of a joint in a model with stages
    logical :: takes(size(state%phase))
    takes = state%phase == phase_contact .or. (state%phase == phase_full .and. state%is_broken)
  end function takes_grout

  !> Allocates the history of the points of one joint; all values but the gap are zero.
  pure subroutine allocate_state(gap, state, num_internal)
    real(rk), intent(in) :: gap(:) !< (points) [m]
    type(joint_state), intent(out) :: state
    integer, intent(in), optional :: num_internal !< variables of the law's own history (0)
    integer :: num_points, num_own
    num_points = size(gap)
    num_own = 0
    if (present(num_internal)) num_own = num_internal
    state%gap = gap
    allocate (state%shift(num_points), source=0.0_rk)
    allocate (state%jump(3, num_points), state%traction(3, num_points), source=0.0_rk)
    allocate (state%slip(2, num_points), source=0.0_rk)
    allocate (state%friction_work(num_points), state%fracture_work(num_points), source=0.0_rk)
    allocate (state%internal(num_own, num_points), source=0.0_rk)
    allocate (state%is_broken(num_points), source=.false.)
    allocate (state%num_openings(num_points), source=0)
    allocate (state%status(num_points), source=state_open)
  end subroutine allocate_state
end module joint_history
