!> Nodes and elements of the whole model, in the order of the deck, with the user's numbers; sets
!> and surfaces made of them, and nodes that follow others by ties.
!>
!> Keyway identifies nodes and elements by position (1..num_nodes, 1..num_elements); the user's ids
!> appear only in messages and results.
module dam_mesh
  use kinds, only: rk
  use row_tables, only: weighted_rows
  implicit none
  private
  public :: fe_mesh, named_set, surface, node_tie, element_is_there, are_there, is_assembled_here
  public :: nodes_of_elements

  type :: fe_mesh
    integer :: num_nodes = 0
    integer :: num_elements = 0
    integer, allocatable :: node_id(:) !< user's number of each node
    real(rk), allocatable :: x(:, :) !< coordinates [m]; shape (3, num_nodes)
    integer, allocatable :: element_id(:) !< user's number of each element
    character(8), allocatable :: element_type(:) !< 'C3D8', 'C3D8B', 'C3D8I', 'C3D8R', 'JOINT8', ..
    integer, allocatable :: nodes(:, :) !< node positions; shape (8, num_elements), unused are 0
    integer, allocatable :: material_of_element(:) !< position in the list of materials, 0 for none
    integer, allocatable :: section_of_element(:) !< number of its *SOLID SECTION, 0 for none
    integer :: stage = 0 !< how often *MODEL CHANGE has acted so far
    !> (elements) taken out by *MODEL CHANGE in the present step; such an element has material 0, so
    !> that it takes part in nothing. Not allocated in models without *MODEL CHANGE.
    logical, allocatable :: is_absent(:)
    !> (elements) rank that assembles the element; not allocated: there is one rank
    integer, allocatable :: rank_of_element(:)
    logical, allocatable :: is_node_absent(:) !< (nodes) all elements of the node are absent
    integer, allocatable :: rank_of_law(:) !< (elements) rank that calls its law, where divided
    !> (nodes) this rank has the unknowns of the node; not allocated: all ranks have all unknowns
    logical, allocatable :: is_node_here(:)
    logical, allocatable :: is_node_common(:) !< (nodes) all ranks have the unknowns of the node
  end type fe_mesh

  !> A set of nodes or elements: positions in the mesh, ascending, each once.
  type :: named_set
    character(:), allocatable :: name !< upper case
    integer, allocatable :: members(:) !< ascending positions
    integer, allocatable :: in_order(:) !< as the deck gives them; sets with UNSORTED only
  end type named_set

  !> A surface: faces S1..S6 of solid elements (CalculiX numbering, see mesh_faces).
  type :: surface
    character(:), allocatable :: name !< upper case
    integer, allocatable :: element(:) !< element positions
    integer, allocatable :: face(:) !< 1..6
  end type surface

  !> One *TIE with an exact constraint, or the equations of the deck: row i gives u(node(i)) from
  !> the nodes that node(i) follows, on either face, in the directions that are tied; the weights
  !> add up to 1. A node may have several rows, in different directions, if supports differ by
  !> direction.
  type, extends(weighted_rows) :: node_tie
    character(:), allocatable :: name !< upper case
    integer, allocatable :: node(:) !< (ties) the node that follows
    logical, allocatable :: is_tied(:, :) !< (3, ties) the tied directions
    !> (items) of equations: the displacement of each item; not allocated: the tied direction. The
    !> weights then add up to any number.
    integer, allocatable :: item_direction(:)
  end type node_tie

contains

  !> Whether an element takes part in the present step.
  pure logical function element_is_there(mesh, element) result(is_there)
    type(fe_mesh), intent(in) :: mesh
    integer, intent(in) :: element !< position
    is_there = .true.
    if (allocated(mesh%is_absent)) is_there = .not. mesh%is_absent(element)
  end function element_is_there

  !> Whether an element takes part in the matrices of this rank.
  pure logical function is_assembled_here(mesh, rank, element) result(is_here)
    type(fe_mesh), intent(in) :: mesh
    integer, intent(in) :: rank !< this rank
    integer, intent(in) :: element !< position
    is_here = mesh%material_of_element(element) > 0
    if (is_here .and. allocated(mesh%rank_of_element)) then
      is_here = mesh%rank_of_element(element) == rank
    end if
  end function is_assembled_here

  !> Marks the nodes of marked elements.
  pure function nodes_of_elements(mesh, is_marked) result(is_theirs)
    type(fe_mesh), intent(in) :: mesh
    logical, intent(in) :: is_marked(:) !< (elements)
    logical :: is_theirs(mesh%num_nodes)
    integer :: e
    is_theirs = .false.
    do e = 1, mesh%num_elements
      if (.not. is_marked(e)) cycle
      is_theirs(pack(mesh%nodes(:, e), mesh%nodes(:, e) > 0)) = .true.
    end do
  end function nodes_of_elements

  !> Whether all these nodes take part in the present step.
  pure logical function are_there(mesh, nodes)
    type(fe_mesh), intent(in) :: mesh
    integer, intent(in) :: nodes(:) !< positions
    are_there = .true.
    if (allocated(mesh%is_node_absent)) are_there = .not. any(mesh%is_node_absent(nodes))
  end function are_there
end module dam_mesh
