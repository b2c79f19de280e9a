!> Initial state of an analysis.
module initial_state
  use kinds, only: rk
  use node_dofs, only: zero_vectors
  use problem_definition, only: problem
  use joint_points, only: joint, relative_displacement
  use joint_law, only: joint_state
  use joint_forces, only: start_joints
  use errors, only: error_type, raise
  use inelastic_forces, only: block_answer, open_answers, update_points, find_failure
  use material_law, only: start_points
  use material_points, only: time_increment, point_state, no_tangent
  use analysis_state, only: state
  use tie_motion, only: follow_ties
  implicit none
  private
  public :: start_analysis

contains

  !> At rest except for the initial conditions of the deck. Tied nodes follow their masters; joints
  !> and inelastic solids follow the initial displacements.
  subroutine start_analysis(scene, now, error)
    type(problem), intent(in) :: scene
    type(state), allocatable, intent(out) :: now
    type(error_type), allocatable, intent(out) :: error
    integer :: i, n
    n = scene%mesh%num_nodes
    allocate (now)
    now%u = zero_vectors(n)
    now%v = zero_vectors(n)
    now%a = zero_vectors(n)
    now%reaction = zero_vectors(n)
    call start_joints(scene%joints, now%joints)
    call start_histories(scene, now)
    if (.not. allocated(scene%initial_values)) return
    do i = 1, size(scene%initial_values)
      associate (given => scene%initial_values(i))
        if (given%is_velocity) then
          now%v(given%dof, given%node) = given%value
        else
          now%u(given%dof, given%node) = given%value
        end if
      end associate
    end do
    call follow_ties(scene%ties, now%u, error)
    if (.not. allocated(error)) call follow_ties(scene%ties, now%v, error)
    if (allocated(error)) return
    if (.not. any(abs(now%u) > 0.0_rk)) return
    do i = 1, size(scene%joints)
      call move_joint(scene%joints(i), now%u, now%joints(i))
    end do
    call strain_points(scene, now, error)
  end subroutine start_analysis

  !> Initial histories of the points of inelastic solids.
  subroutine start_histories(scene, now)
    type(problem), intent(in) :: scene
    type(state), intent(inout) :: now
    integer :: i, num_blocks
    num_blocks = 0
    if (allocated(scene%inelastic)) num_blocks = size(scene%inelastic)
    allocate (now%points(num_blocks))
    do i = 1, num_blocks
      associate (part => scene%inelastic(i))
        call start_points(scene%materials(part%material)%law, part%points, now%points(i))
      end associate
    end do
  end subroutine start_histories

  !> Updates inelastic solids for the initial displacements.
  subroutine strain_points(scene, now, error)
    type(problem), intent(in) :: scene
    type(state), intent(inout) :: now
    type(error_type), allocatable, intent(out) :: error
    type(block_answer), allocatable :: answers(:)
    type(point_state), allocatable :: old(:)
    character(:), allocatable :: why
    real(rk) :: size_ratio
    if (size(now%points) == 0) return
    call open_answers(scene%inelastic, answers)
    old = now%points
    call update_points(scene, now%u, time_increment(tangent=no_tangent), old, now%points, answers)
    call find_failure(scene, answers, size_ratio, why)
    if (allocated(why)) call raise(error, 'initial displacements: '//why)
  end subroutine strain_points

  !> Updates a joint for the initial displacements.
  subroutine move_joint(seam, u, history)
    type(joint), intent(in) :: seam
    real(rk), intent(in) :: u(:, :) !< (3, nodes) [m]
    type(joint_state), intent(inout) :: history
    real(rk) :: jump(3, seam%num_points), tangent(3, 3, seam%num_points)
    type(joint_state) :: old
    integer :: p
    do p = 1, seam%num_points
      jump(:, p) = matmul(seam%rotation(:, :, p), relative_displacement(seam, p, u))
    end do
    old = history
    call seam%law%update(jump, old, history, tangent)
  end subroutine move_joint
end module initial_state
