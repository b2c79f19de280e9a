!> Joints as surfaces for drawing: polygons, and values at their corners.
!>
!> A corner of a joint's cells lies between nodes of the slave face. Each of these nodes contributes
!> the value of its point. At a kink a node has a point for each plane; the point in the plane of
!> the cell counts. Where points lie between the nodes (Gauss), a node contributes their mean,
!> weighted by area and shape function. A corner shared by cells in two planes is drawn twice.
module joint_surface
  use kinds, only: rk
  use joint_points, only: dam_joint, joint_cells, share_a_plane
  use problem_definition, only: problem
  use small_matrix, only: cross_product
  implicit none
  private
  public :: drawn_joints, joint_values, find_drawn_joints, nodes_to_corners
  public :: means_on_corners, heaviest_on_corners

  !> A quantity at the points of a joint.
  type :: joint_values
    real(rk), allocatable :: at(:, :) !< (components, points); unallocated: the joint has no values
    logical, allocatable :: is_absent(:) !< (points) takes no part; unallocated: none
  end type joint_values

  !> Smaller weights, and smaller differences of weights, are round-off of the clipping of facets
  !> (coordinates of order 1).
  real(rk), parameter :: nothing = 1.0e-10_rk

  !> Corners are not shared between joints.
  type :: drawn_joints
    integer :: num_cells = 0, num_corners = 0
    integer, allocatable :: first(:) !< (cells + 1) where each cell's corners start
    integer, allocatable :: corner(:) !< counter-clockwise about the normal
    integer, allocatable :: element(:) !< (cells) JOINT8 or the solid behind the slave face
    integer, allocatable :: joint(:) !< (cells) position of the joint
    integer, allocatable :: joint_of(:) !< (corners) position of the joint
    integer, allocatable :: first_node(:) !< (corners + 1) where a corner's nodes start
    integer, allocatable :: node(:) !< of the slave face, ascending
    real(rk), allocatable :: weight(:) !< they add up to 1
    integer, allocatable :: first_point(:) !< (corners + 1) where a corner's points start
    integer, allocatable :: point(:) !< of the joint
    real(rk), allocatable :: share(:) !< weight of each point
    integer, allocatable :: before(:) !< (corners) previous corner with the same first node, 0: none
  end type drawn_joints

  !> A corner of one cell.
  type :: corner_of_cell
    integer, allocatable :: node(:), point(:)
    real(rk), allocatable :: weight(:), share(:)
  end type corner_of_cell

  !> Points of each node of a joint's slave face.
  type :: node_points
    integer, allocatable :: first(:) !< (nodes of the mesh + 1)
    integer, allocatable :: point(:)
    real(rk), allocatable :: share(:) !< area times weight of the node [m2]
  end type node_points

contains

  !> Lists the cells of all joints and links their corners to points.
  subroutine find_drawn_joints(model, drawn)
    type(problem), intent(in) :: model
    type(drawn_joints), intent(out) :: drawn
    integer :: j, num_cells, num_ends
    num_cells = 0
    num_ends = 0
    do j = 1, size(model%joints)
      if (.not. allocated(model%joints(j)%cells%first)) cycle
      num_cells = num_cells + size(model%joints(j)%cells%element)
      num_ends = num_ends + size(model%joints(j)%cells%corner)
    end do
    allocate (drawn%first(num_cells + 1), source=1)
    allocate (drawn%first_node(num_ends + 1), drawn%first_point(num_ends + 1), source=1)
    allocate (drawn%element(num_cells), drawn%joint(num_cells))
    allocate (drawn%corner(num_ends), drawn%joint_of(num_ends), drawn%before(num_ends))
    allocate (drawn%node(num_ends), drawn%weight(num_ends))
    allocate (drawn%point(num_ends), drawn%share(num_ends))
    do j = 1, size(model%joints)
      if (allocated(model%joints(j)%cells%first)) call draw_joint(model, j, drawn)
    end do
    deallocate (drawn%before)
    drawn%joint_of = drawn%joint_of(:drawn%num_corners)
  end subroutine find_drawn_joints

  !> Adds the cells of one joint.
  subroutine draw_joint(model, j, drawn)
    type(problem), intent(in) :: model
    integer, intent(in) :: j !< position of the joint
    type(drawn_joints), intent(inout) :: drawn
    type(node_points) :: at_nodes
    type(corner_of_cell) :: seen
    integer :: newest(model%mesh%num_nodes), c, i, number, last
    real(rk) :: normal(3)
    call list_points(model%joints(j), model%mesh%num_nodes, at_nodes)
    newest = 0
    associate (item => model%joints(j), cells => model%joints(j)%cells)
      do c = 1, size(cells%element)
        drawn%num_cells = drawn%num_cells + 1
        drawn%element(drawn%num_cells) = cells%element(c)
        drawn%joint(drawn%num_cells) = j
        normal = normal_of_cell(model%mesh%x, item, c)
        last = drawn%first(drawn%num_cells) - 1
        do i = cells%first(c), cells%first(c + 1) - 1
          call find_nodes(cells, cells%corner(i), seen)
          call choose_points(item, at_nodes, normal, seen)
          number = find_equal_corner(drawn, newest(seen%node(1)), seen)
          if (number == 0) call add_corner(j, seen, newest(seen%node(1)), drawn, number)
          last = last + 1
          drawn%corner(last) = number
        end do
        drawn%first(drawn%num_cells + 1) = last + 1
      end do
    end associate
  end subroutine draw_joint

  !> The points at each node of the slave face.
  pure subroutine list_points(joint, num_nodes, at_nodes)
    type(dam_joint), intent(in) :: joint
    integer, intent(in) :: num_nodes !< of the mesh
    type(node_points), intent(out) :: at_nodes
    integer, allocatable :: next(:)
    integer :: p, k, n
    allocate (at_nodes%first(num_nodes + 1), source=0)
    at_nodes%first(1) = 1
    do p = 1, joint%num_points
      do k = joint%first(p), joint%first_master(p) - 1
        at_nodes%first(joint%node(k) + 1) = at_nodes%first(joint%node(k) + 1) + 1
      end do
    end do
    do n = 1, num_nodes
      at_nodes%first(n + 1) = at_nodes%first(n) + at_nodes%first(n + 1)
    end do
    next = at_nodes%first
    allocate (at_nodes%point(next(num_nodes + 1) - 1), at_nodes%share(next(num_nodes + 1) - 1))
    do p = 1, joint%num_points
      do k = joint%first(p), joint%first_master(p) - 1
        n = joint%node(k)
        at_nodes%point(next(n)) = p
        at_nodes%share(next(n)) = joint%weight(k)*joint%area(p)
        next(n) = next(n) + 1
      end do
    end do
  end subroutine list_points

  !> Normal of a cell by the right-hand rule, of any length; zero where the cell has no area.
  pure function normal_of_cell(x, joint, c) result(normal)
    real(rk), intent(in) :: x(:, :) !< (3, nodes) [m]
    type(dam_joint), intent(in) :: joint
    integer, intent(in) :: c !< cell
    real(rk) :: normal(3)
    real(rk) :: start(3), old(3), new(3)
    integer :: i
    normal = 0.0_rk
    associate (cells => joint%cells)
      start = at_corner(x, cells, cells%corner(cells%first(c)))
      new = 0.0_rk
      do i = cells%first(c) + 1, cells%first(c + 1) - 1
        old = new
        new = at_corner(x, cells, cells%corner(i)) - start
        normal = normal + cross_product(old, new)
      end do
    end associate
  end function normal_of_cell

  !> A quantity of the nodes, interpolated to a corner of a joint's cells.
  pure function at_corner(values, cells, corner) result(mean)
    real(rk), intent(in) :: values(:, :) !< (components, nodes)
    type(joint_cells), intent(in) :: cells
    integer, intent(in) :: corner
    real(rk) :: mean(size(values, 1))
    integer :: k
    mean = 0.0_rk
    do k = cells%first_node(corner), cells%first_node(corner + 1) - 1
      mean = mean + cells%weight(k)*values(:, cells%node(k))
    end do
  end function at_corner

  !> The nodes at or around a corner, ascending, each once.
  pure subroutine find_nodes(cells, corner, seen)
    type(joint_cells), intent(in) :: cells
    integer, intent(in) :: corner
    type(corner_of_cell), intent(inout) :: seen
    integer :: k, place
    seen%node = [integer ::]
    seen%weight = [real(rk) ::]
    do k = cells%first_node(corner), cells%first_node(corner + 1) - 1
      if (abs(cells%weight(k)) <= nothing) cycle
      place = findloc(seen%node, cells%node(k), dim=1)
      if (place > 0) then ! a triangle names one of its nodes twice
        seen%weight(place) = seen%weight(place) + cells%weight(k)
        cycle
      end if
      place = count(seen%node < cells%node(k))
      seen%weight = [seen%weight(:place), cells%weight(k), seen%weight(place + 1:)]
      seen%node = [seen%node(:place), cells%node(k), seen%node(place + 1:)]
    end do
    seen%weight = seen%weight/sum(seen%weight)
  end subroutine find_nodes

  !> The points that give the value of a corner in a cell. Their shares add up to 1, or to less
  !> where a node has no point (both faces share the node: nothing opens).
  pure subroutine choose_points(joint, at_nodes, normal, seen)
    type(dam_joint), intent(in) :: joint
    type(node_points), intent(in) :: at_nodes
    real(rk), intent(in) :: normal(3) !< of the cell, of any length
    type(corner_of_cell), intent(inout) :: seen
    logical, allocatable :: is_chosen(:)
    real(rk), allocatable :: part(:)
    integer :: k
    seen%point = [integer ::]
    seen%share = [real(rk) ::]
    do k = 1, size(seen%node)
      associate (first => at_nodes%first(seen%node(k)), &
                 last => at_nodes%first(seen%node(k) + 1) - 1)
        if (last < first) cycle
        is_chosen = in_plane(joint, at_nodes%point(first:last), normal)
        part = pack(at_nodes%share(first:last), is_chosen)
        seen%point = [seen%point, pack(at_nodes%point(first:last), is_chosen)]
        seen%share = [seen%share, seen%weight(k)*part/max(sum(part), tiny(1.0_rk))]
      end associate
    end do
  end subroutine choose_points

  !> Points of a node in the plane of a cell: the point with the closest normal; of points between
  !> nodes all with a close normal.
  pure function in_plane(joint, points, normal) result(is_chosen)
    type(dam_joint), intent(in) :: joint
    integer, intent(in) :: points(:)
    real(rk), intent(in) :: normal(3) !< of the cell, of any length
    logical :: is_chosen(size(points))
    real(rk) :: along(size(points))
    integer :: i
    do i = 1, size(points)
      along(i) = dot_product(joint%rotation(1, :, points(i)), normal)
      is_chosen(i) = share_a_plane(joint%rotation(1, :, points(i)), normal)
    end do
    if (any(is_chosen) .and. .not. joint%is_nodal) return
    is_chosen = .false.
    is_chosen(maxloc(along, dim=1)) = .true.
  end function in_plane

  !> The drawn corner with the same nodes and points, 0 when there is none yet.
  pure integer function find_equal_corner(drawn, newest, seen) result(found)
    type(drawn_joints), intent(in) :: drawn
    integer, intent(in) :: newest !< corner with the same first node
    type(corner_of_cell), intent(in) :: seen
    found = newest
    do while (found > 0)
      associate (n => drawn%first_node(found), p => drawn%first_point(found), &
                 num_nodes => drawn%first_node(found + 1) - drawn%first_node(found), &
                 num_points => drawn%first_point(found + 1) - drawn%first_point(found))
        if (num_nodes == size(seen%node) .and. num_points == size(seen%point)) then
          if (all(drawn%node(n:n + num_nodes - 1) == seen%node) .and. &
              all(abs(drawn%weight(n:n + num_nodes - 1) - seen%weight) <= nothing) .and. &
              all(drawn%point(p:p + num_points - 1) == seen%point)) return
        end if
      end associate
      found = drawn%before(found)
    end do
  end function find_equal_corner

  !> Adds a corner.
  pure subroutine add_corner(j, seen, newest, drawn, number)
    integer, intent(in) :: j !< joint
    type(corner_of_cell), intent(in) :: seen
    integer, intent(inout) :: newest !< corner with the same first node
    type(drawn_joints), intent(inout) :: drawn
    integer, intent(out) :: number
    drawn%num_corners = drawn%num_corners + 1
    number = drawn%num_corners
    drawn%joint_of(number) = j
    drawn%before(number) = newest
    newest = number
    call append(seen%node, seen%weight, drawn%first_node(number:number + 1), drawn%node, &
                drawn%weight)
    call append(seen%point, seen%share, drawn%first_point(number:number + 1), drawn%point, &
                drawn%share)
  end subroutine add_corner

  !> Appends members and their weights to growing lists.
  pure subroutine append(members, weights, ends, list, list_weights)
    integer, intent(in) :: members(:)
    real(rk), intent(in) :: weights(:)
    integer, intent(inout) :: ends(2) !< starts of these members and of the next
    integer, allocatable, intent(inout) :: list(:)
    real(rk), allocatable, intent(inout) :: list_weights(:)
    ends(2) = ends(1) + size(members)
    if (ends(2) - 1 > size(list)) then
      list = [list, spread(0, 1, ends(2))]
      list_weights = [list_weights, spread(0.0_rk, 1, ends(2))]
    end if
    list(ends(1):ends(2) - 1) = members
    list_weights(ends(1):ends(2) - 1) = weights
  end subroutine append

  !> Means of a quantity of points at the corners, weighted by share; zero where there is no point.
  !> Where some points are absent, the others have their shares too.
  pure subroutine means_on_corners(drawn, of_joints, means)
    type(drawn_joints), intent(in) :: drawn
    type(joint_values), intent(in) :: of_joints(:)
    real(rk), intent(out) :: means(:, :) !< (components, corners)
    real(rk) :: whole, present
    integer :: c, i
    means = 0.0_rk
    do c = 1, drawn%num_corners
      whole = 0.0_rk
      present = 0.0_rk
      associate (values => of_joints(drawn%joint_of(c)))
        if (.not. allocated(values%at)) cycle
        do i = drawn%first_point(c), drawn%first_point(c + 1) - 1
          whole = whole + drawn%share(i)
          if (.not. is_present(values, drawn%point(i))) cycle
          present = present + drawn%share(i)
          means(:, c) = means(:, c) + drawn%share(i)*values%at(:, drawn%point(i))
        end do
      end associate
      if (present > 0.0_rk .and. present < whole) means(:, c) = means(:, c)*whole/present
    end do
  end subroutine means_on_corners

  !> Whether a point of a joint takes part.
  pure logical function is_present(values, point)
    type(joint_values), intent(in) :: values
    integer, intent(in) :: point
    is_present = .true.
    if (allocated(values%is_absent)) is_present = .not. values%is_absent(point)
  end function is_present

  !> A whole number at each corner: that of the point with the largest share, of the points that are
  !> there if one is; -1 without a point.
  pure function heaviest_on_corners(drawn, of_joints) result(numbers)
    type(drawn_joints), intent(in) :: drawn
    type(joint_values), intent(in) :: of_joints(:) !< of one component
    integer :: numbers(drawn%num_corners)
    integer :: c, i, first, last
    logical, allocatable :: takes_part(:)
    numbers = -1
    do c = 1, drawn%num_corners
      first = drawn%first_point(c)
      last = drawn%first_point(c + 1) - 1
      if (last < first) cycle
      associate (values => of_joints(drawn%joint_of(c)))
        if (.not. allocated(values%at)) cycle
        takes_part = [(is_present(values, drawn%point(i)), i=first, last)]
        takes_part = takes_part .or. .not. any(takes_part)
        i = first - 1 + maxloc(abs(drawn%share(first:last)), dim=1, mask=takes_part)
        numbers(c) = nint(values%at(1, drawn%point(i)))
      end associate
    end do
  end function heaviest_on_corners

  !> A quantity of the nodes (position, displacement) at the corners, from the slave face.
  pure function nodes_to_corners(drawn, values) result(mean)
    type(drawn_joints), intent(in) :: drawn
    real(rk), intent(in) :: values(:, :) !< (3, nodes)
    real(rk) :: mean(3, drawn%num_corners)
    integer :: c, k
    mean = 0.0_rk
    do c = 1, drawn%num_corners
      do k = drawn%first_node(c), drawn%first_node(c + 1) - 1
        mean(:, c) = mean(:, c) + drawn%weight(k)*values(:, drawn%node(k))
      end do
    end do
  end function nodes_to_corners
end module joint_surface
