!> Numbers as short texts, for messages.
module write_text
  use kinds, only: long, rk
  implicit none
  private
  public :: as_text, as_short_text

  integer, parameter :: num_decimals = 5 !< behind the first significant digit
  integer, parameter :: lowest_plain = -3, highest_plain = 5 !< decades written without exponent

  !> A number in the fewest letters: '3', '0.2', '1e10' (6 significant digits).
  interface as_text
    module procedure integer_as_text, long_as_text, real_as_text
  end interface as_text

contains

  !> An integer.
  pure function integer_as_text(number) result(text)
    integer, intent(in) :: number
    character(:), allocatable :: text
    text = long_as_text(int(number, long))
  end function integer_as_text

  !> A long integer.
  pure function long_as_text(number) result(text)
    integer(long), intent(in) :: number
    character(:), allocatable :: text
    character(20) :: room
    write (room, '(i0)') number
    text = trim(room)
  end function long_as_text

  !> A real, with 6 significant digits.
  pure function real_as_text(number) result(text)
    real(rk), intent(in) :: number
    character(:), allocatable :: text
    character(32) :: room
    character(12) :: style
    integer :: split, exponent
    write (room, '(es13.5e3)') number
    split = index(room, 'E')
    if (split == 0) then ! Inf, NaN
      text = trim(adjustl(room))
      return
    end if
    read (room(split + 1:split + 4), '(i4)') exponent
    if (exponent < lowest_plain .or. exponent > highest_plain) then
      text = without_zeros(trim(adjustl(room(:split - 1))))
      if (exponent /= 0) text = text//'e'//integer_as_text(exponent)
    else
      write (style, '(a,i0,a)') '(f32.', num_decimals - exponent, ')'
      write (room, style) number
      text = without_zeros(trim(adjustl(room)))
    end if
  end function real_as_text

  !> A real with 4 significant digits.
  pure function as_short_text(number) result(text)
    real(rk), intent(in) :: number
    character(:), allocatable :: text
    character(16) :: room
    real(rk) :: rounded
    integer :: status
    write (room, '(es11.3e3)') number
    read (room, *, iostat=status) rounded
    if (status /= 0) rounded = number
    text = as_text(rounded)
  end function as_short_text

  !> A decimal number without trailing zeros and without a trailing point.
  pure function without_zeros(number) result(text)
    character(*), intent(in) :: number !< holds a point
    character(:), allocatable :: text
    integer :: last
    last = verify(number, '0', back=.true.)
    if (number(last:last) == '.') last = last - 1
    text = number(:last)
  end function without_zeros
end module write_text
