!> A CSV file that grows by whole lines: neither a killed run nor a full disk leaves half a line.
module csv_files
  use errors, only: deck_is_wrong, error_type, raise, raise_unwritten, system_failed
  use kinds, only: long, rk
  use archive_type, only: archive
  use text_buffers, only: text_buffer
  use raw_files, only: raw_file
  implicit none
  private
  public :: csv_file

  !> Lines gather in `lines` and reach the disk in one piece with `save`.
  type :: csv_file
    character(:), allocatable :: path
    type(text_buffer) :: lines
    type(raw_file), private :: file
    integer(long), private :: num_kept = 0 !< bytes at the checkpoint that the run goes on from
  contains
    procedure :: open => open_csv
    procedure :: save_position
    procedure :: load_position
    procedure :: go_on
    procedure :: add_row => add_increment
    procedure :: save => save_lines
    procedure :: close => close_csv
  end type csv_file

contains

  !> Starts the file with its header line; an old file of the same name is replaced.
  subroutine open_csv(self, path, header, error)
    class(csv_file), intent(inout) :: self
    character(*), intent(in) :: path
    character(*), intent(in) :: header
    type(error_type), allocatable, intent(out) :: error
    logical :: is_good
    self%path = path
    call self%file%create(path, is_good)
    if (.not. is_good) then
      call raise_unwritten(error, path, self%file%reason)
      return
    end if
    call self%lines%add(header//new_line('a'))
    call self%save(error)
  end subroutine open_csv

  !> Stores the length of the file in a checkpoint.
  subroutine save_position(self, name, file)
    class(csv_file), intent(in) :: self
    character(*), intent(in) :: name
    class(archive), intent(inout) :: file !< open for writing
    call file%put(name, real(self%file%num_bytes, rk)) ! exact up to 9e15
  end subroutine save_position

  !> Reads the length of the file from a checkpoint.
  subroutine load_position(self, name, file)
    class(csv_file), intent(inout) :: self
    character(*), intent(in) :: name
    class(archive), intent(inout) :: file !< open for reading
    real(rk) :: length
    length = 0.0_rk
    call file%get(name, length)
    self%num_kept = int(length, long)
  end subroutine load_position

  !> Opens the file of a run that goes on, and cuts off what follows the checkpoint. A file that is
  !> not in the checkpoint is started. The columns must be the same.
  subroutine go_on(self, path, header, error)
    class(csv_file), intent(inout) :: self
    character(*), intent(in) :: path
    character(*), intent(in) :: header
    type(error_type), allocatable, intent(out) :: error
    logical :: is_good
    if (self%num_kept == 0) then
      call self%open(path, header, error)
      return
    end if
    self%path = path
    if (.not. has_header(path, header)) then
      call raise(error, "cannot continue '"//path//"': the file is missing, or its columns are "// &
                 "not '"//header//"'", deck_is_wrong)
      return
    end if
    call self%file%open_again(path, self%num_kept, is_good)
    if (.not. is_good) call raise(error, "cannot continue '"//path//"': the file is shorter "// &
                                  'than at the checkpoint', system_failed)
  end subroutine go_on

  !> Whether the first line of a file is this one.
  logical function has_header(path, header)
    character(*), intent(in) :: path, header
    character(len(header) + 1) :: line !< one more letter than the header
    integer :: unit, status
    has_header = .false.
    open (newunit=unit, file=path, status='old', action='read', iostat=status)
    if (status /= 0) return
    read (unit, '(a)', iostat=status) line
    close (unit)
    has_header = status == 0 .and. line == header
  end function has_header

  !> Adds a line of one increment: step, increment, numbers.
  subroutine add_increment(self, step, increment, row)
    class(csv_file), intent(inout) :: self
    integer, intent(in) :: step, increment
    real(rk), intent(in) :: row(:)
    integer :: i
    call self%lines%add_integer(step)
    call self%lines%add(',')
    call self%lines%add_integer(increment)
    do i = 1, size(row)
      call self%lines%add(',')
      call self%lines%add_real(row(i))
    end do
    call self%lines%add(new_line('a'))
  end subroutine add_increment

  !> Writes the lines in memory to the disk, all or none.
  subroutine save_lines(self, error)
    class(csv_file), intent(inout) :: self
    type(error_type), allocatable, intent(out) :: error
    logical :: is_good
    if (self%lines%length == 0) return
    call self%file%put(self%lines%room(:self%lines%length), is_good)
    call self%lines%clear()
    if (is_good) return
    call raise_unwritten(error, self%path, self%file%reason)
  end subroutine save_lines

  !> Closes the file.
  subroutine close_csv(self, error)
    class(csv_file), intent(inout) :: self
    type(error_type), allocatable, intent(out) :: error
    logical :: is_good
    call self%file%close(is_good)
    if (.not. is_good) call raise_unwritten(error, self%path, self%file%reason)
  end subroutine close_csv
end module csv_files
