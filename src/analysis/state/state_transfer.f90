!> Transfers motion between the nodes of a model and the unknowns of a step.
module state_transfer
  use dam_mesh, only: fe_mesh
  use kinds, only: rk
  use joint_law, only: joint_state
  use joint_points, only: dam_joint, relative_displacement
  use dof_numbering, only: numbering
  use analysis_state, only: state, motion
  use joint_operator, only: jump_operator
  use joint_forces, only: gather_tractions
  use node_parts, only: gather_at_nodes, list_own_nodes
  use row_tables, only: row_table
  implicit none
  private
  public :: start_motion, store_motion, restrict, sum_contact

contains

  !> The motion of the nodes in the unknowns of a step. Forces are zero.
  subroutine start_motion(numbers, joints, now, has_inertia)
    type(numbering), intent(in) :: numbers
    type(dam_joint), intent(in) :: joints(:)
    type(state), intent(inout) :: now
    logical, intent(in) :: has_inertia !< velocities, accelerations and their forces take part
    type(motion) :: fresh
    integer :: n
    n = numbers%num_total
    allocate (fresh%q(n))
    call restrict(numbers, joints, now%u, fresh%q)
    call set_exact_jumps(numbers, joints, now%joints, fresh%q)
    allocate (fresh%external(n), fresh%elastic(n), fresh%internal(n), fresh%contact(n), &
              fresh%balanced(n), source=0.0_rk)
    if (has_inertia) call start_rates(numbers, joints, now, fresh)
    now%motion = fresh
    if (has_inertia) return
    if (allocated(now%v)) deallocate (now%v)
    if (allocated(now%a)) deallocate (now%a)
  end subroutine start_motion

  !> Velocities and accelerations; zero after a static step.
  subroutine start_rates(numbers, joints, now, fresh)
    type(numbering), intent(in) :: numbers
    type(dam_joint), intent(in) :: joints(:)
    type(state), intent(inout) :: now
    type(motion), intent(inout) :: fresh
    integer :: n
    n = numbers%num_total
    if (.not. allocated(now%v)) allocate (now%v(3, size(now%u, 2)), source=0.0_rk)
    if (.not. allocated(now%a)) allocate (now%a(3, size(now%u, 2)), source=0.0_rk)
    allocate (fresh%v(n), fresh%a(n))
    call restrict(numbers, joints, now%v, fresh%v)
    call restrict(numbers, joints, now%a, fresh%a)
    allocate (fresh%viscous(n), fresh%momentum(n), fresh%inertia(n), source=0.0_rk)
  end subroutine start_rates

  !> The unknowns of a nodal field: q with T q = u.
  subroutine restrict(numbers, joints, u, q)
    type(numbering), intent(in) :: numbers
    type(dam_joint), intent(in) :: joints(:)
    real(rk), intent(in) :: u(:, :) !< (3, nodes)
    real(rk), intent(out) :: q(:) !< (num_total)
    integer :: j, p, pair, first
    call numbers%restrict(u, q)
    pair = 0
    do j = 1, size(joints)
      if (.not. joints(j)%is_nodal) cycle
      do p = 1, joints(j)%num_points
        pair = pair + 1
        first = numbers%first_jump(pair)
        if (first == 0) cycle
        q(first:first + 2) = matmul(joints(j)%rotation(:, :, p), &
                                    relative_displacement(joints(j), p, u))
      end do
    end do
  end subroutine restrict

  !> Jumps from the states of the joints: the difference of two nodes loses digits.
  subroutine set_exact_jumps(numbers, joints, states, q)
    type(numbering), intent(in) :: numbers
    type(dam_joint), intent(in) :: joints(:)
    type(joint_state), intent(in) :: states(:)
    real(rk), intent(inout) :: q(:) !< (num_total) [m]
    integer :: j, p, pair, first
    pair = 0
    do j = 1, size(joints)
      if (.not. joints(j)%is_nodal) cycle
      do p = 1, joints(j)%num_points
        pair = pair + 1
        first = numbers%first_jump(pair)
        if (first == 0) cycle
        q(first:first + 2) = states(j)%jump(:, p)
        if (allocated(states(j)%origin)) then
          q(first:first + 2) = q(first:first + 2) + states(j)%origin(:, p)
        end if
      end do
    end do
  end subroutine set_exact_jumps

  !> The forces of the joints by their laws, B^T (area t).
  subroutine sum_contact(operator, now)
    type(jump_operator), intent(in) :: operator
    type(state), intent(inout) :: now
    real(rk) :: traction(3, operator%num_points)
    now%motion%contact = 0.0_rk
    call gather_tractions(operator, now%joints, traction)
    call operator%add_forces(traction, now%motion%contact)
  end subroutine sum_contact

  !> Writes the motion back to the nodes. Reactions are the residual of prescribed unknowns. Where
  !> vectors are divided a rank has the fields at its nodes; the first one has them at all nodes.
  subroutine store_motion(mesh, numbers, now)
    type(fe_mesh), intent(in) :: mesh
    type(numbering), intent(in) :: numbers
    type(state), intent(inout) :: now
    type(row_table) :: nodes
    real(rk) :: residual(numbers%num_free + 1:numbers%num_total)
    associate (own => now%motion, first => numbers%num_free + 1)
      call numbers%expand(own%q, now%u)
      if (allocated(own%v)) call numbers%expand(own%v, now%v)
      if (allocated(own%a)) call numbers%expand(own%a, now%a)
      if (allocated(own%inertia)) then
        residual = own%inertia(first:) + own%viscous(first:) + own%internal(first:) &
                   + own%contact(first:) - own%external(first:)
      else
        residual = own%internal(first:) + own%contact(first:) - own%external(first:)
      end if
      call numbers%expand_prescribed(residual, now%reaction)
    end associate
    if (.not. allocated(mesh%is_node_here)) return
    call list_own_nodes(mesh, nodes)
    call gather_at_nodes(nodes, now%u)
    if (allocated(now%v)) call gather_at_nodes(nodes, now%v)
    if (allocated(now%a)) call gather_at_nodes(nodes, now%a)
    call gather_at_nodes(nodes, now%reaction)
  end subroutine store_motion
end module state_transfer
