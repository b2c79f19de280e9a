!> Reports the block that its joints cannot hold, when a static step finds no equilibrium.
!>
!> The check takes rigid blocks and the strength of the joints (joint_capacity). It reports nothing
!> where these do not decide. The motion of the block is the one that the loads drive, among the
!> motions that open points and points at the limit of friction do not resist.
module free_blocks
  use block_motion, only: block_name, freedom_text, motion_text
  use errors, only: error_type
  use global_vectors, only: dot
  use joint_capacity, only: best_forces, find_best_forces, point_limits
  use joint_law, only: joint_state, state_open
  use joint_rows, only: num_rows, row_of
  use guest_list, only: supports_of_step
  use kinds, only: rk
  use node_dofs, only: zero_vectors
  use state_transfer, only: restrict
  use problem_definition, only: problem
  use rigid_blocks, only: add_supports, block_set, find_blocks, jump_rows
  use step_loads, only: external_force, step_time
  use step_plan, only: step
  use step_system, only: dam_system
  use symmetric_modes, only: find_modes, null_space
  use write_text, only: as_text
  implicit none
  private
  public :: name_free_block, exceeds_joints

  !> Most entries in the rows of the joints; larger models are not checked.
  integer, parameter :: most_entries = 20000000
  integer, parameter :: most_blocks = 100
  !> Smallest unbalanced fraction of the loads that proves a mechanism; projections leave less.
  real(rk), parameter :: certain = 1.0e-2_rk
  !> Forces below `no_force` of the largest are zero. A point slides within `at_limit` of its limit.
  real(rk), parameter :: no_force = 1.0e-3_rk, at_limit = 1.0e-2_rk
  !> Blocks that move more than this fraction of the largest motion belong to the mechanism.
  real(rk), parameter :: smallest_motion = 0.1_rk

  !> The blocks of a step with its supports.
  type :: block_task
    type(block_set) :: blocks
    real(rk), allocatable :: free(:, :) !< (6*blocks, motions) with the supports, orthonormal
    real(rk), allocatable :: rows(:, :) !< (motions, rows) jumps of the joints
    type(point_limits), allocatable :: limits(:) !< (points)
  end type block_task

contains

  !> Adds the block that moves to the message of an error.
  subroutine name_free_block(model, plan, system, states, last, when, error)
    type(problem), intent(in) :: model
    type(step), intent(in) :: plan
    type(dam_system), intent(in) :: system
    type(joint_state), intent(in) :: states(:) !< of the last equilibrium
    type(joint_state), intent(in) :: last(:) !< at the end of the iteration
    type(step_time), intent(in) :: when !< of the increment that failed
    type(error_type), allocatable, intent(inout) :: error
    type(block_task) :: task
    type(step_time) :: checked
    character(:), allocatable :: text
    logical :: is_known
    if (.not. allocated(error)) return
    call open_task(model, plan, system, states, task, is_known)
    if (.not. is_known) return
    checked = when
    call find_driven_block(model, system, task, checked, text, is_known)
    if (.not. is_known) return
    if (text == '') then
      checked%now = when%duration
      call find_driven_block(model, system, task, checked, text, is_known)
      if (.not. is_known) return
    end if
    if (text /= '') then
      text = '; the joints cannot hold '//text
    else
      text = idle_motion(model, task)
    end if
    if (text == '') then
      text = lifted_block(model, task, last)
      if (text /= '') then
        error%message = text//'; this was the increment to time '//as_text(when%start + when%now)
        return
      end if
      text = '; the same model of rigid blocks has an equilibrium, which may need prestress'// &
             separated_block(model, task, last)
    end if
    error%message = error%message//text
  end subroutine name_free_block

  !> Whether the loads of a time exceed what the joints can carry, however stiff the blocks are:
  !> then no equilibrium exists. False where that is not certain.
  logical function exceeds_joints(model, plan, system, states, when)
    type(problem), intent(in) :: model
    type(step), intent(in) :: plan
    type(dam_system), intent(in) :: system
    type(joint_state), intent(in) :: states(:) !< of the last equilibrium
    type(step_time), intent(in) :: when
    type(block_task) :: task
    character(:), allocatable :: text
    logical :: is_known
    exceeds_joints = .false.
    call open_task(model, plan, system, states, task, is_known)
    if (.not. is_known) return
    call find_driven_block(model, system, task, when, text, is_known)
    exceeds_joints = is_known .and. text /= ''
  end function exceeds_joints

  !> The blocks and joints of a step, unless there are too many or no block can move.
  subroutine open_task(model, plan, system, states, task, is_known)
    type(problem), intent(in) :: model
    type(step), intent(in) :: plan
    type(dam_system), intent(in) :: system
    type(joint_state), intent(in) :: states(:)
    type(block_task), intent(out) :: task
    logical, intent(out) :: is_known
    type(error_type), allocatable :: failure
    is_known = .false.
    if (size(model%joints) == 0) return
    call find_blocks(model, task%blocks)
    if (task%blocks%num_blocks > most_blocks) return
    if (6*task%blocks%num_blocks*num_rows(system%operator%num_points) > most_entries) return
    call find_limits(model, plan, states, task, failure)
    if (allocated(failure)) return ! the error is reported without the blocks
    is_known = size(task%rows, 1) > 0
  end subroutine open_task

  !> Motions that are possible with the supports, and the limits of the joints.
  subroutine find_limits(model, plan, states, task, error)
    type(problem), intent(in) :: model
    type(step), intent(in) :: plan
    type(joint_state), intent(in) :: states(:)
    type(block_task), intent(inout) :: task
    type(error_type), allocatable, intent(out) :: error
    real(rk), allocatable :: matrix(:, :), rows(:, :, :)
    integer, allocatable :: node(:), direction(:)
    integer :: j, p, i, n, point
    n = 6*task%blocks%num_blocks
    allocate (matrix(n, n), source=0.0_rk)
    call supports_of_step(model, plan, node, direction)
    call add_supports(task%blocks, model%mesh%x, node, direction, matrix)
    call null_space(matrix, task%free, error)
    if (allocated(error)) return
    allocate (task%rows(size(task%free, 2), num_rows(sum(model%joints%num_points))))
    allocate (task%limits(sum(model%joints%num_points)))
    allocate (rows(6, task%blocks%num_blocks, 3))
    point = 0
    do j = 1, size(model%joints)
      do p = 1, model%joints(j)%num_points
        point = point + 1
        call jump_rows(task%blocks, model%mesh%x, model%joints(j), p, rows)
        associate (now => task%limits(point), area => model%joints(j)%area(p))
          call model%joints(j)%law%limits(now%friction, now%cohesion, now%tension)
          now%cohesion = area*now%cohesion
          now%tension = area*now%tension
          now%is_bonded = .not. states(j)%is_broken(p)
          if (.not. (now%is_bonded .or. max(now%friction, now%cohesion) > 0.0_rk)) then
            rows(:, :, 2:3) = 0.0_rk
          end if
        end associate
        do i = 1, 3
          task%rows(:, row_of(point, i)) = matmul(reshape(rows(:, :, i), [n]), task%free)
        end do
      end do
    end do
  end subroutine find_limits

  !> The block that moves under the loads of a time, and its motion; '' where the joints hold all.
  subroutine find_driven_block(model, system, task, when, text, is_known)
    type(problem), intent(in) :: model
    type(dam_system), intent(in) :: system
    type(block_task), intent(in) :: task
    type(step_time), intent(in) :: when
    character(:), allocatable, intent(out) :: text
    logical, intent(out) :: is_known !< the joints decide
    real(rk), allocatable :: load(:), motion(:, :), amount(:)
    type(best_forces) :: best
    integer :: b, others
    call sum_loads(model, system, task, when, load)
    text = ''
    is_known = .true.
    if (.not. norm2(load) > 0.0_rk) return
    call find_best_forces(task%rows, task%limits, load, best)
    is_known = best%has_settled .or. best%left < certain
    if (best%left < certain .or. .not. is_known) return
    motion = reshape(matmul(task%free, driven_motion(task, best, load)), &
                     [6, task%blocks%num_blocks])
    amount = norm2(motion, dim=1)
    b = maxloc(amount, 1)
    others = count(amount > smallest_motion*amount(b)) - 1
    text = block_name(model, task%blocks, b)//' under the loads at step time '// &
           as_text(when%now)//': the block can '//motion_text(task%blocks, b, motion(:, b))
    if (others > 0) text = text//' ('//as_text(others)//' more blocks move too)'
  end subroutine find_driven_block

  !> The loads as forces on the motions of the blocks.
  subroutine sum_loads(model, system, task, when, load)
    type(problem), intent(in) :: model
    type(dam_system), intent(in) :: system
    type(block_task), intent(in) :: task
    type(step_time), intent(in) :: when
    real(rk), allocatable, intent(out) :: load(:) !< (motions)
    real(rk), allocatable :: force(:), q(:), u(:, :), on_blocks(:)
    real(rk) :: motion(6)
    integer :: b, k
    allocate (force(system%numbers%num_total), q(system%numbers%num_total))
    u = zero_vectors(model%mesh%num_nodes)
    allocate (on_blocks(6*task%blocks%num_blocks))
    call external_force(system%groups, model%amplitudes, when, force)
    where (.not. system%matrix%part%owns(size(force))) force = 0.0_rk ! another rank has it
    do b = 1, task%blocks%num_blocks
      do k = 1, 6
        motion = 0.0_rk
        motion(k) = 1.0_rk
        call move_block(model, task%blocks, b, motion, u)
        call restrict(system%numbers, model%joints, u, q)
        on_blocks(6*(b - 1) + k) = dot_product(force, q)
      end do
    end do
    call system%matrix%part%add_shares(on_blocks)
    load = matmul(on_blocks, task%free)
  end subroutine sum_loads

  !> Displacements when one block moves.
  subroutine move_block(model, blocks, b, motion, u)
    type(problem), intent(in) :: model
    type(block_set), intent(in) :: blocks
    integer, intent(in) :: b
    real(rk), intent(in) :: motion(6) !< v, radius*w
    real(rk), intent(out) :: u(:, :) !< (3, nodes)
    real(rk) :: r(3)
    integer :: node
    u = 0.0_rk
    do node = 1, size(u, 2)
      if (blocks%block_of(node) /= b) cycle
      r = (model%mesh%x(:, node) - blocks%centre(:, b))/blocks%radius(b)
      u(:, node) = motion(1:3) + [motion(5)*r(3) - motion(6)*r(2), &
                                  motion(6)*r(1) - motion(4)*r(3), &
                                  motion(4)*r(2) - motion(5)*r(1)]
    end do
  end subroutine move_block

  !> A block that its supports hold in part and whose joints were all open at the end of the
  !> iteration: nothing else can hold it, so the message leaves the iteration out. '' for none.
  function lifted_block(model, task, last) result(text)
    type(problem), intent(in) :: model
    type(block_task), intent(in) :: task
    type(joint_state), intent(in) :: last(:)
    character(:), allocatable :: text
    real(rk), allocatable :: shares(:), motion(:, :)
    type(error_type), allocatable :: error
    logical :: is_apart(task%blocks%num_blocks)
    integer :: b, num_held
    text = ''
    is_apart = blocks_apart(model, task%blocks, last)
    do b = 1, task%blocks%num_blocks
      if (.not. is_apart(b)) cycle
      associate (own => task%free(6*b - 5:6*b, :))
        call find_modes(matmul(own, transpose(own)), shares, motion, error)
      end associate
      if (allocated(error)) return
      num_held = count(shares <= no_force)
      if (num_held == 0 .or. num_held == 6) cycle
      text = block_name(model, task%blocks, b)//' has come free: all its joints have opened, '// &
             'and its supports let it '//freedom_text(task%blocks, b, motion(:, num_held + 1:))// &
             '; add a support, or a load that keeps a joint closed'
      return
    end do
  end function lifted_block

  !> The first block that can move and whose joints were all open at the end of the iteration; ''
  !> for none.
  function separated_block(model, task, last) result(text)
    type(problem), intent(in) :: model
    type(block_task), intent(in) :: task
    type(joint_state), intent(in) :: last(:)
    character(:), allocatable :: text
    logical :: is_apart(task%blocks%num_blocks)
    integer :: b
    text = ''
    is_apart = blocks_apart(model, task%blocks, last)
    do b = 1, task%blocks%num_blocks
      if (.not. is_apart(b) .or. sum(task%free(6*b - 5:6*b, :)**2) <= no_force) cycle
      text = '; at the end of the iteration all joints of '//block_name(model, task%blocks, b)// &
             ' were open'
      return
    end do
  end function separated_block

  !> Whether each block has joints and all of them were open.
  pure function blocks_apart(model, blocks, last) result(is_apart)
    type(problem), intent(in) :: model
    type(block_set), intent(in) :: blocks
    type(joint_state), intent(in) :: last(:)
    logical :: is_apart(blocks%num_blocks)
    logical :: has_joint(0:blocks%num_blocks), is_touched(0:blocks%num_blocks)
    integer :: j, p, k, b
    has_joint = .false.
    is_touched = .false.
    do j = 1, size(model%joints)
      do p = 1, model%joints(j)%num_points
        do k = model%joints(j)%first(p), model%joints(j)%first(p + 1) - 1
          b = blocks%block_of(model%joints(j)%node(k))
          has_joint(b) = .true.
          if (last(j)%status(p) /= state_open) is_touched(b) = .true.
        end do
      end do
    end do
    is_apart = has_joint(1:) .and. .not. is_touched(1:)
  end function blocks_apart

  !> A motion that no joint resists and no load drives; '' for none.
  function idle_motion(model, task) result(text)
    type(problem), intent(in) :: model
    type(block_task), intent(in) :: task
    character(:), allocatable :: text
    real(rk), allocatable :: directions(:, :), shares(:), own(:, :), motion(:, :)
    type(error_type), allocatable :: error
    integer :: b
    text = ''
    call null_space(matmul(task%rows, transpose(task%rows)), directions, error)
    if (allocated(error)) then
      text = '; the check for blocks that are free to move failed: '//error%message
      return
    end if
    if (size(directions, 2) == 0) return
    directions = matmul(task%free, directions)
    shares = [(sum(directions(6*b - 5:6*b, :)**2), b=1, task%blocks%num_blocks)]
    b = maxloc(shares, 1)
    own = directions(6*b - 5:6*b, :)
    call find_modes(matmul(own, transpose(own)), shares, motion, error)
    if (allocated(error)) then
      text = '; '//block_name(model, task%blocks, b)//' can move without resistance; add a support'
      return
    end if
    motion = motion(:, findloc(shares > no_force, .true., 1):)
    text = '; '//block_name(model, task%blocks, b)//' can '// &
           freedom_text(task%blocks, b, motion)//' without resistance; add a support'
  end function idle_motion

  !> The motion that the loads drive and that joints at their limit do not resist.
  function driven_motion(task, best, load) result(motion)
    type(block_task), intent(in) :: task
    type(best_forces), intent(in) :: best
    real(rk), intent(in) :: load(:) !< (motions)
    real(rk) :: motion(size(load))
    real(rk), allocatable :: matrix(:, :), directions(:, :)
    real(rk) :: largest, shear
    type(error_type), allocatable :: error
    integer :: p, i, num_held
    allocate (matrix(size(load), size(load)), source=0.0_rk)
    largest = maxval(abs(best%force))
    motion = best%mechanism
    if (.not. largest > 0.0_rk) return
    do p = 1, size(task%limits)
      associate (f => best%force(:, p), now => task%limits(p))
        shear = norm2(f(2:3))
        num_held = 3
        if (.not. now%is_bonded) then
          if (shear >= (1.0_rk - at_limit)*(now%cohesion - now%friction*f(1))) num_held = 1
          if (norm2(f) <= no_force*largest) num_held = 0
        end if
      end associate
      do i = 1, num_held
        associate (row => task%rows(:, row_of(p, i)))
          matrix = matrix + spread(row, 2, size(row))*spread(row, 1, size(row))
        end associate
      end do
    end do
    call null_space(matrix, directions, error)
    if (allocated(error)) then
      motion = best%mechanism
      return
    end if
    motion = matmul(directions, matmul(load, directions))
    if (norm2(motion) <= no_force*norm2(load)) motion = best%mechanism
  end function driven_motion
end module free_blocks
