!> Letters that nobody sees and that make a word another one: blanks of their own, letters without
!> width, control characters.
module invisible_letters
  use utf8_text, only: utf8_width
  implicit none
  private
  public :: name_of_invisible

  character(*), parameter :: hexadecimal = '0123456789ABCDEF'
  character, parameter :: tab = achar(9)

contains

  !> 'a no-break space (U+00A0)': the first invisible letter of a text; '' where there is none.
  pure function name_of_invisible(text) result(name)
    character(*), intent(in) :: text !< in UTF-8
    character(:), allocatable :: name
    integer :: i, width
    name = ''
    i = 1
    do while (i <= len(text) .and. len(name) == 0)
      width = max(1, utf8_width(text(i:)))
      if (text(i:i) /= tab) name = name_of(code_of(text(i:i + width - 1)))
      i = i + width
    end do
  end function name_of_invisible

  !> The number of a letter in Unicode.
  pure integer function code_of(letter) result(code)
    character(*), intent(in) :: letter !< in UTF-8
    integer :: i
    code = ichar(letter(1:1))
    if (len(letter) > 1) code = iand(code, 2**(7 - len(letter)) - 1)
    do i = 2, len(letter)
      code = 64*code + iand(ichar(letter(i:i)), 63)
    end do
  end function code_of

  !> The name of an invisible letter; '' for one that is seen.
  pure function name_of(code) result(name)
    integer, intent(in) :: code !< in Unicode
    character(:), allocatable :: name
    integer :: i
    select case (code)
    case (0:31, 127:159)
      name = 'a control character (U+'
    case (160, 8239)
      name = 'a no-break space (U+'
    case (8192:8202, 12288)
      name = 'an unusual blank (U+'
    case (8203:8207, 8288, 65279)
      name = 'a letter without width (U+'
    case default
      name = ''
      return
    end select
    do i = 3, 0, -1
      name = name//hexadecimal(iand(ishft(code, -4*i), 15) + 1:iand(ishft(code, -4*i), 15) + 1)
    end do
    name = name//')'
  end function name_of
end module invisible_letters
