!> Divides the nodes among the ranks: a rank has the unknowns of the nodes of its elements. Nodes of
!> joints, ties, springs, added mass and other effects that couple nodes are on all ranks.
module node_parts
  use dam_mesh, only: fe_mesh, node_tie, nodes_of_elements
  use guest_history, only: history
  use guest_list, only: ties_of
  use joint_points, only: dam_joint
  use kinds, only: rk
  use problem_definition, only: problem
  use ranks, only: add_over_ranks, gather_on_first_rank, is_first_rank, num_ranks, &
                   number_of_first_rank, this_rank
  use row_tables, only: group_by_key, row_table
  implicit none
  private
  public :: divide_nodes, find_owners, find_largest, vector_at
  public :: gather_field, list_own_nodes, gather_at_nodes

contains

  !> Marks the nodes of this rank, where vectors are divided.
  subroutine divide_nodes(model)
    type(problem), intent(inout) :: model !< with a rank for each element
    logical, allocatable :: is_common(:)
    integer :: i
    if (num_ranks() == 1) return
    if (needs_whole_vectors(model)) return
    call mark_common(model, is_common)
    associate (mesh => model%mesh)
      mesh%rank_of_law = mesh%rank_of_element
      if (allocated(model%inelastic)) then
        do i = 1, size(model%inelastic)
          mesh%rank_of_law(model%inelastic(i)%elements) = model%inelastic(i)%rank
        end do
      end if
      mesh%is_node_here = is_common .or. &
                          nodes_of_elements(mesh, mesh%rank_of_element == this_rank() &
                                            .or. mesh%rank_of_law == this_rank())
      call move_alloc(is_common, mesh%is_node_common)
    end associate
  end subroutine divide_nodes

  !> Whether the model has effects whose vectors are not divided yet.
  logical function needs_whole_vectors(model) result(needs_whole)
    type(problem), intent(in) :: model
    class(history), allocatable :: own
    integer :: i
    associate (mesh => model%mesh)
      needs_whole = any([(.not. any(mesh%rank_of_element == i .and. mesh%material_of_element > 0), &
                          i=0, num_ranks() - 1)])
    end associate
    do i = 1, size(model%steps)
      associate (plan => model%steps(i))
        needs_whole = needs_whole .or. plan%procedure%scheme == 'REDUCED'
      end associate
    end do
    do i = 1, size(model%guests)
      call model%guests(i)%item%start_history(model%mesh, own)
      needs_whole = needs_whole .or. allocated(own)
    end do
  end function needs_whole_vectors

  !> Marks the nodes that joints, ties, guests and loads couple, and those of elements without
  !> material.
  subroutine mark_common(model, is_common)
    type(problem), intent(in) :: model
    logical, allocatable, intent(out) :: is_common(:) !< (nodes)
    type(node_tie), allocatable :: ties(:)
    type(row_table) :: cells
    integer :: i
    allocate (is_common(model%mesh%num_nodes), source=.false.)
    do i = 1, size(model%joints)
      call mark_joint(model%joints(i), is_common)
    end do
    call ties_of(model%guests, ties)
    do i = 1, size(ties)
      is_common(ties(i)%node) = .true.
      is_common(ties(i)%item) = .true.
    end do
    do i = 1, size(model%guests)
      call model%guests(i)%item%add_cells(cells)
    end do
    do i = 1, size(model%loads)
      call model%loads(i)%item%add_cells(cells)
    end do
    call cells%finish()
    is_common(cells%item) = .true.
    is_common = is_common .or. nodes_of_elements(model%mesh, model%mesh%material_of_element <= 0)
  end subroutine mark_common

  !> Marks the nodes of a joint, in all stages.
  pure subroutine mark_joint(joint, is_marked)
    type(dam_joint), intent(in) :: joint
    logical, intent(inout) :: is_marked(:) !< (nodes)
    integer :: k
    is_marked(joint%node) = .true.
    if (.not. allocated(joint%parts)) return
    if (.not. allocated(joint%parts%rows)) return
    do k = 1, size(joint%parts%rows)
      is_marked(joint%parts%rows(k)%node) = .true.
    end do
  end subroutine mark_joint

  !> The rank that owns each node: the lowest one with an element at it, else the first.
  pure subroutine find_owners(mesh, owner)
    type(fe_mesh), intent(in) :: mesh
    integer, intent(out) :: owner(:) !< (nodes) from 0
    integer :: e, a
    owner = huge(1)
    do e = 1, mesh%num_elements
      if (mesh%material_of_element(e) == 0) cycle
      do a = 1, size(mesh%nodes, 1)
        associate (node => mesh%nodes(a, e))
          if (node > 0) owner(node) = min(owner(node), mesh%rank_of_element(e))
        end associate
      end do
    end do
    where (owner == huge(1)) owner = 0
  end subroutine find_owners

  !> Puts a field together on the first rank, where the ranks have it at their nodes.
  subroutine gather_field(mesh, field)
    type(fe_mesh), intent(in) :: mesh
    real(rk), intent(inout) :: field(:, :) !< (components, nodes)
    type(row_table) :: nodes
    if (.not. allocated(mesh%is_node_here)) return
    call list_own_nodes(mesh, nodes)
    call gather_at_nodes(nodes, field)
  end subroutine gather_field

  !> The nodes that each rank owns.
  subroutine list_own_nodes(mesh, nodes)
    type(fe_mesh), intent(in) :: mesh
    type(row_table), intent(out) :: nodes !< of each rank
    integer :: owner(mesh%num_nodes)
    call find_owners(mesh, owner)
    call group_by_key(owner + 1, num_ranks(), nodes)
  end subroutine list_own_nodes

  !> The same for several fields, with the nodes of `list_own_nodes`.
  subroutine gather_at_nodes(nodes, field)
    type(row_table), intent(in) :: nodes
    real(rk), intent(inout) :: field(:, :) !< (components, nodes)
    real(rk), allocatable :: own(:), all(:)
    associate (list => nodes%row(this_rank() + 1))
      own = reshape(field(:, list), [size(field, 1)*size(list)])
    end associate
    allocate (all(merge(size(field), 0, is_first_rank())))
    call gather_on_first_rank(own, size(field, 1)*(nodes%first - 1), all)
    if (is_first_rank()) field(:, nodes%item) = reshape(all, shape(field))
  end subroutine gather_at_nodes

  !> The node with the largest vector of a field, and this vector, on all ranks.
  subroutine find_largest(field, node, vector)
    real(rk), intent(in) :: field(:, :) !< (3, nodes), on the first rank
    integer, intent(out) :: node
    real(rk), intent(out) :: vector(3)
    node = number_of_first_rank(maxloc(field(1, :)**2 + field(2, :)**2 + field(3, :)**2, dim=1))
    vector = 0.0_rk
    if (is_first_rank()) vector = field(:, node)
    call add_over_ranks(vector)
  end subroutine find_largest

  !> The vector of a field at a node, on all ranks: that of the ranks that have the node.
  function vector_at(mesh, node, field) result(vector)
    type(fe_mesh), intent(in) :: mesh
    integer, intent(in) :: node
    real(rk), intent(in) :: field(:, :) !< (3, nodes), or at the nodes of the rank
    real(rk) :: vector(3), sum_of_ranks(4)
    vector = field(:, node)
    if (.not. allocated(mesh%is_node_here)) return
    sum_of_ranks = 0.0_rk
    if (mesh%is_node_here(node)) sum_of_ranks = [vector, 1.0_rk]
    call add_over_ranks(sum_of_ranks)
    vector = sum_of_ranks(:3)/sum_of_ranks(4)
  end function vector_at
end module node_parts
