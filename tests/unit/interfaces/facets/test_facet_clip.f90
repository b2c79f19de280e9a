!> Clipping convex polygons: areas that geometry gives.
program test_facet_clip
  use facet_clip, only: clip_polygon, most_corners
  use facet_plane, only: plane_area
  use kinds, only: rk
  use testing, only: check_close, test_log
  implicit none
  type(test_log) :: log
  real(rk), parameter :: square(2, 4) = reshape(real([0, 0, 1, 0, 1, 1, 0, 1], rk), [2, 4])
  real(rk) :: corners(2, 4), s
  integer :: i

  log%suite = 'facet_clip'
  call check_close(log, area_of(square, square), 1.0_rk, 0.0_rk, 'itself')
  call check_close(log, area_of(square, square + 1.0_rk), 0.0_rk, 0.0_rk, 'a corner touches')
  call check_close(log, area_of(square, moved(1.0_rk, 0.0_rk)), 0.0_rk, 0.0_rk, 'an edge touches')
  call check_close(log, area_of(square, moved(3.0_rk, 0.2_rk)), 0.0_rk, 0.0_rk, 'apart')
  call check_close(log, area_of(square, moved(0.25_rk, 0.5_rk)), 0.375_rk, 1.0e-15_rk, 'shifted')
  call check_close(log, area_of(square, 0.25_rk + 0.5_rk*square), 0.25_rk, 1.0e-15_rk, 'inside')
  call check_close(log, area_of(0.25_rk + 0.5_rk*square, square), 0.25_rk, 1.0e-15_rk, 'around')
  s = sqrt(0.5_rk)
  corners = 0.5_rk + reshape([s, 0.0_rk, 0.0_rk, s, -s, 0.0_rk, 0.0_rk, -s], [2, 4])
  call check_close(log, area_of(square, corners), 2.0_rk*sqrt(2.0_rk) - 2.0_rk, 1.0e-15_rk, &
                   'turned by 45 degrees: an octagon')
  do i = 1, 15
    s = 10.0_rk**(-i)
    corners = square
    corners(1, 2:3) = 1.0_rk + [s, -s]
    call check_close(log, area_of(square, corners), 1.0_rk - 0.25_rk*s, 1.0e-15_rk, 'a sliver off')
  end do
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  pure function moved(x, y)
    real(rk), intent(in) :: x, y
    real(rk) :: moved(2, 4)
    moved(1, :) = square(1, :) + x
    moved(2, :) = square(2, :) + y
  end function moved

  !> Area of what a polygon and a window share.
  pure real(rk) function area_of(polygon, window)
    real(rk), intent(in) :: polygon(:, :), window(:, :)
    real(rk) :: left(2, most_corners)
    integer :: num
    num = size(polygon, 2)
    left(:, :num) = polygon
    call clip_polygon(window, num, left)
    area_of = plane_area(left(:, :num))
  end function area_of
end program test_facet_clip
