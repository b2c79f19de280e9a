!> Nodes that follow several others: ties, points of joints on surfaces, chains and circles of both.
program test_jump_links
  use dam_mesh, only: node_tie
  use kinds, only: rk
  use errors, only: error_type
  use testing, only: test_log, check, check_close, check_text
  use node_dofs, only: displacement_dofs
  use dof_numbering, only: numbering, linear_links, number_unknowns
  use jump_links, only: nodal_points, link_nodes
  implicit none
  integer, parameter :: n = 8
  type(test_log) :: log
  log%suite = 'jump_links'
  call wide_point()
  call tie_of_some_directions()
  call chain_of_ties()
  call circles()
  call light_nodes()
  call tie_and_joint()
  call last_unknowns()
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1
contains

  !> Points without masters yet.
  subroutine no_points(points)
    type(nodal_points), intent(out) :: points
    allocate (points%slave(0), points%master(0), points%weight(0), points%rotation(3, 3, 0))
    points%own = [real(rk) ::]
    points%first = [1]
  end subroutine no_points

  !> One more point, its axes turned about e3.
  subroutine add_point(slave, master, weight, points)
    integer, intent(in) :: slave, master(:)
    real(rk), intent(in) :: weight(:)
    type(nodal_points), intent(inout) :: points
    real(rk) :: turned(3, 3)
    turned = reshape([0.6_rk, -0.8_rk, 0.0_rk, 0.8_rk, 0.6_rk, 0.0_rk, 0.0_rk, 0.0_rk, 1.0_rk], &
                     [3, 3])
    points%slave = [points%slave, slave]
    points%master = [points%master, master]
    points%own = [points%own, 1.0_rk]
    points%weight = [points%weight, weight]
    points%first = [points%first, size(points%master) + 1]
    points%rotation = reshape([points%rotation, turned], [3, 3, size(points%slave)])
  end subroutine add_point

  !> A tie of one node in all directions.
  type(node_tie) function tie_of(node, master, weight) result(tie)
    integer, intent(in) :: node, master(:)
    real(rk), intent(in) :: weight(:)
    tie%name = 'T'
    tie%node = [node]
    allocate (tie%is_tied(3, 1), source=.true.)
    tie%first = [1, size(master) + 1]
    tie%item = master
    tie%weight = weight
  end function tie_of

  !> Numbers eight used nodes, and expands unknowns that are all different.
  subroutine number_nodes(points, ties, is_fixed, numbers, q, u)
    type(nodal_points), intent(in) :: points
    type(node_tie), intent(in) :: ties(:)
    logical, intent(in) :: is_fixed(3, n)
    type(numbering), intent(out) :: numbers
    real(rk), allocatable, intent(out) :: q(:)
    real(rk), intent(out) :: u(3, n)
    type(linear_links) :: links
    type(error_type), allocatable :: error
    logical :: is_used(n)
    integer :: k
    is_used = .true.
    call link_nodes(displacement_dofs(n), points, ties, is_used, is_fixed, links, error)
    call check(log, allocated(error) .eqv. .false., 'links')
    call number_unknowns(displacement_dofs(n), is_used, is_fixed, links, numbers, error)
    call check(log, allocated(error) .eqv. .false., 'numbers')
    q = [(sin(real(k, rk)), k=1, numbers%num_total)]
    call numbers%expand(q, u)
  end subroutine number_nodes

  subroutine wide_point()
    type(nodal_points) :: points
    type(node_tie) :: ties(0)
    type(numbering) :: numbers
    real(rk), allocatable :: q(:)
    real(rk) :: u(3, n), d(3)
    logical :: is_fixed(3, n)
    is_fixed = .false.
    is_fixed(2, 3) = .true.
    is_fixed(:, 8) = .true.
    call no_points(points)
    call add_point(1, [4, 5, 6], [0.2_rk, 0.9_rk, -0.1_rk], points)
    call add_point(2, [1, 6], [0.3_rk, 0.7_rk], points) ! follows node 1, which follows
    call add_point(3, [5, 6], [0.5_rk, 0.5_rk], points) ! held
    call add_point(1, [6, 7], [0.5_rk, 0.5_rk], points) ! follows already
    call add_point(7, [6, 8], [0.5_rk, 0.5_rk], points) ! a master may be held
    call number_nodes(points, ties, is_fixed, numbers, q, u)
    call check(log, all((numbers%first_jump > 0) .eqv. &
                        [.true., .true., .false., .false., .true.]), 'which points have jumps')
    d = matmul(points%rotation(:, :, 1), u(:, 1) - 0.2_rk*u(:, 4) - 0.9_rk*u(:, 5) + 0.1_rk*u(:, 6))
    call check_close(log, norm2(d - q(numbers%first_jump(1) + [0, 1, 2])), 0.0_rk, 1.0e-15_rk, &
                     'the jump of a point is its unknown')
    d = matmul(points%rotation(:, :, 2), u(:, 2) - 0.3_rk*u(:, 1) - 0.7_rk*u(:, 6))
    call check_close(log, norm2(d - q(numbers%first_jump(2) + [0, 1, 2])), 0.0_rk, 1.0e-15_rk, &
                     'of a point on a dependent node, too')
    d = matmul(points%rotation(:, :, 5), u(:, 7) - 0.5_rk*u(:, 6) - 0.5_rk*u(:, 8))
    call check_close(log, norm2(d - q(numbers%first_jump(5) + [0, 1, 2])), 0.0_rk, 1.0e-15_rk, &
                     'and of one on a held node')
  end subroutine wide_point

  subroutine tie_of_some_directions()
    type(nodal_points) :: points
    type(node_tie) :: ties(1)
    type(numbering) :: numbers
    real(rk), allocatable :: q(:)
    real(rk) :: u(3, n)
    logical :: is_fixed(3, n)
    is_fixed = .false.
    is_fixed(2, 1) = .true.
    call no_points(points)
    ties(1) = tie_of(1, [4, 5], [0.25_rk, 0.75_rk])
    ties(1)%is_tied(2, 1) = .false.
    call number_nodes(points, ties, is_fixed, numbers, q, u)
    call check(log, numbers%num_total == 3*n - 2 .and. numbers%num_free == 3*n - 3, &
               'two directions follow, one is fixed')
    call check_close(log, u(1, 1), 0.25_rk*u(1, 4) + 0.75_rk*u(1, 5), 1.0e-15_rk, 'x follows')
    call check_close(log, u(2, 1), q(numbers%num_total), 0.0_rk, 'y is prescribed')
  end subroutine tie_of_some_directions

  !> Ties in the wrong order: 1 follows 2, which the next tie lets follow others.
  subroutine chain_of_ties()
    type(nodal_points) :: points
    type(node_tie) :: ties(3)
    type(numbering) :: numbers
    real(rk), allocatable :: q(:)
    real(rk) :: u(3, n)
    logical :: is_fixed(3, n)
    is_fixed = .false.
    call no_points(points)
    ties(1) = tie_of(1, [2, 3], [0.5_rk, 0.5_rk])
    ties(2) = tie_of(2, [3, 4, 5], [0.2_rk, 0.3_rk, 0.5_rk])
    ties(3) = tie_of(5, [3, 6], [0.6_rk, 0.4_rk])
    call number_nodes(points, ties, is_fixed, numbers, q, u)
    call check(log, numbers%num_free == 3*n - 9, 'three nodes follow')
    call check_close(log, norm2(u(:, 5) - 0.6_rk*u(:, 3) - 0.4_rk*u(:, 6)), 0.0_rk, 1.0e-15_rk, &
                     'the last')
    call check_close(log, norm2(u(:, 1) - 0.5_rk*u(:, 2) - 0.5_rk*u(:, 3)), 0.0_rk, 1.0e-15_rk, &
                     'the first')
    call check(log, numbers%row_start(2) == numbers%row_start(1) + 3, &
               'terms that come by two ways are one')
  end subroutine chain_of_ties

  subroutine circles()
    type(nodal_points) :: points
    type(node_tie) :: ties(2), none(0)
    type(numbering) :: numbers
    type(linear_links) :: links
    type(error_type), allocatable :: error
    real(rk), allocatable :: q(:)
    real(rk) :: u(3, n)
    logical :: is_fixed(3, n), is_used(n)
    is_fixed = .false.
    is_used = .true.
    call no_points(points)
    ties(1) = tie_of(1, [2, 3], [0.5_rk, 0.5_rk])
    ties(2) = tie_of(3, [1, 4], [0.5_rk, 0.5_rk])
    call link_nodes(displacement_dofs(n), points, ties, is_used, is_fixed, links, error)
    call check_text(log, error%message, 'degrees of freedom depend on each other in a circle', &
                    'ties in a circle')
    call add_point(1, [2, 3], [0.5_rk, 0.5_rk], points)
    call add_point(3, [4, 5], [0.5_rk, 0.5_rk], points)
    call add_point(5, [6, 1], [0.5_rk, 0.5_rk], points) ! 1 follows 3, which follows 5
    call add_point(6, [6, 1], [0.5_rk, 0.5_rk], points) ! node 6 is on both sides
    call add_point(2, [8], [1.0_rk], points) ! a pair: 2 is a master
    call add_point(1, [4], [1.0_rk], points) ! 1 would have to be the root, and follows 4 by 3
    call add_point(7, [1], [1.0_rk], points) ! 7 follows 1
    call number_nodes(points, none, is_fixed, numbers, q, u)
    call check(log, all((numbers%first_jump > 0) .eqv. &
                        [.true., .true., .false., .false., .true., .false., .true.]), &
               'no jump closes a circle')
  end subroutine circles

  !> A node without mass follows its partner, whichever of the two is the slave.
  subroutine light_nodes()
    type(nodal_points) :: points
    type(node_tie) :: none(0)
    type(numbering) :: numbers
    real(rk), allocatable :: q(:)
    real(rk) :: u(3, n), d(3)
    logical :: is_fixed(3, n)
    integer :: p
    is_fixed = .false.
    call no_points(points)
    call add_point(1, [5], [1.0_rk], points)
    call add_point(6, [2], [1.0_rk], points)
    points%is_light = [(any([5, 6] == p), p=1, n)]
    call number_nodes(points, none, is_fixed, numbers, q, u)
    call check(log, all([(any(numbers%node == p), p=1, 2)]), 'nodes with mass are unknowns')
    do p = 1, 2
      d = matmul(points%rotation(:, :, p), u(:, points%slave(p)) - u(:, points%master(p)))
      call check_close(log, norm2(d - q(numbers%first_jump(p) + [0, 1, 2])), 0.0_rk, 1.0e-15_rk, &
                       'and the jump is')
      call check(log, count(numbers%node == 4 + p) == 3, 'a light node stands for its jump alone')
    end do
  end subroutine light_nodes

  !> Both ends of a joint are tied to a third body; where one is, the other follows it.
  subroutine tie_and_joint()
    type(nodal_points) :: points
    type(node_tie) :: ties(2)
    type(numbering) :: numbers
    real(rk), allocatable :: q(:)
    real(rk) :: u(3, n), d(3)
    logical :: is_fixed(3, n)
    is_fixed = .false.
    ties(1) = tie_of(1, [5, 6], [0.5_rk, 0.5_rk])
    ties(2) = tie_of(2, [6, 7], [0.5_rk, 0.5_rk])
    call no_points(points)
    call add_point(1, [2], [1.0_rk], points)
    call add_point(1, [3], [1.0_rk], points)
    call add_point(2, [4, 8], [0.5_rk, 0.5_rk], points)
    call number_nodes(points, ties, is_fixed, numbers, q, u)
    call check(log, all((numbers%first_jump > 0) .eqv. [.false., .true., .false.]), &
               'a tied node follows nothing else')
    d = matmul(points%rotation(:, :, 2), u(:, 1) - u(:, 3))
    call check_close(log, norm2(d - q(numbers%first_jump(2) + [0, 1, 2])), 0.0_rk, 1.0e-15_rk, &
                     'the other end of a pair follows the tied one')
    call check_close(log, norm2(u(:, 1) - 0.5_rk*u(:, 5) - 0.5_rk*u(:, 6)), 0.0_rk, 1.0e-15_rk, &
                     'which is still tied')
  end subroutine tie_and_joint

  !> What points without jumps see stands in front of the jumps, behind all others.
  subroutine last_unknowns()
    type(nodal_points) :: points
    type(node_tie) :: ties(1)
    type(numbering) :: numbers
    type(linear_links) :: links
    type(error_type), allocatable :: error
    logical :: is_fixed(3, n), is_used(n)
    is_used = .true.
    is_fixed = .false.
    is_fixed(1, 2) = .true.
    call no_points(points)
    call add_point(3, [4, 5], [0.5_rk, 0.5_rk], points)
    ties(1) = tie_of(1, [5, 6], [0.5_rk, 0.5_rk])
    call link_nodes(displacement_dofs(n), points, ties, is_used, is_fixed, links, error)
    allocate (links%is_last(n), source=.false.)
    links%is_last([1, 2]) = .true.
    call number_unknowns(displacement_dofs(n), is_used, is_fixed, links, numbers, error)
    call check(log, numbers%num_jumps == 3 .and. numbers%num_last == 3 + 2 + 6, &
               'a jump, a node with a support, and what a tied node follows')
    call check(log, all(numbers%node(numbers%num_free - 10:numbers%num_free) == &
                        [2, 2, 5, 5, 5, 6, 6, 6, 3, 3, 3]), 'in this order')
    call check_text(log, &
                    numbers%describe(numbers%num_free - 10, [11, 12, 13, 14, 15, 16, 17, 18]), &
                    'node 12, displacement along y', 'a last unknown that is no jump')
  end subroutine last_unknowns
end program test_jump_links
