!> The unknowns of a rank in a step whose vectors are divided: which it owns, and which it shares.
module part_borders
  use dam_mesh, only: fe_mesh
  use dof_numbering, only: numbering
  use row_tables, only: group_by_key, row_table
  use sorted_lists, only: sorted_unique
  use unknown_parts, only: runs_of, unknown_part
  implicit none
  private
  public :: find_part

contains

  !> Finds the part of a rank. All ranks have the whole mesh, so that nothing is exchanged.
  subroutine find_part(mesh, numbers, owner, rank, num_parts, part)
    type(fe_mesh), intent(in) :: mesh
    type(numbering), intent(in) :: numbers !< of the unknowns of this rank
    integer, intent(in) :: owner(:) !< (nodes) rank of each node
    integer, intent(in) :: rank !< this one, from 0
    integer, intent(in) :: num_parts !< ranks
    type(unknown_part), intent(out) :: part
    integer :: k
    if (.not. allocated(mesh%is_node_here)) return
    part%is_divided = .true.
    part%run = runs_of(owner(numbers%node) == rank)
    part%common = pack([(k, k=1, numbers%num_total)], mesh%is_node_common(numbers%node))
    call list_borders(mesh, numbers, rank, num_parts, part)
    part%shared = sorted_unique(part%border)
  end subroutine find_part

  !> The unknowns at nodes that elements of another rank have, too, for each such rank.
  subroutine list_borders(mesh, numbers, rank, num_parts, part)
    type(fe_mesh), intent(in) :: mesh
    type(numbering), intent(in) :: numbers
    integer, intent(in) :: rank, num_parts
    type(unknown_part), intent(inout) :: part
    type(row_table) :: nodes
    logical :: is_at_border(mesh%num_nodes)
    integer :: other
    call list_border_nodes(mesh, rank, num_parts, nodes)
    part%neighbour = [integer ::]
    part%border = [integer ::]
    part%first = [1]
    is_at_border = .false.
    do other = 0, num_parts - 1
      associate (list => nodes%item(nodes%first(other + 1):nodes%first(other + 2) - 1))
        if (size(list) == 0) cycle
        is_at_border(list) = .true.
        part%neighbour = [part%neighbour, other]
        part%border = [part%border, places_of(is_at_border(numbers%node))]
        part%first = [part%first, size(part%border) + 1]
        is_at_border(list) = .false.
      end associate
    end do
  end subroutine list_borders

  !> Places of marks.
  pure function places_of(is_marked) result(places)
    logical, intent(in) :: is_marked(:)
    integer, allocatable :: places(:)
    integer :: k
    places = pack([(k, k=1, size(is_marked))], is_marked)
  end function places_of

  !> Nodes of this rank that are not on all ranks, at each element of another rank.
  subroutine list_border_nodes(mesh, rank, num_parts, nodes)
    type(fe_mesh), intent(in) :: mesh
    integer, intent(in) :: rank, num_parts
    type(row_table), intent(out) :: nodes !< of each rank, some more than once
    integer, allocatable :: key(:), node(:)
    integer :: e, pass, n
    do pass = 1, 2
      n = 0
      do e = 1, mesh%num_elements
        call add_nodes(mesh%rank_of_element(e))
        if (mesh%rank_of_law(e) /= mesh%rank_of_element(e)) call add_nodes(mesh%rank_of_law(e))
      end do
      if (pass == 1) allocate (key(n), node(n))
    end do
    call group_by_key(key, num_parts, nodes, node)
  contains
    !> Adds the nodes of the element that another rank has; the first pass only counts.
    subroutine add_nodes(other)
      integer, intent(in) :: other
      integer :: a
      if (other == rank) return
      do a = 1, size(mesh%nodes, 1)
        if (mesh%nodes(a, e) == 0) cycle
        if (.not. mesh%is_node_here(mesh%nodes(a, e))) cycle
        if (mesh%is_node_common(mesh%nodes(a, e))) cycle
        n = n + 1
        if (pass == 1) cycle
        key(n) = other + 1
        node(n) = mesh%nodes(a, e)
      end do
    end subroutine add_nodes
  end subroutine list_border_nodes
end module part_borders
