!> Warns of loads that are probably not meant: weight twice, a record that does not end at zero, a
!> level above the crest.
module check_loads
  use amplitudes, only: amplitude
  use deck_card, only: card
  use deck_scan, only: is_keyword, steps_of_cards
  use diagnostics, only: diagnostic_list
  use growing_lists, only: append, make_room
  use kinds, only: rk
  use load_base_motion, only: base_motion
  use load_cards, only: load_card_list, target_of_motion
  use load_gravity, only: gravity_load
  use mesh_faces, only: face_nodes
  use model_draft, only: draft
  use named_things, only: find_surface_name
  use step_plan, only: step_load
  use text_table, only: text_numbers
  use write_text, only: as_text
  implicit none
  private
  public :: warn_of_loads

  real(rk), parameter :: small_share = 0.01_rk !< of the peak: the end of a record counts as zero
  real(rk), parameter :: round_off = 1.0e-9_rk
  !> Part of the height of a surface: less is 0.2 m of water at a face of 100 m. A level in m beside
  !> coordinates in mm is a thousandth of what was meant.
  real(rk), parameter :: least_wet = 2.0e-3_rk

  !> The weights that act at the end of a step, by their names.
  type :: weights_by_name
    type(text_numbers) :: names
    integer, allocatable :: first(:) !< (names) entry, 0 for none
    integer, allocatable :: load(:), next(:) !< (entries) load, and entry of the same name or 0
  end type weights_by_name

  !> The weights of a step by their elements.
  type :: weights_by_element
    integer, allocatable :: newest(:) !< (elements) entry, 0 for none
    integer :: num_entries = 0
    integer, allocatable :: load(:), before(:) !< (entries) load, and entry of the element or 0
  end type weights_by_element

contains

  !> The deck must have no errors.
  subroutine warn_of_loads(model, cards, faults)
    type(draft), intent(in) :: model
    type(load_card_list), intent(in) :: cards !< of the deck
    type(diagnostic_list), intent(inout) :: faults
    call warn_of_weights(model, cards, faults)
    call warn_of_lost_weights(model, cards, faults)
    call warn_of_records(model, cards, faults)
    call warn_of_levels(model, faults)
  end subroutine warn_of_loads

  !> Elements whose weight acts twice in one direction, in the first step that has any.
  subroutine warn_of_weights(model, cards, faults)
    type(draft), intent(in) :: model
    type(load_card_list), intent(in) :: cards
    type(diagnostic_list), intent(inout) :: faults
    logical, dimension(size(model%problem%loads)) :: acts, acted !< in the step, in that before
    integer :: first, second, e, s
    acted = .false.
    do s = 1, size(model%problem%steps)
      acts = .false.
      associate (now => model%problem%steps(s)%loads)
        acts(now%load) = abs(now%end_factor) > 0.0_rk
      end associate
      if (all(acted .or. .not. acts)) cycle ! no load has come
      acted = acts
      call find_second_weight(model, s, first, second, e)
      if (second == 0) cycle
      associate (loads => model%problem%loads)
        call model%cards(cards%find('DLOAD', loads(second)%item%target, s, &
                                    otherwise=model%procedure_card(s)))%warn( &
          faults, 'the weight of element '//as_text(model%problem%mesh%element_id(e))// &
          ' acts twice in step '//as_text(s)//": '"//loads(first)%item%target//"' and '"// &
          loads(second)%item%target//"' add up")
      end associate
      return
    end do
  end subroutine warn_of_weights

  !> Weights that a line with another direction replaces, so that nothing acts along the old one:
  !> in CalculiX both act.
  subroutine warn_of_lost_weights(model, cards, faults)
    type(draft), intent(in) :: model
    type(load_card_list), intent(in) :: cards
    type(diagnostic_list), intent(inout) :: faults
    type(weights_by_name) :: new
    integer :: i, s
    do s = 2, size(model%problem%steps)
      if (.not. any(abs(model%problem%steps(s)%loads%end_factor) <= 0.0_rk)) cycle
      call list_weights(model, model%problem%steps(s)%loads, new)
      do i = 1, size(model%problem%steps(s)%loads)
        associate (work => model%problem%steps(s)%loads(i))
          if (abs(work%end_factor) > 0.0_rk) cycle
          select type (old => model%problem%loads(work%load)%item)
          type is (gravity_load)
            if (.not. is_turned(model, new, old)) cycle
            call model%cards(cards%find('DLOAD', old%target, s, &
                                        otherwise=model%procedure_card(s)))%warn( &
              faults, "'"//old%target//"' of an earlier step ends: this card replaces it by "// &
              'one of another direction; expected both directions in this step if both are meant')
          end select
        end associate
      end do
    end do
  end subroutine warn_of_lost_weights

  !> Lists the weights that a step does not end.
  pure subroutine list_weights(model, loads, list)
    type(draft), intent(in) :: model
    type(step_load), intent(in) :: loads(:) !< of the step
    type(weights_by_name), intent(out) :: list
    integer :: i, name
    allocate (list%first(size(loads)), source=0)
    allocate (list%next(size(loads)), list%load(size(loads)))
    do i = size(loads), 1, -1
      if (abs(loads(i)%end_factor) <= 0.0_rk) cycle
      select type (weight => model%problem%loads(loads(i)%load)%item)
      type is (gravity_load)
        call list%names%find_or_add(weight%target, name)
        list%load(i) = loads(i)%load
        list%next(i) = list%first(name)
        list%first(name) = i
      end select
    end do
  end subroutine list_weights

  !> Whether a step gives a weight of the same name, but none along the old direction.
  pure logical function is_turned(model, list, old)
    type(draft), intent(in) :: model
    type(weights_by_name), intent(in) :: list !< of the step
    type(gravity_load), intent(in) :: old
    integer :: i, name
    is_turned = .false.
    name = list%names%find(old%target)
    if (name == 0) return
    i = list%first(name)
    do while (i > 0)
      select type (new => model%problem%loads(list%load(i))%item)
      type is (gravity_load)
        is_turned = abs(dot_product(new%acceleration, old%acceleration)) &
                    <= round_off*norm2(new%acceleration)*norm2(old%acceleration)
        if (.not. is_turned) return
      end select
      i = list%next(i)
    end do
  end function is_turned

  !> The first load of a step that gives weight to an element that has weight in this direction;
  !> `second` is 0 without one.
  pure subroutine find_second_weight(model, s, first, second, e)
    type(draft), intent(in) :: model
    integer, intent(in) :: s !< step
    integer, intent(out) :: first, second !< loads
    integer, intent(out) :: e !< position of the element
    type(weights_by_element) :: list
    integer :: i, k
    first = 0
    second = 0
    e = 0
    do i = 1, size(model%problem%steps(s)%loads)
      associate (work => model%problem%steps(s)%loads(i))
        if (abs(work%end_factor) <= 0.0_rk) cycle
        select type (weight => model%problem%loads(work%load)%item)
        type is (gravity_load)
          if (.not. allocated(list%newest)) then
            allocate (list%newest(model%problem%mesh%num_elements), source=0)
          end if
          do k = 1, size(weight%elements)
            e = weight%elements(k)
            first = owner_of(model, list, e, weight%acceleration)
            if (first > 0) second = work%load
            if (first > 0) return
            call make_room(list%before, list%num_entries, 1)
            list%before(list%num_entries + 1) = list%newest(e)
            call append(list%load, list%num_entries, work%load)
            list%newest(e) = list%num_entries
          end do
        end select
      end associate
    end do
  end subroutine find_second_weight

  !> The load that gives an element weight in a direction, 0 for none.
  pure integer function owner_of(model, list, element, direction) result(owner)
    type(draft), intent(in) :: model
    type(weights_by_element), intent(in) :: list
    integer, intent(in) :: element !< position
    real(rk), intent(in) :: direction(3) !< of length 1
    integer :: i
    i = list%newest(element)
    do while (i > 0)
      owner = list%load(i)
      select type (weight => model%problem%loads(owner)%item)
      type is (gravity_load)
        if (norm2(weight%acceleration - direction) <= round_off) return
      end select
      i = list%before(i)
    end do
    owner = 0
  end function owner_of

  !> Records of base motion whose end value acts on.
  subroutine warn_of_records(model, cards, faults)
    type(draft), intent(in) :: model
    type(load_card_list), intent(in) :: cards
    type(diagnostic_list), intent(inout) :: faults
    integer :: i, s
    do s = 1, size(model%problem%steps)
      if (.not. model%problem%steps(s)%procedure%has_inertia) cycle
      do i = 1, size(model%problem%steps(s)%loads)
        associate (work => model%problem%steps(s)%loads(i))
          if (work%amplitude == 0) cycle
          select type (item => model%problem%loads(work%load)%item)
          type is (base_motion)
            call warn_of_end(model, cards, s, item%dof, work, faults)
          end select
        end associate
      end do
    end do
  end subroutine warn_of_records

  subroutine warn_of_end(model, cards, s, dof, work, faults)
    type(draft), intent(in) :: model
    type(load_card_list), intent(in) :: cards
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
      place = cards%find('BASE MOTION', target_of_motion(dof, record%name), s, &
                         otherwise=0)
      if (place == 0) return
      call model%cards(place)%warn(faults, "the record '"//record%name//"' ends at "// &
                                   as_text(last*work%end_factor)//', not at zero: this '// &
                                   'acceleration goes on after t = '//as_text(ends_at)//' s')
    end associate
  end subroutine warn_of_end

  !> Time at the end of a step on the clock of a history [s].
  pure real(rk) function end_of_clock(model, s, record) result(time)
    type(draft), intent(in) :: model
    integer, intent(in) :: s !< step
    type(amplitude), intent(in) :: record
    time = model%problem%steps(s)%duration
    if (record%uses_total_time) time = sum(model%problem%steps(:s)%duration)
  end function end_of_clock

  !> Water above the highest node of its surface does not act, nor above what is built of it; water
  !> at its very foot is a level in another unit than that of the coordinates.
  subroutine warn_of_levels(model, faults)
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    real(rk) :: crest, built, foot, level, bed
    character(:), allocatable :: place
    integer :: i, step(size(model%cards))
    step = steps_of_cards(model%cards)
    do i = 1, size(model%cards)
      if (.not. is_keyword(model%cards(i), 'RESERVOIR')) cycle
      call measure_surface(model, model%cards(i), step(i), foot, crest, built)
      level = model%cards(i)%real('LEVEL')
      bed = model%cards(i)%real('BED')
      if (level - max(bed, foot) < least_wet*(crest - foot)) then
        call model%cards(i)%warn(faults, 'the level, '//as_text(level)//', is at the foot of '// &
                                 'the surface, which goes from '//as_text(foot)//' to '// &
                                 as_text(crest), 'a level in the unit of the coordinates')
      end if
      if (level <= built + round_off*(level - bed) .or. built < foot) cycle
      place = 'the surface'
      if (built < crest) place = 'the surface in this step'
      call model%cards(i)%warn(faults, 'the level, '//as_text(level)//', is above the top of '// &
                               place//', '//as_text(built)//': water above the top does not act')
    end do
  end subroutine warn_of_levels

  !> Lowest and highest node of the surface of a reservoir, and the highest of what is there of it.
  subroutine measure_surface(model, this, s, foot, crest, built)
    type(draft), intent(in) :: model
    type(card), intent(in) :: this
    integer, intent(in) :: s !< step
    real(rk), intent(out) :: foot, crest, built !< `built` is below `foot` where nothing is there
    integer :: f, up
    up = this%integer('UP')
    foot = huge(1.0_rk)
    crest = -huge(1.0_rk)
    built = -huge(1.0_rk)
    associate (mesh => model%problem%mesh, &
               faces => model%problem%surfaces(find_surface_name(model, this%word('SURFACE'))))
      do f = 1, size(faces%element)
        associate (heights => mesh%x(up, face_nodes(mesh, faces%element(f), faces%face(f))))
          crest = max(crest, maxval(heights))
          foot = min(foot, minval(heights))
          if (.not. model%problem%stages%has_element(faces%element(f), s)) cycle
          built = max(built, maxval(heights))
        end associate
      end do
    end associate
  end subroutine measure_surface
end module check_loads
