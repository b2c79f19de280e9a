!> *SURFACE INTERACTION, *SURFACE BEHAVIOR, *FRICTION: the law of contact pairs.
module keywords_contact_law
  use deck_card, only: card
  use diagnostics, only: diagnostic_list
  use keyword_spec, only: field, keyword, kind_flag, kind_real, kind_choice, kind_word
  use keywords_other, only: add_idle_parameters, add_refused_parameter
  use kinds, only: rk
  use model_draft, only: draft, interaction_request
  implicit none
  private
  public :: describe_interaction, describe_behavior, describe_friction
  public :: read_interaction, read_behavior, read_friction

  character, parameter :: nl = new_line('a')

contains

  subroutine describe_interaction(spec)
    type(keyword), intent(out) :: spec
    spec%name = 'SURFACE INTERACTION'
    spec%family = 'joint'
    spec%place = 'model'
    spec%meaning = 'A law of contact, for *CONTACT PAIR. *SURFACE BEHAVIOR and *FRICTION below '// &
                   'it, in any order, hold its constants. Without them the contact is HARD and '// &
                   'has no friction. The law may stand below the pairs that name it.'
    spec%example = '*SURFACE INTERACTION, NAME=ROCK'//nl//'*SURFACE BEHAVIOR, '// &
                   'PRESSURE-OVERCLOSURE=HARD'//nl//'*FRICTION'//nl//'0.7'
    spec%most_lines = 1
    allocate (spec%parameters, source=[ &
              field('NAME', kind_word, 'name of the law', is_required=.true.)])
    allocate (spec%columns, source=[ &
              field('thickness', kind_real, 'of two-dimensional contact; no effect')])
  end subroutine describe_interaction

  subroutine read_interaction(this, model, faults)
    type(card), intent(in) :: this
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(interaction_request) :: new
    integer :: i
    new%name = this%word('NAME')
    new%spot = model%here(0)
    new%last_card = model%current
    do i = 1, size(model%interactions)
      if (model%interactions(i)%name /= new%name) cycle
      call this%fault_parameter(faults, 'NAME', "surface interaction '"//this%text('NAME')// &
                                "' is defined twice", 'a name that is used once', &
                                first=model%cards(model%interactions(i)%spot%card)%place())
    end do
    model%interactions = [model%interactions, new]
    if (.not. this%is_empty_at(1, 1)) then
      call this%ignore(faults, 'the thickness has no effect: solids have three dimensions')
    end if
  end subroutine read_interaction

  subroutine describe_behavior(spec)
    type(keyword), intent(out) :: spec
    spec%name = 'SURFACE BEHAVIOR'
    spec%family = 'joint'
    spec%place = 'model'
    spec%meaning = 'Pressure of contact as a function of penetration, below *SURFACE '// &
                   'INTERACTION. HARD and LINEAR are both linear in the penetration, with the '// &
                   'normal stiffness KN of a joint: LINEAR with the value given, HARD with 50 '// &
                   'E/h of the softer side unless a value is given, h the depth of its '// &
                   'elements behind the surface (different_meshes.md, 13.9). TIED is LINEAR '// &
                   'with any tension and no sliding. *JOINT LAW with PENETRATION reduces the '// &
                   'penetration further.'
    spec%example = '*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR'//nl//'1e12'
    spec%most_lines = 1
    spec%no_further = 'the pressure is linear in the penetration'
    allocate (spec%parameters, source=[ &
              field('PRESSURE-OVERCLOSURE', kind_choice, 'for a table LINEAR with its '// &
                    'slope at the pressures of the model', default='HARD', &
                    choices='HARD | LINEAR | TIED', rules_lines=.true., &
                    instead='for a table, LINEAR with its slope at the pressures of the model')])
    call add_refused_parameter(spec, 'NO SEPARATION', 'PRESSURE-OVERCLOSURE=TIED, or *JOINT '// &
                               'with the TENSILE STRENGTH of its *JOINT LAW')
    allocate (spec%columns, source=[ &
              field('stiffness', kind_real, 'normal stiffness', 'Pa/m', lowest=0.0_rk, &
                    excludes_lowest=.true.), &
              field('tension', kind_real, 'of CalculiX, far from the surface; no effect'), &
              field('clearance', kind_real, 'of CalculiX, where contact begins; no effect')])
    call add_idle_parameters(spec, [character(20) :: 'PENALTY', 'DIRECT', 'AUGMENTED LAGRANGE'])
  end subroutine describe_behavior

  subroutine read_behavior(this, model, faults)
    type(card), intent(in) :: this
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer :: number, i
    call find_open(this, model, faults, number)
    if (number == 0) return
    associate (law => model%interactions(number))
      if (law%behavior_card > 0) call this%fault( &
        faults, 'the surface interaction already has a *SURFACE BEHAVIOR', &
        'one for each *SURFACE INTERACTION', first=model%cards(law%behavior_card)%place())
      law%behavior_card = model%current
      law%stiffness = this%real_at(1, 1)
      law%is_tied = this%word('PRESSURE-OVERCLOSURE') == 'TIED'
      if (this%word('PRESSURE-OVERCLOSURE') == 'LINEAR' .and. this%is_empty_at(1, 1)) then
        call this%fault(faults, 'LINEAR without its stiffness', 'a data line: stiffness [Pa/m]')
      end if
    end associate
    do i = 2, 3
      if (.not. this%is_empty_at(1, i)) call this%ignore( &
        faults, this%spec%columns(i)%name//' has no effect: the pressure is linear in the '// &
        'penetration from zero on')
    end do
  end subroutine read_behavior

  subroutine describe_friction(spec)
    type(keyword), intent(out) :: spec
    spec%name = 'FRICTION'
    spec%family = 'joint'
    spec%place = 'model'
    spec%meaning = 'Coulomb friction of contact, below *SURFACE INTERACTION.'
    spec%example = '*FRICTION'//nl//'0.7, 1e10'
    spec%fewest_lines = 1
    spec%most_lines = 1
    spec%no_further = 'the coefficient is constant'
    allocate (spec%parameters(0))
    allocate (spec%columns, source=[ &
              field('coefficient', kind_real, 'of friction', lowest=0.0_rk, is_required=.true.), &
              field('stick slope', kind_real, 'tangential stiffness KT until the contact '// &
                    'slides', 'Pa/m', 'KN/(2(1+nu))', lowest=0.0_rk, &
                    excludes_lowest=.true.)])
    call add_idle_parameters(spec, [character(20) :: 'SLIP TOLERANCE', 'ELASTIC SLIP', 'LAGRANGE'])
  end subroutine describe_friction

  subroutine read_friction(this, model, faults)
    type(card), intent(in) :: this
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer :: number
    call find_open(this, model, faults, number)
    if (number == 0) return
    associate (law => model%interactions(number))
      if (law%friction_card > 0) call this%fault( &
        faults, 'the surface interaction already has a *FRICTION', &
        'one for each *SURFACE INTERACTION', first=model%cards(law%friction_card)%place())
      law%friction_card = model%current
      law%friction = this%real_at(1, 1)
      if (.not. this%is_empty_at(1, 2)) law%stick_slope = this%real_at(1, 2)
    end associate
  end subroutine read_friction

  !> The surface interaction that the card belongs to: the card follows it, or a card that belongs
  !> to it. 0 after a fault.
  subroutine find_open(this, model, faults, number)
    type(card), intent(in) :: this
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer, intent(out) :: number
    number = size(model%interactions)
    if (number > 0) then
      if (model%interactions(number)%last_card /= model%current - 1) number = 0
    end if
    if (number == 0) then
      call this%fault(faults, 'the keyword is outside a surface interaction', &
                      'a place below *SURFACE INTERACTION')
    else
      model%interactions(number)%last_card = model%current
    end if
  end subroutine find_open
end module keywords_contact_law
