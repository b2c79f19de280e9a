!> Warns of cards of a step that have no effect in this step nor in a later one.
module check_idle_steps
  use card_fields, only: field_of_word
  use card_reader, only: field_reader
  use deck_card, only: card
  use deck_scan, only: is_keyword, steps_of_cards
  use diagnostics, only: diagnostic_list
  use keyword_spec, only: without_effect
  use kinds, only: rk
  use model_draft, only: draft
  implicit none
  private
  public :: warn_of_idle_steps, has_inelastic_law, first_displacement

  !> What is known of the model and of the steps from one step on.
  type :: later_steps
    logical :: any_moves !< a *STATIC or *DYNAMIC step is among them
    logical :: any_inertia !< a *DYNAMIC step is among them
    logical :: is_inelastic !< a material cracks or yields
    logical :: has_joints
    logical :: are_modes !< the step itself is a *FREQUENCY step
  end type later_steps

  character(*), parameter :: requests = ' NODE PRINT | EL PRINT | JOINT PRINT | NODE FILE | '// &
                             'EL FILE | NODE OUTPUT | ELEMENT OUTPUT '
  !> Keywords that drive nothing; *BOUNDARY and joints are looked at. A deck with any other keyword
  !> is taken as one where something acts.
  character(*), parameter :: idle = &
                             ' HEADING | INCLUDE | NODE | ELEMENT | NSET | ELSET | '// &
                             'SURFACE | PART | END PART | ASSEMBLY | INSTANCE | '// &
                             'END INSTANCE | END ASSEMBLY | MATERIAL | DENSITY | DAMPING | '// &
                             'EXPANSION | ELASTIC | PLASTIC | CONCRETE DAMAGED PLASTICITY | '// &
                             'CONCRETE COMPRESSION HARDENING | '// &
                             'CONCRETE TENSION STIFFENING | CONCRETE COMPRESSION DAMAGE | '// &
                             'CONCRETE TENSION DAMAGE | MATERIAL TEST | SOLID SECTION | '// &
                             'JOINT LAW | JOINT | TIE | EQUATION | MPC | INTERFACE | '// &
                             'SURFACE INTERACTION | SURFACE BEHAVIOR | FRICTION | '// &
                             'CONTACT PAIR | CLEARANCE | AMPLITUDE | STEP | END STEP | '// &
                             'STATIC | DYNAMIC | CONTROLS | BOUNDARY | NODE PRINT | '// &
                             'EL PRINT | JOINT PRINT | NODE FILE | EL FILE | OUTPUT | '// &
                             'NODE OUTPUT | ELEMENT OUTPUT | ENVELOPE | RESTART | PREPRINT '
  character(*), parameter :: no_dynamic = ': no *DYNAMIC step from here on'

contains

  !> The deck must have no errors.
  subroutine warn_of_idle_steps(model, faults)
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(later_steps) :: later(size(model%problem%steps))
    integer :: step(size(model%cards))
    integer :: i
    call warn_of_idle_run(model, faults)
    step = steps_of_cards(model%cards)
    later = steps_from_each(model)
    do i = 1, size(step)
      if (is_keyword(model%cards(i), 'DAMPING') .and. step(i) == 0) then
        call warn_of_material_damping(model%cards(i), model, faults)
      end if
      if (step(i) == 0 .or. .not. allocated(model%cards(i)%spec%name)) cycle
      associate (this => model%cards(i), now => later(step(i)))
        select case (this%spec%name)
        case ('DAMPING')
          call warn_of_damping(this, now, faults)
        case ('CONTROLS')
          call warn_of_controls(this, now, faults)
        case ('STATIC', 'DYNAMIC')
          call warn_of_limits(this, faults)
        case ('BOUNDARY')
          call warn_of_displacements(this, now, faults)
        case ('OUTPUT')
          call warn_of_empty_output(model, i, step, faults)
        case ('ENVELOPE')
          if (now%are_modes) then
            call this%warn(faults, 'has no effect in a step *FREQUENCY, and is not kept for others')
          end if
        case default
          call warn_of_requests(this, now, faults)
        end select
      end associate
    end do
  end subroutine warn_of_idle_steps

  !> A model that nothing loads or moves has results of zero. Joints that the mesh presses together
  !> act from the start.
  subroutine warn_of_idle_run(model, faults)
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer :: i
    if (size(model%problem%steps) == 0) return
    do i = 1, size(model%cards)
      associate (this => model%cards(i))
        if (.not. allocated(this%spec%name)) return
        if (is_keyword(this, 'BOUNDARY')) then
          if (first_displacement(this) > 0) return
        end if
        if (this%spec%status == without_effect) cycle
        if (index(idle, ' '//this%spec%name//' ') == 0) return
      end associate
    end do
    do i = 1, size(model%problem%joints)
      if (any(model%problem%joints(i)%clearance < 0.0_rk)) return
    end do
    call model%cards(model%procedure_card(1))%warn( &
      faults, 'the deck has no load, no displacement of supports, no temperature and no '// &
      'motion of the base: nothing acts, and all results are zero')
  end subroutine warn_of_idle_run

  !> What is known from each step on.
  pure function steps_from_each(model) result(later)
    type(draft), intent(in) :: model
    type(later_steps) :: later(size(model%problem%steps))
    type(later_steps) :: now
    integer :: s
    now = later_steps(any_moves=.false., any_inertia=.false., are_modes=.false., &
                      is_inelastic=has_inelastic_law(model), has_joints=size(model%joints) > 0)
    do s = size(later), 1, -1
      associate (procedure => model%problem%steps(s)%procedure)
        now%any_moves = now%any_moves .or. .not. procedure%finds_modes
        now%any_inertia = now%any_inertia .or. procedure%has_inertia
        now%are_modes = procedure%finds_modes
      end associate
      later(s) = now
    end do
  end function steps_from_each

  !> Whether a material cracks or yields. An unused material may have no law.
  pure logical function has_inelastic_law(model) result(is_inelastic)
    type(draft), intent(in) :: model
    integer :: i
    is_inelastic = .false.
    do i = 1, size(model%problem%materials)
      if (.not. allocated(model%problem%materials(i)%law)) cycle
      is_inelastic = is_inelastic .or. model%problem%materials(i)%law%is_nonlinear
    end do
  end function has_inelastic_law

  subroutine warn_of_material_damping(this, model, faults)
    type(card), intent(in) :: this
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    if (.not. (this%real('ALPHA') > 0.0_rk .or. this%real('BETA') > 0.0_rk)) then
      call this%warn(faults, 'the keyword has no effect: ALPHA and BETA are zero')
    else if (this%word('BASE') == 'CURRENT' .and. .not. has_inelastic_law(model)) then
      call this%warn(faults, 'BASE=CURRENT has no effect: no material cracks or yields')
    end if
  end subroutine warn_of_material_damping

  subroutine warn_of_damping(this, now, faults)
    type(card), intent(in) :: this
    type(later_steps), intent(in) :: now
    type(diagnostic_list), intent(inout) :: faults
    if (.not. this%real('RATIO') > 0.0_rk) return ! ends the damping of earlier steps
    if (.not. now%any_inertia) then
      call this%warn(faults, 'has no effect'//no_dynamic)
    else if (this%word('BASE') == 'CURRENT' .and. .not. now%is_inelastic) then
      call this%warn(faults, 'BASE=CURRENT has no effect: no material cracks or yields')
    end if
  end subroutine warn_of_damping

  subroutine warn_of_controls(this, now, faults)
    type(card), intent(in) :: this
    type(later_steps), intent(in) :: now
    type(diagnostic_list), intent(inout) :: faults
    if (size(this%parameters) == 0) return ! reported
    if (.not. now%any_moves) then
      call this%warn(faults, 'has no effect: no *STATIC or *DYNAMIC step from here on')
      return
    end if
    if (this%has('TANGENT') .and. .not. now%is_inelastic) then
      call this%warn(faults, 'TANGENT has no effect: no material cracks or yields')
    end if
    if (this%has('JOINT SOLVER') .and. .not. now%has_joints) then
      call this%warn(faults, 'JOINT SOLVER has no effect: the model has no joints')
    end if
    if (.not. this%has('JOINT FORCES')) return
    if (.not. now%has_joints) then
      call this%warn(faults, 'JOINT FORCES has no effect: the model has no joints')
    else if (.not. now%any_inertia) then
      call this%warn(faults, 'JOINT FORCES has no effect'//no_dynamic)
    end if
  end subroutine warn_of_controls

  !> Increments of fixed size have no limits.
  subroutine warn_of_limits(this, faults)
    type(card), intent(in) :: this
    type(diagnostic_list), intent(inout) :: faults
    integer :: i
    if (.not. this%has('DIRECT') .or. this%num_lines == 0) return
    do i = 3, 4
      if (this%is_empty_at(1, i)) cycle
      call this%warn_at(faults, 1, i, 'the '//trim(merge('smallest', 'largest ', i == 3))// &
                        ' increment has no effect: with DIRECT increments have a fixed size')
      return
    end do
  end subroutine warn_of_limits

  !> Modes have supports, no displacements of them.
  subroutine warn_of_displacements(this, now, faults)
    type(card), intent(in) :: this
    type(later_steps), intent(in) :: now
    type(diagnostic_list), intent(inout) :: faults
    integer :: line
    if (.not. now%are_modes) return
    line = first_displacement(this)
    if (line == 0) return
    call this%warn_at(faults, line, 4, 'the displacement has no effect in a step *FREQUENCY')
  end subroutine warn_of_displacements

  !> Line of the first displacement of a *BOUNDARY that is not zero; 0 for none.
  pure integer function first_displacement(this) result(line)
    type(card), intent(in) :: this
    do line = 1, this%num_lines
      if (this%is_empty_at(line, 4)) cycle
      if (abs(this%real_at(line, 4)) > 0.0_rk) return
    end do
    line = 0
  end function first_displacement

  !> *OUTPUT only gives its frequency to the requests that follow.
  subroutine warn_of_empty_output(model, number, step, faults)
    type(draft), intent(in) :: model
    integer, intent(in) :: number !< of the card
    integer, intent(in) :: step(:) !< of each card
    type(diagnostic_list), intent(inout) :: faults
    integer :: i
    logical :: is_history, ends_output
    ends_output = model%cards(number)%has('FREQUENCY') .and. &
                  model%cards(number)%integer('FREQUENCY') == 0
    is_history = model%cards(number)%has('HISTORY')
    if (model%cards(number)%has('VARIABLE')) return
    if (is_history .neqv. ends_output) return ! a history may stand alone, 0 ends fields
    do i = number + 1, size(step)
      if (step(i) /= step(number) .or. is_keyword(model%cards(i), 'OUTPUT')) exit
      if (is_keyword(model%cards(i), 'NODE OUTPUT')) return
      if (is_keyword(model%cards(i), 'ELEMENT OUTPUT')) return
    end do
    if (is_history) then
      call model%cards(number)%warn(faults, 'FREQUENCY=0 has no effect: histories of earlier '// &
                                    'steps go on')
    else
      call model%cards(number)%warn(faults, 'has no effect: no *NODE OUTPUT or *ELEMENT OUTPUT '// &
                                    'follows in the step')
    end if
  end subroutine warn_of_empty_output

  !> Requests that write nothing, and velocities and accelerations that are zero.
  subroutine warn_of_requests(this, now, faults)
    type(card), intent(in) :: this
    type(later_steps), intent(in) :: now
    type(diagnostic_list), intent(inout) :: faults
    type(field_reader) :: reader
    character(:), allocatable :: name, absent
    if (index(requests, ' '//this%spec%name//' ') == 0) return
    if (.not. now%any_moves) then
      call this%warn(faults, 'has no effect: a step *FREQUENCY writes its modes, and no '// &
                     '*STATIC or *DYNAMIC step follows')
      return
    end if
    if (now%any_inertia .or. index(this%spec%name, 'NODE') == 0) return
    absent = ''
    do while (reader%advance(this))
      name = field_of_word(this%word_at(reader%line, reader%field))
      if (name /= 'V' .and. name /= 'A') cycle
      if (absent == '') then
        absent = name
      else if (absent /= name) then
        absent = 'V and no A'
      end if
    end do
    if (absent /= '') call this%warn(faults, 'there is no '//absent//no_dynamic)
  end subroutine warn_of_requests
end module check_idle_steps
