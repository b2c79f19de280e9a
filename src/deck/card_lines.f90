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
    integer, allocatable :: read_first(:), read_last(:) !< bytes read in place of them, if rewritten
    logical :: is_repeat = .false. !< read before: a place has one remark
  contains
    procedure :: find_field
    procedure :: find_place
    procedure :: position_of
    procedure :: widen
    procedure :: spot
    procedure :: spot_of_field
    procedure :: spot_of_keyword
    procedure :: file_and_line
    procedure :: ends_in_comma
  end type line_store

contains

  !> Bytes to be read for a field; first > last for an empty or missing field.
  pure subroutine find_field(self, line, field, first, last)
    class(line_store), intent(in) :: self
    integer, intent(in) :: line, field !< data line and field
    integer, intent(out) :: first, last
    integer :: i
    i = self%position_of(line, field)
    first = 1
    last = 0
    if (i == 0) return
    if (allocated(self%read_first)) then
      first = self%read_first(i)
      last = self%read_last(i)
    else
      first = self%field_first(i)
      last = self%field_last(i)
    end if
  end subroutine find_field

  !> Bytes of a field as the user wrote it; first > last for an empty or missing field.
  pure subroutine find_place(self, line, field, first, last)
    class(line_store), intent(in) :: self
    integer, intent(in) :: line, field !< data line and field
    integer, intent(out) :: first, last
    integer :: i
    i = self%position_of(line, field)
    first = 1
    last = 0
    if (i == 0) return
    first = self%field_first(i)
    last = self%field_last(i)
  end subroutine find_place

  !> Position of a field in `field_first`, 0 for a missing field.
  pure integer function position_of(self, line, field) result(position)
    class(line_store), intent(in) :: self
    integer, intent(in) :: line, field !< data line and field
    integer :: row
    position = 0
    row = self%num_heads + line
    if (line < 1 .or. row > size(self%rows)) return
    if (field < 1 .or. field > self%rows(row)%num_fields) return
    position = self%rows(row)%first_field + field - 1
  end function position_of

  !> Gives every data line at least so many fields; the new ones are empty.
  pure subroutine widen(self, fewest)
    class(line_store), intent(inout) :: self
    integer, intent(in) :: fewest !< fields of a line
    integer, allocatable :: first(:), last(:)
    integer :: row, num, used
    associate (lines => self%rows(self%num_heads + 1:))
      num = sum(max(fewest, lines%num_fields))
      if (all(lines%num_fields >= fewest)) return
    end associate
    allocate (first(num), last(num))
    used = 0
    do row = self%num_heads + 1, size(self%rows)
      associate (line => self%rows(row), old => self%rows(row)%first_field)
        num = max(fewest, line%num_fields)
        first(used + 1:used + num) = line%last + 1
        last(used + 1:used + num) = line%last
        first(used + 1:used + line%num_fields) = self%field_first(old:old + line%num_fields - 1)
        last(used + 1:used + line%num_fields) = self%field_last(old:old + line%num_fields - 1)
        line%first_field = used + 1
        line%num_fields = num
        used = used + num
      end associate
    end do
    call move_alloc(first, self%field_first)
    call move_alloc(last, self%field_last)
  end subroutine widen

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
      spot%is_repeat = self%is_repeat
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
      call self%find_place(line, field, first, last)
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
