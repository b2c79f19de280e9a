!> The start of a step in a model that is built in stages (theory.md, 15): elements that come and
!> go, and joints that are grouted (stage_joints).
!>
!> The mesh says which elements there are; state%origin the displacements at which an element has no
!> stress.
module stage_entry
  use dam_mesh, only: element_is_there, nodes_of_elements
  use errors, only: error_type
  use joint_parts, only: show_parts
  use kinds, only: rk
  use inelastic_blocks, only: inelastic_block
  use material_law, only: start_points
  use material_points, only: created_energy, crushing_energy, fracture_energy, num_energies, &
                             point_state
  use analysis_state, only: energy_balance, state
  use node_dofs, only: gather_vectors
  use problem_definition, only: problem
  use ranks, only: add_over_ranks
  use shape_hex8, only: hex8_dofs
  use stage_joints, only: fill_joints, harden_pressed, move_points, shift_points, start_phases
  use stage_nodes, only: place_nodes
  use warming, only: heat_points, take_references
  implicit none
  private
  public :: enter_stage, show_stage

contains

  !> Brings mesh and state to the start of a step. Nothing happens in a deck without stages.
  subroutine enter_stage(model, number, now, error)
    type(problem), intent(inout) :: model
    integer, intent(in) :: number !< of the step
    type(state), intent(inout) :: now !< at the end of the step before
    type(error_type), allocatable, intent(out) :: error
    if (.not. model%stages%is_there_any()) return
    if (number == 1) call start_phases(model, now%joints)
    if (number > 1) call show_stage(model, number - 1) ! where a loaded state goes on
    if (number > 1) call harden_pressed(model, model%steps(number - 1), now%joints)
    if (model%stages%changes_elements(number)) then
      call move_elements(model, number, now, error)
      if (allocated(error)) return
    end if
    call fill_joints(model, model%steps(number), now%joints)
  end subroutine enter_stage

  !> Sets the elements of the mesh and the parts of joints to those of a step.
  subroutine show_stage(model, number)
    type(problem), intent(inout) :: model
    integer, intent(in) :: number !< of the step
    integer :: s, j
    if (.not. allocated(model%stages%is_absent)) return
    associate (mesh => model%mesh, plan => model%stages)
      mesh%is_absent = plan%is_absent(:, number)
      mesh%material_of_element = merge(0, plan%material, mesh%is_absent)
      mesh%stage = count([(plan%changes_elements(s), s=1, number)])
      mesh%is_node_absent = nodes_of_elements(mesh, mesh%is_absent) &
                            .and. .not. nodes_of_elements(mesh, mesh%material_of_element > 0)
    end associate
    do j = 1, size(model%joints)
      call show_parts(model%joints(j), number)
    end do
    do j = 1, size(model%loads)
      associate (item => model%loads(j)%item)
        if (item%wet_joint > 0) call item%follow_joint(model%mesh, model%joints(item%wet_joint))
      end associate
    end do
  end subroutine show_stage

  !> Elements that come have no stress in the geometry of this moment, and a new history. Where a
  !> relation that begins to hold moves nodes, old elements and joints keep their stress.
  subroutine move_elements(model, number, now, error)
    type(problem), intent(inout) :: model
    integer, intent(in) :: number !< of the step
    type(state), intent(inout) :: now
    type(error_type), allocatable, intent(out) :: error
    logical :: was_absent(model%mesh%num_elements), was_node_absent(model%mesh%num_nodes)
    real(rk) :: change(size(now%u, 1), size(now%u, 2))
    integer :: e
    was_absent = .false.
    was_node_absent = .false.
    if (allocated(model%mesh%is_absent)) then
      was_absent = model%mesh%is_absent
      was_node_absent = model%mesh%is_node_absent
    end if
    call show_stage(model, number)
    call place_nodes(model, number, was_node_absent, now%u, change, error)
    if (allocated(error)) return
    call shift_points(model, change, now%joints)
    call move_points(model, number, now%u, now%joints)
    if (.not. allocated(now%origin)) then
      allocate (now%origin(hex8_dofs, model%mesh%num_elements), source=0.0_rk)
    end if
    do e = 1, model%mesh%num_elements
      if (model%mesh%is_absent(e)) then
        now%origin(:, e) = 0.0_rk
      else if (was_absent(e)) then
        now%origin(:, e) = gather_vectors(now%u, model%mesh%nodes(:, e))
      else if (model%mesh%material_of_element(e) > 0) then
        now%origin(:, e) = now%origin(:, e) + gather_vectors(change, model%mesh%nodes(:, e))
      end if
    end do
    call renew_points(model, was_absent, now)
    call take_references(model, was_absent, now)
    call heat_points(model, now)
  end subroutine move_elements

  !> The points of inelastic elements that come or go start anew. What they have dissipated remains
  !> in the balance.
  subroutine renew_points(model, was_absent, now)
    type(problem), intent(in) :: model
    logical, intent(in) :: was_absent(:) !< (elements)
    type(state), intent(inout) :: now
    real(rk) :: spent(num_energies, size(now%points))
    integer :: i
    spent = 0.0_rk
    do i = 1, size(now%points)
      associate (part => model%inelastic(i))
        if (was_absent(part%elements(1)) .eqv. &
            .not. element_is_there(model%mesh, part%elements(1))) cycle
        if (part%is_here()) spent(:, i) = dissipated_energies(part, now%points(i))
        call start_points(model%materials(part%material)%law, part%points, now%points(i))
      end associate
    end do
    call add_over_ranks(spent)
    do i = 1, size(now%points)
      call keep_dissipated(spent(:, i), now%energy)
    end do
  end subroutine renew_points

  !> The energies that a block has dissipated so far [J].
  pure function dissipated_energies(part, own) result(spent)
    type(inelastic_block), intent(in) :: part
    type(point_state), intent(in) :: own
    real(rk) :: spent(num_energies)
    spent = matmul(own%energy, reshape(part%weight, [size(part%weight)]))
  end function dissipated_energies

  !> Adds the energies that a block has dissipated so far to those of solids that have left.
  pure subroutine keep_dissipated(spent, energy)
    real(rk), intent(in) :: spent(num_energies) !< [J]
    type(energy_balance), intent(inout) :: energy
    energy%left_cracking = energy%left_cracking + spent(fracture_energy)
    energy%left_crushing = energy%left_crushing + spent(crushing_energy)
    energy%left_created = energy%left_created + spent(created_energy)
  end subroutine keep_dissipated
end module stage_entry
