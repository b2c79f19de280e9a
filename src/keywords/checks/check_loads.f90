!> Warns of loads that are probably not meant: weight twice, a record that does not end at zero, a
!> level above the crest.
module check_loads
  use amplitudes, only: amplitude
  use deck_scan, only: is_keyword, steps_of_cards
  use dload_labels, only: elements_in_words
  use diagnostics, only: diagnostic_list
  use kinds, only: rk
  use load_base_motion, only: base_motion
  use load_gravity, only: gravity_load
  use mesh_faces, only: face_nodes
  use model_draft, only: draft
  use named_things, only: find_surface_name
  use step_plan, only: step_load
  use write_text, only: as_text
  implicit none
  private
  public :: card_of_dload, card_of_motion, warn_of_loads

  real(rk), parameter :: small_share = 0.01_rk !< of the peak: the end of a record counts as zero
  real(rk), parameter :: round_off = 1.0e-9_rk
  !> Part of the height of a surface: less is 0.2 m of water at a face of 100 m. A level in m beside
  !> coordinates in mm is a thousandth of what was meant.
  real(rk), parameter :: least_wet = 2.0e-3_rk

contains

  !> The deck must have no errors.
  subroutine warn_of_loads(model, faults)
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer :: step(size(model%cards))
    step = steps_of_cards(model%cards)
    call warn_of_weights(model, step, faults)
    call warn_of_lost_weights(model, step, faults)
    call warn_of_records(model, step, faults)
    call warn_of_levels(model, faults)
  end subroutine warn_of_loads

  !> Elements whose weight acts twice in one direction, in the first step that has any.
  subroutine warn_of_weights(model, step, faults)
    type(draft), intent(in) :: model
    integer, intent(in) :: step(:) !< of each card
    type(diagnostic_list), intent(inout) :: faults
    integer :: first, second, e, s
    do s = 1, size(model%problem%steps)
      call find_second_weight(model, s, first, second, e)
      if (second == 0) cycle
      associate (loads => model%problem%loads)
        call model%cards(card_of_dload(model, step, s, loads(second)%item%target))%warn( &
          faults, 'the weight of element '//as_text(model%problem%mesh%element_id(e))// &
          ' acts twice in step '//as_text(s)//": '"//loads(first)%item%target//"' and '"// &
          loads(second)%item%target//"' add up")
      end associate
      return
    end do
  end subroutine warn_of_weights

  !> Weights that a line with another direction replaces, so that nothing acts along the old one:
  !> in CalculiX both act.
  subroutine warn_of_lost_weights(model, step, faults)
    type(draft), intent(in) :: model
    integer, intent(in) :: step(:) !< of each card
    type(diagnostic_list), intent(inout) :: faults
    integer :: i, s
    do s = 2, size(model%problem%steps)
      do i = 1, size(model%problem%steps(s)%loads)
        associate (work => model%problem%steps(s)%loads(i))
          if (abs(work%end_factor) > 0.0_rk) cycle
          select type (old => model%problem%loads(work%load)%item)
          type is (gravity_load)
            if (.not. is_turned(model, s, old)) cycle
            call model%cards(card_of_dload(model, step, s, old%target))%warn( &
              faults, "'"//old%target//"' of an earlier step ends: this card replaces it by "// &
              'one of another direction; expected both directions in this step if both are meant')
          end select
        end associate
      end do
    end do
  end subroutine warn_of_lost_weights

  !> Whether a step gives a weight of the same name, but none along the old direction.
  pure logical function is_turned(model, s, old)
    type(draft), intent(in) :: model
    integer, intent(in) :: s !< step
    type(gravity_load), intent(in) :: old
    integer :: i
    is_turned = .false.
    do i = 1, size(model%problem%steps(s)%loads)
      associate (work => model%problem%steps(s)%loads(i))
        if (abs(work%end_factor) <= 0.0_rk) cycle
        select type (new => model%problem%loads(work%load)%item)
        type is (gravity_load)
          if (new%target /= old%target) cycle
          is_turned = abs(dot_product(new%acceleration, old%acceleration)) &
                      <= round_off*norm2(new%acceleration)*norm2(old%acceleration)
          if (.not. is_turned) return
        end select
      end associate
    end do
  end function is_turned

  !> The first load of a step that gives weight to an element that has weight in this direction;
  !> `second` is 0 without one.
  pure subroutine find_second_weight(model, s, first, second, e)
    type(draft), intent(in) :: model
    integer, intent(in) :: s !< step
    integer, intent(out) :: first, second !< loads
    integer, intent(out) :: e !< position of the element
    integer, allocatable :: owner(:, :) !< (elements, directions) load that gives the weight
    real(rk), allocatable :: directions(:, :)
    integer :: i, d
    second = 0
    e = 0
    allocate (owner(model%problem%mesh%num_elements, 0), directions(3, 0))
    do i = 1, size(model%problem%steps(s)%loads)
      associate (work => model%problem%steps(s)%loads(i))
        if (abs(work%end_factor) <= 0.0_rk) cycle
        select type (weight => model%problem%loads(work%load)%item)
        type is (gravity_load)
          call find_direction(weight%acceleration, directions, d)
          if (d > size(owner, 2)) owner = reshape(owner, [size(owner, 1), d], pad=[0])
          call own_elements(weight%elements, work%load, owner(:, d), first, e)
          if (e > 0) second = work%load
        end select
      end associate
      if (second > 0) return
    end do
  end subroutine find_second_weight

  !> Enters a load as the owner of its elements, up to an element that has an owner.
  pure subroutine own_elements(elements, load, owner, first, e)
    integer, intent(in) :: elements(:), load
    integer, intent(inout) :: owner(:) !< (elements) 0: none so far
    integer, intent(out) :: first !< owner of the element `e`
    integer, intent(inout) :: e !< element with two owners, unchanged without one
    integer :: k
    first = 0
    do k = 1, size(elements)
      first = owner(elements(k))
      if (first > 0) e = elements(k)
      if (first > 0) return
      owner(elements(k)) = load
    end do
  end subroutine own_elements

  !> The number of a direction in a list; a new direction is added.
  pure subroutine find_direction(direction, list, number)
    real(rk), intent(in) :: direction(3)
    real(rk), allocatable, intent(inout) :: list(:, :) !< (3, directions)
    integer, intent(out) :: number
    do number = 1, size(list, 2)
      if (norm2(list(:, number) - direction) <= round_off) return
    end do
    list = reshape([list, direction], [3, size(list, 2) + 1])
    number = size(list, 2)
  end subroutine find_direction

  !> The last card that gives a load of *DLOAD, up to a step.
  pure integer function card_of_dload(model, step, s, target) result(found)
    type(draft), intent(in) :: model
    integer, intent(in) :: step(:) !< of each card
    integer, intent(in) :: s !< step
    character(*), intent(in) :: target !< of the load: 'DAM GRAV', 'DAM P3'
    integer :: i, line
    found = model%procedure_card(s)
    do i = 1, size(step)
      if (step(i) > s .or. .not. is_keyword(model%cards(i), 'DLOAD')) cycle
      do line = 1, model%cards(i)%num_lines
        if (elements_in_words(model%cards(i), line)//' '//model%cards(i)%word_at(line, 2) &
            == target) found = i
      end do
    end do
  end function card_of_dload

  !> Records of base motion whose end value acts on.
  subroutine warn_of_records(model, step, faults)
    type(draft), intent(in) :: model
    integer, intent(in) :: step(:) !< of each card
    type(diagnostic_list), intent(inout) :: faults
    integer :: i, s
    do s = 1, size(model%problem%steps)
      if (.not. model%problem%steps(s)%procedure%has_inertia) cycle
      do i = 1, size(model%problem%steps(s)%loads)
        associate (work => model%problem%steps(s)%loads(i))
          if (work%amplitude == 0) cycle
          select type (item => model%problem%loads(work%load)%item)
          type is (base_motion)
            call warn_of_end(model, step, s, item%dof, work, faults)
          end select
        end associate
      end do
    end do
  end subroutine warn_of_records

  subroutine warn_of_end(model, step, s, dof, work, faults)
    type(draft), intent(in) :: model
    integer, intent(in) :: step(:) !< of each card
    integer, intent(in) :: s, dof
    type(step_load), intent(in) :: work
    type(diagnostic_list), intent(inout) :: faults
    real(rk) :: last, ends_at
    integer :: place
    associate (record => model%problem%amplitudes(work%amplitude))
      last = record%value(size(record%value))
      if (abs(last) <= small_share*maxval(abs(record%value))) return
      ends_at = record%time(size(record%time))
      if (ends_at > (1.0_rk + round_off)*end_of_clock(model, s, record)) return
      place = card_of_motion(model, step, s, dof, record%name)
      if (place == 0) return
      call model%cards(place)%warn(faults, "the record '"//record%name//"' ends at "// &
                                   as_text(last*work%end_factor)//', not at zero: this '// &
                                   'acceleration goes on after t = '//as_text(ends_at)//' s')
    end associate
  end subroutine warn_of_end

  !> The last *BASE MOTION, up to a step, that moves a direction by a record; 0 for none.
  pure integer function card_of_motion(model, step, s, dof, record) result(place)
    type(draft), intent(in) :: model
    integer, intent(in) :: step(:) !< of each card
    integer, intent(in) :: s, dof
    character(*), intent(in) :: record !< its name
    integer :: i
    place = 0
    do i = 1, size(step)
      if (step(i) > s .or. .not. is_keyword(model%cards(i), 'BASE MOTION')) cycle
      if (model%cards(i)%word('AMPLITUDE') /= record) cycle
      if (model%cards(i)%integer('DOF') == dof) place = i
    end do
  end function card_of_motion

  !> Time at the end of a step on the clock of a history [s].
  pure real(rk) function end_of_clock(model, s, record) result(time)
    type(draft), intent(in) :: model
    integer, intent(in) :: s !< step
    type(amplitude), intent(in) :: record
    time = model%problem%steps(s)%duration
    if (record%uses_total_time) time = sum(model%problem%steps(:s)%duration)
  end function end_of_clock

  !> Water above the highest node of its surface does not act; water at its very foot is a level in
  !> another unit than that of the coordinates.
  subroutine warn_of_levels(model, faults)
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    real(rk) :: crest, foot, level, bed
    integer :: i, f, found, up
    do i = 1, size(model%cards)
      if (.not. is_keyword(model%cards(i), 'RESERVOIR')) cycle
      found = find_surface_name(model, model%cards(i)%word('SURFACE'))
      up = model%cards(i)%integer('UP')
      crest = -huge(1.0_rk)
      foot = huge(1.0_rk)
      associate (mesh => model%problem%mesh, faces => model%problem%surfaces(found))
        do f = 1, size(faces%element)
          associate (heights => mesh%x(up, face_nodes(mesh, faces%element(f), faces%face(f))))
            crest = max(crest, maxval(heights))
            foot = min(foot, minval(heights))
          end associate
        end do
      end associate
      level = model%cards(i)%real('LEVEL')
      bed = model%cards(i)%real('BED')
      if (level - max(bed, foot) < least_wet*(crest - foot)) then
        call model%cards(i)%warn(faults, 'the level, '//as_text(level)//', is at the foot of '// &
                                 'the surface, which goes from '//as_text(foot)//' to '// &
                                 as_text(crest), 'a level in the unit of the coordinates')
      end if
      if (level <= crest + round_off*(level - bed)) cycle
      call model%cards(i)%warn(faults, 'the level, '//as_text(level)//', is above the top of '// &
                               'the surface, '//as_text(crest)//': water above the top does '// &
                               'not act')
    end do
  end subroutine warn_of_levels
end module check_loads
