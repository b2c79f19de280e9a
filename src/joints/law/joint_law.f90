!> The contract of joint laws: traction from relative displacement, for a block of points.
!>
!> Local axes at a point: 1 normal (from master to slave), 2 and 3 in the plane of the joint.
!> Signs: opening and tension positive.
!>
!> A new law is one file: a type that extends `traction_law` by what the interfaces below require,
!> and its entry in joint_catalogue. The smallest law (tests/examples/softening_joint) writes
!> `update`, the traction and its derivative. Only a law with Coulomb friction overrides
!> `linearise` as well.
module joint_law
  use deck_card, only: card
  use diagnostics, only: diagnostic_list
  use joint_history, only: absent_points, allocate_state, is_bare, joint_state, phase_absent, &
                           phase_contact, phase_full, state_bonded, state_open, state_slip, &
                           state_stick, takes_grout, openings_to_part
  use keyword_spec, only: keyword_variant
  use kinds, only: rk
  implicit none
  private
  public :: traction_law, joint_state, solid_behind, allocate_state
  public :: state_open, state_stick, state_slip, state_bonded
  public :: phase_absent, phase_contact, phase_full, absent_points, is_bare, takes_grout
  public :: openings_to_part

  !> What a law may derive its stiffness from.
  type :: solid_behind
    real(rk) :: young = 0.0_rk !< E on the slave side [Pa]
    real(rk) :: poisson = 0.0_rk !< on the slave side
    !> E/h of the softer side, h the depth of its elements; 0 where no side has an E [Pa/m]
    real(rk) :: layer_stiffness = 0.0_rk
  end type solid_behind

  type, abstract :: traction_law
    character(:), allocatable :: name !< of the *JOINT LAW, upper case
    real(rk) :: gap = 0.0_rk !< at the start, of every point [m]
    !> Largest penetration of points in contact [m]; 0: pressure over stiffness
    real(rk) :: penetration = 0.0_rk
  contains
    procedure(describe), deferred, nopass :: describe
    procedure(read_card), deferred :: read_card
    procedure :: needs_solid => needs_no_solid
    procedure :: complete => complete_nothing
    procedure(start_state), deferred :: start_state
    procedure(reference_stiffness), deferred :: reference_stiffness
    procedure(update), deferred :: update
    procedure :: linearise => linearise_by_update
    procedure(stored_energy), deferred :: stored_energy
    procedure :: limits => no_limits
  end type traction_law

  abstract interface
    !> The law's TYPE, its meaning and its parameters of *JOINT LAW.
    pure subroutine describe(entry)
      import :: keyword_variant
      implicit none
      type(keyword_variant), intent(out) :: entry
    end subroutine describe

    !> Reads the constants from a card. The card agrees with the law's entry and contains its
    !> defaults.
    subroutine read_card(self, this, faults)
      import :: traction_law, card, diagnostic_list
      implicit none
      class(traction_law), intent(inout) :: self
      type(card), intent(in) :: this
      type(diagnostic_list), intent(inout) :: faults
    end subroutine read_card

    !> History of a joint that has not moved yet.
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

    !> Traction at a trial jump and its derivative. `num_openings` and `shift` of `new` are set by
    !> the caller. The law sets jump, traction, status, works and its own history. Other values of
    !> `new` do not count: each evaluation starts from `old`.
    pure subroutine update(self, jump, old, new, tangent)
      import :: traction_law, joint_state, rk
      implicit none
      class(traction_law), intent(in) :: self
      real(rk), intent(in) :: jump(:, :) !< (3, points) trial [m]
      type(joint_state), intent(in) :: old !< converged history
      type(joint_state), intent(inout) :: new !< history at the trial jump
      real(rk), intent(out) :: tangent(:, :, :) !< (3, 3, points) [Pa/m], may be unsymmetric
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

  !> Default: the law has all its constants from the deck.
  pure logical function needs_no_solid(self)
    class(traction_law), intent(in) :: self
    needs_no_solid = .false.
  end function needs_no_solid

  !> Default: nothing is derived from the solid.
  pure subroutine complete_nothing(self, solid)
    class(traction_law), intent(inout) :: self
    type(solid_behind), intent(in) :: solid
  end subroutine complete_nothing

  !> Traction and tangent for the next iterate: the traction of Newton's iteration follows iterate +
  !> tangent*(correction of the jump), while `new` contains the law's own traction, which decides
  !> convergence. Default: both are those of `update`. Contact with Coulomb friction needs another
  !> form (theory.md, 2.3): `multiplier` is the traction of the last iterate, `scale` the r of the
  !> augmented form.
  pure subroutine linearise_by_update(self, jump, old, multiplier, scale, new, iterate, tangent)
    class(traction_law), intent(in) :: self
    real(rk), intent(in) :: jump(:, :) !< (3, points) trial [m]
    type(joint_state), intent(in) :: old !< converged history
    real(rk), intent(in) :: multiplier(:, :) !< (3, points) [Pa]
    real(rk), intent(in) :: scale(:, :) !< (2, points) normal, along the joint [Pa/m]
    type(joint_state), intent(inout) :: new !< history at the trial jump, see `update`
    real(rk), intent(out) :: iterate(:, :) !< (3, points) [Pa]
    real(rk), intent(out) :: tangent(:, :, :) !< (3, 3, points) [Pa/m], may be unsymmetric
    call self%update(jump, old, new, tangent)
    iterate = new%traction
  end subroutine linearise_by_update

  !> Limits of a closed point, whatever its stiffness: friction, cohesion and strength [Pa].
  !> Default: frictionless unilateral contact.
  pure subroutine no_limits(self, friction, cohesion, strength)
    class(traction_law), intent(in) :: self
    real(rk), intent(out) :: friction, cohesion, strength
    friction = 0.0_rk
    cohesion = 0.0_rk
    strength = 0.0_rk
  end subroutine no_limits
end module joint_law
