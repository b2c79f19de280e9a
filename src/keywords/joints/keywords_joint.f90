!> *JOINT LAW, *JOINT.
module keywords_joint
  use deck_card, only: card
  use diagnostics, only: diagnostic_list
  use joint_catalogue, only: describe_joint_laws, make_joint_law
  use keyword_spec, only: choices_of, field, keyword, kind_choice, kind_word
  use model_draft, only: add_law, draft, joint_request, law_request
  use named_things, only: elements_of_set, find_surface_at
  use write_text, only: as_text
  implicit none
  private
  public :: describe_joint_law, describe_joint, read_joint_law, read_joint

  character, parameter :: nl = new_line('a')

contains

  subroutine describe_joint_law(spec)
    type(keyword), intent(out) :: spec
    character(:), allocatable :: first, types
    spec%name = 'JOINT LAW'
    spec%family = 'joint'
    spec%place = 'model'
    spec%meaning = 'The law of a joint: traction as a function of relative displacement. '// &
                   'Opening and tension are positive. UPLIFT applies the water pressure of a '// &
                   'reservoir to both faces of the joint, with the factors of the reservoir '// &
                   'in the steps in which its surface reaches the joint. tn is the traction '// &
                   'of the law without the water pressure.'
    spec%example = '*JOINT LAW, NAME=CONTRACTION, FRICTION=0.6'
    spec%most_lines = 0
    spec%chooser = 'TYPE'
    call describe_joint_laws(spec%variants)
    first = spec%variants(1)%name
    types = choices_of(spec%variants)
    allocate (spec%parameters, source=[ &
              field('NAME', kind_word, 'name of the law', is_required=.true.), &
              field('TYPE', kind_choice, 'type of the law', default=first, choices=types), &
              field('UPLIFT', kind_word, 'name of the *RESERVOIR whose water is in the joint'), &
              field('PROFILE', kind_choice, 'distribution of the water pressure: LINEAR, full '// &
                    'head at the upstream edge and zero at the '// &
                    'downstream edge, also in closed joints; OPEN, '// &
                    'full head where the joint is open from the '// &
                    'upstream edge on, zero elsewhere', &
                    default='LINEAR', choices='LINEAR | OPEN'), &
              field('TAIL WATER', kind_word, 'name of the *RESERVOIR at the downstream edge, '// &
                    'with PROFILE=LINEAR')])
  end subroutine describe_joint_law

  subroutine read_joint_law(this, model, faults)
    type(card), intent(in) :: this
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(law_request) :: new
    integer :: i
    call make_joint_law(this%word('TYPE'), new%law)
    ! An unknown TYPE is reported already. The first law stands in: joints that name it add no
    ! fault.
    if (.not. allocated(new%law)) call make_joint_law(this%spec%variants(1)%name, new%law)
    new%law%name = this%word('NAME')
    do i = 1, size(model%laws)
      if (model%laws(i)%law%name /= new%law%name) cycle
      call this%fault_parameter(faults, 'NAME', "joint law '"//this%text('NAME')// &
                                "' is defined twice", 'a name that is used once', &
                                first=model%cards(model%laws(i)%spot%card)%place())
    end do
    call new%law%read_card(this, faults)
    call read_water(this, new, faults)
    new%spot = model%here(0)
    call add_law(model, new)
  end subroutine read_joint_law

  !> Reads the water in the joint. Whether the reservoirs exist is known at the end of the deck.
  subroutine read_water(this, new, faults)
    type(card), intent(in) :: this
    type(law_request), intent(inout) :: new
    type(diagnostic_list), intent(inout) :: faults
    new%uplift = this%word('UPLIFT')
    new%tail_water = this%word('TAIL WATER')
    new%profile = this%word('PROFILE')
    if (new%uplift == '' .and. new%tail_water /= '') then
      call this%fault_parameter(faults, 'TAIL WATER', 'TAIL WATER is given without UPLIFT', &
                                'UPLIFT=the reservoir upstream')
    else if (new%uplift == '' .and. this%has('PROFILE')) then
      call this%warn(faults, 'PROFILE has no effect: UPLIFT is not given')
    else if (new%profile == 'OPEN' .and. new%tail_water /= '') then
      call this%fault_parameter(faults, 'TAIL WATER', 'TAIL WATER is given with PROFILE=OPEN', &
                                'PROFILE=LINEAR')
    end if
  end subroutine read_water

  subroutine describe_joint(spec)
    type(keyword), intent(out) :: spec
    spec%name = 'JOINT'
    spec%family = 'joint'
    spec%place = 'model'
    spec%meaning = 'A joint: the JOINT8 elements of a set, or two surfaces without interface '// &
                   'elements, whose meshes may differ. The points of a joint are the nodes of '// &
                   'the slave side, or Gauss points; at the nodes the traction of a stiff '// &
                   'joint does not oscillate. Between surfaces each node of the slave has a '// &
                   'mortar projection on the master; nodes without a partner are reported. As '// &
                   'a rule the finer side is the slave: it resolves a varying traction '// &
                   'better. The coarser side is the better slave for smooth tractions where '// &
                   'the surface bends and the element sizes differ by 2 or more, and for a '// &
                   'shorter computing time (fewer points). The normal points from the master '// &
                   'to the slave.'
    spec%example = '*JOINT, NAME=J1, LAW=CONTRACTION, ELSET=JOINT1'//nl// &
                   '*JOINT, NAME=J2, LAW=CONTRACTION'//nl//'LEFT_OF_2, RIGHT_OF_2'
    spec%most_lines = 1
    allocate (spec%parameters, source=[ &
              field('NAME', kind_word, 'name of the joint', is_required=.true.), &
              field('LAW', kind_word, 'name of a *JOINT LAW', is_required=.true.), &
              field('ELSET', kind_word, 'JOINT8 elements of the joint, instead of surfaces'), &
              field('INTEGRATION', kind_choice, 'location of the points', default='NODES', &
                    choices='NODES | GAUSS'), &
              field('CLEARANCE', kind_choice, 'initial distance of the surfaces: NONE, only '// &
                    'the GAP of the law; MEASURED, the distance in '// &
                    'the mesh as well (up to 1e-6 of a facet it is rounding and counts as '// &
                    'zero)', &
                    default='NONE', choices='NONE | MEASURED')])
    allocate (spec%columns, source=[ &
              field('slave', kind_word, 'slave surface, as a rule the finer one', &
                    is_required=.true.), &
              field('master', kind_word, 'master surface', is_required=.true.)])
  end subroutine describe_joint

  subroutine read_joint(this, model, faults)
    type(card), intent(in) :: this
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(joint_request) :: new
    integer :: i
    new%name = this%word('NAME')
    new%law = this%word('LAW')
    new%is_nodal = this%word('INTEGRATION') == 'NODES'
    new%is_measured = this%word('CLEARANCE') == 'MEASURED'
    new%spot = model%here(0)
    do i = 1, size(model%joints)
      if (model%joints(i)%name /= new%name) cycle
      call this%fault_parameter(faults, 'NAME', "joint '"//this%text('NAME')// &
                                "' is defined twice", 'a name that is used once', &
                                first=model%cards(model%joints(i)%spot%card)%place())
    end do
    if (this%has('ELSET') .eqv. this%num_lines > 0) then
      call this%fault(faults, 'a joint is made of elements or lies between two surfaces', &
                      'either ELSET with JOINT8 elements, or a data line: slave surface, '// &
                      'master surface')
      return
    else if (this%has('ELSET')) then
      call elements_of_set(this, 'ELSET', model, faults, new%elements)
      call claim_elements(this, new%elements, model, faults)
      if (new%is_measured) then
        call this%fault_parameter(faults, 'CLEARANCE', 'the faces of JOINT8 elements coincide', &
                                  'CLEARANCE for a joint between surfaces')
      end if
    else
      allocate (new%elements(0))
      call claim_surfaces(this, model, faults, new)
      if (min(new%slave, new%master) == 0) return
    end if
    model%joints = [model%joints, new]
  end subroutine read_joint

  !> The two surfaces of a joint. They differ, and no other joint lies between them.
  subroutine claim_surfaces(this, model, faults, new)
    type(card), intent(in) :: this
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(joint_request), intent(inout) :: new
    integer :: i
    call find_surface_at(this, 1, model, faults, new%slave)
    call find_surface_at(this, 1, model, faults, new%master, 2)
    if (min(new%slave, new%master) == 0) return
    if (new%slave == new%master) then
      call this%fault_at(faults, 1, 2, 'the slave surface is the master surface', &
                         'two different surfaces')
    end if
    do i = 1, size(model%joints)
      if (min(model%joints(i)%slave, model%joints(i)%master) /= min(new%slave, new%master)) cycle
      if (max(model%joints(i)%slave, model%joints(i)%master) /= max(new%slave, new%master)) cycle
      call this%fault(faults, "joint '"//model%joints(i)%name// &
                      "' lies between these two surfaces already", 'one joint for two surfaces', &
                      first=model%cards(model%joints(i)%spot%card)%place())
    end do
  end subroutine claim_surfaces

  !> Elements of a joint are JOINT8 and belong to no other joint.
  subroutine claim_elements(this, elements, model, faults)
    type(card), intent(in) :: this
    integer, intent(in) :: elements(:) !< positions
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer :: i, e, earlier
    do i = 1, size(elements)
      e = elements(i)
      if (model%problem%mesh%element_type(e) /= 'JOINT8') then
        call this%fault_parameter(faults, 'ELSET', 'element '// &
                                  as_text(model%problem%mesh%element_id(e))//' is a '// &
                                  trim(model%problem%mesh%element_type(e)), &
                                  'a set of JOINT8 elements')
        return
      end if
      earlier = model%joint_of_element(e)
      if (earlier > 0) then
        call this%fault_parameter(faults, 'ELSET', 'element '// &
                                  as_text(model%problem%mesh%element_id(e))// &
                                  ' belongs to another joint', 'one joint for each element', &
                                  first=model%cards(model%joints(earlier)%spot%card)%place())
        return
      end if
      model%joint_of_element(e) = size(model%joints) + 1
    end do
  end subroutine claim_elements
end module keywords_joint
