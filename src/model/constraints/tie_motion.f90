!> Makes fields at nodes agree with the ties.
module tie_motion
  use dam_mesh, only: node_tie
  use kinds, only: rk
  use errors, only: error_type
  use node_dofs, only: as_dofs, as_field, dof_map, displacement_dofs, num_directions
  use dof_numbering, only: linear_links
  use jump_links, only: nodal_points, link_nodes, pairs_of_nodes
  implicit none
  private
  public :: follow_ties, follow_links, link_ties

contains

  !> Computes the values at tied nodes from the nodes that they follow. Fails if ties depend on each
  !> other in a circle.
  subroutine follow_ties(ties, field, error)
    type(node_tie), intent(in) :: ties(:)
    real(rk), intent(inout) :: field(:, :) !< (3, nodes)
    type(error_type), allocatable, intent(out) :: error
    type(linear_links) :: links
    real(rk), allocatable :: q(:)
    if (size(ties) == 0) return
    call link_ties(displacement_dofs(size(field, 2)), ties, links, error)
    if (allocated(error)) return
    q = as_dofs(field)
    call follow_links(links, spread(.true., 1, links%num_links), q)
    field = as_field(q)
  end subroutine follow_ties

  !> Computes dependent dofs from those on which they depend.
  pure subroutine follow_links(links, is_meant, q)
    type(linear_links), intent(in) :: links !< each after those on which it depends
    logical, intent(in) :: is_meant(:) !< (links)
    real(rk), intent(inout) :: q(:) !< (dofs)
    integer :: k
    do k = 1, links%num_links
      if (.not. is_meant(k)) cycle
      associate (first => links%first(k), last => links%first(k + 1) - 1)
        q(links%dof(k)) = sum(links%coefficient(first:last)*q(links%term(first:last)))
      end associate
    end do
  end subroutine follow_links

  !> The dependent dofs of ties, each after those on which it depends.
  subroutine link_ties(dofs, ties, links, error)
    type(dof_map), intent(in) :: dofs !< displacements
    type(node_tie), intent(in) :: ties(:)
    type(linear_links), intent(out) :: links
    type(error_type), allocatable, intent(out) :: error
    type(nodal_points) :: none
    logical, allocatable :: is_used(:), is_fixed(:, :)
    real(rk) :: rotation(3, 3, 0)
    associate (num_nodes => size(dofs%first) - 1)
      allocate (is_used(num_nodes), source=.true.)
      allocate (is_fixed(num_directions, num_nodes), source=.false.)
    end associate
    call pairs_of_nodes([integer ::], [integer ::], rotation, none)
    call link_nodes(dofs, none, ties, is_used, is_fixed, links, error)
  end subroutine link_ties
end module tie_motion
