!> A CSV file that grows by whole lines: a killed run leaves no torn one.
module csv_files
  use errors, only: error_type, raise, system_failed
  use text_buffers, only: text_buffer
  implicit none
  private
  public :: csv_file

  !> Lines gather in `lines` and reach the disk in one piece with `save`.
  type :: csv_file
    integer :: unit = 0 !< 0 while it is not open
    integer :: good_size = 0 !< bytes of whole lines on the disk
    character(:), allocatable :: path
    type(text_buffer) :: lines
  contains
    procedure :: open => open_csv
    procedure :: save
    procedure :: close => close_csv
  end type csv_file

contains

  !> Starts the file with its header line; an old file of the same name is replaced.
  subroutine open_csv(self, path, header, error)
    class(csv_file), intent(inout) :: self
    character(*), intent(in) :: path
    character(*), intent(in) :: header
    type(error_type), allocatable, intent(out) :: error
    integer :: status
    self%path = path
    open (newunit=self%unit, file=path, access='stream', form='unformatted', status='replace', &
          action='readwrite', iostat=status)
    if (status /= 0) then
      self%unit = 0
      call raise(error, "cannot write '"//path//"'", system_failed)
      return
    end if
    call self%lines%add(header//new_line('a'))
    call self%save(error)
  end subroutine open_csv

  !> Writes the gathered lines. When the disk is full the file is cut back to its last whole line.
  subroutine save(self, error)
    class(csv_file), intent(inout) :: self
    type(error_type), allocatable, intent(out) :: error
    integer :: status, status_of_cut
    if (self%lines%length == 0) return
    write (self%unit, iostat=status) self%lines%room(:self%lines%length)
    if (status == 0) flush (self%unit, iostat=status)
    if (status /= 0) then
      read (self%unit, pos=self%good_size + 1, iostat=status_of_cut)
      if (status_of_cut == 0) endfile (self%unit)
      call raise(error, "cannot write '"//self%path//"' (disk full?)", system_failed)
    end if
    self%good_size = self%good_size + self%lines%length
    call self%lines%clear()
  end subroutine save

  !> Closes the file.
  subroutine close_csv(self)
    class(csv_file), intent(inout) :: self
    if (self%unit /= 0) close (self%unit)
    self%unit = 0
  end subroutine close_csv
end module csv_files
