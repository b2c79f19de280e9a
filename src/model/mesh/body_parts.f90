!> Bodies: parts of the model connected by elements (also joints), ties and couplings; and checks
!> that supports hold them.
module body_parts
  use dam_mesh, only: fe_mesh
  use kinds, only: rk
  use row_tables, only: row_table
  implicit none
  private
  public :: find_bodies, free_motion, unite, root_of

  !> A pivot below this fraction of the largest counts as zero; coordinates are scaled to one.
  real(rk), parameter :: rank_tolerance = 1.0e-10_rk

contains

  !> Numbers the bodies.
  pure subroutine find_bodies(mesh, groups, body, example)
    type(fe_mesh), intent(in) :: mesh
    type(row_table), intent(in) :: groups !< nodes that joints, ties and springs connect
    integer, allocatable, intent(out) :: body(:) !< of each node; 0 for a node without an element
    integer, allocatable, intent(out) :: example(:) !< first element of each body (position)
    integer, allocatable :: parent(:)
    integer :: e, a, g, node, root, num_bodies
    allocate (parent(mesh%num_nodes), source=0)
    do e = 1, mesh%num_elements
      do a = 1, count(mesh%nodes(:, e) > 0)
        node = mesh%nodes(a, e)
        if (parent(node) == 0) parent(node) = node
        call unite(parent, mesh%nodes(1, e), node)
      end do
    end do
    do g = 1, groups%num_rows()
      root = 0
      do a = groups%first(g), groups%first(g + 1) - 1
        node = groups%item(a)
        if (parent(node) == 0) cycle
        if (root == 0) root = node
        call unite(parent, root, node)
      end do
    end do
    allocate (body(mesh%num_nodes), source=0)
    allocate (example(mesh%num_elements))
    num_bodies = 0
    do e = 1, mesh%num_elements
      root = root_of(parent, mesh%nodes(1, e))
      if (body(root) > 0) cycle
      num_bodies = num_bodies + 1
      body(root) = num_bodies
      example(num_bodies) = e
    end do
    example = example(:num_bodies)
    do node = 1, mesh%num_nodes
      if (parent(node) > 0) body(node) = body(root_of(parent, node))
    end do
  end subroutine find_bodies

  !> Joins the trees of two nodes; the node of lower number becomes the root.
  pure subroutine unite(parent, a, b)
    integer, intent(inout) :: parent(:)
    integer, intent(in) :: a, b
    integer :: low, high, node, next
    low = root_of(parent, a)
    high = root_of(parent, b)
    if (low > high) then
      node = low
      low = high
      high = node
    end if
    parent(high) = low
    node = b
    do while (parent(node) /= node) ! shorten the path
      next = parent(node)
      parent(node) = low
      node = next
    end do
  end subroutine unite

  !> The root of the tree that a node stands in.
  pure integer function root_of(parent, node) result(root)
    integer, intent(in) :: parent(:), node
    root = node
    do while (parent(root) /= root)
      root = parent(root)
    end do
  end function root_of

  !> Description of the rigid motion that supports leave free; '' for none.
  pure function free_motion(x, dofs) result(motion)
    real(rk), intent(in) :: x(:, :) !< (3, supports) their places [m]
    integer, intent(in) :: dofs(:) !< direction of each, 1..3
    character(:), allocatable :: motion
    real(rk) :: normal(6, 6), row(6), centre(3), size_of_body, r(3)
    integer :: i, j, d
    motion = ''
    do d = 1, 3
      if (.not. any(dofs == d)) motion = motion//', '//'xyz' (d:d)
    end do
    if (len(motion) > 0) then
      motion = 'move along '//motion(3:)
      return
    end if
    centre = sum(x, dim=2)/size(x, 2)
    size_of_body = max(maxval(abs(x - spread(centre, 2, size(x, 2)))), tiny(1.0_rk))
    normal = 0.0_rk
    do i = 1, size(dofs)
      r = (x(:, i) - centre)/size_of_body
      row = 0.0_rk
      d = dofs(i)
      row(d) = 1.0_rk
      row(4 + mod(d, 3)) = r(1 + mod(d + 1, 3))
      row(4 + mod(d + 1, 3)) = -r(1 + mod(d, 3))
      do j = 1, 6
        normal(:, j) = normal(:, j) + row*row(j)
      end do
    end do
    if (rank_of(normal) < 6) motion = 'turn'
  end function free_motion

  !> Rank of a symmetric matrix without negative eigenvalues, by elimination.
  pure integer function rank_of(matrix) result(rank)
    real(rk), intent(in) :: matrix(6, 6)
    real(rk) :: m(6, 6), largest
    integer :: p, i, k
    m = matrix
    largest = maxval(abs(m))
    rank = 0
    do k = 1, 6
      p = 1
      do i = 2, 6
        if (m(i, i) > m(p, p)) p = i
      end do
      if (m(p, p) <= rank_tolerance*largest) return
      rank = rank + 1
      m = m - spread(m(:, p), 2, 6)*spread(m(p, :), 1, 6)/m(p, p)
      m(p, :) = 0.0_rk
      m(:, p) = 0.0_rk
    end do
  end function rank_of
end module body_parts
