!> JOINT8: two coincident faces of four nodes, nodes 1-4 master and 5-8 slave.
!>
!> The normal points from master to slave, out of the solid of the master face and into the solid
!> of the slave face. Without solids it follows the right-hand rule of nodes 1-2-3-4.
!> Nodal integration (Lobatto) has one point for each pair of nodes, with its tributary area. It
!> avoids the oscillation of tractions that Gauss points cause in stiff joints.
module element_joint8
  use attached_solids, only: solid_list
  use dam_mesh, only: fe_mesh
  use element_catalogue, only: is_solid
  use errors, only: error_type, raise
  use gauss_rules, only: quad_point
  use joint_points, only: draw_elements, dam_joint, list_faces, local_axes, share_a_plane
  use kinds, only: rk
  use mesh_faces, only: face_nodes, face_table, face_vector, find_face, insert_face, open_table
  use shape_quad4, only: facet_point
  implicit none
  private
  public :: build_joint_points, find_attached_solids, solids_behind

  !> Largest distance of two nodes of a pair, over the longer diagonal of the facet.
  real(rk), parameter :: coincidence = 1.0e-4_rk

  !> Points of two coincident faces while they are collected.
  type :: face_points
    integer :: num_points = 0
    integer, allocatable :: master(:, :), slave(:, :) !< (nodes a side, capacity)
    real(rk), allocatable :: shape(:, :) !< (nodes a side, capacity)
    real(rk), allocatable :: x(:, :) !< (3, capacity) [m]
    real(rk), allocatable :: normal(:, :) !< (3, capacity) of any length
    real(rk), allocatable :: area(:) !< (capacity) [m2]
  end type face_points

contains

  !> Sets the geometry of a joint; the caller sets its name and law.
  !> Fails when a pair of nodes does not coincide, a facet has no area, or the solids of both sides
  !> lie on one side.
  subroutine build_joint_points(mesh, elements, is_nodal, built, error)
    type(fe_mesh), intent(in) :: mesh
    integer, intent(in) :: elements(:) !< positions of JOINT8 elements
    logical, intent(in) :: is_nodal !< pairs of nodes, else 2 x 2 Gauss points
    type(dam_joint), intent(inout) :: built
    type(error_type), allocatable, intent(out) :: error
    integer, allocatable :: solid(:, :), side(:)
    integer :: e
    allocate (side(size(elements)))
    call find_attached_solids(mesh, elements, solid, side)
    do e = 1, size(elements)
      call check_facet(mesh, elements(e), side(e), error)
      if (allocated(error)) return
    end do
    built%is_nodal = is_nodal
    if (is_nodal) then
      call gather_pairs(mesh, elements, side, built)
    else
      call gather_gauss_points(mesh, elements, side, built)
    end if
    call draw_elements(mesh, elements, side, built)
  end subroutine build_joint_points

  !> The solids of the faces of JOINT8 elements, and the sense of their normals.
  subroutine find_attached_solids(mesh, elements, solid, side, all_of_them)
    type(fe_mesh), intent(in) :: mesh
    integer, intent(in) :: elements(:) !< positions of JOINT8 elements
    integer, allocatable, intent(out) :: solid(:, :) !< (2, elements) behind master, slave; 0: none
    integer, intent(out) :: side(:) !< 1: normal by nodes 1-2-3-4, -1: against it, 0: contradiction
    type(solid_list), intent(out), optional :: all_of_them !< two sides for each element
    type(face_table) :: table
    integer, allocatable :: sense(:, :)
    integer :: e, i, face, number, nodes(4)

    allocate (solid(2, size(elements)), sense(2, size(elements)), source=0)
    if (present(all_of_them)) all_of_them%num_sides = 2*size(elements)
    call open_table(mesh%num_nodes, 2*size(elements), table)
    do e = 1, size(elements)
      call insert_face(table, mesh%nodes(1:4, elements(e)), number)
      call insert_face(table, mesh%nodes(5:8, elements(e)), number)
    end do
    do e = 1, mesh%num_elements
      if (.not. is_solid(mesh%element_type(e))) cycle
      do face = 1, 6
        nodes = face_nodes(mesh, e, face)
        number = find_face(table, nodes)
        do while (number > 0)
          i = (number + 1)/2
          if (present(all_of_them)) call all_of_them%note(number, e)
          call attach(mesh, e, face, elements(i), solid(2 - mod(number, 2), i), &
                      sense(2 - mod(number, 2), i))
          number = find_face(table, nodes, number)
        end do
      end do
    end do
    side = sense(1, :)
    where (side == 0) side = -sense(2, :)
    where (sense(1, :)*sense(2, :) > 0) side = 0
    where (sense(1, :) == 0 .and. sense(2, :) == 0) side = 1
  end subroutine find_attached_solids

  !> The solids behind both sides of JOINT8 elements; the sides of an element follow each other.
  function solids_behind(mesh, elements) result(list)
    type(fe_mesh), intent(in) :: mesh
    integer, intent(in) :: elements(:) !< positions of JOINT8 elements
    type(solid_list) :: list
    integer, allocatable :: solid(:, :)
    integer :: side(size(elements))
    call find_attached_solids(mesh, elements, solid, side, list)
  end function solids_behind

  !> Records a solid whose face lies on that of a joint. A face between two solids gives no sense.
  subroutine attach(mesh, element, face, joint_element, solid, sense)
    type(fe_mesh), intent(in) :: mesh
    integer, intent(in) :: element, face !< the solid and its face
    integer, intent(in) :: joint_element
    integer, intent(inout) :: solid !< found before, 0 for none
    integer, intent(inout) :: sense !< 1: along the normal by nodes 1-2-3-4, -1: against, 0: unknown
    real(rk) :: along
    along = dot_product(face_vector(mesh%x(:, face_nodes(mesh, element, face))), &
                        face_vector(mesh%x(:, mesh%nodes(1:4, joint_element))))
    if (solid == 0) then
      sense = merge(1, -1, along > 0.0_rk)
    else if (sense*along < 0.0_rk) then
      sense = 0
    end if
    solid = element
  end subroutine attach

  !> Checks the area of a facet, the distance of its pairs, and the sides of its solids.
  subroutine check_facet(mesh, element, side, error)
    type(fe_mesh), intent(in) :: mesh
    integer, intent(in) :: element !< position
    integer, intent(in) :: side !< 0: contradiction
    type(error_type), allocatable, intent(out) :: error
    real(rk) :: x(3, 8), diagonal, distance
    integer :: a
    x = mesh%x(:, mesh%nodes(:, element))
    diagonal = max(norm2(x(:, 3) - x(:, 1)), norm2(x(:, 4) - x(:, 2)))
    do a = 1, 4
      distance = norm2(x(:, a + 4) - x(:, a))
      if (distance <= coincidence*diagonal) cycle
      call raise(error, 'JOINT8 element '//text(mesh%element_id(element))//': nodes ' &
                 //text(mesh%node_id(mesh%nodes(a, element)))//' and ' &
                 //text(mesh%node_id(mesh%nodes(a + 4, element)))//' lie ' &
                 //length_text(distance)//' apart; expected faces whose nodes coincide')
      return
    end do
    if (norm2(face_vector(x(:, 1:4))) <= coincidence*diagonal**2) then
      call raise(error, 'JOINT8 element '//text(mesh%element_id(element))//' has no area')
    else if (side == 0) then
      call raise(error, 'JOINT8 element '//text(mesh%element_id(element)) &
                 //': the solids of its master and slave face lie on the same side')
    end if
  end subroutine check_facet

  !> A whole number as a text.
  pure function text(number)
    integer, intent(in) :: number
    character(:), allocatable :: text
    character(12) :: buffer
    write (buffer, '(i0)') number
    text = trim(buffer)
  end function text

  !> A length as a text [m].
  pure function length_text(length)
    real(rk), intent(in) :: length
    character(:), allocatable :: length_text
    character(12) :: buffer
    write (buffer, '(es10.3)') length
    length_text = trim(adjustl(buffer))
  end function length_text

  !> One point for each pair of nodes and plane: areas are summed, normals averaged.
  subroutine gather_pairs(mesh, elements, side, built)
    type(fe_mesh), intent(in) :: mesh
    integer, intent(in) :: elements(:), side(:)
    type(dam_joint), intent(inout) :: built
    integer, allocatable :: newest(:), next(:)
    type(face_points) :: points
    real(rk) :: share(3, 4)
    integer :: e, a, p, master, slave

    call open_points(1, 4*size(elements), points)
    allocate (newest(mesh%num_nodes), next(4*size(elements)), source=0)
    do e = 1, size(elements)
      share = side(e)*corner_shares(mesh%x(:, mesh%nodes(1:4, elements(e))))
      do a = 1, 4
        master = mesh%nodes(a, elements(e))
        slave = mesh%nodes(a + 4, elements(e))
        if (master == slave) cycle
        p = newest(master)
        do while (p > 0)
          if (points%slave(1, p) == slave .and. &
              share_a_plane(points%normal(:, p), share(:, a))) exit
          p = next(p)
        end do
        if (p == 0) then
          points%num_points = points%num_points + 1
          p = points%num_points
          next(p) = newest(master)
          newest(master) = p
          points%master(1, p) = master
          points%slave(1, p) = slave
          points%x(:, p) = mesh%x(:, master)
        end if
        points%normal(:, p) = points%normal(:, p) + share(:, a)
        points%area(p) = points%area(p) + norm2(share(:, a))
      end do
    end do
    points%shape = 1.0_rk
    call close_points(points, built)
  end subroutine gather_pairs

  !> Tributary area vectors of the corners of a facet: integrals of N_a n dA [m2].
  pure function corner_shares(x) result(share)
    real(rk), intent(in) :: x(3, 4) !< [m]
    real(rk) :: share(3, 4)
    real(rk) :: n(4), area(3)
    integer :: q, a
    share = 0.0_rk
    do q = 1, size(quad_point, 2)
      call facet_point(x, q, n, area)
      do a = 1, 4
        share(:, a) = share(:, a) + n(a)*area
      end do
    end do
  end function corner_shares

  !> Four points an element, each with the nodes of all four pairs.
  subroutine gather_gauss_points(mesh, elements, side, built)
    type(fe_mesh), intent(in) :: mesh
    integer, intent(in) :: elements(:), side(:)
    type(dam_joint), intent(inout) :: built
    type(face_points) :: points
    real(rk) :: x(3, 4), n(4), area(3)
    integer :: e, q, p, nodes(8)

    call open_points(4, 4*size(elements), points)
    allocate (built%face(4*size(elements)))
    do e = 1, size(elements)
      nodes = mesh%nodes(:, elements(e))
      if (all(nodes(:4) == nodes(5:))) cycle
      x = mesh%x(:, nodes(:4))
      do q = 1, 4
        call facet_point(x, q, n, area)
        points%num_points = points%num_points + 1
        p = points%num_points
        points%master(:, p) = nodes(:4)
        points%slave(:, p) = nodes(5:)
        points%shape(:, p) = n
        points%x(:, p) = matmul(x, n)
        points%area(p) = norm2(area)
        points%normal(:, p) = side(e)*area
        built%face(p) = e
      end do
    end do
    built%face = built%face(:points%num_points)
    call close_points(points, built)
  end subroutine gather_gauss_points

  !> Allocates points.
  subroutine open_points(nodes_a_side, capacity, points)
    integer, intent(in) :: nodes_a_side, capacity
    type(face_points), intent(out) :: points
    allocate (points%master(nodes_a_side, capacity), points%slave(nodes_a_side, capacity), source=0)
    allocate (points%shape(nodes_a_side, capacity), source=0.0_rk)
    allocate (points%x(3, capacity), points%normal(3, capacity), points%area(capacity), &
              source=0.0_rk)
  end subroutine open_points

  !> Trims the lists and computes the local axes from the normals.
  subroutine close_points(points, built)
    type(face_points), intent(in) :: points
    type(dam_joint), intent(inout) :: built
    integer :: p, n
    n = points%num_points
    call list_faces(points%slave(:, :n), points%master(:, :n), points%shape(:, :n), built)
    built%x = points%x(:, :n)
    built%area = points%area(:n)
    if (allocated(built%rotation)) deallocate (built%rotation)
    allocate (built%rotation(3, 3, n))
    do p = 1, n
      built%rotation(:, :, p) = local_axes(points%normal(:, p))
    end do
  end subroutine close_points
end module element_joint8
