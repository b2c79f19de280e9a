!> Checks cards against the specifications of their keywords. Every fault is reported.
module card_check
  use deck_card, only: card
  use decimal_commas, only: has_decimal_comma, with_hint_of_point
  use diagnostics, only: diagnostic_list, place, severity_error
  use field_text, only: expected_in, names_of_columns, text_or_nothing
  use keyword_spec, only: field, keyword, kind_choice, kind_flag, kind_integer, &
                          kind_real, kind_word, spec_of_variant
  use kinds, only: rk
  use nearest_words, only: nearest_choice, nearest_word
  use parse_text, only: largest_number, parse_integer, parse_real, single_blanks, upper_case
  use utf8_text, only: num_letters
  use write_text, only: as_text
  implicit none
  private
  public :: check_card, check_given_parameters, check_lines, found_no_integer, is_refused, &
            is_too_large, longest_name

  integer, parameter :: most_letters = 80 !< of a name, as in Abaqus
  integer, parameter :: longest_name = 2*most_letters !< bytes: names of files have at most 255
  integer, parameter :: shortest_name = 3 !< letters of an abbreviated parameter

contains

  !> Checks a card against its specification, and stores the specification in the card.
  subroutine check_card(the_card, spec, faults, is_right)
    type(card), intent(inout) :: the_card
    type(keyword), intent(in) :: spec
    type(diagnostic_list), intent(inout) :: faults
    logical, intent(out) :: is_right !< no fault was found
    logical :: has_unknown_choice
    integer :: num_before
    num_before = faults%num_errors
    the_card%spec = spec
    if (allocated(spec%variants)) then
      the_card%spec = spec_of_variant(spec, single_blanks(the_card%word(spec%chooser)))
    end if
    if (spec%asks_for_output) call complete_names(the_card)
    call check_given_parameters(the_card, faults, has_unknown_choice)
    call check_required_parameters(the_card, faults)
    if (.not. has_unknown_choice) then
      call check_line_count(the_card, faults)
      if (.not. spec%checks_own_data) call check_lines(the_card, faults)
    end if
    is_right = faults%num_errors == num_before
  end subroutine check_card

  !> Writes abbreviated names of parameters in full. Where several names begin alike, those with an
  !> effect come first.
  subroutine complete_names(the_card)
    type(card), intent(inout) :: the_card
    integer :: i, j, num_effects, whole
    do i = 1, size(the_card%parameters)
      associate (given => the_card%parameters(i), wanted => the_card%spec%parameters)
        if (len(given%name) < shortest_name .or. position_of(the_card%spec, given%name) > 0) cycle
        whole = 0
        num_effects = 0
        do j = 1, size(wanted)
          if (index(wanted(j)%name, given%name) /= 1) cycle
          if (.not. wanted(j)%has_no_effect) num_effects = num_effects + 1
          if (whole == 0 .or. .not. wanted(j)%has_no_effect) whole = j
        end do
        if (whole == 0 .or. num_effects > 1) cycle
        if (.not. the_card%has(wanted(whole)%name)) given%name = wanted(whole)%name
      end associate
    end do
  end subroutine complete_names

  !> Checks that every given parameter is known and has a valid value.
  subroutine check_given_parameters(the_card, faults, has_unknown_choice)
    type(card), intent(in) :: the_card
    type(diagnostic_list), intent(inout) :: faults
    logical, intent(out) :: has_unknown_choice !< the data lines may then have another meaning
    character(:), allocatable :: problem, nearest
    integer :: i, j
    has_unknown_choice = .false.
    do i = 1, size(the_card%parameters)
      associate (given => the_card%parameters(i))
        j = position_of(the_card%spec, given%name)
        if (j == 0) then
          call fault_unknown_parameter(the_card, i, faults)
          cycle
        end if
        associate (wanted => the_card%spec%parameters(j))
          if (is_refused(wanted)) then
            call the_card%fault_parameter(faults, given%name, given%name//' is not available', &
                                          wanted%instead)
          else if (wanted%has_no_effect) then
            call the_card%ignore(faults, given%name//' has no effect here')
          else if (wanted%kind == kind_flag) then
            if (given%has_value) call the_card%fault_parameter( &
              faults, given%name, given%name//' takes no value', given%name//' alone')
          else if (given%value_first > given%value_last) then
            if (wanted%may_be_bare) cycle
            call the_card%fault_parameter(faults, given%name, given%name//' has no value', &
                                          expected_in(wanted))
          else if (.not. wanted%is_checked_later) then
            call check_word(the_card%text(given%name), wanted, problem, nearest)
            if (len(problem) > 0) call the_card%fault_parameter( &
              faults, given%name, given%name//': '//problem, expected_in(wanted), nearest)
            if (wanted%rules_lines .and. len(problem) > 0) has_unknown_choice = .true.
          end if
        end associate
      end associate
    end do
  end subroutine check_given_parameters

  !> Whether a parameter of other programs is refused, with any value.
  pure logical function is_refused(wanted)
    type(field), intent(in) :: wanted
    is_refused = allocated(wanted%instead) .and. wanted%kind /= kind_choice
  end function is_refused

  !> Reports an unknown parameter at the place of its name; a card that asks for output is read
  !> without it.
  subroutine fault_unknown_parameter(the_card, i, faults)
    type(card), intent(in) :: the_card
    integer, intent(in) :: i !< position of the parameter in the card
    type(diagnostic_list), intent(inout) :: faults
    character(longest_name), allocatable :: names(:)
    character(:), allocatable :: list, nearest
    type(place) :: spot
    integer :: j
    list = ''
    allocate (names(num_parameters(the_card%spec)))
    names = ''
    do j = 1, size(names)
      associate (known => the_card%spec%parameters(j))
        if (is_refused(known)) cycle
        names(j) = known%name
        if (len(list) > 0) list = list//', '
        list = list//known%name
      end associate
    end do
    if (len(list) == 0) list = 'no parameters'
    if (index(list, ',') > 0) list = 'one of '//list
    associate (given => the_card%parameters(i))
      if (the_card%spec%asks_for_output) then
        nearest = nearest_word(given%name, names)
        if (len(nearest) > 0) nearest = "; did you mean '"//nearest//"'?"
        call the_card%ignore(faults, given%name//' has no effect here'//nearest)
        return
      end if
      spot = the_card%lines%spot(given%row, given%first, given%last, the_card%keyword)
      call faults%add(severity_error, spot, "unknown parameter '"//given%name//"'", list, &
                      nearest_word(given%name, names))
    end associate
  end subroutine fault_unknown_parameter

  !> Checks that every required parameter is given.
  subroutine check_required_parameters(the_card, faults)
    type(card), intent(in) :: the_card
    type(diagnostic_list), intent(inout) :: faults
    integer :: i
    do i = 1, num_parameters(the_card%spec)
      associate (wanted => the_card%spec%parameters(i))
        if (.not. wanted%is_required .or. the_card%has(wanted%name)) cycle
        call the_card%fault(faults, 'parameter '//wanted%name//' is missing', &
                            wanted%name//' = '//expected_in(wanted))
      end associate
    end do
  end subroutine check_required_parameters

  !> Checks the number of data lines.
  subroutine check_line_count(the_card, faults)
    type(card), intent(in) :: the_card
    type(diagnostic_list), intent(inout) :: faults
    character(:), allocatable :: wanted
    associate (spec => the_card%spec)
      if (the_card%num_lines > spec%most_lines) then
        wanted = 'no data lines'
        if (spec%most_lines > 0) wanted = 'at most '//lines_in_words(spec%most_lines)
        call the_card%fault_at(faults, spec%most_lines + 1, 0, &
                               'found '//lines_in_words(the_card%num_lines), wanted)
      else if (spec%new_clears .and. the_card%num_lines == 0 &
               .and. the_card%word('OP') == 'NEW') then
        return
      else if (the_card%num_lines < spec%fewest_lines) then
        wanted = lines_in_words(spec%fewest_lines)
        if (spec%most_lines > spec%fewest_lines) wanted = 'at least '//wanted
        if (len(names_of_columns(spec)) > 0) wanted = wanted//': '//names_of_columns(spec)
        call the_card%fault(faults, 'found '//lines_in_words(the_card%num_lines), wanted)
      end if
    end associate
  end subroutine check_line_count

  !> 'no data line', '1 data line', '2 data lines'.
  pure function lines_in_words(num_lines) result(text)
    integer, intent(in) :: num_lines
    character(:), allocatable :: text
    text = as_text(num_lines)//' data lines'
    if (num_lines == 1) text = '1 data line'
    if (num_lines == 0) text = 'no data line'
  end function lines_in_words

  !> Checks every field of every data line against its column.
  subroutine check_lines(the_card, faults)
    type(card), intent(in) :: the_card
    type(diagnostic_list), intent(inout) :: faults
    integer :: line, num_columns, num_fields
    if (.not. allocated(the_card%spec%columns)) return
    num_columns = size(the_card%spec%columns)
    if (num_columns == 0) return
    do line = 1, min(the_card%num_lines, the_card%spec%most_lines)
      num_fields = the_card%num_fields(line)
      if (num_fields > num_columns .and. .not. the_card%spec%repeats_columns) then
        if (.not. has_one_temperature(the_card, line)) then
          call fault_further_columns(the_card, line, faults)
        else if (has_decimal_comma(the_card%line_as_written(line))) then
          call the_card%warn_at(faults, line, num_columns, 'the line has the value '// &
                                the_card%text_at(line, num_columns)//' here and a temperature '// &
                                'of '//the_card%text_at(line, num_fields), 'a point for '// &
                                'decimals: commas separate numbers')
        else if (line == 1) then
          call the_card%ignore(faults, 'the temperature has no effect')
        end if
      end if
      call check_columns(the_card, line, faults)
    end do
  end subroutine check_lines

  !> Whether the further fields are one temperature, the same in all lines.
  pure logical function has_one_temperature(the_card, line) result(is_one)
    type(card), intent(in) :: the_card
    integer, intent(in) :: line !< data line
    integer :: column, i
    column = the_card%spec%temperature_column
    is_one = the_card%num_fields(line) == column .and. the_card%is_real_at(line, column)
    do i = size(the_card%spec%columns) + 1, column - 1
      is_one = is_one .and. abs(the_card%real_at(line, i)) <= 0.0_rk
    end do
    do i = 1, the_card%num_lines
      is_one = is_one .and. the_card%num_fields(i) == column .and. &
               abs(the_card%real_at(i, column) - the_card%real_at(line, column)) <= 0.0_rk
    end do
  end function has_one_temperature

  !> Reports a line with more fields than columns, with the reason if the specification has one.
  subroutine fault_further_columns(the_card, line, faults)
    type(card), intent(in) :: the_card
    integer, intent(in) :: line !< data line
    type(diagnostic_list), intent(inout) :: faults
    character(:), allocatable :: why
    associate (spec => the_card%spec)
      why = text_or_nothing(spec%no_further)
      if (len(why) > 0) why = ': '//why
      call the_card%fault_at(faults, line, size(spec%columns) + 1, &
                             'found '//as_text(the_card%num_fields(line))//' fields'//why, &
                             with_hint_of_point('at most '//as_text(size(spec%columns))//': '// &
                                                names_of_columns(spec), &
                                                the_card%line_as_written(line)))
    end associate
  end subroutine fault_further_columns

  !> Checks the fields of a line against the columns; columns may repeat.
  subroutine check_columns(the_card, line, faults)
    type(card), intent(in) :: the_card
    integer, intent(in) :: line !< data line
    type(diagnostic_list), intent(inout) :: faults
    character(:), allocatable :: problem, nearest, wanted
    integer :: column, number, num_groups, first, last
    associate (columns => the_card%spec%columns)
      num_groups = 1
      if (the_card%spec%repeats_columns) then
        num_groups = max(1, (the_card%num_fields(line) + size(columns) - 1)/size(columns))
      end if
      do number = 1, num_groups*size(columns)
        column = 1 + mod(number - 1, size(columns))
        call the_card%lines%find_field(line, number, first, last)
        if (first > last) then
          if (columns(column)%is_required) then
            call the_card%fault_at(faults, line, number, columns(column)%name//' is missing', &
                                   expected_in(columns(column)))
          end if
          cycle
        end if
        call check_word(the_card%lines%body(first:last), columns(column), problem, nearest)
        if (len(problem) == 0) cycle
        wanted = expected_in(columns(column))
        if (columns(column)%kind == kind_real) then
          wanted = with_hint_of_point(wanted, the_card%line_as_written(line))
        end if
        call the_card%fault_at(faults, line, number, problem, wanted, nearest)
      end do
    end associate
  end subroutine check_columns

  !> Checks a word against the kind and range of its field.
  pure subroutine check_word(word, wanted, problem, nearest)
    character(*), intent(in) :: word !< not empty
    type(field), intent(in) :: wanted
    character(:), allocatable, intent(out) :: problem !< '' for a valid word
    character(:), allocatable, intent(out) :: nearest !< a choice of similar spelling, or ''
    real(rk) :: value
    integer :: number
    logical :: is_right
    problem = ''
    nearest = ''
    select case (wanted%kind)
    case (kind_real)
      call parse_real(word, value, is_right)
      if (is_right .and. abs(value) > largest_number) then
        problem = "found '"//word//"', beyond "//as_text(largest_number)
        return
      end if
      is_right = is_right .and. is_in_range(value, wanted)
    case (kind_integer)
      call parse_integer(word, number, is_right)
      is_right = is_right .and. is_in_range(real(number, rk), wanted)
    case (kind_choice)
      is_right = is_choice(word, text_or_nothing(wanted%choices))
      if (.not. is_right) nearest = nearest_choice(word, text_or_nothing(wanted%choices))
    case (kind_word)
      problem = fault_of_name(word)
      is_right = .true.
    case default
      is_right = .true.
    end select
    if (.not. is_right) problem = "found '"//word//"'"
    if (wanted%kind == kind_integer .and. .not. is_right) problem = found_no_integer(word)
  end subroutine check_word

  !> 'found 'WORD'', of a whole number that no integer holds with the last one.
  pure function found_no_integer(word) result(problem)
    character(*), intent(in) :: word
    character(:), allocatable :: problem
    problem = "found '"//word//"'"
    if (.not. is_too_large(word)) return
    if (word(1:1) == '-') then
      problem = problem//', below the smallest integer, '//as_text(-huge(1))
    else
      problem = problem//', beyond the largest integer, '//as_text(huge(1))
    end if
  end function found_no_integer

  !> Whether a word is a whole number that no integer holds.
  pure logical function is_too_large(word)
    character(*), intent(in) :: word
    real(rk) :: value
    is_too_large = verify(word, '+-0123456789') == 0
    if (.not. is_too_large) return
    call parse_real(word, value, is_too_large)
    is_too_large = is_too_large .and. abs(value) > huge(1)
  end function is_too_large

  !> What is wrong with a name: names are used for files and in HDF5. '' for a good name.
  pure function fault_of_name(word) result(problem)
    character(*), intent(in) :: word
    character(:), allocatable :: problem
    integer :: i
    problem = ''
    if (num_letters(word) > most_letters) then
      problem = 'a name of '//as_text(num_letters(word))//' letters, more than '// &
                as_text(most_letters)
    else if (len(word) > longest_name) then
      problem = 'a name of '//as_text(len(word))//' bytes in UTF-8, more than '// &
                as_text(longest_name)
    else if (word == '.' .or. word == '..') then
      problem = "found '"//word//"', which is no name"
    else if (any([(ichar(word(i:i)) < ichar(' '), i=1, len(word))])) then
      problem = 'a name with a control character'
    end if
  end function fault_of_name

  !> Whether the value lies in the range of the field.
  pure logical function is_in_range(value, wanted)
    real(rk), intent(in) :: value
    type(field), intent(in) :: wanted
    is_in_range = value >= wanted%lowest .and. value <= wanted%highest
    if (wanted%excludes_lowest) is_in_range = is_in_range .and. value > wanted%lowest
    if (wanted%excludes_highest) is_in_range = is_in_range .and. value < wanted%highest
  end function is_in_range

  !> Whether the word is one of the choices, regardless of case.
  pure logical function is_choice(word, choices)
    character(*), intent(in) :: word
    character(*), intent(in) :: choices !< 'A | B'
    is_choice = index('| '//choices//' |', '| '//single_blanks(upper_case(word))//' |') > 0
  end function is_choice

  !> Position of a parameter in the specification, 0 for an unknown one.
  pure integer function position_of(spec, name) result(found)
    type(keyword), intent(in) :: spec
    character(*), intent(in) :: name
    integer :: i
    found = 0
    do i = 1, num_parameters(spec)
      if (spec%parameters(i)%name == name) found = i
    end do
  end function position_of

  !> Names of the parameters of a keyword.
  pure integer function num_parameters(spec)
    type(keyword), intent(in) :: spec
    num_parameters = 0
    if (allocated(spec%parameters)) num_parameters = size(spec%parameters)
  end function num_parameters
end module card_check
