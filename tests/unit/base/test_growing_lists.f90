!> Growing lists against arrays of known length.
program test_growing_lists
  use growing_lists, only: append, make_room
  use kinds, only: rk
  use testing, only: check, test_log
  implicit none
  type(test_log) :: log
  log%suite = 'growing_lists'
  call entries()
  call columns()
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> One by one and several at once, from a list that is not allocated; room at most doubles.
  subroutine entries()
    integer, allocatable :: list(:)
    real(rk), allocatable :: values(:)
    integer :: i, used, num_values
    used = 0
    num_values = 0
    do i = 1, 1000
      call append(list, used, i)
      call append(values, num_values, 0.5_rk*i)
    end do
    call check(log, used == 1000 .and. all(list(:used) == [(i, i=1, 1000)]), 'integers')
    call check(log, all(abs(values(:num_values) - [(0.5_rk*i, i=1, 1000)]) <= 0.0_rk), 'reals')
    call check(log, size(list) <= 2*used, 'at most half of the room is empty')
    call append(list, used, [(-i, i=1, 5000)])
    call check(log, used == 6000 .and. all(list(1001:used) == [(-i, i=1, 5000)]), 'several')
    call append(list, used, list(1:0))
    call check(log, used == 6000, 'none')
  end subroutine entries

  !> The columns of a table; what is in use stays.
  subroutine columns()
    real(rk), allocatable :: table(:, :)
    integer :: i
    allocate (table(2, 3))
    table = reshape([(real(i, rk), i=1, 6)], [2, 3])
    call make_room(table, 3, 4)
    call check(log, size(table, 1) == 2 .and. size(table, 2) >= 7, 'shape')
    call check(log, all(abs(table(:, :3) - reshape([(real(i, rk), i=1, 6)], [2, 3])) <= 0.0_rk), &
               'columns in use')
  end subroutine columns
end program test_growing_lists
