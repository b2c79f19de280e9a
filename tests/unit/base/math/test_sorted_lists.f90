!> Sorting and looking up.
program test_sorted_lists
  use testing, only: test_log, check
  use sorted_lists, only: sorted_unique, contains_position, place_in
  implicit none
  type(test_log) :: log
  integer :: empty(0), i
  log%suite = 'sorted_lists'
  call check(log, size(sorted_unique(empty)) == 0, 'an empty list stays empty')
  call check(log, all(sorted_unique([3, 1, 2, 3, 1]) == [1, 2, 3]), 'sorted, each once')
  call check(log, all(sorted_unique([(mod(7919*i, 1001), i=1, 1001)]) == [(i, i=0, 1000)]), &
             'a permutation is put in order')
  call check(log, contains_position([2, 5, 9], 5), 'a member is found')
  call check(log,.not. contains_position([2, 5, 9], 6), 'a stranger is not')
  call check(log,.not. contains_position(empty, 6), 'nothing is in an empty list')
  call check(log, place_in([2, 5, 9], 9) == 3 .and. place_in([2, 5, 9], 3) == 2, 'a place')
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1
end program test_sorted_lists
