!> Values at the points of the solids, averaged at the nodes.
!>
!> An elastic element extrapolates the trilinear field through its eight points to the corners. With
!> damage the extrapolation would exceed the values of all points: each corner takes the value of
!> the nearest point. An element of one point is constant. A node takes the mean of the corners of
!> one section there (recovery_plan selects the section).
module node_means
  use kinds, only: rk
  use shape_hex8, only: corners_from_points, corner_of_point
  use recovery_plans, only: fewest_for_threads, max_points, recovery_plan
  implicit none
  private
  public :: average_at_nodes, average_at

  !> The point nearest to each corner: the map of corners to points is its own inverse.
  integer, parameter :: point_of_corner(8) = corner_of_point

contains

  !> Means at all nodes; zero at nodes without a solid.
  subroutine average_at_nodes(plan, at_points, is_bounded, at_nodes)
    type(recovery_plan), intent(in) :: plan
    real(rk), intent(in) :: at_points(:, :, :) !< (components, max_points, solids)
    logical, intent(in) :: is_bounded(:) !< (solids) corners take the value of the nearest point
    real(rk), intent(out) :: at_nodes(:, :) !< (components, nodes)
    integer :: n
    call average_at(plan, at_points, is_bounded, [(n, n=1, size(at_nodes, 2))], at_nodes)
  end subroutine average_at_nodes

  !> Means at some nodes; the values of other nodes remain.
  subroutine average_at(plan, at_points, is_bounded, nodes, at_nodes)
    type(recovery_plan), intent(in) :: plan
    real(rk), intent(in) :: at_points(:, :, :) !< (components, max_points, solids)
    logical, intent(in) :: is_bounded(:) !< (solids) corners take the value of the nearest point
    integer, intent(in) :: nodes(:) !< each once
    real(rk), intent(inout) :: at_nodes(:, :) !< (components, nodes)
    real(rk) :: to_corner(max_points, 8)
    integer :: i
    to_corner = transpose(corners_from_points())
    !$omp parallel do default(none) schedule(static) &
    !$omp shared(plan, at_points, is_bounded, nodes, at_nodes, to_corner) &
    !$omp if (size(nodes) > fewest_for_threads)
    do i = 1, size(nodes)
      call average_one(plan, at_points, is_bounded, to_corner, nodes(i), at_nodes(:, nodes(i)))
    end do
    !$omp end parallel do
  end subroutine average_at

  !> Mean at one node.
  pure subroutine average_one(plan, at_points, is_bounded, to_corner, node, mean)
    type(recovery_plan), intent(in) :: plan
    real(rk), intent(in) :: at_points(:, :, :)
    logical, intent(in) :: is_bounded(:)
    real(rk), intent(in) :: to_corner(max_points, 8)
    integer, intent(in) :: node
    real(rk), intent(out) :: mean(:) !< (components)
    integer :: i, s, a, q
    mean = 0.0_rk
    do i = plan%node_start(node), plan%node_start(node + 1) - 1
      s = (plan%corner(i) - 1)/8 + 1
      a = plan%corner(i) - 8*(s - 1)
      if (plan%num_points(s) < max_points) then
        mean = mean + at_points(:, 1, s)
      else if (is_bounded(s)) then
        mean = mean + at_points(:, point_of_corner(a), s)
      else
        do q = 1, max_points
          mean = mean + to_corner(q, a)*at_points(:, q, s)
        end do
      end if
    end do
    mean = mean/max(1, plan%node_start(node + 1) - plan%node_start(node))
  end subroutine average_one
end module node_means
