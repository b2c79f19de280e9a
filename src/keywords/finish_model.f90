!> Checks that need the whole deck.
module finish_model
  use applied_load, only: load_slot
  use cover_checks, only: report_bare
  use diagnostics, only: diagnostic_list
  use element_catalogue, only: is_solid
  use finish_contact, only: complete_clearances
  use finish_heat, only: complete_heat
  use finish_equations, only: complete_equations
  use finish_interfaces, only: complete_interfaces
  use finish_joints, only: complete_joints
  use finish_materials, only: complete_materials
  use finish_stages, only: complete_stages
  use finish_ties, only: complete_ties
  use finish_uplift, only: complete_uplift
  use joined_twice, only: refuse_joined_twice
  use material_catalogue, only: names_of_laws
  use model_draft, only: draft, has_request
  use verify_elements, only: refuse_inverted
  implicit none
  private
  public :: complete_model

contains

  !> Completes the draft after its last card: what depends on several cards.
  subroutine complete_model(model, faults)
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    if (model%is_in_step) then
      call model%cards(model%step_origin%card)%fault(faults, 'the step is not closed', '*END STEP')
    end if
    model%problem%node_sets = model%node_sets%trimmed()
    model%problem%element_sets = model%element_sets%trimmed()
    call check_contents(model, faults)
    call complete_materials(model, faults)
    call check_materials(model, faults)
    call check_solids(model, faults)
    ! Joints find their sides by the solids: an inverted solid would be blamed on its joint.
    if (.not. faults%has_errors()) call refuse_inverted(model, faults)
    call complete_interfaces(model, faults)
    call complete_clearances(model, faults)
    if (.not. faults%has_errors()) call refuse_joined_twice(model, faults)
    if (.not. faults%has_errors()) call complete_ties(model, faults)
    if (.not. faults%has_errors()) call complete_equations(model, faults)
    call complete_joints(model, faults)
    if (.not. faults%has_errors()) call complete_uplift(model, faults)
    call complete_stages(model, faults)
    call complete_heat(model)
    call trim_loads(model)
  end subroutine complete_model

  !> Gives back the unused end of the list; loads are moved, not copied.
  subroutine trim_loads(model)
    type(draft), intent(inout) :: model
    type(load_slot), allocatable :: shorter(:)
    integer :: i
    allocate (shorter(model%num_loads))
    do i = 1, model%num_loads
      call move_alloc(model%problem%loads(i)%item, shorter(i)%item)
    end do
    call move_alloc(shorter, model%problem%loads)
  end subroutine trim_loads

  !> A model has nodes, elements and a step.
  subroutine check_contents(model, faults)
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    if (faults%has_errors()) return
    if (size(model%cards) == 0) return
    associate (last => model%cards(size(model%cards)))
      if (model%problem%mesh%num_nodes == 0 .and. size(model%problem%tests) > 0) then
        call last%fault(faults, 'the deck ends without nodes', &
                        '*NODE; keyway --material runs the tests of materials')
      else if (model%problem%mesh%num_nodes == 0) then
        call last%fault(faults, 'the deck ends without nodes', '*NODE')
      else if (model%problem%mesh%num_elements == 0) then
        call last%fault(faults, 'the deck ends without elements', '*ELEMENT')
      else if (size(model%problem%steps) == 0) then
        call last%fault(faults, 'the deck ends without a step', '*STEP')
      end if
    end associate
  end subroutine check_contents

  !> Materials in use have a law.
  subroutine check_materials(model, faults)
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer :: i
    do i = 1, size(model%problem%materials)
      if (allocated(model%problem%materials(i)%law)) cycle
      if (has_request(model, i)) cycle ! reported by the request
      if (.not. any(model%problem%mesh%material_of_element == i)) cycle
      call model%cards(model%material_origin(i)%card)%fault( &
        faults, "material '"//model%problem%materials(i)%name//"' has no stiffness", &
        names_of_laws())
    end do
  end subroutine check_materials

  !> Every solid has a section.
  subroutine check_solids(model, faults)
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    logical, allocatable :: is_bare(:)
    integer :: i
    if (model%problem%mesh%num_elements == 0) return
    do i = 1, size(model%sections)
      if (size(model%sections(i)%elements) == 0) return ! its fault is reported
    end do
    associate (mesh => model%problem%mesh)
      is_bare = is_solid(mesh%element_type) .and. mesh%section_of_element == 0
    end associate
    call report_bare(is_bare, 'no section', 'a *SOLID SECTION for each solid element', model, &
                     faults)
  end subroutine check_solids
end module finish_model
