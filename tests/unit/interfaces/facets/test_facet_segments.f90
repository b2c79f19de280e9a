!> Segments of two faces tile what they share: areas, moments, partial cover, gaps, directions.
program test_facet_segments
  use facet_segments, only: facet_area, find_segments
  use kinds, only: rk
  use segment_quadrature, only: integrate_segment, segment_points
  use shape_quad4, only: facet_point
  use surface_segments, only: facet_set, segment_set, surface_cover
  use testing, only: check, check_close, test_log
  use two_faces, only: even_lines, graded_lines, grid_face, rotation_about, shake, turn
  implicit none
  type(test_log) :: log

  !> Of sums over some hundred segments of order one.
  real(rk), parameter :: round_off = 1.0e-12_rk

  log%suite = 'facet_segments'
  call nested_grids(log)
  call graded_grids_anywhere(log)
  call turned_grid_inside(log)
  call slivers(log)
  call shaken_grids(log)
  call hypar(log)
  call part_of_a_face(log)
  call gaps_and_overlaps(log)
  call triangles(log)
  call facets_that_look_away(log)
  call interface_quads(log)
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> What all pairs of fully covered faces must meet: the area, int N_a dA of each slave facet and,
  !> where the faces coincide, of each master facet, and equal places on both sides.
  subroutine check_tiling(log, x, slave, master, both, tolerance, what)
    type(test_log), intent(inout) :: log
    real(rk), intent(in) :: x(:, :)
    type(facet_set), intent(in) :: slave, master
    logical, intent(in) :: both !< the master face is covered too
    real(rk), intent(in) :: tolerance !< part of a facet
    character(*), intent(in) :: what
    type(segment_set) :: segments
    type(surface_cover) :: cover
    type(segment_points) :: points
    real(rk), allocatable :: on_slave(:, :), on_master(:, :)
    real(rk) :: miss
    integer :: s, a
    call find_segments(x, slave, master, segments, cover)
    call check_close(log, cover%covered_area/cover%slave_area, 1.0_rk, round_off, what//' area')
    call check(log, all(abs(cover%bare) <= round_off), what//': each facet is covered')
    allocate (on_slave(4, size(slave%element)), on_master(4, size(master%element)), source=0.0_rk)
    miss = 0.0_rk
    do s = 1, segments%num_segments
      call integrate_segment(x, slave, master, segments, s, points)
      do a = 1, 4
        on_slave(a, segments%slave(s)) = on_slave(a, segments%slave(s)) &
                                         + sum(points%area*points%slave_shape(a, :))
        on_master(a, segments%master(s)) = on_master(a, segments%master(s)) &
                                           + sum(points%area*points%master_shape(a, :))
      end do
      miss = max(miss, maxval(abs(matmul(x(:, slave%node(:, segments%slave(s))), &
                                         points%slave_shape) &
                                  - matmul(x(:, master%node(:, segments%master(s))), &
                                           points%master_shape))))
    end do
    call check_shares(log, x, slave, on_slave, tolerance, what//': slave facets')
    if (both) call check_shares(log, x, master, on_master, tolerance, what//': master facets')
    call check_close(log, miss, 0.0_rk, 1.0e-12_rk*maxval(abs(x)), what//': one place')
  end subroutine check_tiling

  !> int N_a dA of whole facets against 2 x 2 points, exact in the plane.
  subroutine check_shares(log, x, facets, share, tolerance, what)
    type(test_log), intent(inout) :: log
    real(rk), intent(in) :: x(:, :)
    type(facet_set), intent(in) :: facets
    real(rk), intent(in) :: share(:, :) !< (4, facets)
    real(rk), intent(in) :: tolerance
    character(*), intent(in) :: what
    real(rk) :: n(4), vector(3), whole(4), worst
    integer :: f, q
    worst = 0.0_rk
    do f = 1, size(facets%element)
      whole = 0.0_rk
      do q = 1, 4
        call facet_point(x(:, facets%node(:, f)), q, n, vector)
        whole = whole + n*norm2(vector)
      end do
      worst = max(worst, maxval(abs(share(:, f) - whole))/facet_area(x(:, facets%node(:, f))))
    end do
    call check_close(log, worst, 0.0_rk, tolerance, what)
  end subroutine check_shares

  subroutine nested_grids(log)
    type(test_log), intent(inout) :: log
    real(rk), allocatable :: x(:, :)
    type(facet_set) :: slave, master
    call grid_face(even_lines(3, 0.0_rk, 1.0_rk), even_lines(3, 0.0_rk, 1.0_rk), 0.0_rk, .true., &
                   x, slave)
    call grid_face(even_lines(6, 0.0_rk, 1.0_rk), even_lines(3, 0.0_rk, 1.0_rk), 0.0_rk, .false., &
                   x, master)
    call check_tiling(log, x, slave, master, .true., round_off, 'nested')
    call check_tiling(log, x, master, slave, .true., round_off, 'nested, swapped')
  end subroutine nested_grids

  !> Grids graded 1:10 against each other, turned in space and far from the origin, both ways round.
  subroutine graded_grids_anywhere(log)
    type(test_log), intent(inout) :: log
    real(rk), allocatable :: x(:, :)
    type(facet_set) :: slave, master
    call grid_face(graded_lines(11, 10.0_rk), even_lines(3, 0.0_rk, 1.0_rk), 0.0_rk, .true., &
                   x, slave)
    call grid_face(1.0_rk - graded_lines(7, 10.0_rk), graded_lines(13, 0.1_rk), 0.0_rk, .true., &
                   x, master)
    call turn(rotation_about([1.0_rk, 2.0_rk, -0.5_rk], 0.7_rk), [3.0_rk, -2.0_rk, 1.0_rk], x)
    call check_tiling(log, x, slave, master, .true., round_off, 'graded')
    call check_tiling(log, x, master, slave, .true., round_off, 'graded, swapped')
  end subroutine graded_grids_anywhere

  !> A small grid inside a large one that is turned in their plane.
  subroutine turned_grid_inside(log)
    type(test_log), intent(inout) :: log
    real(rk), allocatable :: x(:, :)
    type(facet_set) :: slave, master
    type(segment_set) :: segments
    type(surface_cover) :: cover
    integer :: k
    do k = 1, 12
      if (allocated(x)) deallocate (x)
      call grid_face(even_lines(9, -0.3_rk, 1.3_rk), even_lines(7, -0.4_rk, 1.4_rk), 0.0_rk, &
                     .false., x, master)
      call turn(rotation_about([0.0_rk, 0.0_rk, 1.0_rk], 0.13_rk*k), &
                [0.5_rk, 0.5_rk, 0.0_rk], x)
      call grid_face(even_lines(5, 0.1_rk, 0.9_rk), even_lines(4, 0.2_rk, 0.8_rk), 0.0_rk, .true., &
                     x, slave)
      call check_tiling(log, x, slave, master, .false., round_off, 'turned')
      call find_segments(x, master, slave, segments, cover)
      call check_close(log, cover%covered_area, 0.48_rk, round_off, 'turned: the part in common')
    end do
  end subroutine turned_grid_inside

  !> Lines that nearly coincide: shifted and turned by 1e-15 to 1e-9.
  subroutine slivers(log)
    type(test_log), intent(inout) :: log
    real(rk), allocatable :: x(:, :)
    type(facet_set) :: slave, master
    real(rk) :: s(9), shift
    integer :: k, i
    do k = 9, 15
      shift = 10.0_rk**(-k)
      s = even_lines(8, 0.0_rk, 1.0_rk)
      s(2:8) = s(2:8) + [(shift*(-1)**i*i, i=1, 7)]
      if (allocated(x)) deallocate (x)
      call grid_face(even_lines(8, 0.0_rk, 1.0_rk), even_lines(8, 0.0_rk, 1.0_rk), 0.0_rk, .true., &
                     x, slave)
      call grid_face(s, s, 0.0_rk, .false., x, master)
      call turn(rotation_about([0.3_rk, 0.2_rk, 1.0_rk], 0.4_rk), [0.0_rk, 0.0_rk, 0.0_rk], x)
      call check_tiling(log, x, slave, master, .true., round_off, 'slivers')
    end do
  end subroutine slivers

  !> Plane facets of any shape; the square root in their shape functions is met to round-off.
  subroutine shaken_grids(log)
    type(test_log), intent(inout) :: log
    real(rk), allocatable :: x(:, :)
    type(facet_set) :: slave, master
    call grid_face(even_lines(5, 0.0_rk, 1.0_rk), even_lines(5, 0.0_rk, 1.0_rk), 0.0_rk, .true., &
                   x, slave)
    call grid_face(even_lines(7, 0.0_rk, 1.0_rk), even_lines(6, 0.0_rk, 1.0_rk), 0.0_rk, .false., &
                   x, master)
    call shake(1, 5, 5, 0.15_rk, x)
    call shake(37, 7, 6, 0.2_rk, x)
    call turn(rotation_about([1.0_rk, 0.0_rk, 1.0_rk], 1.1_rk), [0.0_rk, 1.0_rk, 0.0_rk], x)
    call check_tiling(log, x, slave, master, .true., round_off, 'shaken')
    call check_tiling(log, x, master, slave, .true., round_off, 'shaken, swapped')
  end subroutine shaken_grids

  !> z = x y with both meshes along its rulings: both faces are the same curved surface, so that
  !> places agree and int N_a n dA adds up to the exact value of every facet.
  subroutine hypar(log)
    type(test_log), intent(inout) :: log
    real(rk), allocatable :: x(:, :)
    type(facet_set) :: slave, master
    type(segment_set) :: segments
    type(surface_cover) :: cover
    type(segment_points) :: points
    real(rk), allocatable :: force(:, :), expected(:, :)
    integer :: s, a, round
    call grid_face(even_lines(4, -0.5_rk, 1.0_rk), even_lines(4, 0.0_rk, 1.0_rk), 0.0_rk, .true., &
                   x, slave)
    call grid_face(even_lines(7, -0.5_rk, 1.0_rk), graded_lines(5, 3.0_rk), 0.0_rk, .false., &
                   x, master)
    x(3, :) = x(1, :)*x(2, :)
    do round = 1, 2
      call find_segments(x, slave, master, segments, cover)
      call check_close(log, cover%covered_area/cover%slave_area, 1.0_rk, round_off, 'hypar: area')
      call check_close(log, max(cover%largest_gap, cover%largest_overlap), 0.0_rk, 1.0e-14_rk, &
                       'hypar: no gap')
      allocate (force(3, size(x, 2)), source=0.0_rk)
      do s = 1, segments%num_segments
        call integrate_segment(x, slave, master, segments, s, points)
        do a = 1, 4
          associate (mine => slave%node(a, segments%slave(s)), &
                     yours => master%node(a, segments%master(s)))
            force(:, mine) = force(:, mine) + matmul(points%normal, &
                                                     points%area*points%slave_shape(a, :))
            force(:, yours) = force(:, yours) - matmul(points%normal, &
                                                       points%area*points%master_shape(a, :))
          end associate
        end do
      end do
      call add_areas(x, slave, expected)
      call check_close(log, maxval(abs(force(:, minval(slave%node):maxval(slave%node)) &
                                       - expected(:, minval(slave%node):maxval(slave%node)))), &
                       0.0_rk, 1.0e-13_rk, 'hypar: slave nodes')
      call add_areas(x, master, expected)
      call check_close(log, maxval(abs(force(:, minval(master%node):maxval(master%node)) &
                                       - expected(:, minval(master%node):maxval(master%node)))), &
                       0.0_rk, 1.0e-13_rk, 'hypar: master nodes')
      deallocate (force)
      call swap(slave, master)
    end do
  end subroutine hypar

  !> int N_a n dA at the nodes of a face; 2 x 2 points are exact on bilinear facets.
  subroutine add_areas(x, facets, area)
    real(rk), intent(in) :: x(:, :)
    type(facet_set), intent(in) :: facets
    real(rk), allocatable, intent(out) :: area(:, :) !< (3, nodes)
    real(rk) :: n(4), vector(3)
    integer :: f, q, a
    allocate (area(3, size(x, 2)), source=0.0_rk)
    do f = 1, size(facets%element)
      do q = 1, 4
        call facet_point(x(:, facets%node(:, f)), q, n, vector)
        do a = 1, 4
          area(:, facets%node(a, f)) = area(:, facets%node(a, f)) + n(a)*vector
        end do
      end do
    end do
  end subroutine add_areas

  subroutine swap(one, other)
    type(facet_set), intent(inout) :: one, other
    type(facet_set) :: keep
    keep = one
    one = other
    other = keep
  end subroutine swap

  subroutine part_of_a_face(log)
    type(test_log), intent(inout) :: log
    real(rk), allocatable :: x(:, :)
    type(facet_set) :: slave, master
    type(segment_set) :: segments
    type(surface_cover) :: cover
    call grid_face(even_lines(4, 0.0_rk, 1.0_rk), even_lines(4, 0.0_rk, 1.0_rk), 0.0_rk, .true., &
                   x, slave)
    call grid_face(even_lines(3, 0.3_rk, 1.7_rk), even_lines(5, -0.5_rk, 0.9_rk), 0.0_rk, .false., &
                   x, master)
    call find_segments(x, slave, master, segments, cover)
    call check_close(log, cover%covered_area, 0.63_rk, round_off, 'part: covered')
    call check_close(log, cover%slave_area, 1.0_rk, round_off, 'part: whole')
    call check_close(log, cover%master_area, 1.96_rk, round_off, 'part: the other whole')
    call check_close(log, cover%bare(1), 1.0_rk, 0.0_rk, 'part: a bare facet')
    call check_close(log, cover%bare(2), 0.2_rk, round_off, 'part: 0.3 to 0.5 covered')
    call check_close(log, cover%bare(7), 0.0_rk, round_off, 'part: a covered facet')
  end subroutine part_of_a_face

  !> The master face is inclined: 0.1 below at x = 1, 0.2 inside the slave's solid at x = 0.
  subroutine gaps_and_overlaps(log)
    type(test_log), intent(inout) :: log
    real(rk), allocatable :: x(:, :)
    type(facet_set) :: slave, master
    type(segment_set) :: segments
    type(surface_cover) :: cover
    type(segment_points) :: points
    real(rk) :: volume
    integer :: s
    call grid_face(even_lines(3, 0.0_rk, 1.0_rk), even_lines(2, 0.0_rk, 1.0_rk), 0.0_rk, .true., &
                   x, slave)
    call grid_face(even_lines(4, 0.0_rk, 1.0_rk), even_lines(3, 0.0_rk, 1.0_rk), 0.0_rk, .false., &
                   x, master)
    x(3, 13:) = 0.3_rk*x(1, 13:) - 0.2_rk
    call find_segments(x, slave, master, segments, cover)
    call check_close(log, cover%largest_gap, 0.1_rk, 1.0e-14_rk, 'largest gap')
    call check_close(log, cover%gap_place(1), 1.0_rk, 1.0e-14_rk, 'its place')
    call check_close(log, cover%largest_overlap, 0.2_rk, 1.0e-14_rk, 'largest overlap')
    call check_close(log, cover%overlap_place(1), 0.0_rk, 1.0e-14_rk, 'its place')
    volume = 0.0_rk
    do s = 1, segments%num_segments
      call integrate_segment(x, slave, master, segments, s, points)
      volume = volume + sum(points%area*points%gap)
    end do
    call check_close(log, volume, -0.05_rk, 1.0e-14_rk, 'volume between the faces')
    x(3, 13:) = x(3, 13:) + 5.0_rk
    call find_segments(x, slave, master, segments, cover)
    call check(log, segments%num_segments == 0, 'too far apart')
    call check_close(log, cover%covered_area, 0.0_rk, 0.0_rk, 'too far apart: nothing covered')
    call find_segments(x, slave, master, segments, cover, 10.0_rk)
    call check_close(log, cover%covered_area, 1.0_rk, round_off, 'as far apart as they may be')
  end subroutine gaps_and_overlaps

  !> Quads against triangles (a wedge's facet repeats a node), either way round.
  subroutine triangles(log)
    type(test_log), intent(inout) :: log
    real(rk), allocatable :: x(:, :)
    type(facet_set) :: quads, grid, split
    integer :: f
    call grid_face(even_lines(3, 0.0_rk, 1.0_rk), even_lines(3, 0.0_rk, 1.0_rk), 0.0_rk, .true., &
                   x, quads)
    call grid_face(even_lines(4, 0.0_rk, 1.0_rk), even_lines(2, 0.0_rk, 1.0_rk), 0.0_rk, .false., &
                   x, grid)
    allocate (split%node(4, 16), split%element(16))
    split%element = 1
    do f = 1, 8
      split%node(:, 2*f - 1) = grid%node([1, 2, 3, 3], f)
      split%node(:, 2*f) = grid%node([1, 1, 3, 4], f)
    end do
    call check_triangles(log, x, quads, split, 1.0_rk/16.0_rk)
    call check_triangles(log, x, split, quads, 1.0_rk/9.0_rk)
  end subroutine triangles

  !> Integrals that are the same for triangles and quads.
  subroutine check_triangles(log, x, slave, master, first)
    type(test_log), intent(inout) :: log
    real(rk), intent(in) :: x(:, :)
    type(facet_set), intent(in) :: slave, master
    real(rk), intent(in) :: first !< area of the first master facet [m2]
    type(segment_set) :: segments
    type(surface_cover) :: cover
    type(segment_points) :: points
    real(rk) :: moment(3), miss, on_first
    integer :: s
    call find_segments(x, slave, master, segments, cover)
    call check_close(log, cover%covered_area, 1.0_rk, round_off, 'triangles: area')
    moment = 0.0_rk
    miss = 0.0_rk
    on_first = 0.0_rk
    do s = 1, segments%num_segments
      call integrate_segment(x, slave, master, segments, s, points)
      moment = moment + matmul(points%x, points%area*points%x(1, :))
      miss = max(miss, maxval(abs(points%x - matmul(x(:, master%node(:, segments%master(s))), &
                                                    points%master_shape))))
      if (segments%master(s) > 1) cycle
      on_first = on_first + sum(points%area*sum(points%master_shape, 1))
    end do
    call check_close(log, moment(1), 1.0_rk/3.0_rk, round_off, 'triangles: int x x')
    call check_close(log, moment(2), 0.25_rk, round_off, 'triangles: int x y')
    call check_close(log, miss, 0.0_rk, 1.0e-14_rk, 'triangles: one place')
    call check_close(log, on_first, first, round_off, 'triangles: area of a master facet')
  end subroutine check_triangles

  subroutine facets_that_look_away(log)
    type(test_log), intent(inout) :: log
    real(rk), allocatable :: x(:, :)
    type(facet_set) :: slave, master
    type(segment_set) :: segments
    type(surface_cover) :: cover
    call grid_face(even_lines(2, 0.0_rk, 1.0_rk), even_lines(2, 0.0_rk, 1.0_rk), 0.0_rk, .true., &
                   x, slave)
    call grid_face(even_lines(3, 0.0_rk, 1.0_rk), even_lines(3, 0.0_rk, 1.0_rk), 0.0_rk, .true., &
                   x, master)
    call find_segments(x, slave, master, segments, cover)
    call check(log, segments%num_segments == 0, 'facets with equal normals')
    master%node = master%node(:, [1, 2, 3, 4, 5, 6, 7, 8, 9])
    master%node = master%node([4, 3, 2, 1], :)
    call turn(rotation_about([0.0_rk, 1.0_rk, 0.0_rk], 1.2_rk), [0.5_rk, 0.5_rk, 0.0_rk], x(:, 10:))
    call find_segments(x, slave, master, segments, cover)
    call check(log, segments%num_segments == 0, 'facets 69 degrees from each other')
  end subroutine facets_that_look_away

  !> Quads without a solid may have either normal; the other side gives the sense.
  subroutine interface_quads(log)
    type(test_log), intent(inout) :: log
    real(rk), allocatable :: x(:, :)
    type(facet_set) :: slave, master
    type(segment_set) :: segments
    type(surface_cover) :: cover
    type(segment_points) :: points
    call grid_face(even_lines(2, 0.0_rk, 1.0_rk), even_lines(2, 0.0_rk, 1.0_rk), 0.0_rk, .true., &
                   x, slave)
    call grid_face(even_lines(3, 0.0_rk, 1.0_rk), even_lines(3, 0.0_rk, 1.0_rk), 0.02_rk, .true., &
                   x, master)
    slave%element = 0
    call find_segments(x, slave, master, segments, cover)
    call check_close(log, cover%covered_area, 1.0_rk, round_off, 'interface quads: covered')
    call check_close(log, cover%largest_overlap, 0.02_rk, 1.0e-14_rk, 'the solid is in the way')
    call integrate_segment(x, slave, master, segments, 1, points)
    call check_close(log, points%normal(3, 1), -1.0_rk, 1.0e-14_rk, 'out of the slave side')
    call check_close(log, points%gap(1), -0.02_rk, 1.0e-14_rk, 'gap along it')
  end subroutine interface_quads
end program test_facet_segments
