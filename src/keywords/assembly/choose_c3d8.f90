!> What C3D8 means: 2 x 2 x 2 points as in CalculiX, or the C3D8 of Abaqus, which is C3D8B here.
module choose_c3d8
  use card_rewrite, only: card_rewriter
  use deck_card, only: card
  use diagnostics, only: diagnostic_list
  implicit none
  private
  public :: choose_element

contains

  !> Makes C3D8B of C3D8 where the command line or the parts of the deck ask for it.
  subroutine choose_element(cards, choice, has_parts, faults)
    type(card), intent(inout) :: cards(:)
    character(*), intent(in) :: choice !< 'FULL', 'BBAR', '': by the deck
    logical, intent(in) :: has_parts
    type(diagnostic_list), intent(inout) :: faults
    type(card_rewriter) :: words
    logical :: is_said
    integer :: i
    if (choice == 'FULL' .or. (choice == '' .and. .not. has_parts)) return
    is_said = choice == 'BBAR'
    do i = 1, size(cards)
      if (cards(i)%keyword /= 'ELEMENT') cycle
      if (cards(i)%word('TYPE') /= 'C3D8') cycle
      call words%begin(cards(i))
      call words%put_value(cards(i), cards(i)%find_parameter('TYPE'), 'C3D8B')
      call words%finish(cards(i))
      if (.not. is_said) then
        call cards(i)%warn(faults, 'in a deck with parts C3D8 is the element of Abaqus, which '// &
                           'is C3D8B here; --c3d8=full takes 2 x 2 x 2 points')
      end if
      is_said = .true.
    end do
  end subroutine choose_element
end module choose_c3d8
