!> From the lines of a deck to its cards.
module deck_lexer
  use card_lines, only: file_name, line_origin
  use deck_card, only: card, card_parameter
  use deck_source, only: names_abaqus, read_source, source_line, source_text, spot_in_source
  use deck_words, only: next_word, split_parameter, strip_quotes
  use diagnostics, only: diagnostic_list, severity_error
  use keyword_spec, only: find_spec, keyword
  use parse_text, only: single_blanks, upper_case
  implicit none
  private
  public :: read_cards

  character(*), parameter :: quotes = "'"//'"'

contains

  !> Reads a deck with all included files and splits it into cards.
  !>
  !> A keyword line that ends in a comma continues in the next line if that line holds parameters: a
  !> '=', or first a parameter that `specs` has for the keyword. Else the comma is ignored.
  subroutine read_cards(path, specs, cards, faults, is_from_cae)
    character(*), intent(in) :: path !< of the deck
    type(keyword), intent(in) :: specs(:) !< of all keywords
    type(card), allocatable, intent(out) :: cards(:) !< in the order of the deck
    type(diagnostic_list), intent(inout) :: faults
    logical, intent(out), optional :: is_from_cae !< the file names Abaqus/CAE as its author
    type(source_text) :: source
    integer :: first, last, i
    call read_source(path, source, faults)
    if (present(is_from_cae)) is_from_cae = names_abaqus(source)
    call fault_headless_data(source, faults)
    allocate (cards(count(source%lines(:source%num_lines)%is_keyword)))
    last = 0
    do i = 1, size(cards)
      first = last + 1
      do while (.not. source%lines(first)%is_keyword)
        first = first + 1
      end do
      last = first
      do while (last < source%num_lines)
        if (source%lines(last + 1)%is_keyword) exit
        last = last + 1
      end do
      call read_card(source, source%lines(first:last), specs, cards(i), faults)
    end do
  end subroutine read_cards

  !> Reports data before the first keyword.
  subroutine fault_headless_data(source, faults)
    type(source_text), intent(in) :: source
    type(diagnostic_list), intent(inout) :: faults
    if (source%num_lines == 0) return
    if (source%lines(1)%is_keyword) return
    associate (line => source%lines(1))
      call faults%add(severity_error, &
                      spot_in_source(source, line, 1, line%last - line%first + 1, ''), &
                      'data above the first keyword', "a line that begins with '*'")
    end associate
  end subroutine fault_headless_data

  !> Makes a card of its lines.
  subroutine read_card(source, lines, specs, new, faults)
    type(source_text), intent(in) :: source
    type(source_line), intent(in) :: lines(:) !< the lines up to the next keyword
    type(keyword), intent(in) :: specs(:)
    type(card), intent(out) :: new
    type(diagnostic_list), intent(inout) :: faults
    integer :: row
    call copy_lines(source, lines, new)
    call read_keyword(new)
    new%lines%num_heads = 1
    call read_parameters(new, 1, faults)
    do while (new%lines%num_heads < size(lines))
      row = new%lines%num_heads + 1
      if (.not. goes_on(new, row, specs)) exit
      new%lines%num_heads = row
      call read_parameters(new, row, faults)
    end do
    new%num_lines = size(lines) - new%lines%num_heads
    call find_fields(new)
  end subroutine read_card

  !> Copies the text of a card, so that the card does not need the deck.
  subroutine copy_lines(source, lines, new)
    type(source_text), intent(in) :: source
    type(source_line), intent(in) :: lines(:)
    type(card), intent(inout) :: new
    integer :: row, last, file, position
    allocate (new%lines%rows(size(lines)), new%lines%files(0))
    file = 0
    position = 0
    allocate (character(sum(lines%last - lines%first + 1)) :: new%lines%body)
    last = 0
    do row = 1, size(lines)
      associate (origin => new%lines%rows(row), line => lines(row))
        origin%number = line%number
        origin%first = last + 1
        origin%last = last + line%last - line%first + 1
        last = origin%last
        new%lines%body(origin%first:last) = source%files(line%file)%text(line%first:line%last)
      end associate
      if (lines(row)%file /= file) then
        file = lines(row)%file
        call name_file(new%lines%files, source%files(file)%path, position)
      end if
      new%lines%rows(row)%file = position
    end do
  end subroutine copy_lines

  !> Position of a file's name in the list of the card; a new name is added.
  subroutine name_file(files, path, position)
    type(file_name), allocatable, intent(inout) :: files(:)
    character(*), intent(in) :: path
    integer, intent(out) :: position
    do position = 1, size(files)
      if (files(position)%path == path) return
    end do
    files = [files, file_name(path)]
    position = size(files)
  end subroutine name_file

  !> Reads the keyword of a card.
  subroutine read_keyword(new)
    type(card), intent(inout) :: new
    integer :: position, first, last
    associate (line => new%lines%body(:new%lines%rows(1)%last))
      position = 1
      call next_word(line, position, first, last)
      new%keyword = single_blanks(upper_case(line(first + 1:last)))
    end associate
    allocate (new%parameters(0))
  end subroutine read_keyword

  !> Whether the keyword continues in this line.
  logical function goes_on(new, row, specs)
    type(card), intent(in) :: new
    integer, intent(in) :: row !< of the line
    type(keyword), intent(in) :: specs(:)
    integer :: spec, position, first, last, i
    goes_on = .false.
    associate (body => new%lines%body, origin => new%lines%rows(row))
      i = new%lines%rows(row - 1)%last
      if (body(i:i) /= ',') return
      spec = find_spec(specs, new%keyword)
      position = 1
      associate (line => body(origin%first:origin%last))
        if (spec > 0) then
          if (.not. allocated(specs(spec)%parameters)) return
          if (size(specs(spec)%parameters) == 0) return
          call next_word(line, position, first, last)
          do i = 1, size(specs(spec)%parameters)
            goes_on = goes_on .or. &
                      specs(spec)%parameters(i)%name == single_blanks(upper_case(line(first:last)))
          end do
        end if
        goes_on = goes_on .or. index(line, '=') > 0
      end associate
    end associate
  end function goes_on

  !> Reads the parameters in one line of the keyword.
  subroutine read_parameters(new, row, faults)
    type(card), intent(inout) :: new
    integer, intent(in) :: row !< of the line
    type(diagnostic_list), intent(inout) :: faults
    integer :: position, first, last, equals, key_last, offset, value_first, value_last
    type(card_parameter) :: given
    offset = new%lines%rows(row)%first - 1
    position = 1
    associate (line => new%lines%body(offset + 1:new%lines%rows(row)%last))
      if (row == 1) call next_word(line, position, first, last)
      do while (position <= len(line))
        call next_word(line, position, first, last)
        if (first > last) cycle
        call split_parameter(line, first, last, equals, key_last, value_first, value_last)
        given%name = single_blanks(upper_case(line(first:key_last)))
        given%row = row
        given%first = offset + first
        given%last = offset + key_last
        given%has_value = equals > 0
        given%value_first = offset + value_first
        given%value_last = offset + value_last
        call add_parameter(new, given, faults)
      end do
    end associate
  end subroutine read_parameters

  !> Adds a parameter; a repeated parameter or an open quote is a fault.
  subroutine add_parameter(new, given, faults)
    type(card), intent(inout) :: new
    type(card_parameter), intent(in) :: given
    type(diagnostic_list), intent(inout) :: faults
    if (has_open_quote(new%lines%body(given%value_first:given%value_last))) then
      call faults%add(severity_error, &
                      new%lines%spot(given%value_row, given%value_first, given%value_last, &
                                     new%keyword), 'a quote is not closed')
    end if
    if (new%has(given%name)) then
      call faults%add(severity_error, &
                      new%lines%spot(given%row, given%first, given%last, new%keyword), &
                      "parameter '"//given%name//"' is given twice", first=new%place_of(given%name))
    else
      new%parameters = [new%parameters, given]
    end if
  end subroutine add_parameter

  !> Whether a value begins with a quote. Those around a value are not in it any more; a quoted name
  !> before a point, as "Part 1-1".Set, keeps its quotes.
  pure logical function has_open_quote(value)
    character(*), intent(in) :: value
    has_open_quote = .false.
    if (scan(value, quotes) /= 1) return
    has_open_quote = index(value(2:), value(:1)//'.') == 0
  end function has_open_quote

  !> Finds the fields of all data lines.
  subroutine find_fields(new)
    type(card), intent(inout) :: new
    integer, allocatable :: field_first(:), field_last(:)
    integer :: row, num_used
    num_used = count_commas(new) + new%num_lines
    allocate (field_first(num_used), field_last(num_used))
    num_used = 0
    do row = new%lines%num_heads + 1, size(new%lines%rows)
      associate (origin => new%lines%rows(row))
        origin%first_field = num_used + 1
        call split_line(new%lines%body(origin%first:origin%last), origin, &
                        field_first(num_used + 1:), field_last(num_used + 1:))
        num_used = num_used + origin%num_fields
      end associate
    end do
    new%lines%field_first = field_first(:num_used)
    new%lines%field_last = field_last(:num_used)
  end subroutine find_fields

  !> An upper bound of the number of fields.
  pure integer function count_commas(new) result(num_commas)
    type(card), intent(in) :: new
    integer :: i
    num_commas = 0
    do i = 1, len(new%lines%body)
      if (new%lines%body(i:i) == ',') num_commas = num_commas + 1
    end do
  end function count_commas

  !> Finds the fields of a data line, without empty fields at the end.
  pure subroutine split_line(line, origin, field_first, field_last)
    character(*), intent(in) :: line
    type(line_origin), intent(inout) :: origin
    integer, intent(inout) :: field_first(:), field_last(:) !< from the first field of the line on
    integer :: position, first, last, i
    position = 1
    i = 0
    origin%num_fields = 0
    do while (position <= len(line))
      call next_word(line, position, first, last)
      call strip_quotes(line, first, last)
      i = i + 1
      field_first(i) = origin%first - 1 + first
      field_last(i) = origin%first - 1 + last
      if (first <= last) origin%num_fields = i
    end do
  end subroutine split_line
end module deck_lexer
