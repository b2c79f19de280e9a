!> Makes fields at nodes agree with the ties.
module tie_motion
  use dam_mesh, only: node_tie
  use kinds, only: rk
  use errors, only: error_type
  use node_dofs, only: dof_map, displacement_dofs, num_directions
  use dof_numbering, only: linear_links
  use jump_links, only: nodal_points, link_nodes, pairs_of_nodes
  implicit none
  private
  public :: follow_ties, link_ties

contains

  !> Computes the values at tied nodes from the nodes that they follow. Fails if ties depend on each
  !> other in a circle.
  subroutine follow_ties(ties, field, error)
    type(node_tie), intent(in) :: ties(:)
    real(rk), intent(inout) :: field(:, :) !< (3, nodes)
    type(error_type), allocatable, intent(out) :: error
    type(linear_links) :: links
    type(dof_map) :: dofs
    real(rk) :: total
    integer :: k, t
    if (size(ties) == 0) return
    dofs = displacement_dofs(size(field, 2))
    call link_ties(dofs, ties, links, error)
    if (allocated(error)) return
    do k = 1, links%num_links
      total = 0.0_rk
      do t = links%first(k), links%first(k + 1) - 1
        total = total + links%coefficient(t)*value_at(links%term(t))
      end do
      field(dofs%component_of(links%dof(k)), dofs%node(links%dof(k))) = total
    end do
  contains
    pure real(rk) function value_at(dof)
      integer, intent(in) :: dof
      value_at = field(dofs%component_of(dof), dofs%node(dof))
    end function value_at
  end subroutine follow_ties

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
