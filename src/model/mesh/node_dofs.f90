!> Degrees of freedom (dofs) of nodes: their number, meaning and position.
!>
!> Only this module depends on the layout. A vector of dofs lists the nodes in order, and for each
!> node its components in the order of `components`. Displacements come first; a node with another
!> unknown, such as a pressure, has one more component. Fields of vectors at nodes, and the vectors
!> and matrices of displacement elements, list x, y, z of each node.
module node_dofs
  use kinds, only: rk
  implicit none
  private
  public :: dof_map, dof_component, number_dofs, displacement_dofs
  public :: num_directions, displacements, zero_vectors, gather_vectors, add_vectors
  public :: as_dofs, as_field

  integer, parameter :: num_directions = 3 !< displacements of a node: along x, y, z

  !> What one component of a node means.
  type :: dof_component
    character(24) :: name = ''
    character(4) :: unit = ''
  end type dof_component

  type(dof_component), parameter :: displacements(num_directions) = &
                                    [dof_component('displacement along x', 'm'), &
                                     dof_component('displacement along y', 'm'), &
                                     dof_component('displacement along z', 'm')]

  type :: dof_map
    integer :: num_dofs = 0
    type(dof_component), allocatable :: components(:) !< that a node may have, in their order
    integer, allocatable :: first(:) !< (nodes + 1) first dof of each node
    integer, allocatable :: node(:) !< (dofs) the node of each dof
  contains
    procedure :: dof_of, component_of, displacements_of
  end type dof_map

contains

  !> The dofs of nodes that have displacements only.
  pure function displacement_dofs(num_nodes) result(dofs)
    integer, intent(in) :: num_nodes
    type(dof_map) :: dofs
    dofs = number_dofs(displacements, spread(num_directions, 1, num_nodes))
  end function displacement_dofs

  !> The dofs of nodes with different numbers of components.
  pure function number_dofs(components, num_components) result(dofs)
    type(dof_component), intent(in) :: components(:) !< displacements first
    integer, intent(in) :: num_components(:) !< (nodes) number of components of each node
    type(dof_map) :: dofs
    integer :: node
    allocate (dofs%first(size(num_components) + 1))
    dofs%components = components
    dofs%first(1) = 1
    do node = 1, size(num_components)
      dofs%first(node + 1) = dofs%first(node) + num_components(node)
    end do
    dofs%num_dofs = dofs%first(size(num_components) + 1) - 1
    allocate (dofs%node(dofs%num_dofs))
    do node = 1, size(num_components)
      dofs%node(dofs%first(node):dofs%first(node + 1) - 1) = node
    end do
  end function number_dofs

  !> The dof of a component of a node, which must have that component.
  elemental integer function dof_of(self, node, component)
    class(dof_map), intent(in) :: self
    integer, intent(in) :: node, component
    dof_of = self%first(node) + component - 1
  end function dof_of

  !> The component of a dof at its node.
  elemental integer function component_of(self, dof)
    class(dof_map), intent(in) :: self
    integer, intent(in) :: dof
    component_of = dof - self%first(self%node(dof)) + 1
  end function component_of

  !> The displacements of some nodes, node by node, as in the matrices of elements.
  pure function displacements_of(self, nodes) result(dof)
    class(dof_map), intent(in) :: self
    integer, intent(in) :: nodes(:)
    integer :: dof(num_directions*size(nodes))
    integer :: a, i
    do a = 1, size(nodes)
      do i = 1, num_directions
        dof(num_directions*(a - 1) + i) = self%first(nodes(a)) + i - 1
      end do
    end do
  end function displacements_of

  !> A field of vectors at nodes, all zero.
  pure function zero_vectors(num_nodes) result(field)
    integer, intent(in) :: num_nodes
    real(rk), allocatable :: field(:, :) !< (directions, nodes)
    allocate (field(num_directions, num_nodes), source=0.0_rk)
  end function zero_vectors

  !> A field of vectors at all nodes as a vector of their displacement dofs.
  pure function as_dofs(field) result(q)
    real(rk), intent(in) :: field(:, :) !< (directions, nodes)
    real(rk) :: q(size(field))
    q = reshape(field, shape(q))
  end function as_dofs

  !> A vector of the displacement dofs of all nodes as a field.
  pure function as_field(q) result(field)
    real(rk), intent(in) :: q(:) !< (directions times nodes)
    real(rk) :: field(num_directions, size(q)/num_directions)
    field = reshape(q, shape(field))
  end function as_field

  !> The vectors at some nodes, one after the other, as in the vectors of elements.
  pure function gather_vectors(field, nodes) result(values)
    real(rk), intent(in) :: field(:, :) !< (directions, nodes)
    integer, intent(in) :: nodes(:)
    real(rk) :: values(num_directions*size(nodes))
    integer :: a
    do a = 1, size(nodes)
      values(num_directions*(a - 1) + 1:num_directions*a) = field(:, nodes(a))
    end do
  end function gather_vectors

  !> Adds vectors of an element, one after the other, to those at its nodes.
  pure subroutine add_vectors(values, nodes, field)
    real(rk), intent(in) :: values(:) !< (directions*nodes of the element)
    integer, intent(in) :: nodes(:) !< of the element; nodes may repeat
    real(rk), intent(inout) :: field(:, :) !< (directions, nodes)
    integer :: a
    do a = 1, size(nodes)
      field(:, nodes(a)) = field(:, nodes(a)) &
                           + values(num_directions*(a - 1) + 1:num_directions*a)
    end do
  end subroutine add_vectors
end module node_dofs
