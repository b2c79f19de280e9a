!> The log of a run: job.log, and lines on stderr.
!>
!> On a terminal, progress overwrites one line; through a pipe, it is a line now and then. Quiet:
!> stderr holds errors only.
module logging
  use, intrinsic :: iso_c_binding, only: c_int
  use, intrinsic :: iso_fortran_env, only: error_unit
  use errors, only: error_type, raise_unwritten
  use kinds, only: long
  use message_catalogue, only: label_of_run
  use raw_files, only: raw_file
  implicit none
  private
  public :: run_log

  character, parameter :: return = achar(13) !< moves to the start of the line
  integer(c_int), parameter :: standard_error = 2 !< its file descriptor

  !> The log of a run.
  type :: run_log
    type(raw_file), private :: file !< not open: no file
    logical :: is_quiet = .false. !< only errors go to stderr
    logical :: is_terminal = .false. !< stderr is a terminal
    logical :: has_failed = .false. !< a line could not be written to the file (disk full)
    integer :: width_in_place = 0 !< letters of the progress line on the terminal
  contains
    procedure :: open => open_log
    procedure :: say
    procedure :: note
    procedure :: progress
    procedure :: close => close_log
  end type run_log

  interface
    !> C library: 1 for a terminal.
    function isatty(descriptor) result(answer) bind(C, name='isatty')
      import :: c_int
      implicit none
      integer(c_int), intent(in), value :: descriptor
      integer(c_int) :: answer
    end function isatty

    !> Letters in a line of a terminal.
    function terminal_width(descriptor) result(width) bind(C, name='keyway_terminal_width')
      import :: c_int
      implicit none
      integer(c_int), intent(in), value :: descriptor
      integer(c_int) :: width
    end function terminal_width
  end interface

contains

  !> Opens the log; without a path lines go to stderr only.
  subroutine open_log(self, is_quiet, error, path, is_continued)
    class(run_log), intent(inout) :: self
    logical, intent(in) :: is_quiet !< only errors go to stderr
    type(error_type), allocatable, intent(out) :: error
    character(*), intent(in), optional :: path !< of the file
    logical, intent(in), optional :: is_continued !< append to the file; default: write it anew
    logical :: is_good
    integer(long) :: num_bytes
    self%is_quiet = is_quiet
    self%is_terminal = isatty(standard_error) == 1
    if (.not. present(path)) return
    is_good = .false.
    if (present(is_continued)) then
      inquire (file=path, size=num_bytes) ! -1 for no file
      if (is_continued .and. num_bytes >= 0) call self%file%open_again(path, num_bytes, is_good)
    end if
    if (.not. is_good) call self%file%create(path, is_good)
    if (is_good) return
    call raise_unwritten(error, path, self%file%reason)
  end subroutine open_log

  !> Writes a line to the file and to stderr.
  subroutine say(self, line)
    class(run_log), intent(inout) :: self
    character(*), intent(in) :: line !< may hold several lines
    character(:), allocatable :: label
    label = ''
    if (index(line, 'warning: ') == 1) label = label_of_run(line)
    call self%note(line//label)
    if (.not. self%is_quiet) call show(self, line//label)
  end subroutine say

  !> Writes a line to the file only.
  subroutine note(self, line)
    class(run_log), intent(inout) :: self
    character(*), intent(in) :: line !< may hold several lines
    logical :: is_good
    if (.not. self%file%is_open()) return
    call self%file%put(line//new_line('a'), is_good)
    if (.not. is_good) self%has_failed = .true.
  end subroutine note

  !> Writes a line on the progress to stderr alone. On a terminal it replaces the previous one, and
  !> loses the last of its parts between commas where it is too long.
  subroutine progress(self, line)
    class(run_log), intent(inout) :: self
    character(*), intent(in) :: line
    integer :: length
    if (self%is_quiet) return
    if (.not. self%is_terminal) then
      call show(self, line)
      return
    end if
    length = fitting_length(line, int(terminal_width(standard_error)) - 1)
    write (error_unit, '(3a)', advance='no') return, line(:length), &
      repeat(' ', max(self%width_in_place - length, 0))
    flush (error_unit)
    self%width_in_place = length
  end subroutine progress

  !> Letters of the parts that fit into a width.
  pure integer function fitting_length(line, width) result(length)
    character(*), intent(in) :: line
    integer, intent(in) :: width
    length = len(line)
    do while (length > width)
      length = index(line(:length), ',', back=.true.) - 1
      if (length < 1) exit
    end do
    if (length < 1) length = min(len(line), width)
  end function fitting_length

  !> Ends the progress line and closes the file.
  subroutine close_log(self)
    class(run_log), intent(inout) :: self
    logical :: is_good
    call end_progress(self)
    call self%file%close(is_good)
    if (.not. is_good) self%has_failed = .true.
  end subroutine close_log

  !> Writes to stderr, below the progress line.
  subroutine show(self, line)
    class(run_log), intent(inout) :: self
    character(*), intent(in) :: line
    call end_progress(self)
    write (error_unit, '(a)') line
  end subroutine show

  !> Ends the progress line; further lines follow below it.
  subroutine end_progress(self)
    class(run_log), intent(inout) :: self
    if (self%width_in_place > 0) write (error_unit, '(a)') ''
    self%width_in_place = 0
  end subroutine end_progress
end module logging
