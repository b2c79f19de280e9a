!> The page of a kind of message: its short name, how the message is recognised, what to do.
module message_pages
  implicit none
  private
  public :: message_page, page_list

  type :: message_page
    character(:), allocatable :: name !< small letters and '-'
    character(:), allocatable :: signs !< words of the message, one of them, '|' between; '' quotes
    character(:), allocatable :: cause !< what has happened
    character(:), allocatable :: remedy !< what to do
    character(:), allocatable :: wrong, right !< an example, '' for none
  contains
    procedure :: fits
  end type message_page

  !> Pages in the order in which their signs are looked for.
  type :: page_list
    integer :: num_pages = 0
    type(message_page), allocatable :: pages(:) !< the first `num_pages` are in use
  contains
    procedure :: add => add_page
  end type page_list

contains

  !> Adds a page at the end.
  subroutine add_page(self, name, signs, cause, remedy, wrong, right)
    class(page_list), intent(inout) :: self
    character(*), intent(in) :: name, signs, cause, remedy
    character(*), intent(in), optional :: wrong, right
    type(message_page), allocatable :: longer(:)
    integer :: i
    if (.not. allocated(self%pages)) allocate (self%pages(32))
    if (self%num_pages == size(self%pages)) then
      allocate (longer(2*self%num_pages))
      do i = 1, self%num_pages
        longer(i) = self%pages(i)
      end do
      call move_alloc(longer, self%pages)
    end if
    self%num_pages = self%num_pages + 1
    associate (new => self%pages(self%num_pages))
      new%name = name
      new%signs = signs
      new%cause = cause
      new%remedy = remedy
      new%wrong = ''
      new%right = ''
      if (present(wrong)) new%wrong = wrong
      if (present(right)) new%right = right
    end associate
  end subroutine add_page

  !> Whether a message, without the words in its quotes, has one of the signs.
  pure logical function fits(self, message)
    class(message_page), intent(in) :: self
    character(*), intent(in) :: message
    integer :: first, last
    fits = .false.
    first = 1
    do while (first <= len(self%signs) .and. .not. fits)
      last = first + index(self%signs(first:)//'|', '|') - 2
      fits = index(message, self%signs(first:last)) > 0
      first = last + 2
    end do
  end function fits
end module message_pages
