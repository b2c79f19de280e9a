!> Sets an HDF5 file back to a checkpoint: the file driver keeps what later writes replace
!> (undo_driver.c), undo_restore.c writes this back.
module undo_journal
  use, intrinsic :: iso_c_binding, only: c_char, c_int, c_int64_t, c_null_char
  use hdf5, only: hid_t
  implicit none
  private
  public :: undo_access, mark_flushed, start_journal, number_of_journal, restore_file
  public :: is_restored, no_journal, no_old_journal, bad_journal, bad_old_journal, no_file, &
            short_file, other_file

  ! What a restore has found, as in undo_restore.c.
  integer, parameter :: is_restored = 0 !< the file is as it was at the checkpoint
  integer, parameter :: no_journal = 1 !< the last journal is missing, or of another checkpoint
  integer, parameter :: no_old_journal = 2 !< the journal before the last is
  integer, parameter :: bad_journal = 3 !< a record of the last journal has changed
  integer, parameter :: bad_old_journal = 4 !< a record of the journal before has
  integer, parameter :: no_file = 5 !< the file is missing, or cannot be opened for writing
  integer, parameter :: short_file = 6 !< it is shorter than at the checkpoint
  integer, parameter :: other_file = 7 !< it is not as it was at the checkpoint

  interface
    !> A list of file access properties with the driver; below 0 after a failure.
    function c_access() result(access) bind(c, name='keyway_undo_access')
      import :: c_int64_t
      implicit none
      integer(c_int64_t) :: access
    end function c_access

    !> 0 for success.
    function c_mark(file) result(status) bind(c, name='keyway_undo_mark')
      import :: c_int, c_int64_t
      implicit none
      integer(c_int64_t), intent(in), value :: file
      integer(c_int) :: status
    end function c_mark

    !> 0 for success.
    function c_start(file, path, number) result(status) bind(c, name='keyway_undo_start')
      import :: c_char, c_int, c_int64_t
      implicit none
      integer(c_int64_t), intent(in), value :: file
      ! allow(assumed-size)
      character(kind=c_char), intent(in) :: path(*)
      integer(c_int), intent(in), value :: number
      integer(c_int) :: status
    end function c_start

    !> -1 without a valid journal.
    function c_number(path) result(number) bind(c, name='keyway_undo_number')
      import :: c_char, c_int
      implicit none
      ! allow(assumed-size)
      character(kind=c_char), intent(in) :: path(*)
      integer(c_int) :: number
    end function c_number

    !> One of the numbers above, or more where a write has failed.
    function c_restore(path, starting, last, old, number) result(status) &
      bind(c, name='keyway_undo_restore')
      import :: c_char, c_int
      implicit none
      ! allow(assumed-size)
      character(kind=c_char), intent(in) :: path(*), starting(*), last(*), old(*)
      integer(c_int), intent(in), value :: number
      integer(c_int) :: status
    end function c_restore
  end interface

contains

  !> A list of file access properties with the driver, to be closed; below 0 after a failure.
  integer(hid_t) function undo_access()
    undo_access = int(c_access(), hid_t)
  end function undo_access

  !> A file that is open with `undo_access` was flushed: a write that fails later sets it back to
  !> its present state.
  subroutine mark_flushed(file, is_good)
    integer(hid_t), intent(in) :: file
    logical, intent(out) :: is_good
    is_good = c_mark(int(file, c_int64_t)) == 0
  end subroutine mark_flushed

  !> Starts the journal of a checkpoint of a file that is open with `undo_access` and flushed.
  subroutine start_journal(file, path, number, is_good)
    integer(hid_t), intent(in) :: file
    character(*), intent(in) :: path !< of the journal
    integer, intent(in) :: number !< of the checkpoint
    logical, intent(out) :: is_good
    is_good = c_start(int(file, c_int64_t), path//c_null_char, int(number, c_int)) == 0
  end subroutine start_journal

  !> Number of the checkpoint that a journal belongs to, -1 without one.
  integer function number_of_journal(path) result(number)
    character(*), intent(in) :: path
    number = c_number(path//c_null_char)
  end function number_of_journal

  !> Sets a file, which must not be open, back to a checkpoint. A file that cannot be set back is
  !> not changed, unless a write fails.
  integer function restore_file(path, starting, last, old, number) result(found)
    character(*), intent(in) :: path
    character(*), intent(in) :: starting !< journal of a checkpoint that was being written
    character(*), intent(in) :: last, old !< journals of the last checkpoint and of the one before
    integer, intent(in) :: number !< of the checkpoint
    found = c_restore(path//c_null_char, starting//c_null_char, last//c_null_char, &
                      old//c_null_char, int(number, c_int))
  end function restore_file
end module undo_journal
