!> Rows of the jumps at points of joints; a point has an opening and two slips.
!>
!> Only this module knows the layout: vectors over all points list the rows of a point together.
module joint_rows
  implicit none
  private
  public :: num_axes, jump_names, num_rows, row_of, point_of, axis_of

  integer, parameter :: num_axes = 3 !< of a point: normal, slip 1, slip 2
  character(13), parameter :: jump_names(num_axes) = ['joint opening', 'joint slip 1 ', &
                                                      'joint slip 2 ']

contains

  !> Number of rows of some points.
  pure integer function num_rows(num_points)
    integer, intent(in) :: num_points
    num_rows = num_axes*num_points
  end function num_rows

  !> The row of an axis of a point.
  elemental integer function row_of(point, axis)
    integer, intent(in) :: point, axis
    row_of = num_axes*(point - 1) + axis
  end function row_of

  !> The point of a row.
  elemental integer function point_of(row)
    integer, intent(in) :: row
    point_of = (row - 1)/num_axes + 1
  end function point_of

  !> The axis of a row.
  elemental integer function axis_of(row)
    integer, intent(in) :: row
    axis_of = 1 + mod(row - 1, num_axes)
  end function axis_of
end module joint_rows
