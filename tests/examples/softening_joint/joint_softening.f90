!> A cohesive joint that softens: the worked example of a joint law with a history of its own.
!>
!> The normal traction rises with k_n to the strength f at the opening v_0 = f/k_n and falls on a
!> straight line to zero at v_f = 2 G_f/f. The secant share s = t(w)/(k_n w) belongs to the largest
!> opening w so far; below w the joint unloads to the origin: t = s k_n v, and s k_t v in shear.
!> Closed, it carries k_n times the closing. G_f is the work of fracture per area.
module joint_softening
  use deck_card, only: card
  use diagnostics, only: diagnostic_list
  use joint_law, only: allocate_state, joint_state, state_bonded, state_open, state_stick, &
                       traction_law
  use keyword_spec, only: field, keyword_variant, kind_real
  use kinds, only: rk
  implicit none
  private
  public :: softening_law

  type, extends(traction_law) :: softening_law
    real(rk) :: normal_stiffness = 0.0_rk !< k_n [Pa/m]
    real(rk) :: tangent_stiffness = 0.0_rk !< k_t [Pa/m]
    real(rk) :: strength = 0.0_rk !< f [Pa]
    real(rk) :: fracture_energy = 0.0_rk !< G_f [J/m2]
  contains
    procedure, nopass :: describe
    procedure :: read_card
    procedure :: start_state
    procedure :: reference_stiffness
    procedure :: update
    procedure :: stored_energy
    procedure :: limits
    procedure, private :: end_of_softening
    procedure, private :: secant
    procedure, private :: dissipated
  end type softening_law

contains

  pure subroutine describe(entry)
    type(keyword_variant), intent(out) :: entry
    entry%name = 'SOFTENING'
    entry%meaning = 'A cohesive joint. It is elastic up to the tensile strength; beyond, the '// &
                    'traction falls linearly with the opening. FRACTURE ENERGY is the area '// &
                    'below the curve.'
    allocate (entry%parameters, source=[ &
              field('KN', kind_real, 'normal stiffness', 'Pa/m', is_required=.true., &
                    lowest=0.0_rk, excludes_lowest=.true.), &
              field('KT', kind_real, 'tangential stiffness', 'Pa/m', is_required=.true., &
                    lowest=0.0_rk, excludes_lowest=.true.), &
              field('TENSILE STRENGTH', kind_real, 'largest normal traction', 'Pa', &
                    is_required=.true., lowest=0.0_rk, excludes_lowest=.true.), &
              field('FRACTURE ENERGY', kind_real, 'work of fracture per area', 'J/m2', &
                    is_required=.true., lowest=0.0_rk, excludes_lowest=.true.)])
  end subroutine describe

  subroutine read_card(self, this, faults)
    class(softening_law), intent(inout) :: self
    type(card), intent(in) :: this
    type(diagnostic_list), intent(inout) :: faults
    self%normal_stiffness = this%real('KN')
    self%tangent_stiffness = this%real('KT')
    self%strength = this%real('TENSILE STRENGTH')
    self%fracture_energy = this%real('FRACTURE ENERGY')
    if (2.0_rk*self%fracture_energy*self%normal_stiffness <= self%strength**2) then
      call this%fault_parameter(faults, 'FRACTURE ENERGY', 'the joint stores more energy than '// &
                                'this before it softens', &
                                'more than TENSILE STRENGTH**2/(2 KN)')
    end if
  end subroutine read_card

  !> Intact where the faces touch, broken where they have a clearance.
  pure subroutine start_state(self, clearance, state)
    class(softening_law), intent(in) :: self
    real(rk), intent(in) :: clearance(:)
    type(joint_state), intent(out) :: state
    call allocate_state(clearance, state, num_internal=1) ! the largest opening
    state%status = state_bonded
    where (clearance > 0.0_rk)
      state%internal(1, :) = self%end_of_softening()
      state%is_broken = .true.
      state%status = state_open
    end where
  end subroutine start_state

  pure subroutine reference_stiffness(self, k)
    class(softening_law), intent(in) :: self
    real(rk), intent(out) :: k(3)
    k = [self%normal_stiffness, self%tangent_stiffness, self%tangent_stiffness]
  end subroutine reference_stiffness

  pure subroutine update(self, jump, old, new, tangent)
    class(softening_law), intent(in) :: self
    real(rk), intent(in) :: jump(:, :)
    type(joint_state), intent(in) :: old
    type(joint_state), intent(inout) :: new
    real(rk), intent(out) :: tangent(:, :, :)
    real(rk) :: k(3), v(3), w, s, last
    integer :: p, i
    call self%reference_stiffness(k)
    new%jump = jump
    tangent = 0.0_rk
    do p = 1, size(jump, 2)
      v = jump(:, p)
      v(1) = v(1) + old%gap(p)
      last = old%internal(1, p)
      w = max(last, v(1))
      s = self%secant(w)
      do i = 1, 3
        tangent(i, i, p) = s*k(i)
      end do
      if (v(1) <= 0.0_rk) tangent(1, 1, p) = k(1)
      new%traction(:, p) = [tangent(1, 1, p), tangent(2, 2, p), tangent(3, 3, p)]*v
      if (v(1) > last) tangent(:, 1, p) = tangent(:, 1, p) + k*v*secant_slope(self, w)
      new%internal(1, p) = w
      new%is_broken(p) = w >= self%end_of_softening()
      new%status(p) = state_bonded
      if (new%is_broken(p)) new%status(p) = merge(state_open, state_stick, v(1) > 0.0_rk)
      new%fracture_work(p) = old%fracture_work(p) + self%dissipated(w) - self%dissipated(last) &
                             + 0.5_rk*(self%secant(last) - s)*k(2)*sum(v(2:3)**2)
    end do
  end subroutine update

  pure subroutine stored_energy(self, state, energy)
    class(softening_law), intent(in) :: self
    type(joint_state), intent(in) :: state
    real(rk), intent(out) :: energy(:)
    integer :: i
    energy = 0.5_rk*state%traction(1, :)*(state%jump(1, :) + state%gap)
    do i = 2, 3
      energy = energy + 0.5_rk*state%traction(i, :)*state%jump(i, :)
    end do
  end subroutine stored_energy

  !> The strength; a broken joint has no friction.
  pure subroutine limits(self, friction, cohesion, strength)
    class(softening_law), intent(in) :: self
    real(rk), intent(out) :: friction, cohesion, strength
    friction = 0.0_rk
    cohesion = 0.0_rk
    strength = self%strength
  end subroutine limits

  !> v_f [m].
  pure real(rk) function end_of_softening(self)
    class(softening_law), intent(in) :: self
    end_of_softening = 2.0_rk*self%fracture_energy/self%strength
  end function end_of_softening

  !> s, from 1 (intact) to 0 (broken).
  elemental real(rk) function secant(self, w)
    class(softening_law), intent(in) :: self
    real(rk), intent(in) :: w !< largest opening [m]
    real(rk) :: v_0, v_f
    v_0 = self%strength/self%normal_stiffness
    v_f = self%end_of_softening()
    secant = 1.0_rk
    if (w > v_0) secant = v_0/w*max(0.0_rk, v_f - w)/(v_f - v_0)
  end function secant

  !> ds/dw [1/m].
  pure real(rk) function secant_slope(self, w)
    type(softening_law), intent(in) :: self
    real(rk), intent(in) :: w !< largest opening [m]
    real(rk) :: v_0, v_f
    v_0 = self%strength/self%normal_stiffness
    v_f = self%end_of_softening()
    secant_slope = 0.0_rk
    if (w > v_0 .and. w < v_f) secant_slope = -v_0*v_f/((v_f - v_0)*w**2)
  end function secant_slope

  !> Work of fracture of pure opening [J/m2]: area below the curve less the energy recovered by
  !> unloading.
  pure real(rk) function dissipated(self, w)
    class(softening_law), intent(in) :: self
    real(rk), intent(in) :: w !< largest opening [m]
    real(rk) :: v_0, v
    v_0 = self%strength/self%normal_stiffness
    v = min(w, self%end_of_softening())
    dissipated = 0.0_rk
    if (v <= v_0) return
    ! Of the triangle with corners (0, 0), (v_0, f) and (v, t(v)).
    dissipated = 0.5_rk*(self%strength*v - v_0*self%secant(v)*self%normal_stiffness*v)
  end function dissipated
end module joint_softening
