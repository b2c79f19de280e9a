!> Values of all kinds through an archive and back, and archives that cannot be read.
program test_hdf5_archive
  use, intrinsic :: iso_fortran_env, only: int8
  use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_positive_inf
  use kinds, only: rk, long
  use errors, only: error_type
  use archive_type, only: archive
  use hdf5_archive, only: hdf5_store
  use same_values, only: compare
  use testing, only: test_log, check, check_text
  implicit none

  !> One component of each kind and rank.
  type :: sample
    real(rk) :: number = 0.0_rk
    integer :: count = 0
    logical :: flag = .false.
    character(:), allocatable :: text, blank
    real(rk), allocatable :: list(:), none(:), long_list(:)
    real(rk), allocatable :: table(:, :), absent(:, :)
    real(rk), allocatable :: block(:, :, :)
    integer, allocatable :: counts(:), grid(:, :), cube(:, :, :)
    logical, allocatable :: flags(:)
  end type sample

  character(*), parameter :: path = 'test_hdf5_archive.h5'
  type(test_log) :: log

  log%suite = 'hdf5_archive'
  call values_come_back(log)
  call old_file_stays_until_close(log)
  call other_extents_fail(log)
  call other_files_fail(log)
  call truncated_file_fails(log)
  call damaged_file_fails(log)
  call write_bytes([integer(int8) ::])
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> Reals that decimal texts lose: not a number with a payload, minus zero, a subnormal number.
  subroutine make_sample(x)
    type(sample), intent(out) :: x
    integer :: i
    x%list = [transfer(int(z'7ff8000000abcdef', long), 1.0_rk), -0.0_rk, &
              transfer(1_long, 1.0_rk), ieee_value(1.0_rk, ieee_positive_inf), &
              -huge(1.0_rk), 1.0_rk/3.0_rk]
    x%number = x%list(2)
    x%count = -huge(1)
    x%flag = .true.
    x%text = ' two words  '
    x%blank = ''
    x%long_list = [(sqrt(real(i, rk)), i=1, 4026)]
    allocate (x%none(0))
    x%table = reshape(x%list, [2, 3])
    x%block = reshape(x%long_list, [3, 11, 122])
    x%counts = [3, 1, 2]
    x%grid = reshape([1, 2, 3, 4, 5, 6], [3, 2])
    x%cube = reshape([1, 2, 3, 4, 5, 6, 7, 8], [2, 2, 2])
    x%flags = [.true., .false., .false., .true.]
  end subroutine make_sample

  !> Writes all components, some of them in groups.
  subroutine save_sample(x, file)
    type(sample), intent(in) :: x
    class(archive), intent(inout) :: file
    call file%put('number', x%number)
    call file%put('count', x%count)
    call file%put('flag', x%flag)
    call file%put('text', x%text)
    call file%put('blank', x%blank)
    call file%open_group('lists')
    call file%put('list', x%list)
    call file%put('none', x%none)
    call file%put('long_list', x%long_list)
    call file%open_group('of integers')
    call file%put('counts', x%counts)
    call file%close_group()
    call file%put('flags', x%flags)
    call file%close_group()
    call file%put('table', x%table)
    call file%put('absent', x%absent)
    call file%put('block', x%block)
    call file%put('grid', x%grid)
    call file%put('cube', x%cube)
  end subroutine save_sample

  !> Reads all components.
  subroutine load_sample(x, file)
    type(sample), intent(inout) :: x
    class(archive), intent(inout) :: file
    call file%get('number', x%number)
    call file%get('count', x%count)
    call file%get('flag', x%flag)
    call file%get('text', x%text)
    call file%get('blank', x%blank)
    call file%open_group('lists')
    call file%get('list', x%list)
    call file%get('none', x%none)
    call file%get('long_list', x%long_list)
    call file%open_group('of integers')
    call file%get('counts', x%counts)
    call file%close_group()
    call file%get('flags', x%flags)
    call file%close_group()
    call file%get('table', x%table)
    call file%get('absent', x%absent)
    call file%get('block', x%block)
    call file%get('grid', x%grid)
    call file%get('cube', x%cube)
  end subroutine load_sample

  !> Writes the sample into the file of the test.
  subroutine write_sample(x, log)
    type(sample), intent(in) :: x
    type(test_log), intent(inout) :: log
    type(hdf5_store) :: file
    type(error_type), allocatable :: error
    call file%create(path)
    call save_sample(x, file)
    call file%close(error)
    call check(log,.not. allocated(error), 'the sample is written')
  end subroutine write_sample

  !> Reads a sample from the file of the test.
  subroutine read_sample(x, error)
    type(sample), intent(inout) :: x
    type(error_type), allocatable, intent(out) :: error
    type(hdf5_store) :: file
    call file%open(path)
    call load_sample(x, file)
    call file%close(error)
  end subroutine read_sample

  !> Whether two samples agree bit by bit; each difference is a failure.
  subroutine compare_samples(log, a, b)
    type(test_log), intent(inout) :: log
    type(sample), intent(in) :: a, b
    call compare(log, 'a real', a%number, b%number)
    call compare(log, 'an integer', a%count, b%count)
    call compare(log, 'a logical', a%flag, b%flag)
    call check(log, len(b%text) == len(a%text), 'blanks at the end of a text stay')
    call check_text(log, b%text, a%text, 'a text')
    call check(log, len(b%blank) == 0, 'an empty text')
    call compare(log, 'reals that are odd', a%list, b%list)
    call compare(log, 'a list of size 0', a%none, b%none)
    call compare(log, 'a long list', a%long_list, b%long_list)
    call compare(log, 'a table', a%table, b%table)
    call compare(log, 'what is not allocated', a%absent, b%absent)
    call compare(log, 'a block', a%block, b%block)
    call compare(log, 'a list of integers', a%counts, b%counts)
    call check(log, all(a%grid == b%grid), 'a table of integers')
    call check(log, all(a%cube == b%cube), 'a block of integers')
    call compare(log, 'a list of logicals', a%flags, b%flags)
  end subroutine compare_samples

  !> All values come back, also where the component was allocated and is absent in the file.
  subroutine values_come_back(log)
    type(test_log), intent(inout) :: log
    type(sample) :: a, b
    type(error_type), allocatable :: error
    call make_sample(a)
    call write_sample(a, log)
    allocate (b%absent(1, 1), b%list(6))
    call read_sample(b, error)
    call check(log,.not. allocated(error), 'the sample is read')
    if (.not. allocated(error)) call compare_samples(log, a, b)
  end subroutine values_come_back

  !> An archive that is not complete does not replace the one before.
  subroutine old_file_stays_until_close(log)
    type(test_log), intent(inout) :: log
    type(hdf5_store) :: file
    type(sample) :: a, b
    type(error_type), allocatable :: error
    call make_sample(a)
    call write_sample(a, log)
    call file%create(path)
    call file%put('count', 1)
    call read_sample(b, error)
    call check(log,.not. allocated(error), 'the old file is there while the new one grows')
    call file%fail('the writer has found an error')
    call file%close(error)
    call check(log, allocated(error), 'close reports the failure of the writer')
    call read_sample(b, error)
    call check(log,.not. allocated(error), 'the old file is there after a failure')
  end subroutine old_file_stays_until_close

  !> An array that is allocated fixes the extent.
  subroutine other_extents_fail(log)
    type(test_log), intent(inout) :: log
    type(sample) :: a, b
    type(error_type), allocatable :: error
    call make_sample(a)
    call write_sample(a, log)
    allocate (b%table(3, 4))
    call read_sample(b, error)
    call check_error(log, error, "'test_hdf5_archive.h5': /table is an array of 2 x 3, but of "// &
                     '3 x 4 in this model: the archive belongs to another model', 'another extent')
  end subroutine other_extents_fail

  !> No file, no HDF5 file, an HDF5 file without the names, a folder that is not there.
  subroutine other_files_fail(log)
    type(test_log), intent(inout) :: log
    type(sample) :: x
    type(hdf5_store) :: file
    type(error_type), allocatable :: error
    call write_bytes([integer(int8) ::])
    call read_sample(x, error)
    call check_error(log, error, "cannot find 'test_hdf5_archive.h5'", 'no file')
    call write_bytes([35_int8, 13_int8, 10_int8])
    call read_sample(x, error)
    call check_error(log, error, "cannot read 'test_hdf5_archive.h5': it is no HDF5 file, or "// &
                     'it is truncated or damaged', 'another format')
    call file%create(path)
    call file%put('number', 1)
    call file%close(error)
    call read_sample(x, error)
    call check_error(log, error, "'test_hdf5_archive.h5': /number holds another kind of "// &
                     'values: the file is damaged', 'an integer for a real')
    call file%create(path)
    call file%put('number', 1.0_rk)
    call file%close(error)
    call read_sample(x, error)
    call check_error(log, error, "'test_hdf5_archive.h5': /count is missing: the file is "// &
                     'damaged, or it is no state of Keyway, or another version has written it', &
                     'a value that is missing')
    call file%create('no/such/folder/archive.h5')
    call file%put('number', 1.0_rk)
    call file%close(error)
    call check_error(log, error, "cannot write 'no/such/folder/archive.h5' (disk full?)", &
                     'a folder that is missing')
  end subroutine other_files_fail

  !> A file that lacks its end.
  subroutine truncated_file_fails(log)
    type(test_log), intent(inout) :: log
    type(sample) :: a, b
    type(error_type), allocatable :: error
    integer(int8), allocatable :: bytes(:)
    integer :: k, num_kept
    logical :: is_found
    call make_sample(a)
    call write_sample(a, log)
    call read_bytes(bytes)
    is_found = .true.
    do k = 1, 20
      num_kept = (k*(size(bytes) - 1))/20
      call write_bytes(bytes(:num_kept))
      call read_sample(b, error)
      is_found = is_found .and. allocated(error)
    end do
    call check(log, is_found, 'a truncated file is an error, wherever it ends')
  end subroutine truncated_file_fails

  !> One byte is another: an error, or a byte that belongs to no value.
  subroutine damaged_file_fails(log)
    type(test_log), intent(inout) :: log
    type(sample) :: a, b
    type(test_log) :: differences
    type(error_type), allocatable :: error
    integer(int8), allocatable :: bytes(:), broken(:)
    integer :: k, num_errors
    call make_sample(a)
    call write_sample(a, log)
    call read_bytes(bytes)
    differences%suite = 'hdf5_archive, one byte is another'
    num_errors = 0
    do k = 1, size(bytes), 211
      broken = bytes
      broken(k) = not(broken(k))
      call write_bytes(broken)
      call read_sample(b, error)
      if (allocated(error)) num_errors = num_errors + 1
      if (.not. allocated(error)) call compare_samples(differences, a, b)
    end do
    call check(log, differences%failed == 0, 'no damaged value is taken for a good one')
    call check(log, num_errors > (9*size(bytes))/(10*211), 'most damages are errors')
  end subroutine damaged_file_fails

  !> An error with this message.
  subroutine check_error(log, error, message, what)
    type(test_log), intent(inout) :: log
    type(error_type), allocatable, intent(in) :: error
    character(*), intent(in) :: message, what
    call check(log, allocated(error), what//' is an error')
    if (allocated(error)) call check_text(log, error%message, message, what)
  end subroutine check_error

  !> The bytes of the file of the test.
  subroutine read_bytes(bytes)
    integer(int8), allocatable, intent(out) :: bytes(:)
    integer :: unit, num_bytes
    open (newunit=unit, file=path, access='stream', form='unformatted', status='old', &
          action='read')
    inquire (unit, size=num_bytes)
    allocate (bytes(num_bytes))
    read (unit) bytes
    close (unit)
  end subroutine read_bytes

  !> A file of these bytes; none, no file.
  subroutine write_bytes(bytes)
    integer(int8), intent(in) :: bytes(:)
    integer :: unit
    open (newunit=unit, file=path, access='stream', form='unformatted', status='replace')
    write (unit) bytes
    if (size(bytes) == 0) close (unit, status='delete')
    if (size(bytes) > 0) close (unit)
  end subroutine write_bytes
end program test_hdf5_archive
