!> Letters in UTF-8, and texts in Latin-1 that become UTF-8.
module utf8_text
  implicit none
  private
  public :: is_ascii, utf8_width, num_letters, make_utf8, letter_of_latin1, latin1_of_utf8

  character, parameter :: line_feed = achar(10)

contains

  !> Bytes of the UTF-8 letter at the start of `text`, 0 when there is none (RFC 3629).
  pure integer function utf8_width(text) result(width)
    character(*), intent(in) :: text
    integer :: lead, i
    lead = ichar(text(1:1))
    select case (lead)
    case (0:127)
      width = 1
    case (194:223)
      width = 2
    case (224:239)
      width = 3
    case (240:244)
      width = 4
    case default
      width = 0
    end select
    if (width > len(text)) width = 0
    do i = 2, width
      if (iand(ichar(text(i:i)), 192) == 128) cycle
      width = 0
      return
    end do
    if (width > 2) then
      if (.not. is_right_second(lead, ichar(text(2:2)))) width = 0
    end if
  end function utf8_width

  !> Whether the second byte is that of the shortest form of a letter, below U+110000 and no half of
  !> a pair of UTF-16.
  pure logical function is_right_second(lead, second)
    integer, intent(in) :: lead, second
    is_right_second = .true.
    if (lead == 224) is_right_second = second >= 160
    if (lead == 237) is_right_second = second < 160
    if (lead == 240) is_right_second = second >= 144
    if (lead == 244) is_right_second = second < 144
  end function is_right_second

  !> Letters of a text in UTF-8; of other bytes each is a letter.
  pure integer function num_letters(text)
    character(*), intent(in) :: text
    integer :: i
    num_letters = 0
    i = 1
    do while (i <= len(text))
      i = i + max(1, utf8_width(text(i:)))
      num_letters = num_letters + 1
    end do
  end function num_letters

  !> Turns each line that is not valid UTF-8 from Latin-1 to UTF-8. A text in ASCII is only looked
  !> through.
  pure subroutine make_utf8(text, start)
    character(:), allocatable, intent(inout) :: text
    integer, intent(in) :: start !< its first letter, after a byte order mark
    character(:), allocatable :: new, line
    integer :: first, last, used, growth
    if (is_ascii(text)) return
    growth = growth_of(text, start)
    if (growth == 0 .or. growth > huge(1) - len(text)) return
    allocate (character(len(text) + growth) :: new)
    new(:start - 1) = text(:start - 1)
    used = start - 1
    first = start
    do while (first <= len(text))
      last = end_of_line(text, first)
      line = text(first:last)
      if (.not. is_utf8(line)) line = utf8_of_latin1(line)
      new(used + 1:used + len(line)) = line
      used = used + len(line)
      first = last + 1
    end do
    call move_alloc(new, text)
  end subroutine make_utf8

  !> Bytes by which a text grows: those above 127 in the lines that are not UTF-8.
  pure integer function growth_of(text, start) result(growth)
    character(*), intent(in) :: text
    integer, intent(in) :: start !< its first letter
    integer :: first, last, i
    growth = 0
    first = start
    do while (first <= len(text))
      last = end_of_line(text, first)
      if (.not. is_utf8(text(first:last))) then
        do i = first, last
          if (ichar(text(i:i)) > 127) growth = growth + 1
        end do
      end if
      first = last + 1
    end do
  end function growth_of

  !> Position of the line feed that ends a line, or of the last letter of the text.
  pure integer function end_of_line(text, first) result(last)
    character(*), intent(in) :: text
    integer, intent(in) :: first !< letter of the line
    last = index(text(first:), line_feed)
    last = merge(first + last - 1, len(text), last > 0)
  end function end_of_line

  !> A text in Latin-1 as UTF-8.
  pure function utf8_of_latin1(text) result(utf8)
    character(*), intent(in) :: text
    character(:), allocatable :: utf8
    integer :: i, used
    utf8 = repeat(' ', 2*len(text))
    used = 0
    do i = 1, len(text)
      if (ichar(text(i:i)) > 127) then
        utf8(used + 1:used + 2) = letter_of_latin1(text(i:i))
        used = used + 2
      else
        utf8(used + 1:used + 1) = text(i:i)
        used = used + 1
      end if
    end do
    utf8 = utf8(:used)
  end function utf8_of_latin1

  !> Whether no byte is above 127.
  pure logical function is_ascii(text)
    character(*), intent(in) :: text
    integer :: i, bits
    bits = 0
    do i = 1, len(text)
      bits = ior(bits, ichar(text(i:i)))
    end do
    is_ascii = bits < 128
  end function is_ascii

  !> Whether all bytes are letters of UTF-8.
  pure logical function is_utf8(text)
    character(*), intent(in) :: text
    integer :: i, width
    is_utf8 = is_ascii(text)
    if (is_utf8) return
    i = 1
    do while (i <= len(text))
      width = utf8_width(text(i:))
      if (width == 0) return
      i = i + width
    end do
    is_utf8 = .true.
  end function is_utf8

  !> The letter U+0080 to U+00FF of a byte of Latin-1.
  pure function letter_of_latin1(byte) result(letter)
    character, intent(in) :: byte
    character(2) :: letter
    letter = char(192 + ichar(byte)/64)//char(128 + iand(ichar(byte), 63))
  end function letter_of_latin1

  !> A text in UTF-8 with its letters U+0080 to U+00FF as bytes of Latin-1; others stay.
  pure function latin1_of_utf8(text) result(latin1)
    character(*), intent(in) :: text
    character(:), allocatable :: latin1
    integer :: i, width
    latin1 = ''
    i = 1
    do while (i <= len(text))
      width = max(1, utf8_width(text(i:)))
      if (width == 2 .and. ichar(text(i:i)) < 196) then
        latin1 = latin1//char(iand(ichar(text(i:i)), 3)*64 + iand(ichar(text(i + 1:i + 1)), 63))
      else
        latin1 = latin1//text(i:i + width - 1)
      end if
      i = i + width
    end do
  end function latin1_of_utf8
end module utf8_text
