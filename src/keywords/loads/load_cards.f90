!> The cards that give the loads of the steps, found by the family and the target of a load.
module load_cards
  use base_motion_cards, only: directions_of_motion, moves_base
  use deck_card, only: card
  use deck_scan, only: is_keyword, steps_of_cards
  use dload_labels, only: elements_in_words
  use growing_lists, only: append, make_room
  use node_dofs, only: num_directions
  use text_table, only: text_numbers
  use write_text, only: as_text
  implicit none
  private
  public :: load_card_list, list_load_cards, target_of_motion

  !> The cards of each load, newest first.
  type :: load_card_list
    private
    type(text_numbers) :: names !< of family and target
    integer :: num_names = 0, num_entries = 0
    integer, allocatable :: newest(:) !< (names) entry
    integer, allocatable :: before(:) !< (entries) entry of the same name, 0 for none
    integer, allocatable :: card(:) !< (entries)
    integer, allocatable :: step(:) !< (cards)
  contains
    procedure :: find
    procedure, private :: add
  end type load_card_list

contains

  !> Lists *DLOAD, *DSLOAD, *RESERVOIR and motions of the base.
  pure subroutine list_load_cards(cards, list)
    type(card), intent(in) :: cards(:) !< of the deck
    type(load_card_list), intent(out) :: list
    integer :: i, line, dof
    logical :: moves(num_directions)
    allocate (list%step(size(cards)))
    list%step = steps_of_cards(cards)
    do i = 1, size(cards)
      if (is_keyword(cards(i), 'RESERVOIR')) then
        call list%add('RESERVOIR', cards(i)%word('NAME'), i)
      else if (moves_base(cards(i))) then
        moves = directions_of_motion(cards(i))
        do dof = 1, size(moves)
          if (moves(dof)) then
            call list%add('BASE MOTION', target_of_motion(dof, cards(i)%word('AMPLITUDE')), i)
          end if
        end do
      else if (is_keyword(cards(i), 'DLOAD')) then
        do line = 1, cards(i)%num_lines
          call list%add('DLOAD', elements_in_words(cards(i), line)//' '// &
                        cards(i)%word_at(line, 2), i)
        end do
      else if (is_keyword(cards(i), 'DSLOAD')) then
        do line = 1, cards(i)%num_lines
          call list%add('DSLOAD', target_on_surface(cards(i), line), i)
        end do
      end if
    end do
  end subroutine list_load_cards

  !> A direction and a record.
  pure function target_of_motion(dof, record) result(target)
    integer, intent(in) :: dof
    character(*), intent(in) :: record !< its name
    character(:), allocatable :: target
    target = as_text(dof)//' '//record
  end function target_of_motion

  !> Target of a line of *DSLOAD: 'UPSTREAM', 'UPSTREAM HP'.
  pure function target_on_surface(this, line) result(target)
    type(card), intent(in) :: this
    integer, intent(in) :: line
    character(:), allocatable :: target
    target = this%word_at(line, 1)
    if (this%word_at(line, 2) == 'HP') target = target//' HP'
  end function target_on_surface

  !> Adds a card of a load.
  pure subroutine add(self, family, target, number)
    class(load_card_list), intent(inout) :: self
    character(*), intent(in) :: family, target
    integer, intent(in) :: number !< of the card
    integer :: name, before
    call self%names%find_or_add(name_of(family, target), name)
    before = 0
    if (name > self%num_names) then
      call append(self%newest, self%num_names, 0)
    else
      before = self%newest(name)
      if (self%card(before) == number) return
    end if
    call make_room(self%before, self%num_entries, 1)
    self%before(self%num_entries + 1) = before
    call append(self%card, self%num_entries, number)
    self%newest(name) = self%num_entries
  end subroutine add

  !> The text that identifies a load.
  pure function name_of(family, target) result(name)
    character(*), intent(in) :: family, target
    character(:), allocatable :: name
    name = family//new_line('a')//target
  end function name_of

  !> The last card that gives a load, up to a step; `otherwise` for none.
  pure integer function find(self, family, target, step, otherwise) result(number)
    class(load_card_list), intent(in) :: self
    character(*), intent(in) :: family !< its keyword
    character(*), intent(in) :: target !< 'DAM GRAV', 'UPSTREAM', a reservoir, a motion
    integer, intent(in) :: step
    integer, intent(in) :: otherwise !< a card, or 0
    integer :: name, entry
    number = otherwise
    name = self%names%find(name_of(family, target))
    if (name == 0) return
    entry = self%newest(name)
    do while (entry > 0)
      if (self%step(self%card(entry)) <= step) exit
      entry = self%before(entry)
    end do
    if (entry > 0) number = self%card(entry)
  end function find
end module load_cards
