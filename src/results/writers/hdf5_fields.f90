!> Fields in job.h5: on nodes, and at the points of joints.
module hdf5_fields
  use kinds, only: rk
  use problem_definition, only: problem
  use analysis_state, only: state
  use field_type, only: result_field, at_joints
  use hdf5_files, only: hdf5_file
  use file_system, only: link_name
  use json_writer, only: lower
  implicit none
  private
  public :: put_field, put_joints

contains

  !> One array, with the names of its components where there are several.
  subroutine put_field(file, path, values, components)
    type(hdf5_file), intent(inout) :: file
    character(*), intent(in) :: path
    real(rk), intent(in) :: values(:, :) !< (components, places)
    character(*), intent(in) :: components !< names, '' for a scalar
    call put_values(file, path, values)
    if (size(values, 1) /= 1) call file%set(path, 'components', components)
  end subroutine put_field

  !> A list for one component, a table for several.
  subroutine put_values(file, path, values)
    type(hdf5_file), intent(inout) :: file
    character(*), intent(in) :: path
    real(rk), intent(in) :: values(:, :) !< (components, places)
    if (size(values, 1) == 1) then
      call file%put(path, values(1, :))
    else
      call file%put(path, values)
    end if
  end subroutine put_values

  !> The fields of joints at all their points.
  subroutine put_joints(file, model, now, table, group)
    type(hdf5_file), intent(inout) :: file
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(result_field), intent(in) :: table(:) !< all fields
    character(*), intent(in) :: group
    real(rk), allocatable :: values(:, :)
    character(:), allocatable :: place
    integer :: j, i
    call file%make_group(group)
    do j = 1, size(model%joints)
      place = group//'/'//link_name(model%joints(j)%name)
      call file%make_group(place)
      do i = 1, size(table)
        if (table(i)%place /= at_joints) cycle
        call table(i)%of_joint(model, now, j, values)
        if (.not. allocated(values)) cycle
        if (table(i)%is_integer) then
          call file%put(place//'/'//lower(table(i)%name), nint(values(1, :)))
        else
          call put_values(file, place//'/'//lower(table(i)%name), values)
        end if
      end do
    end do
  end subroutine put_joints
end module hdf5_fields
