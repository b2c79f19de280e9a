!> Blocks: parts of the model that are connected without joints, as rigid bodies.
!>
!> Elements, ties and couplings connect the nodes of a block; joints and supports hold the block.
!> Its motions are v + w x (x - centre). The six unknowns are v and radius*w, with the distance of
!> the farthest node as radius, so that all are lengths (different_meshes.md, 13.7).
module rigid_blocks
  use body_parts, only: root_of, unite
  use dam_mesh, only: fe_mesh, node_tie
  use joint_points, only: dam_joint
  use kinds, only: rk
  use problem_definition, only: problem
  use row_tables, only: row_table
  use small_matrix, only: cross_product
  implicit none
  private
  public :: block_set, find_blocks, find_tied_parts, join_blocks, jump_rows, add_supports, add_tie
  public :: add_square

  !> Blocks, parts or bodies of a model.
  type :: block_set
    integer :: num_blocks = 0
    integer, allocatable :: block_of(:) !< (nodes) 0: a node without an element
    integer, allocatable :: example(:) !< (blocks) element with the lowest number (position)
    real(rk), allocatable :: centre(:, :) !< (3, blocks) mean of the nodes [m]
    real(rk), allocatable :: radius(:) !< (blocks) [m]
  end type block_set

contains

  !> Finds the blocks of a model.
  subroutine find_blocks(model, blocks)
    type(problem), intent(in) :: model
    type(block_set), intent(out) :: blocks
    integer, allocatable :: parent(:)
    type(row_table) :: bonds
    integer :: i
    allocate (parent(model%mesh%num_nodes), source=0)
    call unite_elements(model, with_joints=.false., parent=parent)
    do i = 1, size(model%guests)
      call model%guests(i)%item%add_bonds(bonds)
    end do
    call unite_bonds(bonds, parent)
    call number_blocks(model, parent, blocks)
    call measure_blocks(model%mesh%x, blocks)
  end subroutine find_blocks

  !> Finds the parts of a model that ties and equations alone connect: joints and springs count as
  !> rigid.
  subroutine find_tied_parts(model, parts)
    type(problem), intent(in) :: model
    type(block_set), intent(out) :: parts
    integer, allocatable :: parent(:)
    type(node_tie) :: ties(1)
    type(row_table) :: bonds
    integer :: i, used
    allocate (parent(model%mesh%num_nodes), source=0)
    call unite_elements(model, with_joints=.true., parent=parent)
    do i = 1, size(model%joints)
      call model%joints(i)%add_bonds(bonds)
    end do
    do i = 1, size(model%guests)
      used = 0
      call model%guests(i)%item%add_ties(ties, used)
      if (used == 0) call model%guests(i)%item%add_bonds(bonds)
    end do
    call unite_bonds(bonds, parent)
    call number_blocks(model, parent, parts)
    call measure_blocks(model%mesh%x, parts)
  end subroutine find_tied_parts

  !> Joins blocks to bodies.
  subroutine join_blocks(mesh, blocks, body_of, bodies)
    type(fe_mesh), intent(in) :: mesh
    type(block_set), intent(in) :: blocks
    integer, intent(in) :: body_of(:) !< (blocks) 1, 2, .. in the order of their first blocks
    type(block_set), intent(out) :: bodies
    integer :: b
    bodies%num_blocks = maxval([0, body_of])
    allocate (bodies%block_of(size(blocks%block_of)), bodies%example(bodies%num_blocks), source=0)
    where (blocks%block_of > 0) bodies%block_of = body_of(max(blocks%block_of, 1))
    do b = 1, blocks%num_blocks
      associate (first => bodies%example(body_of(b)), own => blocks%example(b))
        if (first == 0) first = own
        if (mesh%element_id(own) < mesh%element_id(first)) first = own
      end associate
    end do
    call measure_blocks(mesh%x, bodies)
  end subroutine join_blocks

  !> Unites the nodes of each element.
  subroutine unite_elements(model, with_joints, parent)
    type(problem), intent(in) :: model
    logical, intent(in) :: with_joints !< also the faces of a joint element
    integer, intent(inout) :: parent(:)
    integer :: e, a, node
    do e = 1, model%mesh%num_elements
      if (model%mesh%element_type(e) == 'JOINT8' .and. .not. with_joints) cycle
      do a = 1, count(model%mesh%nodes(:, e) > 0)
        node = model%mesh%nodes(a, e)
        if (parent(node) == 0) parent(node) = node
        call unite(parent, model%mesh%nodes(1, e), node)
      end do
    end do
  end subroutine unite_elements

  !> Unites the nodes of each bond.
  subroutine unite_bonds(bonds, parent)
    type(row_table), intent(inout) :: bonds
    integer, intent(inout) :: parent(:)
    integer :: i, k
    call bonds%finish()
    do i = 1, bonds%num_rows()
      do k = bonds%first(i) + 1, bonds%first(i + 1) - 1
        call unite_nodes(bonds%item(bonds%first(i)), bonds%item(k))
      end do
    end do
  contains
    !> Puts two nodes into one block.
    subroutine unite_nodes(a, b)
      integer, intent(in) :: a, b
      if (parent(a) == 0) parent(a) = a
      if (parent(b) == 0) parent(b) = b
      call unite(parent, a, b)
    end subroutine unite_nodes
  end subroutine unite_bonds

  !> Numbers the blocks in the order of their elements.
  subroutine number_blocks(model, parent, blocks)
    type(problem), intent(in) :: model
    integer, intent(in) :: parent(:)
    type(block_set), intent(inout) :: blocks
    integer, allocatable :: number(:)
    integer :: e, node, root
    associate (mesh => model%mesh)
      allocate (number(mesh%num_nodes), blocks%block_of(mesh%num_nodes), source=0)
      allocate (blocks%example(mesh%num_elements))
      do e = 1, mesh%num_elements
        if (mesh%element_type(e) == 'JOINT8') cycle
        root = root_of(parent, mesh%nodes(1, e))
        if (number(root) == 0) then
          blocks%num_blocks = blocks%num_blocks + 1
          number(root) = blocks%num_blocks
          blocks%example(blocks%num_blocks) = e
        end if
        associate (first => blocks%example(number(root)))
          if (mesh%element_id(e) < mesh%element_id(first)) first = e
        end associate
      end do
      blocks%example = blocks%example(:blocks%num_blocks)
      do node = 1, mesh%num_nodes
        if (parent(node) > 0) blocks%block_of(node) = number(root_of(parent, node))
      end do
    end associate
  end subroutine number_blocks

  !> Centres and radii.
  subroutine measure_blocks(x, blocks)
    real(rk), intent(in) :: x(:, :) !< (3, nodes) [m]
    type(block_set), intent(inout) :: blocks
    integer :: members(blocks%num_blocks), node, b
    allocate (blocks%centre(3, blocks%num_blocks), blocks%radius(blocks%num_blocks))
    blocks%centre = 0.0_rk
    blocks%radius = tiny(1.0_rk)
    members = 0
    do node = 1, size(x, 2)
      b = blocks%block_of(node)
      if (b == 0) cycle
      members(b) = members(b) + 1
      blocks%centre(:, b) = blocks%centre(:, b) + x(:, node)
    end do
    do b = 1, blocks%num_blocks
      blocks%centre(:, b) = blocks%centre(:, b)/max(1, members(b))
    end do
    do node = 1, size(x, 2)
      b = blocks%block_of(node)
      if (b == 0) cycle
      blocks%radius(b) = max(blocks%radius(b), norm2(x(:, node) - blocks%centre(:, b)))
    end do
  end subroutine measure_blocks

  !> Adds the motion of a node in a direction, for unit motions of the blocks, to a row.
  pure subroutine add_node_motion(blocks, x, node, direction, row)
    type(block_set), intent(in) :: blocks
    real(rk), intent(in) :: x(:, :) !< (3, nodes) [m]
    integer, intent(in) :: node
    real(rk), intent(in) :: direction(3) !< of any length
    real(rk), intent(inout) :: row(:, :) !< (6, blocks)
    integer :: b
    b = blocks%block_of(node)
    if (b == 0) return
    row(1:3, b) = row(1:3, b) + direction
    row(4:6, b) = row(4:6, b) &
                  + cross_product(x(:, node) - blocks%centre(:, b), direction)/blocks%radius(b)
  end subroutine add_node_motion

  !> Jumps of a joint point in its axes, for unit motions of the blocks.
  pure subroutine jump_rows(blocks, x, joint, p, rows)
    type(block_set), intent(in) :: blocks
    real(rk), intent(in) :: x(:, :) !< (3, nodes) [m]
    type(dam_joint), intent(in) :: joint
    integer, intent(in) :: p !< point
    real(rk), intent(out) :: rows(:, :, :) !< (6, blocks, 3)
    integer :: i, k
    rows = 0.0_rk
    do i = 1, 3
      do k = joint%first(p), joint%first(p + 1) - 1
        call add_node_motion(blocks, x, joint%node(k), joint%weight(k)*joint%rotation(i, :, p), &
                             rows(:, :, i))
      end do
    end do
  end subroutine jump_rows

  !> Adds the supports to the matrix sum row^T row.
  pure subroutine add_supports(blocks, x, node, dof, matrix)
    type(block_set), intent(in) :: blocks
    real(rk), intent(in) :: x(:, :) !< (3, nodes) [m]
    integer, intent(in) :: node(:), dof(:) !< (supports)
    real(rk), intent(inout) :: matrix(:, :) !< (6*blocks, 6*blocks)
    real(rk) :: row(6, blocks%num_blocks), direction(3)
    integer :: i, j, b
    do i = 1, size(node)
      b = blocks%block_of(node(i))
      if (b == 0) cycle
      direction = 0.0_rk
      direction(dof(i)) = 1.0_rk
      row(:, b) = 0.0_rk
      call add_node_motion(blocks, x, node(i), direction, row)
      associate (part => matrix(6*b - 5:6*b, 6*b - 5:6*b))
        do j = 1, 6
          part(:, j) = part(:, j) + row(:, b)*row(j, b)
        end do
      end associate
    end do
  end subroutine add_supports

  !> Adds some rows of a tie or of equations to the matrix sum row^T row: the displacement of each
  !> node that follows less those that it follows, over the norm of the weights.
  subroutine add_tie(parts, x, tie, rows, matrix)
    type(block_set), intent(in) :: parts
    real(rk), intent(in) :: x(:, :) !< (3, nodes) [m]
    type(node_tie), intent(in) :: tie
    integer, intent(in) :: rows(:)
    real(rk), intent(inout) :: matrix(:, :) !< (6*parts, 6*parts)
    real(rk) :: row(6, parts%num_blocks)
    integer :: i, j, k, d, item_direction
    do j = 1, size(rows)
      i = rows(j)
      do d = 1, 3
        if (.not. tie%is_tied(d, i)) cycle
        row = 0.0_rk
        call add_node_motion(parts, x, tie%node(i), along(d, 1.0_rk), row)
        do k = tie%first(i), tie%first(i + 1) - 1
          item_direction = d
          if (allocated(tie%item_direction)) item_direction = tie%item_direction(k)
          call add_node_motion(parts, x, tie%item(k), along(item_direction, -tie%weight(k)), row)
        end do
        row = row/sqrt(1.0_rk + sum(tie%weight(tie%first(i):tie%first(i + 1) - 1)**2))
        call add_square(reshape(row, [size(row)]), matrix)
      end do
    end do
  end subroutine add_tie

  !> Adds row^T row.
  pure subroutine add_square(row, matrix)
    real(rk), intent(in) :: row(:) !< (6*blocks) most are zero
    real(rk), intent(inout) :: matrix(:, :) !< (6*blocks, 6*blocks)
    integer, allocatable :: used(:)
    integer :: k
    used = pack([(k, k=1, size(row))], abs(row) > 0.0_rk)
    do k = 1, size(used)
      matrix(used, used(k)) = matrix(used, used(k)) + row(used)*row(used(k))
    end do
  end subroutine add_square

  !> A vector along an axis.
  pure function along(axis, length) result(vector)
    integer, intent(in) :: axis
    real(rk), intent(in) :: length
    real(rk) :: vector(3)
    vector = 0.0_rk
    vector(axis) = length
  end function along
end module rigid_blocks
