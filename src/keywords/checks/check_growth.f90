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
    integer :: last(size(model%cards)) !< (names) card that has added to the set
    character(:), allocatable :: kind
    integer :: i, n
    do i = 1, size(model%cards)
      if (is_keyword(model%cards(i), 'INSTANCE')) return
    end do
    last = 0
    do i = 1, size(model%cards)
      kind = kind_of_set(model%cards(i))
      if (kind == '') cycle
      call names%find_or_add(kind//' '//model%cards(i)%word(kind), n)
      if (last(n) > 0) call warn_of_use(model%cards(last(n):i), kind, faults)
      last(n) = i
    end do
  end subroutine warn_of_growth

  !> Warns where a card between the first and the last has taken the set that both add to.
  subroutine warn_of_use(cards, kind, faults)
    type(card), intent(in) :: cards(:)
    character(*), intent(in) :: kind !< 'NSET' or 'ELSET'
    type(diagnostic_list), intent(inout) :: faults
    integer :: i
    associate (this => cards(size(cards)))
      do i = 2, size(cards) - 1
        if (.not. takes(cards(i), kind, this%word(kind))) cycle
        call this%warn(faults, "the set '"//this%text(kind)//"' gets members here that *"// &
                       cards(i)%spec%name//' above has not taken: complete a set before its '// &
                       'first use')
        return
      end do
    end associate
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

  !> Whether a card has taken the members of a set as they were. Sections take them at the end of
  !> the deck.
  pure logical function takes(this, kind, name)
    type(card), intent(in) :: this
    character(*), intent(in) :: kind !< 'NSET' or 'ELSET'
    character(*), intent(in) :: name !< upper case
    integer :: field, last, line
    takes = .false.
    if (.not. allocated(this%spec%name)) return
    last = 0
    select case (this%spec%name)
    case ('BOUNDARY', 'CLOAD', 'INITIAL CONDITIONS', 'TEMPERATURE')
      if (kind == 'NSET') last = 1
    case ('DLOAD', 'SURFACE')
      if (kind == 'ELSET' .or. this%word('TYPE') == 'NODE') last = 1
    case ('MODEL CHANGE')
      if (kind == 'ELSET') last = huge(1)
    case ('NSET', 'ELSET')
      if (kind == this%spec%name .and. .not. this%has('GENERATE')) last = huge(1)
    case ('NODE PRINT', 'EL PRINT')
      takes = this%word(kind) == name
      return
    case default
      return
    end select
    do line = 1, this%num_lines
      do field = 1, min(last, this%num_fields(line))
        takes = this%word_at(line, field) == name
        if (takes) return
      end do
    end do
  end function takes
end module check_growth
