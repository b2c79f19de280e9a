!> Limits of the process: memory, the standard output, and files that are devices or pipes.
module process_limits
  use, intrinsic :: iso_c_binding, only: c_char, c_int, c_long_long, c_null_char, c_size_t
  use kinds, only: rk
  use errors, only: error_type, raise, system_failed
  implicit none
  private
  public :: prepare_process, try_memory, end_trial, note_part, print_text, why_no_file
  public :: free_memory

  interface
    !> Opens standard files that the caller has closed; must be the first call of the program.
    subroutine prepare_process() bind(c, name='keyway_prepare_process')
      implicit none
    end subroutine prepare_process

    !> Tries the memory of the threads of the BLAS; without it the program ends here, or before
    !> `end_trial`.
    subroutine try_memory(threads) bind(c, name='keyway_try_memory')
      import :: c_int
      implicit none
      integer(c_int), value :: threads
    end subroutine try_memory

    !> The BLAS has its memory: limits the memory of the process to what the machine has. A failed
    !> allocation has a message, a process that the kernel ends has none.
    subroutine end_trial() bind(c, name='keyway_end_trial')
      implicit none
    end subroutine end_trial

    subroutine keyway_note_part(name, is_beginning) bind(c)
      import :: c_char, c_int
      implicit none
      ! allow(assumed-size)
      character(kind=c_char), intent(in) :: name(*)
      integer(c_int), value :: is_beginning
    end subroutine keyway_note_part

    function keyway_kind_of_file(path) result(kind) bind(c)
      import :: c_char, c_int
      implicit none
      ! allow(assumed-size)
      character(kind=c_char), intent(in) :: path(*)
      integer(c_int) :: kind
    end function keyway_kind_of_file

    function keyway_free_memory(sharers) result(bytes) bind(c)
      import :: c_int, c_long_long
      implicit none
      integer(c_int), value :: sharers
      integer(c_long_long) :: bytes
    end function keyway_free_memory

    function keyway_write_output(text, length) result(is_good) bind(c)
      import :: c_char, c_int, c_size_t
      implicit none
      ! allow(assumed-size)
      character(kind=c_char), intent(in) :: text(*)
      integer(c_size_t), value :: length
      integer(c_int) :: is_good
    end function keyway_write_output
  end interface

  integer(c_int), parameter :: folder = 2, device = 3 !< kinds of files, process_limits.c

contains

  !> Memory that this process may still take [MB]; huge where the system does not say.
  real(rk) function free_memory(sharers) result(megabytes)
    integer, intent(in) :: sharers !< processes that share the machine, with this one
    integer(c_long_long) :: bytes
    bytes = keyway_free_memory(int(sharers, c_int))
    megabytes = huge(1.0_rk)
    if (bytes >= 0) megabytes = real(bytes, rk)/2.0_rk**20
  end function free_memory

  !> Names the part that is at work, for the message on missing memory. The program ends here if a
  !> part begins without some memory to spare.
  subroutine note_part(name, is_beginning)
    character(*), intent(in) :: name
    logical, intent(in) :: is_beginning !< else an earlier part goes on
    call keyway_note_part(trim(name)//c_null_char, merge(1_c_int, 0_c_int, is_beginning))
  end subroutine note_part

  !> Prints a text and a line feed on the standard output.
  subroutine print_text(text, error)
    character(*), intent(in) :: text
    type(error_type), allocatable, intent(out) :: error
    if (keyway_write_output(text//new_line('a'), len(text, c_size_t) + 1) /= 0) return
    call raise(error, 'keyway: cannot write to the standard output (closed, or its disk is full)', &
               system_failed)
  end subroutine print_text

  !> Why a path that exists cannot be read as a file; '' for a file and for a missing one.
  function why_no_file(path) result(reason)
    character(*), intent(in) :: path
    character(:), allocatable :: reason
    select case (keyway_kind_of_file(trim(path)//c_null_char))
    case (folder)
      reason = 'it is a folder'
    case (device)
      reason = 'it is a device or a pipe, not a file'
    case default
      reason = ''
    end select
  end function why_no_file
end module process_limits
