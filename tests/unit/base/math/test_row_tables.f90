!> Tables of rows against lists written by hand.
program test_row_tables
  use row_tables, only: group_by_key, row_table, transpose_rows
  use testing, only: check, test_log
  implicit none
  type(test_log) :: log
  log%suite = 'row_tables'
  call row_by_row()
  call by_key()
  call transposed()
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> Rows of different length, an empty one, many; a table without rows.
  subroutine row_by_row()
    type(row_table) :: rows, none
    integer :: i, wrong
    call rows%append([7, 5])
    call rows%append([integer ::])
    do i = 3, 500
      call rows%append(spread(i, 1, mod(i, 7)))
    end do
    call rows%finish()
    call check(log, rows%num_rows() == 500 .and. size(rows%first) == 501, 'number of rows')
    call check(log, all(rows%row(1) == [7, 5]) .and. size(rows%row(2)) == 0, 'first rows')
    wrong = 0
    do i = 3, 500
      if (size(rows%row(i)) /= mod(i, 7) .or. any(rows%row(i) /= i)) wrong = wrong + 1
    end do
    call check(log, wrong == 0 .and. size(rows%item) == rows%first(501) - 1, 'lengths')
    call none%finish()
    call check(log, none%num_rows() == 0 .and. size(none%item) == 0, 'no rows')
  end subroutine row_by_row

  !> Positions or items by their key; key 0 is left out, a key may have no item.
  subroutine by_key()
    type(row_table) :: table
    call group_by_key([2, 4, 0, 2, 1], 4, table)
    call check(log, all(table%first == [1, 2, 4, 4, 5]), 'first of each key')
    call check(log, all(table%item == [5, 1, 4, 2]), 'positions in their order')
    call group_by_key([2, 4, 0, 2, 1], 4, table, [10, 20, 30, 40, 50])
    call check(log, all(table%row(2) == [10, 40]) .and. size(table%row(3)) == 0, 'items')
  end subroutine by_key

  !> Transposed twice, a table has its rows again, with ascending items.
  subroutine transposed()
    type(row_table) :: rows, columns, again
    rows%first = [1, 3, 3, 6]
    rows%item = [1, 4, 1, 2, 4]
    call transpose_rows(rows, 4, columns)
    call check(log, all(columns%first == [1, 3, 4, 4, 6]), 'first of each item')
    call check(log, all(columns%item == [1, 3, 3, 1, 3]), 'rows of each item')
    call transpose_rows(columns, 3, again)
    call check(log, all(again%first == rows%first) .and. all(again%item == rows%item), 'again')
  end subroutine transposed
end program test_row_tables
