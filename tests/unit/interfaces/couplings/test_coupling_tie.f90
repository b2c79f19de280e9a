!> Which nodes of a slave face follow the master face, in which directions, and what they follow.
program test_coupling_tie
  use coupling_tie, only: find_bound, build_tie_rows
  use dam_mesh, only: node_tie
  use errors, only: error_type
  use facet_segments, only: find_segments
  use kinds, only: rk
  use surface_segments, only: facet_set, segment_set, surface_cover
  use testing, only: check, check_close, test_log
  use tie_motion, only: follow_ties
  use two_faces, only: even_lines, graded_lines, grid_face
  implicit none
  type(test_log) :: log

  !> Of sums of some hundred products, and of the inverse of a facet's mass matrix.
  real(rk), parameter :: round_off = 1.0e-12_rk

  log%suite = 'coupling_tie'
  call all_nodes_follow()
  call supports_take_directions()
  call earlier_ties_and_shared_nodes()
  call round_a_line()
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> A slave face of 4 x 3 facets, nodes 1..20, on a master face of 3 x 5, nodes 21..44.
  subroutine make_faces(x, slave, master)
    real(rk), allocatable, intent(out) :: x(:, :)
    type(facet_set), intent(out) :: slave, master
    call grid_face(even_lines(4, 0.0_rk, 1.0_rk), graded_lines(3, 2.0_rk), 0.0_rk, .true., x, slave)
    call grid_face(graded_lines(3, 0.4_rk), even_lines(5, 0.0_rk, 1.0_rk), 0.0_rk, .false., x, &
                   master)
  end subroutine make_faces

  !> Lays a tie between faces.
  subroutine tie_faces(x, slave, master, is_fixed, earlier, tie)
    real(rk), intent(in) :: x(:, :)
    type(facet_set), intent(in) :: slave, master
    logical, intent(in) :: is_fixed(:, :)
    type(node_tie), intent(in) :: earlier(:)
    type(node_tie), intent(out) :: tie
    type(segment_set) :: segments
    type(surface_cover) :: cover
    logical, allocatable :: is_bare(:)
    call find_segments(x, slave, master, segments, cover)
    call build_tie_rows(x, slave, master, segments, is_fixed, earlier, tie, is_bare)
  end subroutine tie_faces

  !> How often each node follows in each direction.
  pure function times_tied(tie, num_nodes) result(times)
    type(node_tie), intent(in) :: tie
    integer, intent(in) :: num_nodes
    integer :: times(3, num_nodes)
    integer :: k
    times = 0
    do k = 1, size(tie%node)
      times(:, tie%node(k)) = times(:, tie%node(k)) + merge(1, 0, tie%is_tied(:, k))
    end do
  end function times_tied

  !> A motion that is linear in space agrees with ties, given at the nodes that follow nothing.
  subroutine check_linear(x, ties, what)
    real(rk), intent(in) :: x(:, :)
    type(node_tie), intent(in) :: ties(:)
    character(*), intent(in) :: what
    type(error_type), allocatable :: error
    real(rk) :: exact(3, size(x, 2)), u(3, size(x, 2))
    integer :: t
    exact = matmul(reshape([1.0_rk, 2.0_rk, 3.0_rk, -1.0_rk, 0.5_rk, 2.0_rk, 4.0_rk, 1.0_rk, &
                            -2.0_rk], [3, 3]), x) + 0.3_rk
    u = exact
    do t = 1, size(ties)
      where (times_tied(ties(t), size(x, 2)) > 0) u = 1.0e3_rk
    end do
    call follow_ties(ties, u, error)
    call check(log, allocated(error) .eqv. .false., what//': no circle')
    call check_close(log, maxval(abs(u - exact)), 0.0_rk, 10.0_rk*round_off, &
                     what//': linear fields')
  end subroutine check_linear

  subroutine all_nodes_follow()
    real(rk), allocatable :: x(:, :)
    type(facet_set) :: slave, master
    type(node_tie) :: none(0), ties(1)
    logical :: is_fixed(3, 44)
    call make_faces(x, slave, master)
    is_fixed = .false.
    is_fixed(:, 30) = .true. ! a node of the master may be held
    call tie_faces(x, slave, master, is_fixed, none, ties(1))
    call check(log, size(ties(1)%node) == 20 .and. all(ties(1)%is_tied), 'one row for each node')
    call check(log, all(ties(1)%item > 20), 'which follows nodes of the master')
    call check_linear(x, ties, 'nothing held')
  end subroutine all_nodes_follow

  subroutine supports_take_directions()
    real(rk), allocatable :: x(:, :)
    type(facet_set) :: slave, master
    type(node_tie) :: none(0), ties(1)
    logical :: is_fixed(3, 44)
    integer :: times(3, 44), k
    call make_faces(x, slave, master)
    is_fixed = .false.
    is_fixed(:, 1:5) = .true.
    is_fixed(2, [6, 10, 13]) = .true.
    call tie_faces(x, slave, master, is_fixed, none, ties(1))
    times = times_tied(ties(1), 44)
    call check(log, all((times(:, :20) == 1) .eqv. .not. is_fixed(:, :20)), &
               'free directions follow, once, held ones do not')
    call check(log, all(times(:, 21:) == 0), 'nor the master')
    do k = 1, size(ties(1)%node)
      associate (followed => ties(1)%item(ties(1)%first(k):ties(1)%first(k + 1) - 1))
        if (any(followed <= 20 .and. followed /= ties(1)%node(k))) exit
      end associate
    end do
    call check(log, k <= size(ties(1)%node), 'neighbours of held nodes follow these too')
    call check_linear(x, ties, 'some held')
    is_fixed(3, :20) = .true.
    call tie_faces(x, slave, master, is_fixed, none, ties(1))
    times = times_tied(ties(1), 44)
    call check(log, all((times(:, :20) == 1) .eqv. .not. is_fixed(:, :20)), &
               'a direction that is held everywhere is not tied')
  end subroutine supports_take_directions

  subroutine earlier_ties_and_shared_nodes()
    real(rk), allocatable :: x(:, :)
    type(facet_set) :: slave, master
    type(node_tie) :: before(2)
    logical :: is_fixed(3, 44), is_bound(44)
    integer :: k
    call make_faces(x, slave, master)
    is_fixed = .false.
    ! Node 1 follows node 44 along y and z; what the master's node 21 follows includes node 2, by
    ! node 30.
    before(1)%node = [1, 21]
    before(1)%is_tied = reshape([.false., .true., .true., .true., .true., .true.], [3, 2])
    before(1)%first = [1, 2, 3]
    before(1)%item = [44, 30]
    before(1)%weight = [1.0_rk, 1.0_rk]
    before(2)%node = [30]
    before(2)%is_tied = reshape([.true., .true., .false.], [3, 1])
    before(2)%first = [1, 3]
    before(2)%item = [2, 44]
    before(2)%weight = [0.5_rk, 0.5_rk]
    master%node = merge(5, master%node, master%node == 44)
    call find_bound(1, slave, master, is_fixed(1, :), before, is_bound)
    call check(log, all(pack([(k, k=1, 44)], is_bound) == [2, 5]), &
               'a node that the master follows, and one that both faces have')
    call find_bound(2, slave, master, is_fixed(2, :), before, is_bound)
    call check(log, all(pack([(k, k=1, 44)], is_bound) == [1, 2, 5]), 'a node that follows others')
    call find_bound(3, slave, master, is_fixed(3, :), before, is_bound)
    call check(log, all(pack([(k, k=1, 44)], is_bound) == [1, 5]), 'each direction by itself')
  end subroutine earlier_ties_and_shared_nodes

  !> Four faces round a line, each the slave of the next one: the last is the master of the first.
  subroutine round_a_line()
    real(rk), allocatable :: x(:, :)
    type(facet_set) :: here(4), there(4)
    type(node_tie) :: ties(4)
    logical, allocatable :: is_fixed(:, :)
    integer, allocatable :: times(:, :)
    integer :: t, n(5), a
    ! The node lists of block t's two faces share the line x = 0: built as separate faces first.
    do t = 1, 4
      call grid_face(even_lines(2, 0.0_rk, 1.0_rk), even_lines(t + 1, 0.0_rk, 1.0_rk), 0.0_rk, &
                     .true., x, here(t))
      call grid_face(even_lines(3, 0.0_rk, 1.0_rk), even_lines(t + 1, 0.0_rk, 1.0_rk), 0.0_rk, &
                     .false., x, there(t))
    end do
    ! Nodes at x = 0 of the second face of a block are those of its first.
    n(1) = 0
    do t = 1, 4
      n(t + 1) = n(t) + (3 + 4)*(t + 2)
      do a = 0, t + 1
        where (there(t)%node == n(t) + 3*(t + 2) + 4*a + 1) there(t)%node = n(t) + 3*a + 1
      end do
    end do
    allocate (is_fixed(3, size(x, 2)), source=.false.)
    do t = 1, 4
      call tie_faces(x, here(t), there(1 + mod(t, 4)), is_fixed, ties(:t - 1), ties(t))
    end do
    call check_linear(x, ties, 'four in a ring')
    times = times_tied(ties(4), size(x, 2))
    call check(log, all(times(1, n(4) + 3*[0, 1, 2, 3, 4, 5] + 1) == 0), &
               'the last ones on the line do not follow')
    call check(log, size(ties(4)%node) == 12, 'the others do')
  end subroutine round_a_line
end program test_coupling_tie
