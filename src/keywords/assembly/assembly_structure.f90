!> Which part, instance or assembly each card of a deck stands in.
module assembly_structure
  use card_check, only: check_card, longest_name
  use deck_card, only: card
  use diagnostics, only: diagnostic_list
  use instance_placement, only: placement, read_placement
  use keyword_spec, only: available, find_spec, keyword
  use nearest_words, only: nearest_word
  use parse_text, only: without_blanks
  implicit none
  private
  public :: model_structure, part_instance, number_range, flat_card, find_structure, is_structural

  character(*), parameter :: structural = ' | PART | ENDPART | ASSEMBLY | ENDASSEMBLY | '// &
                             'INSTANCE | ENDINSTANCE | '
  character(*), parameter :: in_parts = ' | NODE | ELEMENT | NSET | ELSET | SURFACE | '// &
                             'SOLIDSECTION | '

  !> The cards of a part stand between two cards of the deck.
  type :: part
    character(:), allocatable :: name !< upper case
    integer :: first = 0, last = -1 !< cards *PART and *END PART
    logical :: is_used = .false. !< an instance places it
  end type part

  !> Numbers of the nodes or of the elements of an instance.
  type :: number_range
    integer :: lowest = huge(1), highest = 0 !< in the deck
    integer :: offset = 0 !< added in the flat model
  end type number_range

  !> A part in its place; the first `part_instance` of a model is all that stands outside.
  type :: part_instance
    character(:), allocatable :: name !< upper case, '' outside
    character(:), allocatable :: part !< upper case, '' outside
    integer :: card = 0 !< *INSTANCE; outside, the first *NODE or *ELEMENT
    type(placement) :: place
    type(number_range) :: nodes, elements
    logical :: is_repeat = .false. !< an earlier instance has the same part
  end type part_instance

  !> A card of the flat model.
  type :: flat_card
    integer :: card = 0 !< of the deck
    integer :: owner = 1 !< position in `instances`
    logical :: is_from_part = .false.
  end type flat_card

  type :: model_structure
    type(part), allocatable :: parts(:)
    type(part_instance), allocatable :: instances(:)
    type(flat_card), allocatable :: cards(:) !< of the flat model, in its order
    integer :: num_cards = 0 !< in use
    ! While the cards are read: cards that opened what is open, 0 for none.
    integer :: part = 0, assembly = 0, instance = 0
  end type model_structure

contains

  !> Whether a card belongs to the structure.
  pure logical function is_structural(this)
    type(card), intent(in) :: this
    is_structural = index(structural, ' | '//without_blanks(this%keyword)//' | ') > 0
  end function is_structural

  !> Reads the structure; the flat model has the cards of a part where each instance stands.
  subroutine find_structure(cards, specs, structure, faults)
    type(card), intent(inout) :: cards(:) !< structural cards get their specification
    type(keyword), intent(in) :: specs(:)
    type(model_structure), intent(out) :: structure
    type(diagnostic_list), intent(inout) :: faults
    integer :: i
    logical :: is_right
    allocate (structure%parts(0), structure%instances(1), structure%cards(size(cards)))
    structure%instances(1)%name = ''
    structure%instances(1)%part = ''
    do i = 1, size(cards)
      if (is_structural(cards(i))) then
        call check_card(cards(i), specs(find_spec(specs, cards(i)%keyword)), faults, is_right)
        ! A faulty end is an end, so that what follows is not taken as part of the block.
        if (index(cards(i)%keyword, 'END') == 1) is_right = .true.
        if (is_right) call read_structural(cards, i, structure, faults)
      else if (structure%part > 0) then
        call check_part_card(cards(i), specs, 'a part', faults)
      else
        if (structure%instance > 0) call check_part_card(cards(i), specs, 'an instance', faults)
        call append_card(structure, i, merge(size(structure%instances), 1, &
                                             structure%instance > 0), .false.)
      end if
    end do
    call check_ends(cards, structure, faults)
  end subroutine find_structure

  !> Parts and instances hold meshes and sections only.
  subroutine check_part_card(this, specs, where_it_stands, faults)
    type(card), intent(in) :: this
    type(keyword), intent(in) :: specs(:)
    character(*), intent(in) :: where_it_stands
    type(diagnostic_list), intent(inout) :: faults
    integer :: found
    found = find_spec(specs, this%keyword)
    if (found == 0) return ! reported when the card is checked
    if (specs(found)%status /= available) return
    if (index(in_parts, ' | '//without_blanks(this%keyword)//' | ') > 0) return
    call this%fault(faults, 'the keyword is in '//where_it_stands, '*NODE, *ELEMENT, *NSET, '// &
                    '*ELSET, *SURFACE or *SOLID SECTION there; the others after *END ASSEMBLY')
  end subroutine check_part_card

  subroutine read_structural(cards, i, structure, faults)
    type(card), intent(in) :: cards(:)
    integer, intent(in) :: i !< a structural card that agrees with its specification
    type(model_structure), intent(inout) :: structure
    type(diagnostic_list), intent(inout) :: faults
    select case (without_blanks(cards(i)%keyword))
    case ('PART')
      call open_part(cards, i, structure, faults)
    case ('ENDPART')
      call close_block(cards(i), structure%part, '*PART', faults)
      if (size(structure%parts) > 0) structure%parts(size(structure%parts))%last = i
    case ('ASSEMBLY')
      if (structure%part + structure%assembly > 0) then
        call cards(i)%fault(faults, 'the assembly begins in a part or an assembly', &
                            '*END PART or *END ASSEMBLY before it')
      end if
      structure%assembly = i
    case ('ENDASSEMBLY')
      call close_block(cards(i), structure%assembly, '*ASSEMBLY', faults)
    case ('INSTANCE')
      call open_instance(cards, i, structure, faults)
    case default ! *END INSTANCE
      call close_block(cards(i), structure%instance, '*INSTANCE', faults)
    end select
  end subroutine read_structural

  subroutine open_part(cards, i, structure, faults)
    type(card), intent(in) :: cards(:)
    integer, intent(in) :: i
    type(model_structure), intent(inout) :: structure
    type(diagnostic_list), intent(inout) :: faults
    type(part) :: new
    integer :: found
    if (max(structure%part, structure%assembly) > 0) then
      call cards(i)%fault(faults, 'a part inside a part or an assembly', '*END PART before it', &
                          first=cards(max(structure%part, structure%assembly))%place())
    end if
    new%name = cards(i)%word('NAME')
    new%first = i
    found = find_part(structure%parts, new%name)
    if (found > 0) then
      call cards(i)%fault_parameter(faults, 'NAME', "part '"//cards(i)%text('NAME')// &
                                    "' is defined twice", 'a name that is used once', &
                                    first=cards(structure%parts(found)%first)%place())
    end if
    call append_part(structure%parts, new)
    structure%part = i
  end subroutine open_part

  !> Closes a part, the assembly or an instance.
  subroutine close_block(this, opened, name, faults)
    type(card), intent(in) :: this
    integer, intent(inout) :: opened !< card, 0 for none
    character(*), intent(in) :: name !< of the keyword that opens it
    type(diagnostic_list), intent(inout) :: faults
    if (opened == 0) call this%fault(faults, 'nothing is open here', name//' before it')
    opened = 0
  end subroutine close_block

  !> Adds an instance, and the cards of its part to the flat model.
  subroutine open_instance(cards, i, structure, faults)
    type(card), intent(in) :: cards(:)
    integer, intent(in) :: i
    type(model_structure), intent(inout) :: structure
    type(diagnostic_list), intent(inout) :: faults
    type(part_instance) :: new
    integer :: found, k
    if (structure%assembly == 0 .or. structure%instance > 0) then
      call cards(i)%fault(faults, 'the instance is not directly in an assembly', &
                          '*ASSEMBLY or *END INSTANCE before it')
    end if
    structure%instance = i
    new%name = cards(i)%word('NAME')
    new%part = cards(i)%word('PART')
    new%card = i
    call read_placement(cards(i), new%place, faults)
    call check_instance_name(cards, new, structure, faults)
    found = find_part(structure%parts, new%part)
    if (found > 0) then
      new%is_repeat = structure%parts(found)%is_used
      structure%parts(found)%is_used = .true.
    end if
    call append_instance(structure%instances, new)
    if (found == 0) then
      call fault_unknown_part(cards(i), structure%parts, faults)
      return
    end if
    do k = structure%parts(found)%first + 1, structure%parts(found)%last - 1
      call append_card(structure, k, size(structure%instances), .true.)
    end do
  end subroutine open_instance

  subroutine check_instance_name(cards, new, structure, faults)
    type(card), intent(in) :: cards(:)
    type(part_instance), intent(in) :: new
    type(model_structure), intent(in) :: structure
    type(diagnostic_list), intent(inout) :: faults
    integer :: k
    do k = 2, size(structure%instances)
      if (structure%instances(k)%name /= new%name) cycle
      call cards(new%card)%fault_parameter(faults, 'NAME', "instance '"//new%name// &
                                           "' is defined twice", 'a name that is used once', &
                                           first=cards(structure%instances(k)%card)%place())
    end do
  end subroutine check_instance_name

  subroutine fault_unknown_part(this, parts, faults)
    type(card), intent(in) :: this
    type(part), intent(in) :: parts(:)
    type(diagnostic_list), intent(inout) :: faults
    character(longest_name) :: names(size(parts))
    integer :: k
    do k = 1, size(parts)
      names(k) = parts(k)%name
    end do
    call this%fault_parameter(faults, 'PART', "there is no part '"//this%text('PART')// &
                              "' above this line", &
                              'the name of a *PART above', nearest_word(this%word('PART'), names))
  end subroutine fault_unknown_part

  !> What is open must be closed; a part without an instance has no effect.
  subroutine check_ends(cards, structure, faults)
    type(card), intent(in) :: cards(:)
    type(model_structure), intent(in) :: structure
    type(diagnostic_list), intent(inout) :: faults
    integer :: k
    if (structure%part > 0) call cards(structure%part)%fault(faults, &
                                                             'the part has no end', '*END PART')
    if (structure%assembly > 0) call cards(structure%assembly)%fault( &
      faults, 'the assembly has no end', '*END ASSEMBLY')
    if (structure%instance > 0) call cards(structure%instance)%fault( &
      faults, 'the instance has no end', '*END INSTANCE')
    do k = 1, size(structure%parts)
      if (structure%parts(k)%is_used) cycle
      call cards(structure%parts(k)%first)%ignore(faults, 'no *INSTANCE places the part: it '// &
                                                  'has no effect')
    end do
  end subroutine check_ends

  !> Position of the part of that name, 0 for none.
  pure integer function find_part(parts, name) result(found)
    type(part), intent(in) :: parts(:)
    character(*), intent(in) :: name !< upper case
    do found = size(parts), 1, -1
      if (parts(found)%name == name) return
    end do
  end function find_part

  pure subroutine append_part(list, new)
    type(part), allocatable, intent(inout) :: list(:)
    type(part), intent(in) :: new
    type(part), allocatable :: longer(:)
    allocate (longer(size(list) + 1))
    longer(:size(list)) = list
    longer(size(longer)) = new
    call move_alloc(longer, list)
  end subroutine append_part

  pure subroutine append_instance(list, new)
    type(part_instance), allocatable, intent(inout) :: list(:)
    type(part_instance), intent(in) :: new
    type(part_instance), allocatable :: longer(:)
    allocate (longer(size(list) + 1))
    longer(:size(list)) = list
    longer(size(longer)) = new
    call move_alloc(longer, list)
  end subroutine append_instance

  !> Adds a card to the flat model, whose list grows by doubling.
  pure subroutine append_card(structure, number, owner, is_from_part)
    type(model_structure), intent(inout) :: structure
    integer, intent(in) :: number, owner !< card of the deck, instance
    logical, intent(in) :: is_from_part
    type(flat_card), allocatable :: longer(:)
    integer :: used
    used = structure%num_cards
    if (used == size(structure%cards)) then
      allocate (longer(2*used + 8))
      longer(:used) = structure%cards
      call move_alloc(longer, structure%cards)
    end if
    structure%cards(used + 1) = flat_card(number, owner, is_from_part)
    structure%num_cards = used + 1
  end subroutine append_card
end module assembly_structure
