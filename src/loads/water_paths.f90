!> The extent of water in a joint: open points that are connected with the upstream edge.
!>
!> Points are connected if they belong to nodes of one slave facet (points at nodes) or have a
!> common slave node (points between nodes).
module water_paths
  use joint_points, only: dam_joint
  use kinds, only: rk
  use row_tables, only: row_table, transpose_rows
  implicit none
  private
  public :: path_net, build_paths, find_wet

  !> Points between nodes do not lie on the edge. A point is an inlet if its distance to the edge is
  !> less than this fraction of the distances of its neighbours, and no neighbour is at half its
  !> distance. Rows of 2 x 2 points have the fractions 0.13 and 0.5, rows of nodes 0 and 0.5.
  real(rk), parameter :: nearest_share = 0.4_rk, much_nearer = 0.5_rk

  type :: path_net
    type(row_table) :: groups !< of points
    logical, allocatable :: is_inlet(:) !< (points) at the upstream edge
  end type path_net

contains

  !> Groups the points of a joint and finds the inlets.
  subroutine build_paths(num_nodes, joint, facets, distance, net)
    integer, intent(in) :: num_nodes !< of the mesh
    type(dam_joint), intent(in) :: joint
    integer, intent(in) :: facets(:, :) !< (4, facets) of the slave face
    real(rk), intent(in) :: distance(:) !< (points) to the upstream edge [m]
    type(path_net), intent(out) :: net
    type(row_table) :: points_of_node
    integer :: f
    call list_points_of_nodes(num_nodes, joint, points_of_node)
    if (joint%is_nodal) then
      do f = 1, size(facets, 2)
        associate (a => points_of_node%row(facets(1, f)), b => points_of_node%row(facets(2, f)), &
                   c => points_of_node%row(facets(3, f)), d => points_of_node%row(facets(4, f)))
          call net%groups%append([a, b, c, d])
        end associate
      end do
      call net%groups%finish()
    else
      net%groups = points_of_node
    end if
    call mark_inlets(distance, net)
  end subroutine build_paths

  !> Points by their slave nodes.
  subroutine list_points_of_nodes(num_nodes, joint, points_of_node)
    integer, intent(in) :: num_nodes
    type(dam_joint), intent(in) :: joint
    type(row_table), intent(out) :: points_of_node
    type(row_table) :: nodes_of_point
    integer :: p
    do p = 1, joint%num_points
      call nodes_of_point%append(joint%node(joint%first(p):joint%first_master(p) - 1))
    end do
    call nodes_of_point%finish()
    call transpose_rows(nodes_of_point, num_nodes, points_of_node)
  end subroutine list_points_of_nodes

  !> Marks the points where water enters.
  subroutine mark_inlets(distance, net)
    real(rk), intent(in) :: distance(:) !< (points) [m]
    type(path_net), intent(inout) :: net
    real(rk), allocatable :: least(:), most(:)
    integer :: g, k
    least = distance
    most = distance
    do g = 1, net%groups%num_rows()
      associate (members => net%groups%row(g))
        do k = 1, size(members)
          least(members(k)) = min(least(members(k)), minval(distance(members)))
          most(members(k)) = max(most(members(k)), maxval(distance(members)))
        end do
      end associate
    end do
    net%is_inlet = distance <= nearest_share*(most - least) .and. least >= much_nearer*distance
  end subroutine mark_inlets

  !> Marks the open points that open points connect with an inlet.
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
      do g = 1, net%groups%num_rows()
        associate (members => net%groups%row(g))
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
