!> The parts of a segment that hold one Gauss point of a joint each (different_meshes.md, 13.2).
!>
!> On a quad two lines through the middle of the segment, along the natural coordinates of the slave
!> facet, cut the segment into quarters. On a triangle lines from the middle, parallel to the
!> medians, cut it into three parts, one towards each corner. So the parts do not depend on which
!> corner of a facet comes first, and round-off of a line changes them by round-off only.
module segment_quarters
  use facet_clip, only: cut_polygon, most_corners
  use facet_plane, only: facet_pair, flat_facet, plane_area
  use kinds, only: rk
  use segment_quadrature, only: find_pair, integrate_polygon, segment_points
  use surface_segments, only: facet_set, segment_set
  implicit none
  private
  public :: quarter, find_quarters

  !> The mean over a part of a segment.
  type :: quarter
    real(rk) :: area = 0.0_rk !< 0: no such part [m2]
    real(rk) :: slave_shape(4) = 0.0_rk, master_shape(4) = 0.0_rk
    real(rk) :: normal(3) = 0.0_rk !< out of the slave's solid, of any length
    real(rk) :: gap = 0.0_rk !< [m]
  end type quarter

  !> A part below this fraction of its segment is round-off of the clipping; it is left out.
  real(rk), parameter :: smallest_part = 1.0e-14_rk

contains

  !> The parts of segment s. Each holds the means over its area, so that a constant traction is
  !> transmitted exactly.
  pure subroutine find_quarters(x, slave, master, segments, s, points, quarters)
    real(rk), intent(in) :: x(:, :) !< (3, nodes) [m]
    type(facet_set), intent(in) :: slave, master
    type(segment_set), intent(in) :: segments !< of these two faces
    integer, intent(in) :: s
    type(segment_points), intent(inout) :: points !< memory is reused
    type(quarter), intent(out) :: quarters(4)
    type(facet_pair) :: pair
    real(rk) :: line(2, 2, 2, 4), part(2, most_corners)
    integer :: k, num, num_parts
    call find_pair(x, slave, master, segments, s, pair)
    associate (whole => segments%vertex(:, segments%first_vertex(s): &
                                        segments%first_vertex(s + 1) - 1))
      call integrate_polygon(pair, whole, points)
      call find_lines(pair%own, middle_of(pair%own, points), num_parts, line)
      do k = 1, num_parts
        num = size(whole, 2)
        part(:, :num) = whole
        call cut_polygon(line(:, 1, 1, k), line(:, 2, 1, k), num, part)
        call cut_polygon(line(:, 1, 2, k), line(:, 2, 2, k), num, part)
        if (plane_area(part(:, :num)) <= smallest_part*plane_area(whole)) cycle
        call integrate_polygon(pair, part(:, :num), points)
        call take_mean(points, quarters(k))
      end do
    end associate
  end subroutine find_quarters

  !> The mean natural coordinates of a segment on its slave facet.
  pure function middle_of(own, points) result(xi)
    type(flat_facet), intent(in) :: own
    type(segment_points), intent(in) :: points !< of the segment
    real(rk) :: xi(2)
    real(rk) :: n(4)
    n = matmul(points%slave_shape, points%area)/sum(points%area)
    if (own%num_corners == 4) then
      xi = [n(2) + n(3) - n(1) - n(4), n(3) + n(4) - n(1) - n(2)]
    else
      xi = [n(mod(own%double + 1, 4) + 1), n(mod(own%double + 2, 4) + 1)]
    end if
  end function middle_of

  !> The two lines that bound each part, which lies left of both.
  pure subroutine find_lines(own, middle, num_parts, line)
    type(flat_facet), intent(in) :: own
    real(rk), intent(in) :: middle(2) !< natural coordinates
    integer, intent(out) :: num_parts
    real(rk), intent(out) :: line(2, 2, 2, 4) !< (xy, from and to, lines, parts) [m]
    real(rk) :: centre(2), upward(2, 2), rightward(2, 2), median(2, 3)
    integer :: k, next, last
    num_parts = own%num_corners
    if (num_parts == 4) then
      upward(:, 1) = place_at(own, [middle(1), -1.0_rk])
      upward(:, 2) = place_at(own, [middle(1), 1.0_rk])
      rightward(:, 1) = place_at(own, [-1.0_rk, middle(2)])
      rightward(:, 2) = place_at(own, [1.0_rk, middle(2)])
      do k = 1, 4
        line(:, :, 1, k) = upward
        if (mod(k, 2) == 0) line(:, :, 1, k) = upward(:, [2, 1])
        line(:, :, 2, k) = rightward
        if (k <= 2) line(:, :, 2, k) = rightward(:, [2, 1])
      end do
      return
    end if
    centre = place_at(own, middle)
    median = 1.5_rk*(own%corner(:, :3) - spread(sum(own%corner(:, :3), dim=2)/3.0_rk, 2, 3))
    do k = 1, 3
      next = mod(k, 3) + 1
      last = mod(k + 1, 3) + 1
      line(:, :, 1, k) = reshape([centre, centre + median(:, last)], [2, 2])
      line(:, :, 2, k) = reshape([centre, centre - median(:, next)], [2, 2])
    end do
  end subroutine find_lines

  !> The place of natural coordinates in the plane [m].
  pure function place_at(own, xi) result(p)
    type(flat_facet), intent(in) :: own
    real(rk), intent(in) :: xi(2)
    real(rk) :: p(2)
    p = own%centre + matmul(own%along, xi) + own%twist*xi(1)*xi(2)
  end function place_at

  !> The means of the points of a part.
  pure subroutine take_mean(points, mean)
    type(segment_points), intent(in) :: points
    type(quarter), intent(out) :: mean
    mean%area = sum(points%area)
    mean%slave_shape = matmul(points%slave_shape, points%area)/mean%area
    mean%master_shape = matmul(points%master_shape, points%area)/mean%area
    mean%normal = matmul(points%normal, points%area)
    mean%gap = dot_product(points%gap, points%area)/mean%area
  end subroutine take_mean
end module segment_quarters
