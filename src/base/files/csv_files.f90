!> A CSV file that grows by whole lines: neither a killed run nor a full disk leaves half a line.
module csv_files
  use errors, only: error_type, raise, system_failed
  use kinds, only: rk
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
  contains
    procedure :: open => open_csv
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
      call raise(error, "cannot write '"//path//"'", system_failed)
      return
    end if
    call self%lines%add(header//new_line('a'))
    call self%save(error)
  end subroutine open_csv

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
    call raise(error, "cannot write '"//self%path//"' (disk full?)", system_failed)
  end subroutine save_lines

  !> Closes the file.
  subroutine close_csv(self, error)
    class(csv_file), intent(inout) :: self
    type(error_type), allocatable, intent(out) :: error
    logical :: is_good
    call self%file%close(is_good)
    if (.not. is_good) call raise(error, "cannot close '"//self%path//"'", system_failed)
  end subroutine close_csv
end module csv_files
