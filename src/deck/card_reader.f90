!> Data that do not end with their line: streams of fields, and records continued in the next line.
module card_reader
  use deck_card, only: card
  implicit none
  private
  public :: field_reader, find_record

  !> Reads all fields of all data lines of a card one by one, for data of any number per line.
  !>
  !>     do while (reader%advance(the_card))
  !>       value = the_card%real_at(reader%line, reader%field)
  !>     end do
  type :: field_reader
    integer :: line = 1 !< data line of the field
    integer :: field = 0 !< field in that line, from 1
  contains
    procedure :: advance => next_field
  end type field_reader

contains

  !> Moves to the next field (which may be empty); false after the last one.
  logical function next_field(self, the_card) result(has_field)
    class(field_reader), intent(inout) :: self
    type(card), intent(in) :: the_card
    self%field = self%field + 1
    do while (self%line <= the_card%num_lines)
      if (self%field <= the_card%num_fields(self%line)) exit
      self%line = self%line + 1
      self%field = 1
    end do
    has_field = self%line <= the_card%num_lines
  end function next_field

  !> Finds the fields of a record that begins in a data line, such as an element with its nodes.
  !>
  !> A record with fewer fields than wanted continues in the next line. `num_found` differs from the
  !> number wanted if the data end too early or a line holds too many fields.
  pure subroutine find_record(the_card, line, lines, fields, num_found, next_line)
    type(card), intent(in) :: the_card
    integer, intent(in) :: line !< data line where the record begins
    integer, intent(out) :: lines(:), fields(:) !< data line and field of each field wanted
    integer, intent(out) :: num_found !< fields found, also beyond the number wanted
    integer, intent(out) :: next_line !< data line where the next record begins
    integer :: i, num_here
    lines = line
    fields = 0
    num_found = 0
    next_line = line
    do while (num_found < size(lines) .and. next_line <= the_card%num_lines)
      num_here = the_card%num_fields(next_line)
      do i = 1, min(num_here, size(lines) - num_found)
        lines(num_found + i) = next_line
        fields(num_found + i) = i
      end do
      num_found = num_found + num_here
      next_line = next_line + 1
    end do
  end subroutine find_record
end module card_reader
