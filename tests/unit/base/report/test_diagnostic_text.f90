!> What a person reads about a fault, letter by letter.
program test_diagnostic_text
  use diagnostic_text, only: remarks_for_log, text_of_errors, text_of_warnings
  use diagnostics, only: diagnostic_list, place, severity_error, severity_ignored, &
                         severity_warning
  use kinds, only: rk
  use testing, only: check, check_text, test_log
  use write_text, only: as_text
  implicit none
  character, parameter :: lf = achar(10), tab = achar(9)
  character(*), parameter :: umlaut = char(195)//char(188)
  type(test_log) :: log
  log%suite = 'diagnostic_text'
  call plain_fault()
  call two_places()
  call odd_lines()
  call long_line()
  call many()
  call order()
  call numbers()
  call remarks()
  call odd_letters()
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> A place in a file.
  function spot_of(line, column, length, source) result(spot)
    integer, intent(in) :: line, column, length
    character(*), intent(in) :: source
    type(place) :: spot
    spot%file = 'dam.inp'
    spot%line = line
    spot%column = column
    spot%length = length
    spot%keyword = 'ELASTIC'
    spot%source = source
  end function spot_of

  !> Line, carets, nearest word.
  subroutine plain_fault()
    type(diagnostic_list) :: list
    call check(log,.not. list%has_errors() .and. text_of_errors(list) == '', 'no faults')
    call list%add(severity_warning, spot_of(1, 1, 1, 'x'), 'odd')
    call list%add(severity_ignored, spot_of(2, 1, 1, 'x'), 'has no effect here')
    call check(log,.not. list%has_errors(), 'warnings are no errors')
    call check_text(log, text_of_warnings(list), 'dam.inp:1: *ELASTIC: warning: odd'//lf// &
                    'dam.inp:2: *ELASTIC: warning: has no effect here', 'warnings')
    call list%add(severity_error, spot_of(12, 2, 4, ' TIPE = x'), "unknown parameter 'TIPE'", &
                  'TYPE', 'TYPE')
    call check_text(log, text_of_errors(list), 'dam.inp:12: *ELASTIC: unknown parameter '// &
                    "'TIPE'; expected TYPE; did you mean 'TYPE'?"//lf// &
                    '   12 |  TIPE = x'//lf//'      |  ^^^^', 'fault')
    call check_text(log, text_of_warnings(list, is_named=.true.), &
                    'dam.inp:1: *ELASTIC: warning: odd'//lf// &
                    'dam.inp:2: *ELASTIC: warning: has no effect here [no-effect]', 'named')
    call check_text(log, text_of_errors(list, is_named=.true.), 'dam.inp:12: *ELASTIC: unknown '// &
                    "parameter 'TIPE'; expected TYPE; did you mean 'TYPE'? [unknown-parameter]"// &
                    lf//'   12 |  TIPE = x'//lf//'      |  ^^^^', 'named fault')
  end subroutine plain_fault

  !> Two places that clash are both shown.
  subroutine two_places()
    type(diagnostic_list) :: list
    call list%add(severity_error, spot_of(100, 1, 1, '7, 1.'), 'node 7 is defined twice', &
                  first=spot_of(9, 1, 1, '7, 2.'))
    call check_text(log, text_of_errors(list), 'dam.inp:100: *ELASTIC: node 7 is defined twice'// &
                    lf//'  100 | 7, 1.'//lf//'      | ^'//lf//'  first defined here: dam.inp:9'// &
                    lf//'    9 | 7, 2.'//lf//'      | ^', 'both places')
  end subroutine two_places

  !> Tabs, letters of several bytes, control letters, the end of the line.
  subroutine odd_lines()
    type(diagnostic_list) :: list
    type(place) :: spot
    call list%add(severity_error, spot_of(1, 4, 1, tab//'a,b'), 'w')
    call list%add(severity_error, spot_of(2, 4, 4, umlaut//','//umlaut//umlaut), 'w')
    call list%add(severity_error, spot_of(3, 3, 1, '1,'), 'w')
    call list%add(severity_error, spot_of(4, 1, 1, 'x'//achar(27)//'[2J'), 'w'//achar(7))
    spot%file = 'no.inp'
    call list%add(severity_error, spot, 'cannot read it')
    ! The file that cannot be read comes first: what it should hold is missing elsewhere.
    call check_text(log, text_of_errors(list), 'no.inp: cannot read it'//lf// &
                    'dam.inp:1: *ELASTIC: w'//lf//'    1 | '//tab//'a,b'//lf//'      | '//tab// &
                    '  ^'//lf// &
                    'dam.inp:2: *ELASTIC: w'//lf//'    2 | '//umlaut//','//umlaut//umlaut//lf// &
                    '      |   ^^'//lf// &
                    'dam.inp:3: *ELASTIC: w'//lf//'    3 | 1,'//lf//'      |   ^'//lf// &
                    'dam.inp:4: *ELASTIC: w?'//lf//'    4 | x?[2J'//lf//'      | ^', 'odd lines')
  end subroutine odd_lines

  !> Of a long line the part around the word is shown.
  subroutine long_line()
    type(diagnostic_list) :: list
    character(:), allocatable :: text
    integer :: first
    call list%add(severity_error, &
                  spot_of(1, 501, 3, repeat('x', 500)//'bad'//repeat('y', 500)), 'w')
    text = text_of_errors(list)
    call check(log, len(text) < 300, 'not all of it')
    first = index(text, 'bad')
    call check(log, first > 0, 'the word is shown')
    call check(log, index(text, '^^^') - index(text, lf, back=.true.) == &
               first - index(text, lf), 'carets below it')
  end subroutine long_line

  !> Twenty in full, the rest as a number.
  subroutine many()
    type(diagnostic_list) :: list
    character(:), allocatable :: text
    integer :: i
    do i = 1, 25
      call list%add(severity_error, spot_of(i, 0, 0, 'x'), 'w')
      call list%add(severity_warning, spot_of(i, 0, 0, 'x'), 'w')
    end do
    text = text_of_errors(list)
    call check(log, index(text, 'dam.inp:20:') > 0 .and. index(text, 'dam.inp:21:') == 0, 'twenty')
    call check_text(log, text(index(text, lf, back=.true.) + 1:), &
                    'and 5 more in lines 21 to 25: *ELASTIC: w', 'the rest')
    call check(log, list%num_warnings == 25, 'every warning is kept')
  end subroutine many

  !> File by file in the order of lines, whatever the order found.
  subroutine order()
    integer, parameter :: lines(6) = [5, 2, 5, 9, 1, 2] !< odd ones in mesh.inp, named first
    integer, parameter :: sorted(6) = [5, 1, 3, 2, 6, 4]
    type(diagnostic_list) :: list
    type(place) :: spot
    character(:), allocatable :: text
    integer :: i, last, found
    do i = 1, size(lines)
      spot = spot_of(lines(i), 0, 0, 'x')
      if (mod(i, 2) == 1) spot%file = 'mesh.inp'
      call list%add(severity_error, spot, 'fault '//as_text(i)//'.')
    end do
    text = text_of_errors(list)
    last = 0
    do i = 1, size(sorted)
      found = index(text, 'fault '//as_text(sorted(i))//'.')
      call check(log, found > last, 'fault '//as_text(sorted(i))//' in its turn')
      last = found
    end do
  end subroutine order

  !> Numbers in messages.
  subroutine numbers()
    call check_text(log, as_text(-12), '-12', 'integer')
    call check_text(log, as_text(0.0_rk), '0', 'zero')
    call check_text(log, as_text(0.5_rk), '0.5', 'half')
    call check_text(log, as_text(-1.0_rk), '-1', 'minus one')
    call check_text(log, as_text(100.0_rk), '100', 'hundred')
    call check_text(log, as_text(2.2e10_rk), '2.2e10', 'large')
    call check_text(log, as_text(1.0e-5_rk), '1e-5', 'small')
    call check_text(log, as_text(1.0_rk/3.0_rk), '0.333333', 'a third')
    call check_text(log, as_text(999999.4_rk), '999999', 'six digits')
  end subroutine numbers

  !> The log has the warnings first, whatever their order, then the ignored cards.
  subroutine remarks()
    type(diagnostic_list) :: list
    call check_text(log, remarks_for_log(list), '', 'no remarks')
    call list%add(severity_ignored, spot_of(3, 1, 1, 'x'), 'has no effect')
    call list%add(severity_warning, spot_of(4, 1, 1, 'x'), 'is odd')
    call list%add(severity_ignored, spot_of(5, 1, 1, 'x'), 'has none either')
    call check_text(log, remarks_for_log(list), lf//'warnings of the deck'//lf// &
                    text_of_warnings(list, .true., severity_warning)//lf//'ignored input'//lf// &
                    text_of_warnings(list, .true., severity_ignored), 'remarks')
    call check(log, index(remarks_for_log(list), 'dam.inp:3: *ELASTIC: warning: has no') > &
               index(remarks_for_log(list), 'ignored input'), 'ignored cards below their heading')
  end subroutine remarks

  !> No control character is shown, and no part of a letter where a long line is cut.
  subroutine odd_letters()
    type(diagnostic_list) :: list, start, ending, named
    type(place) :: spot
    character(*), parameter :: csi = char(194)//char(155) !< terminals obey U+009B
    call list%add(severity_error, spot_of(1, 4, 1, 'a'//csi//'bc'), 'is odd')
    call check_text(log, text_of_errors(list), 'dam.inp:1: *ELASTIC: is odd'//lf// &
                    '    1 | a?bc'//lf//'      |   ^', 'a control character above 127')
    call start%add(severity_error, spot_of(1, 2, 2, 'a'//repeat(umlaut, 150)), 'is long')
    call check(log, index(text_of_errors(start), '| a'//repeat(umlaut, 50)//'...'//lf) > 0, &
               'whole letters at the end of what is shown')
    call ending%add(severity_error, spot_of(1, 301, 1, repeat(umlaut, 150)//'z'), 'is long')
    spot = spot_of(1, 0, 0, 'x')
    spot%keyword = 'A'//csi//'B'
    call named%add(severity_error, spot, 'is odd')
    call check(log, index(text_of_errors(named), '*A?B: is odd') > 0, 'a keyword')
    call check(log, index(text_of_errors(ending), '| ...'//repeat(umlaut, 50)//'z'//lf) > 0, &
               'whole letters at the start of what is shown')
  end subroutine odd_letters
end program test_diagnostic_text
