!> A contraction joint: tensile strength lost for good, unilateral contact, Coulomb friction.
!>
!> Source: Eqs. 9-13 with paper_notes.md, 3-6. Bonded, the joint is linear in all directions until
!> the normal opening exceeds strength/k_n. Broken, it carries k_n times the closing and no tension;
!> tangential traction sticks elastically with k_t up to mu p + c and slips there. While the joint
!> is open its slip follows the motion, so that traction starts from zero when it closes again.
!>
!> Contact in Newton's iteration (theory.md, 2.3): the status is decided on the traction lambda of
!> the last iterate and on the slip and opening that the springs leave,
!> z = lambda + r (v - s - lambda/k). Where |z_t| > mu p + c, one Newton step on
!> lambda_t - (mu p + c) z_t/|z_t| = 0 gives the next traction. At a solution this is the law and
!> its consistent tangent. The law alone cycles in the iteration where k exceeds the stiffness of
!> the structure.
module joint_contraction
  use contraction_keyword, only: describe_contraction, stiffness_of_thickness
  use deck_card, only: card
  use diagnostics, only: diagnostic_list
  use joint_law, only: allocate_state, is_bare, joint_state, openings_to_part, solid_behind, &
                       state_bonded, state_open, state_slip, state_stick, traction_law
  use kinds, only: rk
  use slip_dissipation, only: closing_work, opening_work, sliding_work
  implicit none
  private
  public :: contraction_law, penalty_factor

  !> k_n of contact over E/h of the softest layer of elements, as the penalty of CalculiX is 50
  !> times E over a unit length (different_meshes.md, 13.5 and 13.9).
  real(rk), parameter :: penalty_factor = 50.0_rk

  type, extends(traction_law) :: contraction_law
    real(rk) :: normal_stiffness = 0.0_rk !< k_n [Pa/m]; 0: from the solid
    real(rk) :: tangent_stiffness = 0.0_rk !< k_t [Pa/m]; 0: from the solid
    real(rk) :: strength = 0.0_rk !< q_on [Pa]
    real(rk) :: friction = 0.0_rk !< mu
    real(rk) :: cohesion = 0.0_rk !< c of the closed joint [Pa]
    real(rk) :: thickness = 0.02_rk !< for the default of k_n [m]; paper_notes.md, 3
    real(rk) :: layer_factor = 0.0_rk !< k_n over E/h of a layer of elements; 0: from the thickness
  contains
    procedure, nopass :: describe => describe_contraction
    procedure :: read_card
    procedure :: needs_solid
    procedure :: complete
    procedure :: start_state
    procedure :: reference_stiffness
    procedure :: update
    procedure :: linearise
    procedure :: stored_energy
    procedure :: limits
  end type contraction_law

  !> History of one point.
  type :: point_state
    real(rk) :: gap !< with the shift of the contact [m]
    real(rk) :: jump(3), traction(3), slip(2), friction_work, fracture_work
    real(rk) :: cohesion !< c, or 0 for a point that has parted within the increment [Pa]
    logical :: is_broken
    integer :: status
  end type point_state

contains

  !> The constants of a card.
  subroutine read_card(self, this, faults)
    class(contraction_law), intent(inout) :: self
    type(card), intent(in) :: this
    type(diagnostic_list), intent(inout) :: faults
    self%normal_stiffness = this%real('KN')
    self%tangent_stiffness = this%real('KT')
    self%strength = this%real('TENSILE STRENGTH')
    self%friction = this%real('FRICTION')
    self%cohesion = this%real('COHESION')
    self%thickness = this%real('THICKNESS')
    self%gap = this%real('GAP')
    self%penetration = this%real('PENETRATION')
    if (self%gap > 0.0_rk .and. self%strength > 0.0_rk) then
      call this%fault_parameter(faults, 'TENSILE STRENGTH', 'a joint with a GAP has no strength', &
                                'GAP or TENSILE STRENGTH, not both')
    end if
    if (this%has('THICKNESS') .and. stiffness_of_thickness(this) == '') then
      call this%warn(faults, 'THICKNESS has no effect: '// &
                     trim(merge('KN', 'KT', this%has('KN')))//' is given')
    end if
  end subroutine read_card

  !> True if a stiffness must be derived from the solid on the slave side.
  pure logical function needs_solid(self)
    class(contraction_law), intent(in) :: self
    needs_solid = min(self%normal_stiffness, self%tangent_stiffness) <= 0.0_rk
  end function needs_solid

  !> k_n = E/thickness and k_t = k_n/(2 (1 + nu)) where the deck gave none (paper_notes.md, 3). For
  !> contact without penetration k_n only controls the convergence (different_meshes.md, 13.5): it
  !> is that of a penalty, and k_t is still that of the joint.
  pure subroutine complete(self, solid)
    class(contraction_law), intent(inout) :: self
    type(solid_behind), intent(in) :: solid
    if (self%penetration > 0.0_rk .and. self%normal_stiffness <= 0.0_rk &
        .and. self%strength <= 0.0_rk) then
      self%normal_stiffness = penalty_factor*solid%layer_stiffness
    end if
    if (self%normal_stiffness <= 0.0_rk) then
      self%normal_stiffness = self%layer_factor*solid%layer_stiffness
    end if
    if (self%normal_stiffness <= 0.0_rk) self%normal_stiffness = solid%young/self%thickness
    if (self%tangent_stiffness > 0.0_rk) return
    self%tangent_stiffness = self%normal_stiffness/(2.0_rk*(1.0_rk + solid%poisson))
    if (self%penetration > 0.0_rk) then
      self%tangent_stiffness = solid%young/self%thickness/(2.0_rk*(1.0_rk + solid%poisson))
    end if
  end subroutine complete

  !> Bonded with a strength, closed without, and open where there is a gap.
  pure subroutine start_state(self, clearance, state)
    class(contraction_law), intent(in) :: self
    real(rk), intent(in) :: clearance(:)
    type(joint_state), intent(out) :: state
    call allocate_state(self%gap + clearance, state)
    state%is_broken = self%strength <= 0.0_rk
    state%status = state_stick
    if (self%strength > 0.0_rk) state%status = state_bonded
    where (state%gap > 0.0_rk)
      state%status = state_open
      state%is_broken = .true.
    end where
  end subroutine start_state

  !> k_n, k_t, k_t.
  pure subroutine reference_stiffness(self, k)
    class(contraction_law), intent(in) :: self
    real(rk), intent(out) :: k(3)
    k = [self%normal_stiffness, self%tangent_stiffness, self%tangent_stiffness]
  end subroutine reference_stiffness

  !> mu, c and q_on.
  pure subroutine limits(self, friction, cohesion, strength)
    class(contraction_law), intent(in) :: self
    real(rk), intent(out) :: friction, cohesion, strength
    friction = self%friction
    cohesion = self%cohesion
    strength = self%strength
  end subroutine limits

  !> Elastic energy of the springs at the tractions of the state. A contact with a shift stores 1/2
  !> q_n times its penetration (different_meshes.md, 13.5).
  pure subroutine stored_energy(self, state, energy)
    class(contraction_law), intent(in) :: self
    type(joint_state), intent(in) :: state
    real(rk), intent(out) :: energy(:)
    real(rk) :: k(3)
    call self%reference_stiffness(k)
    energy = 0.5_rk*(state%traction(1, :)*(state%traction(1, :)/k(1) - state%shift) &
                     + state%traction(2, :)**2/k(2) + state%traction(3, :)**2/k(3))
  end subroutine stored_energy

  !> The return map of friction and its consistent tangent: the augmented form whose multiplier is
  !> the law's own traction.
  pure subroutine update(self, jump, old, new, tangent)
    class(contraction_law), intent(in) :: self
    real(rk), intent(in) :: jump(:, :)
    type(joint_state), intent(in) :: old
    type(joint_state), intent(inout) :: new
    real(rk), intent(out) :: tangent(:, :, :)
    real(rk) :: iterate(3, size(jump, 2)), scale(2, size(jump, 2)), multiplier(3, size(jump, 2))
    scale = spread([self%normal_stiffness, self%tangent_stiffness], 2, size(jump, 2))
    call self%linearise(jump, old, old%traction, scale, new, iterate, tangent)
    multiplier = new%traction
    call self%linearise(jump, old, multiplier, scale, new, iterate, tangent)
  end subroutine update

  !> The law at all points of a joint, contact and friction in their augmented form.
  pure subroutine linearise(self, jump, old, multiplier, scale, new, iterate, tangent)
    class(contraction_law), intent(in) :: self
    real(rk), intent(in) :: jump(:, :)
    type(joint_state), intent(in) :: old
    real(rk), intent(in) :: multiplier(:, :), scale(:, :)
    type(joint_state), intent(inout) :: new
    real(rk), intent(out) :: iterate(:, :)
    real(rk), intent(out) :: tangent(:, :, :)
    type(point_state) :: before, after
    logical :: has_parted
    integer :: p
    do p = 1, size(jump, 2)
      before = point_state(old%gap(p) + old%shift(p), old%jump(:, p), old%traction(:, p), &
                           old%slip(:, p), old%friction_work(p), old%fracture_work(p), &
                           self%cohesion, old%is_broken(p), old%status(p))
      if (is_bare(old, p)) before%cohesion = 0.0_rk
      after = before
      ! A parted point has lost its strength, and its cohesion within the increment.
      has_parted = new%num_openings(p) >= openings_to_part
      if (has_parted) after%cohesion = 0.0_rk
      after%jump = jump(:, p)
      after%gap = old%gap(p) + new%shift(p)
      if (.not. (before%is_broken .or. has_parted) .and. &
          jump(1, p)*self%normal_stiffness <= self%strength) then
        call stay_bonded(self, after, iterate(:, p), tangent(:, :, p))
      else
        if (jump(1, p) + after%gap > 0.0_rk) then
          call open_point(self, before, after)
        else
          call close_point(self, before, after)
        end if
        call augment(self, before%slip, after, multiplier(:, p), scale(:, p), iterate(:, p), &
                     tangent(:, :, p))
      end if
      new%jump(:, p) = after%jump
      new%traction(:, p) = after%traction
      new%slip(:, p) = after%slip
      new%friction_work(p) = after%friction_work
      new%fracture_work(p) = after%fracture_work
      new%is_broken(p) = after%is_broken
      new%status(p) = after%status
    end do
  end subroutine linearise

  !> The intact joint: three springs.
  pure subroutine stay_bonded(law, point, iterate, tangent)
    type(contraction_law), intent(in) :: law
    type(point_state), intent(inout) :: point
    real(rk), intent(out) :: iterate(3), tangent(3, 3)
    real(rk) :: k(3)
    integer :: i
    call law%reference_stiffness(k)
    point%traction = k*point%jump
    point%status = state_bonded
    iterate = point%traction
    tangent = 0.0_rk
    do i = 1, 3
      tangent(i, i) = k(i)
    end do
  end subroutine stay_bonded

  !> The open joint carries nothing. A bonded point loses the energy stored at failure as work of
  !> fracture. A closed point loses the energy of its tangential spring by friction.
  pure subroutine open_point(law, before, point)
    type(contraction_law), intent(in) :: law
    type(point_state), intent(in) :: before
    type(point_state), intent(inout) :: point
    real(rk) :: k(3), share, step(3), opening, limit, rise
    call law%reference_stiffness(k)
    step = point%jump - before%jump
    opening = before%jump(1) + before%gap
    if (.not. before%is_broken) then
      share = 0.0_rk ! failed: the energy stored before is lost
      if (point%jump(1) > law%strength/k(1)) share = (law%strength/k(1) - before%jump(1))/step(1)
      point%fracture_work = before%fracture_work + 0.5_rk*sum(k*(before%jump + share*step)**2)
    else if (opening <= 0.0_rk) then
      limit = slip_limit(law, opening, before%cohesion)
      rise = step(1) + (point%gap - before%gap)
      point%friction_work = before%friction_work &
                            + opening_work(before%traction(2:3), limit, &
                                           -opening/rise*step(2:3), before%cohesion, k(2))
    end if
    point%traction = 0.0_rk
    point%slip = point%jump(2:3)
    point%is_broken = .true.
    point%status = state_open
  end subroutine open_point

  !> Traction of the closed joint: pressure, and the return map of friction.
  pure subroutine close_point(law, before, point)
    type(contraction_law), intent(in) :: law
    type(point_state), intent(in) :: before
    type(point_state), intent(inout) :: point
    real(rk) :: opening, old_opening, limit, k, trial(2), size_of_trial
    opening = point%jump(1) + point%gap
    old_opening = before%jump(1) + before%gap
    limit = slip_limit(law, opening, point%cohesion)
    k = law%tangent_stiffness
    trial = k*(point%jump(2:3) - before%slip)
    size_of_trial = sqrt(trial(1)**2 + trial(2)**2)
    point%traction(1) = law%normal_stiffness*opening
    point%is_broken = .true.
    if (size_of_trial <= limit .and. limit > 0.0_rk) then
      point%traction(2:3) = trial
      point%status = state_stick
      return
    end if
    point%traction(2:3) = limit*trial/max(size_of_trial, tiny(limit))
    point%slip = point%jump(2:3) - point%traction(2:3)/k
    point%status = state_slip
    if (size_of_trial <= limit) point%status = state_stick
    if (old_opening > 0.0_rk) then
      point%friction_work = before%friction_work &
                            + closing_work(trial, limit, old_opening/(old_opening - opening), k)
    else
      point%friction_work = before%friction_work &
                            + sliding_work(before%traction(2:3), &
                                           slip_limit(law, old_opening, before%cohesion), &
                                           trial, limit, k)
    end if
  end subroutine close_point

  !> Traction and tangent for the next iterate of the broken joint. The status follows from the
  !> multiplier; the limit of friction is that of the multiplier (Jean & Moreau), its change that of
  !> the pressure.
  pure subroutine augment(law, slip, point, multiplier, scale, iterate, tangent)
    type(contraction_law), intent(in) :: law
    real(rk), intent(in) :: slip(2) !< converged
    type(point_state), intent(in) :: point
    real(rk), intent(in) :: multiplier(3), scale(2)
    real(rk), intent(out) :: iterate(3), tangent(3, 3)
    real(rk) :: k_n, k, opening, trial, z(2), size_of_z, limit, e(2), rest(2), rho, softening
    k_n = law%normal_stiffness
    k = law%tangent_stiffness
    iterate = 0.0_rk
    tangent = 0.0_rk
    opening = point%jump(1) + point%gap
    trial = multiplier(1)*(1.0_rk - scale(1)/k_n) + scale(1)*opening
    if (trial > 0.0_rk) return ! open
    ! A point that closes has no multiplier yet; without a limit the direction of its slip would be
    ! round-off where symmetry prevents any slip.
    if (multiplier(1) < 0.0_rk) trial = multiplier(1)
    iterate(1) = k_n*opening
    tangent(1, 1) = k_n
    limit = point%cohesion - law%friction*trial
    z = multiplier(2:3)*(1.0_rk - scale(2)/k) + scale(2)*(point%jump(2:3) - slip)
    size_of_z = sqrt(z(1)**2 + z(2)**2)
    if (size_of_z <= limit .and. (law%friction > 0.0_rk .or. point%cohesion > 0.0_rk)) then
      iterate(2:3) = k*(point%jump(2:3) - slip)
      tangent(2, 2) = k
      tangent(3, 3) = k
      return
    end if
    e = z/max(size_of_z, tiny(limit))
    rho = limit/max(size_of_z, tiny(limit))
    softening = 1.0_rk/(1.0_rk - rho*(1.0_rk - scale(2)/k))
    rest = multiplier(2:3) - dot_product(e, multiplier(2:3))*e
    iterate(2:3) = slip_limit(law, opening, point%cohesion)*e + (1.0_rk - softening)*rest
    tangent(2:3, 1) = -law%friction*k_n*e
    tangent(2, 2:3) = softening*rho*scale(2)*([1.0_rk, 0.0_rk] - e(1)*e)
    tangent(3, 2:3) = softening*rho*scale(2)*([0.0_rk, 1.0_rk] - e(2)*e)
  end subroutine augment

  !> Largest tangential traction of the closed joint: mu p + c [Pa].
  pure real(rk) function slip_limit(law, opening, cohesion)
    type(contraction_law), intent(in) :: law
    real(rk), intent(in) :: opening !< <= 0 in contact [m]
    real(rk), intent(in) :: cohesion !< c [Pa]
    slip_limit = cohesion - law%friction*law%normal_stiffness*opening
  end function slip_limit
end module joint_contraction
