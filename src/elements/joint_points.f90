!> The points of a joint: where its two faces lie on each other, and how they see the nodes.
!>
!> The relative displacement of point p in local axes is
!>   jump = rotation(:, :, p) * sum_a shape(a, p) * (u(slave(a, p)) - u(master(a, p))).
!> Integrated at the nodes a point is one pair of nodes (one node a side, shape 1); at Gauss points
!> it sees four nodes a side.
module joint_points
  use kinds, only: rk
  use joint_law, only: traction_law
  implicit none
  private
  public :: joint

  type :: joint
    character(:), allocatable :: name !< upper case
    class(traction_law), allocatable :: law
    logical :: is_nodal = .true. !< points are pairs of nodes
    integer :: num_points = 0
    integer, allocatable :: master(:, :), slave(:, :) !< node positions; (nodes a side, points)
    real(rk), allocatable :: shape(:, :) !< (nodes a side, points)
    real(rk), allocatable :: x(:, :) !< (3, points) [m]
    real(rk), allocatable :: rotation(:, :, :) !< (3, 3, points); rows: normal, slip 1, slip 2
    real(rk), allocatable :: area(:) !< tributary area of each point [m2]
  end type joint
end module joint_points
