!> Edges of a joint's face at the water, and how far water gets into a joint.
program test_joint_rim
  use joint_points, only: dam_joint, list_faces
  use joint_rim, only: area_of_facets, distance_to_edges, face_rim, find_rim
  use kinds, only: rk
  use testing, only: check, check_close, test_log
  use water_paths, only: build_paths, find_wet, path_net
  implicit none

  integer, parameter :: along = 4, across = 3 !< facets of the face
  type(test_log) :: log

  log%suite = 'joint_rim'
  call edges_of_a_face(log)
  call triangles_close_their_edges(log)
  call a_face_that_no_water_reaches(log)
  call water_follows_what_is_open(log)
  call points_between_nodes(log)
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> A level face 4 m along the stream, 3 m across, in facets of 1 m; node 1 + i + 5*j at (i, j).
  subroutine level_face(x, facets)
    real(rk), allocatable, intent(out) :: x(:, :)
    integer, allocatable, intent(out) :: facets(:, :)
    integer :: i, j, n
    allocate (x(3, (along + 1)*(across + 1)), facets(4, along*across))
    do j = 0, across
      do i = 0, along
        x(:, 1 + i + (along + 1)*j) = real([i, j, 0], rk)
      end do
    end do
    do j = 1, across
      do i = 1, along
        n = i + (along + 1)*(j - 1)
        facets(:, i + along*(j - 1)) = [n, n + 1, n + along + 2, n + along + 1]
      end do
    end do
  end subroutine level_face

  !> The sides along the stream are neither upstream nor downstream.
  subroutine edges_of_a_face(log)
    type(test_log), intent(inout) :: log
    real(rk), allocatable :: x(:, :)
    integer, allocatable :: facets(:, :)
    type(face_rim) :: rim
    call level_face(x, facets)
    call find_rim(x, facets, x(1, :) < 0.5_rk, rim)
    call check(log, size(rim%upstream, 2) == across, 'three edges upstream')
    call check(log, size(rim%downstream, 2) == across, 'three edges downstream')
    call check_close(log, maxval(abs(x(1, rim%downstream(1, :)) - along)), 0.0_rk, 0.0_rk, &
                     'they lie at the far end')
    call check_close(log, distance_to_edges(x, rim%upstream, [1.5_rk, 0.3_rk, 0.0_rk]), 1.5_rk, &
                     1.0e-15_rk, 'distance to an edge')
    call check_close(log, distance_to_edges(x, rim%upstream, [3.0_rk, -4.0_rk, 0.0_rk]), 5.0_rk, &
                     1.0e-14_rk, 'distance to the end of an edge')
    call check_close(log, area_of_facets(x, facets), 12.0_rk, 1.0e-13_rk, 'area')
  end subroutine edges_of_a_face

  !> A facet with a repeated node has three edges.
  subroutine triangles_close_their_edges(log)
    type(test_log), intent(inout) :: log
    type(face_rim) :: rim
    real(rk) :: x(3, 4)
    x = reshape(real([0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0], rk), [3, 4])
    call find_rim(x, reshape([1, 2, 3, 3, 1, 3, 4, 4], [4, 2]), x(1, :) < 0.5_rk, rim)
    call check(log, size(rim%upstream, 2) == 1 .and. size(rim%downstream, 2) == 1, &
               'the diagonal is no outer edge')
  end subroutine triangles_close_their_edges

  subroutine a_face_that_no_water_reaches(log)
    type(test_log), intent(inout) :: log
    real(rk), allocatable :: x(:, :)
    integer, allocatable :: facets(:, :)
    type(face_rim) :: rim
    call level_face(x, facets)
    call find_rim(x, facets, x(1, :) + x(2, :) < 0.5_rk, rim)
    call check(log, size(rim%upstream) == 0 .and. size(rim%downstream) == 0, &
               'one node is no edge')
  end subroutine a_face_that_no_water_reaches

  !> Points at the nodes: in through the first row, round a closed point, not across a closed row.
  subroutine water_follows_what_is_open(log)
    type(test_log), intent(inout) :: log
    real(rk), allocatable :: x(:, :)
    integer, allocatable :: facets(:, :)
    logical, allocatable :: is_open(:), is_wet(:)
    type(dam_joint) :: joint
    type(path_net) :: net
    integer :: n
    call level_face(x, facets)
    n = size(x, 2)
    call list_faces(reshape([(n, n=1, size(x, 2))], [1, size(x, 2)]), &
                    reshape([(n, n=1, size(x, 2))], [1, size(x, 2)]), &
                    spread(spread(1.0_rk, 1, size(x, 2)), 1, 1), joint)
    joint%is_nodal = .true.
    call build_paths(size(x, 2), joint, facets, x(1, :), net)
    call check(log, all(net%is_inlet .eqv. x(1, :) < 0.5_rk), 'water comes in at the edge')
    allocate (is_open(size(x, 2)), is_wet(size(x, 2)))
    is_open = abs(x(1, :) - 2.0_rk) > 0.5_rk
    call find_wet(net, is_open, is_wet)
    call check(log, all(is_wet .eqv. x(1, :) < 1.5_rk), 'a closed row stops it')
    is_open(2 + along + 2) = .true. ! (2, 1)
    call find_wet(net, is_open, is_wet)
    call check(log, all(is_wet .eqv. is_open), 'a gap in the row lets it through')
    is_open = x(1, :) > 0.5_rk
    call find_wet(net, is_open, is_wet)
    call check(log, count(is_wet) == 0, 'a closed edge keeps it out')
  end subroutine water_follows_what_is_open

  !> Two by two points a facet: the first row of each facet at the edge is an inlet.
  subroutine points_between_nodes(log)
    type(test_log), intent(inout) :: log
    real(rk), allocatable :: x(:, :), place(:, :)
    integer, allocatable :: facets(:, :), sides(:, :)
    logical, allocatable :: is_wet(:)
    type(dam_joint) :: joint
    type(path_net) :: net
    real(rk) :: s
    integer :: f, q, p
    call level_face(x, facets)
    allocate (place(2, 4*size(facets, 2)), sides(4, 4*size(facets, 2)))
    s = 0.5_rk/sqrt(3.0_rk)
    do f = 1, size(facets, 2)
      do q = 1, 4
        p = 4*(f - 1) + q
        place(:, p) = x(:2, facets(1, f)) + 0.5_rk + s*[2*mod(q, 2) - 1, 2*(q/3) - 1]
        sides(:, p) = facets(:, f)
      end do
    end do
    call list_faces(sides, sides, spread(spread(0.25_rk, 1, 4), 2, size(sides, 2)), joint)
    joint%is_nodal = .false.
    call build_paths(size(x, 2), joint, facets, place(1, :), net)
    call check(log, all(net%is_inlet .eqv. place(1, :) < 0.5_rk), 'first row of points')
    allocate (is_wet(size(place, 2)))
    call find_wet(net, place(1, :) < 1.5_rk .or. place(1, :) > 3.5_rk, is_wet)
    call check(log, all(is_wet .eqv. place(1, :) < 1.5_rk), 'as far as it is open')
  end subroutine points_between_nodes
end program test_joint_rim
