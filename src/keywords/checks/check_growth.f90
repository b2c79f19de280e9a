!> Warns of sets that get more members after a card has used them: the card has the members that
!> stood above it.
module check_growth
  use deck_card, only: card
  use deck_scan, only: is_keyword
  use diagnostics, only: diagnostic_list
  use model_draft, only: draft
  use text_table, only: text_numbers
  implicit none
  private
  public :: warn_of_growth

contains

  !> The deck must have no errors. Names of parts become others in their instances: decks with
  !> instances are left out.
  subroutine warn_of_growth(model, faults)
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(text_numbers) :: names !< of sets, with their kinds
    integer :: user(size(model%cards)) !< (names) first card that takes the set as it is, or 0
    character(:), allocatable :: kind
    integer :: i, n
    do i = 1, size(model%cards)
      if (is_keyword(model%cards(i), 'INSTANCE')) return
    end do
    user = 0
    do i = 1, size(model%cards)
      kind = kind_of_set(model%cards(i))
      n = 0
      if (kind /= '') then
        call names%find_or_add(kind//' '//model%cards(i)%word(kind), n)
        if (user(n) > 0) call warn_of_use(model%cards(i), kind, model%cards(user(n)), faults)
      end if
      call note_sets(model%cards(i), i, 'NSET', names, user)
      call note_sets(model%cards(i), i, 'ELSET', names, user)
      if (n > 0) user(n) = 0
    end do
  end subroutine warn_of_growth

  !> Warns of a card that adds to a set which a card above has taken.
  subroutine warn_of_use(this, kind, user, faults)
    type(card), intent(in) :: this, user
    character(*), intent(in) :: kind !< 'NSET' or 'ELSET'
    type(diagnostic_list), intent(inout) :: faults
    call this%warn(faults, "the set '"//this%text(kind)//"' gets members here that *"// &
                   user%spec%name//' above has not taken: complete a set before its first use')
  end subroutine warn_of_use

  !> The parameter by which a card adds to a set: 'NSET', 'ELSET' or ''.
  pure function kind_of_set(this) result(kind)
    type(card), intent(in) :: this
    character(:), allocatable :: kind
    kind = ''
    if (is_keyword(this, 'NODE') .or. is_keyword(this, 'NSET')) kind = 'NSET'
    if (is_keyword(this, 'ELEMENT') .or. is_keyword(this, 'ELSET')) kind = 'ELSET'
    if (kind == '') return
    if (.not. this%has(kind)) kind = ''
  end function kind_of_set

  !> Notes a card as the user of the sets that it takes as they are. Sections take sets at the end
  !> of the deck.
  subroutine note_sets(this, number, kind, names, user)
    type(card), intent(in) :: this
    integer, intent(in) :: number !< of the card
    character(*), intent(in) :: kind !< 'NSET' or 'ELSET'
    type(text_numbers), intent(in) :: names !< of sets, with their kinds
    integer, intent(inout) :: user(:) !< (names) 0 for none
    integer :: field, line
    if (.not. allocated(this%spec%name)) return
    if (this%spec%name == 'NODE PRINT' .or. this%spec%name == 'EL PRINT') then
      if (this%has(kind)) call note(this%word(kind))
      return
    end if
    do line = 1, merge(this%num_lines, 0, most_fields(this, kind) > 0)
      do field = 1, min(most_fields(this, kind), this%num_fields(line))
        if (.not. this%is_integer_at(line, field)) call note(this%word_at(line, field))
      end do
    end do

  contains

    subroutine note(name)
      character(*), intent(in) :: name !< upper case
      integer :: n
      n = names%find(kind//' '//name)
      if (n == 0) return
      if (user(n) == 0) user(n) = number
    end subroutine note
  end subroutine note_sets

  !> Fields of each line of a card that may name sets of a kind; an integer is a node or an element.
  pure integer function most_fields(this, kind)
    type(card), intent(in) :: this !< of a known keyword
    character(*), intent(in) :: kind !< 'NSET' or 'ELSET'
    most_fields = 0
    select case (this%spec%name)
    case ('BOUNDARY', 'CLOAD', 'INITIAL CONDITIONS', 'TEMPERATURE')
      if (kind == 'NSET') most_fields = 1
    case ('DLOAD', 'SURFACE')
      if (kind == 'ELSET' .or. this%word('TYPE') == 'NODE') most_fields = 1
    case ('MODEL CHANGE')
      if (kind == 'ELSET') most_fields = huge(1)
    case ('NSET', 'ELSET')
      if (kind == this%spec%name .and. .not. this%has('GENERATE')) most_fields = huge(1)
    case default
      continue ! the keyword takes no set
    end select
  end function most_fields
end module check_growth
