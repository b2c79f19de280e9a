!> Warns of reservoirs that act in part only, or not at all.
module check_water
  use deck_card, only: card
  use deck_scan, only: is_keyword, steps_of_cards
  use diagnostics, only: diagnostic_list
  use kinds, only: rk
  use load_gravity, only: gravity_load
  use mesh_faces, only: face_nodes
  use model_draft, only: draft
  use named_things, only: find_surface_name
  use text_table, only: text_numbers
  use write_text, only: as_text
  implicit none
  private
  public :: warn_of_water

  real(rk), parameter :: round_off = 1.0e-9_rk

contains

  !> The deck must have no errors.
  subroutine warn_of_water(model, faults)
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer :: step(size(model%cards)), earlier(size(model%cards))
    integer :: i
    step = steps_of_cards(model%cards)
    earlier = earlier_reservoirs(model, step)
    do i = 1, size(step)
      if (.not. is_keyword(model%cards(i), 'RESERVOIR')) cycle
      if (earlier(i) > 0) then
        if (empties(model%cards(i), model%cards(earlier(i)))) cycle
      end if
      call warn_of_effects(model%cards(i), model, step(i), faults)
      call warn_of_height(model%cards(i), model, faults)
      call warn_of_axis(model%cards(i), model, step(i), faults)
    end do
  end subroutine warn_of_water

  !> The last card of each reservoir in an earlier step, 0 for none and for other cards.
  pure function earlier_reservoirs(model, step) result(earlier)
    type(draft), intent(in) :: model
    integer, intent(in) :: step(:) !< of each card
    integer :: earlier(size(step))
    type(text_numbers) :: names
    integer :: last(size(step)) !< (names) card
    integer :: i, n
    earlier = 0
    last = 0
    do i = 1, size(step)
      if (.not. is_keyword(model%cards(i), 'RESERVOIR')) cycle
      call names%find_or_add(model%cards(i)%word('NAME'), n)
      if (last(n) > 0) earlier(i) = merge(earlier(last(n)), last(n), step(last(n)) == step(i))
      last(n) = i
    end do
  end function earlier_reservoirs

  !> Whether a card without pressure and mass empties the reservoir of an earlier step.
  pure logical function empties(this, earlier)
    type(card), intent(in) :: this, earlier
    empties = .not. has_water(this) .and. has_water(earlier)
  end function empties

  !> Whether a *RESERVOIR has pressure or mass.
  pure logical function has_water(this)
    type(card), intent(in) :: this
    has_water = this%word('HYDROSTATIC') == 'YES' .or. this%word('ADDED MASS') /= 'NONE'
  end function has_water

  !> Pressure and added mass that have no effect, and parameters of what does not act.
  subroutine warn_of_effects(this, model, s, faults)
    type(card), intent(in) :: this
    type(draft), intent(in) :: model
    integer, intent(in) :: s !< step
    type(diagnostic_list), intent(inout) :: faults
    character(:), allocatable :: later
    logical :: has_pressure, has_mass
    has_pressure = this%word('HYDROSTATIC') == 'YES'
    has_mass = this%word('ADDED MASS') /= 'NONE'
    associate (procedures => model%problem%steps(s:)%procedure)
      later = ''
      if (any(.not. procedures%finds_modes)) then
        later = '; the pressure acts from the next *STATIC or *DYNAMIC on'
      end if
      if (.not. (has_pressure .or. has_mass)) then
        call this%warn(faults, 'has no effect: HYDROSTATIC=NO and ADDED MASS=NONE')
        return
      else if (procedures(1)%finds_modes .and. .not. has_mass) then
        call this%warn(faults, 'has no effect in a step *FREQUENCY: ADDED MASS=NONE'//later)
      else if (has_mass .and. .not. any(procedures%has_inertia .or. procedures%finds_modes)) then
        call this%warn(faults, 'ADDED MASS has no effect: no *DYNAMIC or *FREQUENCY step from '// &
                       'here on')
      end if
    end associate
    if (this%has('DIRECTION') .and. .not. has_mass) then
      call this%warn(faults, 'DIRECTION has no effect: ADDED MASS=NONE')
    end if
    if (this%has('GRAVITY') .and. .not. has_pressure) then
      call this%warn(faults, 'GRAVITY has no effect: HYDROSTATIC=NO')
    end if
  end subroutine warn_of_effects

  !> Water between the bed and the lowest node of the surface does not act below the bed.
  subroutine warn_of_height(this, model, faults)
    type(card), intent(in) :: this
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    real(rk) :: lowest, bed
    integer :: f
    lowest = huge(1.0_rk)
    bed = this%real('BED')
    associate (mesh => model%problem%mesh, up => this%integer('UP'), &
               faces => model%problem%surfaces(find_surface_name(model, this%word('SURFACE'))))
      do f = 1, size(faces%element)
        lowest = min(lowest, minval(mesh%x(up, face_nodes(mesh, faces%element(f), faces%face(f)))))
      end do
    end associate
    if (bed <= lowest + round_off*(this%real('LEVEL') - bed)) return
    call this%warn(faults, 'the surface goes down to '//as_text(lowest)//', below BED, '// &
                   as_text(bed)//': there the water does not act')
  end subroutine warn_of_height

  !> The weight of the same step should act against UP.
  subroutine warn_of_axis(this, model, s, faults)
    type(card), intent(in) :: this
    type(draft), intent(in) :: model
    integer, intent(in) :: s !< step
    type(diagnostic_list), intent(inout) :: faults
    integer :: i, axis, up
    up = this%integer('UP')
    do i = 1, size(model%problem%steps(s)%loads)
      select type (weight => model%problem%loads(model%problem%steps(s)%loads(i)%load)%item)
      type is (gravity_load)
        axis = maxloc(abs(weight%acceleration), dim=1)
        if (axis == up) cycle
        call this%warn(faults, 'the water stands along axis '//as_text(this%integer('UP'))// &
                       ' (UP), and the weight of this step acts along axis '//as_text(axis))
        return
      end select
    end do
    call warn_of_upward_weight(this, model, s, faults)
  end subroutine warn_of_axis

  !> The weights of a step act upwards, all of them: one that acts upwards beside one that acts
  !> downwards may stand for an earthquake.
  subroutine warn_of_upward_weight(this, model, s, faults)
    type(card), intent(in) :: this
    type(draft), intent(in) :: model
    integer, intent(in) :: s !< step
    type(diagnostic_list), intent(inout) :: faults
    real(rk) :: upwards
    integer :: i, up
    up = this%integer('UP')
    upwards = 0.0_rk
    do i = 1, size(model%problem%steps(s)%loads)
      associate (work => model%problem%steps(s)%loads(i))
        select type (weight => model%problem%loads(work%load)%item)
        type is (gravity_load)
          upwards = work%end_factor*weight%acceleration(up)
          if (work%amplitude > 0 .or. .not. upwards > 0.0_rk) return
        end select
      end associate
    end do
    if (.not. upwards > 0.0_rk) return
    call this%warn(faults, 'the weight of this step acts upwards: axis '// &
                   as_text(this%integer('UP'))//' points up (UP)', &
                   'GRAV, '//as_text(upwards)//' with a direction of -1 along this axis')
  end subroutine warn_of_upward_weight
end module check_water
