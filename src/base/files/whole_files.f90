!> Files that are never visible half written: they are written as PATH.part and then renamed.
module whole_files
  use, intrinsic :: iso_c_binding, only: c_char, c_int, c_null_char
  use errors, only: error_type, raise, system_failed
  use raw_files, only: raw_file
  implicit none
  private
  public :: whole_file, write_whole_file, move_file, remove_file

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
    integer(c_int) :: status
    call self%file%close(is_closed)
    self%is_good = self%is_good .and. is_closed
    if (self%is_good) then
      call move_file(self%path//'.part', self%path, is_moved)
      if (is_moved) return
    end if
    status = c_unlink(self%path//'.part'//c_null_char)
    call raise(error, "cannot write '"//self%path//"' (disk full?)", system_failed)
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
end module whole_files
