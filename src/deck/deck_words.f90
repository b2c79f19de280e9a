!> Finds the words of a line: commas separate words, quotes protect commas.
module deck_words
  implicit none
  private
  public :: next_word, split_parameter, strip_quotes, is_blank

  character, parameter :: tab = achar(9)

contains

  !> Finds the next word of a line: the text between two commas, without blanks around it.
  !>
  !> A quote at the start of a word or of the value after '=' protects commas if the line closes the
  !> quote; other quotes are letters. The quotes themselves belong to the word here.
  pure subroutine next_word(line, position, first, last)
    character(*), intent(in) :: line
    integer, intent(inout) :: position !< where to begin; then after the comma; len + 2: none
    integer, intent(out) :: first, last !< of the word; first > last for an empty word
    integer :: i
    logical :: may_open
    first = position
    last = position - 1
    may_open = .true.
    i = position
    do while (i <= len(line))
      if (line(i:i) == ',') exit
      if (is_blank(line(i:i))) then
        if (last < first) first = i + 1
      else
        if (may_open) i = closing_quote(line, i)
        may_open = line(i:i) == '='
        last = i
      end if
      i = i + 1
    end do
    last = max(last, first - 1)
    position = i + 1
  end subroutine next_word

  !> Position of the quote that closes the quote at `i`; `i` itself if there is none.
  pure integer function closing_quote(line, i) result(closing)
    character(*), intent(in) :: line
    integer, intent(in) :: i
    closing = i
    if (line(i:i) == "'" .or. line(i:i) == '"') closing = i + index(line(i + 1:), line(i:i))
  end function closing_quote

  !> Removes the quotes around a word.
  pure subroutine strip_quotes(line, first, last)
    character(*), intent(in) :: line
    integer, intent(inout) :: first, last !< of the word
    if (last <= first) return
    if (closing_quote(line, first) /= last) return
    first = first + 1
    last = last - 1
    do while (first <= last)
      if (.not. is_blank(line(first:first))) exit
      first = first + 1
    end do
    do while (last >= first)
      if (.not. is_blank(line(last:last))) exit
      last = last - 1
    end do
  end subroutine strip_quotes

  !> Whether a letter is a blank or a tab.
  elemental logical function is_blank(letter)
    character, intent(in) :: letter
    is_blank = letter == ' ' .or. letter == tab
  end function is_blank

  !> Splits KEY=VALUE: bounds of both parts in the line, without blanks and without quotes.
  pure subroutine split_parameter(line, first, last, equals, key_last, value_first, value_last)
    character(*), intent(in) :: line
    integer, intent(in) :: first, last !< the word, as `next_word` finds it
    integer, intent(out) :: equals !< position of the '=', 0 for a flag
    integer, intent(out) :: key_last !< end of the key, which begins with the word
    integer, intent(out) :: value_first, value_last !< first > last without a value
    key_last = last
    value_first = last + 1
    value_last = last
    equals = index(line(first:last), '=')
    if (equals == 0) return
    equals = first + equals - 1
    key_last = equals - 1
    do while (key_last >= first)
      if (.not. is_blank(line(key_last:key_last))) exit
      key_last = key_last - 1
    end do
    value_first = equals + 1
    do while (value_first <= last)
      if (.not. is_blank(line(value_first:value_first))) exit
      value_first = value_first + 1
    end do
    call strip_quotes(line, value_first, value_last)
  end subroutine split_parameter
end module deck_words
