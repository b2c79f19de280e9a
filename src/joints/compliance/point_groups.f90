!> Groups of joint points: those of a joint, of some small joints, or of a patch of a large joint.
!>
!> The compliance of the joints is kept in blocks between groups (theory.md, 8). On several ranks
!> each group has a rank of its own, which holds its rows of the compliance and solves for it.
module point_groups
  use joint_rows, only: num_axes, row_of
  use kinds, only: rk
  use ranks, only: num_ranks, this_rank
  implicit none
  private
  public :: group_list, group_points, single_group, divide

  !> Points and rows, group by group.
  type :: group_list
    integer :: num_groups = 0
    integer, allocatable :: first(:) !< (groups + 1) in `point`
    integer, allocatable :: point(:)
    integer, allocatable :: row(:) !< rows of these points; those of group g start at first_row(g)
    integer, allocatable :: first_row(:) !< (groups + 1) in `row`
    !> (groups) rank of each group, from 0; not allocated where every rank has all groups
    integer, allocatable :: rank(:)
  contains
    procedure :: members, rows, is_divided, is_here, are_worth_threads
  end type group_list

  !> Joints are one group as long as they have so many points together. Their tangent is then
  !> factored as one dense matrix.
  integer, parameter :: most_together = 150
  !> A joint with more points is cut into patches.
  integer, parameter :: most_in_group = 400
  !> Threads that wait are woken up for each loop, which takes as long as one thread needs for the
  !> products of so many rows (docs/performance.md, "Joints").
  integer, parameter :: fewest_rows = 2000

contains

  !> Groups of the points of all joints.
  subroutine group_points(first_point, x, groups)
    integer, intent(in) :: first_point(:) !< (joints + 1)
    real(rk), intent(in) :: x(:, :) !< (3, points) [m]
    type(group_list), intent(out) :: groups
    integer :: j, p, first, num_points
    num_points = size(x, 2)
    groups%point = [(p, p=1, num_points)]
    allocate (groups%first(num_points + 1))
    first = 1
    do j = 1, size(first_point) - 1
      associate (next => first_point(j + 1))
        if (j < size(first_point) - 1) then
          if (first_point(j + 2) - first <= most_together) cycle
        end if
        call cut(x, first, next - 1, groups)
        first = next
      end associate
    end do
    groups%first(groups%num_groups + 1) = num_points + 1
    groups%first = groups%first(:groups%num_groups + 1)
    call list_rows(groups)
    if (num_ranks() > 1 .and. groups%num_groups > 1) call divide(num_ranks(), groups)
  end subroutine group_points

  !> Gives each group to a rank: the largest group first, to the rank with the least points so far.
  pure subroutine divide(num_parts, groups)
    integer, intent(in) :: num_parts
    type(group_list), intent(inout) :: groups
    integer :: points(0:num_parts - 1), size_of(groups%num_groups), k, g, rank
    points = 0
    size_of = groups%first(2:) - groups%first(:groups%num_groups)
    allocate (groups%rank(groups%num_groups))
    do k = 1, groups%num_groups
      g = maxloc(size_of, 1)
      rank = minloc(points, 1) - 1
      groups%rank(g) = rank
      points(rank) = points(rank) + size_of(g)
      size_of(g) = -1
    end do
  end subroutine divide

  !> Whether threads together do a loop over the groups sooner than one thread.
  pure logical function are_worth_threads(self)
    class(group_list), intent(in) :: self
    are_worth_threads = self%num_groups > 1 .and. size(self%row) >= fewest_rows
  end function are_worth_threads

  !> Whether the groups have ranks of their own.
  pure logical function is_divided(self)
    class(group_list), intent(in) :: self
    is_divided = allocated(self%rank)
  end function is_divided

  !> Whether this rank works for a group.
  logical function is_here(self, group)
    class(group_list), intent(in) :: self
    integer, intent(in) :: group
    is_here = .true.
    if (allocated(self%rank)) is_here = self%rank(group) == this_rank()
  end function is_here

  !> All points in one group.
  subroutine single_group(num_points, groups)
    integer, intent(in) :: num_points
    type(group_list), intent(out) :: groups
    integer :: p
    groups%num_groups = 1
    groups%first = [1, num_points + 1]
    groups%point = [(p, p=1, num_points)]
    call list_rows(groups)
  end subroutine single_group

  !> Points of a group.
  pure function members(self, group) result(points)
    class(group_list), intent(in) :: self
    integer, intent(in) :: group
    integer :: points(self%first(group + 1) - self%first(group))
    points = self%point(self%first(group):self%first(group + 1) - 1)
  end function members

  !> Rows of a group.
  pure function rows(self, group)
    class(group_list), intent(in) :: self
    integer, intent(in) :: group
    integer :: rows(self%first_row(group + 1) - self%first_row(group))
    rows = self%row(self%first_row(group):self%first_row(group + 1) - 1)
  end function rows

  !> Halves a range of points across its longest extent until it is small enough.
  recursive subroutine cut(x, first, last, groups)
    real(rk), intent(in) :: x(:, :) !< (3, points) [m]
    integer, intent(in) :: first, last !< in `groups%point`
    type(group_list), intent(inout) :: groups
    real(rk) :: extent(3)
    integer :: axis, middle
    if (last < first) return
    if (last - first < most_in_group) then
      groups%num_groups = groups%num_groups + 1
      groups%first(groups%num_groups) = first
      return
    end if
    associate (point => groups%point(first:last))
      extent = maxval(x(:, point), 2) - minval(x(:, point), 2)
      axis = maxloc(extent, 1)
      call sort_along(x(axis, :), point)
    end associate
    middle = (first + last)/2
    call cut(x, first, middle, groups)
    call cut(x, middle + 1, last, groups)
  end subroutine cut

  !> Sorts points by a coordinate: merges sorted halves, so that equal ones keep their order.
  recursive subroutine sort_along(coordinate, point)
    real(rk), intent(in) :: coordinate(:) !< of all points [m]
    integer, intent(inout) :: point(:)
    integer :: merged(size(point)), middle, i, j, k
    logical :: takes_left
    if (size(point) < 2) return
    middle = size(point)/2
    call sort_along(coordinate, point(:middle))
    call sort_along(coordinate, point(middle + 1:))
    i = 1
    j = middle + 1
    do k = 1, size(point)
      takes_left = j > size(point)
      if (.not. takes_left .and. i <= middle) then
        takes_left = coordinate(point(i)) <= coordinate(point(j))
      end if
      if (takes_left) then
        merged(k) = point(i)
        i = i + 1
      else
        merged(k) = point(j)
        j = j + 1
      end if
    end do
    point = merged
  end subroutine sort_along

  !> Rows of the points, group by group.
  pure subroutine list_rows(groups)
    type(group_list), intent(inout) :: groups
    integer :: k, i
    groups%row = [((row_of(groups%point(k), i), i=1, num_axes), k=1, size(groups%point))]
    groups%first_row = num_axes*(groups%first - 1) + 1
  end subroutine list_rows
end module point_groups
