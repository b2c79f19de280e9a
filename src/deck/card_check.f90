!> Checks cards against the specifications of their keywords; every fault is told, none stops it.
module card_check
  use deck_card, only: card
  use diagnostics, only: diagnostic_list
  use keyword_spec, only: keyword
  use parse_text, only: without_blanks
  implicit none
  private
  public :: check_card, match_card, find_spec

contains

  !> Position of the specification a card belongs to; names compare with blanks removed.
  !>
  !> Where two keywords share a name (*DAMPING of a material and of a step), the one whose `place`
  !> is the given one is found, else the first.
  pure integer function find_spec(specs, name, where_it_stands) result(found)
    type(keyword), intent(in) :: specs(:)
    character(*), intent(in) :: name !< upper case, without the star
    character(*), intent(in), optional :: where_it_stands !< 'model', 'step', 'material', ..
    character(:), allocatable :: wanted
    integer :: i
    found = 0
    wanted = without_blanks(name)
    do i = size(specs), 1, -1
      if (without_blanks(specs(i)%name) /= wanted) cycle
      found = i
      if (.not. present(where_it_stands) .or. .not. allocated(specs(i)%place)) cycle
      if (specs(i)%place == where_it_stands) return
    end do
  end function find_spec

  !> Finds the keyword of a card. Unknown or not yet available: an error; without effect: noted.
  subroutine match_card(the_card, specs, faults, found, where_it_stands)
    type(card), intent(in) :: the_card
    type(keyword), intent(in) :: specs(:)
    type(diagnostic_list), intent(inout) :: faults
    integer, intent(out) :: found !< position in `specs`; 0: there is nothing to do for this card
    character(*), intent(in), optional :: where_it_stands !< see `find_spec`
    found = find_spec(specs, the_card%keyword, where_it_stands)
    if (found == 0) call the_card%fault(faults, "unknown keyword")
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
