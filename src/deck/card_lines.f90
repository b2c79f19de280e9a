!> The text of a card: its lines, their places in the files, and the fields of its data.
module card_lines
  use diagnostics, only: place
  implicit none
  private
  public :: line_store, line_origin, file_name

  !> Name of a file.
  type :: file_name
    character(:), allocatable :: path !< as the user named it
  end type file_name

  !> One line and its place in a file.
  type :: line_origin
    integer :: file = 1 !< index into `files`
    integer :: number = 0 !< line in that file
    integer :: first = 1, last = 0 !< its bytes in `body`
    integer :: first_field = 1 !< its first field in `field_first`
    integer :: num_fields = 0 !< empty ones at the end do not count
  end type line_origin

  !> Lines of one card, filled by the lexer: first the keyword lines, then the data lines.
  type :: line_store
    character(:), allocatable :: body !< the lines one after the other
    type(file_name), allocatable :: files(:)
    integer :: num_heads = 1 !< number of keyword lines
    type(line_origin), allocatable :: rows(:) !< keyword lines, then data lines
    integer, allocatable :: field_first(:), field_last(:) !< bytes of each field, without quotes
  contains
    procedure :: find_field
    procedure :: spot
    procedure :: spot_of_field
    procedure :: spot_of_keyword
    procedure :: file_and_line
    procedure :: ends_in_comma
  end type line_store

contains

  !> Bytes of a field in the body; first > last for an empty or missing field.
  pure subroutine find_field(self, line, field, first, last)
    class(line_store), intent(in) :: self
    integer, intent(in) :: line, field !< data line and field
    integer, intent(out) :: first, last
    integer :: row, i
    first = 1
    last = 0
    row = self%num_heads + line
    if (line < 1 .or. row > size(self%rows)) return
    if (field < 1 .or. field > self%rows(row)%num_fields) return
    i = self%rows(row)%first_field + field - 1
    first = self%field_first(i)
    last = self%field_last(i)
  end subroutine find_field

  !> Place of some bytes of the body in their file.
  pure function spot(self, row, first, last, keyword)
    class(line_store), intent(in) :: self
    integer, intent(in) :: row !< index into `rows`
    integer, intent(in) :: first, last !< bytes in the body
    character(*), intent(in) :: keyword !< name of the card
    type(place) :: spot
    associate (origin => self%rows(row))
      spot%file = self%files(origin%file)%path
      spot%line = origin%number
      spot%column = first - origin%first + 1
      spot%length = last - first + 1
      spot%keyword = keyword
      spot%source = self%body(origin%first:origin%last)
    end associate
  end function spot

  !> Place of a field: of the whole data line for field 0, of the line's end for a missing field.
  pure function spot_of_field(self, line, field, keyword) result(spot)
    class(line_store), intent(in) :: self
    integer, intent(in) :: line, field !< data line and field; line 0: the keyword line
    character(*), intent(in) :: keyword !< name of the card
    type(place) :: spot
    integer :: first, last, row
    row = min(max(self%num_heads + line, 1), size(self%rows))
    if (field <= 0) then
      first = self%rows(row)%first
      last = self%rows(row)%last
    else
      call self%find_field(line, field, first, last)
      if (field > self%rows(row)%num_fields) first = self%rows(row)%last + 1
      last = max(first, last)
    end if
    spot = self%spot(row, first, last, keyword)
  end function spot_of_field

  !> Place of the keyword, star included.
  pure function spot_of_keyword(self, keyword) result(spot)
    class(line_store), intent(in) :: self
    character(*), intent(in) :: keyword !< name of the card
    type(place) :: spot
    integer :: star, comma, last
    associate (head => self%body(self%rows(1)%first:self%rows(1)%last))
      star = max(index(head, '*'), 1)
      comma = index(head, ',')
      if (comma == 0) comma = len(head) + 1
      last = len_trim(head(:comma - 1))
    end associate
    spot = self%spot(1, self%rows(1)%first + star - 1, self%rows(1)%first + last - 1, keyword)
  end function spot_of_keyword

  !> 'file:line' of a data line; of the keyword for `line` = 0.
  pure function file_and_line(self, line) result(name)
    class(line_store), intent(in) :: self
    integer, intent(in) :: line !< data line
    character(:), allocatable :: name
    character(12) :: number
    integer :: row
    row = 1
    if (line > 0) row = self%num_heads + line
    write (number, '(i0)') self%rows(row)%number
    name = self%files(self%rows(row)%file)%path//':'//trim(number)
  end function file_and_line

  !> Whether the data line ends in a comma.
  pure logical function ends_in_comma(self, line)
    class(line_store), intent(in) :: self
    integer, intent(in) :: line !< data line
    integer :: last
    associate (row => self%rows(self%num_heads + line))
      last = verify(self%body(row%first:row%last), ' '//achar(9), back=.true.)
      ends_in_comma = last > 0
      if (last > 0) ends_in_comma = self%body(row%first + last - 1:row%first + last - 1) == ','
    end associate
  end function ends_in_comma
end module card_lines
