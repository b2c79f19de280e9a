!> Numbers of texts against the order in which they were added.
program test_text_table
  use testing, only: check, test_log
  use text_table, only: text_numbers
  use write_text, only: as_text
  implicit none
  type(test_log) :: log
  log%suite = 'text_table'
  call many_texts()
  call odd_texts()
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> The table grows several times; each text keeps its number.
  subroutine many_texts()
    type(text_numbers) :: numbers
    integer :: i, number, wrong
    call check(log, numbers%find('A') == 0, 'empty table')
    wrong = 0
    do i = 1, 5000
      call numbers%find_or_add('SET_'//as_text(i), number)
      if (number /= i) wrong = wrong + 1
    end do
    do i = 1, 5000
      call numbers%find_or_add('SET_'//as_text(i), number)
      if (number /= i .or. numbers%find('SET_'//as_text(i)) /= i) wrong = wrong + 1
    end do
    call check(log, wrong == 0, 'numbers in the order of the texts')
    call check(log, numbers%find('SET_5001') == 0, 'unknown text')
  end subroutine many_texts

  !> Fortran pads the shorter of two texts with blanks; the table does not.
  subroutine odd_texts()
    type(text_numbers) :: numbers
    integer :: first, second, none
    call numbers%find_or_add('A', first)
    call numbers%find_or_add('A ', second)
    call numbers%find_or_add('', none)
    call check(log, first == 1 .and. second == 2 .and. none == 3, 'blanks count')
    call check(log, numbers%find('') == 3, 'the empty text')
  end subroutine odd_texts
end program test_text_table
