!> One VTK unstructured grid file (.vtu), raw appended binary, little endian.
!>
!> Arrays gather in memory in the order in which they are put; `save` writes the header with their
!> offsets and then their bytes, beside the final place and moved there.
module vtu_files
  use, intrinsic :: iso_fortran_env, only: int8, int32, int64
  use kinds, only: rk
  use errors, only: error_type, raise, system_failed
  use text_buffers, only: text_buffer, text_of
  use file_system, only: move_file
  implicit none
  private
  public :: vtu_file

  character, parameter :: nl = new_line('a')

  type :: byte_block
    integer(int8), allocatable :: bytes(:)
  end type byte_block

  type :: vtu_file
    private
    type(text_buffer) :: grid, points, cells !< XML of the sections
    type(byte_block), allocatable :: blocks(:)
    integer(int64) :: offset = 0 !< bytes of data so far, with their counts
    integer :: num_points = 0, num_cells = 0
  contains
    procedure :: start
    procedure :: put_point_reals
    procedure :: put_cell_reals
    procedure :: put_point_integers
    procedure :: put_cell_integers
    procedure :: save
    procedure, private :: append
  end type vtu_file

contains

  !> Starts a file with its grid.
  subroutine start(self, x, connectivity, ends, kinds)
    class(vtu_file), intent(inout) :: self
    real(rk), intent(in) :: x(:, :) !< (3, points) [m]
    integer, intent(in) :: connectivity(:) !< points of the cells, from 0
    integer, intent(in) :: ends(:) !< (cells) where each cell's points end
    integer, intent(in) :: kinds(:) !< (cells) VTK's codes
    integer(int8) :: none(0)
    self%num_points = size(x, 2)
    self%num_cells = size(kinds)
    allocate (self%blocks(0))
    call self%grid%add('<Points>'//nl)
    call self%append(self%grid, 'Points', 'Float64', 3, transfer(x, none), '')
    call self%grid%add('</Points>'//nl//'<Cells>'//nl)
    call self%append(self%grid, 'connectivity', 'Int32', 1, transfer(connectivity, none), '')
    call self%append(self%grid, 'offsets', 'Int32', 1, transfer(ends, none), '')
    call self%append(self%grid, 'types', 'UInt8', 1, int(kinds, int8), '')
    call self%grid%add('</Cells>'//nl)
  end subroutine start

  !> A field on the points.
  subroutine put_point_reals(self, name, values, components)
    class(vtu_file), intent(inout) :: self
    character(*), intent(in) :: name
    real(rk), intent(in) :: values(:, :) !< (components, points)
    character(*), intent(in) :: components !< their names with commas between, '' for none
    integer(int8) :: none(0)
    call self%append(self%points, name, 'Float64', size(values, 1), transfer(values, none), &
                     components)
  end subroutine put_point_reals

  !> A field on the cells.
  subroutine put_cell_reals(self, name, values, components)
    class(vtu_file), intent(inout) :: self
    character(*), intent(in) :: name
    real(rk), intent(in) :: values(:, :) !< (components, cells)
    character(*), intent(in) :: components !< their names with commas between, '' for none
    integer(int8) :: none(0)
    call self%append(self%cells, name, 'Float64', size(values, 1), transfer(values, none), &
                     components)
  end subroutine put_cell_reals

  !> Whole numbers on the points.
  subroutine put_point_integers(self, name, values)
    class(vtu_file), intent(inout) :: self
    character(*), intent(in) :: name
    integer, intent(in) :: values(:)
    integer(int8) :: none(0)
    call self%append(self%points, name, 'Int32', 1, transfer(int(values, int32), none), '')
  end subroutine put_point_integers

  !> Whole numbers on the cells.
  subroutine put_cell_integers(self, name, values)
    class(vtu_file), intent(inout) :: self
    character(*), intent(in) :: name
    integer, intent(in) :: values(:)
    integer(int8) :: none(0)
    call self%append(self%cells, name, 'Int32', 1, transfer(int(values, int32), none), '')
  end subroutine put_cell_integers

  !> Describes an array and keeps its bytes.
  subroutine append(self, section, name, kind, num_components, bytes, components)
    class(vtu_file), intent(inout) :: self
    type(text_buffer), intent(inout) :: section
    character(*), intent(in) :: name, kind, components
    integer, intent(in) :: num_components
    integer(int8), intent(in) :: bytes(:)
    character(24) :: place
    type(byte_block), allocatable :: more(:)
    integer :: i, n
    write (place, '(i0)') self%offset
    call section%add('<DataArray type="'//kind//'" Name="'//name//'" NumberOfComponents="'// &
                     text_of(num_components)//'"'//component_names(components)// &
                     ' format="appended" offset="'//trim(place)//'"/>'//nl)
    n = size(self%blocks)
    allocate (more(n + 1))
    do i = 1, n
      call move_alloc(self%blocks(i)%bytes, more(i)%bytes)
    end do
    more(n + 1)%bytes = bytes
    call move_alloc(more, self%blocks)
    self%offset = self%offset + size(bytes, kind=int64) + storage_size(self%offset)/8
  end subroutine append

  !> ComponentName0="xx" ComponentName1="yy" ...
  pure function component_names(list) result(text)
    character(*), intent(in) :: list !< 'xx,yy,..'
    character(:), allocatable :: text
    integer :: start, comma, i
    text = ''
    start = 1
    i = 0
    do while (start <= len(list))
      comma = index(list(start:)//',', ',')
      text = text//' ComponentName'//text_of(i)//'="'//list(start:start + comma - 2)//'"'
      start = start + comma
      i = i + 1
    end do
  end function component_names

  !> Writes the file.
  subroutine save(self, path, error)
    class(vtu_file), intent(inout) :: self
    character(*), intent(in) :: path
    type(error_type), allocatable, intent(out) :: error
    integer :: unit, status, i
    open (newunit=unit, file=path//'.part', access='stream', form='unformatted', status='replace', &
          action='write', iostat=status)
    if (status == 0) write (unit, iostat=status) header_of(self)
    do i = 1, size(self%blocks)
      if (status == 0) write (unit, iostat=status) size(self%blocks(i)%bytes, kind=int64)
      if (status == 0) write (unit, iostat=status) self%blocks(i)%bytes
    end do
    if (status == 0) write (unit, iostat=status) nl//'</AppendedData>'//nl//'</VTKFile>'//nl
    if (status == 0) close (unit, iostat=status)
    if (status /= 0) then
      call raise(error, "cannot write '"//path//"' (disk full?)", system_failed)
    else
      call move_file(path//'.part', path, error)
    end if
  end subroutine save

  !> Everything before the bytes.
  function header_of(self) result(text)
    class(vtu_file), intent(in) :: self
    character(:), allocatable :: text
    text = '<?xml version="1.0"?>'//nl//'<VTKFile type="UnstructuredGrid" version="1.0"'// &
           ' byte_order="LittleEndian" header_type="UInt64">'//nl//'<UnstructuredGrid>'//nl// &
           '<Piece NumberOfPoints="'//text_of(self%num_points)//'" NumberOfCells="'// &
           text_of(self%num_cells)//'">'//nl//self%grid%contents()//'<PointData>'//nl// &
           self%points%contents()//'</PointData>'//nl//'<CellData>'//nl// &
           self%cells%contents()//'</CellData>'//nl//'</Piece>'//nl//'</UnstructuredGrid>'//nl// &
           '<AppendedData encoding="raw">'//nl//'_'
  end function header_of
end module vtu_files
