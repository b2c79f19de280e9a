!> Faces that a deck holds as elements beside the solids, as meshes from Gmsh have them. They carry
!> no loads; *SURFACE may name their sets.
module face_elements
  use growing_lists, only: append
  use id_map, only: position_table
  use set_lists, only: set_list
  implicit none
  private
  public :: face_element_list

  type :: face_element_list
    integer :: num_faces = 0
    integer, allocatable :: ids(:) !< of the elements
    integer, allocatable :: nodes(:) !< (4*faces) ids of nodes; a triangle repeats its last one
    type(position_table) :: position !< of the number of an element
    type(set_list) :: sets !< of positions
  contains
    procedure :: add => add_face
  end type face_element_list

contains

  !> Adds a face; the first of two faces of one number stays.
  pure subroutine add_face(self, id, nodes)
    class(face_element_list), intent(inout) :: self
    integer, intent(in) :: id !< of the element
    integer, intent(in) :: nodes(4) !< ids
    integer :: earlier, num_nodes
    call self%position%insert(id, self%num_faces + 1, earlier)
    if (earlier > 0) return
    num_nodes = 4*self%num_faces
    call append(self%nodes, num_nodes, nodes)
    call append(self%ids, self%num_faces, id)
  end subroutine add_face
end module face_elements
