!> Decks as people write them: cards, parameters, fields, places, includes, broken lines.
program test_deck_lexer
  use card_reader, only: field_reader, find_record
  use deck_card, only: card
  use deck_lexer, only: read_cards
  use diagnostic_text, only: text_of_errors
  use diagnostics, only: diagnostic_list, place
  use keyword_spec, only: field, keyword, kind_flag, kind_word
  use kinds, only: rk
  use testing, only: check, check_close, check_text, repeat_chance, test_log
  implicit none
  character, parameter :: lf = achar(10), cr = achar(13), tab = achar(9)
  type(test_log) :: log
  log%suite = 'deck_lexer'
  call repeat_chance(1)
  call plain_cards()
  call odd_spellings()
  call quoted_words()
  call long_keyword_lines()
  call stray_commas()
  call bytes_of_other_worlds()
  call places()
  call repeated_parameters()
  call includes()
  call broken_includes()
  call streams_and_records()
  call broken_lines()
  call long_lines()
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> Reads a deck from a text.
  subroutine read_text(text, cards, faults)
    character(*), intent(in) :: text
    type(card), allocatable, intent(out) :: cards(:)
    type(diagnostic_list), intent(out) :: faults
    call write_file('lexer_test.inp', text)
    call read_cards('lexer_test.inp', known_keywords(), cards, faults)
    call delete_file('lexer_test.inp')
  end subroutine read_text

  !> Writes a file byte by byte.
  subroutine write_file(path, text)
    character(*), intent(in) :: path, text
    integer :: unit
    open (newunit=unit, file=path, access='stream', form='unformatted', status='replace', &
          action='write')
    write (unit) text
    close (unit)
  end subroutine write_file

  !> Removes a file.
  subroutine delete_file(path)
    character(*), intent(in) :: path
    integer :: unit
    open (newunit=unit, file=path, action='read')
    close (unit, status='delete')
  end subroutine delete_file

  !> Two keywords with parameters, one without.
  function known_keywords() result(specs)
    type(keyword), allocatable :: specs(:)
    allocate (specs(3))
    specs(1)%name = 'NSET'
    specs(1)%parameters = [field(name='NSET', kind=kind_word), &
                           field(name='GENERATE', kind=kind_flag)]
    specs(2)%name = 'ELASTIC'
    specs(2)%parameters = [field(name='TYPE', kind=kind_word)]
    specs(3)%name = 'HEADING'
    allocate (specs(3)%parameters(0))
  end function known_keywords

  !> Keywords, parameters, numbers.
  subroutine plain_cards()
    type(card), allocatable :: cards(:)
    type(diagnostic_list) :: faults
    call read_text('*NODE, NSET=All'//lf//'1, 0., .5, 1.D+3'//lf//'2, 1e3,,'//lf// &
                   '*NSET, NSET=base, GENERATE'//lf//'1, 9, 2'//lf//'*END STEP'//lf, cards, faults)
    call check(log,.not. faults%has_errors(), 'a plain deck has no faults')
    call check(log, size(cards) == 3, 'three cards')
    call check_text(log, cards(1)%keyword, 'NODE', 'keyword')
    call check_text(log, cards(1)%text('NSET'), 'All', 'text keeps the case')
    call check_text(log, cards(1)%word('NSET'), 'ALL', 'word is upper case')
    call check(log, cards(1)%num_lines == 2, 'two data lines')
    call check(log, cards(1)%num_fields(1) == 4, 'four fields')
    call check(log, cards(1)%num_fields(2) == 2, 'empty fields at the end do not count')
    call check(log, cards(1)%integer_at(1, 1) == 1, 'integer')
    call check_close(log, cards(1)%real_at(1, 3), 0.5_rk, 0.0_rk, 'real')
    call check_close(log, cards(1)%real_at(1, 4), 1000.0_rk, 0.0_rk, 'real with D')
    call check(log, cards(1)%is_empty_at(2, 3), 'empty field')
    call check(log, cards(1)%is_empty_at(2, 99), 'field that is not there')
    call check(log, cards(1)%is_empty_at(9, 1), 'line that is not there')
    call check(log,.not. cards(1)%is_integer_at(1, 2), '0. is no integer')
    call check(log, cards(2)%has('GENERATE'), 'flag')
    call check(log,.not. cards(2)%has('ELSET'), 'no flag')
    call check_text(log, cards(3)%keyword, 'END STEP', 'keyword of two words')
    call check(log, cards(3)%num_lines == 0, 'no data')
  end subroutine plain_cards

  !> Blanks, tabs, comments and blank lines where nobody wants them.
  subroutine odd_spellings()
    type(card), allocatable :: cards(:)
    type(diagnostic_list) :: faults
    call read_text('** a comment, first'//lf//lf//'  * Node  ,  nset =  x'//lf//'**'//lf// &
                   tab//' 1 ,'//tab//'2.0'//tab//', 3. ,'//lf//'   '//tab//lf// &
                   '** inside'//lf//' 2,0,0'//lf//'*endstep'//lf//'*el'//tab//'  file'//lf//'U,', &
                   cards, faults)
    call check(log,.not. faults%has_errors(), 'odd spellings are no faults')
    call check_text(log, cards(1)%keyword, 'NODE', 'blank behind the star')
    call check_text(log, cards(1)%word('NSET'), 'X', 'blanks around =')
    call check(log, cards(1)%num_lines == 2, 'comments and blank lines are dropped')
    call check(log, cards(1)%num_fields(1) == 3, 'trailing comma')
    call check_close(log, cards(1)%real_at(1, 2), 2.0_rk, 0.0_rk, 'tabs around a number')
    call check_text(log, cards(2)%keyword, 'ENDSTEP', 'no blank')
    call check_text(log, cards(3)%keyword, 'EL FILE', 'many blanks')
    call check_text(log, cards(3)%word_at(1, 1), 'U', 'no newline at the end')
  end subroutine odd_spellings

  !> Names in quotes, and quotes that are letters.
  subroutine quoted_words()
    type(card), allocatable :: cards(:)
    type(diagnostic_list) :: faults
    call read_text('*NODE, NSET="My, set = 1" , SYSTEM= '//"'R'"//lf//'"a, b", 2'//lf// &
                   "O'Brien, d'or"//lf//'"open, 3'//lf//'" padded ", ""'//lf, cards, faults)
    call check(log,.not. faults%has_errors(), 'quotes are no faults')
    call check_text(log, cards(1)%text('NSET'), 'My, set = 1', 'quoted value with comma and =')
    call check_text(log, cards(1)%text('SYSTEM'), 'R', 'single quotes')
    call check_text(log, cards(1)%text_at(1, 1), 'a, b', 'quoted field')
    call check(log, cards(1)%integer_at(1, 2) == 2, 'field behind quotes')
    call check_text(log, cards(1)%text_at(2, 1), "O'Brien", 'quote inside a word')
    call check_text(log, cards(1)%text_at(2, 2), "d'or", 'quote inside a word, again')
    call check_text(log, cards(1)%text_at(3, 1), '"open', 'quote that is not closed, in data')
    call check(log, cards(1)%num_fields(3) == 2, 'it does not protect the comma')
    call check_text(log, cards(1)%text_at(4, 1), 'padded', 'blanks inside quotes')
    call read_text('*NODE, NSET="open'//lf, cards, faults)
    call check(log, faults%num_errors == 1, 'quote that is not closed, in a parameter')
  end subroutine quoted_words

  !> Keyword lines that go on.
  subroutine long_keyword_lines()
    type(card), allocatable :: cards(:)
    type(diagnostic_list) :: faults
    call read_text('*NSET,'//lf//'** between'//lf//'NSET=a ,'//cr//lf//'  generate'//lf// &
                   '1,3'//lf//'*OTHER,'//lf//'KEY=3'//lf//'4'//lf, cards, faults)
    call check(log,.not. faults%has_errors(), 'long keyword lines are no faults')
    call check_text(log, cards(1)%word('NSET'), 'A', 'parameter in the second line')
    call check(log, cards(1)%has('GENERATE'), 'flag in the third line')
    call check(log, cards(1)%num_lines == 1, 'data behind')
    call check_text(log, cards(1)%file_and_line(1), 'lexer_test.inp:5', 'line of the data')
    call check(log, cards(2)%integer('KEY') == 3, 'unknown keyword goes on by its =')
    call check(log, cards(2)%integer_at(1, 1) == 4, 'and its data')
  end subroutine long_keyword_lines

  !> A comma behind the keyword line that means nothing.
  subroutine stray_commas()
    type(card), allocatable :: cards(:)
    type(diagnostic_list) :: faults
    call read_text('*ELASTIC,'//lf//'3e10, 0.2'//lf//'*NSET, NSET=b,'//lf//'base, crest'//lf// &
                   '*HEADING,'//lf//'E = 30 GPa, of course'//lf//'*ELASTIC,,TYPE=iso,,'//lf// &
                   '1,,'//lf//'*ELASTIC,'//lf//'*ELASTIC,', cards, faults)
    call check(log,.not. faults%has_errors(), 'stray commas are no faults')
    call check(log, size(cards) == 6, 'cards')
    call check_close(log, cards(1)%real_at(1, 1), 3.0e10_rk, 0.0_rk, 'data behind a stray comma')
    call check_text(log, cards(2)%word_at(1, 2), 'CREST', 'names behind a stray comma')
    call check(log, cards(3)%num_lines == 1, 'text behind a stray comma')
    call check_text(log, cards(4)%word('TYPE'), 'ISO', 'empty parameters')
    call check(log, cards(5)%num_lines == 0 .and. cards(6)%num_lines == 0, 'nothing behind')
  end subroutine stray_commas

  !> Line ends, byte order marks and letters of all kinds.
  subroutine bytes_of_other_worlds()
    type(card), allocatable :: cards(:)
    type(diagnostic_list) :: faults
    character(*), parameter :: mark = char(239)//char(187)//char(191)
    character(*), parameter :: umlaut = char(252), wide_umlaut = char(195)//char(188)
    call read_text(mark//'*HEADING'//cr//lf//'Stauh'//wide_umlaut//'he'//lf//'h'//umlaut//cr//lf// &
                   '*NODE, NSET=s'//wide_umlaut//'d'//cr//lf//'1,2'//cr//lf//cr//lf//'2,3'//cr, &
                   cards, faults)
    call check(log,.not. faults%has_errors(), 'bytes are no faults')
    call check_text(log, cards(1)%keyword, 'HEADING', 'byte order mark')
    call check(log, cards(1)%num_lines == 2, 'heading')
    call check_text(log, cards(2)%text('NSET'), 's'//wide_umlaut//'d', 'name with an umlaut')
    call check(log, cards(2)%integer_at(2, 2) == 3, 'carriage return at the very end')
    call read_text('', cards, faults)
    call check(log, size(cards) == 0 .and. .not. faults%has_errors(), 'empty file')
    call read_text('1, 2'//lf//'3'//lf//'*NODE'//lf, cards, faults)
    call check(log, size(cards) == 1 .and. faults%num_errors == 1, 'data above the first keyword')
  end subroutine bytes_of_other_worlds

  !> Every word has its place.
  subroutine places()
    type(card), allocatable :: cards(:)
    type(diagnostic_list) :: faults
    type(place) :: spot
    call read_text(lf//' *nset, nset = A,'//lf//'  GENERATE'//lf//'1, 22 ,,'//lf, cards, faults)
    spot = cards(1)%place()
    call check(log, spot%line == 2 .and. spot%column == 2 .and. spot%length == 5, 'of the keyword')
    call check_text(log, spot%source, ' *nset, nset = A,', 'line as it is')
    spot = cards(1)%place_of('NSET')
    call check(log, spot%line == 2 .and. spot%column == 16 .and. spot%length == 1, 'of a value')
    spot = cards(1)%place_of('GENERATE')
    call check(log, spot%line == 3 .and. spot%column == 3 .and. spot%length == 8, 'of a flag')
    spot = cards(1)%place_of('NOTHING')
    call check(log, spot%line == 2 .and. spot%column == 2, 'of a parameter that is not there')
    spot = cards(1)%place_at(1, 2)
    call check(log, spot%line == 4 .and. spot%column == 4 .and. spot%length == 2, 'of a field')
    spot = cards(1)%place_at(1, 3)
    call check(log, spot%column == 9 .and. spot%length == 1, 'of a field that is not there')
    spot = cards(1)%place_at(1, 0)
    call check(log, spot%column == 1 .and. spot%length == 8, 'of a line')
    call check_text(log, cards(1)%file_and_line(0), 'lexer_test.inp:2', 'of the card')
  end subroutine places

  !> The second of two equal parameters is reported, with the place of the first.
  subroutine repeated_parameters()
    type(card), allocatable :: cards(:)
    type(diagnostic_list) :: faults
    call read_text('*NSET, NSET=a, GENERATE, nset=b'//lf, cards, faults)
    call check(log, faults%num_errors == 1, 'repeated parameter')
    call check(log, faults%errors(1)%spot%column == 26, 'place of the second')
    call check(log, faults%errors(1)%first%column == 13, 'place of the first')
    call check_text(log, cards(1)%text('NSET'), 'a', 'the first counts')
  end subroutine repeated_parameters

  !> Included lines stand where they are named; paths start at the file that names them.
  subroutine includes()
    type(card), allocatable :: cards(:)
    type(diagnostic_list) :: faults
    call execute_command_line('mkdir -p lexer_test_dir/deeper')
    call write_file('lexer_test_dir/mesh.inc', '2, 0'//lf//'*include , input = deeper/x.inc'//lf// &
                    '4, 0')
    call write_file('lexer_test_dir/deeper/x.inc', '*INCLUDE,'//lf//'INPUT="../n o.inc"'//lf)
    call write_file('lexer_test_dir/n o.inc', '3, 0')
    call read_text('*NODE'//lf//'1, 0'//lf//'*INCLUDE, INPUT=lexer_test_dir/mesh.inc'//lf// &
                   '5, 0'//lf//'*INCLUDE, INPUT=lexer_test_dir/n o.inc'//lf, cards, faults)
    call check(log,.not. faults%has_errors(), 'includes are no faults: '//text_of_errors(faults))
    call check(log, size(cards) == 1, 'included data belong to the keyword above')
    call check(log, cards(1)%num_lines == 6, 'lines of all files')
    call check(log, cards(1)%integer_at(3, 1) == 3 .and. cards(1)%integer_at(5, 1) == 5, 'order')
    call check_text(log, cards(1)%file_and_line(4), 'lexer_test_dir/mesh.inc:3', 'file and line')
    call execute_command_line('rm -r lexer_test_dir')
  end subroutine includes

  !> Files that are missing, name themselves or are not named.
  subroutine broken_includes()
    type(card), allocatable :: cards(:)
    type(diagnostic_list) :: faults
    call read_text('*INCLUDE, INPUT=nowhere.inc'//lf//'*NODE'//lf//'*INCLUDE'//lf// &
                   '*INCLUDE, FILE=x, INPUT=lexer_test.inp'//lf// &
                   '*INCLUDE, INPUT=./lexer_test.inp', cards, faults)
    call check(log, faults%num_errors == 5, 'each broken include is a fault')
    call check_text(log, text_of_errors(faults), 'lexer_test.inp:1: *INCLUDE: cannot read '// &
                    "'nowhere.inc': No such file or directory"//lf// &
                    '    1 | *INCLUDE, INPUT=nowhere.inc'//lf// &
                    '      |                 ^^^^^^^^^^^'//lf// &
                    'lexer_test.inp:3: *INCLUDE: no file is named; expected INPUT=file'//lf// &
                    '    3 | *INCLUDE'//lf//'      | ^^^^^^^^'//lf// &
                    "lexer_test.inp:4: *INCLUDE: unknown parameter 'FILE'; expected INPUT=file"// &
                    lf//'    4 | *INCLUDE, FILE=x, INPUT=lexer_test.inp'//lf// &
                    '      |           ^^^^'//lf// &
                    'lexer_test.inp:4: *INCLUDE: the file includes itself; expected files '// &
                    'that do not include each other'//lf// &
                    '    4 | *INCLUDE, FILE=x, INPUT=lexer_test.inp'//lf// &
                    '      |                         ^^^^^^^^^^^^^^'//lf// &
                    'lexer_test.inp:5: *INCLUDE: the file includes itself; expected files '// &
                    'that do not include each other'//lf// &
                    '    5 | *INCLUDE, INPUT=./lexer_test.inp'//lf// &
                    '      |                 ^^^^^^^^^^^^^^^^', 'their text')
    call check(log, size(cards) == 1, 'the rest is read')
    faults = diagnostic_list()
    call read_cards('no_such_deck.inp', known_keywords(), cards, faults)
    call check_text(log, text_of_errors(faults), &
                    "no_such_deck.inp: cannot read 'no_such_deck.inp': "// &
                    'No such file or directory', 'its text')
    call read_cards('.', known_keywords(), cards, faults)
    call check(log, size(cards) == 0 .and. faults%num_errors == 2, 'a folder')
  end subroutine broken_includes

  !> Data that do not keep to their lines.
  subroutine streams_and_records()
    type(card), allocatable :: cards(:)
    type(diagnostic_list) :: faults
    type(field_reader) :: reader
    integer :: lines(5), fields(5), num_found, next_line, total
    call read_text('*ELEMENT'//lf//'1, 10, 20,'//lf//'30,'//lf//'40'//lf//'2,10,20,30,40,'//lf// &
                   '3,10,20,30,40,50'//lf//'4,10'//lf, cards, faults)
    total = 0
    do while (reader%advance(cards(1)))
      total = total + cards(1)%integer_at(reader%line, reader%field)
    end do
    call check(log, total == 100 + 100 + 150 + 10 + 10, 'every field once')
    call find_record(cards(1), 1, lines, fields, num_found, next_line)
    call check(log, num_found == 5 .and. next_line == 4, 'a record of three lines')
    call check(log, cards(1)%integer_at(lines(5), fields(5)) == 40, 'its last field')
    call find_record(cards(1), 4, lines, fields, num_found, next_line)
    call check(log, num_found == 5 .and. next_line == 5, 'a full line with a trailing comma')
    call find_record(cards(1), 5, lines, fields, num_found, next_line)
    call check(log, num_found == 6 .and. next_line == 6, 'too many fields')
    call find_record(cards(1), 6, lines, fields, num_found, next_line)
    call check(log, num_found == 2 .and. next_line == 7, 'too few fields')
    call check(log, cards(1)%ends_in_comma(1), 'a comma at the end')
    call check(log,.not. cards(1)%ends_in_comma(3), 'no comma at the end')
  end subroutine streams_and_records

  !> Random bytes and words of decks, thrown together: nothing may crash, every word has its place.
  subroutine broken_lines()
    integer, parameter :: num_decks = 300, num_pieces = 40
    character(8), parameter :: pieces(16) = [ &
                               '*       ', '**      ', ',       ', '=       ', "'       ", &
                               '"       ', 'NODE    ', 'NSET    ', '1.5e    ', '-       ', &
                               '*INCLUDE', '=,=     ', '        ', '\       ', "''      ", &
                               '""      ']
    character(:), allocatable :: text
    type(card), allocatable :: cards(:)
    type(diagnostic_list) :: faults
    type(place) :: spot
    real(rk) :: chance(2), value
    integer :: deck, i, j, line
    do deck = 1, num_decks
      text = ''
      do i = 1, num_pieces
        call random_number(chance)
        if (chance(1) < 0.2_rk) then
          text = text//char(int(256*chance(2)))
        else if (chance(1) < 0.4_rk) then
          text = text//lf
        else
          text = text//trim(pieces(1 + int(16*chance(2))))
        end if
      end do
      call read_text(text, cards, faults)
      do i = 1, size(cards)
        spot = cards(i)%place()
        do j = 1, size(cards(i)%parameters)
          spot = cards(i)%place_of(cards(i)%parameters(j)%name)
        end do
        do line = 1, cards(i)%num_lines
          do j = 0, cards(i)%num_fields(line) + 1
            spot = cards(i)%place_at(line, j)
            value = cards(i)%real_at(line, j)
            call cards(i)%fault_at(faults, line, j, "found '"//cards(i)%text_at(line, j)//"'")
          end do
        end do
      end do
      if (len(text_of_errors(faults)) < 0) exit
    end do
    call check(log, deck == num_decks + 1, 'no deck of broken lines crashes the reader')
  end subroutine broken_lines

  !> A line of half a million letters.
  subroutine long_lines()
    integer, parameter :: num_values = 100000
    type(card), allocatable :: cards(:)
    type(diagnostic_list) :: faults
    character(:), allocatable :: text
    text = '*AMPLITUDE, NAME='//repeat('n', 5000)//lf//repeat('0.5, ', num_values)//'bad, 1'//lf
    call read_text(text, cards, faults)
    call check(log, cards(1)%num_fields(1) == num_values + 2, 'fields of a long line')
    call check(log, len(cards(1)%text('NAME')) == 5000, 'a long name')
    call cards(1)%fault_at(faults, 1, num_values + 1, "found 'bad'")
    call check(log, len(text_of_errors(faults)) < 1000, 'the message shows a part of it')
    call check(log, index(text_of_errors(faults), '0.5, bad, 1') > 0, 'the part that matters')
  end subroutine long_lines
end program test_deck_lexer
