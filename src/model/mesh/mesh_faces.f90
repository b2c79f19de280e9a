!> Faces of hexahedra: their nodes, area vectors, and the exterior faces.
!>
!> Faces have the numbers of CalculiX and Abaqus, S1..S6. Their corners are listed here so that the
!> right-hand rule gives the outward normal. A face with one repeated node is a triangle; a face
!> with fewer than three different nodes has collapsed.
module mesh_faces
  use kinds, only: rk
  use dam_mesh, only: fe_mesh, surface
  use small_matrix, only: cross_product
  implicit none
  private
  public :: face_nodes, face_vector, face_centre, count_corners
  public :: face_table, open_table, insert_face, find_face
  public :: find_exterior, mark_covered

  !> Corners of S1..S6, right-hand rule outward.
  integer, parameter :: face_corner(4, 6) = reshape([1, 4, 3, 2, 5, 6, 7, 8, 1, 2, 6, 5, &
                                                     2, 3, 7, 6, 3, 4, 8, 7, 4, 1, 5, 8], [4, 6])

  !> Table to find faces by their nodes in any order: lists by the smallest node.
  type :: face_table
    integer :: num_faces = 0
    integer, allocatable :: first(:) !< (nodes of the mesh) newest face with this smallest node
    integer, allocatable :: next(:) !< (capacity) next face of the same list, 0 at its end
    integer, allocatable :: key(:, :) !< (4, capacity) different nodes, ascending, zeros in front
  end type face_table

contains

  !> Positions of the four corners of a face in the mesh.
  pure function face_nodes(mesh, element, face) result(nodes)
    type(fe_mesh), intent(in) :: mesh
    integer, intent(in) :: element !< position of the element
    integer, intent(in) :: face !< 1..6
    integer :: nodes(4)
    nodes = mesh%nodes(face_corner(:, face), element)
  end function face_nodes

  !> Area times the unit normal by the right-hand rule [m2]; exact for a bilinear facet.
  pure function face_vector(x) result(vector)
    real(rk), intent(in) :: x(3, 4) !< corners [m]
    real(rk) :: vector(3)
    vector = 0.5_rk*cross_product(x(:, 3) - x(:, 1), x(:, 4) - x(:, 2))
  end function face_vector

  !> Mean of the different corners [m].
  pure function face_centre(mesh, nodes) result(centre)
    type(fe_mesh), intent(in) :: mesh
    integer, intent(in) :: nodes(4)
    real(rk) :: centre(3)
    integer :: key(4)
    key = face_key(nodes)
    centre = sum(mesh%x(:, pack(key, key > 0)), dim=2)/count(key > 0)
  end function face_centre

  !> Number of different nodes of a face: 4, 3 for a triangle, 2 or 1 for a collapsed face.
  pure integer function count_corners(nodes) result(corners)
    integer, intent(in) :: nodes(4)
    corners = count(face_key(nodes) > 0)
  end function count_corners

  !> The different nodes of a face, ascending, with zeros in front.
  pure function face_key(nodes) result(key)
    integer, intent(in) :: nodes(4)
    integer :: key(4)
    integer :: i, j, node
    key = nodes
    do i = 2, 4
      node = key(i)
      do j = i - 1, 1, -1
        if (key(j) <= node) exit
        key(j + 1) = key(j)
      end do
      key(j + 1) = node
    end do
    do i = 2, 4
      if (key(i) == key(i - 1)) key(1:i) = [0, key(1:i - 1)]
    end do
  end function face_key

  !> An empty table.
  pure subroutine open_table(num_nodes, capacity, table)
    integer, intent(in) :: num_nodes !< nodes of the mesh
    integer, intent(in) :: capacity !< most faces it will hold
    type(face_table), intent(out) :: table
    allocate (table%first(num_nodes), source=0)
    allocate (table%next(capacity), source=0)
    allocate (table%key(4, capacity), source=0)
  end subroutine open_table

  !> Adds a face to the table and returns its number there, from 1.
  pure subroutine insert_face(table, nodes, number)
    type(face_table), intent(inout) :: table
    integer, intent(in) :: nodes(4)
    integer, intent(out) :: number
    integer :: lowest
    table%num_faces = table%num_faces + 1
    number = table%num_faces
    table%key(:, number) = face_key(nodes)
    lowest = minval(nodes)
    table%next(number) = table%first(lowest)
    table%first(lowest) = number
  end subroutine insert_face

  !> Number in the table of the newest face with the same nodes and a number below `before`
  !> (default: of all faces), 0 for none.
  pure integer function find_face(table, nodes, before) result(number)
    type(face_table), intent(in) :: table
    integer, intent(in) :: nodes(4)
    integer, intent(in), optional :: before !< number of a face found earlier
    integer :: key(4)
    key = face_key(nodes)
    number = table%first(minval(nodes))
    if (present(before)) number = table%next(before)
    do while (number > 0)
      if (all(table%key(:, number) == key)) return
      number = table%next(number)
    end do
  end function find_face

  !> The exterior faces of the elements: faces that no other of them shares.
  pure subroutine find_exterior(mesh, elements, skin)
    type(fe_mesh), intent(in) :: mesh
    integer, intent(in) :: elements(:) !< positions of solid elements
    type(surface), intent(out) :: skin !< without a name; in the order of `elements`
    type(face_table) :: table
    logical, allocatable :: is_outer(:)
    integer, allocatable :: owner(:), face_of(:)
    integer :: e, face, number, twin

    call open_table(mesh%num_nodes, 6*size(elements), table)
    allocate (is_outer(6*size(elements)), source=.false.)
    allocate (owner(6*size(elements)), face_of(6*size(elements)))
    do e = 1, size(elements)
      if (any(mesh%nodes(:, elements(e)) == 0)) cycle ! an element of a faulty deck
      do face = 1, 6
        twin = find_face(table, face_nodes(mesh, elements(e), face))
        call insert_face(table, face_nodes(mesh, elements(e), face), number)
        owner(number) = elements(e)
        face_of(number) = face
        is_outer(number) = twin == 0 .and. table%key(2, number) > 0
        if (twin > 0) is_outer(twin) = .false.
      end do
    end do
    skin%element = pack(owner, is_outer)
    skin%face = pack(face_of, is_outer)
  end subroutine find_exterior

  !> Marks the faces of a skin that are the master or slave face of a JOINT8 element.
  pure subroutine mark_covered(mesh, skin, is_covered)
    type(fe_mesh), intent(in) :: mesh
    type(surface), intent(in) :: skin
    logical, allocatable, intent(out) :: is_covered(:) !< (faces of the skin)
    type(face_table) :: table
    integer :: e, i, number

    call open_table(mesh%num_nodes, 2*count(mesh%element_type == 'JOINT8'), table)
    do e = 1, mesh%num_elements
      if (mesh%element_type(e) /= 'JOINT8') cycle
      call insert_face(table, mesh%nodes(1:4, e), number)
      call insert_face(table, mesh%nodes(5:8, e), number)
    end do
    allocate (is_covered(size(skin%element)))
    do i = 1, size(skin%element)
      is_covered(i) = find_face(table, face_nodes(mesh, skin%element(i), skin%face(i))) > 0
    end do
  end subroutine mark_covered
end module mesh_faces
