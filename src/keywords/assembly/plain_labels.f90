!> Labels with quotes inside, as "Part 1-1".Set, without their quotes.
module plain_labels
  use card_rewrite, only: card_rewriter
  use deck_card, only: card
  implicit none
  private
  public :: drop_inner_quotes, plain_label

contains

  !> Removes the quotes from fields and values that hold a quoted name and more.
  subroutine drop_inner_quotes(cards)
    type(card), intent(inout) :: cards(:)
    type(card_rewriter) :: words
    character(:), allocatable :: name
    integer :: i, k, line, field
    do i = 1, size(cards)
      if (cards(i)%keyword == 'HEADING') cycle
      if (index(cards(i)%lines%body, '".') + index(cards(i)%lines%body, '."') == 0) cycle
      call words%begin(cards(i))
      do k = 1, size(cards(i)%parameters)
        name = cards(i)%text(cards(i)%parameters(k)%name)
        if (is_joined(name)) call words%put_value(cards(i), k, plain_label(name))
      end do
      do line = 1, cards(i)%num_lines
        do field = 1, cards(i)%num_fields(line)
          name = cards(i)%text_at(line, field)
          if (is_joined(name)) call words%put_field(cards(i), line, field, plain_label(name))
        end do
      end do
      call words%finish(cards(i))
    end do
  end subroutine drop_inner_quotes

  !> A quoted name before or behind a point.
  pure logical function is_joined(name)
    character(*), intent(in) :: name
    is_joined = index(name, '".') > 0 .or. index(name, '."') > 0
  end function is_joined

  !> A name without the quotes inside; any other name as it is.
  pure function plain_label(name) result(plain)
    character(*), intent(in) :: name
    character(:), allocatable :: plain
    integer :: i
    plain = name
    if (.not. is_joined(name)) return
    plain = ''
    do i = 1, len(name)
      if (name(i:i) /= '"') plain = plain//name(i:i)
    end do
  end function plain_label
end module plain_labels
