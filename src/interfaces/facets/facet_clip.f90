!> Clipping one convex polygon with another (Sutherland & Hodgman 1974).
!>
!> There are no tolerances: a corner is inside an edge or not. If edges nearly coincide, two
!> neighbours may both keep or both lose a piece of round-off area; the areas of the pieces still
!> add up to round-off.
module facet_clip
  use kinds, only: rk
  implicit none
  private
  public :: clip_polygon, cut_polygon, most_corners

  !> Two quads have at most 8 corners in common; round-off may bend an edge and add a few.
  integer, parameter :: most_corners = 16

contains

  !> Keeps the part of a polygon that lies in another one.
  pure subroutine clip_polygon(window, num, polygon)
    real(rk), intent(in) :: window(:, :) !< (2, corners) convex, anticlockwise
    integer, intent(inout) :: num !< corners; 0 when nothing is left
    real(rk), intent(inout) :: polygon(2, most_corners) !< anticlockwise
    integer :: i
    do i = 1, size(window, 2)
      call cut_polygon(window(:, i), window(:, mod(i, size(window, 2)) + 1), num, polygon)
      if (num < 3) num = 0
      if (num == 0) return
    end do
  end subroutine clip_polygon

  !> Keeps what lies left of the line from a to b.
  pure subroutine cut_polygon(a, b, num, polygon)
    real(rk), intent(in) :: a(2), b(2)
    integer, intent(inout) :: num
    real(rk), intent(inout) :: polygon(2, most_corners)
    real(rk) :: kept(2, most_corners), side(most_corners)
    integer :: i, next, used
    do i = 1, num
      side(i) = (b(1) - a(1))*(polygon(2, i) - a(2)) - (b(2) - a(2))*(polygon(1, i) - a(1))
    end do
    if (all(side(:num) >= 0.0_rk)) return
    used = 0
    do i = 1, num
      next = mod(i, num) + 1
      if (used + 2 > most_corners) exit
      if (side(i) >= 0.0_rk) then
        used = used + 1
        kept(:, used) = polygon(:, i)
      end if
      if ((side(i) > 0.0_rk .and. side(next) < 0.0_rk) .or. &
          (side(i) < 0.0_rk .and. side(next) > 0.0_rk)) then
        used = used + 1
        kept(:, used) = polygon(:, i) + side(i)/(side(i) - side(next)) &
                        *(polygon(:, next) - polygon(:, i))
      end if
    end do
    num = used
    polygon(:, :used) = kept(:, :used)
  end subroutine cut_polygon
end module facet_clip
