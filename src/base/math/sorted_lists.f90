!> Lists of positions in ascending order, each once, as sets hold them.
module sorted_lists
  implicit none
  private
  public :: sorted_unique, contains_position, place_in

contains

  !> The members of a list in ascending order, each once.
  pure function sorted_unique(list) result(members)
    integer, intent(in) :: list(:)
    integer, allocatable :: members(:)
    integer, allocatable :: work(:), room(:)
    work = list
    if (.not. is_ascending(work)) then
      allocate (room(size(work)))
      call merge_sort(work, room)
    end if
    allocate (members(0))
    if (size(work) == 0) return
    members = pack(work, [.true., work(2:) /= work(:size(work) - 1)])
  end function sorted_unique

  !> Whether the list holds a position.
  pure logical function contains_position(list, position) result(is_member)
    integer, intent(in) :: list(:) !< ascending
    integer, intent(in) :: position
    is_member = .false.
    if (size(list) > 0) is_member = list(place_in(list, position)) == position
  end function contains_position

  !> Index of an item in an ascending list, or the index where to insert it (binary search).
  pure integer function place_in(list, item) result(low)
    integer, intent(in) :: list(:) !< ascending, not empty
    integer, intent(in) :: item
    integer :: high, middle
    low = 1
    high = size(list)
    do while (low < high)
      middle = (low + high)/2
      if (list(middle) < item) then
        low = middle + 1
      else
        high = middle
      end if
    end do
  end function place_in

  pure logical function is_ascending(list)
    integer, intent(in) :: list(:)
    is_ascending = .true.
    if (size(list) > 1) is_ascending = all(list(2:) >= list(:size(list) - 1))
  end function is_ascending

  !> Sorts by merging runs of doubling length.
  pure subroutine merge_sort(list, room)
    integer, intent(inout) :: list(:)
    integer, intent(out) :: room(:) !< work space, as long as the list
    integer :: length, first, middle, last
    length = 1
    do while (length < size(list))
      do first = 1, size(list), 2*length
        middle = min(first + length, size(list) + 1)
        last = min(first + 2*length, size(list) + 1)
        call merge_runs(list(first:middle - 1), list(middle:last - 1), room(first:last - 1))
      end do
      list = room
      length = 2*length
    end do
  end subroutine merge_sort

  pure subroutine merge_runs(left, right, merged)
    integer, intent(in) :: left(:), right(:) !< ascending
    integer, intent(out) :: merged(:)
    integer :: i, j, k
    i = 1
    j = 1
    do k = 1, size(merged)
      if (j > size(right)) then
        merged(k) = left(i)
        i = i + 1
      else if (i > size(left)) then
        merged(k) = right(j)
        j = j + 1
      else if (left(i) <= right(j)) then
        merged(k) = left(i)
        i = i + 1
      else
        merged(k) = right(j)
        j = j + 1
      end if
    end do
  end subroutine merge_runs
end module sorted_lists
