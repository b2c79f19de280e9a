!> Which keyword and which step a card belongs to. The cards must have been checked.
module deck_scan
  use deck_card, only: card
  implicit none
  private
  public :: is_keyword, steps_of_cards

contains

  !> Whether a card has the keyword; blanks in the deck do not count.
  pure logical function is_keyword(this, name)
    type(card), intent(in) :: this
    character(*), intent(in) :: name !< upper case, without the star
    is_keyword = .false.
    if (allocated(this%spec%name)) is_keyword = this%spec%name == name
  end function is_keyword

  !> The step of each card: 0 before the first step and between steps.
  pure function steps_of_cards(cards) result(step)
    type(card), intent(in) :: cards(:) !< of the deck, in its order
    integer :: step(size(cards))
    integer :: i, number
    logical :: is_open
    number = 0
    is_open = .false.
    do i = 1, size(step)
      if (is_keyword(cards(i), 'STEP')) number = number + 1
      if (is_keyword(cards(i), 'STEP')) is_open = .true.
      step(i) = merge(number, 0, is_open)
      if (is_keyword(cards(i), 'END STEP')) is_open = .false.
    end do
  end function steps_of_cards
end module deck_scan
