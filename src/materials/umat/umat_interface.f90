!> The 37 arguments of a UMAT, and the C functions that load, guard and serve it.
module umat_interface
  use, intrinsic :: iso_c_binding, only: c_char, c_double, c_funptr, c_int, c_size_t
  use, intrinsic :: iso_c_binding, only: c_null_char, c_null_ptr, c_ptr
  implicit none
  private
  public :: umat_arguments, keyway_umat_call, keyway_umat_start, keyway_umat_external
  public :: keyway_umat_open, keyway_umat_find, keyway_umat_set_job, keyway_umat_counts
  public :: keyway_umat_count, keyway_umat_stop, keyway_umat_disable_traps
  public :: keyway_umat_restore_traps, keyway_make_temporary, keyway_remove_temporary
  public :: keyway_umat_restore_folder
  public :: failure_reason, text_from_c

  integer, parameter :: longest_message = 512

  !> Arguments of one call, in the order of the bridge, with the names of the interface.
  type, bind(c) :: umat_arguments
    real(c_double) :: stress(6) = 0, ddsdde(6, 6) = 0, sse = 0, spd = 0, scd = 0
    real(c_double) :: rpl = 0, ddsddt(6) = 0, drplde(6) = 0, drpldt = 0
    real(c_double) :: stran(6) = 0, dstran(6) = 0, time(2) = 0, dtime = 0
    real(c_double) :: temp = 0, dtemp = 0, predef(1) = 0, dpred(1) = 0
    real(c_double) :: coords(3) = 0
    real(c_double) :: drot(3, 3) = reshape(real([1, 0, 0, 0, 1, 0, 0, 0, 1], c_double), [3, 3])
    real(c_double) :: pnewdt = 0, celent = 0, dfgrd0(3, 3) = 0, dfgrd1(3, 3) = 0
    type(c_ptr) :: statev = c_null_ptr, props = c_null_ptr
    integer(c_int) :: ndi = 3, nshr = 3, ntens = 6, nstatv = 0, nprops = 0
    integer(c_int) :: noel = 0, npt = 0, layer = 1, kspt = 1
    integer(c_int) :: kstep(4) = 0 !< the step; the other entries are 0
    integer(c_int) :: kinc = 0
    character(kind=c_char) :: cmname(80) = ' '
  end type umat_arguments

  interface
    !> Calls UMAT; 1 if it stops, else 0.
    function keyway_umat_call(routine, arguments) result(status) bind(c)
      import :: c_funptr, c_int, umat_arguments
      implicit none
      type(c_funptr), value :: routine
      type(umat_arguments), intent(inout) :: arguments
      integer(c_int) :: status
    end function keyway_umat_call

    !> Calls SDVINI with the state variables, place and numbers of the arguments.
    function keyway_umat_start(routine, arguments) result(status) bind(c)
      import :: c_funptr, c_int, umat_arguments
      implicit none
      type(c_funptr), value :: routine
      type(umat_arguments), intent(inout) :: arguments
      integer(c_int) :: status
    end function keyway_umat_start

    !> Calls UEXTERNALDB.
    function keyway_umat_external(routine, lop, restart, time, dtime, step, increment) &
      result(status) bind(c)
      import :: c_double, c_funptr, c_int
      implicit none
      type(c_funptr), value :: routine
      integer(c_int), value :: lop, restart
      real(c_double), intent(in) :: time(2) !< of the step, of the analysis [s]
      real(c_double), value :: dtime
      integer(c_int), value :: step, increment
      integer(c_int) :: status
    end function keyway_umat_external

    !> Reason of the last stop in this thread.
    subroutine keyway_umat_message(message, size) bind(c)
      import :: c_char, c_size_t
      implicit none
      integer(c_size_t), intent(in), value :: size
      character(kind=c_char), intent(out) :: message(size)
    end subroutine keyway_umat_message

    !> Loads a library; null with a message on failure.
    function keyway_umat_open(path, message, size) result(handle) bind(c)
      import :: c_char, c_ptr, c_size_t
      implicit none
      ! allow(assumed-size)
      character(kind=c_char), intent(in) :: path(*)
      integer(c_size_t), intent(in), value :: size
      character(kind=c_char), intent(out) :: message(size)
      type(c_ptr) :: handle
    end function keyway_umat_open

    !> A routine of a library by its symbol; null if missing.
    function keyway_umat_find(handle, name) result(routine) bind(c)
      import :: c_char, c_funptr, c_ptr
      implicit none
      type(c_ptr), value :: handle
      ! allow(assumed-size)
      character(kind=c_char), intent(in) :: name(*)
      type(c_funptr) :: routine
    end function keyway_umat_find

    !> Sets the results of GETJOBNAME and GETOUTDIR.
    subroutine keyway_umat_set_job(name, folder) bind(c)
      import :: c_char
      implicit none
      ! allow(assumed-size)
      character(kind=c_char), intent(in) :: name(*), folder(*)
    end subroutine keyway_umat_set_job

    !> Counts a warning (0) or an error (1) that the UMAT wrote.
    subroutine keyway_umat_count(is_error) bind(c)
      import :: c_int
      implicit none
      integer(c_int), value :: is_error
    end subroutine keyway_umat_count

    !> Numbers of warnings and errors.
    subroutine keyway_umat_counts(warnings, errors) bind(c)
      import :: c_int
      implicit none
      integer(c_int), intent(out) :: warnings, errors
    end subroutine keyway_umat_counts

    !> Jumps back to the guarded call; never returns.
    subroutine keyway_umat_stop(message, length) bind(c)
      import :: c_char, c_size_t
      implicit none
      ! allow(assumed-size)
      character(kind=c_char), intent(in) :: message(*)
      integer(c_size_t), value :: length
    end subroutine keyway_umat_stop

    !> Disables traps of floating-point exceptions until keyway_umat_restore_traps.
    subroutine keyway_umat_disable_traps() bind(c)
      implicit none
    end subroutine keyway_umat_disable_traps

    subroutine keyway_umat_restore_traps() bind(c)
      implicit none
    end subroutine keyway_umat_restore_traps

    !> Goes back to the working folder of the start; 1 if a routine had changed it.
    function keyway_umat_restore_folder() result(has_moved) bind(c)
      import :: c_int
      implicit none
      integer(c_int) :: has_moved
    end function keyway_umat_restore_folder

    !> Makes a temporary folder; an empty path on failure.
    subroutine keyway_make_temporary(path, size) bind(c)
      import :: c_char, c_size_t
      implicit none
      integer(c_size_t), intent(in), value :: size
      character(kind=c_char), intent(out) :: path(size)
    end subroutine keyway_make_temporary

    !> Removes a folder and the files in it.
    subroutine keyway_remove_temporary(path) bind(c)
      import :: c_char
      implicit none
      ! allow(assumed-size)
      character(kind=c_char), intent(in) :: path(*)
    end subroutine keyway_remove_temporary
  end interface

contains

  !> Reason of the last stop in this thread: 'XIT was called'.
  function failure_reason() result(text)
    character(:), allocatable :: text
    character(kind=c_char) :: message(longest_message)
    call keyway_umat_message(message, int(longest_message, c_size_t))
    text = text_from_c(message)
  end function failure_reason

  !> The text before the null.
  pure function text_from_c(letters) result(text)
    character(kind=c_char), intent(in) :: letters(:)
    character(:), allocatable :: text
    integer :: i, length
    length = findloc(letters, c_null_char, 1) - 1
    if (length < 0) length = size(letters)
    allocate (character(length) :: text)
    do i = 1, length
      text(i:i) = letters(i)
    end do
  end function text_from_c
end module umat_interface
