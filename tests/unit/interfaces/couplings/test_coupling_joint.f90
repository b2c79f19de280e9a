!> Joints between two surfaces: their points, axes, clearances, and what is drawn of them.
program test_coupling_joint
  use coupling_joint, only: lay_gauss_points, lay_node_points
  use dam_mesh, only: fe_mesh
  use element_joint8, only: build_joint_points
  use errors, only: error_type
  use face_pairs, only: add_sheet, bent, parts, two_faces
  use facet_segments, only: find_segments
  use joint_points, only: dam_joint
  use kinds, only: rk
  use small_matrix, only: cross_product
  use testing, only: check, check_close, test_log
  implicit none

  !> Round-off of sums of some hundred products; the quadrature leaves 1e-14.
  real(rk), parameter :: round_off = 1.0e-12_rk
  integer, parameter :: size_of_pair = 31 !< nodes of lay_faces
  type(test_log) :: log

  log%suite = 'coupling_joint'
  call nodes_stand_on_the_master(log)
  call equal_meshes_are_joint8(log)
  call shared_nodes_hold_together(log)
  call tied_nodes_leave_their_share(log)
  call gauss_points_share_the_area(log)
  call gauss_points_hold_quarters(log)
  call gauss_points_know_no_first_corner(log)
  call cells_draw_the_face(log)
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> The slave with 3 x 3 facets below, the master with 4 x 2 above it by `gap`.
  subroutine lay_faces(gap, pair)
    real(rk), intent(in) :: gap !< [m]
    type(two_faces), intent(out) :: pair
    allocate (pair%x(3, 0))
    call add_sheet(parts(3, 1.0_rk), parts(3, 2.0_rk), .false., pair%x, pair%slave)
    call add_sheet(parts(4, 1.0_rk), parts(2, 1.0_rk), .true., pair%x, pair%master)
    pair%x(3, 17:) = gap
    call find_segments(pair%x, pair%slave, pair%master, pair%segments, pair%cover)
  end subroutine lay_faces

  subroutine nodes_stand_on_the_master(log)
    type(test_log), intent(inout) :: log
    type(two_faces) :: pair
    type(dam_joint) :: built, measured
    logical, allocatable :: is_bare(:)
    integer :: p
    logical :: is_right
    call lay_faces(0.01_rk, pair)
    call lay_node_points(pair%x, pair%slave, pair%master, pair%segments, none(pair), &
                         .false., built, is_bare)
    call check(log, built%num_points == 16, 'one point a node')
    call check(log, built%is_nodal .and. .not. built%is_matching, 'at nodes of surfaces')
    call check(log, all(built%first_master == built%first(:16) + 1), 'one slave node a point')
    call check(log, all(abs(built%weight(built%first(:16)) - 1.0_rk) <= 0.0_rk), 'with weight 1')
    is_right = .true.
    do p = 1, 16
      is_right = is_right .and. &
                 abs(sum(built%weight(built%first(p):built%first(p + 1) - 1))) < round_off
    end do
    call check(log, is_right, 'weights add up to zero')
    call check(log, all(abs(built%rotation(1, 3, :) + 1.0_rk) < round_off), &
               'normals out of the master')
    call check_close(log, sum(built%area), 1.0_rk, round_off, 'whole area')
    call check(log, all(abs(built%clearance) <= 0.0_rk), 'faces count as touching')
    call check(log, count(is_bare) == 0, 'all covered')
    call check_close(log, maxval(built%admissible_slip), 0.25_rk, round_off, &
                     'admissible slip: the master facets are shorter')
    call lay_node_points(pair%x, pair%slave, pair%master, pair%segments, none(pair), &
                         .true., measured, is_bare)
    call check_close(log, maxval(abs(measured%clearance - 0.01_rk)), 0.0_rk, round_off, &
                     'distance as meshed')
  end subroutine nodes_stand_on_the_master

  !> On two faces of one mesh the points are those of JOINT8 elements between them.
  subroutine equal_meshes_are_joint8(log)
    type(test_log), intent(inout) :: log
    type(two_faces) :: pair
    type(fe_mesh) :: mesh
    type(dam_joint) :: built, elements
    type(error_type), allocatable :: error
    logical, allocatable :: is_bare(:)
    integer :: p, q, e
    logical :: is_right
    allocate (pair%x(3, 0))
    call add_sheet(parts(2, 3.0_rk), parts(2, 1.0_rk), .false., pair%x, pair%slave)
    call add_sheet(parts(2, 3.0_rk), parts(2, 1.0_rk), .true., pair%x, pair%master)
    pair%x = bent(pair%x, 'rotated')
    call find_segments(pair%x, pair%slave, pair%master, pair%segments, pair%cover)
    call lay_node_points(pair%x, pair%slave, pair%master, pair%segments, none(pair), &
                         .false., built, is_bare)
    mesh%num_nodes = 18
    mesh%num_elements = 4
    mesh%x = pair%x
    mesh%nodes = reshape([(pair%master%node(:, e), pair%master%node(:, e) - 9, e=1, 4)], [8, 4])
    mesh%element_type = spread('JOINT8  ', 1, 4)
    mesh%node_id = [(p, p=1, 18)]
    mesh%element_id = [1, 2, 3, 4]
    call build_joint_points(mesh, [1, 2, 3, 4], .true., elements, error)
    call check(log, built%num_points == 9 .and. elements%num_points == 9, 'a point a pair')
    is_right = .true.
    do p = 1, 9
      do q = 1, 9
        if (built%node(built%first(p)) == elements%node(elements%first(q))) exit
      end do
      is_right = is_right .and. built%node(built%first_master(p)) &
                 == elements%node(elements%first_master(q))
      is_right = is_right .and. abs(built%area(p) - elements%area(q)) < 144.0_rk*round_off
      is_right = is_right .and. maxval(abs(built%rotation(:, :, p) - elements%rotation(:, :, q))) &
                 < round_off
      is_right = is_right .and. maxval(abs(built%x(:, p) - elements%x(:, q))) < 40.0_rk*round_off
    end do
    call check(log, is_right, 'masters, areas, axes and places of JOINT8')
  end subroutine equal_meshes_are_joint8

  !> Two blocks that share the nodes of an edge: no point there, and its nodes among the masters.
  subroutine shared_nodes_hold_together(log)
    type(test_log), intent(inout) :: log
    type(two_faces) :: pair
    type(dam_joint) :: built
    logical, allocatable :: is_bare(:)
    real(rk) :: force(16), expected(16)
    integer :: p, k
    allocate (pair%x(3, 0))
    call add_sheet(parts(1, 1.0_rk), parts(3, 1.0_rk), .false., pair%x, pair%slave)
    call add_sheet(parts(1, 1.0_rk), parts(3, 1.0_rk), .true., pair%x, pair%master)
    pair%master%node = merge(pair%master%node - 8, pair%master%node, pair%master%node <= 10)
    call find_segments(pair%x, pair%slave, pair%master, pair%segments, pair%cover)
    call lay_node_points(pair%x, pair%slave, pair%master, pair%segments, none(pair), &
                         .false., built, is_bare)
    call check(log, built%num_points == 6, 'points of the free nodes')
    call check(log, all(built%node(built%first(:6)) > 2), 'none where both faces have the node')
    force = 0.0_rk
    do p = 1, 6
      do k = built%first(p), built%first(p + 1) - 1
        force(built%node(k)) = force(built%node(k)) + built%area(p)*built%weight(k)
      end do
    end do
    expected = [0, 0, 2, 2, 2, 2, 1, 1, 0, 0, -2, -2, -2, -2, -1, -1]/12.0_rk
    call check_close(log, maxval(abs(force - expected)), 0.0_rk, round_off, &
                     'the edge takes its part of a pressure itself')
  end subroutine shared_nodes_hold_together

  !> Nodes that follow others by a tie have no point; the points beside them see them, so that a
  !> constant traction still puts int N dA on every node, and a uniform opening reads as it is.
  subroutine tied_nodes_leave_their_share(log)
    type(test_log), intent(inout) :: log
    type(two_faces) :: pair
    type(dam_joint) :: free, beside
    logical, allocatable :: is_bare(:), is_tied(:)
    real(rk) :: expected(size_of_pair), force(size_of_pair), jump, field
    integer :: p, k
    call lay_faces(0.0_rk, pair)
    is_tied = none(pair)
    is_tied(1:4) = .true.
    call lay_node_points(pair%x, pair%slave, pair%master, pair%segments, none(pair), .false., &
                         free, is_bare)
    call lay_node_points(pair%x, pair%slave, pair%master, pair%segments, is_tied, .false., &
                         beside, is_bare)
    call check(log, beside%num_points == 12, 'no points at tied nodes')
    call unit_traction(free, expected)
    call unit_traction(beside, force)
    call check_close(log, maxval(abs(force - expected)), 0.0_rk, round_off, 'forces on all nodes')
    jump = 0.0_rk
    field = 0.0_rk
    do p = 1, beside%num_points
      jump = max(jump, abs(sum(beside%weight(beside%first(p):beside%first_master(p) - 1)) - 1.0_rk))
      field = max(field, abs(sum([(beside%weight(k)*linear(pair%x(:, beside%node(k))), &
                                   k=beside%first(p), beside%first(p + 1) - 1)])))
    end do
    call check_close(log, jump, 0.0_rk, round_off, 'uniform opening')
    call check_close(log, field, 0.0_rk, round_off, 'linear field on both faces')
  end subroutine tied_nodes_leave_their_share

  !> Forces of a unit traction on the nodes [m2].
  pure subroutine unit_traction(built, force)
    type(dam_joint), intent(in) :: built
    real(rk), intent(out) :: force(:) !< (nodes)
    integer :: p, k
    force = 0.0_rk
    do p = 1, built%num_points
      do k = built%first(p), built%first(p + 1) - 1
        force(built%node(k)) = force(built%node(k)) + built%area(p)*built%weight(k)
      end do
    end do
  end subroutine unit_traction

  pure real(rk) function linear(x) result(value)
    real(rk), intent(in) :: x(3)
    value = 0.3_rk + 0.7_rk*x(1) - 1.1_rk*x(2)
  end function linear

  !> No node follows others.
  pure function none(pair) result(is_tied)
    type(two_faces), intent(in) :: pair
    logical, allocatable :: is_tied(:)
    allocate (is_tied(size(pair%x, 2)), source=.false.)
  end function none

  subroutine gauss_points_share_the_area(log)
    type(test_log), intent(inout) :: log
    type(two_faces) :: pair
    type(dam_joint) :: built
    real(rk), allocatable :: force(:)
    integer :: p, k
    call lay_faces(0.01_rk, pair)
    call lay_gauss_points(pair%x, pair%slave, pair%master, pair%segments, .true., built)
    call check(log, built%num_points == 4*pair%segments%num_segments, 'four points a segment')
    call check(log, built%is_nodal .eqv. .false., 'between nodes')
    call check_close(log, sum(built%area), 1.0_rk, round_off, 'whole area')
    call check_close(log, maxval(abs(built%clearance - 0.01_rk)), 0.0_rk, round_off, 'distance')
    call check(log, all(abs(built%rotation(1, 3, :) + 1.0_rk) < round_off), &
               'normals out of the master')
    allocate (force(size(pair%x, 2)), source=0.0_rk)
    do p = 1, built%num_points
      do k = built%first(p), built%first(p + 1) - 1
        force(built%node(k)) = force(built%node(k)) + built%area(p)*built%weight(k)
      end do
    end do
    call check_close(log, force(1), parts_area(parts(3, 1.0_rk), parts(3, 2.0_rk)), round_off, &
                     'int N_a dA at a corner of the slave')
    call check_close(log, force(17), -parts_area(parts(4, 1.0_rk), parts(2, 1.0_rk)), round_off, &
                     'int N_m dA at a corner of the master')
  end subroutine gauss_points_share_the_area

  !> One facet of 2 x 1 m on its like: quarters, whichever corner comes first.
  subroutine gauss_points_hold_quarters(log)
    type(test_log), intent(inout) :: log
    type(two_faces) :: pair
    type(dam_joint) :: built
    integer :: first
    allocate (pair%x(3, 0))
    call add_sheet(parts(1, 2.0_rk), parts(1, 1.0_rk), .false., pair%x, pair%slave)
    call add_sheet(parts(1, 2.0_rk), parts(1, 1.0_rk), .true., pair%x, pair%master)
    pair%x(1, :) = 2.0_rk*pair%x(1, :)
    do first = 1, 4
      pair%slave%node = cshift(pair%slave%node, 1, dim=1)
      call lay_points(pair, built)
      call check(log, built%num_points == 4, 'four points')
      call check_close(log, maxval(abs(built%area - 0.5_rk)), 0.0_rk, round_off, 'quarters')
      call check_close(log, maxval(abs(abs(built%x(1, :) - 1.0_rk) - 0.5_rk)), 0.0_rk, round_off, &
                       'their middles along x')
      call check_close(log, maxval(abs(abs(built%x(2, :) - 0.5_rk) - 0.25_rk)), 0.0_rk, round_off, &
                       'their middles along y')
    end do
  end subroutine gauss_points_hold_quarters

  !> Facets of any shape, warped ones and triangles among them: the points do not depend on the
  !> corners at which slave and master facets begin.
  subroutine gauss_points_know_no_first_corner(log)
    type(test_log), intent(inout) :: log
    type(two_faces) :: pair
    type(dam_joint) :: built, turned
    integer :: first, shape
    do shape = 1, 3
      call lay_faces(0.0_rk, pair)
      if (shape > 1) then
        pair%x(1, :) = pair%x(1, :) + 0.1_rk*pair%x(1, :)*pair%x(2, :)
        pair%x(3, :) = 0.3_rk*pair%x(1, :)*pair%x(2, :)
      end if
      if (shape == 3) pair%slave%node(4, :) = pair%slave%node(3, :)
      call lay_points(pair, built)
      do first = 2, 4
        pair%slave%node = cshift(pair%slave%node, 1, dim=1)
        if (mod(first, 2) == 0) pair%master%node = cshift(pair%master%node, 1, dim=1)
        call lay_points(pair, turned)
        call check(log, turned%num_points == built%num_points, 'as many points')
        call check_close(log, difference(built, turned), 0.0_rk, round_off, 'the same points')
      end do
    end do
  end subroutine gauss_points_know_no_first_corner

  subroutine lay_points(pair, built)
    type(two_faces), intent(inout) :: pair
    type(dam_joint), intent(out) :: built
    call find_segments(pair%x, pair%slave, pair%master, pair%segments, pair%cover)
    call lay_gauss_points(pair%x, pair%slave, pair%master, pair%segments, .true., built)
  end subroutine lay_points

  !> The largest difference of places, areas, distances and normals; points in any order.
  pure real(rk) function difference(a, b)
    type(dam_joint), intent(in) :: a, b
    integer :: p, q
    difference = 0.0_rk
    do p = 1, a%num_points
      q = minloc(norm2(b%x - spread(a%x(:, p), 2, b%num_points), dim=1), dim=1)
      difference = max(difference, maxval(abs(a%x(:, p) - b%x(:, q))), &
                       abs(a%area(p) - b%area(q)), abs(a%clearance(p) - b%clearance(q)), &
                       maxval(abs(a%rotation(1, :, p) - b%rotation(1, :, q))))
    end do
  end function difference

  !> A quarter of the first facet.
  pure real(rk) function parts_area(s, t) result(area)
    real(rk), intent(in) :: s(:), t(:)
    area = 0.25_rk*s(2)*t(2)
  end function parts_area

  !> The polygons fill the face, turn about the joint's normal, and their corners lie on it.
  subroutine cells_draw_the_face(log)
    type(test_log), intent(inout) :: log
    type(two_faces) :: pair
    type(dam_joint) :: built
    logical, allocatable :: is_bare(:)
    real(rk) :: corner(3, 12), area
    integer :: c, i, k, n
    call lay_faces(0.0_rk, pair)
    call lay_node_points(pair%x, pair%slave, pair%master, pair%segments, none(pair), &
                         .false., built, is_bare)
    area = 0.0_rk
    associate (cells => built%cells)
      do c = 1, size(cells%element)
        n = 0
        do i = cells%first(c), cells%first(c + 1) - 1
          n = n + 1
          corner(:, n) = 0.0_rk
          do k = cells%first_node(cells%corner(i)), cells%first_node(cells%corner(i) + 1) - 1
            corner(:, n) = corner(:, n) + cells%weight(k)*pair%x(:, cells%node(k))
          end do
        end do
        do i = 3, n
          area = area + 0.5_rk*dot_product(built%rotation(1, :, 1), &
                                           cross_product(corner(:, i - 1) - corner(:, 1), &
                                                         corner(:, i) - corner(:, 1)))
        end do
      end do
    end associate
    call check_close(log, area, 1.0_rk, round_off, 'area of the cells, about the normal')
  end subroutine cells_draw_the_face
end program test_coupling_joint
