!> The order of the nodes for an incomplete factor, whatever the numbers of the nodes in the deck.
!>
!> An incomplete factor leaves out what would fill it. It leaves out least where neighbours follow
!> each other in layers, as in the order of E. Cuthill and J. McKee (Proceedings of the 24th ACM
!> National Conference, 1969), here reversed and without sorting by numbers of neighbours.
module node_sequence
  use dam_mesh, only: fe_mesh
  use row_tables, only: group_by_key, row_table
  implicit none
  private
  public :: order_nodes

contains

  !> Lists the nodes in layers of neighbours, from one end of each connected part to the other.
  subroutine order_nodes(mesh, sequence)
    type(fe_mesh), intent(in) :: mesh
    integer, intent(out) :: sequence(:) !< (nodes)
    type(row_table) :: elements !< at each node, counted in steps of the nodes of an element
    logical :: is_listed(mesh%num_nodes)
    integer :: start, other_end, first, last
    call group_by_key(reshape(mesh%nodes, [size(mesh%nodes)]), mesh%num_nodes, elements)
    is_listed = .false.
    last = 0
    do start = 1, mesh%num_nodes
      if (is_listed(start)) cycle
      first = last + 1
      call list_layers(mesh, elements, start, sequence, last, is_listed)
      is_listed(sequence(first:last)) = .false.
      other_end = sequence(last)
      last = first - 1
      call list_layers(mesh, elements, other_end, sequence, last, is_listed)
    end do
    sequence = sequence(mesh%num_nodes:1:-1)
  end subroutine order_nodes

  !> Appends the nodes of a connected part, layer by layer from its node `start`.
  subroutine list_layers(mesh, elements, start, sequence, last, is_listed)
    type(fe_mesh), intent(in) :: mesh
    type(row_table), intent(in) :: elements
    integer, intent(in) :: start
    integer, intent(inout) :: sequence(:)
    integer, intent(inout) :: last !< nodes listed so far
    logical, intent(inout) :: is_listed(:)
    integer :: now, k, a, e
    now = last + 1
    last = now
    sequence(last) = start
    is_listed(start) = .true.
    do while (now <= last)
      do k = elements%first(sequence(now)), elements%first(sequence(now) + 1) - 1
        e = (elements%item(k) - 1)/size(mesh%nodes, 1) + 1
        do a = 1, size(mesh%nodes, 1)
          associate (node => mesh%nodes(a, e))
            if (node == 0) cycle
            if (is_listed(node)) cycle
            last = last + 1
            sequence(last) = node
            is_listed(node) = .true.
          end associate
        end do
      end do
      now = now + 1
    end do
  end subroutine list_layers
end module node_sequence
