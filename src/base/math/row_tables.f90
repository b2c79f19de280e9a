!> Rows of different length in one list (compressed rows).
module row_tables
  use kinds, only: rk
  use growing_lists, only: append_items => append, make_room
  implicit none
  private
  public :: row_table, weighted_rows, group_by_key, transpose_rows

  !> Row i is item(first(i):first(i + 1) - 1). A table is built row by row (`append`, at the end
  !> `finish`), by `group_by_key`, or written as a whole.
  type :: row_table
    integer, allocatable :: first(:) !< (rows + 1)
    integer, allocatable :: item(:)
    integer, private :: num_added = 0 !< rows, while the table is built row by row
  contains
    procedure :: append => append_row
    procedure :: finish => finish_rows
    procedure :: num_rows
    procedure :: row
  end type row_table

  !> Rows whose items have weights: row i stands for the sum of weight(k) f(item(k)).
  type, extends(row_table) :: weighted_rows
    real(rk), allocatable :: weight(:) !< (items)
  end type weighted_rows

contains

  !> Adds a row at the end.
  pure subroutine append_row(self, items)
    class(row_table), intent(inout) :: self
    integer, intent(in) :: items(:)
    integer :: num_items
    call make_room(self%first, self%num_added + 1, 1)
    if (self%num_added == 0) self%first(1) = 1
    num_items = self%first(self%num_added + 1) - 1
    call append_items(self%item, num_items, items)
    self%num_added = self%num_added + 1
    self%first(self%num_added + 1) = num_items + 1
  end subroutine append_row

  !> Frees unused memory; no row can be added afterwards.
  pure subroutine finish_rows(self)
    class(row_table), intent(inout) :: self
    if (self%num_added == 0) then
      self%first = [1]
      self%item = [integer ::]
    else
      self%first = self%first(:self%num_added + 1)
      self%item = self%item(:self%first(self%num_added + 1) - 1)
    end if
  end subroutine finish_rows

  !> Number of rows of a finished table.
  pure integer function num_rows(self)
    class(row_table), intent(in) :: self
    num_rows = size(self%first) - 1
  end function num_rows

  !> The items of a row.
  pure function row(self, number) result(items)
    class(row_table), intent(in) :: self
    integer, intent(in) :: number !< of the row
    integer :: items(self%first(number + 1) - self%first(number))
    items = self%item(self%first(number):self%first(number + 1) - 1)
  end function row

  !> Sorts items into rows by their key; within a row they keep their order (a counting sort).
  pure subroutine group_by_key(key, num_keys, table, item)
    integer, intent(in) :: key(:) !< row of each item, 0: the item is left out
    integer, intent(in) :: num_keys
    type(row_table), intent(out) :: table
    integer, intent(in), optional :: item(:) !< default: the positions in `key`
    integer, allocatable :: next(:)
    integer :: i
    call open_rows(key, num_keys, table)
    next = table%first
    do i = 1, size(key)
      if (key(i) == 0) cycle
      table%item(next(key(i))) = i
      next(key(i)) = next(key(i)) + 1
    end do
    if (present(item)) table%item = item(table%item)
  end subroutine group_by_key

  !> Lists the rows that hold each item, in ascending order.
  pure subroutine transpose_rows(rows, num_items, columns)
    type(row_table), intent(in) :: rows
    integer, intent(in) :: num_items !< items are 1 .. num_items
    type(row_table), intent(out) :: columns
    integer, allocatable :: next(:)
    integer :: i, k
    call open_rows(rows%item, num_items, columns)
    next = columns%first
    do i = 1, rows%num_rows()
      do k = rows%first(i), rows%first(i + 1) - 1
        columns%item(next(rows%item(k))) = i
        next(rows%item(k)) = next(rows%item(k)) + 1
      end do
    end do
  end subroutine transpose_rows

  !> Allocates the items of each key.
  pure subroutine open_rows(key, num_keys, table)
    integer, intent(in) :: key(:) !< 0: in no row
    integer, intent(in) :: num_keys
    type(row_table), intent(out) :: table
    integer :: i
    allocate (table%first(num_keys + 1), source=0)
    do i = 1, size(key)
      if (key(i) > 0) table%first(key(i) + 1) = table%first(key(i) + 1) + 1
    end do
    table%first(1) = 1
    do i = 1, num_keys
      table%first(i + 1) = table%first(i) + table%first(i + 1)
    end do
    allocate (table%item(table%first(num_keys + 1) - 1))
  end subroutine open_rows
end module row_tables
