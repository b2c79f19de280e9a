!> Files written without buffers, so that the write itself fails on a full disk: units of Fortran
!> report no failure when they are flushed or closed.
module raw_files
  use, intrinsic :: iso_c_binding, only: c_char, c_int, c_long, c_null_char, c_size_t
  use kinds, only: long
  implicit none
  private
  public :: raw_file, last_reason

  type :: raw_file
    integer(c_int) :: descriptor = -1 !< -1 while it is not open
    integer(long) :: num_bytes = 0 !< of all good writes
    character(:), allocatable :: reason !< of the last failure, as the system calls it
  contains
    procedure :: create
    procedure :: open_again
    procedure :: is_open
    procedure :: put => put_raw
    procedure :: close => close_file
  end type raw_file

  interface
    !> Makes an empty file or empties an old one (system_calls.c).
    function c_create(path, mode) result(descriptor) bind(c, name='keyway_create')
      import :: c_char, c_int
      implicit none
      ! allow(assumed-size)
      character(kind=c_char), intent(in) :: path(*)
      integer(c_int), intent(in), value :: mode
      integer(c_int) :: descriptor
    end function c_create

    !> Opens a file for appending and cuts it off (system_calls.c).
    function c_open_again(path, num_bytes) result(descriptor) bind(c, name='keyway_open_again')
      import :: c_char, c_int, c_long
      implicit none
      ! allow(assumed-size)
      character(kind=c_char), intent(in) :: path(*)
      integer(c_long), intent(in), value :: num_bytes
      integer(c_int) :: descriptor
    end function c_open_again

    !> POSIX write: the number of bytes written, or -1.
    function c_write(descriptor, bytes, num_bytes) result(num_taken) bind(c, name='write')
      import :: c_char, c_int, c_size_t
      implicit none
      integer(c_int), intent(in), value :: descriptor
      ! allow(assumed-size)
      character(kind=c_char), intent(in) :: bytes(*)
      integer(c_size_t), intent(in), value :: num_bytes
      integer(c_size_t) :: num_taken
    end function c_write

    !> The reason of the last failed call (system_calls.c).
    subroutine c_reason(text, room) bind(c, name='keyway_reason')
      import :: c_char, c_size_t
      implicit none
      integer(c_size_t), intent(in), value :: room
      character(kind=c_char), intent(inout) :: text(room)
    end subroutine c_reason

    !> POSIX ftruncate.
    function c_ftruncate(descriptor, num_bytes) result(status) bind(c, name='ftruncate')
      import :: c_int, c_long
      implicit none
      integer(c_int), intent(in), value :: descriptor
      integer(c_long), intent(in), value :: num_bytes
      integer(c_int) :: status
    end function c_ftruncate

    !> POSIX close.
    function c_close(descriptor) result(status) bind(c, name='close')
      import :: c_int
      implicit none
      integer(c_int), intent(in), value :: descriptor
      integer(c_int) :: status
    end function c_close
  end interface

  integer(c_int), parameter :: mode_of_files = int(o'644', c_int)

contains

  !> Makes the file.
  subroutine create(self, path, is_good)
    class(raw_file), intent(inout) :: self
    character(*), intent(in) :: path
    logical, intent(out) :: is_good
    self%descriptor = c_create(path//c_null_char, mode_of_files)
    self%reason = last_reason()
    self%num_bytes = 0
    is_good = self%descriptor >= 0
  end subroutine create

  !> Opens a file after its first bytes; what follows them is cut off. Fails for a shorter file.
  subroutine open_again(self, path, num_bytes, is_good)
    class(raw_file), intent(inout) :: self
    character(*), intent(in) :: path
    integer(long), intent(in) :: num_bytes
    logical, intent(out) :: is_good
    self%descriptor = c_open_again(path//c_null_char, int(num_bytes, c_long))
    self%num_bytes = num_bytes
    is_good = self%descriptor >= 0
  end subroutine open_again

  !> Whether the file is open.
  pure logical function is_open(self)
    class(raw_file), intent(in) :: self
    is_open = self%descriptor >= 0
  end function is_open

  !> Writes all bytes, or none: on a full disk the file is cut back to its former length.
  subroutine put_raw(self, bytes, is_good)
    class(raw_file), intent(inout) :: self
    character(*), intent(in) :: bytes
    logical, intent(out) :: is_good
    integer(c_size_t) :: num_done, num_taken
    num_done = 0
    do while (num_done < len(bytes, c_size_t))
      num_taken = c_write(self%descriptor, bytes(num_done + 1:), len(bytes, c_size_t) - num_done)
      if (num_taken <= 0) exit
      num_done = num_done + num_taken
    end do
    is_good = num_done == len(bytes, c_size_t)
    if (.not. is_good) self%reason = last_reason()
    if (is_good) then
      self%num_bytes = self%num_bytes + num_done
    else if (c_ftruncate(self%descriptor, int(self%num_bytes, c_long)) /= 0) then
      return ! nothing more can be done: the caller reports the failure
    end if
  end subroutine put_raw

  !> The reason of the last failed call, as the system calls it.
  function last_reason() result(reason)
    character(:), allocatable :: reason
    integer, parameter :: longest = 100
    character(kind=c_char) :: letters(longest)
    integer :: i
    letters = c_null_char
    call c_reason(letters, int(longest, c_size_t))
    reason = ''
    do i = 1, first_null(letters) - 1
      reason = reason//letters(i)
    end do
  end function last_reason

  !> Position of the first null character.
  pure integer function first_null(letters) result(place)
    character(kind=c_char), intent(in) :: letters(:)
    do place = 1, size(letters)
      if (letters(place) == c_null_char) return
    end do
  end function first_null

  !> Closes the file.
  subroutine close_file(self, is_good)
    class(raw_file), intent(inout) :: self
    logical, intent(out) :: is_good
    is_good = .true.
    if (self%descriptor >= 0) is_good = c_close(self%descriptor) == 0
    if (.not. is_good) self%reason = last_reason()
    self%descriptor = -1
  end subroutine close_file
end module raw_files
