!> Positions of the user's numbers: a hash table with open addressing, quick for any ids.
!>
!> Ids of real decks are sparse, unsorted and often multiples of a power of ten; a multiplicative
!> hash spreads all these. At most half of the table is in use.
module id_map
  use kinds, only: long
  implicit none
  private
  public :: position_table

  integer(long), parameter :: spread = 2654435769_long !< 2^32 over the golden ratio (Knuth 6.4)
  integer, parameter :: fewest_bits = 6 !< of the smallest table

  !> Positions by id.
  type :: position_table
    private
    integer :: bits = 0 !< the table has 2^bits seats
    integer :: count = 0
    integer, allocatable :: id(:), position(:) !< 0 in `position`: the seat is empty
  contains
    procedure :: reserve
    procedure :: insert
    procedure :: find
    procedure :: num_ids
  end type position_table

contains

  !> Allocates memory for `num_ids` ids, so that inserting them never resizes the table.
  pure subroutine reserve(self, num_ids)
    class(position_table), intent(inout) :: self
    integer, intent(in) :: num_ids
    integer :: bits
    bits = max(fewest_bits, self%bits)
    do while (ishft(1, bits) < 2*num_ids)
      bits = bits + 1
    end do
    if (bits > self%bits) call resize(self, bits)
  end subroutine reserve

  !> Adds a new id, with `earlier` = 0; for a known id `earlier` is its position.
  pure subroutine insert(self, id, position, earlier)
    class(position_table), intent(inout) :: self
    integer, intent(in) :: id !< user's number
    integer, intent(in) :: position !< > 0
    integer, intent(out) :: earlier
    integer :: seat
    call self%reserve(self%count + 1)
    seat = seat_of(self, id)
    earlier = self%position(seat)
    if (earlier /= 0) return
    self%id(seat) = id
    self%position(seat) = position
    self%count = self%count + 1
  end subroutine insert

  !> Position of an id, 0 for an unknown one.
  pure integer function find(self, id) result(position)
    class(position_table), intent(in) :: self
    integer, intent(in) :: id
    position = 0
    if (self%count > 0) position = self%position(seat_of(self, id))
  end function find

  !> Number of ids.
  pure integer function num_ids(self)
    class(position_table), intent(in) :: self
    num_ids = self%count
  end function num_ids

  !> The seat of an id, or the empty seat for it.
  pure integer function seat_of(self, id) result(seat)
    type(position_table), intent(in) :: self
    integer, intent(in) :: id
    integer(long) :: mixed
    mixed = iand(int(id, long), 2147483647_long)*spread ! without the sign: no overflow
    seat = int(ibits(mixed, 32 - self%bits, self%bits)) + 1
    do while (self%position(seat) /= 0)
      if (self%id(seat) == id) return
      seat = seat + 1
      if (seat > size(self%id)) seat = 1
    end do
  end function seat_of

  pure subroutine resize(self, bits)
    type(position_table), intent(inout) :: self
    integer, intent(in) :: bits
    integer, allocatable :: id(:), position(:)
    integer :: old, seat
    call move_alloc(self%id, id)
    call move_alloc(self%position, position)
    self%bits = bits
    allocate (self%id(ishft(1, bits)), self%position(ishft(1, bits)), source=0)
    if (.not. allocated(id)) return
    do old = 1, size(id)
      if (position(old) == 0) cycle
      seat = seat_of(self, id(old))
      self%id(seat) = id(old)
      self%position(seat) = position(old)
    end do
  end subroutine resize
end module id_map
