!> A card: one keyword line of the deck with its parameters and data lines.
!>
!> A card holds its lines and the place of every word, so that a message can point at any word.
!> Getters return the default of the specification for what is not given. Getters never fail:
!> `check_card` has reported every invalid word.
!> Data lines and their fields count from 1; names of parameters are upper case.
module deck_card
  use card_lines, only: line_store
  use diagnostics, only: diagnostic_list, place, severity_error, severity_ignored, severity_warning
  use keyword_spec, only: column_default, keyword, parameter_default
  use kinds, only: rk
  use parse_text, only: largest_number, parse_integer, parse_real, upper_case
  implicit none
  private
  public :: card, card_parameter

  !> KEY=VALUE or the flag KEY.
  type :: card_parameter
    character(:), allocatable :: name !< upper case, single blanks
    integer :: row = 1 !< line of the name
    integer :: first = 1, last = 0 !< bytes of the name
    logical :: has_value = .false. !< the parameter has a '='
    integer :: value_row = 1 !< line of the value
    integer :: value_first = 1, value_last = 0 !< bytes of the value, without quotes
    integer :: read_first = 0, read_last = 0 !< bytes read in place of the value, if rewritten
  end type card_parameter

  !> One keyword of the deck with its parameters and data.
  type :: card
    character(:), allocatable :: keyword !< upper case, single blanks, without the star
    integer :: num_lines = 0 !< data lines
    type(keyword) :: spec !< the specification of the keyword
    type(card_parameter), allocatable :: parameters(:) !< in the order of the deck
    type(line_store) :: lines !< text and places
  contains
    procedure :: has
    procedure :: text
    procedure :: word
    procedure :: real => real_of
    procedure :: integer => integer_of
    procedure :: num_fields
    procedure :: text_at
    procedure :: word_at
    procedure :: real_at
    procedure :: integer_at
    procedure :: is_empty_at
    procedure :: is_real_at
    procedure :: is_integer_at
    procedure :: ends_in_comma
    procedure :: find_parameter
    procedure :: place => place_of_card
    procedure :: place_of
    procedure :: place_at
    procedure :: line_as_written
    procedure :: file_and_line
    procedure :: fault
    procedure :: fault_parameter
    procedure :: fault_at
    procedure :: warn_at
    procedure :: warn
    procedure :: ignore
  end type card

contains

  !> Whether the keyword line holds the parameter or flag.
  pure logical function has(self, name)
    class(card), intent(in) :: self
    character(*), intent(in) :: name
    has = self%find_parameter(name) > 0
  end function has

  !> Index into `parameters`, 0 for a parameter that is not given.
  pure integer function find_parameter(self, name) result(found)
    class(card), intent(in) :: self
    character(*), intent(in) :: name
    integer :: i
    found = 0
    if (.not. allocated(self%parameters)) return
    do i = 1, size(self%parameters)
      if (self%parameters(i)%name == name) found = i
    end do
  end function find_parameter

  !> Value of a parameter as written, without quotes; else its default.
  pure function text(self, name) result(value)
    class(card), intent(in) :: self
    character(*), intent(in) :: name
    character(:), allocatable :: value
    integer :: i
    i = self%find_parameter(name)
    value = ''
    if (i > 0) then
      associate (given => self%parameters(i))
        if (given%read_first > 0) then
          value = self%lines%body(given%read_first:given%read_last)
        else
          value = self%lines%body(given%value_first:given%value_last)
        end if
      end associate
    end if
    if (len(value) == 0) value = parameter_default(self%spec, name)
  end function text

  !> Value of a parameter in upper case; else its default.
  pure function word(self, name) result(value)
    class(card), intent(in) :: self
    character(*), intent(in) :: name
    character(:), allocatable :: value
    value = upper_case(self%text(name))
  end function word

  !> Number given to a parameter; else its default, zero without a default.
  pure real(rk) function real_of(self, name) result(value)
    class(card), intent(in) :: self
    character(*), intent(in) :: name
    logical :: is_number
    call parse_real(self%text(name), value, is_number)
  end function real_of

  !> Integer given to a parameter; else its default, zero without a default.
  pure integer function integer_of(self, name) result(value)
    class(card), intent(in) :: self
    character(*), intent(in) :: name
    logical :: is_integer
    call parse_integer(self%text(name), value, is_integer)
  end function integer_of

  !> Number of fields of a data line, without empty fields at the end.
  pure integer function num_fields(self, line)
    class(card), intent(in) :: self
    integer, intent(in) :: line
    num_fields = 0
    if (line >= 1 .and. line <= self%num_lines) then
      num_fields = self%lines%rows(self%lines%num_heads + line)%num_fields
    end if
  end function num_fields

  !> A field as written, without quotes and outer blanks; default of its column for an empty field.
  pure function text_at(self, line, field) result(value)
    class(card), intent(in) :: self
    integer, intent(in) :: line, field
    character(:), allocatable :: value
    integer :: first, last
    call self%lines%find_field(line, field, first, last)
    if (first > last) then
      value = column_default(self%spec, field)
    else
      value = self%lines%body(first:last)
    end if
  end function text_at

  !> A field in upper case; default of its column if the field is empty.
  pure function word_at(self, line, field) result(value)
    class(card), intent(in) :: self
    integer, intent(in) :: line, field
    character(:), allocatable :: value
    value = upper_case(self%text_at(line, field))
  end function word_at

  !> A number; default of its column (or zero) if the field is empty or no number.
  pure real(rk) function real_at(self, line, field) result(value)
    class(card), intent(in) :: self
    integer, intent(in) :: line, field
    integer :: first, last
    logical :: is_number
    call self%lines%find_field(line, field, first, last)
    call parse_real(self%lines%body(first:last), value, is_number)
    if (.not. is_number) call parse_real(column_default(self%spec, field), value, is_number)
  end function real_at

  !> An integer; default of its column (or zero) if the field is empty or no integer.
  pure integer function integer_at(self, line, field) result(value)
    class(card), intent(in) :: self
    integer, intent(in) :: line, field
    integer :: first, last
    logical :: is_integer
    call self%lines%find_field(line, field, first, last)
    call parse_integer(self%lines%body(first:last), value, is_integer)
    if (.not. is_integer) call parse_integer(column_default(self%spec, field), value, is_integer)
  end function integer_at

  !> Whether the field is empty or missing.
  pure logical function is_empty_at(self, line, field)
    class(card), intent(in) :: self
    integer, intent(in) :: line, field
    integer :: first, last
    call self%lines%find_field(line, field, first, last)
    is_empty_at = first > last
  end function is_empty_at

  !> Whether the field holds a number.
  pure logical function is_real_at(self, line, field)
    class(card), intent(in) :: self
    integer, intent(in) :: line, field
    integer :: first, last
    real(rk) :: value
    call self%lines%find_field(line, field, first, last)
    call parse_real(self%lines%body(first:last), value, is_real_at)
    is_real_at = is_real_at .and. abs(value) <= largest_number
  end function is_real_at

  !> Whether the field holds an integer.
  pure logical function is_integer_at(self, line, field)
    class(card), intent(in) :: self
    integer, intent(in) :: line, field
    integer :: first, last, value
    call self%lines%find_field(line, field, first, last)
    call parse_integer(self%lines%body(first:last), value, is_integer_at)
  end function is_integer_at

  !> Whether the data line ends in a comma (for keywords whose data continue in the next line).
  pure logical function ends_in_comma(self, line)
    class(card), intent(in) :: self
    integer, intent(in) :: line
    ends_in_comma = self%lines%ends_in_comma(line)
  end function ends_in_comma

  !> Place of the keyword itself.
  pure function place_of_card(self) result(spot)
    class(card), intent(in) :: self
    type(place) :: spot
    spot = self%lines%spot_of_keyword(self%keyword)
  end function place_of_card

  !> Place of the value of a parameter; without a value of its name, without a name of the keyword.
  pure function place_of(self, name) result(spot)
    class(card), intent(in) :: self
    character(*), intent(in) :: name
    type(place) :: spot
    integer :: i
    i = self%find_parameter(name)
    if (i == 0) then
      spot = self%place()
    else
      associate (given => self%parameters(i))
        if (given%value_first <= given%value_last) then
          spot = self%lines%spot(given%value_row, given%value_first, given%value_last, self%keyword)
        else
          spot = self%lines%spot(given%row, given%first, given%last, self%keyword)
        end if
      end associate
    end if
  end function place_of

  !> Place of a field: of the whole data line for field 0, of the line's end for a missing field.
  pure function place_at(self, line, field) result(spot)
    class(card), intent(in) :: self
    integer, intent(in) :: line, field
    type(place) :: spot
    spot = self%lines%spot_of_field(line, field, self%keyword)
  end function place_at

  !> A data line as it stands in the deck.
  pure function line_as_written(self, line) result(text)
    class(card), intent(in) :: self
    integer, intent(in) :: line
    character(:), allocatable :: text
    type(place) :: spot
    spot = self%place_at(line, 0)
    text = ''
    if (allocated(spot%source)) text = spot%source
  end function line_as_written

  !> 'file:line' of a data line; of the keyword for `line` = 0.
  pure function file_and_line(self, line) result(name)
    class(card), intent(in) :: self
    integer, intent(in) :: line
    character(:), allocatable :: name
    name = self%lines%file_and_line(line)
  end function file_and_line

  !> Adds an error that points at the keyword.
  subroutine fault(self, faults, problem, expected, nearest, first)
    class(card), intent(in) :: self
    type(diagnostic_list), intent(inout) :: faults
    character(*), intent(in) :: problem !< what is wrong
    character(*), intent(in), optional :: expected !< what was expected
    character(*), intent(in), optional :: nearest !< a known word of similar spelling, or ''
    type(place), intent(in), optional :: first !< where the same was defined before
    call faults%add(severity_error, self%place(), problem, expected, nearest, first)
  end subroutine fault

  !> Adds an error that points at the value of a parameter; arguments as in `fault`.
  subroutine fault_parameter(self, faults, name, problem, expected, nearest, first)
    class(card), intent(in) :: self
    type(diagnostic_list), intent(inout) :: faults
    character(*), intent(in) :: name !< of the parameter
    character(*), intent(in) :: problem
    character(*), intent(in), optional :: expected, nearest
    type(place), intent(in), optional :: first
    call faults%add(severity_error, self%place_of(name), problem, expected, nearest, first)
  end subroutine fault_parameter

  !> Adds an error that points at a field (0: the whole line); arguments as in `fault`.
  subroutine fault_at(self, faults, line, field, problem, expected, nearest, first)
    class(card), intent(in) :: self
    type(diagnostic_list), intent(inout) :: faults
    integer, intent(in) :: line, field !< data line and field
    character(*), intent(in) :: problem
    character(*), intent(in), optional :: expected, nearest
    type(place), intent(in), optional :: first
    call faults%add(severity_error, self%place_at(line, field), problem, expected, nearest, first)
  end subroutine fault_at

  !> Adds a warning that points at the keyword.
  subroutine warn(self, faults, problem, expected)
    class(card), intent(in) :: self
    type(diagnostic_list), intent(inout) :: faults
    character(*), intent(in) :: problem !< what is unusual
    character(*), intent(in), optional :: expected !< what was expected
    call faults%add(severity_warning, self%place(), problem, expected)
  end subroutine warn

  !> Adds a warning that points at a field (0: the whole line).
  subroutine warn_at(self, faults, line, field, problem, expected)
    class(card), intent(in) :: self
    type(diagnostic_list), intent(inout) :: faults
    integer, intent(in) :: line, field !< data line and field
    character(*), intent(in) :: problem !< what is unusual
    character(*), intent(in), optional :: expected !< what was expected
    call faults%add(severity_warning, self%place_at(line, field), problem, expected)
  end subroutine warn_at

  !> Notes that the keyword has no effect here (`ignored_input` of job.json).
  subroutine ignore(self, faults, why)
    class(card), intent(in) :: self
    type(diagnostic_list), intent(inout) :: faults
    character(*), intent(in) :: why !< 'has no effect here'
    call faults%add(severity_ignored, self%place(), why)
  end subroutine ignore
end module deck_card
