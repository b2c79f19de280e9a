!> Time to find and to integrate the segments of two faces, rotated relative to each other, plane
!> and curved, at three sizes; the largest has 50 000 facets per face.
program bench_segments
  use facet_segments, only: find_segments
  use kinds, only: rk
  use segment_quadrature, only: integrate_segment, segment_points
  use surface_segments, only: facet_set, segment_set, surface_cover
  use two_faces, only: even_lines, grid_face, rotation_about, shake, turn
  implicit none
  integer, parameter :: sizes(4) = [56, 112, 224, 448]

  integer :: i, sort

  do sort = 1, 2
    if (sort == 1) write (*, '(a)') 'parallelograms, plane'
    if (sort == 2) write (*, '(a)') 'quads of any shape, z = 0.1 cos(2 x)'
    write (*, '(6a12)') 'facets', 'segments', 'search+clip', 'us/facet', 'gaps of 4', 'integrate'
    do i = 1, size(sizes)
      call measure(sizes(i), sort == 2)
    end do
  end do

contains

  !> Two faces of n x n facets.
  subroutine measure(n, is_curved)
    integer, intent(in) :: n
    logical, intent(in) :: is_curved
    real(rk), allocatable :: x(:, :)
    type(facet_set) :: slave, master
    type(segment_set) :: segments
    type(surface_cover) :: cover
    type(segment_points) :: points
    real(rk) :: started, found, far, area
    integer :: s
    call grid_face(even_lines(n, 0.0_rk, 1.0_rk), even_lines(n, 0.0_rk, 1.0_rk), 0.0_rk, .true., &
                   x, slave)
    call turn(rotation_about([0.0_rk, 0.0_rk, 1.0_rk], 0.3_rk), [0.5_rk, 0.5_rk, 0.0_rk], x)
    call grid_face(even_lines(n, 0.0_rk, 1.0_rk), even_lines(n, 0.0_rk, 1.0_rk), 0.0_rk, .false., &
                   x, master)
    if (is_curved) then
      call shake(1, n, n, 0.15_rk, x)
      call shake((n + 1)**2 + 1, n, n, 0.15_rk, x)
      x(3, :) = 0.1_rk*cos(2.0_rk*x(1, :))
    end if
    started = seconds()
    call find_segments(x, slave, master, segments, cover)
    found = seconds()
    call find_segments(x, slave, master, segments, cover, 4.0_rk)
    far = seconds() - found
    found = found + far
    started = started + far
    area = 0.0_rk
    do s = 1, segments%num_segments
      call integrate_segment(x, slave, master, segments, s, points)
      area = area + sum(points%area)
    end do
    write (*, '(2i12,4f12.3)') n**2, segments%num_segments, found - started, &
      1.0e6_rk*(found - started)/n**2, far, seconds() - found
    if (abs(area - cover%covered_area) > 1.0e-5_rk) error stop 'the points do not add up'
  end subroutine measure

  !> Processor time, which excludes other work of the machine.
  real(rk) function seconds()
    call cpu_time(seconds)
  end function seconds
end program bench_segments
