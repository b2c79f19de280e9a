!> The ledger as a table: the longest parts, with their shares of the time of the run.
module ledger_text
  use kinds, only: rk
  use run_ledger, only: ledger, ledger_part
  implicit none
  private
  public :: text_of_ledger

  integer, parameter :: most_rows = 14 !< parts that get a row; the rest is summed as 'other'

contains

  !> Rows by decreasing time, below a row of headings.
  function text_of_ledger(costs) result(text)
    type(ledger), intent(in) :: costs
    character(:), allocatable :: text !< lines with new_line between them
    type(ledger_part), allocatable :: parts(:)
    real(rk) :: wall_time
    integer, allocatable :: order(:)
    integer :: i, num_rows
    call costs%read_parts(parts, wall_time)
    call sort_by_time(parts, order)
    num_rows = merge(size(order), most_rows - 1, size(order) <= most_rows)
    text = '   time [s]  share  memory [MB]     calls  part'
    do i = 1, num_rows
      associate (part => parts(order(i)))
        text = text//new_line('a')//row_of(part%wall_time, part%memory, wall_time)// &
               count_of(part%num_calls)//'  '//part%name()
      end associate
    end do
    if (num_rows == size(order)) return
    associate (rest => parts(order(num_rows + 1:)))
      text = text//new_line('a')//row_of(sum(rest%wall_time), sum(rest%memory), wall_time)// &
             count_of(sum(rest%num_calls))//'  other'
    end associate
  end function text_of_ledger

  !> Time, share and memory of a row.
  pure function row_of(time, memory, wall_time) result(row)
    real(rk), intent(in) :: time !< [s]
    real(rk), intent(in) :: memory !< [MB]
    real(rk), intent(in) :: wall_time !< of the run [s]
    character(:), allocatable :: row
    character(32) :: room
    write (room, '(f11.3,f6.1,a,f13.1)') time, 100.0_rk*time/max(wall_time, tiny(1.0_rk)), '%', &
      memory
    row = trim(room)
  end function row_of

  !> Calls of a row.
  pure function count_of(num_calls) result(column)
    integer, intent(in) :: num_calls
    character(10) :: column
    write (column, '(i10)') num_calls
  end function count_of

  !> Positions of the parts by decreasing time.
  pure subroutine sort_by_time(parts, order)
    type(ledger_part), intent(in) :: parts(:)
    integer, allocatable, intent(out) :: order(:)
    integer :: i
    logical :: is_left(size(parts))
    allocate (order(size(parts)))
    is_left = .true.
    do i = 1, size(parts)
      order(i) = maxloc(parts%wall_time, dim=1, mask=is_left)
      is_left(order(i)) = .false.
    end do
  end subroutine sort_by_time
end module ledger_text
