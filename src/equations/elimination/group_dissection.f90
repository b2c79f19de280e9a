!> Nested dissection of a graph in which the vertices of a group stay together.
!>
!> A separator consists of a whole group and of what else connects its two sides. The unknowns of a
!> group then form one front of the factor, and groups that see each other are ancestors of one
!> another in the elimination tree.
module group_dissection
  use, intrinsic :: iso_c_binding, only: c_int
  implicit none
  private
  public :: vertex_graph, dissect_groups, dissect_graph

  !> Both triangles, 0-based, without loops.
  type :: vertex_graph
    integer, allocatable :: start(:) !< (vertices + 1)
    integer, allocatable :: neighbour(:)
    integer, allocatable :: weight(:) !< (vertices) unknowns
    integer, allocatable :: group(:) !< (vertices) 0 for none
  end type vertex_graph

  interface
    function keyway_nested_dissection(n, start, neighbour, weight, order) result(status) bind(c)
      import :: c_int
      implicit none
      integer(c_int), value :: n
      integer(c_int), intent(in) :: start(n + 1), neighbour(start(n + 1)), weight(n)
      integer(c_int), intent(out) :: order(n)
      integer(c_int) :: status
    end function keyway_nested_dissection
  end interface

  integer, parameter :: small = 30 !< graphs of fewer vertices keep their order
  !> Most groups that are tried as a separator.
  integer, parameter :: most_trials = 12
  !> Unknowns of the larger side that one unknown less in the separator is worth.
  real, parameter :: worth = 10.0
  integer, parameter :: separating = 2 !< part of a separator

contains

  !> Orders all vertices: order(k) is eliminated as the k-th, counted from 1.
  recursive subroutine dissect_groups(graph, order, status)
    type(vertex_graph), intent(in) :: graph
    integer, intent(out) :: order(:) !< (vertices)
    integer, intent(out) :: status !< 0 for success
    integer :: part(size(order)), side, place
    integer, allocatable :: vertex(:), inner(:)
    type(vertex_graph) :: region
    status = 0
    if (count(graph%group > 0) == 0) then
      call dissect_graph(graph, order, status)
      return
    end if
    call divide(graph, part)
    place = 0
    do side = 0, 1
      call take_region(graph, part, side, vertex, region)
      allocate (inner(size(vertex)))
      call dissect_groups(region, inner, status)
      if (status /= 0) return
      order(place + 1:place + size(vertex)) = vertex(inner)
      place = place + size(vertex)
      deallocate (inner)
    end do
    call list_part(part, separating, vertex)
    order(place + 1:) = vertex
  end subroutine dissect_groups

  !> Nested dissection without groups.
  subroutine dissect_graph(graph, order, status)
    type(vertex_graph), intent(in) :: graph
    integer, intent(out) :: order(:) !< (vertices) counted from 1
    integer, intent(out) :: status !< 0 for success
    integer :: v
    status = 0
    if (size(order) > small) then
      status = keyway_nested_dissection(size(order), graph%start, graph%neighbour, graph%weight, &
                                        order)
      order = order + 1
    else
      order = [(v, v=1, size(order))]
    end if
  end subroutine dissect_graph

  !> Parts of a graph: two sides and what separates them, by the group that divides best. A group
  !> without others is the separator alone.
  subroutine divide(graph, part)
    type(vertex_graph), intent(in) :: graph
    integer, intent(out) :: part(:) !< (vertices)
    integer :: trial(size(part)), k, last
    integer, allocatable :: groups(:)
    real :: cost, least
    logical :: is_there(maxval(graph%group))
    part = merge(separating, 0, graph%group > 0)
    if (size(part) <= small) return
    is_there = .false.
    do k = 1, size(part)
      if (graph%group(k) > 0) is_there(graph%group(k)) = .true.
    end do
    groups = pack([(k, k=1, size(is_there))], is_there)
    if (size(groups) == 1) return
    least = huge(least)
    last = min(most_trials, size(groups))
    do k = 1, last
      call divide_by_group(graph, groups((2*k - 1)*size(groups)/(2*last) + 1), trial)
      if (count(trial == 0) == 0 .or. count(trial == 1) == 0) cycle
      cost = max(sum(graph%weight, trial == 0), sum(graph%weight, trial == 1)) &
             + worth*sum(graph%weight, trial == separating)
      if (cost >= least) cycle
      least = cost
      part = trial
    end do
  end subroutine divide

  !> The sides of a group: vertices nearer to one of two that are next to it and, without it, far
  !> from each other. Where the sides touch, one of them ends in the separator.
  subroutine divide_by_group(graph, group, part)
    type(vertex_graph), intent(in) :: graph
    integer, intent(in) :: group
    integer, intent(out) :: part(:) !< (vertices)
    integer, dimension(size(part)) :: from, to
    logical :: is_next(size(part)), is_border(size(part))
    integer :: v, side
    do v = 1, size(part)
      is_next(v) = graph%group(v) /= group .and. &
                   any(graph%group(graph%neighbour(graph%start(v) + 1:graph%start(v + 1)) + 1) &
                       == group)
    end do
    part = 0
    if (count(is_next) < 2) return
    call measure_distances(graph, group, findloc(is_next, .true., 1), from)
    call measure_distances(graph, group, maxloc(from, 1, is_next), to)
    call measure_distances(graph, group, maxloc(to, 1, is_next), from)
    part = merge(0, 1, from <= to)
    where (graph%group == group) part = separating
    side = 0
    do v = 1, size(part)
      is_border(v) = part(v) /= separating .and. &
                     any(part(graph%neighbour(graph%start(v) + 1:graph%start(v + 1)) + 1) &
                         == 1 - part(v))
    end do
    if (sum(graph%weight, is_border .and. part == 1) &
        < sum(graph%weight, is_border .and. part == 0)) then
      side = 1
    end if
    where (is_border .and. part == side) part = separating
    call complete_groups(graph, part)
  end subroutine divide_by_group

  !> Edges from a vertex to all others on paths that avoid a group; huge where there is none.
  pure subroutine measure_distances(graph, group, origin, distance)
    type(vertex_graph), intent(in) :: graph
    integer, intent(in) :: group, origin
    integer, intent(out) :: distance(:) !< (vertices)
    integer :: queue(size(distance)), head, tail, v, k, other
    distance = huge(distance)
    distance(origin) = 0
    queue(1) = origin
    head = 1
    tail = 1
    do while (head <= tail)
      v = queue(head)
      head = head + 1
      do k = graph%start(v) + 1, graph%start(v + 1)
        other = graph%neighbour(k) + 1
        if (distance(other) < huge(distance) .or. graph%group(other) == group) cycle
        distance(other) = distance(v) + 1
        tail = tail + 1
        queue(tail) = other
      end do
    end do
  end subroutine measure_distances

  !> Puts groups as a whole into the separator where they are not on one side of it.
  pure subroutine complete_groups(graph, part)
    type(vertex_graph), intent(in) :: graph
    integer, intent(inout) :: part(:) !< (vertices)
    integer :: least(maxval(graph%group)), most(maxval(graph%group)), v, g
    least = separating
    most = 0
    do v = 1, size(part)
      g = graph%group(v)
      if (g == 0) cycle
      least(g) = min(least(g), part(v))
      most(g) = max(most(g), part(v))
    end do
    do v = 1, size(part)
      g = graph%group(v)
      if (g == 0) cycle
      if (least(g) /= most(g)) part(v) = separating
    end do
  end subroutine complete_groups

  !> Vertices of a part, counted from 1.
  pure subroutine list_part(part, side, vertex)
    integer, intent(in) :: part(:), side
    integer, allocatable, intent(out) :: vertex(:)
    integer :: v
    vertex = pack([(v, v=1, size(part))], part == side)
  end subroutine list_part

  !> The graph of a part.
  pure subroutine take_region(graph, part, side, vertex, region)
    type(vertex_graph), intent(in) :: graph
    integer, intent(in) :: part(:), side
    integer, allocatable, intent(out) :: vertex(:) !< of the part, counted from 1
    type(vertex_graph), intent(out) :: region
    integer :: place(size(part)), v, k, other, used
    call list_part(part, side, vertex)
    place(vertex) = [(v - 1, v=1, size(vertex))]
    allocate (region%start(size(vertex) + 1), region%neighbour(size(graph%neighbour)))
    used = 0
    do v = 1, size(vertex)
      region%start(v) = used
      do k = graph%start(vertex(v)) + 1, graph%start(vertex(v) + 1)
        other = graph%neighbour(k) + 1
        if (part(other) /= side) cycle
        used = used + 1
        region%neighbour(used) = place(other)
      end do
    end do
    region%start(size(vertex) + 1) = used
    region%neighbour = region%neighbour(:used)
    region%weight = graph%weight(vertex)
    region%group = graph%group(vertex)
  end subroutine take_region
end module group_dissection
