!> What a rank adds to a distributed matrix: blocks of 3 x 3 in the upper triangle of a symmetric
!> matrix, single entries of another one.
!>
!> Rows without an unknown get an entry on the diagonal, as large as the largest value of all ranks.
module entry_lists
  use, intrinsic :: iso_c_binding, only: c_int
  use kinds, only: rk
  use matrix_pattern, only: pattern
  use ranks, only: of_all_ranks, this_rank
  use unknown_layout, only: own_rows, row_layout
  implicit none
  private
  public :: list_entries, list_entry_values, list_blocks, list_block_values

  integer, parameter :: width = 3 !< rows of a block

contains

  !> Rows and columns of the entries of a matrix that is not symmetric.
  subroutine list_entries(matrix, row, column)
    type(pattern), intent(in) :: matrix !< with a layout
    integer(c_int), allocatable, intent(out) :: row(:), column(:) !< from 0
    integer, allocatable :: empty(:)
    integer :: j, n, last
    associate (layout => matrix%layout)
      call find_empty_rows(layout, empty)
      n = size(empty)
      do j = 1, matrix%num_free
        if (layout%is_touched(j)) n = n + matrix%free_entries(j)
      end do
      allocate (row(n), column(n))
      n = 0
      do j = 1, matrix%num_free
        if (.not. layout%is_touched(j)) cycle
        last = n + matrix%free_entries(j)
        row(n + 1:last) = int(layout%row(rows_of_column(matrix, j)), c_int)
        column(n + 1:last) = int(layout%row(j), c_int)
        n = last
      end do
      row(n + 1:) = int(empty, c_int)
      column(n + 1:) = int(empty, c_int)
    end associate
  end subroutine list_entries

  !> The values of the entries of `list_entries`.
  subroutine list_entry_values(matrix, values, list)
    type(pattern), intent(in) :: matrix
    real(rk), intent(in) :: values(:) !< of this rank
    real(rk), intent(out) :: list(:)
    integer :: j, n, last
    n = 0
    do j = 1, matrix%num_free
      if (.not. matrix%layout%is_touched(j)) cycle
      last = n + matrix%free_entries(j)
      list(n + 1:last) = values(matrix%column_start(j):matrix%column_start(j) + last - n - 1)
      n = last
    end do
    list(n + 1:) = largest_everywhere(maxval(list(:n)))
  end subroutine list_entry_values

  !> Rows and columns of the blocks of a symmetric matrix. A block may stand there several times.
  subroutine list_blocks(matrix, row, column)
    type(pattern), intent(in) :: matrix !< with a layout
    integer(c_int), allocatable, intent(out) :: row(:), column(:) !< from 0, row <= column
    integer, allocatable :: empty(:)
    integer :: pass, j, k, n, own, last
    call find_empty_rows(matrix%layout, empty)
    do pass = 1, 2
      n = 0
      do j = 1, matrix%num_free
        if (.not. matrix%layout%is_touched(j) .or. is_continued(matrix, j)) cycle
        own = matrix%layout%row(j)/width
        last = -1
        do k = matrix%column_start(j), matrix%column_start(j) + matrix%free_entries(j) - 1
          associate (other => matrix%layout%row(matrix%row(k))/width)
            if (other == last) cycle
            last = other
            call add(min(own, other), max(own, other))
          end associate
        end do
      end do
      do k = 1, size(empty)
        call add(empty(k)/width, empty(k)/width)
      end do
      if (pass == 1) allocate (row(n), column(n))
    end do
  contains
    !> Counts a block, and in the second pass writes it.
    subroutine add(row_of_block, column_of_block)
      integer, intent(in) :: row_of_block, column_of_block
      n = n + 1
      if (pass == 1) return
      row(n) = int(row_of_block, c_int)
      column(n) = int(column_of_block, c_int)
    end subroutine add
  end subroutine list_blocks

  !> The values of the blocks of `list_blocks`. The columns of a node follow each other: they add to
  !> the same blocks.
  subroutine list_block_values(matrix, values, list)
    type(pattern), intent(in) :: matrix
    real(rk), intent(in) :: values(:) !< of this rank
    real(rk), intent(out) :: list(:, :, :) !< (columns of a block, its rows, blocks)
    integer, allocatable :: empty(:)
    real(rk) :: largest
    integer :: j, k, n, first, last
    list = 0.0_rk
    n = 0
    first = 0
    do j = 1, matrix%num_free
      if (.not. matrix%layout%is_touched(j)) cycle
      if (.not. is_continued(matrix, j)) first = n
      n = first
      last = -1
      do k = matrix%column_start(j), matrix%column_start(j) + matrix%free_entries(j) - 1
        associate (block => matrix%layout%row(matrix%row(k))/width)
          if (block /= last) n = n + 1
          last = block
        end associate
        call put_entry(matrix%layout%row(j), matrix%layout%row(matrix%row(k)), values(k), &
                       list(:, :, n))
      end do
    end do
    call find_empty_rows(matrix%layout, empty)
    largest = largest_everywhere(maxval(list))
    do k = 1, size(empty)
      associate (i => modulo(empty(k), width) + 1)
        list(i, i, n + k) = largest
      end associate
    end do
  end subroutine list_block_values

  !> Puts an entry of a symmetric matrix into its block of the upper triangle.
  pure subroutine put_entry(a, b, value, block)
    integer, intent(in) :: a, b !< row and column, from 0, in any order
    real(rk), intent(in) :: value
    real(rk), intent(inout) :: block(:, :) !< (columns, rows)
    integer :: row, column
    row = modulo(min(a, b), width) + 1
    column = modulo(max(a, b), width) + 1
    block(column, row) = value
    if (a/width == b/width) block(row, column) = value
  end subroutine put_entry

  !> Whether a column has the node of the column before, and its blocks.
  pure logical function is_continued(matrix, j)
    type(pattern), intent(in) :: matrix
    integer, intent(in) :: j
    is_continued = .false.
    if (j == 1) return
    if (.not. matrix%layout%is_touched(j - 1)) return
    is_continued = matrix%alike(j - 1) > 1 &
                   .and. matrix%layout%row(j)/width == matrix%layout%row(j - 1)/width
  end function is_continued

  !> Unknowns in the rows of a column that are free.
  pure function rows_of_column(matrix, j) result(rows)
    type(pattern), intent(in) :: matrix
    integer, intent(in) :: j
    integer :: rows(matrix%free_entries(j))
    rows = matrix%row(matrix%column_start(j):matrix%column_start(j) + size(rows) - 1)
  end function rows_of_column

  !> The own rows without an unknown, from 0.
  subroutine find_empty_rows(layout, empty)
    type(row_layout), intent(in) :: layout
    integer, allocatable, intent(out) :: empty(:)
    logical, allocatable :: is_empty(:)
    integer :: bounds(2), i, j
    bounds = own_rows(layout, this_rank())
    allocate (is_empty(bounds(1):bounds(2)), source=.true.)
    do j = 1, size(layout%row)
      if (layout%row(j) >= bounds(1) .and. layout%row(j) <= bounds(2)) then
        is_empty(layout%row(j)) = .false.
      end if
    end do
    empty = pack([(i, i=bounds(1), bounds(2))], is_empty)
  end subroutine find_empty_rows

  !> The largest value of all ranks, at least the smallest number that is not zero.
  real(rk) function largest_everywhere(own) result(largest)
    real(rk), intent(in) :: own !< largest of this rank
    largest = max(maxval(of_all_ranks(own)), tiny(1.0_rk))
  end function largest_everywhere
end module entry_lists
