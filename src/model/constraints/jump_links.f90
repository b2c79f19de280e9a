!> Dependent nodes: those of ties, u_s = sum_m w_m u_m, and slave nodes of joints, whose jumps d are
!> unknowns instead, u_s = sum_m w_m u_m + R^T d (theory.md, 3; different_meshes.md, 13.3).
!>
!> A node follows others at most once, and not if a support holds any of its directions. Ties come
!> first, then points with several nodes of the master face, which their slave node follows; then
!> pairs of nodes, of which either may follow the other. Pairs are edges of a graph: each of its
!> trees depends on one node, so chains of joints are resolved. A point gets no jump if the jump
!> would close a circle, or if the node is held, has no element or is on both sides: the joint then
!> uses the displacements.
module jump_links
  use dam_mesh, only: node_tie
  use kinds, only: rk
  use errors, only: error_type
  use node_dofs, only: dof_map, num_directions
  use joint_rows, only: num_axes, num_rows
  use dof_numbering, only: linear_links
  use link_graph, only: dependence
  use link_order, only: order_links
  implicit none
  private
  public :: nodal_points, link_nodes, pairs_of_nodes

  !> Points of joints that belong to one node of the slave face.
  type :: nodal_points
    integer, allocatable :: slave(:) !< (points) node positions
    real(rk), allocatable :: own(:) !< (points) weight of the slave node in the jump
    integer, allocatable :: first(:) !< (points + 1)
    integer, allocatable :: master(:)
    real(rk), allocatable :: weight(:) !< of the masters, over that of the slave; sum 1
    real(rk), allocatable :: rotation(:, :, :) !< (3, 3, points) rows: normal, slip 1, slip 2
    !> Nodes without mass, which should be the dependent ones: if a node with mass follows a node
    !> without, the mass matrix of both and their jump is singular. Not allocated: none.
    logical, allocatable :: is_light(:)
  end type nodal_points

contains

  !> Points with one node on each face.
  pure subroutine pairs_of_nodes(slave, master, rotation, points)
    integer, intent(in) :: slave(:), master(:) !< (pairs)
    real(rk), intent(in) :: rotation(:, :, :) !< (3, 3, pairs)
    type(nodal_points), intent(out) :: points
    integer :: p
    points%slave = slave
    points%own = spread(1.0_rk, 1, size(slave))
    points%master = master
    points%first = [(p, p=1, size(slave) + 1)]
    points%weight = spread(1.0_rk, 1, size(slave))
    points%rotation = rotation
  end subroutine pairs_of_nodes

  !> Chooses the points that get jump unknowns and adds the dependent dofs. Fails if ties depend on
  !> each other in a circle.
  subroutine link_nodes(dofs, points, ties, is_used, is_fixed, links, error)
    type(dof_map), intent(in) :: dofs
    type(nodal_points), intent(in) :: points
    type(node_tie), intent(in) :: ties(:)
    logical, intent(in) :: is_used(:) !< (nodes)
    logical, intent(in) :: is_fixed(:, :) !< (components, nodes)
    type(linear_links), intent(out) :: links
    type(error_type), allocatable, intent(out) :: error
    type(dependence) :: graph
    integer :: i, most_rows, most_masters
    call allocate_links(points, ties, links)
    if (size(points%slave) == 0 .and. size(ties) == 0) return
    most_rows = size(points%slave) + sum([(size(ties(i)%node), i=1, size(ties))])
    most_masters = size(points%master) + sum([(size(ties(i)%item), i=1, size(ties))])
    call graph%start(any(is_fixed(:num_directions, :), 1), most_rows, most_masters)
    do i = 1, size(ties)
      call link_tie(dofs, ties(i), graph, links)
    end do
    call link_wide_points(dofs, points, is_used, graph, links)
    call link_pairs(points, is_used, graph, links)
    call link_trees(dofs, points, graph, links)
    call order_links(dofs%num_dofs, links, error)
  end subroutine link_nodes

  !> Allocates the largest possible number of links.
  pure subroutine allocate_links(points, ties, links)
    type(nodal_points), intent(in) :: points
    type(node_tie), intent(in) :: ties(:)
    type(linear_links), intent(inout) :: links
    integer :: i, num_links, num_terms
    num_links = num_directions*size(points%slave)
    num_terms = num_directions*(size(points%master) + num_rows(size(points%slave)))
    do i = 1, size(ties)
      num_links = num_links + num_directions*size(ties(i)%node)
      num_terms = num_terms + num_directions*size(ties(i)%item)
    end do
    allocate (links%dof(num_links), links%term(num_terms), links%coefficient(num_terms))
    allocate (links%first(num_links + 1), source=1)
    allocate (links%jump_node(num_rows(size(points%slave))))
    allocate (links%first_jump(size(points%slave)), source=0)
  end subroutine allocate_links

  !> Adds a dependent dof.
  pure subroutine add_link(dof, term, coefficient, links)
    integer, intent(in) :: dof
    integer, intent(in) :: term(:) !< dofs, or -k for jump k
    real(rk), intent(in) :: coefficient(:)
    type(linear_links), intent(inout) :: links
    integer :: last
    links%num_links = links%num_links + 1
    last = links%num_terms + size(term)
    links%dof(links%num_links) = dof
    links%term(links%num_terms + 1:last) = term
    links%coefficient(links%num_terms + 1:last) = coefficient
    links%num_terms = last
    links%first(links%num_links + 1) = last + 1
  end subroutine add_link

  !> Adds the nodes of a tie, in their tied directions.
  subroutine link_tie(dofs, tie, graph, links)
    type(dof_map), intent(in) :: dofs
    type(node_tie), intent(in) :: tie
    type(dependence), intent(inout) :: graph
    type(linear_links), intent(inout) :: links
    integer, allocatable :: term(:)
    integer :: k, i
    do k = 1, size(tie%node)
      associate (first => tie%first(k), last => tie%first(k + 1) - 1)
        call graph%add_row(tie%node(k), tie%item(first:last))
        do i = 1, num_directions
          if (.not. tie%is_tied(i, k)) cycle
          if (allocated(tie%item_direction)) then
            term = dofs%dof_of(tie%item(first:last), tie%item_direction(first:last))
          else
            term = dofs%dof_of(tie%item(first:last), i)
          end if
          call add_link(dofs%dof_of(tie%node(k), i), term, tie%weight(first:last), links)
        end do
      end associate
    end do
  end subroutine link_tie

  !> Adds jumps of points with several nodes of the master face.
  subroutine link_wide_points(dofs, points, is_used, graph, links)
    type(dof_map), intent(in) :: dofs
    type(nodal_points), intent(in) :: points
    logical, intent(in) :: is_used(:)
    type(dependence), intent(inout) :: graph
    type(linear_links), intent(inout) :: links
    logical :: is_linked
    integer :: p, i, jump
    do p = 1, size(points%slave)
      if (is_pair(points, p) .or. .not. is_used(points%slave(p))) cycle
      associate (masters => points%master(points%first(p):points%first(p + 1) - 1))
        if (.not. all(is_used(masters))) cycle
        call graph%follow(points%slave(p), masters, is_linked)
        if (.not. is_linked) cycle
        call add_jump(p, points%slave(p), links, jump)
        do i = 1, num_directions
          call add_link(dofs%dof_of(points%slave(p), i), &
                        [dofs%dof_of(masters, i), -jump, -jump - 1, -jump - 2], &
                        [points%weight(points%first(p):points%first(p + 1) - 1), &
                         points%rotation(:, i, p)/points%own(p)], links)
        end do
      end associate
    end do
  end subroutine link_wide_points

  pure logical function is_pair(points, p)
    type(nodal_points), intent(in) :: points
    integer, intent(in) :: p
    is_pair = points%first(p + 1) == points%first(p) + 1
  end function is_pair

  !> Adds the three jumps of a point.
  pure subroutine add_jump(p, node, links, jump)
    integer, intent(in) :: p
    integer, intent(in) :: node !< that follows
    type(linear_links), intent(inout) :: links
    integer, intent(out) :: jump !< the first of the three
    jump = links%num_jumps + 1
    links%num_jumps = links%num_jumps + num_axes
    links%first_jump(p) = jump
    links%jump_node(jump:jump + num_axes - 1) = node
  end subroutine add_jump

  !> Numbers the jumps of pairs that join two trees, of which at most one is held.
  subroutine link_pairs(points, is_used, graph, links)
    type(nodal_points), intent(in) :: points
    logical, intent(in) :: is_used(:)
    type(dependence), intent(inout) :: graph
    type(linear_links), intent(inout) :: links
    logical :: is_joined
    integer :: p, jump
    do p = 1, size(points%slave)
      if (.not. is_pair(points, p)) cycle
      associate (slave => points%slave(p), master => points%master(points%first(p)))
        if (.not. (is_used(slave) .and. is_used(master))) cycle
        call graph%join(slave, master, is_joined)
        if (is_joined) call add_jump(p, slave, links, jump)
      end associate
    end do
  end subroutine link_pairs

  !> Links every tree of pairs from its root: a node that cannot follow, else one that is never a
  !> slave, else any; nodes without mass are chosen last.
  subroutine link_trees(dofs, points, graph, links)
    type(dof_map), intent(in) :: dofs
    type(nodal_points), intent(in) :: points
    type(dependence), intent(in) :: graph
    type(linear_links), intent(inout) :: links
    integer, allocatable :: first(:), edge(:), queue(:)
    logical, allocatable :: is_seen(:), is_slave(:), is_light(:)
    integer :: rank, node, p, num_nodes
    num_nodes = size(dofs%first) - 1
    call list_edges(points, links%first_jump, num_nodes, first, edge)
    allocate (is_seen(num_nodes), is_slave(num_nodes), source=.false.)
    allocate (queue(num_nodes))
    do p = 1, size(points%slave)
      if (links%first_jump(p) > 0 .and. is_pair(points, p)) is_slave(points%slave(p)) = .true.
    end do
    allocate (is_light(num_nodes), source=.false.)
    if (allocated(points%is_light)) is_light = points%is_light
    do rank = 1, 4
      do node = 1, num_nodes
        if (is_seen(node) .or. first(node + 1) == first(node)) cycle
        if (rank == 1 .and. .not. graph%is_end(node)) cycle
        if (rank == 2 .and. is_slave(node)) cycle
        if (rank <= 3 .and. is_light(node) .and. .not. graph%is_end(node)) cycle
        call link_from(node)
      end do
    end do
  contains
    !> Links a tree breadth first, so that the links of a node stand after those of its parent.
    subroutine link_from(root)
      integer, intent(in) :: root
      integer :: head, tail, k, child
      is_seen(root) = .true.
      queue(1) = root
      tail = 1
      head = 0
      do while (head < tail)
        head = head + 1
        do k = first(queue(head)), first(queue(head) + 1) - 1
          child = points%slave(edge(k))
          if (child == queue(head)) child = points%master(points%first(edge(k)))
          if (is_seen(child)) cycle
          is_seen(child) = .true.
          tail = tail + 1
          queue(tail) = child
          call add_links(dofs, points, edge(k), child, queue(head), links)
        end do
      end do
    end subroutine link_from
  end subroutine link_trees

  !> The chosen pairs at each node.
  subroutine list_edges(points, first_jump, num_nodes, first, edge)
    type(nodal_points), intent(in) :: points
    integer, intent(in) :: first_jump(:), num_nodes
    integer, allocatable, intent(out) :: first(:), edge(:)
    integer, allocatable :: next(:)
    integer :: p, node, pass, i, ends(2)
    allocate (first(num_nodes + 1), next(num_nodes + 1), source=0)
    do pass = 1, 2
      do p = 1, size(points%slave)
        if (first_jump(p) == 0 .or. .not. is_pair(points, p)) cycle
        ends = [points%slave(p), points%master(points%first(p))]
        do i = 1, 2
          if (pass == 2) edge(next(ends(i))) = p
          next(ends(i)) = next(ends(i)) + 1
        end do
      end do
      if (pass == 2) exit
      first(1) = 1
      do node = 1, num_nodes
        first(node + 1) = first(node) + next(node)
      end do
      next(:) = first
      allocate (edge(first(num_nodes + 1) - 1))
    end do
  end subroutine list_edges

  !> The three links of a child node: u_child = u_parent +- R^T d.
  pure subroutine add_links(dofs, points, p, child, parent, links)
    type(dof_map), intent(in) :: dofs
    type(nodal_points), intent(in) :: points
    integer, intent(in) :: p !< the pair
    integer, intent(in) :: child, parent
    type(linear_links), intent(inout) :: links
    real(rk) :: sign
    integer :: i, jump
    sign = merge(1.0_rk, -1.0_rk, child == points%slave(p))
    jump = links%first_jump(p)
    do i = 1, num_directions
      call add_link(dofs%dof_of(child, i), &
                    [dofs%dof_of(parent, i), -jump, -jump - 1, -jump - 2], &
                    [1.0_rk, sign*points%rotation(:, i, p)], links)
    end do
    links%jump_node(jump:jump + num_axes - 1) = child
  end subroutine add_links
end module jump_links
