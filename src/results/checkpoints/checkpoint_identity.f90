!> What a checkpoint belongs to: the program, the deck, the UMAT. A run goes on only where all that
!> has acted on the state so far is the same.
module checkpoint_identity
  use archive_type, only: archive
  use build_info, only: compiler, compiler_flags, libraries, program_version
  use card_digests, only: card_digest
  use errors, only: deck_is_wrong, error_type, raise
  use parse_text, only: parse_integer
  use problem_definition, only: problem
  use sha256, only: digest_of_file
  use write_text, only: as_text
  implicit none
  private
  public :: save_identity, check_identity

  character, parameter :: nl = new_line('a'), tab = achar(9)
  character(*), parameter :: program_name = 'Keyway '//program_version//', '//compiler//', '// &
                             compiler_flags//', '//libraries

  !> Cards that may differ: they do not act on the state.
  character(*), parameter :: free_cards = ' HEADING | RESTART | PREPRINT '
  !> Definitions that may be added: later steps can need them.
  character(*), parameter :: addable_cards = ' AMPLITUDE | NSET | ELSET | SURFACE '
  !> Cards that act on the state before their own step: they say what a joint is before it is
  !> grouted, which elements come and go together, and that there are temperatures.
  character(*), parameter :: early_cards = ' MODEL CHANGE | GROUT | TEMPERATURE '

contains

  !> Stores the program and the digests of the deck and of the UMAT.
  subroutine save_identity(model, file)
    type(problem), intent(in) :: model
    class(archive), intent(inout) :: file !< open for writing
    type(card_digest), allocatable :: cards(:)
    character(:), allocatable :: text
    integer :: i
    call list_cards(model, cards)
    text = ''
    do i = 1, size(cards)
      text = text//as_text(cards(i)%step)//tab//cards(i)%keyword//tab//cards(i)%name//tab// &
             cards(i)%digest//nl
    end do
    call file%open_group('identity')
    call file%put_long_text('program', program_name)
    call file%put_long_text('cards', text)
    call file%close_group()
  end subroutine save_identity

  !> Compares the deck with that of a checkpoint, up to the step of the checkpoint.
  subroutine check_identity(model, file, step, error)
    type(problem), intent(in) :: model
    class(archive), intent(inout) :: file !< open for reading
    integer, intent(in) :: step !< that the checkpoint is in
    type(error_type), allocatable, intent(out) :: error
    type(card_digest), allocatable :: old(:), new(:)
    character(:), allocatable :: text
    call file%open_group('identity')
    call file%get_long_text('program', text)
    if (.not. file%has_failed() .and. text /= program_name) then
      call refuse('it was written by '//text//', and this is '//program_name, error)
      return
    end if
    call file%get_long_text('cards', text)
    call file%close_group()
    call file%report(error)
    if (allocated(error)) return
    call parse_cards(text, old)
    call list_cards(model, new)
    call keep_up_to(step, old)
    call keep_up_to(step, new)
    call compare(old, new, error)
  end subroutine check_identity

  !> The cards of the model that count, and the files of the UMAT.
  subroutine list_cards(model, cards)
    type(problem), intent(in) :: model
    type(card_digest), allocatable, intent(out) :: cards(:)
    integer, allocatable :: rows(:)
    integer :: i, num_cards
    rows = [integer ::]
    if (allocated(model%cards)) then
      rows = pack([(i, i=1, size(model%cards))], &
                  [(.not. is_in(model%cards(i)%keyword, free_cards), i=1, size(model%cards))])
    end if
    num_cards = size(rows)
    allocate (cards(num_cards + num_umat_files(model)))
    do i = 1, num_cards
      cards(i) = model%cards(rows(i))
    end do
    do i = 1, num_umat_files(model)
      associate (new => cards(num_cards + i))
        new%keyword = 'UMAT'
        new%name = ''
        new%place = model%umat%files(i)%path
        new%digest = digest_of_file(model%umat%files(i)%path)
      end associate
    end do
  end subroutine list_cards

  !> Number of files of --umat.
  pure integer function num_umat_files(model)
    type(problem), intent(in) :: model
    num_umat_files = 0
    if (associated(model%umat)) num_umat_files = size(model%umat%files)
  end function num_umat_files

  !> Reads what save_identity has written.
  subroutine parse_cards(text, cards)
    character(*), intent(in) :: text
    type(card_digest), allocatable, intent(out) :: cards(:)
    integer :: i, c, first
    logical :: is_integer
    allocate (cards(count([(text(i:i) == nl, i=1, len(text))])))
    first = 1
    do c = 1, size(cards)
      call parse_integer(word(tab), cards(c)%step, is_integer)
      cards(c)%keyword = word(tab)
      cards(c)%name = word(tab)
      cards(c)%place = ''
      cards(c)%digest = word(nl)
    end do

  contains

    !> The text up to the next separator.
    function word(separator)
      character, intent(in) :: separator
      character(:), allocatable :: word
      integer :: length
      length = index(text(first:), separator) - 1
      word = text(first:first + length - 1)
      first = first + length + 1
    end function word
  end subroutine parse_cards

  !> Keeps the cards outside of steps and in the steps up to a number, and those of stages.
  subroutine keep_up_to(step, cards)
    integer, intent(in) :: step
    type(card_digest), allocatable, intent(inout) :: cards(:)
    type(card_digest), allocatable :: some(:)
    integer :: i, last
    allocate (some(size(cards)))
    last = 0
    do i = 1, size(cards)
      if (cards(i)%step > step .and. .not. is_in(cards(i)%keyword, early_cards)) cycle
      last = last + 1
      some(last) = cards(i)
    end do
    some = some(:last)
    call move_alloc(some, cards)
  end subroutine keep_up_to

  !> Walks through both lists. Added definitions of new names are no change.
  subroutine compare(old, new, error)
    type(card_digest), intent(in) :: old(:), new(:)
    type(error_type), allocatable, intent(out) :: error
    integer :: i, j
    i = 1
    do j = 1, size(new)
      if (i <= size(old)) then
        if (is_same(old(i), new(j))) then
          i = i + 1
          cycle
        end if
      end if
      if (is_addition(old, new(j))) cycle
      if (any(is_same(old(i + 1:), new(j))) .and. .not. any(is_same(new(j:), old(i)))) exit
      call refuse('the deck has changed: '//new(j)%place//': *'//new(j)%keyword//' is new or '// &
                  'not as it was', error)
      return
    end do
    if (i > size(old)) return
    call refuse('the deck has changed: *'//trim(old(i)%keyword//' '//old(i)%name)// &
                ' of the checkpoint is missing', error)
  end subroutine compare

  !> Whether two cards say the same.
  elemental logical function is_same(one, other)
    type(card_digest), intent(in) :: one, other
    is_same = one%digest == other%digest .and. one%keyword == other%keyword
  end function is_same

  !> Whether a card defines something that the deck of the checkpoint did not have.
  logical function is_addition(old, new)
    type(card_digest), intent(in) :: old(:), new
    integer :: i
    is_addition = new%step == 0 .and. new%name /= '' .and. is_in(new%keyword, addable_cards)
    do i = 1, size(old)
      if (old(i)%name == new%name) is_addition = .false.
    end do
  end function is_addition

  !> Whether a keyword is in a list ' A | B | C '.
  pure logical function is_in(keyword, list)
    character(*), intent(in) :: keyword, list
    is_in = index(list, ' '//keyword//' ') > 0
  end function is_in

  !> The error of a checkpoint that this run cannot go on from.
  subroutine refuse(reason, error)
    character(*), intent(in) :: reason
    type(error_type), allocatable, intent(out) :: error
    call raise(error, 'keyway: --continue: the checkpoint does not belong to this run: '// &
               reason//nl//'Only steps after the one of the checkpoint may change (not their '// &
               '*MODEL CHANGE, *GROUT and *TEMPERATURE) and INC of *STEP, and amplitudes, sets '// &
               'and surfaces of new names may be added. Without --continue the analysis starts '// &
               'from the beginning', deck_is_wrong)
  end subroutine refuse
end module checkpoint_identity
