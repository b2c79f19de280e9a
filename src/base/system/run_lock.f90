!> The lock of a run, job.lock: one process at a time writes the results of a job.
!>
!> The file names the process and its host, and the kernel holds a lock on it as long as the process
!> lives. A file without a lock was left by a process that was killed: every other end of the
!> program removes it (system_calls.c), also one by missing memory or by a second Ctrl-C.
module run_lock
  use, intrinsic :: iso_c_binding, only: c_char, c_int, c_null_char, c_size_t
  use errors, only: error_type, raise, raise_unwritten, system_failed
  implicit none
  private
  public :: job_lock

  integer, parameter :: longest_holder = 300
  !> Answers of `c_take_lock`.
  integer(c_int), parameter :: held = -2, of_other_host = -3, is_full = -4

  type :: job_lock
    private
    integer(c_int) :: descriptor = -1 !< -1 while it is not taken
    character(:), allocatable, public :: earlier !< process that left the lock behind, '' for none
  contains
    procedure :: take
    procedure :: give_back
  end type job_lock

  interface
    !> Takes the lock; below 0 it cannot (system_calls.c).
    function c_take_lock(path, holder, room) result(descriptor) bind(c, name='keyway_take_lock')
      import :: c_char, c_int, c_size_t
      implicit none
      ! allow(assumed-size)
      character(kind=c_char), intent(in) :: path(*)
      integer(c_size_t), intent(in), value :: room
      character(kind=c_char), intent(inout) :: holder(room)
      integer(c_int) :: descriptor
    end function c_take_lock

    !> Removes the file and gives the lock back.
    subroutine c_give_lock() bind(c, name='keyway_give_lock')
      implicit none
    end subroutine c_give_lock
  end interface

contains

  !> Takes the lock, or says who has it. A lock that this run has taken already stays taken.
  subroutine take(self, path, error)
    class(job_lock), intent(inout) :: self
    character(*), intent(in) :: path !< of the lock file, in a folder that exists
    type(error_type), allocatable, intent(out) :: error
    character(kind=c_char) :: holder(longest_holder)
    character(:), allocatable :: who
    if (self%descriptor >= 0) return
    holder = c_null_char
    self%descriptor = c_take_lock(path//c_null_char, holder, size(holder, kind=c_size_t))
    self%earlier = text_of(holder)
    if (self%descriptor >= 0) return
    who = 'process '//self%earlier(:max(1, index(self%earlier, ' ')) - 1)//' on host '// &
          self%earlier(index(self%earlier, ' ') + 1:)
    select case (self%descriptor)
    case (held)
      call raise(error, "keyway: '"//path//"': "//who//' runs this job in this folder; wait '// &
                 'for its end or give another folder with -o', system_failed)
    case (of_other_host)
      call raise(error, "keyway: '"//path//"': "//who//' runs this job in this folder, or was '// &
                 'killed there; remove the file when that process has ended', system_failed)
    case (is_full)
      call raise_unwritten(error, path)
    case default
      call raise(error, "keyway: cannot take the lock '"//path//"': the folder cannot be "// &
                 'written, or the file is not a lock of Keyway', system_failed)
    end select
  end subroutine take

  !> Gives the lock back and removes its file.
  subroutine give_back(self)
    class(job_lock), intent(inout) :: self
    if (self%descriptor >= 0) call c_give_lock()
    self%descriptor = -1
  end subroutine give_back

  !> The text before the null character.
  pure function text_of(letters) result(text)
    character(kind=c_char), intent(in) :: letters(:)
    character(:), allocatable :: text
    integer :: i
    text = ''
    do i = 1, size(letters)
      if (letters(i) == c_null_char) return
      text = text//letters(i)
    end do
  end function text_of
end module run_lock
