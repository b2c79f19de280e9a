!> Points of a joint: their places, and their relative displacements from the nodes.
!>
!> The relative displacement of point p in local axes is
!>   jump = rotation(:, :, p) * sum_k weight(k) * u(node(k)),   k = first(p) .. first(p + 1) - 1,
!> with nodes of the slave face first (sum of weights 1), then nodes of the master face from
!> first_master(p) on (sum of weights -1). With nodal integration a point belongs to one node of
!> the slave face, the first of its list. Its other end is a node (JOINT8) or a mortar projection
!> of the master face (different meshes). Further slave nodes occur only where neighbours of the
!> node are tied to other nodes of the face.
module joint_points
  use dam_mesh, only: fe_mesh
  use global_vectors, only: dot
  use guest_history, only: history, stored_work
  use guest_type, only: guest
  use kinds, only: rk
  use joint_law, only: joint_state, traction_law
  use row_tables, only: row_table
  use small_matrix, only: cross_product
  implicit none
  private
  public :: dam_joint, joint_cells, point_rows, stage_parts, list_faces, relative_displacement, &
            draw_elements, local_axes, share_a_plane

  !> Facets with a common node share its point unless their normals differ by more than 30 degrees.
  real(rk), parameter :: same_plane = 0.5_rk*sqrt(3.0_rk)

  !> A normal closer than this to the vertical has slip 1 along x.
  real(rk), parameter :: vertical = 1.0e-6_rk

  !> Polygons on the face of a joint for the results. Place, motion and values of a corner are sums
  !> weight * node over nodes with points of the joint.
  type :: joint_cells
    integer, allocatable :: first(:) !< (cells + 1) corners of each cell
    integer, allocatable :: corner(:) !< numbers of corners, right-hand rule about the normal
    integer, allocatable :: element(:) !< (cells) JOINT8 or the solid behind the slave face
    integer, allocatable :: first_node(:) !< (corners + 1) nodes of each corner
    integer, allocatable :: node(:) !< positions in the mesh
    real(rk), allocatable :: weight(:) !< they add up to 1 at each corner
  end type joint_cells

  !> The nodes of all points, as in dam_joint.
  type :: point_rows
    integer, allocatable :: first(:), first_master(:), node(:)
    real(rk), allocatable :: weight(:)
  end type point_rows

  !> Parts of a joint that come and go, each with faces whose solids are there in the same steps.
  type :: stage_parts
    real(rk), allocatable :: area(:, :) !< (parts, points) share of the area of each point [m2]
    logical, allocatable :: is_there(:, :) !< (parts, steps)
    type(point_rows), allocatable :: rows(:) !< only where the nodes of points change, too
    integer, allocatable :: rows_of_step(:) !< (steps) position in `rows`
  end type stage_parts

  type, extends(guest) :: dam_joint
    class(traction_law), allocatable :: law
    logical :: is_nodal = .true. !< points at the slave nodes, else at Gauss points
    logical :: is_matching = .true. !< made of JOINT8 elements, else of two surfaces
    integer :: num_points = 0
    integer, allocatable :: first(:) !< (points + 1) nodes of each point
    integer, allocatable :: first_master(:) !< (points) the first master node of each
    integer, allocatable :: node(:) !< positions in the mesh
    real(rk), allocatable :: weight(:) !< slave positive in sum, master negative
    real(rk), allocatable :: x(:, :) !< (3, points) [m]
    real(rk), allocatable :: rotation(:, :, :) !< (3, 3, points); rows: normal, slip 1, slip 2
    real(rk), allocatable :: area(:) !< tributary area of each point [m2]
    real(rk), allocatable :: clearance(:) !< (points) as meshed, beside the law's gap [m]
    real(rk), allocatable :: admissible_slip(:) !< (points) limit of small sliding [m]
    integer, allocatable :: face(:) !< (Gauss points) JOINT8 element or segment, by its position
    type(stage_parts), allocatable :: parts !< only where parts of points come and go
    logical, allocatable :: is_idle(:) !< (points) all parts are absent in the present step
    type(joint_cells) :: cells
  contains
    procedure :: add_cells
    procedure :: add_work
  end type dam_joint

contains

  !> The nodes of each point.
  subroutine add_cells(self, cells)
    class(dam_joint), intent(in) :: self
    type(row_table), intent(inout) :: cells
    integer :: p
    do p = 1, self%num_points
      call cells%append(self%node(self%first(p):self%first(p + 1) - 1))
    end do
  end subroutine add_cells

  !> Energy of the springs of the law, and the work dissipated in the joint.
  subroutine add_work(self, own, total)
    class(dam_joint), intent(in) :: self
    class(history), intent(in) :: own
    type(stored_work), intent(inout) :: total
    real(rk) :: stored(self%num_points)
    select type (own)
    class is (joint_state)
      call self%law%stored_energy(own, stored)
      total%stored = total%stored + dot(self%area, stored)
      total%friction = total%friction + dot(self%area, own%friction_work)
      total%fracture = total%fracture + dot(self%area, own%fracture_work)
    end select
  end subroutine add_work

  !> Points of two coincident faces: as many slave as master nodes a point, with the same
  !> weights.
  pure subroutine list_faces(slave, master, shape, built)
    integer, intent(in) :: slave(:, :), master(:, :) !< (nodes a side, points) positions
    real(rk), intent(in) :: shape(:, :) !< (nodes a side, points)
    type(dam_joint), intent(inout) :: built
    integer :: p, n, k
    n = size(slave, 1)
    built%num_points = size(slave, 2)
    built%first = [(1 + 2*n*(p - 1), p=1, built%num_points + 1)]
    built%first_master = built%first(:built%num_points) + n
    if (allocated(built%node)) deallocate (built%node, built%weight)
    allocate (built%node(2*n*built%num_points), built%weight(2*n*built%num_points))
    do p = 1, built%num_points
      k = built%first(p)
      built%node(k:k + 2*n - 1) = [slave(:, p), master(:, p)]
      built%weight(k:k + 2*n - 1) = [shape(:, p), -shape(:, p)]
    end do
    built%clearance = spread(0.0_rk, 1, built%num_points)
    built%admissible_slip = spread(huge(1.0_rk), 1, built%num_points)
  end subroutine list_faces

  !> Relative displacement of the faces at a point.
  pure function relative_displacement(joint, p, u) result(difference)
    type(dam_joint), intent(in) :: joint
    integer, intent(in) :: p !< point
    real(rk), intent(in) :: u(:, :) !< (3, nodes)
    real(rk) :: difference(3) !< slave minus master, global axes
    integer :: k
    difference = 0.0_rk
    do k = joint%first(p), joint%first(p + 1) - 1
      difference = difference + joint%weight(k)*u(:, joint%node(k))
    end do
  end function relative_displacement

  !> Fills the cells of a joint of JOINT8 elements: one for each element, one corner for each slave
  !> node. A face with repeated nodes becomes a triangle.
  pure subroutine draw_elements(mesh, elements, side, built)
    type(fe_mesh), intent(in) :: mesh
    integer, intent(in) :: elements(:) !< positions of JOINT8 elements
    integer, intent(in) :: side(:) !< 1: normal by nodes 5-6-7-8, -1: against it
    type(dam_joint), intent(inout) :: built
    integer, allocatable :: corner_of_node(:), node_of_corner(:), first(:), corner(:)
    integer :: ring(4), e, a, k, num_corners, last, node
    allocate (corner_of_node(mesh%num_nodes), node_of_corner(4*size(elements)), source=0)
    allocate (first(size(elements) + 1), corner(4*size(elements)), source=1)
    num_corners = 0
    last = 0
    do e = 1, size(elements)
      ring = mesh%nodes(5:8, elements(e))
      if (side(e) < 0) ring = ring([1, 4, 3, 2])
      do a = 1, 4
        node = ring(a)
        if (any(ring(:a - 1) == node)) cycle
        if (corner_of_node(node) == 0) then
          num_corners = num_corners + 1
          corner_of_node(node) = num_corners
          node_of_corner(num_corners) = node
        end if
        last = last + 1
        corner(last) = corner_of_node(node)
      end do
      first(e + 1) = last + 1
    end do
    built%cells%element = elements
    built%cells%first = first
    built%cells%corner = corner(:last)
    built%cells%first_node = [(k, k=1, num_corners + 1)]
    built%cells%node = node_of_corner(:num_corners)
    built%cells%weight = spread(1.0_rk, 1, num_corners)
  end subroutine draw_elements

  !> Rows: normal, slip 1 = z x normal (x when the normal is along z), slip 2 = normal x slip 1.
  pure function local_axes(direction) result(rotation)
    real(rk), intent(in) :: direction(3) !< along the normal, of any length
    real(rk) :: rotation(3, 3)
    real(rk) :: n(3), s(3)
    n = direction/norm2(direction)
    s = [-n(2), n(1), 0.0_rk]
    if (norm2(s) <= vertical) s = [1.0_rk, 0.0_rk, 0.0_rk] - n(1)*n
    s = s/norm2(s)
    rotation(1, :) = n
    rotation(2, :) = s
    rotation(3, :) = cross_product(n, s)
  end function local_axes

  !> Whether two normals, of any length, differ by at most 30 degrees.
  pure logical function share_a_plane(one, other)
    real(rk), intent(in) :: one(3), other(3)
    share_a_plane = dot_product(one, other) >= same_plane*norm2(one)*norm2(other)
  end function share_a_plane
end module joint_points
