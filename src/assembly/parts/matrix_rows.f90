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
  use node_parts, only: find_owners
  use part_borders, only: find_part
  use ranks, only: num_ranks, starts_of_ranks, this_rank
  use row_tables, only: row_table
  use unknown_layout, only: own_rows
  use unknown_parts, only: unknown_part
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
    integer :: owner(mesh%num_nodes)
    allocate (matrix%layout)
    matrix%is_shared = .true.
    call find_owners(mesh, owner)
    call find_part(mesh, numbers, owner, this_rank(), num_ranks(), matrix%part)
    associate (layout => matrix%layout)
      call number_rows(mesh, numbers, owner, layout%first_row, first_of_node, layout%row)
      call share_rows(numbers%num_total, matrix%part, layout%row)
      allocate (layout%is_touched(numbers%num_free), source=.false.)
      call touch_unknowns(numbers, cells, layout%is_touched)
      call find_rigid_motions(mesh, numbers, first_of_node, &
                              own_rows(layout, this_rank()), layout%rigid)
    end associate
  end subroutine lay_out_rows

  !> Numbers the rows of this rank: those of its nodes with free unknowns, then those of its jumps.
  subroutine number_rows(mesh, numbers, owner, first_row, first_of_node, row)
    type(fe_mesh), intent(in) :: mesh
    type(numbering), intent(in) :: numbers
    integer, intent(in) :: owner(:) !< (nodes) rank of each node
    integer, allocatable, intent(out) :: first_row(:) !< (ranks + 1) from 0
    integer, allocatable, intent(out) :: first_of_node(:) !< (nodes) from 0; -1: not here
    integer, allocatable, intent(out) :: row(:) !< (num_free) from 0; -1: of another rank
    integer :: sequence(mesh%num_nodes)
    integer :: k, next, j, first_jump
    logical :: has_rows(mesh%num_nodes)
    call order_nodes(mesh, sequence)
    first_jump = numbers%num_free - numbers%num_jumps + 1
    has_rows = .false.
    has_rows(numbers%node(:first_jump - 1)) = .true.
    has_rows = has_rows .and. owner == this_rank()
    first_row = starts_of_ranks(num_directions*count(has_rows) + count( &
                                owner(numbers%node(first_jump:numbers%num_free)) == this_rank()))
    allocate (first_of_node(mesh%num_nodes), source=-1)
    allocate (row(numbers%num_free), source=-1)
    next = first_row(this_rank() + 1)
    do k = 1, mesh%num_nodes
      if (.not. has_rows(sequence(k))) cycle
      first_of_node(sequence(k)) = next
      next = next + num_directions
    end do
    do j = 1, first_jump - 1
      if (has_rows(numbers%node(j))) row(j) = first_of_node(numbers%node(j)) &
                                              + numbers%direction(j) - 1
    end do
    do j = first_jump, numbers%num_free, num_axes
      if (owner(numbers%node(j)) /= this_rank()) cycle
      row(j:j + num_axes - 1) = [next, next + 1, next + 2]
      next = next + num_axes
    end do
  end subroutine number_rows

  !> Takes the rows of unknowns that other ranks own.
  subroutine share_rows(num_total, part, row)
    integer, intent(in) :: num_total !< unknowns
    type(unknown_part), intent(in) :: part
    integer, intent(inout) :: row(:) !< (num_free)
    real(rk) :: number(num_total)
    number = 0.0_rk
    number(:size(row)) = max(row, 0)
    call part%add(number)
    row = nint(number(:size(row)))
  end subroutine share_rows

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
      if (first_of_node(numbers%node(j)) < 0) cycle
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
