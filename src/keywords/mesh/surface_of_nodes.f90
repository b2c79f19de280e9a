!> *SURFACE, TYPE=NODE: the faces that the nodes span.
module surface_of_nodes
  use dam_mesh, only: surface
  use deck_card, only: card
  use diagnostics, only: diagnostic_list
  use element_catalogue, only: is_solid
  use mesh_faces, only: face_nodes, find_exterior
  use model_draft, only: draft
  use named_things, only: nodes_at
  use write_text, only: as_text
  implicit none
  private
  public :: find_faces

contains

  !> The outer faces of solids all of whose corners are nodes of the card. A node that no such face
  !> has is a fault.
  subroutine find_faces(this, model, faults, new)
    type(card), intent(in) :: this
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(surface), intent(inout) :: new
    type(surface) :: skin
    logical, allocatable :: is_given(:), is_spanned(:), is_in(:)
    integer :: i, num_before
    num_before = faults%num_errors
    call mark_nodes(this, model, faults, is_given)
    associate (mesh => model%problem%mesh)
      call find_exterior(mesh, pack([(i, i=1, mesh%num_elements)], &
                                    is_solid(mesh%element_type(:mesh%num_elements))), skin)
      allocate (is_in(size(skin%element)))
      allocate (is_spanned(size(is_given)), source=.false.)
      do i = 1, size(is_in)
        associate (corners => face_nodes(mesh, skin%element(i), skin%face(i)))
          is_in(i) = all(is_given(corners))
          if (is_in(i)) is_spanned(corners) = .true.
        end associate
      end do
      new%element = pack(skin%element, is_in)
      new%face = pack(skin%face, is_in)
      if (all(is_spanned .or. .not. is_given) .or. faults%num_errors > num_before) return
      i = findloc(is_given .and. .not. is_spanned, .true., dim=1)
      call this%fault(faults, 'no outer face of a solid has node '//as_text(mesh%node_id(i))// &
                      ' and all its corners among the nodes of the surface', &
                      'TYPE=ELEMENT with elements and faces, or all nodes of each face')
    end associate
  end subroutine find_faces

  !> Marks the nodes of the card. The second field, an area, has no effect.
  subroutine mark_nodes(this, model, faults, is_given)
    type(card), intent(in) :: this
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    logical, allocatable, intent(out) :: is_given(:) !< (nodes)
    integer, allocatable :: members(:)
    integer :: line
    allocate (is_given(model%problem%mesh%num_nodes), source=.false.)
    do line = 1, this%num_lines
      if (this%is_empty_at(line, 1)) then
        call this%fault_at(faults, line, 1, 'found an empty field', &
                           'the id of a node or the name of a node set')
        cycle
      end if
      if (this%num_fields(line) > 2 .or. &
          .not. (this%is_empty_at(line, 2) .or. this%is_real_at(line, 2))) then
        call this%fault_at(faults, line, min(3, this%num_fields(line)), "found '"// &
                           this%text_at(line, min(3, this%num_fields(line)))//"'", &
                           'a node or a node set, and at most an area')
      else if (this%num_fields(line) == 2) then
        call this%ignore(faults, 'the area of nodes has no effect: faces have their own')
      end if
      call nodes_at(this, line, 1, model, faults, members)
      is_given(members) = .true.
    end do
  end subroutine mark_nodes
end module surface_of_nodes
