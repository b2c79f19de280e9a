!> Finds the keyword of a card. Unknown, refused and idle keywords are reported.
module card_match
  use card_check, only: check_given_parameters, is_refused, longest_name
  use deck_card, only: card
  use diagnostics, only: diagnostic_list, severity_ignored
  use keyword_spec, only: find_spec, keyword, later, refused, spec_of_variant, without_effect
  use nearest_words, only: nearest_word, word_distance
  implicit none
  private
  public :: match_card

  integer, parameter :: most_slips = 2 !< changes of a word that is meant all the same

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

  !> Reports an unknown keyword, with the known keyword of the nearest spelling. What is refused is
  !> no suggestion: the message says what to take in its place.
  subroutine fault_unknown(the_card, specs, faults)
    type(card), intent(in) :: the_card
    type(keyword), intent(in) :: specs(:)
    type(diagnostic_list), intent(inout) :: faults
    character(longest_name) :: names(size(specs))
    character(:), allocatable :: nearest, unavailable, instead
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
      call drop_refused(the_card%keyword, specs, nearest, unavailable, instead)
      if (len(nearest) + len(unavailable) == 0) then
        call put_comma(the_card%keyword, specs, nearest, unavailable, instead)
      end if
      if (len(unavailable) > 0) then
        call the_card%fault(faults, 'unknown keyword, and *'//unavailable//' is not available', &
                            instead)
        return
      end if
      if (len(nearest) > 0) nearest = '*'//nearest
      call the_card%fault(faults, 'unknown keyword', nearest=nearest)
    end if
  end subroutine fault_unknown

  !> Takes away a nearest keyword that is not available.
  subroutine drop_refused(text, specs, nearest, unavailable, instead)
    character(*), intent(in) :: text !< the unknown keyword
    type(keyword), intent(in) :: specs(:)
    character(:), allocatable, intent(inout) :: nearest !< '' for one that is not available
    character(:), allocatable, intent(out) :: unavailable !< a refused keyword that is meant, or ''
    character(:), allocatable, intent(out) :: instead !< what to take in its place
    integer :: found
    unavailable = ''
    instead = ''
    found = find_spec(specs, nearest)
    if (found == 0) return
    if (.not. any(specs(found)%status == [later, refused])) return
    if (specs(found)%status == refused .and. word_distance(text, nearest) <= most_slips) then
      unavailable = nearest
      instead = specs(found)%way_out
    end if
    nearest = ''
  end subroutine drop_refused

  !> 'DYNAMIC, DIRECT' for 'DYNAMIC DIRECT': a keyword and one of its parameters without a comma.
  pure subroutine put_comma(text, specs, better, unavailable, instead)
    character(*), intent(in) :: text !< the unknown keyword
    type(keyword), intent(in) :: specs(:)
    character(:), allocatable, intent(out) :: better !< '' for another text
    character(:), allocatable, intent(out) :: unavailable !< the same with a refused parameter
    character(:), allocatable, intent(out) :: instead !< what to take in place of this parameter
    logical :: is_there
    integer :: i, length
    better = ''
    unavailable = ''
    instead = ''
    do i = 1, size(specs)
      if (any(specs(i)%status == [later, refused])) cycle
      length = len(specs(i)%name)
      if (index(text, specs(i)%name//' ') /= 1) cycle
      call find_parameter(specs(i), text(length + 2:), is_there, instead)
      if (.not. is_there) cycle
      better = text(:length)//','//text(length + 1:)
      exit
    end do
    if (len(instead) == 0) return
    unavailable = better
    better = ''
  end subroutine put_comma

  !> Finds a parameter of a keyword, or of one of its variants.
  pure subroutine find_parameter(spec, name, is_there, instead)
    type(keyword), intent(in) :: spec
    character(*), intent(in) :: name !< upper case
    logical, intent(out) :: is_there
    character(:), allocatable, intent(out) :: instead !< of a refused parameter, else ''
    type(keyword) :: whole
    integer :: i
    is_there = .false.
    instead = ''
    if (.not. allocated(spec%parameters)) return
    whole = spec
    if (allocated(spec%variants)) whole = spec_of_variant(spec, '')
    do i = 1, size(whole%parameters)
      if (whole%parameters(i)%name /= name) cycle
      is_there = .true.
      if (is_refused(whole%parameters(i))) instead = whole%parameters(i)%instead
    end do
  end subroutine find_parameter
end module card_match
