!> The flat model: the cards of a deck with parts as cards of a deck without them. The handlers of
!> keywords see flat cards only; every word keeps its place in the deck.
module flatten_assembly
  use assembly_structure, only: find_structure, is_structural, model_structure, part_instance
  use card_rewrite, only: card_rewriter
  use deck_card, only: card
  use diagnostics, only: diagnostic_list
  use instance_list, only: mesh_instance
  use instance_numbers, only: find_numbers
  use instance_words, only: rewrite_card
  use keyword_spec, only: keyword
  implicit none
  private
  public :: flatten

contains

  !> Makes the cards flat. A deck without parts stays as it is, without instances. After an error of
  !> the structure no card is left: all others would be its consequences.
  subroutine flatten(cards, specs, outside, instances, faults)
    type(card), allocatable, intent(inout) :: cards(:)
    type(keyword), intent(in) :: specs(:)
    type(mesh_instance), intent(out) :: outside !< what stands outside the instances
    type(mesh_instance), allocatable, intent(out) :: instances(:)
    type(diagnostic_list), intent(inout) :: faults
    type(model_structure) :: structure
    type(card), allocatable :: flat(:)
    integer :: i, num_before
    num_before = faults%num_errors
    allocate (instances(0))
    if (.not. any([(is_structural(cards(i)), i=1, size(cards))])) then
      call fault_instances(cards, faults)
      return
    end if
    call find_structure(cards, specs, structure, faults)
    call find_numbers(cards, structure, faults)
    if (faults%num_errors > num_before) structure%num_cards = 0
    allocate (flat(structure%num_cards))
    do i = 1, size(flat)
      flat(i) = cards(structure%cards(i)%card)
      call rewrite_card(flat(i), structure%cards(i), structure, specs, faults)
      if (flat(i)%keyword == 'TIE') call adjust_tie(flat(i))
    end do
    call move_alloc(flat, cards)
    call list_instances(structure, outside, instances)
  end subroutine flatten

  !> INSTANCE= needs an assembly.
  subroutine fault_instances(cards, faults)
    type(card), intent(in) :: cards(:)
    type(diagnostic_list), intent(inout) :: faults
    integer :: i
    do i = 1, size(cards)
      if (cards(i)%keyword /= 'NSET' .and. cards(i)%keyword /= 'ELSET') cycle
      if (.not. cards(i)%has('INSTANCE')) cycle
      call cards(i)%fault_parameter(faults, 'INSTANCE', 'the deck has no instances', &
                                    'INSTANCE in an *ASSEMBLY only')
    end do
  end subroutine fault_instances

  !> In decks with parts a tie moves the slave nodes onto the master surface, as in Abaqus.
  subroutine adjust_tie(this)
    type(card), intent(inout) :: this
    type(card_rewriter) :: words
    if (this%has('ADJUST') .or. this%has('STIFFNESS')) return
    call words%begin(this)
    call words%add_parameter(this, 'ADJUST', 'YES')
    call words%finish(this)
  end subroutine adjust_tie

  !> The instances with the range of their numbers and what is added to them.
  subroutine list_instances(structure, outside, instances)
    type(model_structure), intent(in) :: structure
    type(mesh_instance), intent(out) :: outside
    type(mesh_instance), allocatable, intent(out) :: instances(:)
    integer :: k
    allocate (instances(size(structure%instances) - 1))
    outside = listed(structure%instances(1))
    do k = 1, size(instances)
      instances(k) = listed(structure%instances(k + 1))
    end do
  end subroutine list_instances

  !> An instance as the model has it.
  pure function listed(instance) result(one)
    type(part_instance), intent(in) :: instance
    type(mesh_instance) :: one
    one%name = instance%name
    one%part = instance%part
    one%first_node = instance%nodes%lowest
    one%last_node = instance%nodes%highest
    one%has_members = max(instance%nodes%highest, instance%elements%highest) > 0
    one%nodes_added = instance%nodes%offset
    one%elements_added = instance%elements%offset
  end function listed
end module flatten_assembly
