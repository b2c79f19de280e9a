!> Digests of the cards of a deck, so that a run that goes on sees what has changed in the deck.
module card_digests
  use deck_card, only: card
  use deck_file, only: path_of_named
  use deck_scan, only: steps_of_cards
  use diagnostics, only: place
  use file_identity, only: add_path, file_path
  use sha256, only: digest_of_file, digest_of_text
  implicit none
  private
  public :: card_digest, digests_of_cards, list_input_files

  !> One card: where it stands, what it is called, and a digest of its lines.
  type :: card_digest
    character(:), allocatable :: keyword !< upper case
    character(:), allocatable :: name !< what it defines: NAME, NSET or ELSET; '' for none
    character(:), allocatable :: place !< 'file:line'
    integer :: step = 0 !< number of the step that it stands in, 0 outside
    character(64) :: digest = ''
  end type card_digest

  character, parameter :: nl = new_line('a')

contains

  !> The digests of all cards. Comments, blank lines and blanks at the end of a line do not count.
  subroutine digests_of_cards(cards, digests)
    type(card), intent(in) :: cards(:) !< of the deck, in its order
    type(card_digest), allocatable, intent(out) :: digests(:)
    integer :: i
    allocate (digests(size(cards)))
    digests%step = steps_of_cards(cards)
    do i = 1, size(cards)
      digests(i)%keyword = cards(i)%keyword
      digests(i)%name = name_of(cards(i))
      digests(i)%place = cards(i)%file_and_line(0)
      digests(i)%digest = digest_of(cards(i))
    end do
  end subroutine digests_of_cards

  !> What a card defines.
  pure function name_of(this) result(name)
    type(card), intent(in) :: this
    character(:), allocatable :: name
    name = ''
    if (this%has('NAME')) name = this%word('NAME')
    if (this%has('ELSET')) name = this%word('ELSET')
    if (this%has('NSET')) name = this%word('NSET')
  end function name_of

  !> Digest of the lines, of where they end, and of the file that INPUT names.
  function digest_of(this) result(digest)
    type(card), intent(in) :: this
    character(64) :: digest
    character(:), allocatable :: ends
    integer, allocatable :: last(:)
    if (this%keyword == 'STEP') then
      digest = digest_of_text(step_text(this))
      return
    end if
    last = this%lines%rows%last ! gfortran 12 would transfer whole rows
    ends = repeat(' ', storage_size(last)/8*size(last))
    ends = transfer(last, ends)
    digest = digest_of_text(digest_of_text(this%lines%body)//digest_of_text(ends)// &
                            digest_of_file(input_of(this)))
  end function digest_of

  !> What acts on the state in *STEP: not INC, which may be raised where a run has stopped at it.
  !> Lines of text do not count.
  pure function step_text(this) result(text)
    type(card), intent(in) :: this
    character(:), allocatable :: text
    integer :: i
    text = ''
    do i = 1, size(this%spec%parameters)
      associate (name => this%spec%parameters(i)%name)
        if (name /= 'INC' .and. this%has(name)) text = text//name//'='//this%word(name)//nl
      end associate
    end do
  end function step_text

  !> Path of the file that INPUT names, '' for none.
  function input_of(this) result(path)
    type(card), intent(in) :: this
    character(:), allocatable :: path
    type(place) :: spot
    path = ''
    if (.not. this%has('INPUT')) return
    spot = this%place_of('INPUT')
    path = path_of_named(spot%file, this%text('INPUT'))
  end function input_of

  !> All files that the cards come from or name.
  subroutine list_input_files(cards, paths)
    type(card), intent(in) :: cards(:)
    type(file_path), allocatable, intent(out) :: paths(:)
    integer :: i, f
    allocate (paths(0))
    do i = 1, size(cards)
      do f = 1, size(cards(i)%lines%files)
        call add_once(paths, cards(i)%lines%files(f)%path)
      end do
      call add_once(paths, input_of(cards(i)))
    end do
  end subroutine list_input_files

  !> Adds a path unless it is empty or in the list.
  subroutine add_once(paths, path)
    type(file_path), allocatable, intent(inout) :: paths(:)
    character(*), intent(in) :: path
    integer :: i
    if (path == '') return
    do i = size(paths), 1, -1
      if (paths(i)%path == path) return
    end do
    call add_path(paths, path)
  end subroutine add_once
end module card_digests
