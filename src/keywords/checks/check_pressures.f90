!> Warns of a pressure, or of water, of an earlier step that goes on beside a new one of its kind on
!> the same face under another name: a load is replaced under its own name alone. Warns of OP=NEW of
!> *DLOAD or *DSLOAD that leaves loads of the other keyword acting.
module check_pressures
  use applied_load, only: load
  use check_loads, only: card_of_dload
  use dam_mesh, only: surface
  use deck_card, only: card
  use deck_scan, only: is_keyword, steps_of_cards
  use diagnostics, only: diagnostic_list
  use kinds, only: rk
  use load_pressure, only: pressure_load
  use load_reservoir, only: reservoir_load
  use model_draft, only: draft
  use step_plan, only: step_load
  use write_text, only: as_text
  implicit none
  private
  public :: card_of_faces, find_faces, warn_of_other_keyword, warn_of_pressures

contains

  !> The deck must have no errors.
  subroutine warn_of_pressures(model, faults)
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer :: i, k, element, s
    do s = 2, size(model%problem%steps)
      associate (before => model%problem%steps(s - 1)%loads, now => model%problem%steps(s)%loads)
        do i = 1, size(now)
          if (any(before%load == now(i)%load)) cycle
          do k = 1, size(now)
            if (.not. any(before%load == now(k)%load) .or. is_ending(now(k))) cycle
            element = shared_element(model, now(k)%load, now(i)%load)
            if (element == 0) cycle
            call warn_of_both(model, s, element, now(k)%load, now(i)%load, faults)
            exit
          end do
        end do
      end associate
    end do
  end subroutine warn_of_pressures

  !> OP=NEW of *DLOAD clears the loads of *DLOAD alone, that of *DSLOAD those of *DSLOAD, as in
  !> Abaqus. CalculiX clears both. Each load that goes on by this is named once.
  subroutine warn_of_other_keyword(model, faults)
    type(draft), intent(in) :: model
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
      call find_standing(model, step, step(i), other, stays)
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

  !> The loads of a keyword that act in a step, have acted before and are not given in the step.
  !> None where a card of this keyword has OP=NEW in the step.
  pure subroutine find_standing(model, step, s, keyword, stays)
    type(draft), intent(in) :: model
    integer, intent(in) :: step(:) !< of each card
    integer, intent(in) :: s !< step
    character(*), intent(in) :: keyword !< DLOAD or DSLOAD
    logical, allocatable, intent(out) :: stays(:) !< (loads)
    integer :: i, found
    allocate (stays(size(model%problem%loads)), source=.false.)
    do i = 1, size(step)
      if (step(i) /= s .or. .not. is_keyword(model%cards(i), keyword)) cycle
      if (is_pressed_anew(model%cards(i))) return
    end do
    associate (before => model%problem%steps(s - 1)%loads, now => model%problem%steps(s)%loads)
      do i = 1, size(now)
        if (model%problem%loads(now(i)%load)%item%family /= keyword) cycle
        if (is_ending(now(i)) .or. .not. any(before%load == now(i)%load)) cycle
        found = card_of_faces(model, s, model%problem%loads(now(i)%load)%item)
        stays(now(i)%load) = step(found) < s
      end do
    end associate
  end subroutine find_standing

  !> Whether a load fades to zero in its step.
  pure logical function is_ending(work)
    type(step_load), intent(in) :: work
    is_ending = work%amplitude == 0 .and. abs(work%end_factor) <= 0.0_rk
  end function is_ending

  !> An element with a face that two loads of one kind push, of *DLOAD or *DSLOAD; 0 for none.
  pure integer function shared_element(model, first, second) result(element)
    type(draft), intent(in) :: model
    integer, intent(in) :: first, second !< loads
    type(surface) :: old, new
    integer, allocatable :: pushed(:) !< (elements) a bit for each face of the first load
    integer :: i, old_kind, new_kind
    element = 0
    associate (loads => model%problem%loads)
      if (loads(first)%item%family == loads(second)%item%family .and. &
          loads(first)%item%target == loads(second)%item%target) return
      call find_faces(loads(first)%item, old, old_kind)
      call find_faces(loads(second)%item, new, new_kind)
    end associate
    if (old_kind /= new_kind .or. new_kind == 0) return
    allocate (pushed(model%problem%mesh%num_elements), source=0)
    do i = 1, size(old%element)
      pushed(old%element(i)) = ibset(pushed(old%element(i)), old%face(i))
    end do
    do i = 1, size(new%element)
      element = new%element(i)
      if (btest(pushed(element), new%face(i))) return
    end do
    element = 0
  end function shared_element

  !> The faces that a load pushes, and its kind: 0 for a load without faces.
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
  subroutine warn_of_both(model, s, element, first, second, faults)
    type(draft), intent(in) :: model
    integer, intent(in) :: s !< step
    integer, intent(in) :: element !< position
    integer, intent(in) :: first, second !< loads
    type(diagnostic_list), intent(inout) :: faults
    character(:), allocatable :: what, remedy
    integer :: found
    associate (loads => model%problem%loads)
      found = card_of_faces(model, s, loads(second)%item)
      what = 'pressure'
      remedy = 'a load is replaced under its own name, or with OP=NEW of *'// &
               loads(first)%item%family
      if (loads(second)%item%family == 'RESERVOIR') then
        what = 'water of *RESERVOIR'
        remedy = 'a reservoir is replaced under its own name, and emptied there by HYDROSTATIC=NO'
      end if
      call model%cards(found)%warn( &
        faults, 'element '//as_text(model%problem%mesh%element_id(element))//' keeps the '// &
        what//" '"//loads(first)%item%target//"' of an earlier step beside '"// &
        loads(second)%item%target//"': "//remedy)
    end associate
  end subroutine warn_of_both

  !> The last card that gives a load on faces, up to a step.
  pure integer function card_of_faces(model, s, item) result(found)
    type(draft), intent(in) :: model
    integer, intent(in) :: s !< step
    class(load), intent(in) :: item
    integer :: step(size(model%cards)), i, line
    step = steps_of_cards(model%cards)
    if (item%family == 'DLOAD') then
      found = card_of_dload(model, step, s, item%target)
      return
    end if
    found = model%procedure_card(s)
    do i = 1, size(step)
      if (step(i) > s .or. .not. is_keyword(model%cards(i), item%family)) cycle
      if (item%family == 'RESERVOIR') then
        if (model%cards(i)%word('NAME') == item%target) found = i
        cycle
      end if
      do line = 1, model%cards(i)%num_lines
        if (target_of_dsload(model%cards(i), line) == item%target) found = i
      end do
    end do
  end function card_of_faces

  !> The target of the load that a line of *DSLOAD gives.
  pure function target_of_dsload(this, line) result(target)
    type(card), intent(in) :: this
    integer, intent(in) :: line
    character(:), allocatable :: target
    target = this%word_at(line, 1)
    if (this%word_at(line, 2) == 'HP') target = target//' HP'
  end function target_of_dsload
end module check_pressures
