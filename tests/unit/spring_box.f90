!> A box of nodes, 6 along each side unless asked for, whose cells are webs of springs: a symmetric
!> positive matrix.
module spring_box
  use kinds, only: rk
  use errors, only: error_type
  use node_dofs, only: displacement_dofs
  use dof_numbering, only: numbering, linear_links, number_unknowns
  use matrix_pattern, only: pattern, add_block
  use pattern_builder, only: build_pattern
  use row_tables, only: row_table
  implicit none
  private
  public :: make_box

  integer, parameter :: usual_side = 6

contains

  !> The nodes of the lowest layer are fixed; the last free unknowns are taken for jumps.
  subroutine make_box(matrix, values, num_jumps, nodes_of_side)
    type(pattern), intent(out) :: matrix
    real(rk), allocatable, intent(out) :: values(:)
    integer, intent(in) :: num_jumps
    integer, intent(in), optional :: nodes_of_side
    type(numbering) :: numbers
    type(linear_links) :: links
    type(row_table) :: cells
    type(error_type), allocatable :: error
    logical, allocatable :: is_used(:), is_fixed(:, :)
    integer :: c, side
    side = usual_side
    if (present(nodes_of_side)) side = nodes_of_side
    call list_box(side, cells)
    allocate (is_used(side**3), source=.true.)
    allocate (is_fixed(3, side**3), source=.false.)
    is_fixed(:, :side**2) = .true.
    call number_unknowns(displacement_dofs(side**3), is_used, is_fixed, links, numbers, error)
    if (allocated(error)) error stop 'spring_box: numbering'
    call build_pattern(numbers, cells, matrix)
    matrix%num_last = num_jumps
    allocate (values(size(matrix%row)))
    values = 0.0_rk
    do c = 1, size(cells%first) - 1
      call add_springs(numbers, cells%item(cells%first(c):cells%first(c + 1) - 1), matrix, values)
    end do
  end subroutine make_box

  subroutine list_box(side, cells)
    integer, intent(in) :: side
    type(row_table), intent(out) :: cells
    integer :: i, j, k, c, corner, num_cells
    num_cells = (side - 1)**3
    allocate (cells%first(num_cells + 1), cells%item(8*num_cells))
    cells%first(:) = [(1 + 8*(c - 1), c=1, num_cells + 1)]
    c = 0
    do k = 0, side - 2
      do j = 0, side - 2
        do i = 0, side - 2
          corner = 1 + i + side*(j + side*k)
          cells%item(8*c + 1:8*c + 4) = [corner, corner + 1, corner + side, corner + side + 1]
          cells%item(8*c + 5:8*c + 8) = cells%item(8*c + 1:8*c + 4) + side**2
          c = c + 1
        end do
      end do
    end do
  end subroutine list_box

  !> Every unknown of the cell against every other.
  subroutine add_springs(numbers, nodes, matrix, values)
    type(numbering), intent(in) :: numbers
    integer, intent(in) :: nodes(8)
    type(pattern), intent(in) :: matrix
    real(rk), intent(inout) :: values(:)
    integer :: unknown(24), sorted(24), k
    real(rk) :: block(24, 24)
    unknown = numbers%unknown(numbers%row_start(numbers%dofs%displacements_of(nodes)))
    do k = 1, 24
      sorted(count(unknown <= unknown(k))) = unknown(k)
    end do
    block = -1.0_rk
    do k = 1, 24
      block(k, k) = 23.1_rk
    end do
    call add_block(matrix, sorted, block, values)
  end subroutine add_springs
end module spring_box
