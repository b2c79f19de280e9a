!> Bodies and the rigid motions that supports leave.
program test_body_parts
  use body_parts, only: find_bodies, free_motion
  use dam_mesh, only: fe_mesh
  use kinds, only: rk
  use row_tables, only: row_table
  use testing, only: check, check_text, test_log
  implicit none
  type(test_log) :: log
  real(rk), parameter :: corner(3, 4) = reshape(real([0, 0, 0, 2, 0, 0, 0, 3, 0, 0, 0, 5], rk), &
                                                [3, 4])
  log%suite = 'body_parts'
  call finds_bodies()
  call check_text(log, free_motion(corner(:, [1, 1, 1, 2, 2, 3]), [1, 2, 3, 2, 3, 3]), '', &
                  'six good supports hold a body')
  call check_text(log, free_motion(corner(:, [1, 1, 1, 2, 2]), [1, 2, 3, 2, 3]), 'turn', &
                  'five supports leave a rotation')
  call check_text(log, free_motion(corner(:, [1, 1, 1, 2, 2, 2]), [1, 2, 3, 1, 2, 3]), 'turn', &
                  'two hinges leave the rotation about their line')
  call check_text(log, free_motion(corner, [3, 3, 3, 3]), 'move along x, y', &
                  'rollers leave two translations')
  call check_text(log, free_motion(corner(:, :0), [integer ::]), 'move along x, y, z', &
                  'nothing holds a free body')
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> Three elements, the first and the last of which share a node.
  subroutine finds_bodies()
    type(fe_mesh) :: mesh
    type(row_table) :: groups
    integer, allocatable :: body(:), example(:)
    integer :: i
    mesh%num_nodes = 24
    mesh%num_elements = 3
    mesh%nodes = reshape([(i, i=8, 1, -1), (i, i=9, 16), (i, i=16, 23)], [8, 3])
    mesh%nodes(1, 3) = 3
    allocate (groups%first(1), groups%item(0))
    groups%first(1) = 1
    call find_bodies(mesh, groups, body, example)
    call check(log, all(example == [1, 2]), 'two bodies')
    call check(log, all(body(1:8) == 1) .and. all(body(17:23) == 1), 'one by a shared node')
    call check(log, all(body(9:16) == 2), 'the other')
    call check(log, body(24) == 0, 'a node without an element belongs to none')
    groups%first = [1, 3, 7]
    groups%item = [24, 1, 24, 12, 13, 14]
    call find_bodies(mesh, groups, body, example)
    call check(log, all(example == [1, 2]) .and. body(24) == 0, 'nothing hangs on an unused node')
    groups%item = [1, 2, 24, 12, 13, 20]
    call find_bodies(mesh, groups, body, example)
    call check(log, size(example) == 1 .and. all(body(:23) == 1), 'a group joins bodies')
  end subroutine finds_bodies
end program test_body_parts
