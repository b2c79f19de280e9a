!> Strict reading of numbers and words: a number must fill the whole word.
module parse_text
  use, intrinsic :: iso_c_binding, only: c_char, c_double, c_null_char, c_null_ptr, c_ptr
  use kinds, only: long, rk
  implicit none
  private
  public :: largest_number
  public :: parse_real, parse_integer, upper_case, single_blanks, without_blanks

  !> Input beyond this number is refused: its square is beyond all numbers.
  real(rk), parameter :: largest_number = 1.0e150_rk
  integer, parameter :: most_digits = 18 !< any number of so many digits fits 64 bits
  integer(long), parameter :: exact_limit = 2_long**53 !< integers below are exact reals
  integer, parameter :: largest_power = 22 !< 10**22 is the last exact power of ten
  integer, parameter :: largest_magnitude = 307 !< decades of a normal real, up and down
  integer, parameter :: longest_exponent = 100000 !< larger ones are clipped: out of range anyway
  real(rk), parameter :: power_of_ten(0:largest_power) = [ &
                         1e0_rk, 1e1_rk, 1e2_rk, 1e3_rk, 1e4_rk, 1e5_rk, 1e6_rk, 1e7_rk, &
                         1e8_rk, 1e9_rk, 1e10_rk, 1e11_rk, 1e12_rk, 1e13_rk, 1e14_rk, 1e15_rk, &
                         1e16_rk, 1e17_rk, 1e18_rk, 1e19_rk, 1e20_rk, 1e21_rk, 1e22_rk]
  character, parameter :: tab = achar(9)

  !> A number in parts: digits*10**exponent.
  type :: decimal
    logical :: is_negative = .false.
    integer(long) :: digits = 0 !< the first significant digits
    integer :: num_digits = 0 !< significant digits, also those beyond `digits`
    integer :: exponent = 0 !< of ten
    logical :: is_cut = .false. !< `digits` does not hold all digits
  end type decimal

  interface
    !> C library: nearest double of a decimal number.
    pure function strtod(text, tail) result(value) bind(C, name='strtod')
      import :: c_char, c_double, c_ptr
      implicit none
      ! allow(C071) a C string has no length
      character(kind=c_char), intent(in) :: text(*)
      type(c_ptr), intent(in), value :: tail
      real(c_double) :: value
    end function strtod
  end interface

contains

  !> Reads a real: `1`, `1.`, `.5`, `1e3`, `1.D+3`; correctly rounded.
  !>
  !> Not a number: other letters in the word, `NaN`, `Inf`, above 1e308 or nonzero below 1e-307.
  pure subroutine parse_real(text, value, is_number)
    character(*), intent(in) :: text !< one word; blanks around it do not count
    real(rk), intent(out) :: value !< zero if the word is no number
    logical, intent(out) :: is_number !< the whole word is a number
    type(decimal) :: parts
    integer :: magnitude
    value = 0.0_rk
    call split_number(text, parts, is_number)
    if (.not. is_number .or. parts%digits == 0) return
    magnitude = parts%exponent + min(parts%num_digits, most_digits) - 1
    is_number = abs(magnitude) <= largest_magnitude
    if (.not. is_number) return
    if (parts%is_cut .or. parts%digits > exact_limit .or. abs(parts%exponent) > largest_power) then
      value = nearest_double(trim(adjustl(text)))
      return
    end if
    value = real(parts%digits, rk)
    if (parts%exponent < 0) then
      value = value/power_of_ten(-parts%exponent)
    else
      value = value*power_of_ten(parts%exponent)
    end if
    if (parts%is_negative) value = -value
  end subroutine parse_real

  !> Reads an integer: an optional sign and digits, nothing else.
  pure subroutine parse_integer(text, value, is_integer)
    character(*), intent(in) :: text !< one word; blanks around it do not count
    integer, intent(out) :: value !< zero if the word is no integer
    logical, intent(out) :: is_integer !< the whole word is an integer that fits
    integer :: position, first, last, digit
    integer(long) :: total
    value = 0
    is_integer = .false.
    call find_ends(text, first, last)
    if (first > last) return
    if (scan(text(first:first), '+-') == 1) first = first + 1
    if (first > last) return
    total = 0
    do position = first, last
      digit = iachar(text(position:position)) - iachar('0')
      if (digit < 0 .or. digit > 9) return
      total = 10*total + digit
      if (total > huge(value)) return
    end do
    is_integer = .true.
    value = int(total)
    if (first > 1) then
      if (text(first - 1:first - 1) == '-') value = -value
    end if
  end subroutine parse_integer

  !> Splits a word into the parts of a number; `is_number` is false if the word is none.
  pure subroutine split_number(text, parts, is_number)
    character(*), intent(in) :: text
    type(decimal), intent(out) :: parts
    logical, intent(out) :: is_number
    integer :: position, last, num_seen, digit
    logical :: has_point
    is_number = .false.
    call find_ends(text, position, last)
    if (position > last) return
    if (text(position:position) == '-' .or. text(position:position) == '+') then
      parts%is_negative = text(position:position) == '-'
      position = position + 1
    end if
    num_seen = 0
    has_point = .false.
    do while (position <= last)
      digit = iachar(text(position:position)) - iachar('0')
      if (digit >= 0 .and. digit <= 9) then
        num_seen = num_seen + 1
        call add_digit(parts, digit, has_point)
      else if (text(position:position) == '.' .and. .not. has_point) then
        has_point = .true.
      else
        exit
      end if
      position = position + 1
    end do
    if (num_seen == 0) return
    call add_exponent(text(position:last), parts, is_number)
  end subroutine split_number

  !> Adds a digit of the mantissa; leading zeros are not significant.
  pure subroutine add_digit(parts, digit, has_point)
    type(decimal), intent(inout) :: parts
    integer, intent(in) :: digit !< 0 to 9
    logical, intent(in) :: has_point !< the digit stands after the point
    if (digit > 0 .or. parts%num_digits > 0) parts%num_digits = parts%num_digits + 1
    if (parts%num_digits > most_digits) then
      if (digit > 0) parts%is_cut = .true.
      if (.not. has_point) parts%exponent = parts%exponent + 1
    else
      parts%digits = 10*parts%digits + digit
      if (has_point) parts%exponent = parts%exponent - 1
    end if
  end subroutine add_digit

  !> Reads what follows the mantissa: nothing, or E or D with an integer.
  pure subroutine add_exponent(tail, parts, is_right)
    character(*), intent(in) :: tail
    type(decimal), intent(inout) :: parts
    logical, intent(out) :: is_right !< the tail is an exponent or empty
    integer :: position, digit, power
    is_right = len(tail) == 0
    if (is_right) return
    if (scan(tail(1:1), 'eEdD') == 0) return
    position = 2
    if (len(tail) > 1) then
      if (scan(tail(2:2), '+-') == 1) position = 3
    end if
    if (position > len(tail)) return
    power = 0
    do position = position, len(tail)
      digit = iachar(tail(position:position)) - iachar('0')
      if (digit < 0 .or. digit > 9) return
      power = min(10*power + digit, longest_exponent)
    end do
    if (tail(2:2) == '-') power = -power
    parts%exponent = parts%exponent + power
    is_right = .true.
  end subroutine add_exponent

  !> The nearest double of a word that is a number, by the C library.
  pure function nearest_double(text) result(value)
    character(*), intent(in) :: text
    real(rk) :: value
    character(kind=c_char) :: letters(len(text) + 1)
    integer :: i
    do i = 1, len(text)
      letters(i) = text(i:i)
      if (scan(text(i:i), 'dD') == 1) letters(i) = 'e'
    end do
    letters(len(text) + 1) = c_null_char
    value = strtod(letters, c_null_ptr)
  end function nearest_double

  !> First and last letter that is neither blank nor tab; first > last if there is none.
  pure subroutine find_ends(text, first, last)
    character(*), intent(in) :: text
    integer, intent(out) :: first, last
    first = 1
    last = len(text)
    do while (first <= last)
      if (text(first:first) /= ' ' .and. text(first:first) /= tab) exit
      first = first + 1
    end do
    do while (last >= first)
      if (text(last:last) /= ' ' .and. text(last:last) /= tab) exit
      last = last - 1
    end do
  end subroutine find_ends

  !> The text with a-z turned to A-Z; other bytes stay.
  pure function upper_case(text) result(upper)
    character(*), intent(in) :: text
    character(len(text)) :: upper
    integer :: i
    do i = 1, len(text)
      upper(i:i) = text(i:i)
      if (text(i:i) >= 'a' .and. text(i:i) <= 'z') upper(i:i) = achar(iachar(text(i:i)) - 32)
    end do
  end function upper_case

  !> The text without outer blanks, and with one blank for each run of blanks and tabs inside.
  pure function single_blanks(text) result(squeezed)
    character(*), intent(in) :: text
    character(:), allocatable :: squeezed
    character(len(text)) :: room
    integer :: i, used
    logical :: is_blank, was_blank
    used = 0
    was_blank = .true.
    do i = 1, len(text)
      is_blank = text(i:i) == ' ' .or. text(i:i) == tab
      if (.not. (is_blank .and. was_blank)) then
        used = used + 1
        room(used:used) = merge(' ', text(i:i), is_blank)
      end if
      was_blank = is_blank
    end do
    squeezed = trim(room(:used))
  end function single_blanks

  !> The text without any blank or tab.
  pure function without_blanks(text) result(solid)
    character(*), intent(in) :: text
    character(:), allocatable :: solid
    character(len(text)) :: room
    integer :: i, used
    used = 0
    do i = 1, len(text)
      if (text(i:i) == ' ' .or. text(i:i) == tab) cycle
      used = used + 1
      room(used:used) = text(i:i)
    end do
    solid = room(:used)
  end function without_blanks
end module parse_text
