!> An archive in an HDF5 file.
!>
!> Damaged values are detected: the newest format of HDF5 has checksums of all its structures. Small
!> arrays are stored within these structures, and large arrays have a separate checksum. The file
!> is written as PATH.part and renamed to PATH when it is complete.
module hdf5_archive
  use hdf5, only: hid_t, hsize_t, size_t, h5fcreate_f, h5fopen_f, h5fclose_f, h5f_acc_trunc_f, &
                  h5f_acc_rdonly_f, h5f_libver_latest_f, h5gcreate_f, h5gclose_f, h5screate_f, &
                  h5screate_simple_f, h5sclose_f, h5s_scalar_f, h5s_null_f, h5dcreate_f, &
                  h5dopen_f, h5dwrite_f, h5dread_f, h5dclose_f, h5dget_space_f, h5dget_type_f, &
                  h5sget_simple_extent_type_f, h5sget_simple_extent_ndims_f, &
                  h5sget_simple_extent_dims_f, h5pcreate_f, h5pclose_f, h5pset_layout_f, &
                  h5pset_chunk_f, h5pset_fletcher32_f, h5pset_libver_bounds_f, h5p_file_access_f, &
                  h5p_dataset_create_f, h5d_compact_f, h5tget_class_f, h5tget_size_f, h5tclose_f, &
                  h5t_float_f, h5t_integer_f, h5t_string_f, h5t_native_double, h5t_native_integer
  use kinds, only: rk
  use errors, only: error_type
  use archive_type, only: archive
  use hdf5_files, only: start_hdf5, text_type
  use whole_files, only: move_file, remove_file
  implicit none
  private
  public :: hdf5_store

  integer, parameter :: version = 1 !< of the names and meanings in the file
  character(*), parameter :: version_name = 'keyway_archive'
  integer, parameter :: most_in_header = 4000 !< values that are stored within the structures
  integer, parameter :: most_in_chunk = 2**27 !< values; HDF5 allows 4 GB

  type, extends(archive) :: hdf5_store
    private
    integer(hid_t) :: id = 0 !< 0 while it is not open
    character(:), allocatable :: path
    character(:), allocatable :: group !< the present one, with '/' at its end
    logical :: is_written = .false. !< opened for writing
  contains
    procedure :: create
    procedure :: open => open_store
    procedure :: close => close_store
    procedure :: open_group
    procedure :: close_group
    procedure :: find
    procedure :: write_absent
    procedure :: write_reals
    procedure :: write_integers
    procedure :: write_text
    procedure :: read_reals
    procedure :: read_integers
    procedure :: read_text
    procedure :: place_of
    procedure, private :: start_file, check_write, make_dataset, open_dataset
  end type hdf5_store

contains

  !> Starts a new archive.
  subroutine create(self, path)
    class(hdf5_store), intent(inout) :: self
    character(*), intent(in) :: path
    integer(hid_t) :: access
    integer :: status
    call self%start_file(path, is_written=.true.)
    call h5pcreate_f(h5p_file_access_f, access, status)
    call h5pset_libver_bounds_f(access, h5f_libver_latest_f, h5f_libver_latest_f, status)
    call h5fcreate_f(path//'.part', h5f_acc_trunc_f, self%id, status, access_prp=access)
    call self%check_write(status)
    if (status < 0) self%id = 0
    call h5pclose_f(access, status)
    call self%put(version_name, version)
  end subroutine create

  !> Opens an archive for reading.
  subroutine open_store(self, path)
    class(hdf5_store), intent(inout) :: self
    character(*), intent(in) :: path
    logical :: is_there
    integer :: status
    call self%start_file(path, is_written=.false.)
    inquire (file=path, exist=is_there)
    if (.not. is_there) then
      call self%fail("cannot find '"//path//"'")
      return
    end if
    call h5fopen_f(path, h5f_acc_rdonly_f, self%id, status)
    if (status < 0) then
      self%id = 0
      call self%fail("cannot read '"//path//"': it is no HDF5 file, or it is truncated or damaged")
      return
    end if
    call self%confirm(version_name, version)
  end subroutine open_store

  !> Prepares the archive for writing or reading.
  subroutine start_file(self, path, is_written)
    class(hdf5_store), intent(inout) :: self
    character(*), intent(in) :: path
    logical, intent(in) :: is_written
    integer :: status
    call start_hdf5(status)
    self%id = 0
    self%path = path
    self%group = '/'
    self%is_written = is_written
    if (status < 0) call self%fail('cannot start the HDF5 library')
  end subroutine start_file

  !> Closes the file, also after a failure, and reports the first failure.
  subroutine close_store(self, error)
    class(hdf5_store), intent(inout) :: self
    type(error_type), allocatable, intent(out) :: error
    integer :: status
    logical :: is_moved
    if (self%id /= 0) then
      call h5fclose_f(self%id, status)
      self%id = 0
      if (self%is_written) call self%check_write(status)
    end if
    if (self%is_written .and. .not. self%has_failed()) then
      call move_file(self%path//'.part', self%path, is_moved)
      if (.not. is_moved) call self%check_write(-1)
    end if
    if (self%is_written .and. self%has_failed()) call remove_file(self%path//'.part')
    call self%report(error)
  end subroutine close_store

  !> Enters a group, and makes it while the archive is written.
  subroutine open_group(self, name)
    class(hdf5_store), intent(inout) :: self
    character(*), intent(in) :: name
    integer(hid_t) :: group
    integer :: status
    if (self%has_failed()) return
    if (self%is_written) then
      call h5gcreate_f(self%id, self%group//name, group, status)
      call self%check_write(status)
      if (status >= 0) call h5gclose_f(group, status)
    end if
    self%group = self%group//name//'/'
  end subroutine open_group

  !> Leaves the current group for its parent.
  subroutine close_group(self)
    class(hdf5_store), intent(inout) :: self
    if (self%has_failed()) return
    self%group = self%group(:index(self%group(:len(self%group) - 1), '/', back=.true.))
  end subroutine close_group

  !> Finds a value and its extent.
  subroutine find(self, name, is_present, extent)
    class(hdf5_store), intent(inout) :: self
    character(*), intent(in) :: name
    logical, intent(out) :: is_present
    integer, allocatable, intent(out) :: extent(:)
    integer(hid_t) :: dataset, space
    integer(hsize_t), allocatable :: extents(:), limits(:)
    integer :: status, class_of_space, rank
    is_present = .false.
    allocate (extent(0))
    call self%open_dataset(name, dataset)
    if (self%has_failed()) return
    call h5dget_space_f(dataset, space, status)
    call h5sget_simple_extent_type_f(space, class_of_space, status)
    is_present = class_of_space /= h5s_null_f
    if (is_present) then
      call h5sget_simple_extent_ndims_f(space, rank, status)
      allocate (extents(rank), limits(rank))
      if (rank > 0) call h5sget_simple_extent_dims_f(space, extents, limits, status)
      extent = int(extents)
    end if
    call h5sclose_f(space, status)
    call h5dclose_f(dataset, status)
  end subroutine find

  !> Stores an empty dataset for a component that is not allocated.
  subroutine write_absent(self, name)
    class(hdf5_store), intent(inout) :: self
    character(*), intent(in) :: name
    integer(hid_t) :: dataset, space
    integer :: status
    call h5screate_f(h5s_null_f, space, status)
    call h5dcreate_f(self%id, self%group//name, h5t_native_integer, space, dataset, status)
    call self%check_write(status)
    call h5sclose_f(space, status)
    if (.not. self%has_failed()) call h5dclose_f(dataset, status)
  end subroutine write_absent

  !> Reals, as they are in memory.
  subroutine write_reals(self, name, extent, values)
    class(hdf5_store), intent(inout) :: self
    character(*), intent(in) :: name
    integer, intent(in) :: extent(:)
    real(rk), intent(in) :: values(product(extent))
    integer(hid_t) :: dataset
    integer :: status
    call self%make_dataset(name, h5t_native_double, extent, dataset)
    if (self%has_failed()) return
    status = 0
    if (size(values) > 0) then
      call h5dwrite_f(dataset, h5t_native_double, values, [size(values, kind=hsize_t)], status)
    end if
    call self%check_write(status)
    call h5dclose_f(dataset, status)
    call self%check_write(status)
  end subroutine write_reals

  !> Integers, as they are in memory.
  subroutine write_integers(self, name, extent, values)
    class(hdf5_store), intent(inout) :: self
    character(*), intent(in) :: name
    integer, intent(in) :: extent(:)
    integer, intent(in) :: values(product(extent))
    integer(hid_t) :: dataset
    integer :: status
    call self%make_dataset(name, h5t_native_integer, extent, dataset)
    if (self%has_failed()) return
    status = 0
    if (size(values) > 0) then
      call h5dwrite_f(dataset, h5t_native_integer, values, [size(values, kind=hsize_t)], status)
    end if
    call self%check_write(status)
    call h5dclose_f(dataset, status)
    call self%check_write(status)
  end subroutine write_integers

  !> A text; a null character represents the empty text, which HDF5 does not have.
  subroutine write_text(self, name, text)
    class(hdf5_store), intent(inout) :: self
    character(*), intent(in) :: name, text
    integer(hid_t) :: dataset, kind
    integer :: status
    call text_type(max(1, len(text)), kind)
    call self%make_dataset(name, kind, [integer ::], dataset)
    if (.not. self%has_failed()) then
      call h5dwrite_f(dataset, kind, text//repeat(achar(0), max(0, 1 - len(text))), &
                      [1_hsize_t], status)
      call self%check_write(status)
      call h5dclose_f(dataset, status)
    end if
    call h5tclose_f(kind, status)
  end subroutine write_text

  !> Reals, as they were in memory.
  subroutine read_reals(self, name, num_values, values)
    class(hdf5_store), intent(inout) :: self
    character(*), intent(in) :: name
    integer, intent(in) :: num_values
    real(rk), intent(inout) :: values(num_values)
    integer(hid_t) :: dataset
    integer :: status
    call self%open_dataset(name, dataset, h5t_float_f)
    if (self%has_failed()) return
    status = 0
    if (num_values > 0) then
      call h5dread_f(dataset, h5t_native_double, values, [int(num_values, hsize_t)], status)
    end if
    if (status < 0) call self%fail(damaged(self, name))
    call h5dclose_f(dataset, status)
  end subroutine read_reals

  !> Integers, as they were in memory.
  subroutine read_integers(self, name, num_values, values)
    class(hdf5_store), intent(inout) :: self
    character(*), intent(in) :: name
    integer, intent(in) :: num_values
    integer, intent(inout) :: values(num_values)
    integer(hid_t) :: dataset
    integer :: status
    call self%open_dataset(name, dataset, h5t_integer_f)
    if (self%has_failed()) return
    status = 0
    if (num_values > 0) then
      call h5dread_f(dataset, h5t_native_integer, values, [int(num_values, hsize_t)], status)
    end if
    if (status < 0) call self%fail(damaged(self, name))
    call h5dclose_f(dataset, status)
  end subroutine read_integers

  !> A text, of the length with which it was written.
  subroutine read_text(self, name, text)
    class(hdf5_store), intent(inout) :: self
    character(*), intent(in) :: name
    character(:), allocatable, intent(inout) :: text
    integer(hid_t) :: dataset, kind
    integer(size_t) :: length
    integer :: status
    call self%open_dataset(name, dataset, h5t_string_f)
    if (self%has_failed()) return
    call h5dget_type_f(dataset, kind, status)
    call h5tget_size_f(kind, length, status)
    if (allocated(text)) deallocate (text)
    allocate (character(length) :: text)
    call h5dread_f(dataset, kind, text, [1_hsize_t], status)
    if (status < 0) call self%fail(damaged(self, name))
    if (text == achar(0)) text = ''
    call h5tclose_f(kind, status)
    call h5dclose_f(dataset, status)
  end subroutine read_text

  !> File and name within it, for messages.
  pure function place_of(self, name) result(place)
    class(hdf5_store), intent(in) :: self
    character(*), intent(in) :: name
    character(:), allocatable :: place
    place = "'"//self%path//"': "//self%group//name
  end function place_of

  !> The message about a value whose checksum is wrong.
  pure function damaged(self, name) result(message)
    class(hdf5_store), intent(in) :: self
    character(*), intent(in) :: name
    character(:), allocatable :: message
    message = self%place_of(name)//' cannot be read: the file is damaged'
  end function damaged

  !> Turns a failed call into the failure of the archive.
  subroutine check_write(self, status)
    class(hdf5_store), intent(inout) :: self
    integer, intent(in) :: status
    if (status < 0) call self%fail_to_write(self%path)
  end subroutine check_write

  !> A new dataset with checksums.
  subroutine make_dataset(self, name, kind, extent, dataset)
    class(hdf5_store), intent(inout) :: self
    character(*), intent(in) :: name
    integer(hid_t), intent(in) :: kind
    integer, intent(in) :: extent(:)
    integer(hid_t), intent(out) :: dataset
    integer(hid_t) :: space, plan
    integer(hsize_t) :: chunk(size(extent))
    integer :: status, last
    chunk = int(extent, hsize_t)
    call h5pcreate_f(h5p_dataset_create_f, plan, status)
    if (product(chunk) <= most_in_header) then
      call h5pset_layout_f(plan, h5d_compact_f, status)
    else
      last = size(chunk)
      chunk(last) = min(chunk(last), max(1_hsize_t, most_in_chunk/product(chunk(:last - 1))))
      call h5pset_chunk_f(plan, last, chunk, status)
      call h5pset_fletcher32_f(plan, status)
    end if
    if (size(extent) == 0) then
      call h5screate_f(h5s_scalar_f, space, status)
    else
      call h5screate_simple_f(size(extent), int(extent, hsize_t), space, status)
    end if
    call h5dcreate_f(self%id, self%group//name, kind, space, dataset, status, plan)
    call self%check_write(status)
    call h5sclose_f(space, status)
    call h5pclose_f(plan, status)
  end subroutine make_dataset

  !> Opens a dataset, and compares what it holds with what is expected.
  subroutine open_dataset(self, name, dataset, expected)
    class(hdf5_store), intent(inout) :: self
    character(*), intent(in) :: name
    integer(hid_t), intent(out) :: dataset
    integer, intent(in), optional :: expected !< class of its type
    integer(hid_t) :: kind
    integer :: status, class_of_type
    call h5dopen_f(self%id, self%group//name, dataset, status)
    if (status < 0) then
      call self%fail(self%place_of(name)//' is missing: the file is damaged, or it is no state '// &
                     'of Keyway, or another version has written it')
      return
    end if
    if (.not. present(expected)) return
    call h5dget_type_f(dataset, kind, status)
    call h5tget_class_f(kind, class_of_type, status)
    call h5tclose_f(kind, status)
    if (class_of_type == expected) return
    call h5dclose_f(dataset, status)
    call self%fail(self%place_of(name)//' holds another kind of values: the file is damaged')
  end subroutine open_dataset
end module hdf5_archive
