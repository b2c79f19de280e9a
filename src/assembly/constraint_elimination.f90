!> Dependent dofs of a step: joints and ties in the numbering.
module constraint_elimination
  use errors, only: error_type
  use dam_mesh, only: fe_mesh, node_tie, are_there
  use guest_list, only: ties_of
  use guest_type, only: guest_slot
  use joint_points, only: dam_joint
  use step_plan, only: step_fixity
  use node_dofs, only: dof_map, displacement_dofs, num_directions
  use dof_numbering, only: numbering, linear_links, number_unknowns
  use jump_links, only: nodal_points, link_nodes
  implicit none
  private
  public :: number_step, keep_present

  !> Most nodes of points without jumps that are ordered last: the Schur block is dense, with 0.3 GB
  !> for 6000 unknowns.
  integer, parameter :: most_last_nodes = 2000

contains

  !> Numbers the unknowns of a step from its elements, its joints, its ties and its supports. Where
  !> vectors are divided: those of the nodes of this rank.
  subroutine number_step(mesh, joints, guests, fixities, numbers, error, of_all_ranks)
    type(fe_mesh), intent(in) :: mesh
    type(dam_joint), intent(in) :: joints(:)
    type(guest_slot), intent(in) :: guests(:) !< with the ties
    type(step_fixity), intent(in) :: fixities(:)
    type(numbering), intent(out) :: numbers
    type(error_type), allocatable, intent(out) :: error
    logical, intent(in), optional :: of_all_ranks !< all unknowns, also where vectors are divided
    logical, allocatable :: is_used(:), is_fixed(:, :)
    type(node_tie), allocatable :: ties(:)
    type(nodal_points) :: points
    type(linear_links) :: links
    type(dof_map) :: dofs
    logical :: is_whole
    integer :: e, k
    dofs = displacement_dofs(mesh%num_nodes)
    allocate (is_used(mesh%num_nodes), is_fixed(size(dofs%components), mesh%num_nodes))
    is_used = .false.
    do e = 1, mesh%num_elements
      if (mesh%material_of_element(e) == 0 .and. mesh%element_type(e) /= 'IFACE4') cycle
      do k = 1, size(mesh%nodes, 1)
        if (mesh%nodes(k, e) > 0) is_used(mesh%nodes(k, e)) = .true.
      end do
    end do
    is_fixed = .false.
    do k = 1, size(fixities)
      is_fixed(fixities(k)%dof, fixities(k)%node) = .true.
    end do
    call add_held_bases(mesh, is_fixed, is_used)
    call list_points(joints, points)
    if (size(points%slave) > 0) points%is_light = nodes_of_quads(mesh)
    call ties_of(guests, ties)
    call keep_present(mesh, ties)
    call link_nodes(dofs, points, ties, is_used, is_fixed, links, error)
    if (allocated(error)) return
    call mark_last(joints, links%first_jump, is_used, links%is_last)
    is_whole = .false.
    if (present(of_all_ranks)) is_whole = of_all_ranks
    if (.not. is_whole) call leave_others(mesh, is_used)
    call number_unknowns(dofs, is_used, is_fixed, links, numbers, error)
  end subroutine number_step

  !> Leaves the nodes of other ranks out, where vectors are divided.
  pure subroutine leave_others(mesh, is_used)
    type(fe_mesh), intent(in) :: mesh
    logical, intent(inout) :: is_used(:) !< (nodes)
    if (allocated(mesh%is_node_here)) is_used = is_used .and. mesh%is_node_here
  end subroutine leave_others

  !> Marks nodes of joint elements that supports hold in all directions: a base without solids. It
  !> moves as the supports do, and has their reactions. Nodes whose solids are absent are no base.
  pure subroutine add_held_bases(mesh, is_fixed, is_used)
    type(fe_mesh), intent(in) :: mesh
    logical, intent(in) :: is_fixed(:, :) !< (components, nodes)
    logical, intent(inout) :: is_used(:) !< (nodes)
    integer :: e, k
    do e = 1, mesh%num_elements
      if (mesh%element_type(e) /= 'JOINT8') cycle
      do k = 1, size(mesh%nodes, 1)
        if (mesh%nodes(k, e) == 0) cycle
        if (.not. are_there(mesh, [mesh%nodes(k, e)])) cycle
        if (all(is_fixed(:num_directions, mesh%nodes(k, e)))) is_used(mesh%nodes(k, e)) = .true.
      end do
    end do
  end subroutine add_held_bases

  !> Leaves out the ties of nodes that are absent, or that follow an absent node.
  subroutine keep_present(mesh, ties)
    type(fe_mesh), intent(in) :: mesh
    type(node_tie), intent(inout) :: ties(:)
    logical, allocatable :: is_kept(:)
    integer, allocatable :: rows(:), first(:), items(:)
    integer :: i, k, t
    if (.not. allocated(mesh%is_node_absent)) return
    do i = 1, size(ties)
      associate (tie => ties(i))
        is_kept = [(are_there(mesh, [tie%node(k), tie%item(tie%first(k):tie%first(k + 1) - 1)]), &
                    k=1, size(tie%node))]
        rows = pack([(k, k=1, size(is_kept))], is_kept)
        items = [([(t, t=tie%first(rows(k)), tie%first(rows(k) + 1) - 1)], k=1, size(rows))]
        allocate (first(size(rows) + 1), source=1)
        do k = 1, size(rows)
          first(k + 1) = first(k) + tie%first(rows(k) + 1) - tie%first(rows(k))
        end do
        tie%node = tie%node(rows)
        tie%is_tied = tie%is_tied(:, rows)
        tie%item = tie%item(items)
        tie%weight = tie%weight(items)
        if (allocated(tie%item_direction)) tie%item_direction = tie%item_direction(items)
        call move_alloc(first, tie%first)
      end associate
    end do
  end subroutine keep_present

  !> Nodes of interface quadrilaterals, which are without mass.
  pure function nodes_of_quads(mesh) result(is_there)
    type(fe_mesh), intent(in) :: mesh
    logical :: is_there(mesh%num_nodes)
    integer :: e
    is_there = .false.
    do e = 1, mesh%num_elements
      if (mesh%element_type(e) == 'IFACE4') is_there(mesh%nodes(1:4, e)) = .true.
    end do
  end function nodes_of_quads

  !> Points of the joints with nodal integration, joint by joint.
  subroutine list_points(joints, points)
    type(dam_joint), intent(in) :: joints(:)
    type(nodal_points), intent(out) :: points
    integer :: j, p, n, t, length
    n = sum(joints%num_points, mask=joints%is_nodal)
    allocate (points%slave(n), points%own(n), points%first(n + 1), points%rotation(3, 3, n))
    allocate (points%master(sum([(size(joints(j)%node), j=1, size(joints))])))
    allocate (points%weight(size(points%master)))
    points%first(1) = 1
    n = 0
    do j = 1, size(joints)
      if (.not. joints(j)%is_nodal) cycle
      do p = 1, joints(j)%num_points
        n = n + 1
        t = joints(j)%first(p) + 1
        length = joints(j)%first(p + 1) - t
        points%slave(n) = joints(j)%node(t - 1)
        points%own(n) = joints(j)%weight(t - 1)
        points%rotation(:, :, n) = joints(j)%rotation(:, :, p)
        points%first(n + 1) = points%first(n) + length
        points%master(points%first(n):points%first(n + 1) - 1) = joints(j)%node(t:t + length - 1)
        points%weight(points%first(n):points%first(n + 1) - 1) = &
          -joints(j)%weight(t:t + length - 1)/points%own(n)
      end do
    end do
    points%master = points%master(:points%first(n + 1) - 1)
  end subroutine list_points

  !> Marks the nodes of points without jumps.
  pure subroutine mark_last(joints, first_jump, is_used, is_last)
    type(dam_joint), intent(in) :: joints(:)
    integer, intent(in) :: first_jump(:) !< (points of nodal joints) 0 for none
    logical, intent(in) :: is_used(:) !< (nodes)
    logical, allocatable, intent(out) :: is_last(:) !< (nodes)
    integer :: j, p, n
    allocate (is_last(size(is_used)), source=.false.)
    n = 0
    do j = 1, size(joints)
      do p = 1, joints(j)%num_points
        if (joints(j)%is_nodal) then
          n = n + 1
          if (first_jump(n) > 0) cycle
        end if
        is_last(joints(j)%node(joints(j)%first(p):joints(j)%first(p + 1) - 1)) = .true.
      end do
    end do
    if (count(is_last .and. is_used) > most_last_nodes) is_last = .false.
  end subroutine mark_last
end module constraint_elimination
