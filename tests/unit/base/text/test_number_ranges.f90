!> Runs of numbers are drawn together, and only they.
program test_number_ranges
  use number_ranges, only: as_ranges
  use testing, only: check_text, test_log
  implicit none
  type(test_log) :: log

  log%suite = 'number_ranges'
  call check_text(log, as_ranges([integer ::]), '', 'none')
  call check_text(log, as_ranges([7]), '7', 'one')
  call check_text(log, as_ranges([7, 8]), '7-8', 'two neighbours')
  call check_text(log, as_ranges([1, 2, 3, 7, 9, 10]), '1-3, 7, 9-10', 'runs and single ones')
  call check_text(log, as_ranges([1, 3, 5]), '1, 3, 5', 'no neighbours')
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1
end program test_number_ranges
