!> Warns of a pressure, or of water, of an earlier step that goes on beside a new one of its kind on
!> the same face under another name: a load is replaced under its own name alone. Warns of OP=NEW of
!> *DLOAD or *DSLOAD that leaves pressures of the other keyword acting.
module check_pressures
  use applied_load, only: load
  use dam_mesh, only: surface
  use deck_card, only: card
  use deck_scan, only: is_keyword, steps_of_cards
  use diagnostics, only: diagnostic_list
  use growing_lists, only: append, make_room
  use kinds, only: rk
  use load_cards, only: load_card_list
  use load_pressure, only: pressure_load
  use load_reservoir, only: reservoir_load
  use model_draft, only: draft
  use step_plan, only: step_load
  use write_text, only: as_text
  implicit none
  private
  public :: find_faces, warn_of_pressures

  integer, parameter :: num_kinds = 3 !< of loads on faces

  !> The loads of one kind by face.
  type :: load_table
    integer, allocatable :: load(:, :) !< (6, elements) the first load that pushes, 0 for none
  end type load_table

  !> The faces that loads of earlier steps push in a step.
  type :: pushed_faces
    type(load_table) :: tables(num_kinds)
    logical, allocatable :: has(:) !< (loads) the tables have the faces of this load
  end type pushed_faces

  !> Loads of earlier steps that warnings have named, and the steps of these warnings.
  type :: named_loads
    integer :: num = 0
    integer, allocatable :: load(:) !< `num` are in use
    integer, allocatable :: step(:)
  end type named_loads

contains

  !> The deck must have no errors.
  subroutine warn_of_pressures(model, cards, faults)
    type(draft), intent(in) :: model
    type(load_card_list), intent(in) :: cards !< of the deck
    type(diagnostic_list), intent(inout) :: faults
    type(pushed_faces) :: pushed
    type(named_loads) :: named
    logical, allocatable :: is_old(:) !< (loads) acts in the step before
    integer :: s, i, old, element
    allocate (is_old(size(model%problem%loads)))
    allocate (pushed%has(size(is_old)), source=.false.)
    do s = 2, size(model%problem%steps)
      is_old = .false.
      is_old(model%problem%steps(s - 1)%loads%load) = .true.
      associate (now => model%problem%steps(s)%loads)
        if (all(is_old(now%load))) cycle
        call push_old(model, now, is_old, pushed)
        do i = 1, size(now)
          if (is_old(now(i)%load)) cycle
          call find_shared(model, now(i)%load, pushed, old, element)
          if (element == 0) cycle
          call warn_of_both(model, cards, s, element, old, now(i)%load, faults)
          call note_named(named, old, s)
        end do
      end associate
    end do
    call warn_of_other_keyword(model, cards, named, faults)
  end subroutine warn_of_pressures

  !> OP=NEW of *DLOAD clears the loads of *DLOAD alone, that of *DSLOAD those of *DSLOAD, as in
  !> Abaqus. CalculiX clears both. Each pressure that goes on by this is named once. The weight is
  !> not named: it is meant to stay where new water comes.
  subroutine warn_of_other_keyword(model, cards, named, faults)
    type(draft), intent(in) :: model
    type(load_card_list), intent(in) :: cards
    type(named_loads), intent(in) :: named !< as acting beside new loads
    type(diagnostic_list), intent(inout) :: faults
    character(:), allocatable :: other
    logical, allocatable :: stays(:)
    logical :: is_named(size(model%problem%loads))
    integer :: step(size(model%cards)), i, first
    step = steps_of_cards(model%cards)
    is_named = .false.
    do i = 1, size(step)
      if (step(i) < 2 .or. .not. is_pressed_anew(model%cards(i))) cycle
      other = 'DLOAD'
      if (is_keyword(model%cards(i), 'DLOAD')) other = 'DSLOAD'
      call find_standing(model, cards, step, step(i), other, stays)
      call mark_named(named, step(i), is_named)
      stays = stays .and. .not. is_named
      if (.not. any(stays)) cycle
      is_named = is_named .or. stays
      first = findloc(stays, .true., dim=1)
      call model%cards(i)%warn( &
        faults, "OP=NEW leaves '"//model%problem%loads(first)%item%target//"' of *"//other// &
        others_in_words(count(stays) - 1)//' acting: it clears the loads of this keyword alone '// &
        '(CalculiX clears those of *DLOAD and *DSLOAD)', '*'//other//', OP=NEW in this step '// &
        'where they must end')
    end do
  end subroutine warn_of_other_keyword

  pure subroutine note_named(named, number, s)
    type(named_loads), intent(inout) :: named
    integer, intent(in) :: number !< of a load
    integer, intent(in) :: s !< step
    call make_room(named%step, named%num, 1)
    named%step(named%num + 1) = s
    call append(named%load, named%num, number)
  end subroutine note_named

  !> Marks the loads that warnings of a step have named.
  pure subroutine mark_named(named, s, is_named)
    type(named_loads), intent(in) :: named
    integer, intent(in) :: s !< step
    logical, intent(inout) :: is_named(:) !< (loads)
    integer :: i
    do i = 1, named%num
      if (named%step(i) == s) is_named(named%load(i)) = .true.
    end do
  end subroutine mark_named

  !> Whether a card is *DLOAD or *DSLOAD with OP=NEW.
  pure logical function is_pressed_anew(this)
    type(card), intent(in) :: this
    is_pressed_anew = .false.
    if (.not. (is_keyword(this, 'DLOAD') .or. is_keyword(this, 'DSLOAD'))) return
    is_pressed_anew = this%word('OP') == 'NEW'
  end function is_pressed_anew

  pure function others_in_words(num) result(text)
    integer, intent(in) :: num
    character(:), allocatable :: text
    text = ''
    if (num > 0) text = ' and '//as_text(num)//' more'
  end function others_in_words

  !> The pressures of a keyword that act in a step, have acted before and are not given in the step.
  !> None where a card of this keyword has OP=NEW in the step.
  subroutine find_standing(model, cards, step, s, keyword, stays)
    type(draft), intent(in) :: model
    type(load_card_list), intent(in) :: cards
    integer, intent(in) :: step(:) !< of each card
    integer, intent(in) :: s !< step
    character(*), intent(in) :: keyword !< DLOAD or DSLOAD
    logical, allocatable, intent(out) :: stays(:) !< (loads)
    logical :: is_old(size(model%problem%loads))
    integer :: i, found
    allocate (stays(size(is_old)), source=.false.)
    do i = 1, size(step)
      if (step(i) /= s .or. .not. is_keyword(model%cards(i), keyword)) cycle
      if (is_pressed_anew(model%cards(i))) return
    end do
    is_old = .false.
    is_old(model%problem%steps(s - 1)%loads%load) = .true.
    associate (now => model%problem%steps(s)%loads)
      do i = 1, size(now)
        if (model%problem%loads(now(i)%load)%item%family /= keyword) cycle
        if (is_ending(now(i)) .or. .not. is_old(now(i)%load)) cycle
        if (.not. is_pressure(model%problem%loads(now(i)%load)%item)) cycle
        associate (item => model%problem%loads(now(i)%load)%item)
          found = cards%find(item%family, item%target, s, otherwise=model%procedure_card(s))
        end associate
        stays(now(i)%load) = step(found) < s
      end do
    end associate
  end subroutine find_standing

  !> Whether a load is a pressure, else a weight.
  pure logical function is_pressure(item)
    class(load), intent(in) :: item
    is_pressure = .false.
    select type (item)
    type is (pressure_load)
      is_pressure = .true.
    end select
  end function is_pressure

  !> Enters the loads of earlier steps that go on. While none of them ends, only those that have
  !> come are entered.
  subroutine push_old(model, now, is_old, pushed)
    type(draft), intent(in) :: model
    type(step_load), intent(in) :: now(:) !< loads of the step
    logical, intent(in) :: is_old(:) !< (loads) acts in the step before
    type(pushed_faces), intent(inout) :: pushed
    logical :: goes_on(size(is_old))
    integer :: i
    goes_on = .false.
    do i = 1, size(now)
      goes_on(now(i)%load) = is_old(now(i)%load) .and. .not. is_ending(now(i))
    end do
    if (any(pushed%has .and. .not. goes_on)) then
      pushed%has = .false.
      do i = 1, num_kinds
        if (allocated(pushed%tables(i)%load)) pushed%tables(i)%load = 0
      end do
    end if
    do i = 1, size(goes_on)
      if (goes_on(i) .and. .not. pushed%has(i)) call push_faces(model, i, pushed)
    end do
  end subroutine push_old

  !> Whether a load fades to zero in its step.
  pure logical function is_ending(work)
    type(step_load), intent(in) :: work
    is_ending = work%amplitude == 0 .and. abs(work%end_factor) <= 0.0_rk
  end function is_ending

  !> Enters the faces of a load.
  subroutine push_faces(model, number, pushed)
    type(draft), intent(in) :: model
    integer, intent(in) :: number !< of the load
    type(pushed_faces), intent(inout) :: pushed
    type(surface) :: faces
    integer :: i, kind
    pushed%has(number) = .true.
    call find_faces(model%problem%loads(number)%item, faces, kind)
    if (kind == 0) return
    associate (table => pushed%tables(kind))
      if (.not. allocated(table%load)) then
        allocate (table%load(6, model%problem%mesh%num_elements), source=0)
      end if
      do i = 1, size(faces%element)
        associate (first => table%load(faces%face(i), faces%element(i)))
          if (first == 0 .or. first > number) first = number
        end associate
      end do
    end associate
  end subroutine push_faces

  !> The first load of an earlier step that pushes a face of a new one, and the first element with
  !> such a face. A load that the new step gives again under the name of the new one is meant.
  subroutine find_shared(model, new, pushed, old, element)
    type(draft), intent(in) :: model
    integer, intent(in) :: new !< load
    type(pushed_faces), intent(in) :: pushed
    integer, intent(out) :: old !< load, 0 for none
    integer, intent(out) :: element !< position, 0 for none
    type(surface) :: faces
    integer :: i, kind, other
    old = 0
    element = 0
    call find_faces(model%problem%loads(new)%item, faces, kind)
    if (kind == 0) return
    associate (table => pushed%tables(kind), loads => model%problem%loads)
      if (.not. allocated(table%load)) return
      do i = 1, size(faces%element)
        other = table%load(faces%face(i), faces%element(i))
        if (other == 0 .or. (old > 0 .and. other >= old)) cycle
        if (loads(other)%item%target == loads(new)%item%target .and. &
            loads(other)%item%family == loads(new)%item%family) cycle
        old = other
        element = faces%element(i)
      end do
    end associate
  end subroutine find_shared

  !> The faces that a load pushes, and its kind: 1 uniform pressure, 2 hydrostatic pressure, 3 water
  !> of a reservoir, 0 for a load without faces.
  pure subroutine find_faces(item, faces, kind)
    class(load), intent(in) :: item
    type(surface), intent(out) :: faces
    integer, intent(out) :: kind
    kind = 0
    select type (item)
    type is (pressure_load)
      kind = merge(2, 1, item%is_hydrostatic)
      faces = item%faces
    type is (reservoir_load)
      if (item%is_hydrostatic .or. item%has_added_mass) kind = 3
      faces = item%faces
    end select
  end subroutine find_faces

  !> The warning, at the last card that gives the new load.
  subroutine warn_of_both(model, cards, s, element, first, second, faults)
    type(draft), intent(in) :: model
    type(load_card_list), intent(in) :: cards
    integer, intent(in) :: s !< step
    integer, intent(in) :: element !< position
    integer, intent(in) :: first, second !< loads
    type(diagnostic_list), intent(inout) :: faults
    character(:), allocatable :: what, remedy
    integer :: found
    associate (loads => model%problem%loads)
      what = 'pressure'
      remedy = 'a load is replaced under its own name, or with OP=NEW of *'// &
               loads(first)%item%family
      if (loads(second)%item%family == 'RESERVOIR') then
        what = 'water of *RESERVOIR'
        remedy = 'a reservoir is replaced under its own name, and emptied there by HYDROSTATIC=NO'
      end if
      found = cards%find(loads(second)%item%family, loads(second)%item%target, s, &
                         otherwise=model%procedure_card(s))
      call model%cards(found)%warn( &
        faults, 'element '//as_text(model%problem%mesh%element_id(element))//' keeps the '// &
        what//" '"//loads(first)%item%target//"' of an earlier step beside '"// &
        loads(second)%item%target//"': "//remedy)
    end associate
  end subroutine warn_of_both
end module check_pressures
