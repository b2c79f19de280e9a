!> *JOINT LAW, *JOINT.
module keywords_joint
  use deck_card, only: card
  use diagnostics, only: diagnostic_list
  use joint_catalogue, only: joint_law_kinds
  use keyword_spec, only: keyword, field, kind_choice, kind_real, kind_word
  use kinds, only: rk
  use model_draft, only: draft, joint_request, law_request
  use named_things, only: elements_of_set, find_surface_at
  use write_text, only: as_text
  implicit none
  private
  public :: describe_joint_law, describe_joint, read_joint_law, read_joint

  character, parameter :: nl = new_line('a')

contains

  subroutine describe_joint_law(spec)
    type(keyword), intent(out) :: spec
    spec%name = 'JOINT LAW'
    spec%family = 'joint'
    spec%place = 'model'
    spec%meaning = 'The law of a contraction joint. Closed it is elastic (KN, KT) with Coulomb '// &
                   'friction; bonded until the normal traction reaches the tensile strength, '// &
                   'which is then lost for good; open it carries nothing. Opening and tension '// &
                   'are positive. Where faces must not go into each other, PENETRATION=tol '// &
                   'repeats each increment with a contact pressure that is carried on until '// &
                   'no point in contact is deeper than tol (or further apart while pressed); '// &
                   'KN is then E/h of the softer side, h the depth of its elements, and KT '// &
                   'E/THICKNESS/(2(1+nu)), unless given; a larger KN takes fewer repetitions. '// &
                   'Points that are still bonded keep to KN, which with a tensile strength is '// &
                   'E/THICKNESS as ever. '// &
                   'UPLIFT puts the water of a reservoir into the joint: its '// &
                   'pressure pushes the faces apart, in the steps and with the factors of the '// &
                   'reservoir. tn stays the traction of the joint itself.'
    spec%example = '*JOINT LAW, NAME=CONTRACTION, FRICTION=0.6'
    spec%most_lines = 0
    allocate (spec%parameters, source=[ &
              field('NAME', kind_word, 'name of the law', is_required=.true.), &
              field('TYPE', kind_choice, 'which law', default='CONTRACTION', &
                    choices=joint_law_kinds), &
              field('KN', kind_real, 'normal stiffness', 'Pa/m', 'E/THICKNESS of the slave side', &
                    lowest=0.0_rk, excludes_lowest=.true.), &
              field('KT', kind_real, 'tangential stiffness', 'Pa/m', 'KN/(2(1+nu))', &
                    lowest=0.0_rk, excludes_lowest=.true.), &
              field('TENSILE STRENGTH', kind_real, 'normal traction at first opening', 'Pa', &
                    '0', lowest=0.0_rk), &
              field('FRICTION', kind_real, 'Coulomb coefficient', '', '0', lowest=0.0_rk), &
              field('COHESION', kind_real, 'shear strength without pressure', 'Pa', '0', &
                    lowest=0.0_rk), &
              field('THICKNESS', kind_real, 'makes KN from E when KN is not given', 'm', '0.02', &
                    lowest=0.0_rk, excludes_lowest=.true.), &
              field('GAP', kind_real, 'opening at the start', 'm', '0', lowest=0.0_rk), &
              field('PENETRATION', kind_real, 'largest penetration of points in contact '// &
                    '(augmented Lagrangian); KN then only leads the iteration, KT makes a '// &
                    'sticking point yield as ever', 'm', &
                    'pressure/KN', lowest=0.0_rk, excludes_lowest=.true.), &
              field('UPLIFT', kind_word, 'name of a *RESERVOIR whose water is in the joint'), &
              field('PROFILE', kind_choice, 'how far: LINEAR, full head at the upstream edge '// &
                    'falling to none at the downstream edge, open or not; OPEN, full head as '// &
                    'far as the joint is open from the upstream edge on, none elsewhere', &
                    default='LINEAR', choices='LINEAR | OPEN'), &
              field('TAIL WATER', kind_word, 'name of a *RESERVOIR at the downstream edge, '// &
                    'PROFILE=LINEAR')])
  end subroutine describe_joint_law

  subroutine read_joint_law(this, model, faults)
    type(card), intent(in) :: this
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(law_request) :: new
    integer :: i
    new%law%name = this%word('NAME')
    do i = 1, size(model%laws)
      if (model%laws(i)%law%name /= new%law%name) cycle
      call this%fault_parameter(faults, 'NAME', "joint law '"//this%text('NAME')// &
                                "' is defined twice", 'a name that is used once', &
                                first=model%cards(model%laws(i)%spot%card)%place())
    end do
    new%law%kind = this%word('TYPE')
    new%law%normal_stiffness = this%real('KN')
    new%law%tangent_stiffness = this%real('KT')
    new%law%strength = this%real('TENSILE STRENGTH')
    new%law%friction = this%real('FRICTION')
    new%law%cohesion = this%real('COHESION')
    new%law%thickness = this%real('THICKNESS')
    new%law%gap = this%real('GAP')
    new%law%penetration = this%real('PENETRATION')
    if (new%law%gap > 0.0_rk .and. new%law%strength > 0.0_rk) then
      call this%fault_parameter(faults, 'TENSILE STRENGTH', 'a joint with a GAP has no strength', &
                                'GAP or TENSILE STRENGTH, not both')
    end if
    if (this%has('KN') .and. this%has('THICKNESS')) then
      call this%warn(faults, 'THICKNESS has no effect: KN is given')
    end if
    call read_water(this, new, faults)
    new%spot = model%here(0)
    model%laws = [model%laws, new]
  end subroutine read_joint_law

  !> The water in the joint; whether the reservoirs exist is known at the end of the deck.
  subroutine read_water(this, new, faults)
    type(card), intent(in) :: this
    type(law_request), intent(inout) :: new
    type(diagnostic_list), intent(inout) :: faults
    new%uplift = this%word('UPLIFT')
    new%tail_water = this%word('TAIL WATER')
    new%profile = this%word('PROFILE')
    if (new%uplift == '' .and. new%tail_water /= '') then
      call this%fault_parameter(faults, 'TAIL WATER', 'TAIL WATER stands without UPLIFT', &
                                'UPLIFT=the reservoir upstream')
    else if (new%uplift == '' .and. this%has('PROFILE')) then
      call this%warn(faults, 'PROFILE has no effect: UPLIFT is not given')
    else if (new%profile == 'OPEN' .and. new%tail_water /= '') then
      call this%fault_parameter(faults, 'TAIL WATER', 'TAIL WATER stands beside PROFILE=OPEN', &
                                'PROFILE=LINEAR')
    end if
  end subroutine read_water

  subroutine describe_joint(spec)
    type(keyword), intent(out) :: spec
    spec%name = 'JOINT'
    spec%family = 'joint'
    spec%place = 'model'
    spec%meaning = 'A joint: of the JOINT8 elements of a set, or between two surfaces whose '// &
                   'meshes may differ, without interface elements. Its points are the nodes of '// &
                   'the slave side, or Gauss points; at the nodes the traction of a stiff '// &
                   'joint does not oscillate. Between surfaces each node of the slave stands '// &
                   'on a mortar projection of the master; what has no partner is told. The '// &
                   'finer side is the better slave, as a rule: it sees more of a traction '// &
                   'that varies. Take the coarser one where the face itself bends between '// &
                   'meshes 1:2 and more apart (smoother tractions), or where time counts: the '// &
                   'joint then has fewer points. '// &
                   'The normal points from the master to the slave.'
    spec%example = '*JOINT, NAME=J1, LAW=CONTRACTION, ELSET=JOINT1'//nl// &
                   '*JOINT, NAME=J2, LAW=CONTRACTION'//nl//'LEFT_OF_2, RIGHT_OF_2'
    spec%most_lines = 1
    allocate (spec%parameters, source=[ &
              field('NAME', kind_word, 'name of the joint', is_required=.true.), &
              field('LAW', kind_word, 'name of a *JOINT LAW', is_required=.true.), &
              field('ELSET', kind_word, 'its JOINT8 elements, instead of surfaces'), &
              field('INTEGRATION', kind_choice, 'where its points are', default='NODES', &
                    choices='NODES | GAUSS'), &
              field('CLEARANCE', kind_choice, 'between surfaces: they touch as they are '// &
                    'meshed, but for the GAP of the law, or their distance as meshed counts '// &
                    'as well', default='NONE', choices='NONE | MEASURED')])
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

  !> The two surfaces of a joint; they differ, and no joint has both of them already.
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
      if (model%scene%mesh%element_type(e) /= 'JOINT8') then
        call this%fault_parameter(faults, 'ELSET', 'element '// &
                                  as_text(model%scene%mesh%element_id(e))//' is a '// &
                                  trim(model%scene%mesh%element_type(e)), &
                                  'a set of JOINT8 elements')
        return
      end if
      earlier = model%joint_of_element(e)
      if (earlier > 0) then
        call this%fault_parameter(faults, 'ELSET', 'element '// &
                                  as_text(model%scene%mesh%element_id(e))// &
                                  ' belongs to another joint', 'one joint for each element', &
                                  first=model%cards(model%joints(earlier)%spot%card)%place())
        return
      end if
      model%joint_of_element(e) = size(model%joints) + 1
    end do
  end subroutine claim_elements
end module keywords_joint
