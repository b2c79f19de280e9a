!> *CONTACT PAIR, *CLEARANCE: contact between surfaces, which becomes joints.
module keywords_contact_pair
  use deck_card, only: card
  use diagnostics, only: diagnostic_list
  use joint_contraction, only: contraction_law, penalty_factor
  use keyword_spec, only: field, keyword, kind_choice, kind_flag, kind_real, kind_text, kind_word
  use keywords_other, only: add_idle_parameters, add_refused_parameter
  use kinds, only: rk
  use model_draft, only: add_law, draft, interaction_request, joint_request, law_request
  use named_things, only: find_surface_at, longest_name, nodes_of_set
  use nearest_words, only: nearest_word
  use parse_text, only: parse_real
  use write_text, only: as_text
  implicit none
  private
  public :: describe_contact_pair, describe_clearance
  public :: read_contact_pair, read_clearance

  character, parameter :: nl = new_line('a')

  !> Tensile strength of tied contact: no traction of a model reaches it [Pa].
  real(rk), parameter :: tied_strength = 1.0e30_rk

contains

  subroutine describe_contact_pair(spec)
    type(keyword), intent(out) :: spec
    spec%name = 'CONTACT PAIR'
    spec%family = 'joint'
    spec%place = 'model'
    spec%meaning = 'Contact between two surfaces whose meshes may differ, as in Abaqus and '// &
                   'CalculiX. Each line becomes a joint with its points at the nodes of the '// &
                   'slave surface; the joints are called CONTACT1, CONTACT2, ... in the order '// &
                   'of the deck. A name that a *JOINT above has is left out: below a joint '// &
                   'CONTACT1 the first pair is CONTACT2. The distance of the surfaces in the '// &
                   'mesh is the gap at the start, unless ADJUST or *CLEARANCE change it; '// &
                   'overlaps press from the start. Gaps and overlaps up to 1e-6 of a facet are '// &
                   'rounding of the mesh and count as zero. Sliding is small: the run stops '// &
                   'where a point slides further than a facet. A pair acts in all steps.'
    spec%example = '*CONTACT PAIR, INTERACTION=ROCK, TYPE=SURFACE TO SURFACE, SMALL SLIDING'// &
                   nl//'DAM_BASE, ROCK_TOP'
    spec%fewest_lines = 1
    spec%no_further = 'the pair has no local axes'
    allocate (spec%parameters, source=[ &
              field('INTERACTION', kind_word, 'name of a *SURFACE INTERACTION', &
                    is_required=.true.), &
              field('TYPE', kind_choice, 'discretisation: here both have points at the nodes '// &
                    'of the slave and a mortar projection on the master, as *JOINT', &
                    default='NODE TO SURFACE', &
                    choices='NODE TO SURFACE | SURFACE TO SURFACE'), &
              field('SMALL SLIDING', kind_flag, 'the assumption of joints; a warning '// &
                    'without it'), &
              field('ADJUST', kind_text, 'gaps up to this number and all overlaps are zero '// &
                    'at the start [m]; or a node set, whose gaps and overlaps are zero')])
    call add_refused_parameter(spec, 'TIED', '*TIE of the two surfaces')
    allocate (spec%columns, source=[ &
              field('slave', kind_word, 'slave surface, as a rule the finer one', &
                    is_required=.true.), &
              field('master', kind_word, 'master surface', is_required=.true.)])
    call add_idle_parameters(spec, [character(26) :: 'CPSET', 'TRACKING', 'SMOOTH', &
                                    'NO THICKNESS', 'EXTENSION ZONE', 'HCRIT', &
                                    'MECHANICAL CONSTRAINT', 'SUPPLEMENTARY CONSTRAINTS'])
  end subroutine describe_contact_pair

  subroutine read_contact_pair(this, model, faults)
    type(card), intent(in) :: this
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(joint_request) :: new
    integer :: line, interaction
    if (model%num_steps > 0) then
      call this%fault(faults, 'a pair acts in all steps', 'a place above the first *STEP')
    end if
    call find_interaction(this, model, faults, interaction)
    call read_adjust(this, model, faults, new)
    allocate (new%elements(0))
    new%is_measured = .true.
    if (interaction > 0) new%is_measured = .not. model%interactions(interaction)%is_tied
    do line = 1, this%num_lines
      new%spot = model%here(line)
      call find_surface_at(this, line, model, faults, new%slave)
      call find_surface_at(this, line, model, faults, new%master, 2)
      if (min(new%slave, new%master, interaction) == 0) cycle
      if (is_known(this, line, new, interaction, model, faults)) cycle
      call add_pair(model, new, model%interactions(interaction))
      call warn_of_name(this, line, model, faults)
    end do
    if (.not. this%has('SMALL SLIDING')) then
      call this%warn(faults, 'sliding is small here: the run stops where a point slides '// &
                     'further than a facet', 'SMALL SLIDING')
    end if
  end subroutine read_contact_pair

  !> Position of the *SURFACE INTERACTION that the card names, 0 after a fault.
  subroutine find_interaction(this, model, faults, found)
    type(card), intent(in) :: this
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer, intent(out) :: found
    character(longest_name) :: known(size(model%interactions))
    integer :: i
    found = 0
    do i = 1, size(known)
      known(i) = model%interactions(i)%name
      if (model%interactions(i)%name == this%word('INTERACTION')) found = i
    end do
    if (found > 0) return
    call this%fault_parameter(faults, 'INTERACTION', "there is no surface interaction '"// &
                              this%text('INTERACTION')//"'", &
                              'the name of a *SURFACE INTERACTION', &
                              nearest_word(this%word('INTERACTION'), known))
  end subroutine find_interaction

  !> Reads ADJUST: a distance, or a set of nodes.
  subroutine read_adjust(this, model, faults, new)
    type(card), intent(in) :: this
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(joint_request), intent(inout) :: new
    logical :: is_number
    if (.not. this%has('ADJUST')) return
    new%is_adjusted = .true.
    call parse_real(this%text('ADJUST'), new%adjust, is_number)
    if (.not. is_number) then
      call nodes_of_set(this, 'ADJUST', model, faults, new%adjusted_nodes)
    else if (new%adjust < 0.0_rk) then
      call this%fault_parameter(faults, 'ADJUST', "found '"//this%text('ADJUST')//"'", &
                                'a distance >= 0 [m], or the name of a node set')
    end if
  end subroutine read_adjust

  !> Whether a pair or a joint lies between the two surfaces already. A second pair with the same
  !> law, such as the pair with slave and master exchanged, has no effect; anything else is a fault.
  logical function is_known(this, line, new, interaction, model, faults)
    type(card), intent(in) :: this
    integer, intent(in) :: line
    type(joint_request), intent(in) :: new
    integer, intent(in) :: interaction
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer :: i
    is_known = .true.
    if (new%slave == new%master) then
      call this%fault_at(faults, line, 2, 'the slave surface is the master surface', &
                         'two different surfaces')
      return
    end if
    do i = 1, size(model%joints)
      associate (other => model%joints(i))
        if (min(other%slave, other%master) /= min(new%slave, new%master)) cycle
        if (max(other%slave, other%master) /= max(new%slave, new%master)) cycle
        if (other%contact_law > 0 .and. other%law == model%interactions(interaction)%name) then
          call this%ignore(faults, 'the pair '//this%text_at(line, 1)//', '// &
                           this%text_at(line, 2)//' has no effect: joint '//other%name// &
                           ' acts between these surfaces')
        else
          call this%fault_at(faults, line, 1, "joint '"//other%name//"' lies between these two "// &
                             'surfaces already', 'one joint or pair for two surfaces', &
                             first=model%cards(other%spot%card)%place())
        end if
      end associate
      return
    end do
    is_known = .false.
  end function is_known

  !> Adds a pair as a joint with a law of its own.
  subroutine add_pair(model, new, interaction)
    type(draft), intent(inout) :: model
    type(joint_request), intent(inout) :: new !< gets its name and its law
    type(interaction_request), intent(in) :: interaction
    type(law_request) :: request
    allocate (request%law, source=law_of(interaction))
    request%law%name = interaction%name
    request%uplift = ''
    request%tail_water = ''
    request%profile = ''
    request%is_of_contact = .true.
    request%spot = interaction%spot
    call add_law(model, request)
    new%name = free_name(model)
    new%law = interaction%name
    new%contact_law = size(model%laws)
    model%joints = [model%joints, new]
  end subroutine add_pair

  !> 'CONTACT' and the number of the pair, or the next number whose name no joint has.
  pure function free_name(model) result(name)
    type(draft), intent(in) :: model
    character(:), allocatable :: name
    integer :: number, i
    do number = 1 + count(model%joints%contact_law > 0), 1 + 2*size(model%joints)
      name = 'CONTACT'//as_text(number)
      if (.not. any([(model%joints(i)%name == name, i=1, size(model%joints))])) return
    end do
  end function free_name

  !> A pair that could not get its name, since a *JOINT has it.
  subroutine warn_of_name(this, line, model, faults)
    type(card), intent(in) :: this
    integer, intent(in) :: line
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    character(:), allocatable :: usual
    integer :: i, last
    last = size(model%joints)
    usual = 'CONTACT'//as_text(count(model%joints%contact_law > 0))
    do i = 1, last - 1
      associate (other => model%joints(i))
        if (other%contact_law > 0 .or. other%name /= usual) cycle
        call this%warn_at(faults, line, 1, 'the pair is called '//model%joints(last)%name// &
                          ': a *JOINT has the name of the pair, '//usual, &
                          'another name of the *JOINT')
      end associate
    end do
  end subroutine warn_of_name

  !> The law of joints for a surface interaction.
  pure function law_of(interaction) result(law)
    type(interaction_request), intent(in) :: interaction
    type(contraction_law) :: law
    law%normal_stiffness = interaction%stiffness
    law%tangent_stiffness = interaction%stick_slope
    law%friction = interaction%friction
    law%layer_factor = penalty_factor
    if (interaction%is_tied) law%strength = tied_strength
  end function law_of

  subroutine describe_clearance(spec)
    type(keyword), intent(out) :: spec
    spec%name = 'CLEARANCE'
    spec%family = 'joint'
    spec%place = 'model'
    spec%meaning = 'Gap of a *CONTACT PAIR at the start, in place of the distance of its '// &
                   'surfaces in the mesh. The card may stand above the pair.'
    spec%example = '*CLEARANCE, SLAVE=DAM_BASE, MASTER=ROCK_TOP, VALUE=0.001'
    spec%most_lines = 0
    allocate (spec%parameters, source=[ &
              field('SLAVE', kind_word, 'slave surface of the pair', is_required=.true.), &
              field('MASTER', kind_word, 'master surface of the pair', is_required=.true.), &
              field('VALUE', kind_real, 'the gap', 'm', lowest=0.0_rk, is_required=.true.)])
    allocate (spec%columns(0))
  end subroutine describe_clearance

  !> Keeps the card until the pairs are known: `complete_clearances` reads it.
  subroutine read_clearance(this, model, faults)
    type(card), intent(in) :: this
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    if (this%word('SLAVE') == this%word('MASTER')) then
      call this%fault_parameter(faults, 'MASTER', 'the slave surface is the master surface', &
                                'two different surfaces')
    else
      model%clearances = [model%clearances, model%here(0)]
    end if
  end subroutine read_clearance
end module keywords_contact_pair
