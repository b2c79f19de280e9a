!> Short text for a list of numbers: '1-4, 7, 9-12'.
module number_ranges
  use write_text, only: as_text
  implicit none
  private
  public :: as_ranges

contains

  !> The numbers, with consecutive numbers written as ranges.
  pure function as_ranges(numbers) result(text)
    integer, intent(in) :: numbers(:) !< in increasing order
    character(:), allocatable :: text
    integer :: first, last
    text = ''
    first = 1
    do while (first <= size(numbers))
      last = first
      do while (last < size(numbers))
        if (numbers(last + 1) /= numbers(last) + 1) exit
        last = last + 1
      end do
      if (first > 1) text = text//', '
      text = text//as_text(numbers(first))
      if (last > first) text = text//'-'//as_text(numbers(last))
      first = last + 1
    end do
  end function as_ranges
end module number_ranges
