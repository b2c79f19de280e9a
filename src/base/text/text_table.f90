!> Numbers texts 1, 2, 3 .. in the order in which they are added: a hash table, open addressing.
module text_table
  use growing_lists, only: append
  use kinds, only: long
  use text_buffers, only: text_buffer
  implicit none
  private
  public :: text_numbers

  !> Hash of Fowler, Noll and Vo (FNV-1a, 32 bits).
  integer(long), parameter :: offset_basis = 2166136261_long, prime = 16777619_long
  integer(long), parameter :: low_bits = 4294967295_long !< 2^32 - 1

  !> Numbers of texts. At most half of the seats of the hash table are in use.
  type :: text_numbers
    private
    integer :: num_texts = 0
    integer, allocatable :: last(:) !< byte of `bytes` where each text ends
    type(text_buffer) :: bytes !< all texts, one behind the other
    integer, allocatable :: number_at(:) !< (seats) 0: empty
  contains
    procedure :: find
    procedure :: find_or_add
  end type text_numbers

contains

  !> Number of a text, 0 for an unknown one.
  pure integer function find(self, text) result(number)
    class(text_numbers), intent(in) :: self
    character(*), intent(in) :: text
    number = 0
    if (self%num_texts > 0) number = self%number_at(seat_of(self, text))
  end function find

  !> Number of a text; a new text gets the next number.
  pure subroutine find_or_add(self, text, number)
    class(text_numbers), intent(inout) :: self
    character(*), intent(in) :: text
    integer, intent(out) :: number
    integer :: seat
    call double_seats(self)
    seat = seat_of(self, text)
    number = self%number_at(seat)
    if (number > 0) return
    call self%bytes%add(text)
    call append(self%last, self%num_texts, self%bytes%length)
    number = self%num_texts
    self%number_at(seat) = number
  end subroutine find_or_add

  !> The seat of a text, or the empty seat for it.
  pure integer function seat_of(self, text) result(seat)
    class(text_numbers), intent(in) :: self
    character(*), intent(in) :: text
    integer :: number
    seat = int(mod(hash(text), int(size(self%number_at), long))) + 1
    do
      number = self%number_at(seat)
      if (number == 0) return
      if (is_text(self, number, text)) return
      seat = mod(seat, size(self%number_at)) + 1
    end do
  end function seat_of

  pure logical function is_text(self, number, text)
    class(text_numbers), intent(in) :: self
    integer, intent(in) :: number
    character(*), intent(in) :: text
    integer :: first
    first = 1
    if (number > 1) first = self%last(number - 1) + 1
    is_text = self%last(number) - first + 1 == len(text)
    if (is_text) is_text = self%bytes%room(first:self%last(number)) == text
  end function is_text

  pure integer(long) function hash(text)
    character(*), intent(in) :: text
    integer :: i
    hash = offset_basis
    do i = 1, len(text)
      hash = iand(ieor(hash, int(iachar(text(i:i)), long))*prime, low_bits)
    end do
  end function hash

  !> Doubles the seats before they are half full.
  pure subroutine double_seats(self)
    class(text_numbers), intent(inout) :: self
    integer :: number, first, num_seats
    if (.not. allocated(self%number_at)) allocate (self%number_at(64), source=0)
    num_seats = size(self%number_at)
    if (2*(self%num_texts + 1) <= num_seats) return
    deallocate (self%number_at)
    allocate (self%number_at(2*num_seats), source=0)
    first = 1
    do number = 1, self%num_texts
      self%number_at(seat_of(self, self%bytes%room(first:self%last(number)))) = number
      first = self%last(number) + 1
    end do
  end subroutine double_seats
end module text_table
