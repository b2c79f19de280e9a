!> Numbers of nodes and elements in the flat model: those of the deck, plus a round number for an
!> instance whose range of numbers overlaps that of another one.
module instance_numbers
  use assembly_structure, only: model_structure, number_range
  use deck_card, only: card
  use diagnostics, only: diagnostic_list
  use element_catalogue, only: element_kinds, find_element_kind
  use kinds, only: long
  use write_text, only: as_text
  implicit none
  private
  public :: find_numbers, begins_element

contains

  !> Finds the ranges of all instances and chooses their offsets.
  subroutine find_numbers(cards, structure, faults)
    type(card), intent(in) :: cards(:) !< of the deck
    type(model_structure), intent(inout) :: structure
    type(diagnostic_list), intent(inout) :: faults
    type(number_range) :: ranges(size(structure%instances))
    integer :: i
    do i = 1, structure%num_cards
      associate (this => cards(structure%cards(i)%card), &
                 owner => structure%instances(structure%cards(i)%owner))
        if (this%keyword /= 'NODE' .and. this%keyword /= 'ELEMENT') cycle
        if (owner%card == 0) owner%card = structure%cards(i)%card
        if (this%keyword == 'NODE') then
          call widen(this, spread(.true., 1, this%num_lines), owner%nodes)
        else
          call widen(this, begins_element(this), owner%elements)
        end if
      end associate
    end do
    ranges = structure%instances%nodes
    call choose_offsets(cards, structure, ranges, faults)
    structure%instances%nodes = ranges
    ranges = structure%instances%elements
    call choose_offsets(cards, structure, ranges, faults)
    structure%instances%elements = ranges
    call warn_of_offsets(cards, structure, faults)
  end subroutine find_numbers

  !> Data lines of *ELEMENT that begin an element; the other ones continue it.
  pure function begins_element(this) result(begins)
    type(card), intent(in) :: this
    logical :: begins(this%num_lines)
    integer :: line, missing, kind, wanted
    kind = find_element_kind(this%word('TYPE'))
    wanted = element_kinds(max(kind, 1))%num_nodes
    missing = 0
    do line = 1, this%num_lines
      begins(line) = missing <= 0
      if (begins(line)) missing = wanted + 1
      missing = missing - this%num_fields(line)
    end do
  end function begins_element

  !> Widens a range by the numbers in the first fields.
  pure subroutine widen(this, counts, range)
    type(card), intent(in) :: this
    logical, intent(in) :: counts(:) !< (lines) the line begins with a number of its own
    type(number_range), intent(inout) :: range
    integer :: line, id
    do line = 1, this%num_lines
      if (.not. counts(line)) cycle
      id = this%integer_at(line, 1)
      if (id <= 0) cycle ! reported when the card is checked
      range%lowest = min(range%lowest, id)
      range%highest = max(range%highest, id)
    end do
  end subroutine widen

  !> Ranges that overlap an earlier one are moved by multiples of a power of ten. What stands
  !> outside the instances is the last to keep its numbers.
  subroutine choose_offsets(cards, structure, ranges, faults)
    type(card), intent(in) :: cards(:)
    type(model_structure), intent(in) :: structure
    type(number_range), intent(inout) :: ranges(:)
    type(diagnostic_list), intent(inout) :: faults
    integer(long) :: unit, offset
    logical :: keeps(size(ranges))
    integer :: i, k, num_moved
    unit = 10
    do while (unit <= maxval(ranges%highest))
      unit = 10*unit
    end do
    keeps = .false.
    num_moved = 0
    do k = 2, size(ranges) + 1
      i = merge(1, k, k > size(ranges))
      keeps(i) = .not. any(keeps .and. ranges%lowest <= ranges(i)%highest .and. &
                           ranges(i)%lowest <= ranges%highest)
      if (keeps(i) .or. ranges(i)%highest == 0) cycle
      num_moved = num_moved + 1
      offset = num_moved*unit
      if (offset + ranges(i)%highest > huge(1)) then
        call cards(structure%instances(i)%card)%fault( &
          faults, 'numbers up to '//as_text(ranges(i)%highest)//' leave no room for those of '// &
          'all instances', 'parts with smaller numbers')
        return
      end if
      ranges(i)%offset = int(offset)
    end do
  end subroutine choose_offsets

  !> Says once which numbers have changed, at the first card whose numbers have.
  subroutine warn_of_offsets(cards, structure, faults)
    type(card), intent(in) :: cards(:)
    type(model_structure), intent(in) :: structure
    type(diagnostic_list), intent(inout) :: faults
    integer, parameter :: most_named = 3
    character(:), allocatable :: list
    integer :: k, num_moved, first
    list = ''
    num_moved = 0
    do k = 1, size(structure%instances)
      associate (this => structure%instances(k))
        if (max(this%nodes%offset, this%elements%offset) == 0) cycle
        num_moved = num_moved + 1
        if (num_moved == 1) first = k
        if (num_moved > most_named) cycle
        if (num_moved > 1) list = list//'; '
        list = list//as_text(this%nodes%offset)//' to nodes and '// &
               as_text(this%elements%offset)//' to elements '//name_of(this%name)
      end associate
    end do
    if (num_moved == 0) return
    if (num_moved > most_named) list = list//'; and '//as_text(num_moved - most_named)//' more'
    call cards(structure%instances(first)%card)%warn( &
      faults, 'instances share numbers; results add '//list//' (job.json, instances, has all)')
  end subroutine warn_of_offsets

  !> Name of an instance for messages.
  pure function name_of(name) result(text)
    character(*), intent(in) :: name
    character(:), allocatable :: text
    text = 'of '//name
    if (len(name) == 0) text = 'outside the instances'
  end function name_of
end module instance_numbers
