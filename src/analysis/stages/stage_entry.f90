!> The start of a step in a model that is built in stages (theory.md, 15): elements that come and
!> go, and joints that are grouted.
!>
!> The mesh says which elements there are; state%origin the displacements at which an element has no
!> stress. A joint keeps the relative displacement of its nodes at the zero of its law.
module stage_entry
  use constraint_elimination, only: keep_present
  use dam_mesh, only: fe_mesh, node_tie, are_there, element_is_there
  use errors, only: error_type
  use guest_list, only: ties_of
  use joint_law, only: joint_state, phase_absent, phase_contact, phase_full, takes_grout
  use joint_points, only: dam_joint, relative_displacement
  use kinds, only: rk
  use material_law, only: start_points
  use analysis_state, only: state
  use node_dofs, only: gather_vectors
  use problem_definition, only: problem
  use shape_hex8, only: hex8_dofs
  use step_plan, only: step
  use tie_motion, only: follow_ties
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
    if (.not. model%steps(number)%changes_stage) return
    if (number > 1) call harden_pressed(model, model%steps(number - 1), now%joints)
    if (model%stages%changes_elements(number)) then
      call move_elements(model, number, now, error)
      if (allocated(error)) return
    end if
    call harden_joints(model, model%steps(number), now%joints)
  end subroutine enter_stage

  !> Sets the elements of the mesh to those of a step.
  subroutine show_stage(model, number)
    type(problem), intent(inout) :: model
    integer, intent(in) :: number !< of the step
    integer :: s, e
    if (.not. allocated(model%stages%is_absent)) return
    associate (mesh => model%mesh, plan => model%stages)
      mesh%is_absent = plan%is_absent(:, number)
      mesh%material_of_element = merge(0, plan%material, mesh%is_absent)
      mesh%stage = count([(plan%changes_elements(s), s=1, number)])
      if (.not. allocated(mesh%is_node_absent)) allocate (mesh%is_node_absent(mesh%num_nodes))
      mesh%is_node_absent = .false.
      do e = 1, mesh%num_elements
        if (mesh%is_absent(e)) mesh%is_node_absent(nodes_of(mesh, e)) = .true.
      end do
      do e = 1, mesh%num_elements
        if (mesh%material_of_element(e) > 0) mesh%is_node_absent(nodes_of(mesh, e)) = .false.
      end do
    end associate
  end subroutine show_stage

  !> The nodes of an element.
  pure function nodes_of(mesh, element) result(nodes)
    type(fe_mesh), intent(in) :: mesh
    integer, intent(in) :: element
    integer, allocatable :: nodes(:)
    nodes = pack(mesh%nodes(:, element), mesh%nodes(:, element) > 0)
  end function nodes_of

  !> Phases and origins of the joints of the complete model; joints to be grouted are in contact.
  subroutine start_phases(model, joints)
    type(problem), intent(in) :: model
    type(joint_state), intent(inout) :: joints(:)
    integer :: j
    do j = 1, size(joints)
      if (.not. allocated(model%stages%is_absent) .and. first_phase(model, j) == phase_full) cycle
      allocate (joints(j)%origin(3, model%joints(j)%num_points), source=0.0_rk)
      allocate (joints(j)%phase(model%joints(j)%num_points), source=first_phase(model, j))
      if (first_phase(model, j) == phase_contact) joints(j)%is_broken = .true.
    end do
  end subroutine start_phases

  !> The phase of points that appear.
  pure integer function first_phase(model, joint) result(phase)
    type(problem), intent(in) :: model
    integer, intent(in) :: joint
    phase = phase_full
    if (allocated(model%stages%is_grouted)) then
      if (model%stages%is_grouted(joint)) phase = phase_contact
    end if
  end function first_phase

  !> Elements that come have no stress in the geometry of this moment, and a new history. Nodes that
  !> come start without displacement, tied ones from the nodes that they follow.
  subroutine move_elements(model, number, now, error)
    type(problem), intent(inout) :: model
    integer, intent(in) :: number !< of the step
    type(state), intent(inout) :: now
    type(error_type), allocatable, intent(out) :: error
    logical :: was_absent(model%mesh%num_elements), was_node_absent(model%mesh%num_nodes)
    integer :: e, j
    was_absent = .false.
    was_node_absent = .false.
    if (allocated(model%mesh%is_absent)) then
      was_absent = model%mesh%is_absent
      was_node_absent = model%mesh%is_node_absent
    end if
    call show_stage(model, number)
    call place_nodes(model, was_node_absent, now%u, error)
    if (allocated(error)) return
    do j = 1, size(model%joints)
      call move_points(model, j, now%u, now%joints(j))
    end do
    if (.not. allocated(now%origin)) then
      allocate (now%origin(hex8_dofs, model%mesh%num_elements), source=0.0_rk)
    end if
    do e = 1, model%mesh%num_elements
      if (model%mesh%is_absent(e)) then
        now%origin(:, e) = 0.0_rk
      else if (was_absent(e)) then
        now%origin(:, e) = gather_vectors(now%u, model%mesh%nodes(:, e))
      end if
    end do
    call renew_points(model, was_absent, now)
    call take_references(model, was_absent, now)
    call heat_points(model, now)
  end subroutine move_elements

  !> Displacements of nodes that come.
  subroutine place_nodes(model, was_absent, u, error)
    type(problem), intent(in) :: model
    logical, intent(in) :: was_absent(:) !< (nodes)
    real(rk), intent(inout) :: u(:, :) !< (3, nodes) [m]
    type(error_type), allocatable, intent(out) :: error
    type(node_tie), allocatable :: ties(:)
    real(rk), allocatable :: followed(:, :)
    integer :: node
    do node = 1, size(u, 2)
      if (model%mesh%is_node_absent(node)) u(:, node) = 0.0_rk
    end do
    call ties_of(model%guests, ties)
    call keep_present(model%mesh, ties)
    followed = u
    call follow_ties(ties, followed, error)
    do node = 1, size(u, 2)
      if (was_absent(node)) u(:, node) = followed(:, node)
    end do
  end subroutine place_nodes

  !> Points of a joint that come or go start anew; their energies dissipated so far remain.
  subroutine move_points(model, number, u, own)
    type(problem), intent(in) :: model
    integer, intent(in) :: number !< of the joint
    real(rk), intent(in) :: u(:, :) !< (3, nodes) [m]
    type(joint_state), intent(inout) :: own
    type(joint_state) :: fresh
    logical :: is_there
    integer :: p
    associate (joint => model%joints(number))
      call joint%law%start_state(joint%clearance, fresh)
      do p = 1, joint%num_points
        is_there = are_there(model%mesh, joint%node(joint%first(p):joint%first(p + 1) - 1))
        if (is_there .eqv. own%phase(p) /= phase_absent) cycle
        call renew_point(fresh, p, own)
        own%phase(p) = phase_absent
        own%origin(:, p) = 0.0_rk
        if (.not. is_there) cycle
        own%phase(p) = first_phase(model, number)
        own%is_broken(p) = own%is_broken(p) .or. own%phase(p) == phase_contact
        own%origin(:, p) = matmul(joint%rotation(:, :, p), relative_displacement(joint, p, u))
      end do
    end associate
  end subroutine move_points

  !> Copies what a point is at the start, but for the energies dissipated.
  pure subroutine renew_point(fresh, p, own)
    type(joint_state), intent(in) :: fresh
    integer, intent(in) :: p
    type(joint_state), intent(inout) :: own
    own%gap(p) = fresh%gap(p)
    own%shift(p) = fresh%shift(p)
    own%jump(:, p) = fresh%jump(:, p)
    own%traction(:, p) = fresh%traction(:, p)
    own%slip(:, p) = fresh%slip(:, p)
    own%is_broken(p) = fresh%is_broken(p)
    own%status(p) = fresh%status(p)
    own%num_openings(p) = 0
    own%internal(:, p) = fresh%internal(:, p)
  end subroutine renew_point

  !> The points of inelastic elements that come or go start anew.
  subroutine renew_points(model, was_absent, now)
    type(problem), intent(in) :: model
    logical, intent(in) :: was_absent(:) !< (elements)
    type(state), intent(inout) :: now
    integer :: i
    do i = 1, size(now%points)
      associate (part => model%inelastic(i))
        if (was_absent(part%elements(1)) .eqv. &
            .not. element_is_there(model%mesh, part%elements(1))) cycle
        call start_points(model%materials(part%material)%law, part%points, now%points(i))
      end associate
    end do
  end subroutine renew_points

  !> Grout without pressure hardens at the start of its step.
  subroutine harden_joints(model, plan, joints)
    type(problem), intent(in) :: model
    type(step), intent(in) :: plan
    type(joint_state), intent(inout) :: joints(:)
    integer :: g
    if (.not. allocated(plan%grouts)) return
    do g = 1, size(plan%grouts)
      associate (grout => plan%grouts(g))
        if (grout%pressure > 0.0_rk) cycle
        call harden(model%joints(grout%joint), 0.0_rk, joints(grout%joint))
      end associate
    end do
  end subroutine harden_joints

  !> Grout with pressure hardens at the end of its step.
  subroutine harden_pressed(model, plan, joints)
    type(problem), intent(in) :: model
    type(step), intent(in) :: plan !< the step before
    type(joint_state), intent(inout) :: joints(:)
    integer :: g
    if (.not. allocated(plan%grouts)) return
    do g = 1, size(plan%grouts)
      associate (grout => plan%grouts(g))
        if (grout%pressure <= 0.0_rk) cycle
        call harden(model%joints(grout%joint), grout%pressure, joints(grout%joint))
      end associate
    end do
  end subroutine harden_pressed

  !> The zero of the law moves so that the springs of the law carry what faces and grout carry now:
  !> an open point without pressure has its zero where it is.
  subroutine harden(joint, pressure, own)
    type(dam_joint), intent(in) :: joint
    real(rk), intent(in) :: pressure !< of the grout [Pa]
    type(joint_state), intent(inout) :: own
    type(joint_state) :: old, fresh
    real(rk) :: tangent(3, 3, joint%num_points), jump(3, joint%num_points), k(3)
    logical :: takes(joint%num_points)
    integer :: p
    takes = takes_grout(own)
    call joint%law%start_state(spread(-joint%law%gap, 1, joint%num_points), old)
    old%phase = own%phase
    where (takes) old%phase = phase_full
    call joint%law%reference_stiffness(k)
    jump = spread(1.0_rk/k, 2, joint%num_points)*own%traction
    jump(1, :) = jump(1, :) - pressure/k(1)
    fresh = old
    call joint%law%update(jump, old, fresh, tangent)
    do p = 1, joint%num_points
      if (.not. takes(p)) cycle
      own%origin(:, p) = own%origin(:, p) + own%jump(:, p) - jump(:, p)
      call renew_point(fresh, p, own)
      own%phase(p) = phase_full
    end do
  end subroutine harden
end module stage_entry
