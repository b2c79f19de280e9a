!> What every joint law can do: traction from relative displacement, for a block of points.
!>
!> Local axes at a point: 1 normal (from master to slave), 2 and 3 in the plane of the joint.
!> Signs: opening and tension positive.
module joint_law
  use kinds, only: rk
  implicit none
  private
  public :: traction_law, joint_state, allocate_state
  public :: state_open, state_stick, state_slip, state_bonded

  integer, parameter :: state_open = 0, state_stick = 1, state_slip = 2, state_bonded = 3

  !> History of all points of one joint; two of them exist, converged and trial. A new component
  !> gets a line in save and load of joint_archive.
  type :: joint_state
    real(rk), allocatable :: gap(:) !< (points) at the start; the opening is jump(1) + gap [m]
    !> (points) multiplier of the contact over the normal stiffness, <= 0: contact begins where the
    !> opening is -shift, so that the joint carries pressure without penetration [m]
    real(rk), allocatable :: shift(:)
    real(rk), allocatable :: jump(:, :) !< (3, points) relative displacement [m]
    real(rk), allocatable :: traction(:, :) !< (3, points) by the law at `jump` [Pa]
    real(rk), allocatable :: slip(:, :) !< (2, points) irrecoverable sliding [m]
    logical, allocatable :: is_broken(:) !< tensile strength lost
    !> (points) What the law reports: open (the point touches and carries nothing), stick or slip
    !> (pressed), bonded (it can carry tension)
    integer, allocatable :: status(:)
    !> (points) How often the iteration of this increment has opened the point. The law decides from
    !> which number on the point has parted, and what the point loses by that.
    integer, allocatable :: num_openings(:)
    real(rk), allocatable :: friction_work(:) !< dissipated so far [J/m2]
    real(rk), allocatable :: fracture_work(:) !< set free when the strength was lost [J/m2]
    real(rk), allocatable :: water(:) !< (points) pressure of water in the joint; where there is any
  end type joint_state

  !> A joint law. `update` answers with the law's own traction (for the residual that decides
  !> convergence) and with the traction and tangent of the augmented form (for the next iterate):
  !> in Newton's iteration the traction follows iterate + tangent*(correction of the jump).
  type, abstract :: traction_law
    character(:), allocatable :: name !< upper case
    real(rk) :: gap = 0.0_rk !< at the start, of every point [m]
    !> Largest penetration of points in contact [m]; 0: as their stiffness gives it
    real(rk) :: penetration = 0.0_rk
  contains
    procedure(start_state), deferred :: start_state
    procedure(reference_stiffness), deferred :: reference_stiffness
    procedure(update), deferred :: update
    procedure(stored_energy), deferred :: stored_energy
    procedure :: limits => no_limits
  end type traction_law

  abstract interface
    !> History of a joint that has not moved yet, as the law wants it.
    pure subroutine start_state(self, clearance, state)
      import :: traction_law, joint_state, rk
      implicit none
      class(traction_law), intent(in) :: self
      real(rk), intent(in) :: clearance(:) !< (points) of the faces as meshed, beside the gap [m]
      type(joint_state), intent(out) :: state
    end subroutine start_state

    !> Stiffness of the closed, sticking joint: normal and the two tangents [Pa/m].
    pure subroutine reference_stiffness(self, k)
      import :: traction_law, rk
      implicit none
      class(traction_law), intent(in) :: self
      real(rk), intent(out) :: k(3)
    end subroutine reference_stiffness

    !> Tractions at a trial jump. `multiplier` is the friction of the last iterate (tangential
    !> traction), `scale` the r of the augmented form [Pa/m].
    pure subroutine update(self, jump, old, multiplier, scale, new, iterate, tangent)
      import :: traction_law, joint_state, rk
      implicit none
      class(traction_law), intent(in) :: self
      real(rk), intent(in) :: jump(:, :) !< (3, points) trial [m]
      type(joint_state), intent(in) :: old !< converged history
      real(rk), intent(in) :: multiplier(:, :) !< (2, points) [Pa]
      real(rk), intent(in) :: scale(:) !< (points) [Pa/m]
      type(joint_state), intent(inout) :: new !< history at the trial jump, law's own traction;
      !! num_openings and shift are given
      real(rk), intent(out) :: iterate(:, :) !< (3, points) traction of the augmented form [Pa]
      real(rk), intent(out) :: tangent(:, :, :) !< (3, 3, points) [Pa/m], unsymmetric
    end subroutine update

    !> Elastic energy stored per area [J/m2].
    pure subroutine stored_energy(self, state, energy)
      import :: traction_law, joint_state, rk
      implicit none
      class(traction_law), intent(in) :: self
      type(joint_state), intent(in) :: state
      real(rk), intent(out) :: energy(:) !< (points)
    end subroutine stored_energy
  end interface

contains

  !> What a closed point may carry, whatever its stiffness: friction, cohesion and strength [Pa]. A
  !> law that says nothing of it presses and does no more.
  pure subroutine no_limits(self, friction, cohesion, strength)
    class(traction_law), intent(in) :: self
    real(rk), intent(out) :: friction, cohesion, strength
    friction = 0.0_rk
    cohesion = 0.0_rk
    strength = 0.0_rk
  end subroutine no_limits

  !> Room for the history of the points of one joint, all zero but the gap.
  pure subroutine allocate_state(gap, state)
    real(rk), intent(in) :: gap(:) !< (points) [m]
    type(joint_state), intent(out) :: state
    integer :: num_points
    num_points = size(gap)
    state%gap = gap
    allocate (state%shift(num_points), source=0.0_rk)
    allocate (state%jump(3, num_points), state%traction(3, num_points), source=0.0_rk)
    allocate (state%slip(2, num_points), source=0.0_rk)
    allocate (state%friction_work(num_points), state%fracture_work(num_points), source=0.0_rk)
    allocate (state%is_broken(num_points), source=.false.)
    allocate (state%num_openings(num_points), source=0)
    allocate (state%status(num_points), source=state_open)
  end subroutine allocate_state
end module joint_law
