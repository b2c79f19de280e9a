!> Builds the joints after the whole deck is read: completes their laws and places their points.
module finish_joints
  use contact_clearance, only: set_clearance
  use contact_defaults, only: softest_layer
  use coupling_joint, only: lay_gauss_points, lay_node_points
  use cover_checks, only: claim_facets, claims, keep_cover, open_claims, report_bare
  use dam_mesh, only: node_tie
  use deck_card, only: card
  use diagnostics, only: diagnostic_list
  use element_joint8, only: build_joint_points, find_attached_solids
  use errors, only: error_type
  use facet_segments, only: find_segments, leave_bare
  use guest_list, only: ties_of
  use joint_law, only: joint_state, solid_behind, traction_law
  use joint_points, only: dam_joint
  use kinds, only: rk
  use model_draft, only: draft, law_of_joint
  use named_things, only: longest_name
  use nearest_words, only: nearest_word
  use surface_facets, only: list_surface_facets, mark_corners
  use surface_segments, only: facet_set, segment_set, surface_cover
  use write_text, only: as_text
  implicit none
  private
  public :: complete_joints, farthest_gap, farthest_contact, followers

  !> Largest distance of facets that a joint connects, in diagonals of a facet: of faces that count
  !> as touching, and of faces with a gap that may close.
  real(rk), parameter :: farthest_contact = 0.5_rk, farthest_gap = 4.0_rk

contains

  !> Builds the joints of the deck, in its order.
  subroutine complete_joints(model, faults)
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(claims) :: taken
    class(traction_law), allocatable :: law
    type(dam_joint), allocatable :: joints(:)
    integer :: i
    logical :: is_fit
    call check_joint_elements(model, faults)
    call open_claims(model%problem%mesh%num_nodes, count_slave_faces(model), taken)
    allocate (joints(size(model%joints)))
    do i = 1, size(model%joints)
      call find_law(i, model, faults, law, is_fit)
      if (.not. is_fit .or. faults%has_errors()) cycle
      if (model%joints(i)%slave == 0) then
        call build_from_elements(i, model, law, faults, joints(i))
      else
        call build_from_surfaces(i, model, law, taken, faults, joints(i))
      end if
    end do
    if (.not. faults%has_errors()) call move_alloc(joints, model%problem%joints)
  end subroutine complete_joints

  !> Every JOINT8 element belongs to a joint.
  subroutine check_joint_elements(model, faults)
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    logical, allocatable :: is_bare(:)
    integer :: i
    if (model%problem%mesh%num_elements == 0) return
    do i = 1, size(model%joints)
      if (size(model%joints(i)%elements) + model%joints(i)%slave == 0) return ! reported
    end do
    is_bare = model%problem%mesh%element_type == 'JOINT8' .and. model%joint_of_element == 0
    call report_bare(is_bare, 'no joint', 'a *JOINT for each JOINT8 element', model, faults)
  end subroutine check_joint_elements

  !> Faces of the slave surfaces of all joints.
  pure integer function count_slave_faces(model) result(num)
    type(draft), intent(in) :: model
    integer :: i
    num = 0
    do i = 1, size(model%joints)
      if (model%joints(i)%slave == 0) cycle
      num = num + size(model%problem%surfaces(model%joints(i)%slave)%element)
    end do
  end function count_slave_faces

  !> The law that a joint names.
  subroutine find_law(number, model, faults, law, is_found)
    integer, intent(in) :: number !< of the joint
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    class(traction_law), allocatable, intent(out) :: law
    logical, intent(out) :: is_found
    character(longest_name) :: known(size(model%laws))
    integer :: i
    i = law_of_joint(model, number)
    is_found = i > 0
    if (is_found) then
      allocate (law, source=model%laws(i)%law)
      return
    end if
    do i = 1, size(known)
      known(i) = model%laws(i)%law%name
    end do
    associate (place => model%cards(model%joints(number)%spot%card))
      call place%fault_parameter(faults, 'LAW', "there is no joint law '"//place%text('LAW')// &
                                 "'", 'the name of a *JOINT LAW', &
                                 nearest_word(model%joints(number)%law, known))
    end associate
  end subroutine find_law

  !> A joint of JOINT8 elements.
  subroutine build_from_elements(number, model, law, faults, new)
    integer, intent(in) :: number
    type(draft), intent(in) :: model
    class(traction_law), intent(inout) :: law
    type(diagnostic_list), intent(inout) :: faults
    type(dam_joint), intent(out) :: new
    type(error_type), allocatable :: error
    integer, allocatable :: solid(:, :), side(:)
    integer :: i
    associate (request => model%joints(number), &
               place => model%cards(model%joints(number)%spot%card))
      if (size(request%elements) == 0) return ! its fault is reported
      if (law%needs_solid()) then
        allocate (side(size(request%elements)))
        call find_attached_solids(model%problem%mesh, request%elements, solid, side)
        associate (nodes => model%problem%mesh%nodes(:, request%elements))
          i = merge(2, 1, any(solid(2, :) > 0))
          call complete_law(place, pack(solid(i, :), solid(i, :) > 0), &
                            [solid(1, :), solid(2, :)], [nodes(1:4, :), nodes(5:8, :)], model, &
                            law, faults)
        end associate
      end if
      new%name = request%name
      new%kind = 'joint'
      allocate (new%law, source=law)
      call build_joint_points(model%problem%mesh, request%elements, request%is_nodal, new, error)
      if (allocated(error)) then
        call place%fault(faults, error%message)
      else if (new%num_points == 0) then
        call place%fault(faults, 'the joint has no points', 'pairs of different nodes')
      end if
    end associate
  end subroutine build_from_elements

  !> Points whose faces are apart at the start do not get the strength of their law.
  subroutine warn_of_lost_strength(place, law, clearance, faults)
    type(card), intent(in) :: place
    class(traction_law), intent(in) :: law
    real(rk), intent(in) :: clearance(:) !< (points) [m]
    type(diagnostic_list), intent(inout) :: faults
    type(joint_state) :: closed, apart
    integer :: lost
    call law%start_state(0.0_rk*clearance, closed)
    call law%start_state(clearance, apart)
    lost = count(apart%is_broken .and. .not. closed%is_broken)
    if (lost == 0) return
    call place%warn(faults, as_text(lost)//' of '//as_text(size(clearance))//' points have no '// &
                    'strength: their faces are apart at the start (CLEARANCE=MEASURED)', &
                    'CLEARANCE=NONE where the faces are bonded')
  end subroutine warn_of_lost_strength

  !> A joint between two surfaces.
  subroutine build_from_surfaces(number, model, law, taken, faults, new)
    integer, intent(in) :: number
    type(draft), intent(inout) :: model !< gets the cover
    class(traction_law), intent(inout) :: law
    type(claims), intent(inout) :: taken
    type(diagnostic_list), intent(inout) :: faults
    type(dam_joint), intent(out) :: new
    type(facet_set) :: slave, master
    type(segment_set) :: segments
    type(surface_cover) :: cover
    logical, allocatable :: is_bare(:)
    integer :: line
    line = max(1, model%joints(number)%spot%line)
    associate (request => model%joints(number), mesh => model%problem%mesh, &
               place => model%cards(model%joints(number)%spot%card))
      call list_surface_facets(mesh, model%problem%surfaces(request%slave), slave)
      call list_surface_facets(mesh, model%problem%surfaces(request%master), master)
      if (law%needs_solid()) then
        call complete_law(place, slave%element, [slave%element, master%element], &
                          [slave%node, master%node], model, law, faults)
      end if
      new%name = request%name
      new%kind = 'joint'
      allocate (new%law, source=law)
      call find_segments(mesh%x, slave, master, segments, cover, &
                         merge(farthest_gap, farthest_contact, request%is_measured))
      if (request%is_nodal) then
        call lay_node_points(mesh%x, slave, master, segments, followers(model, slave), &
                             request%is_measured, new, is_bare)
        call leave_bare(mesh%x, slave, is_bare, cover)
      else
        call lay_gauss_points(mesh%x, slave, master, segments, request%is_measured, new)
      end if
      if (request%is_measured) then
        call set_clearance(request, mesh%x, new)
        call warn_of_lost_strength(place, law, new%clearance, faults)
      end if
      if (new%num_points == 0 .and. segments%num_segments > 0) then
        call place%fault_at(faults, line, 1, 'the joint has no points: its surfaces share '// &
                            'their nodes', 'faces with nodes of their own')
      else if (new%num_points == 0) then
        call place%fault_at(faults, line, 1, 'the two surfaces do not lie on each other', &
                            'opposite faces at a distance of less than '// &
                            trim(merge('4 facets    ', 'half a facet', request%is_measured)))
      else
        call keep_cover(place, request%name, 'JOINT', cover, request%is_measured, .false., model, &
                        faults)
      end if
    end associate
    call check_claims(number, slave, cover, model, taken, faults)
  end subroutine build_from_surfaces

  !> Nodes that a tie makes depend on nodes of a face.
  function followers(model, face) result(is_tied)
    type(draft), intent(in) :: model
    type(facet_set), intent(in) :: face
    logical, allocatable :: is_tied(:)
    logical, allocatable :: is_there(:)
    type(node_tie), allocatable :: ties(:)
    integer :: i, k
    allocate (is_tied(model%problem%mesh%num_nodes), source=.false.)
    is_there = mark_corners(model%problem%mesh%num_nodes, face)
    call ties_of(model%problem%guests, ties)
    do i = 1, size(ties)
      if (allocated(ties(i)%item_direction)) cycle ! an equation leaves other directions free
      associate (tie => ties(i))
        do k = 1, size(tie%node)
          is_tied(tie%node(k)) = is_tied(tie%node(k)) .or. &
                                 any(is_there(tie%item(tie%first(k):tie%first(k + 1) - 1)))
        end do
      end associate
    end do
  end function followers

  !> Where the stiffnesses of a joint or of a contact pair are given.
  pure function remedy(place) result(text)
    type(card), intent(in) :: place !< of the joint
    character(:), allocatable :: text
    text = 'KN and KT in the *JOINT LAW'
    if (place%keyword /= 'JOINT') text = 'stiffness and stick slope in *SURFACE BEHAVIOR and '// &
                                         '*FRICTION'
  end function remedy

  !> Reports a face that is a slave of two joints.
  subroutine check_claims(number, slave, cover, model, taken, faults)
    integer, intent(in) :: number
    type(facet_set), intent(in) :: slave
    type(surface_cover), intent(in) :: cover
    type(draft), intent(in) :: model
    type(claims), intent(inout) :: taken
    type(diagnostic_list), intent(inout) :: faults
    integer :: facet, earlier, line
    call claim_facets(taken, number, slave, cover, facet, earlier)
    if (facet == 0) return
    associate (place => model%cards(model%joints(number)%spot%card))
      line = max(1, model%joints(number)%spot%line)
      call place%fault_at(faults, line, 1, 'a face of element '// &
                          as_text(model%problem%mesh%element_id(slave%element(facet)))// &
                          " is a slave of joint '"//model%joints(earlier)%name//"' already", &
                          'faces that joints cover once', &
                          first=model%cards(model%joints(earlier)%spot%card)%place())
    end associate
  end subroutine check_claims

  !> Derives KN and KT that the deck does not give from the solids on the slave side
  !> (paper_notes.md, 3). Where this side has interface quads, the solids are those of the master
  !> side.
  subroutine complete_law(place, solids, behind, corners, model, law, faults)
    type(card), intent(in) :: place !< of the joint
    integer, intent(in) :: solids(:) !< of the slave side, positions
    integer, intent(in) :: behind(:) !< the element behind each facet of either side, 0 for none
    integer, intent(in) :: corners(:) !< nodes of these facets, four each
    type(draft), intent(in) :: model
    class(traction_law), intent(inout) :: law
    type(diagnostic_list), intent(inout) :: faults
    integer :: materials(size(solids))
    materials = model%problem%mesh%material_of_element(solids)
    if (size(materials) == 0) then
      call place%fault(faults, 'there is no solid behind the joint to derive KN and KT from', &
                       remedy(place))
      return
    else if (model%problem%materials(materials(1))%young <= 0.0_rk) then
      call place%fault(faults, "the material of the slave side, '"// &
                       model%problem%materials(materials(1))%name//"', has no E (a UMAT) to "// &
                       'derive KN and KT from', remedy(place))
      return
    else if (any(materials /= materials(1))) then
      call place%warn(faults, 'the slave side has several materials; KN and KT '// &
                      "are derived from '"// &
                      model%problem%materials(materials(1))%name//"'")
    end if
    associate (slave => model%problem%materials(materials(1)))
      call law%complete(solid_behind(slave%young, slave%poisson, &
                                     softest_layer(model%problem, behind, &
                                                   reshape(corners, [4, size(behind)]))))
    end associate
  end subroutine complete_law
end module finish_joints
