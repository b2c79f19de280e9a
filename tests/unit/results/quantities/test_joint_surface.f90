!> Joints as the results see them: what is drawn on which corner, which points lie on a face of the
!> dam, openings on nodes, faces that are no free surface. Scenes are made by hand.
program test_joint_surface
  use coupling_tie, only: exact_tie
  use dam_mesh, only: surface
  use kinds, only: rk
  use analysis_state, only: state
  use covered_faces, only: mark_joined
  use dam_faces, only: dam_skin
  use element_joint8, only: build_joint_points
  use errors, only: error_type
  use joint_contraction, only: contraction_law
  use joint_points, only: dam_joint
  use joint_readings, only: joint_record, open_joint_record, opening_at_nodes
  use field_table, only: find_field, list_fields
  use field_type, only: result_field
  use joint_surface, only: drawn_joints, joint_values, find_drawn_joints, means_on_corners, &
                           heaviest_on_corners, nodes_to_corners
  use mesh_faces, only: find_exterior
  use problem_definition, only: problem
  use testing, only: test_log, check, check_close
  implicit none
  character(10), parameter :: shown(4) = ['OPENING   ', 'SLIP      ', 'TRACTION  ', 'REACH_USED']
  integer, parameter :: num_values = 7 !< components of the fields above
  real(rk), parameter :: roundoff = 1.0e-15_rk !< of sums of a few numbers of order 1
  type(test_log) :: log
  log%suite = 'joint_surface'
  call a_kink_shows_each_plane(log)
  call gauss_points_are_means(log)
  call segments_lie_between_slave_nodes(log)
  call slave_nodes_decide_on_faces(log)
  call masters_show_means(log)
  call joined_faces_are_covered(log)
  call a_key_covers_three_faces(log)
  print '(i0,a,i0,a)', log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> Two JOINT8 elements over the edge of a cube, in the planes x = 0 and z = 1; nodes 7-12 slave.
  subroutine make_kink(model, is_nodal)
    type(problem), intent(out) :: model
    logical, intent(in) :: is_nodal
    type(error_type), allocatable :: error
    integer :: n
    model%mesh%num_nodes = 12
    model%mesh%num_elements = 2
    model%mesh%x = real(reshape([0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 1, 0, 1, 1, 1, 1, &
                                 0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 1, 0, 1, 1, 1, 1], &
                                [3, 12]), rk)
    model%mesh%nodes = reshape([1, 2, 4, 3, 7, 8, 10, 9, 3, 4, 6, 5, 9, 10, 12, 11], [8, 2])
    model%mesh%element_type = ['JOINT8  ', 'JOINT8  ']
    model%mesh%node_id = [(100 + n, n=1, 12)]
    model%mesh%element_id = [1, 2]
    allocate (model%joints(1), model%guests(0))
    allocate (model%joints(1)%law, source=contraction_law(name='LAW', gap=0.5_rk))
    call build_joint_points(model%mesh, [1, 2], is_nodal, model%joints(1), error)
    if (allocated(error)) error stop 'make_kink'
  end subroutine make_kink

  !> A state in which point p has opened by p, slid by 10 p and 20 p, and is in state mod(p, 4).
  subroutine move_points(model, now)
    type(problem), intent(in) :: model
    type(state), intent(out) :: now
    integer :: p
    allocate (now%joints(1))
    call model%joints(1)%law%start_state(model%joints(1)%clearance, now%joints(1))
    do p = 1, model%joints(1)%num_points
      now%joints(1)%jump(:, p) = [p - 0.5_rk, 10.0_rk*p, 0.0_rk]
      now%joints(1)%slip(:, p) = [10.0_rk*p, 20.0_rk*p]
      now%joints(1)%traction(:, p) = [-1.0_rk*p, 2.0_rk*p, 3.0_rk*p]
      now%joints(1)%status(p) = mod(p, 4)
    end do
    now%u = 2.0_rk*model%mesh%x
  end subroutine move_points

  !> The fields of `shown` on the corners, one below the other.
  subroutine values_on_corners(model, now, drawn, values)
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(drawn_joints), intent(in) :: drawn
    real(rk), intent(out) :: values(:, :) !< (num_values, corners)
    type(result_field), allocatable :: table(:)
    type(joint_values) :: of_joint(1)
    integer :: i, row, width
    call list_fields(table)
    row = 0
    do i = 1, size(shown)
      associate (item => table(find_field(table, trim(shown(i)))))
        width = item%width(model)
        call item%of_joint(model, now, 1, of_joint(1)%at)
        call means_on_corners(drawn, of_joint, values(row + 1:row + width, :))
        row = row + width
      end associate
    end do
  end subroutine values_on_corners

  !> STATE on the corners.
  function states_on_corners(model, now, drawn) result(states)
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(drawn_joints), intent(in) :: drawn
    integer :: states(drawn%num_corners)
    type(result_field), allocatable :: table(:)
    type(joint_values) :: of_joint(1)
    call list_fields(table)
    call table(find_field(table, 'STATE'))%of_joint(model, now, 1, of_joint(1)%at)
    states = heaviest_on_corners(drawn, of_joint)
  end function states_on_corners

  !> Eight corners, since the edge is drawn once for each plane, with the points of that plane.
  subroutine a_kink_shows_each_plane(log)
    type(test_log), intent(inout) :: log
    type(problem) :: model
    type(state) :: now
    type(drawn_joints) :: drawn
    real(rk), allocatable :: values(:, :), u(:, :)
    integer, allocatable :: states(:)
    integer :: c, i, p
    logical :: is_right
    call make_kink(model, is_nodal=.true.)
    call move_points(model, now)
    call find_drawn_joints(model, drawn)
    call check(log, drawn%num_cells == 2 .and. drawn%num_corners == 8, 'two cells, eight corners')
    allocate (values(num_values, drawn%num_corners))
    call values_on_corners(model, now, drawn, values)
    states = states_on_corners(model, now, drawn)
    u = nodes_to_corners(drawn, now%u)
    is_right = .true.
    do c = 1, 2
      do i = drawn%first(c), drawn%first(c + 1) - 1
        p = nint(values(1, drawn%corner(i)))
        associate (item => model%joints(1))
          is_right = is_right .and. all(abs(2.0_rk*item%x(:, p) - u(:, drawn%corner(i))) <= 0.0_rk)
          is_right = is_right .and. abs(item%rotation(1, merge(1, 3, c == 1), p)) > 0.99_rk
        end associate
        is_right = is_right .and. states(drawn%corner(i)) == mod(p, 4)
        is_right = is_right .and. all(abs(values(2:6, drawn%corner(i)) &
                                          - p*[10, 20, -1, 2, 3]) <= roundoff)
      end do
    end do
    call check(log, is_right, 'each corner shows the point of its node in the plane of its cell')
    call check(log, all(abs(values(7, :)) <= 0.0_rk), 'JOINT8 has no admissible slip')
    model%mesh%x(3, [5, 6, 11, 12]) = 6.0_rk
    call remake(model)
    call find_drawn_joints(model, drawn)
    call check(log, drawn%num_corners == 6, 'a bend below 30 degrees is drawn as one surface')
  end subroutine a_kink_shows_each_plane

  !> The joint anew after its nodes have moved.
  subroutine remake(model)
    type(problem), intent(inout) :: model
    type(error_type), allocatable :: error
    call build_joint_points(model%mesh, [1, 2], .true., model%joints(1), error)
    if (allocated(error)) error stop 'remake'
  end subroutine remake

  !> A node shows the mean of its plane's points; a constant stays what it is.
  subroutine gauss_points_are_means(log)
    type(test_log), intent(inout) :: log
    type(problem) :: model
    type(state) :: now
    type(drawn_joints) :: drawn
    real(rk), allocatable :: values(:, :)
    integer :: c
    call make_kink(model, is_nodal=.false.)
    call move_points(model, now)
    now%joints(1)%jump(1, :4) = 1.0_rk ! the gap is 0.5
    now%joints(1)%jump(1, 5:) = 2.0_rk
    call find_drawn_joints(model, drawn)
    allocate (values(num_values, drawn%num_corners))
    call values_on_corners(model, now, drawn, values)
    call check(log, drawn%num_corners == 8, 'the edge is drawn twice')
    do c = 1, 2
      associate (corners => drawn%corner(drawn%first(c):drawn%first(c + 1) - 1))
        call check(log, all(abs(values(1, corners) - (0.5_rk + c)) <= roundoff), &
                   'no value of the other plane')
      end associate
    end do
  end subroutine gauss_points_are_means

  !> Columns of solids on both sides of the plane x = 0, 2 facets along y (master, x < 0) against 3,
  !> 6 m long and 1 m high. Slave nodes 1-8 and master nodes 17-22 lie on the plane, y fastest. The
  !> weights give linear fields exactly and have a negative one, as those of a dual projection.
  subroutine make_columns(model)
    type(problem), intent(out) :: model
    integer :: i, k, e
    allocate (model%mesh%x(3, 28))
    do k = 0, 1
      do i = 0, 3
        model%mesh%x(:, 1 + i + 4*k) = real([0, 2*i, k], rk)
        model%mesh%x(:, 9 + i + 4*k) = real([1, 2*i, k], rk)
      end do
      do i = 0, 2
        model%mesh%x(:, 17 + i + 3*k) = real([0, 3*i, k], rk)
        model%mesh%x(:, 23 + i + 3*k) = real([-1, 3*i, k], rk)
      end do
    end do
    model%mesh%num_nodes = 28
    model%mesh%num_elements = 5
    allocate (model%mesh%nodes(8, 5))
    do e = 1, 3
      model%mesh%nodes(:, e) = e + [0, 8, 9, 1, 4, 12, 13, 5]
    end do
    do e = 1, 2
      model%mesh%nodes(:, 3 + e) = e + [22, 16, 17, 23, 25, 19, 20, 26]
    end do
    model%mesh%element_type = ['C3D8', 'C3D8', 'C3D8', 'C3D8', 'C3D8']
    model%mesh%node_id = [(i, i=1, 28)]
    model%mesh%element_id = [(e, e=1, 5)]
    allocate (model%guests(0), model%joints(1))
    allocate (model%joints(1)%law, source=contraction_law(name='LAW', gap=0.5_rk))
    call lay_points(model%joints(1))
    model%joints(1)%x = model%mesh%x(:, :8)
    call lay_segments(model%joints(1))
  end subroutine make_columns

  !> Rows of the projection: one for each slave node.
  subroutine lay_points(joint)
    type(dam_joint), intent(inout) :: joint
    real(rk), parameter :: c = 0.05_rk
    real(rk) :: row(3, 4)
    integer :: i, k, p
    row = reshape([1.0_rk, 0.0_rk, 0.0_rk, 1/3.0_rk - c, 2/3.0_rk + 2*c, -c, &
                   -c, 2/3.0_rk + 2*c, 1/3.0_rk - c, 0.0_rk, 0.0_rk, 1.0_rk], [3, 4])
    joint%num_points = 8
    joint%is_matching = .false.
    joint%first = [(1 + 4*p, p=0, 8)]
    joint%first_master = joint%first(:8) + 1
    allocate (joint%node(32), joint%weight(32))
    do k = 0, 1
      do i = 1, 4
        p = joint%first(i + 4*k)
        joint%node(p:p + 3) = [i + 4*k, 17 + 3*k, 18 + 3*k, 19 + 3*k]
        joint%weight(p:p + 3) = [1.0_rk, -row(:, i)]
      end do
    end do
    joint%area = [0.5_rk, 1.0_rk, 1.0_rk, 0.5_rk, 0.5_rk, 1.0_rk, 1.0_rk, 0.5_rk]
    joint%clearance = spread(0.0_rk, 1, 8)
    joint%admissible_slip = spread(20.0_rk, 1, 8)
    joint%rotation = spread(reshape(real([1, 0, 0, 0, 1, 0, 0, 0, 1], rk), [3, 3]), 3, 8)
  end subroutine lay_points

  !> Four segments along y, borders at 0, 2, 3, 4, 6: the second facet is cut in its middle. Each
  !> has corners of its own with the four shape functions of its facet, and roundoff in them.
  subroutine lay_segments(joint)
    type(dam_joint), intent(inout) :: joint
    integer, parameter :: facet(4) = [1, 2, 2, 3]
    real(rk), parameter :: start(4) = [0.0_rk, 0.0_rk, 0.5_rk, 0.0_rk]
    real(rk), parameter :: end(4) = [1.0_rk, 0.5_rk, 1.0_rk, 1.0_rk]
    real(rk) :: shape(4, 4)
    integer :: c, k
    joint%cells%first = [1, 5, 9, 13, 17]
    joint%cells%corner = [(k, k=1, 16)]
    joint%cells%element = facet
    joint%cells%first_node = [(4*k + 1, k=0, 16)]
    allocate (joint%cells%node(0), joint%cells%weight(0))
    do c = 1, 4
      shape = 0.0_rk
      shape(1:2, 1) = [1 - start(c), start(c)]
      shape(1:2, 2) = [1 - end(c), end(c)]
      shape(3:4, 3) = [end(c), 1 - end(c)]
      shape(3:4, 4) = [start(c), 1 - start(c)]
      joint%cells%node = [joint%cells%node, (facet(c) + [0, 1, 5, 4], k=1, 4)]
      joint%cells%weight = [joint%cells%weight, shape + 1.0e-14_rk*c]
    end do
  end subroutine lay_segments

  !> Corners between nodes lie and show what lies between.
  subroutine segments_lie_between_slave_nodes(log)
    type(test_log), intent(inout) :: log
    type(problem) :: model
    type(state) :: now
    type(drawn_joints) :: drawn
    real(rk), parameter :: rough = 1.0e-12_rk !< the shape functions are off by 1e-14, times 6 m
    real(rk), allocatable :: values(:, :), x(:, :)
    call make_columns(model)
    call move_points(model, now)
    call find_drawn_joints(model, drawn)
    allocate (values(num_values, drawn%num_corners))
    call values_on_corners(model, now, drawn, values)
    x = nodes_to_corners(drawn, model%mesh%x)
    call check(log, drawn%num_cells == 4 .and. drawn%num_corners == 10, &
               'corners that lie and show alike are one')
    associate (middle => drawn%corner(6)) ! second corner of the second cell
      call check_close(log, x(2, middle), 3.0_rk, rough, 'place between nodes 2 and 3')
      call check_close(log, values(1, middle), 2.5_rk, rough, 'opening there')
      call check_close(log, values(4, middle), -2.5_rk, rough, 'normal traction there')
      call check_close(log, values(7, middle), 25.0_rk/20.0_rk, rough, 'share of slip')
    end associate
  end subroutine segments_lie_between_slave_nodes

  !> Upstream at y = 0, downstream at y = 6: of the fine points only those on the faces, although
  !> the second one leans most on a coarse node in the middle, and a coarse face of 2 facets ends.
  subroutine slave_nodes_decide_on_faces(log)
    type(test_log), intent(inout) :: log
    type(problem) :: model
    type(dam_skin) :: skin
    type(joint_record) :: record
    integer :: n
    call make_columns(model)
    skin%is_upstream = model%mesh%x(2, :) <= 0.0_rk
    skin%is_downstream = model%mesh%x(2, :) >= 6.0_rk
    call open_joint_record(model%joints(1), skin, record)
    call check(log, all(record%is_upstream .eqv. [(mod(n, 4) == 1, n=1, 8)]), 'upstream')
    call check(log, all(record%is_downstream .eqv. [(mod(n, 4) == 0, n=1, 8)]), 'downstream')
    skin%is_upstream(18) = .true. ! master node in the middle, the largest weight of points 2 and 3
    call open_joint_record(model%joints(1), skin, record)
    call check(log, count(record%is_upstream) == 2, 'a coarse master makes no point upstream')
    skin%is_upstream(:8) = .false.
    skin%is_downstream(:8) = .false.
    skin%is_upstream(18) = .false.
    call open_joint_record(model%joints(1), skin, record)
    call check(log, all(record%is_upstream .eqv. [(mod(n, 4) == 1, n=1, 8)]), 'rock as slave')
  end subroutine slave_nodes_decide_on_faces

  !> Slave nodes show their points, masters something between the points that lean on them.
  subroutine masters_show_means(log)
    type(test_log), intent(inout) :: log
    type(problem) :: model
    type(state) :: now
    real(rk), allocatable :: opening(:)
    integer :: n
    call make_columns(model)
    call move_points(model, now)
    opening = opening_at_nodes(model, now)
    call check(log, all(abs(opening(:8) - [(n, n=1, 8)]) <= roundoff), 'slave nodes')
    call check(log, all(opening(17:19) >= 1.0_rk .and. opening(17:19) <= 4.0_rk), 'no overshoot')
    call check_close(log, opening(18), 2.5_rk, 4.0_rk*roundoff, 'the middle')
    ! Shares 0.5 at point 1 and 1/3 - 0.05 at point 2; the negative one of point 3 does not count.
    call check_close(log, opening(17), (0.5_rk + 2.0_rk*(1/3.0_rk - 0.05_rk)) &
                     /(0.5_rk + 1/3.0_rk - 0.05_rk), 4.0_rk*roundoff, 'the edge')
    call check(log, all(abs(opening(23:)) <= 0.0_rk), 'other nodes')
  end subroutine masters_show_means

  !> The five facets on the plane x = 0, by the joint, by a tie, and none without them.
  subroutine joined_faces_are_covered(log)
    type(test_log), intent(inout) :: log
    type(problem) :: model
    type(surface) :: skin
    type(exact_tie) :: tie
    logical, allocatable :: is_covered(:)
    integer :: i
    call make_columns(model)
    call find_exterior(model%mesh, [1, 2, 3, 4, 5], skin)
    call mark_joined(model, skin, is_covered)
    call check(log, count(is_covered) == 5, 'five facets under the joint')
    call check(log, all(pack(skin%face, is_covered .and. skin%element <= 3) == 6), 'S6 of slaves')
    call check(log, all(pack(skin%face, is_covered .and. skin%element > 3) == 4), 'S4 of masters')
    ! Node 2 hangs on others of the slave face: it has no multiplier of its own (a cross point).
    tie%rows%node = [1, 3, 4, 5, 6, 7, 8]
    tie%rows%first = [(1 + 6*i, i=0, 7)]
    tie%rows%item = [2, 18, 19, 20, 21, 22, ([17, 18, 19, 20, 21, 22], i=2, 7)]
    tie%rows%weight = spread(1/6.0_rk, 1, 42)
    deallocate (model%joints)
    allocate (model%joints(0))
    call mark_joined(model, skin, is_covered)
    call check(log, count(is_covered) == 0, 'nothing is covered by nothing')
    deallocate (model%guests)
    allocate (model%guests(1))
    allocate (model%guests(1)%item, source=tie)
    call mark_joined(model, skin, is_covered)
    call check(log, count(is_covered) == 5, 'five facets under the tie')
  end subroutine joined_faces_are_covered

  !> One cube in a groove: a joint round x = 0, z = 0 and x = 1 holds all its nodes, but neither its
  !> ends (y) nor its top are covered.
  subroutine a_key_covers_three_faces(log)
    type(test_log), intent(inout) :: log
    type(problem) :: model
    type(surface) :: skin
    logical, allocatable :: is_covered(:)
    integer, parameter :: axis(12) = [1, 1, 1, 1, 1, 1, 1, 1, 3, 3, 3, 3]
    integer :: p
    model%mesh%num_nodes = 8
    model%mesh%num_elements = 1
    model%mesh%x = real(reshape([0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, &
                                 0, 0, 1, 1, 0, 1, 1, 1, 1, 0, 1, 1], [3, 8]), rk)
    model%mesh%nodes = reshape([1, 2, 3, 4, 5, 6, 7, 8], [8, 1])
    model%mesh%element_type = ['C3D8']
    allocate (model%joints(1), model%guests(0))
    associate (item => model%joints(1))
      item%num_points = 12
      item%is_matching = .false.
      item%node = [1, 2, 3, 4, 5, 6, 7, 8, 1, 2, 3, 4]
      item%first = [(p, p=1, 13)]
      item%first_master = item%first(2:)
      item%weight = spread(1.0_rk, 1, 12)
      item%area = spread(0.25_rk, 1, 12)
      allocate (item%rotation(3, 3, 12), source=0.0_rk)
      do p = 1, 12
        item%rotation(1, axis(p), p) = 1.0_rk
      end do
      item%rotation(1, 1, [2, 3, 6, 7]) = -1.0_rk
    end associate
    call find_exterior(model%mesh, [1], skin)
    call mark_joined(model, skin, is_covered)
    call check(log, all(pack(skin%face, is_covered) == [1, 4, 6]), 'S1, S4 and S6')
  end subroutine a_key_covers_three_faces
end program test_joint_surface
