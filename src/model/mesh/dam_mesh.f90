!> Nodes and elements of the whole model, in the order of the deck, with the user's numbers.
!>
!> Everything inside Keyway speaks in positions (1..num_nodes, 1..num_elements); the user's ids
!> appear only in messages and results.
module dam_mesh
  use kinds, only: rk
  implicit none
  private
  public :: mesh

  type :: mesh
    integer :: num_nodes = 0
    integer :: num_elements = 0
    integer, allocatable :: node_id(:) !< user's number of each node
    real(rk), allocatable :: x(:, :) !< coordinates [m]; shape (3, num_nodes)
    integer, allocatable :: element_id(:) !< user's number of each element
    character(8), allocatable :: element_type(:) !< 'C3D8', 'C3D8B', 'C3D8I', 'C3D8R', 'JOINT8', ..
    integer, allocatable :: nodes(:, :) !< node positions; shape (8, num_elements), unused are 0
    integer, allocatable :: material_of_element(:) !< position in the list of materials, 0 for none
    integer, allocatable :: section_of_element(:) !< number of its *SOLID SECTION, 0 for none
  end type mesh
end module dam_mesh
