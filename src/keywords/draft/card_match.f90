!> Finds the keyword of a card. Unknown, refused and idle keywords are reported.
module card_match
  use card_check, only: check_given_parameters, longest_name
  use deck_card, only: card
  use diagnostics, only: diagnostic_list, severity_ignored
  use keyword_spec, only: find_spec, keyword, later, refused, spec_of_variant, without_effect
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

  !> Reports an unknown keyword, with the known keyword of the nearest spelling. A keyword that is
  !> refused is no suggestion.
  subroutine fault_unknown(the_card, specs, faults)
    type(card), intent(in) :: the_card
    type(keyword), intent(in) :: specs(:)
    type(diagnostic_list), intent(inout) :: faults
    character(longest_name) :: names(size(specs))
    character(:), allocatable :: nearest
    integer :: i, found
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
      found = find_spec(specs, nearest)
      if (found > 0) then
        if (any(specs(found)%status == [later, refused])) nearest = ''
      end if
      if (len(nearest) == 0) nearest = with_comma(the_card%keyword, specs)
      if (len(nearest) > 0) nearest = '*'//nearest
      call the_card%fault(faults, 'unknown keyword', nearest=nearest)
    end if
  end subroutine fault_unknown

  !> 'DYNAMIC, DIRECT' for 'DYNAMIC DIRECT': a keyword and one of its parameters without a comma.
  !> '' for another text.
  pure function with_comma(text, specs) result(better)
    character(*), intent(in) :: text
    type(keyword), intent(in) :: specs(:)
    character(:), allocatable :: better
    integer :: i, length
    better = ''
    do i = 1, size(specs)
      if (any(specs(i)%status == [later, refused])) cycle
      length = len(specs(i)%name)
      if (index(text, specs(i)%name//' ') /= 1) cycle
      if (has_parameter(specs(i), text(length + 2:))) better = text(:length)//','//text(length + 1:)
    end do
  end function with_comma

  !> Whether a keyword, or one of its variants, has a parameter of this name.
  pure logical function has_parameter(spec, name)
    type(keyword), intent(in) :: spec
    character(*), intent(in) :: name !< upper case
    type(keyword) :: whole
    integer :: i
    has_parameter = .false.
    if (.not. allocated(spec%parameters)) return
    whole = spec
    if (allocated(spec%variants)) whole = spec_of_variant(spec, '')
    has_parameter = any([(whole%parameters(i)%name == name, i=1, size(whole%parameters))])
  end function has_parameter
end module card_match
