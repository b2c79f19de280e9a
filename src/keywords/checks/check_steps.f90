!> Warns of what a step holds without effect or twice; refuses a base that moves an unheld model.
module check_steps
  use check_idle_steps, only: has_inelastic_law
  use deck_scan, only: is_keyword, steps_of_cards
  use diagnostics, only: diagnostic_list
  use guest_list, only: supports_of_step
  use load_base_motion, only: base_motion
  use keywords_boundary, only: sets_support
  use keywords_output, only: fields_of_envelope
  use model_draft, only: draft, kept_support
  use step_plan, only: field_name_length
  use text_table, only: text_numbers
  use write_text, only: as_text
  implicit none
  private
  public :: verify_steps

  integer, parameter :: longest_key = field_name_length + 16 !< name of a field and position

contains

  !> The deck must have no errors.
  subroutine verify_steps(model, faults)
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer :: step(size(model%cards))
    step = steps_of_cards(model%cards)
    call warn_of_names(model, step, faults)
    call warn_of_loads_on_modes(model, step, faults)
    call warn_of_kept_supports(model, step, faults)
    call warn_of_reservoirs(model, step, faults)
    call warn_of_envelopes(model, step, faults)
    call warn_of_initial_displacements(model, faults)
    call verify_shaken_supports(model, step, faults)
  end subroutine verify_steps

  !> Two steps of one name.
  subroutine warn_of_names(model, step, faults)
    type(draft), intent(in) :: model
    integer, intent(in) :: step(:) !< of each card
    type(diagnostic_list), intent(inout) :: faults
    type(text_numbers) :: names
    integer :: first(size(model%problem%steps)) !< (names) step
    integer :: i, n
    first = 0
    do i = 1, size(step)
      if (.not. is_keyword(model%cards(i), 'STEP')) cycle
      call names%find_or_add(model%problem%steps(step(i))%name, n)
      if (first(n) == 0) first(n) = step(i)
      if (first(n) == step(i) .or. .not. model%cards(i)%has('NAME')) cycle
      call model%cards(i)%warn(faults, "step '"//model%cards(i)%text('NAME')// &
                               "' has the name of step "//as_text(first(n))// &
                               ': both run, and results distinguish them by their numbers')
    end do
  end subroutine warn_of_names

  !> *FREQUENCY takes masses and stiffness, no forces.
  subroutine warn_of_loads_on_modes(model, step, faults)
    type(draft), intent(in) :: model
    integer, intent(in) :: step(:) !< of each card
    type(diagnostic_list), intent(inout) :: faults
    character(:), allocatable :: later
    integer :: i
    do i = 1, size(step)
      if (step(i) == 0) cycle
      if (.not. model%problem%steps(step(i))%procedure%finds_modes) cycle
      if (.not. (is_keyword(model%cards(i), 'CLOAD') .or. is_keyword(model%cards(i), 'DLOAD') .or. &
                 is_keyword(model%cards(i), 'DSLOAD'))) cycle
      if (model%cards(i)%num_lines == 0) cycle ! OP=NEW alone ends loads
      later = ''
      if (any(.not. model%problem%steps(step(i):)%procedure%finds_modes)) then
        later = '; the load acts from the next *STATIC or *DYNAMIC on'
      end if
      call model%cards(i)%warn(faults, 'has no effect in a step *FREQUENCY'//later)
    end do
  end subroutine warn_of_loads_on_modes

  !> Supports of a *FREQUENCY step stay in the steps after it; in Abaqus they end with the step.
  !> OP=NEW in the next step that moves the model gives all its supports.
  subroutine warn_of_kept_supports(model, step, faults)
    type(draft), intent(in) :: model
    integer, intent(in) :: step(:) !< of each card
    type(diagnostic_list), intent(inout) :: faults
    character(:), allocatable :: number, state
    integer :: i, k
    do k = 1, size(model%kept_supports)
      associate (kept => model%kept_supports(k))
        if (gives_all_supports(model, step, kept%step)) cycle
        i = card_of_kept(model, step, kept)
        if (i == 0) cycle
        number = as_text(kept%step)
        state = 'is held'
        if (.not. kept%is_held) state = 'is not held'
        if (kept%is_moved) state = 'has another displacement'
        call model%cards(i)%warn( &
          faults, 'the supports of this *FREQUENCY step stay: node '// &
          as_text(model%problem%mesh%node_id(kept%node))//' '//state//' in direction '// &
          as_text(kept%dof)//' in step '//number//' (in Abaqus they end with the *FREQUENCY '// &
          'step)', '*BOUNDARY, OP=NEW with all supports in step '//number//', unless they '// &
          'are meant to stay')
      end associate
    end do
  end subroutine warn_of_kept_supports

  !> Whether a step gives all its supports.
  pure logical function gives_all_supports(model, step, s)
    type(draft), intent(in) :: model
    integer, intent(in) :: step(:) !< of each card
    integer, intent(in) :: s !< step
    integer :: i
    gives_all_supports = .false.
    do i = 1, size(step)
      if (step(i) /= s .or. .not. is_keyword(model%cards(i), 'BOUNDARY')) cycle
      if (model%cards(i)%word('OP') == 'NEW') gives_all_supports = .true.
    end do
  end function gives_all_supports

  !> The last *BOUNDARY of the *FREQUENCY steps before a step that has set or removed a support
  !> that the step keeps; 0 for none.
  integer function card_of_kept(model, step, kept) result(found)
    type(draft), intent(in) :: model
    integer, intent(in) :: step(:) !< of each card
    type(kept_support), intent(in) :: kept
    integer :: s
    do s = kept%step - 1, 1, -1
      if (.not. model%problem%steps(s)%procedure%finds_modes) exit
      do found = size(step), 1, -1
        if (step(found) /= s .or. .not. is_keyword(model%cards(found), 'BOUNDARY')) cycle
        if (kept%is_held) then
          if (sets_support(model%cards(found), model, kept%node, kept%dof)) return
        else if (model%cards(found)%word('OP') == 'NEW') then
          return
        end if
      end do
    end do
    found = 0
  end function card_of_kept

  !> One reservoir twice in a step: both press.
  subroutine warn_of_reservoirs(model, step, faults)
    type(draft), intent(in) :: model
    integer, intent(in) :: step(:) !< of each card
    type(diagnostic_list), intent(inout) :: faults
    type(text_numbers) :: names
    integer :: last(size(step)) !< (names) step that has given the reservoir last
    integer :: i, n
    last = 0
    do i = 1, size(step)
      if (.not. is_keyword(model%cards(i), 'RESERVOIR')) cycle
      call names%find_or_add(model%cards(i)%word('NAME'), n)
      if (last(n) == step(i)) then
        call model%cards(i)%warn(faults, "reservoir '"//model%cards(i)%text('NAME')// &
                                 "' is given twice in this step: the pressures and the added "// &
                                 'masses of both act')
      end if
      last(n) = step(i)
    end do
  end subroutine warn_of_reservoirs

  !> A field in two *ENVELOPE cards of a step. Values at nodes and at points are two fields.
  subroutine warn_of_envelopes(model, step, faults)
    type(draft), intent(in) :: model
    integer, intent(in) :: step(:) !< of each card
    type(diagnostic_list), intent(inout) :: faults
    character(longest_key), allocatable :: seen(:), own(:)
    character(field_name_length) :: word
    logical, allocatable :: is_new(:)
    integer :: i, k, opened
    allocate (seen(0))
    opened = 0
    do i = 1, size(step)
      if (step(i) /= opened) seen = [character(longest_key) ::]
      opened = step(i)
      if (.not. is_keyword(model%cards(i), 'ENVELOPE')) cycle
      own = fields_of_envelope(model%cards(i))//model%cards(i)%word('POSITION')
      is_new = [(.not. any(seen == own(k)), k=1, size(own))]
      k = findloc(is_new, .false., dim=1)
      if (k > 0) then
        word = own(k) (:field_name_length)
        call model%cards(i)%warn(faults, 'an *ENVELOPE of this step requests '//trim(word)// &
                                 ' already; it is recorded once')
      end if
      seen = [character(longest_key) :: seen, pack(own, is_new)]
    end do
  end subroutine warn_of_envelopes

  !> A static step finds its displacements from its loads; only histories of joints and inelastic
  !> solids and prescribed displacements start from the initial ones. What solids have stored by
  !> them is released in the first increment.
  subroutine warn_of_initial_displacements(model, faults)
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    character(:), allocatable :: why, effect
    integer :: i
    if (all(model%problem%initial_values%is_velocity)) return
    effect = 'initial displacements have no effect: '
    if (size(model%problem%joints) > 0 .or. has_inelastic_law(model)) then
      effect = 'initial displacements have no effect but on joints and inelastic solids: '
    else if (any_starts_a_support(model)) then
      return
    end if
    why = 'no step moves the model'
    do i = 1, size(model%problem%steps)
      if (model%problem%steps(i)%procedure%has_inertia) return
      if (.not. model%problem%steps(i)%procedure%is_static()) cycle
      why = 'the first step is *STATIC and finds the displacements of its loads'
      exit
    end do
    do i = 1, size(model%cards)
      if (.not. is_keyword(model%cards(i), 'INITIAL CONDITIONS')) cycle
      if (model%cards(i)%word('TYPE') /= 'DISPLACEMENT') cycle
      call model%cards(i)%warn(faults, effect//why)
      return
    end do
  end subroutine warn_of_initial_displacements

  !> Whether a support of the first step begins at an initial displacement.
  pure logical function any_starts_a_support(model) result(is_start)
    type(draft), intent(in) :: model
    integer :: i
    is_start = .false.
    do i = 1, size(model%problem%initial_values)
      associate (given => model%problem%initial_values(i), &
                 supports => model%problem%steps(1)%fixities)
        is_start = is_start .or. &
                   any(supports%node == given%node .and. supports%dof == given%dof)
      end associate
    end do
  end function any_starts_a_support

  !> A model that nothing connects to the base does not feel its motion.
  subroutine verify_shaken_supports(model, step, faults)
    type(draft), intent(in), target :: model
    integer, intent(in) :: step(:) !< of each card
    type(diagnostic_list), intent(inout) :: faults
    integer, allocatable :: node(:), direction(:)
    integer :: s, i, place
    do s = 1, size(model%problem%steps)
      if (.not. model%problem%steps(s)%procedure%has_inertia) cycle
      if (.not. is_shaken(model, s)) cycle
      call supports_of_step(model%problem, model%problem%steps(s), node, direction)
      if (size(node) > 0) cycle
      place = model%procedure_card(s)
      do i = 1, size(step)
        if (step(i) == s .and. is_keyword(model%cards(i), 'BOUNDARY')) place = i
      end do
      call model%cards(place)%fault(faults, 'the base moves, but no support connects the model '// &
                                    'to it in this step', '*BOUNDARY with supports')
      return
    end do
  end subroutine verify_shaken_supports

  !> Whether a step has a motion of the base.
  pure logical function is_shaken(model, s)
    type(draft), intent(in) :: model
    integer, intent(in) :: s !< step
    integer :: i
    is_shaken = .false.
    do i = 1, size(model%problem%steps(s)%loads)
      select type (item => model%problem%loads(model%problem%steps(s)%loads(i)%load)%item)
      type is (base_motion)
        is_shaken = .true.
      end select
    end do
  end function is_shaken
end module check_steps
