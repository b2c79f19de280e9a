!> The graph of nodes that depend on others, without circles.
!>
!> Nodes joined by pairs form trees. All nodes of a tree depend on one of its nodes. A node that is
!> held by supports or that follows nodes of other trees must be this node, so a tree has at most
!> one. Dependences form a graph of trees: from the tree of a node to the trees of its masters.
module link_graph
  implicit none
  private
  public :: dependence

  type :: dependence
    integer, allocatable, private :: parent(:) !< (nodes) towards the root of the tree
    integer, allocatable, private :: end_node(:) !< (roots) held or following node, 0 for none
    integer, allocatable, private :: first_row(:) !< (nodes) first row of a node, 0 for none
    integer, allocatable, private :: next_row(:), first(:), master(:) !< rows of masters
    integer, private :: num_rows = 0
    integer, allocatable, private :: stamp(:), stack(:) !< of the search
    integer, private :: num_searches = 0
  contains
    procedure :: start => start_graph
    procedure :: add_row => add_follower
    procedure :: follow, join, is_end
  end type dependence

contains

  !> Starts with no node that follows another.
  subroutine start_graph(self, is_held, most_rows, most_masters)
    class(dependence), intent(inout) :: self
    logical, intent(in) :: is_held(:) !< (nodes) by supports
    integer, intent(in) :: most_rows, most_masters !< largest numbers to be added
    integer :: i, n
    n = size(is_held)
    allocate (self%parent(n), self%end_node(n), self%stack(n))
    self%parent(:) = [(i, i=1, n)]
    self%end_node(:) = merge(self%parent, 0, is_held)
    allocate (self%first_row(n), self%stamp(n), self%next_row(most_rows), source=0)
    allocate (self%first(most_rows + 1), source=1)
    allocate (self%master(most_masters))
  end subroutine start_graph

  !> Makes a node follow others without any check.
  subroutine add_follower(self, node, masters)
    class(dependence), intent(inout) :: self
    integer, intent(in) :: node, masters(:)
    integer :: row, root, next
    self%num_rows = self%num_rows + 1
    row = self%num_rows
    next = self%first(row) + size(masters)
    self%master(self%first(row):next - 1) = masters
    self%first(row + 1) = next
    self%next_row(row) = self%first_row(node)
    self%first_row(node) = row
    call find_root(self%parent, node, root)
    self%end_node(root) = node
  end subroutine add_follower

  !> Makes a node follow others if it is free and none of them follows it.
  subroutine follow(self, node, masters, is_linked)
    class(dependence), intent(inout) :: self
    integer, intent(in) :: node, masters(:)
    logical, intent(out) :: is_linked
    integer :: root
    call find_root(self%parent, node, root)
    is_linked = self%end_node(root) == 0
    if (.not. is_linked) return
    call find_circle(self, masters, root, is_linked)
    is_linked = .not. is_linked
    if (is_linked) call self%add_row(node, masters)
  end subroutine follow

  !> Joins the trees of two nodes if one node is free to follow the other.
  subroutine join(self, a, b, is_joined)
    class(dependence), intent(inout) :: self
    integer, intent(in) :: a, b
    logical, intent(out) :: is_joined
    integer :: root_a, root_b
    logical :: is_circle
    is_joined = .false.
    call find_root(self%parent, a, root_a)
    call find_root(self%parent, b, root_b)
    if (root_a == root_b) return
    if (self%end_node(root_a) > 0 .and. self%end_node(root_b) > 0) return
    call find_circle(self, [root_a], root_b, is_circle)
    if (is_circle) return
    call find_circle(self, [root_b], root_a, is_circle)
    if (is_circle) return
    self%parent(root_a) = root_b
    self%end_node(root_b) = max(self%end_node(root_a), self%end_node(root_b))
    is_joined = .true.
  end subroutine join

  !> Whether all nodes of its tree must depend on this node.
  pure logical function is_end(self, node)
    class(dependence), intent(in) :: self
    integer, intent(in) :: node
    integer :: root
    root = node
    do while (self%parent(root) /= root)
      root = self%parent(root)
    end do
    is_end = self%end_node(root) == node
  end function is_end

  !> Whether the nodes that these nodes follow, directly or through others, include a tree.
  subroutine find_circle(self, nodes, target_root, is_circle)
    class(dependence), intent(inout) :: self
    integer, intent(in) :: nodes(:)
    integer, intent(in) :: target_root !< of the tree
    logical, intent(out) :: is_circle
    integer :: top, row
    self%num_searches = self%num_searches + 1
    top = 0
    is_circle = .false.
    call visit(nodes)
    do while (top > 0 .and. .not. is_circle)
      row = self%first_row(self%stack(top))
      top = top - 1
      do while (row > 0)
        call visit(self%master(self%first(row):self%first(row + 1) - 1))
        row = self%next_row(row)
      end do
    end do
  contains
    !> Puts the end nodes of the trees of some nodes on the stack, each once.
    subroutine visit(others)
      integer, intent(in) :: others(:)
      integer :: i, root
      do i = 1, size(others)
        call find_root(self%parent, others(i), root)
        if (root == target_root) is_circle = .true.
        if (self%stamp(root) == self%num_searches) cycle
        self%stamp(root) = self%num_searches
        if (self%end_node(root) == 0) cycle
        top = top + 1
        self%stack(top) = self%end_node(root)
      end do
    end subroutine visit
  end subroutine find_circle

  !> The root of a node's tree; halves the path to the root.
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
end module link_graph
