!> Writes HDF5 files: groups, arrays, texts, attributes and growing tables.
!>
!> Arrays keep Fortran's order in memory, so that h5py reads (3, nodes) as (nodes, 3). A failure
!> sets `has_failed`, which the caller checks once after a group of calls.
module hdf5_files
  use hdf5, only: h5dont_atexit_f
  use hdf5, only: hid_t, hsize_t, size_t, h5open_f, h5eset_auto_f, h5fcreate_f, h5fclose_f
  use hdf5, only: h5fopen_f, h5f_acc_rdwr_f
  use hdf5, only: h5fflush_f, h5f_acc_trunc_f, h5f_scope_global_f, h5gcreate_f, h5gclose_f
  use hdf5, only: h5screate_simple_f, h5screate_f, h5sclose_f, h5s_scalar_f
  use hdf5, only: h5s_unlimited_f, h5s_select_set_f, h5sselect_hyperslab_f, h5dcreate_f
  use hdf5, only: h5dopen_f, h5dwrite_f, h5dclose_f, h5dget_space_f, h5dset_extent_f
  use hdf5, only: h5pcreate_f, h5pclose_f, h5p_dataset_create_f, h5pset_chunk_f
  use hdf5, only: h5acreate_f, h5awrite_f, h5aclose_f, h5oopen_f, h5oclose_f, h5tcopy_f
  use hdf5, only: h5tset_size_f, h5tset_strpad_f, h5tclose_f, h5t_str_nullpad_f
  use hdf5, only: h5tset_cset_f, h5t_cset_utf8_f
  use hdf5, only: h5t_native_double, h5t_native_integer, h5t_c_s1
  use kinds, only: rk
  use undo_journal, only: mark_flushed, start_journal, undo_access
  use utf8_text, only: is_ascii
  implicit none
  private
  public :: hdf5_file, start_hdf5, text_type

  type :: hdf5_file
    integer(hid_t) :: id = 0 !< 0 while it is not open
    logical :: has_failed = .false.
  contains
    procedure :: create
    procedure :: open_again
    procedure :: start_undo
    procedure :: make_group
    procedure, private :: put_reals_1
    procedure, private :: put_reals_2
    procedure, private :: put_reals_3
    procedure, private :: put_integers_1
    procedure, private :: put_integers_2
    generic :: put => put_reals_1, put_reals_2, put_reals_3, put_integers_1, put_integers_2
    procedure :: put_texts
    procedure, private :: set_text
    procedure, private :: set_real
    procedure, private :: set_integer
    generic :: set => set_text, set_real, set_integer
    procedure :: start_table
    procedure :: extend_table
    procedure :: flush => flush_file
    procedure :: close => close_file
    procedure, private :: note
    procedure, private :: make_dataset
    procedure, private :: close_dataset
  end type hdf5_file

contains

  !> Makes the file, in place of an old one.
  subroutine create(self, path)
    class(hdf5_file), intent(inout) :: self
    character(*), intent(in) :: path
    integer(hid_t) :: access
    integer :: status, ignored
    call start_hdf5(status)
    call self%note(status)
    access = undo_access()
    call h5fcreate_f(path, h5f_acc_trunc_f, self%id, status, access_prp=access)
    call self%note(status)
    call h5pclose_f(access, ignored)
  end subroutine create

  !> Opens a file that exists, to add to it.
  subroutine open_again(self, path)
    class(hdf5_file), intent(inout) :: self
    character(*), intent(in) :: path
    integer(hid_t) :: access
    integer :: status, ignored
    call start_hdf5(status)
    call self%note(status)
    access = undo_access()
    call h5fopen_f(path, h5f_acc_rdwr_f, self%id, status, access_prp=access)
    call self%note(status)
    call h5pclose_f(access, ignored)
  end subroutine open_again

  !> Starts the journal of a checkpoint, which can set the file back to this moment.
  subroutine start_undo(self, journal, number)
    class(hdf5_file), intent(inout) :: self
    character(*), intent(in) :: journal !< path
    integer, intent(in) :: number !< of the checkpoint
    logical :: is_good
    call self%flush()
    if (self%has_failed) return
    call start_journal(self%id, journal, number, is_good)
    self%has_failed = .not. is_good
  end subroutine start_undo

  !> Starts the library, also if it is started already.
  subroutine start_hdf5(status)
    integer, intent(out) :: status !< below 0 for a failure
    integer :: ignored
    ! After a failure the file stays as it was last flushed: the library must not touch it at exit.
    call h5dont_atexit_f(ignored)
    call h5open_f(status)
    call h5eset_auto_f(0, ignored)
  end subroutine start_hdf5

  !> Makes a group; its parents must exist.
  subroutine make_group(self, path)
    class(hdf5_file), intent(inout) :: self
    character(*), intent(in) :: path
    integer(hid_t) :: group
    integer :: status
    if (self%has_failed) return
    call h5gcreate_f(self%id, path, group, status)
    call self%note(status)
    if (status == 0) call h5gclose_f(group, status)
  end subroutine make_group

  !> A list of reals.
  subroutine put_reals_1(self, path, values)
    class(hdf5_file), intent(inout) :: self
    character(*), intent(in) :: path
    real(rk), intent(in) :: values(:)
    integer(hid_t) :: dataset, space
    integer :: status
    call self%make_dataset(path, h5t_native_double, int([size(values)], hsize_t), dataset, space)
    if (self%has_failed) return
    call h5dwrite_f(dataset, h5t_native_double, values, int([size(values)], hsize_t), status)
    call self%note(status)
    call self%close_dataset(dataset, space)
  end subroutine put_reals_1

  !> A table of reals.
  subroutine put_reals_2(self, path, values)
    class(hdf5_file), intent(inout) :: self
    character(*), intent(in) :: path
    real(rk), intent(in) :: values(:, :)
    integer(hid_t) :: dataset, space
    integer :: status
    call self%make_dataset(path, h5t_native_double, int(shape(values), hsize_t), dataset, space)
    if (self%has_failed) return
    call h5dwrite_f(dataset, h5t_native_double, values, int(shape(values), hsize_t), status)
    call self%note(status)
    call self%close_dataset(dataset, space)
  end subroutine put_reals_2

  !> A block of reals.
  subroutine put_reals_3(self, path, values)
    class(hdf5_file), intent(inout) :: self
    character(*), intent(in) :: path
    real(rk), intent(in) :: values(:, :, :)
    integer(hid_t) :: dataset, space
    integer :: status
    call self%make_dataset(path, h5t_native_double, int(shape(values), hsize_t), dataset, space)
    if (self%has_failed) return
    call h5dwrite_f(dataset, h5t_native_double, values, int(shape(values), hsize_t), status)
    call self%note(status)
    call self%close_dataset(dataset, space)
  end subroutine put_reals_3

  !> A list of integers.
  subroutine put_integers_1(self, path, values)
    class(hdf5_file), intent(inout) :: self
    character(*), intent(in) :: path
    integer, intent(in) :: values(:)
    integer(hid_t) :: dataset, space
    integer :: status
    call self%make_dataset(path, h5t_native_integer, int([size(values)], hsize_t), dataset, space)
    if (self%has_failed) return
    call h5dwrite_f(dataset, h5t_native_integer, values, int([size(values)], hsize_t), status)
    call self%note(status)
    call self%close_dataset(dataset, space)
  end subroutine put_integers_1

  !> A table of integers.
  subroutine put_integers_2(self, path, values)
    class(hdf5_file), intent(inout) :: self
    character(*), intent(in) :: path
    integer, intent(in) :: values(:, :)
    integer(hid_t) :: dataset, space
    integer :: status
    call self%make_dataset(path, h5t_native_integer, int(shape(values), hsize_t), dataset, space)
    if (self%has_failed) return
    call h5dwrite_f(dataset, h5t_native_integer, values, int(shape(values), hsize_t), status)
    call self%note(status)
    call self%close_dataset(dataset, space)
  end subroutine put_integers_2

  !> A list of texts of one length, padded with null bytes.
  subroutine put_texts(self, path, texts)
    class(hdf5_file), intent(inout) :: self
    character(*), intent(in) :: path
    character(*), intent(in) :: texts(:)
    character(len(texts)) :: padded(size(texts))
    integer(hid_t) :: dataset, space, kind
    integer :: status, i
    do i = 1, size(texts)
      padded(i) = trim(texts(i))//repeat(achar(0), len(texts) - len_trim(texts(i)))
    end do
    call text_type(len(texts), kind)
    call set_letters(texts, kind)
    call self%make_dataset(path, kind, int([size(texts)], hsize_t), dataset, space)
    if (self%has_failed) return
    call h5dwrite_f(dataset, kind, padded, int([size(texts)], hsize_t), status)
    call self%note(status)
    call self%close_dataset(dataset, space)
    call h5tclose_f(kind, status)
  end subroutine put_texts

  !> A text as an attribute of a group or an array.
  subroutine set_text(self, path, name, text)
    class(hdf5_file), intent(inout) :: self
    character(*), intent(in) :: path, name
    character(*), intent(in) :: text
    integer(hid_t) :: object, space, attribute, kind
    integer :: status
    if (self%has_failed) return
    call text_type(max(1, len(text)), kind)
    call set_letters([text], kind)
    call h5oopen_f(self%id, path, object, status)
    call h5screate_f(h5s_scalar_f, space, status)
    call h5acreate_f(object, name, kind, space, attribute, status)
    call self%note(status)
    call h5awrite_f(attribute, kind, text//repeat(achar(0), max(0, 1 - len(text))), &
                    [1_hsize_t], status)
    call close_attribute(object, space, attribute)
    call h5tclose_f(kind, status)
  end subroutine set_text

  !> A real as an attribute.
  subroutine set_real(self, path, name, number)
    class(hdf5_file), intent(inout) :: self
    character(*), intent(in) :: path, name
    real(rk), intent(in) :: number
    integer(hid_t) :: object, space, attribute
    integer :: status
    if (self%has_failed) return
    call h5oopen_f(self%id, path, object, status)
    call h5screate_f(h5s_scalar_f, space, status)
    call h5acreate_f(object, name, h5t_native_double, space, attribute, status)
    call self%note(status)
    call h5awrite_f(attribute, h5t_native_double, number, [1_hsize_t], status)
    call close_attribute(object, space, attribute)
  end subroutine set_real

  !> An integer as an attribute.
  subroutine set_integer(self, path, name, number)
    class(hdf5_file), intent(inout) :: self
    character(*), intent(in) :: path, name
    integer, intent(in) :: number
    integer(hid_t) :: object, space, attribute
    integer :: status
    if (self%has_failed) return
    call h5oopen_f(self%id, path, object, status)
    call h5screate_f(h5s_scalar_f, space, status)
    call h5acreate_f(object, name, h5t_native_integer, space, attribute, status)
    call self%note(status)
    call h5awrite_f(attribute, h5t_native_integer, number, [1_hsize_t], status)
    call close_attribute(object, space, attribute)
  end subroutine set_integer

  !> An empty table of reals that grows by rows.
  subroutine start_table(self, path, columns)
    class(hdf5_file), intent(inout) :: self
    character(*), intent(in) :: path
    character(*), intent(in) :: columns !< their names, with commas between
    integer, parameter :: rows_in_chunk = 256
    integer(hid_t) :: dataset, space, plan
    integer(hsize_t) :: width
    integer :: status, i
    if (self%has_failed) return
    width = 1 + count([(columns(i:i) == ',', i=1, len(columns))])
    call h5screate_simple_f(2, [width, 0_hsize_t], space, status, [width, h5s_unlimited_f])
    call h5pcreate_f(h5p_dataset_create_f, plan, status)
    call h5pset_chunk_f(plan, 2, [width, int(rows_in_chunk, hsize_t)], status)
    call h5dcreate_f(self%id, path, h5t_native_double, space, dataset, status, plan)
    call self%note(status)
    call h5pclose_f(plan, status)
    if (self%has_failed) return
    call self%close_dataset(dataset, space)
    call self%set(path, 'columns', columns)
  end subroutine start_table

  !> Adds rows to a table.
  subroutine extend_table(self, path, rows, num_before)
    class(hdf5_file), intent(inout) :: self
    character(*), intent(in) :: path
    real(rk), intent(in) :: rows(:, :) !< (columns, rows)
    integer, intent(in) :: num_before !< rows that the table has
    integer(hid_t) :: dataset, all_rows, new_rows
    integer(hsize_t) :: extent(2)
    integer :: status
    if (self%has_failed .or. size(rows, 2) == 0) return
    extent = int(shape(rows), hsize_t)
    call h5dopen_f(self%id, path, dataset, status)
    call self%note(status)
    if (self%has_failed) return
    call h5dset_extent_f(dataset, [extent(1), num_before + extent(2)], status)
    call h5dget_space_f(dataset, all_rows, status)
    call h5sselect_hyperslab_f(all_rows, h5s_select_set_f, [0_hsize_t, int(num_before, hsize_t)], &
                               extent, status)
    call h5screate_simple_f(2, extent, new_rows, status)
    call h5dwrite_f(dataset, h5t_native_double, rows, extent, status, new_rows, all_rows)
    call self%note(status)
    call h5sclose_f(new_rows, status)
    call self%close_dataset(dataset, all_rows)
  end subroutine extend_table

  !> Writes everything to the disk: the file stays readable if the run is killed afterwards, and a
  !> write that fails later (disk full) leaves the file as it is now.
  subroutine flush_file(self)
    class(hdf5_file), intent(inout) :: self
    integer :: status
    logical :: is_good
    if (self%has_failed) return
    call h5fflush_f(self%id, h5f_scope_global_f, status)
    call self%note(status)
    if (self%has_failed) return
    call mark_flushed(self%id, is_good)
    self%has_failed = .not. is_good
  end subroutine flush_file

  !> Closes the file, unless something failed.
  subroutine close_file(self)
    class(hdf5_file), intent(inout) :: self
    integer :: status
    if (self%id == 0 .or. self%has_failed) return
    call h5fclose_f(self%id, status)
    call self%note(status)
    self%id = 0
  end subroutine close_file

  !> Sets `has_failed` after a failure.
  subroutine note(self, status)
    class(hdf5_file), intent(inout) :: self
    integer, intent(in) :: status
    if (status < 0) self%has_failed = .true.
  end subroutine note

  !> A new array.
  subroutine make_dataset(self, path, kind, extent, dataset, space)
    class(hdf5_file), intent(inout) :: self
    character(*), intent(in) :: path
    integer(hid_t), intent(in) :: kind
    integer(hsize_t), intent(in) :: extent(:)
    integer(hid_t), intent(out) :: dataset, space
    integer :: status
    dataset = 0
    space = 0
    if (self%has_failed) return
    call h5screate_simple_f(size(extent), extent, space, status)
    call self%note(status)
    call h5dcreate_f(self%id, path, kind, space, dataset, status)
    call self%note(status)
  end subroutine make_dataset

  !> Ends the work on an array.
  subroutine close_dataset(self, dataset, space)
    class(hdf5_file), intent(inout) :: self
    integer(hid_t), intent(in) :: dataset, space
    integer :: status
    call h5sclose_f(space, status)
    call self%note(status)
    call h5dclose_f(dataset, status)
    call self%note(status)
  end subroutine close_dataset

  !> The type of a text of fixed length.
  subroutine text_type(length, kind)
    integer, intent(in) :: length
    integer(hid_t), intent(out) :: kind
    integer :: status
    call h5tcopy_f(h5t_c_s1, kind, status)
    call h5tset_size_f(kind, int(length, size_t), status)
    call h5tset_strpad_f(kind, h5t_str_nullpad_f, status)
  end subroutine text_type

  !> Says that texts are UTF-8, where they have other letters than those of ASCII.
  subroutine set_letters(texts, kind)
    character(*), intent(in) :: texts(:)
    integer(hid_t), intent(in) :: kind
    integer :: status, i
    if (all([(is_ascii(texts(i)), i=1, size(texts))])) return
    call h5tset_cset_f(kind, h5t_cset_utf8_f, status)
  end subroutine set_letters

  !> Ends the work on an attribute.
  subroutine close_attribute(object, space, attribute)
    integer(hid_t), intent(in) :: object, space, attribute
    integer :: status
    call h5aclose_f(attribute, status)
    call h5sclose_f(space, status)
    call h5oclose_f(object, status)
  end subroutine close_attribute
end module hdf5_files
