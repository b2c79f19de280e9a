!> What a rank gives to PETSc against a dense matrix: blocks of the upper triangle of a symmetric
!> matrix, entries of another one. In one process all rows are own ones.
program test_entry_lists
  use, intrinsic :: iso_c_binding, only: c_int
  use dam_mesh, only: node_tie
  use dof_numbering, only: linear_links, number_unknowns, numbering
  use entry_lists, only: list_block_values, list_blocks, list_entries, list_entry_values
  use errors, only: error_type
  use jump_links, only: link_nodes, nodal_points, pairs_of_nodes
  use kinds, only: rk
  use matrix_pattern, only: full_pattern, pattern, spread_values
  use node_dofs, only: displacement_dofs
  use pattern_builder, only: build_pattern
  use row_tables, only: row_table
  use testing, only: check, check_close, test_log
  implicit none
  integer, parameter :: num_rows = 18
  type(test_log) :: log
  type(pattern) :: lower, full
  real(rk), allocatable :: values(:)
  real(rk) :: dense(0:num_rows - 1, 0:num_rows - 1)
  log%suite = 'entry_lists'
  call make_model()
  call make_dense()
  call blocks_give_the_matrix()
  call entries_give_the_matrix()
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1
contains

  !> Two cells of three nodes (1 2 3 and 4 5 6), joined by a point of the pair (4, 3); node 1 is
  !> partly fixed. The rows of the nodes stand in another order than their unknowns.
  subroutine make_model()
    type(numbering) :: numbers
    type(linear_links) :: links
    type(nodal_points) :: points
    type(node_tie) :: ties(0)
    type(row_table) :: cells
    type(error_type), allocatable :: error
    integer, parameter :: first_row_of_node(6) = [3, 9, 12, -1, 6, 0]
    logical :: is_used(6), is_fixed(3, 6)
    integer :: j, k
    is_used = .true.
    is_fixed = .false.
    is_fixed(2, 1) = .true.
    call pairs_of_nodes([4], [3], reshape([1.0_rk, 0.0_rk, 0.0_rk, 0.0_rk, 1.0_rk, 0.0_rk, &
                                           0.0_rk, 0.0_rk, 1.0_rk], [3, 3, 1]), points)
    call link_nodes(displacement_dofs(6), points, ties, is_used, is_fixed, links, error)
    call number_unknowns(displacement_dofs(6), is_used, is_fixed, links, numbers, error)
    cells%first = [1, 4, 7, 9]
    cells%item = [1, 2, 3, 4, 5, 6, 3, 4]
    call build_pattern(numbers, cells, lower)
    allocate (lower%layout)
    lower%layout%first_row = [0, num_rows]
    lower%layout%is_touched = [(.true., j=1, lower%num_free)]
    lower%layout%row = [(first_row_of_node(numbers%node(j)) + numbers%direction(j) - 1, j=1, 14), &
                        15, 16, 17]
    call full_pattern(lower, full)
    full%layout = lower%layout
    values = [(sqrt(real(k, rk)), k=1, size(lower%row))]
  end subroutine make_model

  !> Both triangles of the free unknowns, in the order of the rows.
  subroutine make_dense()
    real(rk) :: largest
    integer :: j, k
    dense = 0.0_rk
    largest = 0.0_rk
    do j = 1, lower%num_free
      do k = lower%column_start(j), lower%column_start(j) + lower%free_entries(j) - 1
        associate (a => lower%layout%row(j), b => lower%layout%row(lower%row(k)))
          dense(a, b) = values(k)
          dense(b, a) = values(k)
        end associate
        largest = max(largest, values(k))
      end do
    end do
    dense(4, 4) = largest ! the fixed direction of node 1
  end subroutine make_dense

  subroutine blocks_give_the_matrix()
    integer(c_int), allocatable :: row(:), column(:)
    real(rk), allocatable :: block(:, :, :)
    real(rk) :: found(0:num_rows - 1, 0:num_rows - 1)
    integer :: n
    call list_blocks(lower, row, column)
    allocate (block(3, 3, size(row)))
    call list_block_values(lower, values, block)
    found = 0.0_rk
    do n = 1, size(row)
      associate (i => 3*row(n), j => 3*column(n))
        found(i:i + 2, j:j + 2) = found(i:i + 2, j:j + 2) + transpose(block(:, :, n))
        if (i == j) cycle
        found(j:j + 2, i:i + 2) = found(j:j + 2, i:i + 2) + block(:, :, n)
      end associate
    end do
    call check(log, all(row <= column), 'upper triangle')
    call check_close(log, maxval(abs(found - dense)), 0.0_rk, 0.0_rk, 'sum of the blocks')
  end subroutine blocks_give_the_matrix

  subroutine entries_give_the_matrix()
    integer(c_int), allocatable :: row(:), column(:)
    real(rk), allocatable :: all_values(:), list(:)
    real(rk) :: found(0:num_rows - 1, 0:num_rows - 1)
    integer :: n
    call list_entries(full, row, column)
    allocate (list(size(row)), all_values(size(full%row)))
    call spread_values(lower, values, full, all_values)
    call list_entry_values(full, all_values, list)
    found = 0.0_rk
    do n = 1, size(row)
      found(row(n), column(n)) = found(row(n), column(n)) + list(n)
    end do
    call check_close(log, maxval(abs(found - dense)), 0.0_rk, 0.0_rk, 'sum of the entries')
  end subroutine entries_give_the_matrix
end program test_entry_lists
