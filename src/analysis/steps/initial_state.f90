!> Initial state of an analysis.
module initial_state
  use kinds, only: rk
  use node_dofs, only: zero_vectors
  use problem_definition, only: problem
  use dam_mesh, only: node_tie
  use guest_list, only: ties_of
  use guest_forces, only: update_guests
  use guest_histories, only: start_histories
  use guest_history, only: history_slot
  use joint_points, only: dam_joint, relative_displacement
  use joint_law, only: joint_state
  use joint_forces, only: start_joints
  use errors, only: error_type, raise
  use block_answers, only: gather_points
  use inelastic_forces, only: block_answer, open_answers, update_points, find_failure
  use material_law, only: start_points
  use material_points, only: time_increment, point_state, no_tangent
  use analysis_state, only: state
  use tie_motion, only: follow_ties
  use warming, only: start_heat
  implicit none
  private
  public :: start_analysis

contains

  !> At rest except for the initial conditions of the deck. Tied nodes follow their masters; joints
  !> and inelastic solids follow the initial displacements.
  subroutine start_analysis(model, now, error)
    type(problem), intent(in) :: model
    type(state), allocatable, intent(out) :: now
    type(error_type), allocatable, intent(out) :: error
    type(node_tie), allocatable :: ties(:)
    integer :: i, n
    n = model%mesh%num_nodes
    allocate (now)
    now%u = zero_vectors(n)
    now%v = zero_vectors(n)
    now%a = zero_vectors(n)
    now%reaction = zero_vectors(n)
    call start_joints(model%joints, now%joints)
    call start_points_of_solids(model, now)
    call start_heat(model, now)
    call start_histories(model, now%guests)
    if (.not. allocated(model%initial_values)) return
    do i = 1, size(model%initial_values)
      associate (given => model%initial_values(i))
        if (given%is_velocity) then
          now%v(given%dof, given%node) = given%value
        else
          now%u(given%dof, given%node) = given%value
        end if
      end associate
    end do
    call ties_of(model%guests, ties)
    call follow_ties(ties, now%u, error)
    if (.not. allocated(error)) call follow_ties(ties, now%v, error)
    if (allocated(error)) return
    if (.not. any(abs(now%u) > 0.0_rk)) return
    do i = 1, size(model%joints)
      call move_joint(model%joints(i), now%u, now%joints(i))
    end do
    call move_guests(model, now)
    call strain_points(model, now, error)
  end subroutine start_analysis

  !> Initial histories of the points of inelastic solids.
  subroutine start_points_of_solids(model, now)
    type(problem), intent(in) :: model
    type(state), intent(inout) :: now
    integer :: i, num_blocks
    num_blocks = 0
    if (allocated(model%inelastic)) num_blocks = size(model%inelastic)
    allocate (now%points(num_blocks))
    do i = 1, num_blocks
      associate (part => model%inelastic(i))
        call start_points(model%materials(part%material)%law, part%points, now%points(i))
      end associate
    end do
  end subroutine start_points_of_solids

  !> Updates inelastic solids for the initial displacements.
  subroutine strain_points(model, now, error)
    type(problem), intent(in) :: model
    type(state), intent(inout) :: now
    type(error_type), allocatable, intent(out) :: error
    type(block_answer), allocatable :: answers(:)
    type(point_state), allocatable :: old(:)
    character(:), allocatable :: why
    real(rk) :: size_ratio
    if (size(now%points) == 0) return
    call open_answers(model%inelastic, answers)
    old = now%points
    call update_points(model, now%u, now%origin, time_increment(tangent=no_tangent), old, &
                       now%points, answers)
    call gather_points(model%inelastic, now%points)
    call find_failure(model, answers, size_ratio, why)
    if (allocated(why)) call raise(error, 'initial displacements: '//why)
  end subroutine strain_points

  !> Updates the histories of guests for the initial displacements.
  subroutine move_guests(model, now)
    type(problem), intent(in) :: model
    type(state), intent(inout) :: now
    type(history_slot), allocatable :: old(:)
    real(rk), allocatable :: excess(:, :)
    old = now%guests
    excess = zero_vectors(model%mesh%num_nodes)
    call update_guests(model, now%u, 0.0_rk, old, now%guests, excess)
  end subroutine move_guests

  !> Updates a joint for the initial displacements.
  subroutine move_joint(joint, u, history)
    type(dam_joint), intent(in) :: joint
    real(rk), intent(in) :: u(:, :) !< (3, nodes) [m]
    type(joint_state), intent(inout) :: history
    real(rk) :: jump(3, joint%num_points), tangent(3, 3, joint%num_points)
    type(joint_state) :: old
    integer :: p
    do p = 1, joint%num_points
      jump(:, p) = matmul(joint%rotation(:, :, p), relative_displacement(joint, p, u))
    end do
    old = history
    call joint%law%update(jump, old, history, tangent)
  end subroutine move_joint
end module initial_state
