!> Warns of blocks that joints do not hold in every direction, when the deck is read.
!>
!> A closed joint without friction, cohesion and strength does not resist sliding. A block with such
!> joints and supports alone can slide along them in any state of the joints. The block may still be
!> in equilibrium if no load acts in this direction: a warning, not an error.
module verify_blocks
  use block_motion, only: block_name, freedom_text
  use diagnostics, only: diagnostic_list
  use errors, only: error_type
  use joint_points, only: dam_joint
  use guest_list, only: supports_of_step
  use kinds, only: rk
  use model_draft, only: draft
  use rigid_blocks, only: add_square, add_supports, block_set, find_blocks, jump_rows
  use symmetric_modes, only: find_modes, null_space
  implicit none
  private
  public :: verify_free_blocks

  integer, parameter :: most_blocks = 100 !< more are not checked
  integer, parameter :: most_reported = 5 !< blocks; the others are counted
  !> A smaller share of a block in the free motions, squared, is round-off.
  real(rk), parameter :: no_share = 1.0e-6_rk
  character(*), parameter :: no_check = 'the check for blocks that are free to move failed: '

contains

  !> Warns of free blocks at the first static step that has any.
  subroutine verify_free_blocks(model, faults)
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(block_set) :: blocks
    type(error_type), allocatable :: error
    real(rk), allocatable :: by_joints(:, :), matrix(:, :), directions(:, :)
    integer, allocatable :: node(:), direction(:)
    integer :: i, n
    if (size(model%problem%joints) == 0) return
    call find_blocks(model%problem, blocks)
    if (blocks%num_blocks > most_blocks) return
    n = 6*blocks%num_blocks
    allocate (by_joints(n, n), source=0.0_rk)
    do i = 1, size(model%problem%joints)
      call add_joint(model%problem%mesh%x, blocks, model%problem%joints(i), by_joints)
    end do
    do i = 1, size(model%problem%steps)
      associate (step => model%problem%steps(i))
        if (.not. step%procedure%is_static()) cycle
        matrix = by_joints
        call supports_of_step(model%problem, step, node, direction)
        call add_supports(blocks, model%problem%mesh%x, node, direction, matrix)
        call null_space(matrix, directions, error)
        if (allocated(error)) then
          call model%cards(model%procedure_card(i))%warn(faults, no_check//error%message)
          return
        end if
        if (size(directions, 2) == 0) cycle
        call warn_of_motions(model, i, blocks, directions, faults)
        return
      end associate
    end do
  end subroutine verify_free_blocks

  !> Adds sum row^T row of the closed points of a joint.
  subroutine add_joint(x, blocks, joint, matrix)
    real(rk), intent(in) :: x(:, :) !< (3, nodes) [m]
    type(block_set), intent(in) :: blocks
    type(dam_joint), intent(in) :: joint
    real(rk), intent(inout) :: matrix(:, :) !< (6*blocks, 6*blocks)
    real(rk) :: rows(6, blocks%num_blocks, 3)
    real(rk) :: friction, cohesion, strength
    integer :: p, i, num_held
    call joint%law%limits(friction, cohesion, strength)
    num_held = merge(3, 1, max(friction, cohesion, strength) > 0.0_rk)
    do p = 1, joint%num_points
      call jump_rows(blocks, x, joint, p, rows)
      do i = 1, num_held
        call add_square(reshape(rows(:, :, i), [size(matrix, 1)]), matrix)
      end do
    end do
  end subroutine add_joint

  !> One warning for each block with a share in the free motions.
  subroutine warn_of_motions(model, number, blocks, directions, faults)
    type(draft), intent(in) :: model
    integer, intent(in) :: number !< of the step
    type(block_set), intent(in) :: blocks
    real(rk), intent(in) :: directions(:, :) !< (6*blocks, motions) orthonormal
    type(diagnostic_list), intent(inout) :: faults
    type(error_type), allocatable :: error
    real(rk), allocatable :: share(:), motion(:, :)
    integer :: b, num_free
    num_free = 0
    do b = 1, blocks%num_blocks
      associate (own => directions(6*b - 5:6*b, :))
        call find_modes(matmul(own, transpose(own)), share, motion, error)
      end associate
      if (allocated(error)) then
        call model%cards(model%procedure_card(number))%warn(faults, no_check//error%message)
        return
      end if
      if (share(6) <= no_share) cycle
      num_free = num_free + 1
      if (num_free > most_reported) cycle
      call model%cards(model%procedure_card(number))%warn( &
        faults, block_name(model%problem, blocks, b)//' can '// &
        freedom_text(blocks, b, motion(:, findloc(share > no_share, .true., 1):))// &
        ': only joints hold the block, without friction, cohesion and strength')
    end do
    if (num_free <= most_reported) return
    call model%cards(model%procedure_card(number))%warn( &
      faults, 'further blocks can move; only the first are listed')
  end subroutine warn_of_motions
end module verify_blocks
