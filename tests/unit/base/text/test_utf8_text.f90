!> Letters of UTF-8, and lines in Latin-1 that become UTF-8.
program test_utf8_text
  use testing, only: check, check_text, test_log
  use utf8_text, only: latin1_of_utf8, letter_of_latin1, make_utf8, num_letters, utf8_width
  implicit none
  character, parameter :: lf = achar(10), latin1 = char(228), other = char(246) !< ae, oe
  character(*), parameter :: umlaut = char(195)//char(164), second = char(195)//char(182)
  character(*), parameter :: mark = char(239)//char(187)//char(191)
  type(test_log) :: log

  log%suite = 'utf8_text'
  call widths()
  call lines()
  call bytes()
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> Letters of one to four bytes; what is no letter of RFC 3629 has no width.
  subroutine widths()
    call check(log, utf8_width('a'//umlaut) == 1, 'one byte')
    call check(log, utf8_width(umlaut//'a') == 2, 'two bytes')
    call check(log, utf8_width(char(226)//char(130)//char(172)) == 3, 'three bytes')
    call check(log, utf8_width(char(240)//char(159)//char(152)//char(128)) == 4, 'four bytes')
    call check(log, utf8_width(umlaut(:1)) == 0, 'the end of the text within a letter')
    call check(log, utf8_width(umlaut(2:)) == 0, 'the second byte of a letter')
    call check(log, utf8_width(latin1//'bc') == 0, 'a letter of Latin-1')
    call check(log, utf8_width(char(192)//char(128)) == 0, 'zero in two bytes')
    call check(log, utf8_width(char(224)//char(128)//char(128)) == 0, 'zero in three bytes')
    call check(log, utf8_width(char(237)//char(160)//char(128)) == 0, 'half a pair of UTF-16')
    call check(log, utf8_width(char(240)//char(128)//char(128)//char(128)) == 0, 'zero in four')
    call check(log, utf8_width(char(244)//char(144)//char(128)//char(128)) == 0, 'above U+10FFFF')
    call check(log, num_letters('a'//umlaut//latin1//'b') == 4, 'number of letters')
    call check(log, num_letters('') == 0, 'no letters')
  end subroutine widths

  !> Lines that are not UTF-8 become UTF-8, the others stay.
  subroutine lines()
    call check_text(log, utf8_of(''), '', 'empty')
    call check_text(log, utf8_of('a'//lf//'b'), 'a'//lf//'b', 'ASCII')
    call check_text(log, utf8_of('a'//umlaut//lf), 'a'//umlaut//lf, 'UTF-8')
    call check_text(log, utf8_of('a'//latin1//lf//other), 'a'//umlaut//lf//second, 'Latin-1')
    call check_text(log, utf8_of(umlaut//lf//other//lf//umlaut), umlaut//lf//second//lf//umlaut, &
                    'a line of Latin-1 in UTF-8')
    call check_text(log, utf8_of(mark//latin1, 4), mark//umlaut, 'Latin-1 below a mark of UTF-8')
    call check_text(log, utf8_of(mark, 4), mark, 'the mark alone')
  end subroutine lines

  !> Bytes of Latin-1 and letters of UTF-8 are the same two ways.
  subroutine bytes()
    integer :: i
    logical :: is_same
    is_same = .true.
    do i = 128, 255
      is_same = is_same .and. utf8_width(letter_of_latin1(char(i))) == 2 .and. &
                latin1_of_utf8('a'//letter_of_latin1(char(i))) == 'a'//char(i)
    end do
    call check(log, is_same, 'all bytes')
    call check_text(log, letter_of_latin1(latin1), umlaut, 'a letter')
    call check_text(log, latin1_of_utf8(char(196)//char(128)), char(196)//char(128), &
                    'a letter that Latin-1 has not')
  end subroutine bytes

  !> A text after make_utf8.
  function utf8_of(text, start) result(new)
    character(*), intent(in) :: text
    integer, intent(in), optional :: start
    character(:), allocatable :: new
    integer :: first
    first = 1
    if (present(start)) first = start
    new = text
    call make_utf8(new, first)
  end function utf8_of
end program test_utf8_text
