!> Writes JSON: the caller gives keys and values, this module writes commas, escapes and null.
module json_writer
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use kinds, only: rk
  use text_buffers, only: text_buffer
  use utf8_text, only: letter_of_latin1, utf8_width
  implicit none
  private
  public :: json_text, lower, quoted

  !> Keys are given inside objects; inside arrays the key is left out (use `item_...`).
  type :: json_text
    private
    type(text_buffer) :: buffer
    logical :: is_first = .true. !< nothing written yet at this level
    integer :: depth = 0
  contains
    procedure :: open_object
    procedure :: open_array
    procedure :: close_object
    procedure :: close_array
    procedure :: put_text
    procedure :: put_integer
    procedure :: put_real
    procedure :: put_reals
    procedure :: contents
    procedure, private :: start_value
    procedure, private :: close_level
    procedure, private :: add_quoted
    procedure, private :: add_number
  end type json_text

contains

  !> '{', as the value of `key` or as an item of an array.
  subroutine open_object(self, key)
    class(json_text), intent(inout) :: self
    character(*), intent(in), optional :: key
    call self%start_value(key)
    call self%buffer%add('{')
    self%is_first = .true.
    self%depth = self%depth + 1
  end subroutine open_object

  !> '[', as the value of `key` or as an item of an array.
  subroutine open_array(self, key)
    class(json_text), intent(inout) :: self
    character(*), intent(in), optional :: key
    call self%start_value(key)
    call self%buffer%add('[')
    self%is_first = .true.
    self%depth = self%depth + 1
  end subroutine open_array

  !> '}'
  subroutine close_object(self)
    class(json_text), intent(inout) :: self
    call self%close_level('}')
  end subroutine close_object

  !> ']'
  subroutine close_array(self)
    class(json_text), intent(inout) :: self
    call self%close_level(']')
  end subroutine close_array

  !> A string; every character that JSON reserves is escaped.
  subroutine put_text(self, text, key)
    class(json_text), intent(inout) :: self
    character(*), intent(in) :: text
    character(*), intent(in), optional :: key
    call self%start_value(key)
    call self%add_quoted(text)
  end subroutine put_text

  !> An integer.
  subroutine put_integer(self, number, key)
    class(json_text), intent(inout) :: self
    integer, intent(in) :: number
    character(*), intent(in), optional :: key
    call self%start_value(key)
    call self%buffer%add_integer(number)
  end subroutine put_integer

  !> A real; null for a number that is not finite, since JSON has no NaN.
  subroutine put_real(self, number, key)
    class(json_text), intent(inout) :: self
    real(rk), intent(in) :: number
    character(*), intent(in), optional :: key
    call self%start_value(key)
    call self%add_number(number)
  end subroutine put_real

  !> A short array of reals on one line.
  subroutine put_reals(self, numbers, key)
    class(json_text), intent(inout) :: self
    real(rk), intent(in) :: numbers(:)
    character(*), intent(in), optional :: key
    integer :: i
    call self%start_value(key)
    call self%buffer%add('[')
    do i = 1, size(numbers)
      if (i > 1) call self%buffer%add(', ')
      call self%add_number(numbers(i))
    end do
    call self%buffer%add(']')
  end subroutine put_reals

  !> The whole document.
  function contents(self) result(text)
    class(json_text), intent(in) :: self
    character(:), allocatable :: text
    text = self%buffer%contents()//new_line('a')
  end function contents

  !> Comma, new line, indentation and key.
  subroutine start_value(self, key)
    class(json_text), intent(inout) :: self
    character(*), intent(in), optional :: key
    if (.not. self%is_first) call self%buffer%add(',')
    if (self%depth > 0) call self%buffer%add(new_line('a')//repeat('  ', self%depth))
    self%is_first = .false.
    if (.not. present(key)) return
    call self%add_quoted(key)
    call self%buffer%add(': ')
  end subroutine start_value

  !> Closes a level.
  subroutine close_level(self, bracket)
    class(json_text), intent(inout) :: self
    character(*), intent(in) :: bracket
    self%depth = self%depth - 1
    if (.not. self%is_first) call self%buffer%add(new_line('a')//repeat('  ', self%depth))
    call self%buffer%add(bracket)
    self%is_first = .false.
  end subroutine close_level

  !> A number, or null.
  subroutine add_number(self, number)
    class(json_text), intent(inout) :: self
    real(rk), intent(in) :: number
    if (ieee_is_finite(number)) then
      call self%buffer%add_real(number)
    else
      call self%buffer%add('null')
    end if
  end subroutine add_number

  !> A quoted string. Bytes above 127 that are not UTF-8 (in names of files) count as Latin-1.
  subroutine add_quoted(self, text)
    class(json_text), intent(inout) :: self
    character(*), intent(in) :: text
    character(6) :: escape
    integer :: i, width
    call self%buffer%add('"')
    i = 1
    do while (i <= len(text))
      width = utf8_width(text(i:))
      if (width == 0) then
        call self%buffer%add(letter_of_latin1(text(i:i)))
      else if (width > 1) then
        call self%buffer%add(text(i:i + width - 1))
      else if (text(i:i) == '"' .or. text(i:i) == achar(92)) then
        call self%buffer%add(achar(92)//text(i:i))
      else if (iachar(text(i:i)) < 32) then
        write (escape, '(a,z4.4)') achar(92)//'u', iachar(text(i:i))
        call self%buffer%add(escape)
      else
        call self%buffer%add(text(i:i))
      end if
      i = i + max(1, width)
    end do
    call self%buffer%add('"')
  end subroutine add_quoted

  !> A text as a string of JSON, with its quotes.
  function quoted(text) result(string)
    character(*), intent(in) :: text
    character(:), allocatable :: string
    type(json_text) :: json
    call json%add_quoted(text)
    string = json%buffer%contents()
  end function quoted

  !> In lower case.
  pure function lower(text) result(small)
    character(*), intent(in) :: text
    character(len(text)) :: small
    integer :: i
    small = text
    do i = 1, len(text)
      if (text(i:i) >= 'A' .and. text(i:i) <= 'Z') small(i:i) = achar(iachar(text(i:i)) + 32)
    end do
  end function lower
end module json_writer
