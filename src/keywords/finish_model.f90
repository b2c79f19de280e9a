!> What can be said only when the whole deck is read: nothing is left open, joints are built.
module finish_model
  use applied_load, only: load_slot
  use contact_defaults, only: take_layer_stiffness
  use diagnostics, only: diagnostic_list
  use element_catalogue, only: is_solid
  use element_joint8, only: build_joint_points, find_attached_solids
  use errors, only: error_type
  use finish_concrete, only: complete_concretes
  use finish_ties, only: complete_ties
  use finish_uplift, only: complete_uplift
  use finish_user_materials, only: complete_user_materials
  use joint_catalogue, only: make_joint_law
  use joint_constants, only: law_constants
  use joint_points, only: joint
  use kinds, only: rk
  use model_draft, only: draft
  use named_things, only: longest_name
  use nearest_words, only: nearest_word
  use write_text, only: as_text
  implicit none
  private
  public :: complete_model

contains

  subroutine complete_model(model, faults)
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer :: i
    if (model%is_in_step) then
      call model%cards(model%step_origin%card)%fault(faults, 'the step is not closed', '*END STEP')
    end if
    model%scene%node_sets = model%node_sets%trimmed()
    model%scene%element_sets = model%element_sets%trimmed()
    call check_contents(model, faults)
    call complete_concretes(model, faults)
    call complete_user_materials(model, faults)
    call check_materials(model, faults)
    call check_solids(model, faults)
    call check_joint_elements(model, faults)
    do i = 1, size(model%joints)
      call build_joint(i, model, faults)
    end do
    if (.not. faults%has_errors()) call complete_ties(model, faults)
    if (.not. faults%has_errors()) call complete_uplift(model, faults)
    call trim_loads(model)
  end subroutine complete_model

  !> Gives back the unused end of the list; loads are moved, not copied.
  subroutine trim_loads(model)
    type(draft), intent(inout) :: model
    type(load_slot), allocatable :: shorter(:)
    integer :: i
    allocate (shorter(model%num_loads))
    do i = 1, model%num_loads
      call move_alloc(model%scene%loads(i)%item, shorter(i)%item)
    end do
    call move_alloc(shorter, model%scene%loads)
  end subroutine trim_loads

  !> A model has nodes, elements and a step.
  subroutine check_contents(model, faults)
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    if (faults%has_errors()) return
    if (size(model%cards) == 0) return
    associate (last => model%cards(size(model%cards)))
      if (model%scene%mesh%num_nodes == 0 .and. size(model%scene%tests) > 0) then
        call last%fault(faults, 'the deck ends without nodes', &
                        '*NODE; keyway --material runs the tests of materials')
      else if (model%scene%mesh%num_nodes == 0) then
        call last%fault(faults, 'the deck ends without nodes', '*NODE')
      else if (model%scene%mesh%num_elements == 0) then
        call last%fault(faults, 'the deck ends without elements', '*ELEMENT')
      else if (size(model%scene%steps) == 0) then
        call last%fault(faults, 'the deck ends without a step', '*STEP')
      end if
    end associate
  end subroutine check_contents

  !> Materials in use have a law.
  subroutine check_materials(model, faults)
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer :: i
    do i = 1, size(model%scene%materials)
      if (allocated(model%scene%materials(i)%law)) cycle
      if (any(model%concretes%material == i)) cycle ! told there
      if (any(model%user_materials%material == i)) cycle ! told there
      if (.not. any(model%scene%mesh%material_of_element == i)) cycle
      call model%cards(model%material_origin(i)%card)%fault( &
        faults, "material '"//model%scene%materials(i)%name//"' has no stiffness", '*ELASTIC')
    end do
  end subroutine check_materials

  !> Every solid has a section.
  subroutine check_solids(model, faults)
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    logical, allocatable :: is_bare(:)
    integer :: i
    if (model%scene%mesh%num_elements == 0) return
    do i = 1, size(model%sections)
      if (size(model%sections(i)%elements) == 0) return ! its fault is told
    end do
    associate (mesh => model%scene%mesh)
      is_bare = is_solid(mesh%element_type) .and. mesh%section_of_element == 0
    end associate
    call tell_bare(is_bare, 'no section', 'a *SOLID SECTION for each solid element', model, faults)
  end subroutine check_solids

  !> Every JOINT8 element belongs to a joint.
  subroutine check_joint_elements(model, faults)
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    logical, allocatable :: is_bare(:)
    integer :: i
    if (model%scene%mesh%num_elements == 0) return
    do i = 1, size(model%joints)
      if (size(model%joints(i)%elements) == 0) return ! its fault is told
    end do
    is_bare = model%scene%mesh%element_type == 'JOINT8' .and. model%joint_of_element == 0
    call tell_bare(is_bare, 'no joint', 'a *JOINT for each JOINT8 element', model, faults)
  end subroutine check_joint_elements

  !> Points at the first of the elements that lack something.
  subroutine tell_bare(is_bare, lack, expected, model, faults)
    logical, intent(in) :: is_bare(:) !< (elements)
    character(*), intent(in) :: lack, expected
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    character(:), allocatable :: others
    integer :: e
    if (.not. any(is_bare)) return
    e = findloc(is_bare, .true., dim=1)
    others = ''
    if (count(is_bare) > 1) others = ', as '//as_text(count(is_bare) - 1)//' more'
    associate (spot => model%element_origin(e))
      call model%cards(spot%card)%fault_at(faults, spot%line, 1, 'element '// &
                                           as_text(model%scene%mesh%element_id(e))//' has '// &
                                           lack//others, expected)
    end associate
  end subroutine tell_bare

  !> Completes the law of a joint and lays its points.
  subroutine build_joint(number, model, faults)
    integer, intent(in) :: number
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(joint) :: new
    type(law_constants) :: law
    type(error_type), allocatable :: error
    character(longest_name) :: known(size(model%laws))
    integer :: i
    logical :: is_found
    associate (request => model%joints(number), &
               place => model%cards(model%joints(number)%spot%card))
      is_found = .false.
      do i = 1, size(known)
        known(i) = model%laws(i)%law%name
        if (model%laws(i)%law%name /= request%law) cycle
        law = model%laws(i)%law
        is_found = .true.
      end do
      if (.not. is_found) then
        call place%fault_parameter(faults, 'LAW', "there is no joint law '"//place%text('LAW')// &
                                   "'", 'the name of a *JOINT LAW', &
                                   nearest_word(request%law, known))
        return
      end if
      if (size(request%elements) == 0 .or. faults%has_errors()) return
      call complete_law(number, model, law, faults)
      new%name = request%name
      call make_joint_law(law, new%law)
      if (.not. allocated(new%law)) return
      call build_joint_points(model%scene%mesh, request%elements, request%is_nodal, new, error)
      if (allocated(error)) then
        call place%fault(faults, error%message)
      else if (new%num_points == 0) then
        call place%fault(faults, 'the joint has no points', 'pairs of different nodes')
      end if
    end associate
    call append_joint(model, new)
  end subroutine build_joint

  subroutine append_joint(model, new)
    type(draft), intent(inout) :: model
    type(joint), intent(in) :: new
    type(joint), allocatable :: longer(:)
    integer :: i
    allocate (longer(size(model%scene%joints) + 1))
    do i = 1, size(model%scene%joints)
      longer(i) = model%scene%joints(i)
    end do
    longer(size(longer)) = new
    call move_alloc(longer, model%scene%joints)
  end subroutine append_joint

  !> KN and KT that the deck does not give, from the solid on the slave side (NOTES 3).
  subroutine complete_law(number, model, law, faults)
    integer, intent(in) :: number !< of the joint
    type(draft), intent(in) :: model
    type(law_constants), intent(inout) :: law
    type(diagnostic_list), intent(inout) :: faults
    integer, allocatable :: solid(:, :), side(:), materials(:)
    if (.not. law%needs_solid()) return
    associate (request => model%joints(number), &
               place => model%cards(model%joints(number)%spot%card))
      allocate (side(size(request%elements)))
      call find_attached_solids(model%scene%mesh, request%elements, solid, side)
      materials = pack(solid(2, :), solid(2, :) > 0)
      materials = model%scene%mesh%material_of_element(materials)
      if (size(materials) == 0) then
        call place%fault(faults, 'no solid on the slave side gives KN and KT', &
                         'KN and KT in the *JOINT LAW')
        return
      else if (any(materials /= materials(1))) then
        call place%warn(faults, "the slave side has several materials; KN and KT are made of '"// &
                        model%scene%materials(materials(1))%name//"'")
      else if (model%scene%materials(materials(1))%young <= 0.0_rk) then
        call place%fault(faults, "the material of the slave side, '"// &
                         model%scene%materials(materials(1))%name//"', has no E (a UMAT) to "// &
                         'make KN and KT of', 'KN and KT in the *JOINT LAW')
        return
      end if
      if (law%asks_for_layer()) then
        associate (nodes => model%scene%mesh%nodes(:, request%elements))
          call take_layer_stiffness(model%scene, [solid(1, :), solid(2, :)], &
                                    reshape([nodes(1:4, :), nodes(5:8, :)], &
                                            [4, 2*size(request%elements)]), law)
        end associate
      end if
      call law%complete_stiffness(model%scene%materials(materials(1))%young, &
                                  model%scene%materials(materials(1))%poisson)
    end associate
  end subroutine complete_law
end module finish_model
