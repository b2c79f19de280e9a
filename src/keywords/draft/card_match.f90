!> Finds the keyword of a card. Unknown, refused and idle keywords are reported.
module card_match
  use card_check, only: check_given_parameters, longest_name
  use deck_card, only: card
  use diagnostics, only: diagnostic_list, severity_ignored
  use keyword_spec, only: find_spec, keyword, later, refused, without_effect
  use nearest_words, only: nearest_word
  implicit none
  private
  public :: match_card

contains

  !> Finds the keyword of a card. An unknown or unavailable keyword is an error; a keyword without
  !> effect is noted.
  subroutine match_card(the_card, specs, faults, found, where_it_stands)
    type(card), intent(in) :: the_card
    type(keyword), intent(in) :: specs(:)
    type(diagnostic_list), intent(inout) :: faults
    integer, intent(out) :: found !< position in `specs`; 0: ignore the card
    character(*), intent(in), optional :: where_it_stands !< see `find_spec`
    found = find_spec(specs, the_card%keyword, where_it_stands)
    if (found == 0) then
      call fault_unknown(the_card, specs, faults)
    else if (specs(found)%status == later) then
      call the_card%fault(faults, 'not available yet')
      found = 0
    else if (specs(found)%status == refused) then
      call the_card%fault(faults, 'not available', specs(found)%way_out)
      found = 0
    else if (specs(found)%status == without_effect) then
      call the_card%ignore(faults, 'has no effect here')
      call note_odd_parameters(the_card, specs(found), faults)
      found = 0
    end if
  end subroutine match_card

  !> Notes the unknown parameters and values of a card without effect whose parameters are known.
  subroutine note_odd_parameters(the_card, spec, faults)
    type(card), intent(in) :: the_card
    type(keyword), intent(in) :: spec
    type(diagnostic_list), intent(inout) :: faults
    type(card) :: checked
    type(diagnostic_list) :: found
    logical :: has_unknown_choice
    integer :: i
    if (.not. allocated(spec%parameters)) return
    if (size(spec%parameters) == 0) return
    checked = the_card
    checked%spec = spec
    call check_given_parameters(checked, found, has_unknown_choice)
    do i = 1, found%num_kept
      associate (fault => found%errors(i))
        call faults%add(severity_ignored, fault%spot, fault%problem, fault%expected, fault%nearest)
      end associate
    end do
  end subroutine note_odd_parameters

  !> Reports an unknown keyword, with the known keyword of the nearest spelling.
  subroutine fault_unknown(the_card, specs, faults)
    type(card), intent(in) :: the_card
    type(keyword), intent(in) :: specs(:)
    type(diagnostic_list), intent(inout) :: faults
    character(longest_name) :: names(size(specs))
    character(:), allocatable :: nearest
    integer :: i
    if (len(the_card%keyword) == 0) then
      call the_card%fault(faults, "no keyword after the '*'", "a keyword, or '**' for a comment")
    else if (index(the_card%keyword, '=') > 0) then
      call the_card%fault(faults, 'unknown keyword with a "="', &
                          'a comma between the keyword and its parameters')
    else
      do i = 1, size(specs)
        names(i) = specs(i)%name
      end do
      nearest = nearest_word(the_card%keyword, names)
      if (len(nearest) == 0) nearest = with_comma(the_card%keyword, names)
      if (len(nearest) > 0) nearest = '*'//nearest
      call the_card%fault(faults, 'unknown keyword', nearest=nearest)
    end if
  end subroutine fault_unknown

  !> 'DYNAMIC, DIRECT' for 'DYNAMIC DIRECT': a keyword and words behind it without a comma. ''
  !> where the text begins with no keyword.
  pure function with_comma(text, names) result(better)
    character(*), intent(in) :: text
    character(*), intent(in) :: names(:) !< known keywords
    character(:), allocatable :: better
    integer :: i, longest
    better = ''
    longest = 0
    do i = 1, size(names)
      if (len_trim(names(i)) <= longest .or. index(text, trim(names(i))//' ') /= 1) cycle
      longest = len_trim(names(i))
      better = text(:longest)//','//text(longest + 1:)
    end do
  end function with_comma
end module card_match
