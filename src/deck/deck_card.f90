!> A card: one keyword line of the deck with its parameters and data lines.
!>
!> A card owns the bytes of its lines and knows the place of every word, so that a message can point
!> at it. Getters fall back to the default of the specification the card was checked against; they
!> never fail: `check_card` has told about every word that is not what it should be.
!> Data lines and their fields count from 1.
module deck_card
  use diagnostics, only: diagnostic_list, place
  use keyword_spec, only: keyword
  use kinds, only: rk
  implicit none
  private
  public :: card, card_parameter, card_row, file_name

  !> Name of a file the card has lines of.
  type :: file_name
    character(:), allocatable :: path !< as the user named it
  end type file_name

  !> A line of the card: of the keyword itself or of data.
  type :: card_row
    integer :: file = 1 !< index into `files`
    integer :: number = 0 !< line in that file
    integer :: first = 1, last = 0 !< its bytes in `body`
    integer :: first_field = 1 !< its first field in `field_first`
    integer :: num_fields = 0 !< empty ones at the end do not count
  end type card_row

  !> KEY=VALUE or the flag KEY.
  type :: card_parameter
    character(:), allocatable :: name !< upper case, single blanks
    integer :: row = 1 !< where it stands
    integer :: first = 1, last = 0 !< bytes of the name in `body`
    integer :: value_row = 1 !< where the value stands
    integer :: value_first = 1, value_last = 0 !< bytes of the value in `body`, without quotes
    logical :: has_value = .false. !< there is a '='
  end type card_parameter

  !> One keyword of the deck with all it says.
  type :: card
    character(:), allocatable :: keyword !< upper case, single blanks, without the star
    integer :: num_lines = 0 !< data lines
    type(keyword) :: spec !< what it was checked against
    ! Below: filled by deck_lexer, read through the procedures.
    character(:), allocatable :: body !< the lines of the card, one after the other
    type(file_name), allocatable :: files(:)
    integer :: num_heads = 1 !< lines the keyword takes; data lines follow in `rows`
    type(card_row), allocatable :: rows(:)
    type(card_parameter), allocatable :: parameters(:)
    integer, allocatable :: field_first(:), field_last(:) !< bytes of each field, without quotes
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
    procedure :: file_and_line
    procedure :: fault
    procedure :: fault_parameter
    procedure :: fault_at
    procedure :: warn
    procedure :: ignore
  end type card

  interface
    !> The keyword line holds the parameter or flag.
    pure module function has(self, name) result(is_given)
      class(card), intent(in) :: self
      character(*), intent(in) :: name !< upper case
      logical :: is_given
    end function has

    !> Value of a parameter as written, without quotes; its default where it is not given.
    pure module function text(self, name) result(value)
      class(card), intent(in) :: self
      character(*), intent(in) :: name !< upper case
      character(:), allocatable :: value
    end function text

    !> Value of a parameter in upper case; its default where it is not given.
    pure module function word(self, name) result(value)
      class(card), intent(in) :: self
      character(*), intent(in) :: name !< upper case
      character(:), allocatable :: value
    end function word

    !> Number given to a parameter; its default where it is not given, zero without a default.
    pure module function real_of(self, name) result(value)
      class(card), intent(in) :: self
      character(*), intent(in) :: name !< upper case
      real(rk) :: value
    end function real_of

    !> Integer given to a parameter; its default where it is not given, zero without a default.
    pure module function integer_of(self, name) result(value)
      class(card), intent(in) :: self
      character(*), intent(in) :: name !< upper case
      integer :: value
    end function integer_of

    !> Fields of a data line; empty ones at its end do not count.
    pure module function num_fields(self, line) result(count)
      class(card), intent(in) :: self
      integer, intent(in) :: line !< data line
      integer :: count
    end function num_fields

    !> A field as written, without quotes and outer blanks; default of its column where it is empty.
    pure module function text_at(self, line, field) result(value)
      class(card), intent(in) :: self
      integer, intent(in) :: line, field !< data line and field
      character(:), allocatable :: value
    end function text_at

    !> A field in upper case; default of its column where it is empty.
    pure module function word_at(self, line, field) result(value)
      class(card), intent(in) :: self
      integer, intent(in) :: line, field !< data line and field
      character(:), allocatable :: value
    end function word_at

    !> A number; default of its column (or zero) where the field is empty or no number.
    pure module function real_at(self, line, field) result(value)
      class(card), intent(in) :: self
      integer, intent(in) :: line, field !< data line and field
      real(rk) :: value
    end function real_at

    !> An integer; default of its column (or zero) where the field is empty or no integer.
    pure module function integer_at(self, line, field) result(value)
      class(card), intent(in) :: self
      integer, intent(in) :: line, field !< data line and field
      integer :: value
    end function integer_at

    !> Nothing is written there.
    pure module function is_empty_at(self, line, field) result(is_empty)
      class(card), intent(in) :: self
      integer, intent(in) :: line, field !< data line and field
      logical :: is_empty
    end function is_empty_at

    !> The field holds a number.
    pure module function is_real_at(self, line, field) result(is_real)
      class(card), intent(in) :: self
      integer, intent(in) :: line, field !< data line and field
      logical :: is_real
    end function is_real_at

    !> The field holds an integer.
    pure module function is_integer_at(self, line, field) result(is_integer)
      class(card), intent(in) :: self
      integer, intent(in) :: line, field !< data line and field
      logical :: is_integer
    end function is_integer_at

    !> The data line ends in a comma (for keywords whose data go on in the next line).
    pure module function ends_in_comma(self, line) result(ends_so)
      class(card), intent(in) :: self
      integer, intent(in) :: line !< data line
      logical :: ends_so
    end function ends_in_comma

    !> Index into `parameters`, 0 where the keyword line has no such parameter.
    pure module function find_parameter(self, name) result(index)
      class(card), intent(in) :: self
      character(*), intent(in) :: name !< upper case
      integer :: index
    end function find_parameter

    !> Place of the keyword itself.
    pure module function place_of_card(self) result(spot)
      class(card), intent(in) :: self
      type(place) :: spot
    end function place_of_card

    !> Place of the value of a parameter (of the keyword where it is not given).
    pure module function place_of(self, name) result(spot)
      class(card), intent(in) :: self
      character(*), intent(in) :: name !< upper case
      type(place) :: spot
    end function place_of

    !> Place of a field; of the whole data line where `field` is 0, of its end where it is missing.
    pure module function place_at(self, line, field) result(spot)
      class(card), intent(in) :: self
      integer, intent(in) :: line, field !< data line and field
      type(place) :: spot
    end function place_at

    !> 'file:line' of a data line, of the keyword for `line` = 0.
    pure module function file_and_line(self, line) result(name)
      class(card), intent(in) :: self
      integer, intent(in) :: line !< data line
      character(:), allocatable :: name
    end function file_and_line

    !> Adds an error that points at the keyword.
    module subroutine fault(self, faults, problem, expected, nearest, first)
      class(card), intent(in) :: self
      type(diagnostic_list), intent(inout) :: faults
      character(*), intent(in) :: problem !< what is wrong
      character(*), intent(in), optional :: expected !< what was expected
      character(*), intent(in), optional :: nearest !< a known word that is near
      type(place), intent(in), optional :: first !< where the same was defined before
    end subroutine fault

    !> Adds an error that points at the value of a parameter.
    module subroutine fault_parameter(self, faults, name, problem, expected, nearest, first)
      class(card), intent(in) :: self
      type(diagnostic_list), intent(inout) :: faults
      character(*), intent(in) :: name !< of the parameter, upper case
      character(*), intent(in) :: problem !< what is wrong
      character(*), intent(in), optional :: expected !< what was expected
      character(*), intent(in), optional :: nearest !< a known word that is near
      type(place), intent(in), optional :: first !< where the same was defined before
    end subroutine fault_parameter

    !> Adds an error that points at a field of a data line.
    module subroutine fault_at(self, faults, line, field, problem, expected, nearest, first)
      class(card), intent(in) :: self
      type(diagnostic_list), intent(inout) :: faults
      integer, intent(in) :: line, field !< data line and field; field 0: the line as a whole
      character(*), intent(in) :: problem !< what is wrong
      character(*), intent(in), optional :: expected !< what was expected
      character(*), intent(in), optional :: nearest !< a known word that is near
      type(place), intent(in), optional :: first !< where the same was defined before
    end subroutine fault_at

    !> Adds a warning that points at the keyword.
    module subroutine warn(self, faults, problem, expected)
      class(card), intent(in) :: self
      type(diagnostic_list), intent(inout) :: faults
      character(*), intent(in) :: problem !< what is odd
      character(*), intent(in), optional :: expected !< what was expected
    end subroutine warn

    !> Notes that the keyword has no effect here (`ignored_input` of job.json).
    module subroutine ignore(self, faults, why)
      class(card), intent(in) :: self
      type(diagnostic_list), intent(inout) :: faults
      character(*), intent(in) :: why !< 'has no effect here'
    end subroutine ignore
  end interface
end module deck_card
