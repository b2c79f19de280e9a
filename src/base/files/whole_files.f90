!> Files that are never visible half written: they are written as PATH.part and then renamed.
module whole_files
  use, intrinsic :: iso_c_binding, only: c_char, c_int, c_null_char, c_size_t
  use errors, only: error_type, raise_unwritten
  use raw_files, only: last_reason, raw_file
  implicit none
  private
  public :: whole_file, write_whole_file, write_over, move_file, remove_file

  type :: whole_file
    private
    type(raw_file) :: file
    character(:), allocatable :: path
    logical :: is_good = .false. !< everything so far is on the disk
  contains
    procedure :: open => open_file
    procedure :: put => put_bytes
    procedure :: complete
  end type whole_file

  interface
    !> C rename: replaces `to` in one operation.
    function c_rename(from, to) result(status) bind(c, name='rename')
      import :: c_char, c_int
      implicit none
      ! allow(assumed-size)
      character(kind=c_char), intent(in) :: from(*), to(*)
      integer(c_int) :: status
    end function c_rename

    !> Overwrites a file that is long enough; 0 for success (system_calls.c).
    function c_write_over(path, text, length) result(status) bind(c, name='keyway_write_over')
      import :: c_char, c_int, c_size_t
      implicit none
      ! allow(assumed-size)
      character(kind=c_char), intent(in) :: path(*), text(*)
      integer(c_size_t), intent(in), value :: length
      integer(c_int) :: status
    end function c_write_over

    !> POSIX unlink.
    function c_unlink(path) result(status) bind(c, name='unlink')
      import :: c_char, c_int
      implicit none
      ! allow(assumed-size)
      character(kind=c_char), intent(in) :: path(*)
      integer(c_int) :: status
    end function c_unlink
  end interface

contains

  !> Starts PATH.part.
  subroutine open_file(self, path)
    class(whole_file), intent(inout) :: self
    character(*), intent(in) :: path
    self%path = path
    call self%file%create(path//'.part', self%is_good)
  end subroutine open_file

  !> Adds bytes.
  subroutine put_bytes(self, bytes)
    class(whole_file), intent(inout) :: self
    character(*), intent(in) :: bytes
    if (self%is_good) call self%file%put(bytes, self%is_good)
  end subroutine put_bytes

  !> Renames PATH.part to PATH, or removes PATH.part when a write has failed.
  subroutine complete(self, error)
    class(whole_file), intent(inout) :: self
    type(error_type), allocatable, intent(out) :: error
    logical :: is_closed
    logical :: is_moved
    character(:), allocatable :: reason
    integer(c_int) :: status
    call self%file%close(is_closed)
    self%is_good = self%is_good .and. is_closed
    if (self%is_good) then
      call move_file(self%path//'.part', self%path, is_moved)
      if (is_moved) return
      self%file%reason = last_reason()
    end if
    reason = self%file%reason
    status = c_unlink(self%path//'.part'//c_null_char)
    call raise_unwritten(error, self%path, reason)
  end subroutine complete

  !> Renames a file in one operation; an existing file is replaced.
  subroutine move_file(from, to, is_moved)
    character(*), intent(in) :: from, to
    logical, intent(out) :: is_moved
    is_moved = c_rename(from//c_null_char, to//c_null_char) == 0
  end subroutine move_file

  !> Removes a file; a file that does not exist is no failure.
  subroutine remove_file(path)
    character(*), intent(in) :: path
    integer(c_int) :: status
    status = c_unlink(path//c_null_char)
  end subroutine remove_file

  !> Writes a whole file.
  subroutine write_whole_file(path, text, error)
    character(*), intent(in) :: path, text
    type(error_type), allocatable, intent(out) :: error
    type(whole_file) :: file
    call file%open(path)
    call file%put(text)
    call file%complete(error)
  end subroutine write_whole_file

  !> Writes a text over a file that is as long or longer; blanks fill the rest. This needs no new
  !> room on the disk.
  subroutine write_over(path, text, is_good)
    character(*), intent(in) :: path, text
    logical, intent(out) :: is_good
    is_good = c_write_over(path//c_null_char, text, len(text, c_size_t)) == 0
  end subroutine write_over
end module whole_files
