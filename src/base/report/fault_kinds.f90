!> Kinds of errors of a deck: errors of a keyword that differ only in numbers and names are of one
!> kind; so are references to one missing thing.
!>
!> A missing node, element, set or other name is often the consequence of another error, such as a
!> misspelt keyword: such errors are listed after the others, and many of them as one. So is what a
!> card lacks, such as the stiffness of a material: these errors come last. A file that cannot be
!> read comes first: what it should hold is missing elsewhere.
module fault_kinds
  use message_catalogue, only: label_of_fault
  implicit none
  private
  public :: fault_kind, kind_list, shows_reference

  !> Errors of one kind.
  type :: fault_kind
    character(:), allocatable :: name !< keyword and problem, numbers and names replaced by '..'
    character(:), allocatable :: file !< of the first; '' where the errors are in several files
    integer :: num = 0 !< all
    integer :: first_line = 0, last_line = 0 !< of those that are not shown one by one
    logical :: is_reference = .false. !< something named does not exist
    logical :: is_lost_file = .false. !< a file cannot be read
    logical :: is_absence = .false. !< something has not what another card should give it
    integer :: most_shown = huge(1) !< if there are more, only one is shown
  end type fault_kind

  !> All kinds of a deck; those beyond `most_kinds` count as one.
  type :: kind_list
    integer :: num_kinds = 0
    type(fault_kind), allocatable :: kinds(:) !< the first `num_kinds` are in use
  contains
    procedure :: count => count_fault
    procedure :: note_line
  end type kind_list

  integer, parameter :: most_kinds = 50
  integer, parameter :: most_references = 3 !< of more missing numbers only one is shown
  character(*), parameter :: digits = '0123456789'

contains

  !> Counts an error under its kind.
  subroutine count_fault(self, keyword, problem, file, number)
    class(kind_list), intent(inout) :: self
    character(*), intent(in) :: keyword !< '' for none
    character(*), intent(in) :: problem, file
    integer, intent(out) :: number !< position of the kind
    character(:), allocatable :: name
    logical :: is_reference
    if (.not. allocated(self%kinds)) allocate (self%kinds(most_kinds))
    is_reference = index(problem, 'does not exist') > 0 .or. index(problem, 'there is no ') == 1
    name = text_of_kind(problem, is_reference)
    if (keyword /= '' .and. .not. is_reference) name = '*'//keyword//': '//name
    do number = 1, self%num_kinds
      if (self%kinds(number)%name == name) exit
    end do
    if (number > most_kinds) then
      number = most_kinds
      self%kinds(number)%name = 'of other kinds'
    end if
    associate (kind => self%kinds(number))
      if (number > self%num_kinds) then
        self%num_kinds = number
        kind%name = name
        kind%file = file
        kind%is_reference = is_reference
        kind%is_lost_file = index(problem, 'cannot read ') == 1
        kind%is_absence = label_of_fault(problem, '') == ' [incomplete-model]'
        if (is_reference) kind%most_shown = merge(1, most_references, index(name, '''') > 0)
      end if
      kind%num = kind%num + 1
      if (kind%file /= file) kind%file = ''
    end associate
  end subroutine count_fault

  !> Whether one more error of a missing thing is shown beside those of its kind.
  pure logical function shows_reference(kinds, problem)
    type(kind_list), intent(in) :: kinds
    character(*), intent(in) :: problem !< 'there is no ..'
    character(:), allocatable :: name
    integer :: i
    name = text_of_kind(problem, .true.)
    shows_reference = .true.
    do i = 1, kinds%num_kinds
      if (kinds%kinds(i)%name /= name) cycle
      shows_reference = kinds%kinds(i)%num < kinds%kinds(i)%most_shown
    end do
  end function shows_reference

  !> Notes the line of an error that is not shown.
  subroutine note_line(self, number, line)
    class(kind_list), intent(inout) :: self
    integer, intent(in) :: number !< of the kind
    integer, intent(in) :: line
    associate (kind => self%kinds(number))
      if (kind%first_line == 0) kind%first_line = line
      kind%first_line = min(kind%first_line, line)
      kind%last_line = max(kind%last_line, line)
    end associate
  end subroutine note_line

  !> 'element .. does not exist': a problem without its numbers and quoted words.
  pure function text_of_kind(problem, keeps_words) result(text)
    character(*), intent(in) :: problem
    logical, intent(in) :: keeps_words !< quoted ones
    character(:), allocatable :: text
    integer :: i, last
    text = ''
    i = 1
    do while (i <= len(problem))
      last = i
      if (problem(i:i) == '''') then
        last = i + index(problem(i + 1:), '''')
        if (keeps_words .or. last == i) then
          text = text//problem(i:last)
        else
          text = text//'''..'''
        end if
      else if (index(digits, problem(i:i)) > 0) then
        last = i + verify(problem(i:)//' ', digits//'.') - 2
        text = text//'..'
      else
        text = text//problem(i:i)
      end if
      i = last + 1
    end do
  end function text_of_kind
end module fault_kinds
