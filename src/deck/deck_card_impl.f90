!> Bodies of the card's getters and messages.
submodule(deck_card) deck_card_impl
  use diagnostics, only: severity_error, severity_ignored, severity_warning
  use keyword_spec, only: field
  use parse_text, only: parse_integer, parse_real, upper_case
  implicit none

contains

  module procedure has
    is_given = self%find_parameter(name) > 0
  end procedure has

  module procedure find_parameter
    integer :: i
    index = 0
    if (.not. allocated(self%parameters)) return
    do i = 1, size(self%parameters)
      if (self%parameters(i)%name == name) index = i
    end do
  end procedure find_parameter

  module procedure text
    integer :: i
    i = self%find_parameter(name)
    if (i > 0) then
      value = self%body(self%parameters(i)%value_first:self%parameters(i)%value_last)
    else
      value = ''
    end if
    if (value == '') value = default_of_parameter(self%spec, name)
  end procedure text

  module procedure word
    value = self%text(name)
    value = upper_case(value)
  end procedure word

  module procedure real_of
    logical :: is_number
    call parse_real(self%text(name), value, is_number)
  end procedure real_of

  module procedure integer_of
    logical :: is_number
    call parse_integer(self%text(name), value, is_number)
  end procedure integer_of

  module procedure num_fields
    count = self%rows(self%num_heads + line)%num_fields
  end procedure num_fields

  module procedure is_empty_at
    integer :: first, last
    call find_field(self, line, field, first, last)
    is_empty = first > last
  end procedure is_empty_at

  module procedure text_at
    integer :: first, last
    call find_field(self, line, field, first, last)
    if (first > last) then
      value = default_of_column(self%spec, field)
    else
      value = self%body(first:last)
    end if
  end procedure text_at

  module procedure word_at
    value = self%text_at(line, field)
    value = upper_case(value)
  end procedure word_at

  module procedure real_at
    integer :: first, last
    logical :: is_number
    call find_field(self, line, field, first, last)
    is_number = .false.
    if (first <= last) call parse_real(self%body(first:last), value, is_number)
    if (.not. is_number) call parse_real(default_of_column(self%spec, field), value, is_number)
  end procedure real_at

  module procedure integer_at
    integer :: first, last
    logical :: is_number
    call find_field(self, line, field, first, last)
    is_number = .false.
    if (first <= last) call parse_integer(self%body(first:last), value, is_number)
    if (.not. is_number) call parse_integer(default_of_column(self%spec, field), value, is_number)
  end procedure integer_at

  module procedure is_real_at
    integer :: first, last
    real(rk) :: value
    call find_field(self, line, field, first, last)
    call parse_real(self%body(first:last), value, is_real)
  end procedure is_real_at

  module procedure is_integer_at
    integer :: first, last, value
    call find_field(self, line, field, first, last)
    call parse_integer(self%body(first:last), value, is_integer)
  end procedure is_integer_at

  module procedure ends_in_comma
    integer :: last
    associate (row => self%rows(self%num_heads + line))
      last = row%first - 1 + len_trim(self%body(row%first:row%last))
      ends_so = .false.
      if (last >= row%first) ends_so = self%body(last:last) == ','
    end associate
  end procedure ends_in_comma

  module procedure place_of_card
    integer :: star, tail
    associate (row => self%rows(1))
      star = index(self%body(row%first:row%last), '*')
      tail = index(self%body(row%first:row%last)//',', ',') - 1
      tail = len_trim(self%body(row%first:row%first + tail - 1))
    end associate
    spot = place_in_row(self, 1, self%rows(1)%first + star - 1, self%rows(1)%first + tail - 1)
  end procedure place_of_card

  module procedure place_of
    integer :: i
    i = self%find_parameter(name)
    if (i == 0) then
      spot = self%place()
    else
      associate (given => self%parameters(i))
        if (given%value_first <= given%value_last) then
          spot = place_in_row(self, given%value_row, given%value_first, given%value_last)
        else
          spot = place_in_row(self, given%row, given%first, given%last)
        end if
      end associate
    end if
  end procedure place_of

  module procedure place_at
    integer :: first, last, row
    row = self%num_heads + line
    if (field == 0) then
      first = self%rows(row)%first
      last = self%rows(row)%last
    else if (field > self%rows(row)%num_fields) then
      first = self%rows(row)%last + 1
      last = first
    else
      call find_field(self, line, field, first, last)
      last = max(first, last)
    end if
    spot = place_in_row(self, row, first, last)
  end procedure place_at

  module procedure file_and_line
    character(12) :: number
    integer :: row
    row = 1
    if (line > 0) row = self%num_heads + line
    write (number, '(i0)') self%rows(row)%number
    name = self%files(self%rows(row)%file)%path//':'//trim(number)
  end procedure file_and_line

  module procedure fault
    call faults%add(severity_error, self%place(), problem, expected, nearest, first)
  end procedure fault

  module procedure fault_parameter
    call faults%add(severity_error, self%place_of(name), problem, expected, nearest, first)
  end procedure fault_parameter

  module procedure fault_at
    call faults%add(severity_error, self%place_at(line, field), problem, expected, nearest, first)
  end procedure fault_at

  module procedure warn
    call faults%add(severity_warning, self%place(), problem, expected)
  end procedure warn

  module procedure ignore
    call faults%add(severity_ignored, self%place(), why)
  end procedure ignore

  !> Bytes of a field in the body; first > last where it is empty or missing.
  pure subroutine find_field(self, line, number, first, last)
    class(card), intent(in) :: self
    integer, intent(in) :: line, number !< data line and field
    integer, intent(out) :: first, last
    integer :: i
    first = 1
    last = 0
    if (line < 1 .or. line > self%num_lines) return
    associate (row => self%rows(self%num_heads + line))
      if (number < 1 .or. number > row%num_fields) return
      i = row%first_field + number - 1
      first = self%field_first(i)
      last = self%field_last(i)
    end associate
  end subroutine find_field

  !> Place of some bytes of the body in the file they come from.
  pure function place_in_row(self, row, first, last) result(spot)
    class(card), intent(in) :: self
    integer, intent(in) :: row !< index into `rows`
    integer, intent(in) :: first, last !< bytes in the body
    type(place) :: spot
    spot%file = self%files(self%rows(row)%file)%path
    spot%line = self%rows(row)%number
    spot%column = first - self%rows(row)%first + 1
    spot%length = last - first + 1
    spot%keyword = self%keyword
    spot%source = self%body(self%rows(row)%first:self%rows(row)%last)
  end function place_in_row

  !> Default of a parameter by the specification, '' where there is none.
  pure function default_of_parameter(spec, name) result(default)
    type(keyword), intent(in) :: spec
    character(*), intent(in) :: name
    character(:), allocatable :: default
    integer :: i
    default = ''
    if (.not. allocated(spec%parameters)) return
    do i = 1, size(spec%parameters)
      if (spec%parameters(i)%name /= name) cycle
      if (allocated(spec%parameters(i)%default)) default = spec%parameters(i)%default
    end do
  end function default_of_parameter

  !> Default of a column by the specification, '' where there is none.
  pure function default_of_column(spec, number) result(default)
    type(keyword), intent(in) :: spec
    integer, intent(in) :: number !< field of the data line
    character(:), allocatable :: default
    integer :: column
    default = ''
    if (.not. allocated(spec%columns)) return
    column = number
    if (spec%repeats_columns) column = 1 + mod(number - 1, size(spec%columns))
    if (column < 1 .or. column > size(spec%columns)) return
    if (allocated(spec%columns(column)%default)) default = spec%columns(column)%default
  end function default_of_column
end submodule deck_card_impl
