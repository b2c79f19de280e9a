!> The points of a joint between two surfaces whose meshes differ, without interface elements.
!>
!> At the nodes of the slave face (default) the relative displacement is that of mortar_projection.
!> The law has one point per node and plane, as in a joint of JOINT8 elements, and its tractions do
!> not oscillate (different_meshes.md, 13.2). At the Gauss points of the segments the law is a
!> penalty whose tractions oscillate. The normal points out of the master's solid, from master to
!> slave.
module coupling_joint
  use joint_points, only: dam_joint, joint_cells, local_axes
  use kinds, only: rk
  use mortar_facet, only: facet_extent
  use mortar_projection, only: project
  use mortar_balance, only: mortar_rows
  use segment_quadrature, only: segment_points
  use segment_quarters, only: find_quarters, quarter
  use surface_facets, only: mark_corners
  use surface_segments, only: facet_set, segment_set
  implicit none
  private
  public :: lay_node_points, lay_gauss_points

contains

  !> One point for each plane and each covered node of the slave face. Nodes shared by both faces
  !> have no point, since they connect the faces. Nodes tied to other nodes of the face have no
  !> point, since their jumps follow from those of the others; the points of the neighbours include
  !> them. The caller sets name and law of the joint.
  subroutine lay_node_points(x, slave, master, segments, is_tied, is_measured, built, is_bare)
    real(rk), intent(in) :: x(:, :) !< (3, nodes) [m]
    type(facet_set), intent(in) :: slave, master
    type(segment_set), intent(in) :: segments
    logical, intent(in) :: is_tied(:) !< (nodes) follows others of the slave face by a tie
    logical, intent(in) :: is_measured !< the distance as meshed counts, else the faces touch
    type(dam_joint), intent(inout) :: built
    logical, allocatable, intent(out) :: is_bare(:) !< (slave facets) too little covered
    type(mortar_rows) :: rows
    logical :: is_shared(size(x, 2)), is_neighbour(size(x, 2))
    integer :: p
    is_shared = shared_nodes(size(x, 2), slave, master)
    is_neighbour = mark_corners(size(x, 2), slave) .and. is_tied .and. .not. is_shared
    call project(x, slave, master, segments, is_shared .or. is_neighbour, rows)
    built%is_nodal = .true.
    call open_points(rows%num_rows(), rows%num_rows() + size(rows%item), built)
    do p = 1, rows%num_rows()
      associate (first => rows%first(p), last => rows%first(p + 1) - 1)
        call add_row(p, rows%node(p), rows%area(p), rows%item(first:last), &
                     rows%weight(first:last), is_neighbour, built)
      end associate
      built%rotation(:, :, p) = local_axes(-rows%normal(:, p))
    end do
    built%x = x(:, rows%node)
    built%admissible_slip = rows%facet_size
    built%clearance = merge(rows%gap, 0.0_rk, is_measured)
    call close_points(rows%num_rows(), built)
    call list_cells(slave, segments, rows%is_bare, built%cells)
    call move_alloc(rows%is_bare, is_bare)
  end subroutine lay_node_points

  !> Adds the point of a row. A tied neighbour whose dual function belongs to the row is a slave
  !> node of the point, with its area; the jump is the mean over both nodes.
  subroutine add_row(p, node, area, masters, weights, is_neighbour, built)
    integer, intent(in) :: p, node
    real(rk), intent(in) :: area !< of the node itself [m2]
    integer, intent(in) :: masters(:)
    real(rk), intent(in) :: weights(:) !< of the row; negative at tied neighbours
    logical, intent(in) :: is_neighbour(:) !< (nodes)
    type(dam_joint), intent(inout) :: built
    logical :: is_slave(size(masters))
    real(rk) :: whole
    is_slave = is_neighbour(masters)
    whole = 1.0_rk - sum(weights, mask=is_slave)
    built%area(p) = area*whole
    call add_nodes(p, [node, pack(masters, is_slave)], &
                   [1.0_rk, -pack(weights, is_slave)]/whole, &
                   pack(masters,.not. is_slave), pack(weights,.not. is_slave)/whole, built)
  end subroutine add_row

  !> Up to four points per segment, each between one facet of the slave and one of the master face.
  subroutine lay_gauss_points(x, slave, master, segments, is_measured, built)
    real(rk), intent(in) :: x(:, :) !< (3, nodes) [m]
    type(facet_set), intent(in) :: slave, master
    type(segment_set), intent(in) :: segments
    logical, intent(in) :: is_measured
    type(dam_joint), intent(inout) :: built
    type(segment_points) :: points
    type(quarter) :: quarters(4)
    integer :: s, q, p
    built%is_nodal = .false.
    call open_points(4*segments%num_segments, 32*segments%num_segments, built)
    allocate (built%face(4*segments%num_segments))
    p = 0
    do s = 1, segments%num_segments
      call find_quarters(x, slave, master, segments, s, points, quarters)
      associate (own => slave%node(:, segments%slave(s)), &
                 other => master%node(:, segments%master(s)))
        do q = 1, 4
          if (.not. quarters(q)%area > 0.0_rk) cycle
          p = p + 1
          call add_nodes(p, own, quarters(q)%slave_shape, other, quarters(q)%master_shape, built)
          built%rotation(:, :, p) = local_axes(-quarters(q)%normal)
          built%x(:, p) = matmul(x(:, own), quarters(q)%slave_shape)
          built%area(p) = quarters(q)%area
          built%face(p) = s
          built%clearance(p) = merge(quarters(q)%gap, 0.0_rk, is_measured)
          built%admissible_slip(p) = min(facet_extent(x(:, own)), facet_extent(x(:, other)))
        end do
      end associate
    end do
    call close_points(p, built)
    built%face = built%face(:p)
    call list_cells(slave, segments, spread(.false., 1, size(slave%node, 2)), built%cells)
  end subroutine lay_gauss_points

  !> Allocates the points and their nodes.
  subroutine open_points(num_points, most_nodes, built)
    integer, intent(in) :: num_points, most_nodes
    type(dam_joint), intent(inout) :: built
    built%is_matching = .false.
    allocate (built%first(num_points + 1), built%first_master(num_points), source=1)
    allocate (built%node(most_nodes), built%weight(most_nodes))
    allocate (built%rotation(3, 3, num_points), built%x(3, num_points))
    allocate (built%area(num_points), built%clearance(num_points))
    allocate (built%admissible_slip(num_points))
  end subroutine open_points

  !> Adds the nodes of point p, slave first; nodes without weight are left out.
  subroutine add_nodes(p, slave, slave_weight, master, master_weight, built)
    integer, intent(in) :: p !< point; the previous point has its nodes
    integer, intent(in) :: slave(:), master(:) !< positions in the mesh
    real(rk), intent(in) :: slave_weight(:), master_weight(:) !< each adds up to 1
    type(dam_joint), intent(inout) :: built
    integer :: next
    next = built%first(p)
    call add_side(slave, slave_weight)
    built%first_master(p) = next
    call add_side(master, -master_weight)
    built%first(p + 1) = next
  contains
    !> Nodes of one side.
    subroutine add_side(nodes, weights)
      integer, intent(in) :: nodes(:)
      real(rk), intent(in) :: weights(:)
      integer :: k
      do k = 1, size(nodes)
        if (.not. abs(weights(k)) > 0.0_rk) cycle
        built%node(next) = nodes(k)
        built%weight(next) = weights(k)
        next = next + 1
      end do
    end subroutine add_side
  end subroutine add_nodes

  !> Cuts all arrays to size.
  subroutine close_points(num_points, built)
    integer, intent(in) :: num_points
    type(dam_joint), intent(inout) :: built
    integer :: used
    used = built%first(num_points + 1) - 1
    built%num_points = num_points
    built%first = built%first(:num_points + 1)
    built%first_master = built%first_master(:num_points)
    built%node = built%node(:used)
    built%weight = built%weight(:used)
    built%rotation = built%rotation(:, :, :num_points)
    built%x = built%x(:, :num_points)
    built%area = built%area(:num_points)
    built%clearance = built%clearance(:num_points)
    built%admissible_slip = built%admissible_slip(:num_points)
  end subroutine close_points

  !> Nodes that belong to both faces.
  pure function shared_nodes(num_nodes, slave, master) result(is_shared)
    integer, intent(in) :: num_nodes
    type(facet_set), intent(in) :: slave, master
    logical :: is_shared(num_nodes)
    is_shared = mark_corners(num_nodes, slave) .and. mark_corners(num_nodes, master)
  end function shared_nodes

  !> Cells for the results: polygons of the segments, with shape functions of the slave facets.
  pure subroutine list_cells(slave, segments, is_bare, cells)
    type(facet_set), intent(in) :: slave
    type(segment_set), intent(in) :: segments
    logical, intent(in) :: is_bare(:) !< (slave facets) not drawn
    type(joint_cells), intent(out) :: cells
    integer :: s, v, corner, c, most
    most = segments%first_vertex(segments%num_segments + 1) - 1
    allocate (cells%first(segments%num_segments + 1), cells%element(segments%num_segments))
    allocate (cells%corner(most), cells%first_node(most + 1))
    allocate (cells%node(4*most), cells%weight(4*most))
    c = 0
    corner = 0
    cells%first(1) = 1
    do s = 1, segments%num_segments
      if (is_bare(segments%slave(s))) cycle
      c = c + 1
      cells%element(c) = slave%element(segments%slave(s))
      ! Anticlockwise about the slave's outward normal, which is opposite to the joint's normal.
      do v = segments%first_vertex(s + 1) - 1, segments%first_vertex(s), -1
        corner = corner + 1
        cells%corner(corner) = corner
        cells%first_node(corner) = 4*corner - 3
        cells%node(4*corner - 3:4*corner) = slave%node(:, segments%slave(s))
        cells%weight(4*corner - 3:4*corner) = segments%vertex_shape(:, v)
      end do
      cells%first(c + 1) = corner + 1
    end do
    cells%first_node(corner + 1) = 4*corner + 1
    cells%first = cells%first(:c + 1)
    cells%element = cells%element(:c)
    cells%corner = cells%corner(:corner)
    cells%first_node = cells%first_node(:corner + 1)
    cells%node = cells%node(:4*corner)
    cells%weight = cells%weight(:4*corner)
  end subroutine list_cells
end module coupling_joint
