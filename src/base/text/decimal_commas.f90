!> Recognises commas that were meant as decimal signs: 30000,0, 0,2.
module decimal_commas
  implicit none
  private
  public :: has_decimal_comma, with_hint_of_point

  character(*), parameter :: digits = '0123456789'

contains

  !> Whether a comma between digits stands for a point: the number before it has none, and another
  !> comma of the line has a blank behind it.
  pure logical function has_decimal_comma(line)
    character(*), intent(in) :: line !< as written in the deck
    integer :: i
    has_decimal_comma = .false.
    if (index(line, ', ') == 0) return
    do i = 2, len(line) - 1
      if (line(i:i) /= ',') cycle
      if (index(digits, line(i - 1:i - 1)) == 0 .or. index(digits, line(i + 1:i + 1)) == 0) cycle
      if (is_whole(line(:i - 1)) .and. ends_number(line(i + 1:))) then
        has_decimal_comma = .true.
        return
      end if
    end do
  end function has_decimal_comma

  !> Whether the last word of a text is a whole number.
  pure logical function is_whole(text)
    character(*), intent(in) :: text
    integer :: first
    first = scan(text, ', ', back=.true.) + 1
    if (scan(text(first:first), '+-') > 0) first = first + 1
    is_whole = verify(text(first:), digits) == 0
  end function is_whole

  !> Whether the first word of a text is digits without a point, with or without an exponent.
  pure logical function ends_number(text)
    character(*), intent(in) :: text
    integer :: last
    last = scan(text, ', ') - 1
    if (last < 0) last = len(text)
    ends_number = verify(text(:last), digits//'eEdD+-') == 0
  end function ends_number

  !> What was expected of a line, with a hint where the line has decimal commas.
  pure function with_hint_of_point(expected, line) result(text)
    character(*), intent(in) :: expected
    character(*), intent(in) :: line !< as written in the deck
    character(:), allocatable :: text
    text = expected
    if (has_decimal_comma(line)) text = text//'; decimals need a point: commas separate numbers'
  end function with_hint_of_point
end module decimal_commas
