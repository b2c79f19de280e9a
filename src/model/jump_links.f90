!> Jumps across pairs of nodes as unknowns: u_slave = u_master + R^T d.
!>
!> The pairs are edges of a graph of nodes. Each of its trees is written through one root, so chains
!> of joints resolve. A pair that would close a loop, that joins two trees held by supports, whose
!> nodes have no element or are the same node, gets no jump: the joint then works in the unknowns
!> that are there.
module jump_links
  use kinds, only: rk
  use dof_numbering, only: linear_links
  implicit none
  private
  public :: link_pairs

contains

  !> Chooses the pairs that get jump unknowns and writes the dependent dofs.
  subroutine link_pairs(slave, master, rotation, is_used, is_fixed, links)
    integer, intent(in) :: slave(:), master(:) !< (pairs) node positions
    real(rk), intent(in) :: rotation(:, :, :) !< (3, 3, pairs) rows: normal, slip 1, slip 2
    logical, intent(in) :: is_used(:) !< (nodes)
    logical, intent(in) :: is_fixed(:, :) !< (3, nodes)
    type(linear_links), intent(out) :: links
    logical, allocatable :: is_held(:)
    integer :: p
    allocate (is_held, source=any(is_fixed, 1))
    call choose_pairs(slave, master, is_used, is_held, links)
    allocate (links%jump_node(links%num_jumps), links%dof(links%num_jumps))
    allocate (links%first(links%num_jumps + 1), links%term(4*links%num_jumps))
    allocate (links%coefficient(4*links%num_jumps))
    links%first(:) = [(1 + 4*(p - 1), p=1, links%num_jumps + 1)]
    call walk_trees(slave, master, rotation, is_held, links)
  end subroutine link_pairs

  !> Numbers the jumps of the pairs that join two trees, at most one of which is held.
  subroutine choose_pairs(slave, master, is_used, is_held, links)
    integer, intent(in) :: slave(:), master(:)
    logical, intent(in) :: is_used(:), is_held(:)
    type(linear_links), intent(inout) :: links
    logical, allocatable :: tree_is_held(:)
    integer, allocatable :: parent(:)
    integer :: p, a, b
    allocate (links%first_jump(size(slave)))
    links%first_jump = 0
    allocate (tree_is_held, source=is_held)
    allocate (parent(size(is_used)))
    parent(:) = [(p, p=1, size(is_used))]
    do p = 1, size(slave)
      if (.not. (is_used(slave(p)) .and. is_used(master(p)))) cycle
      call find_root(parent, slave(p), a)
      call find_root(parent, master(p), b)
      if (a == b .or. (tree_is_held(a) .and. tree_is_held(b))) cycle
      parent(a) = b
      tree_is_held(b) = tree_is_held(a) .or. tree_is_held(b)
      links%first_jump(p) = links%num_jumps + 1
      links%num_jumps = links%num_jumps + 3
    end do
  end subroutine choose_pairs

  !> The root of a node's tree, halving the path to it on the way.
  pure subroutine find_root(parent, node, root)
    integer, intent(inout) :: parent(:)
    integer, intent(in) :: node
    integer, intent(out) :: root
    root = node
    do while (parent(root) /= root)
      parent(root) = parent(parent(root))
      root = parent(root)
    end do
  end subroutine find_root

  !> Walks every tree from its root: a held node, else a node that is never a slave, else any.
  subroutine walk_trees(slave, master, rotation, is_held, links)
    integer, intent(in) :: slave(:), master(:)
    real(rk), intent(in) :: rotation(:, :, :)
    logical, intent(in) :: is_held(:)
    type(linear_links), intent(inout) :: links
    integer, allocatable :: first(:), edge(:), queue(:)
    logical, allocatable :: is_seen(:), is_slave(:)
    integer :: rank, node, p
    call list_edges(slave, master, links%first_jump, size(is_held), first, edge)
    allocate (is_seen(size(is_held)), is_slave(size(is_held)), queue(size(is_held)))
    is_seen = .false.
    is_slave = .false.
    do p = 1, size(slave)
      if (links%first_jump(p) > 0) is_slave(slave(p)) = .true.
    end do
    do rank = 1, 3
      do node = 1, size(is_held)
        if (is_seen(node) .or. first(node + 1) == first(node)) cycle
        if (rank == 1 .and. .not. is_held(node)) cycle
        if (rank == 2 .and. is_slave(node)) cycle
        call walk_from(node)
      end do
    end do
  contains
    !> Breadth first, so that the links of a node stand behind those of its parent.
    subroutine walk_from(root)
      integer, intent(in) :: root
      integer :: head, tail, k, child, pair
      is_seen(root) = .true.
      queue(1) = root
      tail = 1
      head = 0
      do while (head < tail)
        head = head + 1
        do k = first(queue(head)), first(queue(head) + 1) - 1
          pair = edge(k)
          child = slave(pair)
          if (child == queue(head)) child = master(pair)
          if (is_seen(child)) cycle
          is_seen(child) = .true.
          tail = tail + 1
          queue(tail) = child
          call add_links(child, queue(head), links%first_jump(pair), rotation(:, :, pair), &
                         child == slave(pair), links)
        end do
      end do
    end subroutine walk_from
  end subroutine walk_trees

  !> The chosen pairs at each node.
  subroutine list_edges(slave, master, first_jump, num_nodes, first, edge)
    integer, intent(in) :: slave(:), master(:), first_jump(:), num_nodes
    integer, allocatable, intent(out) :: first(:), edge(:)
    integer, allocatable :: next(:)
    integer :: p, node
    allocate (first(num_nodes + 1))
    first = 0
    do p = 1, size(slave)
      if (first_jump(p) == 0) cycle
      first(slave(p) + 1) = first(slave(p) + 1) + 1
      first(master(p) + 1) = first(master(p) + 1) + 1
    end do
    first(1) = 1
    do node = 1, num_nodes
      first(node + 1) = first(node) + first(node + 1)
    end do
    allocate (next, source=first)
    allocate (edge(first(num_nodes + 1) - 1))
    do p = 1, size(slave)
      if (first_jump(p) == 0) cycle
      edge(next(slave(p))) = p
      next(slave(p)) = next(slave(p)) + 1
      edge(next(master(p))) = p
      next(master(p)) = next(master(p)) + 1
    end do
  end subroutine list_edges

  !> The three links of a child node: u_child = u_parent +- R^T d.
  pure subroutine add_links(child, parent, jump, rotation, is_slave, links)
    integer, intent(in) :: child, parent
    integer, intent(in) :: jump !< first of three
    real(rk), intent(in) :: rotation(3, 3)
    logical, intent(in) :: is_slave !< of the child
    type(linear_links), intent(inout) :: links
    real(rk) :: sign
    integer :: i, t
    sign = merge(1.0_rk, -1.0_rk, is_slave)
    do i = 1, 3
      links%num_links = links%num_links + 1
      t = links%first(links%num_links)
      links%dof(links%num_links) = 3*(child - 1) + i
      links%term(t:t + 3) = [3*(parent - 1) + i, -jump, -jump - 1, -jump - 2]
      links%coefficient(t:t + 3) = [1.0_rk, sign*rotation(:, i)]
    end do
    links%num_terms = 4*links%num_links
    links%jump_node(jump:jump + 2) = child
  end subroutine add_links
end module jump_links
