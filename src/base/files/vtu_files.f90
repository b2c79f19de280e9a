!> One VTK unstructured grid file (.vtu), raw appended binary, little endian.
!>
!> Arrays stay in memory until `save` writes the header with their offsets, then their bytes. The
!> bytes stand in reverse order of the header's list: meshio finds arrays by offsets that it
!> changes while reading, and takes the first match in the list.
module vtu_files
  use, intrinsic :: iso_fortran_env, only: int32, int64
  use kinds, only: rk
  use errors, only: error_type
  use text_buffers, only: text_of
  use whole_files, only: whole_file
  implicit none
  private
  public :: vtu_file

  character, parameter :: nl = new_line('a')

  !> Sections of the header, in their order.
  integer, parameter :: in_points = 1, in_cells = 2, on_points = 3, on_cells = 4
  character(9), parameter :: section_names(4) = ['Points   ', 'Cells    ', 'PointData', 'CellData ']

  !> One array of the file.
  type :: data_array
    integer :: section = 0
    character(:), allocatable :: attributes !< XML, without the offset
    character(:), allocatable :: bytes
    integer(int64) :: offset = 0 !< where its count and bytes stand in the appended data
  end type data_array

  type :: vtu_file
    private
    type(data_array), allocatable :: arrays(:) !< in the order of the header
    integer :: num_points = 0, num_cells = 0
  contains
    procedure :: start => start_vtu
    procedure :: put_point_reals
    procedure :: put_point_integers
    procedure :: put_cell_reals
    procedure :: put_cell_integers
    procedure :: save => save_vtu
    procedure, private :: append
  end type vtu_file

contains

  !> Starts a file with its grid.
  subroutine start_vtu(self, x, connectivity, ends, kinds)
    class(vtu_file), intent(inout) :: self
    real(rk), intent(in) :: x(:, :) !< (3, points) [m]
    integer, intent(in) :: connectivity(:) !< points of the cells, from 0
    integer, intent(in) :: ends(:) !< (cells) where each cell's points end
    integer, intent(in) :: kinds(:) !< (cells) VTK's codes
    self%num_points = size(x, 2)
    self%num_cells = size(kinds)
    allocate (self%arrays(0))
    call self%append(in_points, 'Points', 'Float64', 3, bytes_of_reals(x), '')
    call self%append(in_cells, 'connectivity', 'Int32', 1, bytes_of_integers(connectivity), '')
    call self%append(in_cells, 'offsets', 'Int32', 1, bytes_of_integers(ends), '')
    call self%append(in_cells, 'types', 'UInt8', 1, low_bytes(kinds), '')
  end subroutine start_vtu

  !> A field on the points.
  subroutine put_point_reals(self, name, values, components)
    class(vtu_file), intent(inout) :: self
    character(*), intent(in) :: name
    real(rk), intent(in) :: values(:, :) !< (components, points)
    character(*), intent(in) :: components !< their names with commas between, '' for none
    call self%append(on_points, name, 'Float64', size(values, 1), bytes_of_reals(values), &
                     components)
  end subroutine put_point_reals

  !> Whole numbers on the points.
  subroutine put_point_integers(self, name, values)
    class(vtu_file), intent(inout) :: self
    character(*), intent(in) :: name
    integer, intent(in) :: values(:)
    call self%append(on_points, name, 'Int32', 1, bytes_of_integers(values), '')
  end subroutine put_point_integers

  !> A number on each cell.
  subroutine put_cell_reals(self, name, values)
    class(vtu_file), intent(inout) :: self
    character(*), intent(in) :: name
    real(rk), intent(in) :: values(:)
    call self%append(on_cells, name, 'Float64', 1, &
                     bytes_of_reals(reshape(values, [1, size(values)])), '')
  end subroutine put_cell_reals

  !> Whole numbers on the cells.
  subroutine put_cell_integers(self, name, values)
    class(vtu_file), intent(inout) :: self
    character(*), intent(in) :: name
    integer, intent(in) :: values(:)
    call self%append(on_cells, name, 'Int32', 1, bytes_of_integers(values), '')
  end subroutine put_cell_integers

  !> The memory of reals.
  pure function bytes_of_reals(values) result(bytes)
    real(rk), intent(in) :: values(:, :)
    character(:), allocatable :: bytes
    allocate (character(storage_size(values)/8*size(values)) :: bytes)
    bytes = transfer(values, bytes)
  end function bytes_of_reals

  !> The memory of integers.
  pure function bytes_of_integers(values) result(bytes)
    integer, intent(in) :: values(:)
    character(:), allocatable :: bytes
    allocate (character(storage_size(1_int32)/8*size(values)) :: bytes)
    bytes = transfer(int(values, int32), bytes)
  end function bytes_of_integers

  !> Small integers, one byte each.
  pure function low_bytes(values) result(bytes)
    integer, intent(in) :: values(:)
    character(size(values)) :: bytes
    integer :: i
    do i = 1, size(values)
      bytes(i:i) = achar(values(i))
    end do
  end function low_bytes

  !> Describes an array and keeps its bytes; the list stays in the order of the sections.
  subroutine append(self, section, name, kind, num_components, bytes, components)
    class(vtu_file), intent(inout) :: self
    integer, intent(in) :: section
    character(*), intent(in) :: name, kind, components
    integer, intent(in) :: num_components
    character(*), intent(in) :: bytes
    type(data_array), allocatable :: more(:)
    integer :: i, place
    place = 1 + count(self%arrays%section <= section)
    allocate (more(size(self%arrays) + 1))
    do i = 1, size(self%arrays)
      call move_array(self%arrays(i), more(merge(i, i + 1, i < place)))
    end do
    more(place)%section = section
    more(place)%attributes = 'type="'//kind//'" Name="'//name//'"'
    if (num_components > 1) then
      more(place)%attributes = more(place)%attributes//' NumberOfComponents="'// &
                               text_of(num_components)//'"'//component_names(components)
    end if
    more(place)%bytes = bytes
    call move_alloc(more, self%arrays)
  end subroutine append

  !> Moves an array without a copy of its bytes.
  subroutine move_array(from, to)
    type(data_array), intent(inout) :: from, to
    to%section = from%section
    call move_alloc(from%attributes, to%attributes)
    call move_alloc(from%bytes, to%bytes)
  end subroutine move_array

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
  subroutine save_vtu(self, path, error)
    class(vtu_file), intent(inout) :: self
    character(*), intent(in) :: path
    type(error_type), allocatable, intent(out) :: error
    type(whole_file) :: file
    integer(int64) :: offset
    integer :: i
    offset = 0
    do i = size(self%arrays), 1, -1
      self%arrays(i)%offset = offset
      offset = offset + storage_size(offset)/8 + len(self%arrays(i)%bytes, int64)
    end do
    call file%open(path)
    call file%put(header_of(self))
    do i = size(self%arrays), 1, -1
      call file%put(transfer(len(self%arrays(i)%bytes, int64), repeat(' ', 8)))
      call file%put(self%arrays(i)%bytes)
    end do
    call file%put(nl//'</AppendedData>'//nl//'</VTKFile>'//nl)
    call file%complete(error)
  end subroutine save_vtu

  !> Everything before the bytes.
  function header_of(self) result(text)
    class(vtu_file), intent(in) :: self
    character(:), allocatable :: text
    integer :: section, i
    character(24) :: offset
    text = '<?xml version="1.0"?>'//nl//'<VTKFile type="UnstructuredGrid" version="1.0"'// &
           ' byte_order="LittleEndian" header_type="UInt64">'//nl//'<UnstructuredGrid>'//nl// &
           '<Piece NumberOfPoints="'//text_of(self%num_points)//'" NumberOfCells="'// &
           text_of(self%num_cells)//'">'//nl
    do section = 1, size(section_names)
      text = text//'<'//trim(section_names(section))//'>'//nl
      do i = 1, size(self%arrays)
        if (self%arrays(i)%section /= section) cycle
        write (offset, '(i0)') self%arrays(i)%offset
        text = text//'<DataArray '//self%arrays(i)%attributes//' format="appended" offset="'// &
               trim(offset)//'"/>'//nl
      end do
      text = text//'</'//trim(section_names(section))//'>'//nl
    end do
    text = text//'</Piece>'//nl//'</UnstructuredGrid>'//nl//'<AppendedData encoding="raw">'//nl//'_'
  end function header_of
end module vtu_files
