!> *SURFACE, TYPE=ELEMENT SET: the faces of solids that elements of faces in the deck lie on.
module surface_of_faces
  use dam_mesh, only: surface
  use deck_card, only: card
  use diagnostics, only: diagnostic_list
  use element_catalogue, only: is_solid
  use growing_lists, only: append
  use mesh_faces, only: face_nodes, face_table, find_exterior, find_face, insert_face, open_table
  use model_draft, only: draft
  use named_things, only: nearest_set
  use sorted_lists, only: sorted_unique
  use write_text, only: as_text
  implicit none
  private
  public :: find_set_faces

contains

  !> The outer faces of solids that the elements of the sets lie on. An element without such a face
  !> is a fault.
  subroutine find_set_faces(this, model, faults, new)
    type(card), intent(in) :: this
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(surface), intent(inout) :: new
    type(surface) :: skin
    type(face_table) :: table
    integer, allocatable :: members(:), found(:)
    integer :: line, i, number, num
    allocate (found(0))
    num = 0
    call open_skin(model, skin, table)
    do line = 1, this%num_lines
      call find_set(this, line, model, faults, members)
      do i = 1, size(members)
        number = face_below(model, members(i), table)
        if (number > 0) then
          call append(found, num, number)
        else
          call this%fault_at(faults, line, 1, 'element '// &
                             as_text(model%faces%ids(members(i)))// &
                             ' of the set lies on no outer face of a solid', &
                             'elements with the nodes of outer faces of solids')
          exit
        end if
      end do
    end do
    found = sorted_unique(found(:num))
    new%element = skin%element(found)
    new%face = skin%face(found)
  end subroutine find_set_faces

  !> The outer faces of all solids, and a table to find them.
  subroutine open_skin(model, skin, table)
    type(draft), intent(in) :: model
    type(surface), intent(out) :: skin
    type(face_table), intent(out) :: table
    integer :: i, number
    associate (mesh => model%problem%mesh)
      call find_exterior(mesh, pack([(i, i=1, mesh%num_elements)], &
                                    is_solid(mesh%element_type(:mesh%num_elements))), skin)
      call open_table(mesh%num_nodes, size(skin%element), table)
      do i = 1, size(skin%element)
        call insert_face(table, face_nodes(mesh, skin%element(i), skin%face(i)), number)
      end do
    end associate
  end subroutine open_skin

  !> Number in the table of the face that an element lies on, 0 for none.
  integer function face_below(model, member, table) result(number)
    type(draft), intent(in) :: model
    integer, intent(in) :: member !< position of the element
    type(face_table), intent(in) :: table
    integer :: nodes(4), k
    do k = 1, 4
      nodes(k) = model%node_position%find(model%faces%nodes(4*(member - 1) + k))
    end do
    number = 0
    if (all(nodes > 0)) number = find_face(table, nodes)
  end function face_below

  !> Positions of the elements of the set that a line names.
  subroutine find_set(this, line, model, faults, members)
    type(card), intent(in) :: this
    integer, intent(in) :: line
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer, allocatable, intent(out) :: members(:)
    character(:), allocatable :: problem
    integer :: number
    allocate (members(0))
    number = model%faces%sets%find(this%word_at(line, 1))
    if (this%num_fields(line) > 1) then
      call this%fault_at(faults, line, 2, "found '"//this%text_at(line, 2)//"'", &
                         'the name of a set alone')
    else if (number == 0) then
      problem = "there is no set of faces '"//this%text_at(line, 1)//"'"
      call this%fault_at(faults, line, 1, problem, &
                         'a set of elements CPS4, S4, CPS3 or the like beside the solids', &
                         nearest_set(this%word_at(line, 1), model%faces%sets, problem, faults))
    else
      members = model%faces%sets%sets(number)%members
    end if
  end subroutine find_set
end module surface_of_faces
