!> The joints as surfaces that can be drawn: polygons, and values on their corners.
!>
!> A corner of a joint's cells lies between nodes of the slave face. Each of these nodes brings the
!> value of the point that belongs to it; at a kink, where a node has a point for each plane, that
!> of the cell's own. Where points lie between the nodes (Gauss), a node brings the mean of those
!> that see it, by area and shape function. A corner that cells in two planes share is drawn twice.
module joint_surface
  use kinds, only: rk
  use joint_points, only: joint, joint_cells
  use problem_definition, only: problem
  use analysis_state, only: state
  use shape_quad4, only: cross
  implicit none
  private
  public :: drawn_joints, find_drawn_joints, values_on_corners, nodes_to_corners, &
            states_on_corners, num_values

  !> Opening, slip 1 and 2, normal and two shear tractions, part of the reach that is used.
  integer, parameter :: num_values = 7

  !> Points of a place between the nodes count for a cell whose normal is less than 30 degrees away.
  real(rk), parameter :: same_plane = 0.5_rk*sqrt(3.0_rk)

  !> Corners are not shared between joints.
  type :: drawn_joints
    integer :: num_cells = 0, num_corners = 0
    integer, allocatable :: first(:) !< (cells + 1) where each cell's corners start
    integer, allocatable :: corner(:) !< right-hand rule about the normal
    integer, allocatable :: element(:) !< (cells) JOINT8 or the solid behind the slave face
    integer, allocatable :: joint(:) !< (cells) position of the joint
    integer, allocatable :: joint_of(:) !< (corners) position of the joint
    integer, allocatable :: corner_of(:) !< (corners) the corner of the joint's cells
    integer, allocatable :: first_point(:) !< (corners + 1) where a corner's points start
    integer, allocatable :: point(:) !< of the joint
    real(rk), allocatable :: share(:) !< what each brings
    integer, allocatable :: before(:) !< (corners) the last one of the same corner of cells, 0: none
  end type drawn_joints

  !> Which points belong to the nodes of a joint's slave face.
  type :: node_points
    integer, allocatable :: first(:) !< (nodes of the mesh + 1)
    integer, allocatable :: point(:)
    real(rk), allocatable :: share(:) !< area times weight of the node [m2]
  end type node_points

contains

  !> Takes the cells of all joints and links their corners to points.
  subroutine find_drawn_joints(scene, drawn)
    type(problem), intent(in) :: scene
    type(drawn_joints), intent(out) :: drawn
    integer :: j, num_cells, num_ends
    num_cells = 0
    num_ends = 0
    do j = 1, size(scene%joints)
      if (.not. allocated(scene%joints(j)%cells%first)) cycle
      num_cells = num_cells + size(scene%joints(j)%cells%element)
      num_ends = num_ends + size(scene%joints(j)%cells%corner)
    end do
    allocate (drawn%first(num_cells + 1), drawn%first_point(num_ends + 1), source=1)
    allocate (drawn%element(num_cells), drawn%joint(num_cells))
    allocate (drawn%corner(num_ends), drawn%joint_of(num_ends), drawn%corner_of(num_ends), &
              drawn%before(num_ends))
    allocate (drawn%point(num_ends), drawn%share(num_ends))
    do j = 1, size(scene%joints)
      if (allocated(scene%joints(j)%cells%first)) call draw_joint(scene, j, drawn)
    end do
    deallocate (drawn%before)
    drawn%joint_of = drawn%joint_of(:drawn%num_corners)
    drawn%corner_of = drawn%corner_of(:drawn%num_corners)
  end subroutine find_drawn_joints

  !> Adds the cells of one joint.
  subroutine draw_joint(scene, j, drawn)
    type(problem), intent(in) :: scene
    integer, intent(in) :: j !< position of the joint
    type(drawn_joints), intent(inout) :: drawn
    type(node_points) :: at_nodes
    integer, allocatable :: newest(:), points(:)
    real(rk), allocatable :: shares(:)
    real(rk) :: normal(3)
    integer :: c, i, number, last
    call list_points(scene%joints(j), scene%mesh%num_nodes, at_nodes)
    associate (item => scene%joints(j), cells => scene%joints(j)%cells)
      allocate (newest(size(cells%first_node) - 1), source=0)
      do c = 1, size(cells%element)
        drawn%num_cells = drawn%num_cells + 1
        drawn%element(drawn%num_cells) = cells%element(c)
        drawn%joint(drawn%num_cells) = j
        normal = normal_of_cell(scene%mesh%x, item, c)
        last = drawn%first(drawn%num_cells) - 1
        do i = cells%first(c), cells%first(c + 1) - 1
          call choose_points(item, at_nodes, cells%corner(i), normal, points, shares)
          number = copy_with(drawn, newest(cells%corner(i)), points)
          if (number == 0) then
            call add_corner(j, cells%corner(i), points, shares, newest(cells%corner(i)), drawn)
            number = drawn%num_corners
          end if
          last = last + 1
          drawn%corner(last) = number
        end do
        drawn%first(drawn%num_cells + 1) = last + 1
      end do
    end associate
  end subroutine draw_joint

  !> The points at each node of the slave face.
  pure subroutine list_points(item, num_nodes, at_nodes)
    type(joint), intent(in) :: item
    integer, intent(in) :: num_nodes !< of the mesh
    type(node_points), intent(out) :: at_nodes
    integer, allocatable :: next(:)
    integer :: p, k, n
    allocate (at_nodes%first(num_nodes + 1), source=0)
    at_nodes%first(1) = 1
    do p = 1, item%num_points
      do k = item%first(p), item%first_master(p) - 1
        at_nodes%first(item%node(k) + 1) = at_nodes%first(item%node(k) + 1) + 1
      end do
    end do
    do n = 1, num_nodes
      at_nodes%first(n + 1) = at_nodes%first(n) + at_nodes%first(n + 1)
    end do
    next = at_nodes%first
    allocate (at_nodes%point(next(num_nodes + 1) - 1), at_nodes%share(next(num_nodes + 1) - 1))
    do p = 1, item%num_points
      do k = item%first(p), item%first_master(p) - 1
        n = item%node(k)
        at_nodes%point(next(n)) = p
        at_nodes%share(next(n)) = item%weight(k)*item%area(p)
        next(n) = next(n) + 1
      end do
    end do
  end subroutine list_points

  !> Normal of a cell by the right-hand rule, of any length; zero where the cell has no area.
  pure function normal_of_cell(x, item, c) result(normal)
    real(rk), intent(in) :: x(:, :) !< (3, nodes) [m]
    type(joint), intent(in) :: item
    integer, intent(in) :: c !< cell
    real(rk) :: normal(3)
    real(rk) :: start(3), old(3), new(3)
    integer :: i
    normal = 0.0_rk
    associate (cells => item%cells)
      start = at_corner(x, cells, cells%corner(cells%first(c)))
      new = 0.0_rk
      do i = cells%first(c) + 1, cells%first(c + 1) - 1
        old = new
        new = at_corner(x, cells, cells%corner(i)) - start
        normal = normal + cross(old, new)
      end do
    end associate
  end function normal_of_cell

  !> A quantity of the nodes at a corner of a joint's cells.
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

  !> The points that a corner shows in a cell; their shares add up to 1, or to less where a node has
  !> none (both faces hang together there: nothing opens).
  pure subroutine choose_points(item, at_nodes, corner, normal, points, shares)
    type(joint), intent(in) :: item
    type(node_points), intent(in) :: at_nodes
    integer, intent(in) :: corner
    real(rk), intent(in) :: normal(3) !< of the cell, of any length
    integer, allocatable, intent(out) :: points(:)
    real(rk), allocatable, intent(out) :: shares(:)
    real(rk), allocatable :: along(:), part(:)
    logical, allocatable :: is_chosen(:)
    integer :: k, i
    points = [integer ::]
    shares = [real(rk) ::]
    do k = item%cells%first_node(corner), item%cells%first_node(corner + 1) - 1
      associate (first => at_nodes%first(item%cells%node(k)), &
                 last => at_nodes%first(item%cells%node(k) + 1) - 1)
        if (last < first) cycle
        along = [(dot_product(item%rotation(1, :, at_nodes%point(i)), normal), i=first, last)]
        is_chosen = along >= min(maxval(along), same_plane*norm2(normal))
        if (item%is_nodal) then
          is_chosen = .false.
          is_chosen(maxloc(along, dim=1)) = .true.
        end if
        part = pack(at_nodes%share(first:last), is_chosen)
        points = [points, pack(at_nodes%point(first:last), is_chosen)]
        shares = [shares, item%cells%weight(k)*part/max(sum(part), tiny(1.0_rk))]
      end associate
    end do
  end subroutine choose_points

  !> The copy of a corner that shows these points, 0 when there is none yet.
  pure integer function copy_with(drawn, newest, points) result(found)
    type(drawn_joints), intent(in) :: drawn
    integer, intent(in) :: newest !< copy of the corner
    integer, intent(in) :: points(:)
    integer :: first, last
    found = newest
    do while (found > 0)
      first = drawn%first_point(found)
      last = drawn%first_point(found + 1) - 1
      if (last - first + 1 == size(points)) then
        if (all(drawn%point(first:last) == points)) return
      end if
      found = drawn%before(found)
    end do
  end function copy_with

  !> Adds a copy of a corner.
  pure subroutine add_corner(j, corner, points, shares, newest, drawn)
    integer, intent(in) :: j, corner !< joint, corner of its cells
    integer, intent(in) :: points(:)
    real(rk), intent(in) :: shares(:)
    integer, intent(inout) :: newest !< copy of this corner
    type(drawn_joints), intent(inout) :: drawn
    integer :: first, last
    drawn%num_corners = drawn%num_corners + 1
    drawn%joint_of(drawn%num_corners) = j
    drawn%corner_of(drawn%num_corners) = corner
    drawn%before(drawn%num_corners) = newest
    newest = drawn%num_corners
    first = drawn%first_point(newest)
    last = first + size(points) - 1
    if (last > size(drawn%point)) then
      drawn%point = [drawn%point, spread(0, 1, size(drawn%point) + last)]
      drawn%share = [drawn%share, spread(0.0_rk, 1, size(drawn%share) + last)]
    end if
    drawn%point(first:last) = points
    drawn%share(first:last) = shares
    drawn%first_point(newest + 1) = last + 1
  end subroutine add_corner

  !> Opening [m], slip [m], traction [Pa], used reach on the corners; zero where there is no point.
  subroutine values_on_corners(scene, now, drawn, values)
    type(problem), intent(in) :: scene
    type(state), intent(in) :: now
    type(drawn_joints), intent(in) :: drawn
    real(rk), intent(out) :: values(:, :) !< (num_values, corners)
    real(rk) :: used
    integer :: c, i, p
    values = 0.0_rk
    do c = 1, drawn%num_corners
      associate (seam => now%joints(drawn%joint_of(c)), mean => values(:, c), &
                 reach => scene%joints(drawn%joint_of(c))%reach)
        do i = drawn%first_point(c), drawn%first_point(c + 1) - 1
          p = drawn%point(i)
          used = 0.0_rk
          if (reach(p) < huge(1.0_rk)) used = hypot(seam%jump(2, p), seam%jump(3, p))/reach(p)
          mean = mean + drawn%share(i)*[seam%jump(1, p) + seam%gap(p), seam%slip(:, p), &
                                        seam%traction(:, p), used]
        end do
      end associate
    end do
  end subroutine values_on_corners

  !> The state of the point that weighs most at each corner; -1 where there is none.
  pure function states_on_corners(now, drawn) result(status)
    type(state), intent(in) :: now
    type(drawn_joints), intent(in) :: drawn
    integer :: status(drawn%num_corners)
    integer :: c, first, last
    do c = 1, drawn%num_corners
      status(c) = -1
      first = drawn%first_point(c)
      last = drawn%first_point(c + 1) - 1
      if (last < first) cycle
      associate (most => drawn%point(first - 1 + maxloc(abs(drawn%share(first:last)), dim=1)))
        status(c) = now%joints(drawn%joint_of(c))%status(most)
      end associate
    end do
  end function states_on_corners

  !> A quantity of the nodes (place, displacement) on the corners: that of the slave face.
  pure function nodes_to_corners(scene, drawn, values) result(mean)
    type(problem), intent(in) :: scene
    type(drawn_joints), intent(in) :: drawn
    real(rk), intent(in) :: values(:, :) !< (3, nodes)
    real(rk) :: mean(3, drawn%num_corners)
    integer :: c
    do c = 1, drawn%num_corners
      mean(:, c) = at_corner(values, scene%joints(drawn%joint_of(c))%cells, drawn%corner_of(c))
    end do
  end function nodes_to_corners
end module joint_surface
