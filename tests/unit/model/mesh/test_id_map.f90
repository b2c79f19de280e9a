!> Ids found again, whatever their pattern.
program test_id_map
  use testing, only: test_log, check
  use id_map, only: position_table
  implicit none
  type(test_log) :: log
  log%suite = 'id_map'
  call holds_pattern(1, 0, 'dense ids')
  call holds_pattern(4096, 7, 'multiples of a power of two')
  call holds_pattern(10000, -50000000, 'sparse and negative ids')
  call reports_duplicates()
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  subroutine holds_pattern(stride, first, what)
    integer, intent(in) :: stride, first
    character(*), intent(in) :: what
    integer, parameter :: num = 20000
    type(position_table) :: table
    integer :: i, earlier, wrong
    do i = 1, num
      call table%insert(first + stride*i, i, earlier)
    end do
    wrong = 0
    do i = 1, num
      if (table%find(first + stride*i) /= i) wrong = wrong + 1
    end do
    call check(log, wrong == 0, what)
    call check(log, table%find(first) == 0, what//': an unknown id has no position')
  end subroutine holds_pattern

  subroutine reports_duplicates()
    type(position_table) :: table
    integer :: earlier
    call check(log, table%find(3) == 0, 'an empty table knows nothing')
    call table%insert(3, 8, earlier)
    call check(log, earlier == 0, 'a new id is new')
    call table%insert(3, 9, earlier)
    call check(log, earlier == 8, 'the second place learns of the first')
    call check(log, table%find(3) == 8, 'the first place stays')
  end subroutine reports_duplicates
end program test_id_map
