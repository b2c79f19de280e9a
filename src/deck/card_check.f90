!> Checks cards against the specifications of their keywords; every fault is told, none stops it.
module card_check
  use deck_card, only: card
  use diagnostics, only: diagnostic_list
  use keyword_spec, only: find_spec, keyword
  implicit none
  private
  public :: check_card, match_card

contains

  !> Finds the keyword of a card. Unknown or not yet available: an error; without effect: noted.
  subroutine match_card(the_card, specs, faults, found, where_it_stands)
    type(card), intent(in) :: the_card
    type(keyword), intent(in) :: specs(:)
    type(diagnostic_list), intent(inout) :: faults
    integer, intent(out) :: found !< position in `specs`; 0: there is nothing to do for this card
    character(*), intent(in), optional :: where_it_stands !< see `find_spec`
    found = find_spec(specs, the_card%keyword, where_it_stands)
    if (found == 0) call the_card%fault(faults, 'unknown keyword')
  end subroutine match_card

  !> Compares a card with its specification, keeps the specification in the card.
  subroutine check_card(the_card, spec, faults, is_right)
    type(card), intent(inout) :: the_card
    type(keyword), intent(in) :: spec
    type(diagnostic_list), intent(inout) :: faults
    logical, intent(out) :: is_right !< nothing was found
    integer :: num_before
    num_before = faults%num_errors
    the_card%spec = spec
    is_right = faults%num_errors == num_before
  end subroutine check_card
end module card_check
