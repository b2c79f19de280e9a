!> Tables of an HDF5 file that get a row per increment; rows stay in memory between flushes.
module hdf5_tables
  use kinds, only: rk
  use hdf5_files, only: hdf5_file
  implicit none
  private
  public :: growing_table

  integer, parameter :: capacity = 256 !< rows kept in memory

  type :: growing_table
    private
    character(:), allocatable :: path
    real(rk), allocatable :: rows(:, :) !< (columns, capacity)
    integer :: num_kept = 0, num_written = 0
  contains
    procedure :: start => start_rows
    procedure :: go_on
    procedure :: num_rows
    procedure :: add => add_table_row
    procedure :: write_rows
  end type growing_table

contains

  !> Makes the empty table in the file.
  subroutine start_rows(self, file, path, columns)
    class(growing_table), intent(inout) :: self
    type(hdf5_file), intent(inout) :: file
    character(*), intent(in) :: path
    character(*), intent(in) :: columns !< their names, with commas between
    integer :: i
    self%path = path
    allocate (self%rows(1 + count([(columns(i:i) == ',', i=1, len(columns))]), capacity))
    call file%start_table(path, columns)
  end subroutine start_rows

  !> Goes on with a table that is in the file.
  subroutine go_on(self, path, columns, num_rows)
    class(growing_table), intent(inout) :: self
    character(*), intent(in) :: path
    character(*), intent(in) :: columns !< their names, with commas between
    integer, intent(in) :: num_rows !< rows in the file
    integer :: i
    self%path = path
    allocate (self%rows(1 + count([(columns(i:i) == ',', i=1, len(columns))]), capacity))
    self%num_written = num_rows
  end subroutine go_on

  !> Rows in the file and in memory.
  pure integer function num_rows(self)
    class(growing_table), intent(in) :: self
    num_rows = self%num_written + self%num_kept
  end function num_rows

  !> Adds a row.
  subroutine add_table_row(self, file, row)
    class(growing_table), intent(inout) :: self
    type(hdf5_file), intent(inout) :: file
    real(rk), intent(in) :: row(:)
    if (self%num_kept == capacity) call self%write_rows(file)
    self%num_kept = self%num_kept + 1
    self%rows(:, self%num_kept) = row
  end subroutine add_table_row

  !> Moves the rows from memory to the file; does nothing for a table that was not started.
  subroutine write_rows(self, file)
    class(growing_table), intent(inout) :: self
    type(hdf5_file), intent(inout) :: file
    if (.not. allocated(self%path)) return
    call file%extend_table(self%path, self%rows(:, :self%num_kept), self%num_written)
    self%num_written = self%num_written + self%num_kept
    self%num_kept = 0
  end subroutine write_rows
end module hdf5_tables
