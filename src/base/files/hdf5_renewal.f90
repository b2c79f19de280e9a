!> Writes arrays and attributes of an HDF5 file again, in their place, where their values have
!> changed. What has not changed is not written, so that the journal of a checkpoint need not keep
!> it.
module hdf5_renewal
  use hdf5, only: h5aclose_f, h5aopen_by_name_f, h5aread_f, h5awrite_f, h5dclose_f, &
                  h5dget_space_f, h5dopen_f, h5dread_f, h5dwrite_f, h5lexists_f, h5sclose_f, &
                  h5sget_simple_extent_npoints_f, h5t_native_integer, hid_t, hsize_t
  use hdf5_files, only: hdf5_file
  implicit none
  private
  public :: has_link, renew_integer, renew_integers

contains

  !> Whether a group has this member; its group must exist.
  logical function has_link(file, path)
    type(hdf5_file), intent(inout) :: file
    character(*), intent(in) :: path
    integer :: status
    has_link = .false.
    if (file%has_failed) return
    call h5lexists_f(file%id, path, has_link, status)
    if (status < 0) file%has_failed = .true.
  end function has_link

  !> A list of integers that is in the file, with the same number of values.
  subroutine renew_integers(file, path, values)
    type(hdf5_file), intent(inout) :: file
    character(*), intent(in) :: path
    integer, intent(in) :: values(:)
    integer(hid_t) :: dataset
    integer :: old(size(values)), status, ignored
    if (file%has_failed) return
    call h5dopen_f(file%id, path, dataset, status)
    file%has_failed = status < 0
    if (file%has_failed) return
    file%has_failed = num_values(dataset) /= size(values)
    if (size(values) > 0 .and. .not. file%has_failed) then
      call h5dread_f(dataset, h5t_native_integer, old, int([size(values)], hsize_t), status)
      if (status >= 0 .and. any(old /= values)) then
        call h5dwrite_f(dataset, h5t_native_integer, values, int([size(values)], hsize_t), status)
      end if
      file%has_failed = status < 0
    end if
    call h5dclose_f(dataset, ignored)
  end subroutine renew_integers

  !> Number of values of an array.
  integer(hsize_t) function num_values(dataset)
    integer(hid_t), intent(in) :: dataset
    integer(hid_t) :: space
    integer :: ignored
    num_values = -1
    call h5dget_space_f(dataset, space, ignored)
    call h5sget_simple_extent_npoints_f(space, num_values, ignored)
    call h5sclose_f(space, ignored)
  end function num_values

  !> An attribute that is in the file.
  subroutine renew_integer(file, path, name, number)
    type(hdf5_file), intent(inout) :: file
    character(*), intent(in) :: path, name
    integer, intent(in) :: number
    integer(hid_t) :: attribute
    integer :: old, status, ignored
    if (file%has_failed) return
    call h5aopen_by_name_f(file%id, path, name, attribute, status)
    file%has_failed = status < 0
    if (file%has_failed) return
    call h5aread_f(attribute, h5t_native_integer, old, [1_hsize_t], status)
    if (status >= 0 .and. old /= number) then
      call h5awrite_f(attribute, h5t_native_integer, number, [1_hsize_t], status)
    end if
    file%has_failed = status < 0
    call h5aclose_f(attribute, ignored)
  end subroutine renew_integer
end module hdf5_renewal
