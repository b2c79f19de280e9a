!> 'Did you mean ..': the known word nearest to a misspelt word.
module nearest_words
  use parse_text, only: upper_case
  implicit none
  private
  public :: nearest_word, nearest_choice, word_distance

  character(*), parameter :: separator = '|' !< between the words of a list of choices

contains

  !> The candidate nearest to `word` regardless of case; '' if none is near.
  !>
  !> Near: at most one change per three letters, at most three in all.
  pure function nearest_word(word, candidates) result(nearest)
    character(*), intent(in) :: word !< as written
    character(*), intent(in) :: candidates(:) !< known words; blanks at their ends do not count
    character(:), allocatable :: nearest
    integer :: i, distance, smallest
    nearest = ''
    smallest = most_changes(word) + 1
    do i = 1, size(candidates)
      if (abs(len_trim(candidates(i)) - len_trim(word)) >= smallest) cycle
      distance = word_distance(upper_case(trim(word)), upper_case(trim(candidates(i))))
      if (distance >= smallest .or. distance >= len_trim(candidates(i))) cycle
      smallest = distance
      nearest = trim(candidates(i))
    end do
  end function nearest_word

  !> As `nearest_word`, for the words of the program in one text: 'A | B | C'. Words of two letters
  !> have no near ones: one change of them gives another meaning (ON and NO, ME and PE).
  pure function nearest_choice(word, choices) result(nearest)
    character(*), intent(in) :: word !< as written
    character(*), intent(in) :: choices !< known words
    character(:), allocatable :: nearest
    character(len(choices)) :: candidates(count_choices(choices))
    integer, parameter :: longest_code = 2
    integer :: i, first, length
    nearest = ''
    if (len_trim(word) <= longest_code) return
    first = 1
    do i = 1, size(candidates)
      length = index(choices(first:)//separator, separator) - 1
      candidates(i) = adjustl(choices(first:first + length - 1))
      first = first + length + 1
    end do
    nearest = nearest_word(word, candidates)
  end function nearest_choice

  !> Words in a list of choices.
  pure integer function count_choices(choices)
    character(*), intent(in) :: choices
    integer :: i
    count_choices = 1
    do i = 1, len(choices)
      if (choices(i:i) == separator) count_choices = count_choices + 1
    end do
  end function count_choices

  !> Changes that a misspelt word may have: one per three letters, one to three.
  pure integer function most_changes(word)
    character(*), intent(in) :: word
    most_changes = min(max(len_trim(word)/3, 1), 3)
    if (len_trim(word) < 2) most_changes = 0
  end function most_changes

  !> Fewest letters to insert, delete, replace or swap with the next, to turn `a` into `b`.
  pure integer function word_distance(a, b) result(distance)
    character(*), intent(in) :: a, b
    integer :: before(0:len(b)), last(0:len(b)), row(0:len(b)), i, j, cost
    last = [(j, j=0, len(b))]
    before = last
    do i = 1, len(a)
      row(0) = i
      do j = 1, len(b)
        cost = merge(0, 1, a(i:i) == b(j:j))
        row(j) = min(last(j) + 1, row(j - 1) + 1, last(j - 1) + cost)
      end do
      if (i > 1) call try_swaps(a(i - 1:i), b, before, row)
      before = last
      last = row
    end do
    distance = last(len(b))
  end function word_distance

  !> Reduces the distances where the last two letters are swapped.
  pure subroutine try_swaps(pair, b, before, row)
    character(2), intent(in) :: pair !< last two letters of the one word
    character(*), intent(in) :: b !< the other word
    integer, intent(in) :: before(0:) !< distances without the pair
    integer, intent(inout) :: row(0:) !< distances with the pair
    integer :: j
    do j = 2, len(b)
      if (pair(2:2)//pair(1:1) == b(j - 1:j)) row(j) = min(row(j), before(j - 2) + 1)
    end do
  end subroutine try_swaps
end module nearest_words
