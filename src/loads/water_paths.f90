!> How far water gets into a joint: along open points that hang together with its upstream edge.
!>
!> Points hang together through facets: those at the nodes of one slave facet (points at nodes), or
!> those that see a common slave node (points between nodes).
module water_paths
  use joint_points, only: joint
  use kinds, only: rk
  implicit none
  private
  public :: path_net, build_paths, find_wet

  !> Points between nodes lie beside the edge, not on it: those count as inlets that are nearer to
  !> it than this part of the distances that their neighbours have, and none of these is twice as
  !> near. Rows of 2 x 2 points have 0.13 and 0.5, rows of nodes 0 and 0.5.
  real(rk), parameter :: nearest_share = 0.4_rk, much_nearer = 0.5_rk

  type :: path_net
    integer, allocatable :: first(:) !< (groups + 1)
    integer, allocatable :: point(:) !< points of each group
    logical, allocatable :: is_inlet(:) !< (points) at the upstream edge
  end type path_net

contains

  !> Groups the points of a joint and finds the inlets.
  subroutine build_paths(num_nodes, seam, facets, distance, net)
    integer, intent(in) :: num_nodes !< of the mesh
    type(joint), intent(in) :: seam
    integer, intent(in) :: facets(:, :) !< (4, facets) of the slave face
    real(rk), intent(in) :: distance(:) !< (points) to the upstream edge [m]
    type(path_net), intent(out) :: net
    integer, allocatable :: first(:), point(:)
    call list_points_of_nodes(num_nodes, seam, first, point)
    if (seam%is_nodal) then
      call group_by_facets(facets, first, point, net)
    else
      net%first = first
      net%point = point
    end if
    call mark_inlets(distance, net)
  end subroutine build_paths

  !> Points by the slave nodes that they see.
  subroutine list_points_of_nodes(num_nodes, seam, first, point)
    integer, intent(in) :: num_nodes
    type(joint), intent(in) :: seam
    integer, allocatable, intent(out) :: first(:) !< (nodes + 1)
    integer, allocatable, intent(out) :: point(:)
    integer, allocatable :: next(:)
    integer :: p, k, node
    allocate (first(num_nodes + 1), source=0)
    do p = 1, seam%num_points
      do k = seam%first(p), seam%first_master(p) - 1
        first(seam%node(k) + 1) = first(seam%node(k) + 1) + 1
      end do
    end do
    first(1) = 1
    do node = 1, num_nodes
      first(node + 1) = first(node) + first(node + 1)
    end do
    allocate (next, source=first)
    allocate (point(first(num_nodes + 1) - 1))
    do p = 1, seam%num_points
      do k = seam%first(p), seam%first_master(p) - 1
        point(next(seam%node(k))) = p
        next(seam%node(k)) = next(seam%node(k)) + 1
      end do
    end do
  end subroutine list_points_of_nodes

  !> One group for each facet: the points at its nodes.
  subroutine group_by_facets(facets, first, point, net)
    integer, intent(in) :: facets(:, :) !< (4, facets)
    integer, intent(in) :: first(:), point(:) !< points of each node
    type(path_net), intent(inout) :: net
    integer :: f, a, n, last
    allocate (net%first(size(facets, 2) + 1))
    net%first(1) = 1
    do f = 1, size(facets, 2)
      n = sum(first(facets(:, f) + 1) - first(facets(:, f)))
      net%first(f + 1) = net%first(f) + n
    end do
    allocate (net%point(net%first(size(net%first)) - 1))
    last = 0
    do f = 1, size(facets, 2)
      do a = 1, 4
        associate (node => facets(a, f))
          n = first(node + 1) - first(node)
          net%point(last + 1:last + n) = point(first(node):first(node + 1) - 1)
        end associate
        last = last + n
      end do
    end do
  end subroutine group_by_facets

  !> The points where water comes in.
  subroutine mark_inlets(distance, net)
    real(rk), intent(in) :: distance(:) !< (points) [m]
    type(path_net), intent(inout) :: net
    real(rk), allocatable :: least(:), most(:)
    integer :: g, k
    least = distance
    most = distance
    do g = 1, size(net%first) - 1
      associate (members => net%point(net%first(g):net%first(g + 1) - 1))
        do k = 1, size(members)
          least(members(k)) = min(least(members(k)), minval(distance(members)))
          most(members(k)) = max(most(members(k)), maxval(distance(members)))
        end do
      end associate
    end do
    net%is_inlet = distance <= nearest_share*(most - least) .and. least >= much_nearer*distance
  end subroutine mark_inlets

  !> Marks the open points that water reaches through open points.
  pure subroutine find_wet(net, is_open, is_wet)
    type(path_net), intent(in) :: net
    logical, intent(in) :: is_open(:) !< (points)
    logical, intent(out) :: is_wet(:) !< (points)
    logical :: is_spreading
    integer :: g, k
    is_wet = is_open .and. net%is_inlet
    is_spreading = any(is_wet)
    do while (is_spreading)
      is_spreading = .false.
      do g = 1, size(net%first) - 1
        associate (members => net%point(net%first(g):net%first(g + 1) - 1))
          if (.not. any(is_wet(members))) cycle
          do k = 1, size(members)
            if (is_wet(members(k)) .or. .not. is_open(members(k))) cycle
            is_wet(members(k)) = .true.
            is_spreading = .true.
          end do
        end associate
      end do
    end do
  end subroutine find_wet
end module water_paths
