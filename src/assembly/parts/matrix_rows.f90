!> The rows of a matrix that is divided among the ranks.
!>
!> A node belongs to the lowest rank that assembles an element at it; nodes without such an element
!> belong to the first rank. Its three rows stand together, and so do those of a jump, which belong
!> to the rank of the node that the jump separates from the rest.
module matrix_rows
  use dam_mesh, only: fe_mesh
  use dof_numbering, only: numbering
  use joint_rows, only: num_axes
  use kinds, only: rk
  use matrix_pattern, only: pattern
  use node_dofs, only: num_directions
  use node_sequence, only: order_nodes
  use ranks, only: num_ranks, this_rank
  use row_tables, only: row_table
  use unknown_layout, only: own_rows
  implicit none
  private
  public :: lay_out_rows

contains

  !> Gives the matrix of a step its rows, and marks it as a sum over the ranks.
  subroutine lay_out_rows(mesh, numbers, cells, matrix)
    type(fe_mesh), intent(in) :: mesh !< with a rank for each element
    type(numbering), intent(in) :: numbers
    type(row_table), intent(in) :: cells !< of this rank
    type(pattern), intent(inout) :: matrix
    integer, allocatable :: first_of_node(:)
    allocate (matrix%layout)
    matrix%is_shared = .true.
    associate (layout => matrix%layout)
      call number_rows(mesh, numbers, layout%first_row, layout%row, first_of_node)
      allocate (layout%is_touched(numbers%num_free), source=.false.)
      call touch_unknowns(numbers, cells, layout%is_touched)
      call find_rigid_motions(mesh, numbers, first_of_node, &
                              own_rows(layout, this_rank()), layout%rigid)
    end associate
  end subroutine lay_out_rows

  !> Numbers the rows of the nodes with free unknowns and of the jumps, rank by rank.
  subroutine number_rows(mesh, numbers, first_row, row, first_of_node)
    type(fe_mesh), intent(in) :: mesh
    type(numbering), intent(in) :: numbers
    integer, allocatable, intent(out) :: first_row(:) !< (ranks + 1) from 0
    integer, allocatable, intent(out) :: row(:) !< (num_free) from 0
    integer, allocatable, intent(out) :: first_of_node(:) !< (nodes) from 0; -1: no rows
    integer :: owner(mesh%num_nodes), sequence(mesh%num_nodes)
    integer :: rank, k, next, j, first_jump
    logical :: has_rows(mesh%num_nodes)
    call find_owners(mesh, owner)
    call order_nodes(mesh, sequence)
    first_jump = numbers%num_free - numbers%num_jumps + 1
    has_rows = .false.
    has_rows(numbers%node(:first_jump - 1)) = .true.
    allocate (first_row(num_ranks() + 1), first_of_node(mesh%num_nodes), row(numbers%num_free))
    first_of_node = -1
    next = 0
    do rank = 0, num_ranks() - 1
      first_row(rank + 1) = next
      do k = 1, mesh%num_nodes
        if (owner(sequence(k)) /= rank .or. .not. has_rows(sequence(k))) cycle
        first_of_node(sequence(k)) = next
        next = next + num_directions
      end do
      do j = first_jump, numbers%num_free, num_axes
        if (owner(numbers%node(j)) /= rank) cycle
        row(j:j + num_axes - 1) = [next, next + 1, next + 2]
        next = next + num_axes
      end do
    end do
    first_row(num_ranks() + 1) = next
    row(:first_jump - 1) = first_of_node(numbers%node(:first_jump - 1)) &
                           + numbers%direction(:first_jump - 1) - 1
  end subroutine number_rows

  !> The rank of each node.
  pure subroutine find_owners(mesh, owner)
    type(fe_mesh), intent(in) :: mesh
    integer, intent(out) :: owner(:) !< (nodes) from 0
    integer :: e, a
    owner = huge(1)
    do e = 1, mesh%num_elements
      if (mesh%material_of_element(e) == 0) cycle
      do a = 1, size(mesh%nodes, 1)
        associate (node => mesh%nodes(a, e))
          if (node > 0) owner(node) = min(owner(node), mesh%rank_of_element(e))
        end associate
      end do
    end do
    where (owner == huge(1)) owner = 0
  end subroutine find_owners

  !> Marks the free unknowns of some cells.
  pure subroutine touch_unknowns(numbers, cells, is_touched)
    type(numbering), intent(in) :: numbers
    type(row_table), intent(in) :: cells
    logical, intent(inout) :: is_touched(:)
    integer :: c, k, node
    do c = 1, size(cells%item)
      node = cells%item(c)
      do k = numbers%node_start(node), numbers%node_start(node + 1) - 1
        if (numbers%unknown(k) <= size(is_touched)) is_touched(numbers%unknown(k)) = .true.
      end do
    end do
  end subroutine touch_unknowns

  !> Three translations and three rotations about the centre of the model at the own rows; zero
  !> where there is no free displacement.
  subroutine find_rigid_motions(mesh, numbers, first_of_node, bounds, rigid)
    type(fe_mesh), intent(in) :: mesh
    type(numbering), intent(in) :: numbers
    integer, intent(in) :: first_of_node(:) !< (nodes)
    integer, intent(in) :: bounds(2) !< own rows
    real(rk), allocatable, intent(out) :: rigid(:, :) !< (own rows, 6)
    real(rk) :: centre(3), x(3)
    integer :: j, i, row, direction
    centre = sum(mesh%x, dim=2)/max(1, mesh%num_nodes)
    allocate (rigid(bounds(1):bounds(2), 2*num_directions), source=0.0_rk)
    do j = 1, numbers%num_free - numbers%num_jumps
      direction = numbers%direction(j)
      row = first_of_node(numbers%node(j)) + direction - 1
      if (row < bounds(1) .or. row > bounds(2)) cycle
      x = mesh%x(:, numbers%node(j)) - centre
      rigid(row, direction) = 1.0_rk
      do i = 1, num_directions
        rigid(row, num_directions + i) = rotation(i, x, direction)
      end do
    end do
  end subroutine find_rigid_motions

  !> A component of the unit rotation about an axis at a place.
  pure real(rk) function rotation(axis, x, direction)
    integer, intent(in) :: axis, direction !< 1..3
    real(rk), intent(in) :: x(3) !< from the centre [m]
    integer :: next, last
    next = modulo(axis, 3) + 1
    last = modulo(next, 3) + 1
    rotation = 0.0_rk
    if (direction == last) rotation = x(next)
    if (direction == next) rotation = -x(last)
  end function rotation
end module matrix_rows
