!> Files of a deck on the disk.
module deck_file
  use kinds, only: long
  use process_limits, only: why_no_file
  use utf8_text, only: latin1_of_utf8, make_utf8
  implicit none
  private
  public :: load_file, load_text, path_beside, path_of_named, first_letter, why_no_text

  integer, parameter :: num_looked_at = 4096 !< letters that show the encoding
  character(*), parameter :: byte_order_mark = char(239)//char(187)//char(191) !< UTF-8

contains

  !> Reads a whole file.
  subroutine load_file(path, text, reason)
    character(*), intent(in) :: path
    character(:), allocatable, intent(out) :: text !< its bytes
    character(:), allocatable, intent(out) :: reason !< why the file cannot be read, '' for success
    character(200) :: message
    integer(long) :: num_bytes
    integer :: unit, status
    reason = why_no_file(path)
    if (len(reason) > 0) return
    open (newunit=unit, file=path, access='stream', form='unformatted', status='old', &
          action='read', iostat=status, iomsg=message)
    if (status /= 0) then
      reason = cause(message)
      return
    end if
    inquire (unit=unit, size=num_bytes)
    if (num_bytes < 0 .or. num_bytes >= huge(1)) then
      reason = 'not a file of less than 2 GB'
    else
      allocate (character(num_bytes) :: text, stat=status)
      message = 'not enough memory'
      if (status == 0) message = ''
      if (status == 0 .and. num_bytes > 0) read (unit, iostat=status, iomsg=message) text
      if (status /= 0) reason = cause(message)
    end if
    close (unit)
  end subroutine load_file

  !> Reads a text that holds names: what is Latin-1 in it becomes UTF-8.
  subroutine load_text(path, text, reason)
    character(*), intent(in) :: path
    character(:), allocatable, intent(out) :: text !< in UTF-8
    character(:), allocatable, intent(out) :: reason !< why it cannot be read, '' for success
    call load_file(path, text, reason)
    if (len(reason) == 0) reason = why_no_text(text)
    if (len(reason) == 0) call make_utf8(text, first_letter(text))
  end subroutine load_text

  !> Where the text of a file begins: after the byte order mark, if there is one.
  pure integer function first_letter(text)
    character(*), intent(in) :: text
    first_letter = 1
    if (index(text(:min(3, len(text))), byte_order_mark) == 1) first_letter = 4
  end function first_letter

  !> Why the bytes of a file are no text, with the remedy; '' for a text.
  pure function why_no_text(text) result(reason)
    character(*), intent(in) :: text
    character(:), allocatable :: reason
    reason = ''
    if (index(text(:min(len(text), num_looked_at)), achar(0)) > 0) then
      reason = 'it is in UTF-16, or no text; save it as UTF-8'
    else if (index(text, achar(13)) > 0 .and. index(text, achar(10)) == 0) then
      if (index(text, achar(13)) == len(text)) return ! one line
      reason = 'its lines end with CR alone; save it with the line ends LF or CR LF'
    end if
  end function why_no_text

  !> The message of the run-time library without the name of the file.
  pure function cause(message) result(reason)
    character(*), intent(in) :: message
    character(:), allocatable :: reason
    reason = trim(message(index(message, "': ") + merge(3, 1, index(message, "': ") > 0):))
    if (len(reason) == 0) reason = 'it is no file'
  end function cause

  !> Path of a file that another file names: relative paths start in the folder of the naming file.
  pure function path_beside(path, name) result(joined)
    character(*), intent(in) :: path !< of the naming file
    character(*), intent(in) :: name !< as written there
    character(:), allocatable :: joined
    joined = name
    if (name(1:1) /= '/') joined = path(:index(path, '/', back=.true.))//name
    do while (index(joined, '/./') > 0)
      joined = joined(:index(joined, '/./'))//joined(index(joined, '/./') + 3:)
    end do
    if (index(joined, './') == 1 .and. index(path, './') /= 1) joined = joined(3:)
  end function path_beside

  !> Path of a file that exists and that another file names. A deck in Latin-1 may name a file whose
  !> name is in Latin-1 on the disk, too. Else the path in UTF-8.
  function path_of_named(path, name) result(joined)
    character(*), intent(in) :: path !< of the naming file
    character(*), intent(in) :: name !< in UTF-8
    character(:), allocatable :: joined
    character(:), allocatable :: other
    logical :: exists
    joined = path_beside(path, name)
    inquire (file=joined, exist=exists)
    if (exists) return
    other = path_beside(path, latin1_of_utf8(name))
    if (other == joined) return
    inquire (file=other, exist=exists)
    if (exists) joined = other
  end function path_of_named
end module deck_file
