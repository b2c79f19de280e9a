!> The joints as surfaces that can be drawn: their quadrilaterals, and values on their corners.
module joint_surface
  use kinds, only: rk
  use problem_definition, only: problem
  use analysis_state, only: state
  implicit none
  private
  public :: drawn_joints, find_drawn_joints, values_on_corners, num_values

  integer, parameter :: num_values = 6 !< opening, slip 1 and 2, normal and two shear tractions

  !> Corners are not shared between joints; they lie where the master nodes are.
  type :: drawn_joints
    integer, allocatable :: quad(:, :) !< (4, quads) corners
    integer, allocatable :: element(:), joint(:) !< (quads) JOINT8 element and joint, positions
    integer, allocatable :: node(:) !< (corners) master node
    integer, allocatable :: corner_of(:) !< (links) corner that ...
    integer, allocatable :: joint_of(:), point_of(:) !< (links) ... this point of a joint feeds ...
    real(rk), allocatable :: weight(:) !< (links) ... with this weight; their sum is 1 or 0
  end type drawn_joints

contains

  !> Finds the JOINT8 elements of each joint and links their corners to its points.
  subroutine find_drawn_joints(scene, drawn)
    type(problem), intent(in) :: scene
    type(drawn_joints), intent(out) :: drawn
    integer, allocatable :: owner(:), corner_at(:)
    integer :: j, e, a, node
    allocate (drawn%quad(4, 0), drawn%element(0), drawn%joint(0), drawn%node(0))
    allocate (drawn%corner_of(0), drawn%joint_of(0), drawn%point_of(0), drawn%weight(0))
    call find_owners(scene, owner)
    do j = 1, size(scene%joints)
      allocate (corner_at(scene%mesh%num_nodes), source=0)
      do e = 1, scene%mesh%num_elements
        if (owner(e) /= j) cycle
        do a = 1, 4
          node = scene%mesh%nodes(a, e)
          if (corner_at(node) > 0) cycle
          drawn%node = [drawn%node, node]
          corner_at(node) = size(drawn%node)
        end do
        drawn%element = [drawn%element, e]
        drawn%joint = [drawn%joint, j]
        drawn%quad = reshape([drawn%quad, corner_at(scene%mesh%nodes(1:4, e))], &
                             [4, size(drawn%element)])
      end do
      call link_points(scene, j, corner_at, drawn)
      deallocate (corner_at)
    end do
    call make_means(drawn)
  end subroutine find_drawn_joints

  !> The joint of each JOINT8 element: the one that holds most of its pairs of nodes.
  subroutine find_owners(scene, owner)
    type(problem), intent(in) :: scene
    integer, allocatable, intent(out) :: owner(:) !< (elements) 0: none
    integer, allocatable :: hits(:), partner(:, :)
    integer :: j, p, e
    allocate (owner(scene%mesh%num_elements), source=0)
    allocate (hits(scene%mesh%num_elements), source=0)
    do j = 1, size(scene%joints)
      associate (item => scene%joints(j))
        allocate (partner(2, scene%mesh%num_nodes), source=0)
        do p = 1, item%num_points
          partner(2, item%node(item%first(p):item%first_master(p) - 1)) = 1
          partner(1, item%node(item%first_master(p):item%first(p + 1) - 1)) = 1
        end do
      end associate
      do e = 1, scene%mesh%num_elements
        if (scene%mesh%element_type(e) /= 'JOINT8') cycle
        p = sum(partner(1, scene%mesh%nodes(1:4, e))*partner(2, scene%mesh%nodes(5:8, e)))
        if (p <= hits(e)) cycle
        hits(e) = p
        owner(e) = j
      end do
      deallocate (partner)
    end do
  end subroutine find_owners

  !> Which points feed which corners.
  subroutine link_points(scene, j, corner_at, drawn)
    type(problem), intent(in) :: scene
    integer, intent(in) :: j, corner_at(:)
    type(drawn_joints), intent(inout) :: drawn
    integer :: p, k, corner
    associate (item => scene%joints(j))
      do p = 1, item%num_points
        do k = item%first_master(p), item%first(p + 1) - 1
          corner = corner_at(item%node(k))
          if (corner == 0) cycle
          drawn%corner_of = [drawn%corner_of, corner]
          drawn%joint_of = [drawn%joint_of, j]
          drawn%point_of = [drawn%point_of, p]
          drawn%weight = [drawn%weight, -item%weight(k)*item%area(p)]
        end do
      end do
    end associate
  end subroutine link_points

  !> Divides the weights by their sum at each corner.
  subroutine make_means(drawn)
    type(drawn_joints), intent(inout) :: drawn
    real(rk) :: total(size(drawn%node))
    integer :: i
    total = 0.0_rk
    do i = 1, size(drawn%weight)
      total(drawn%corner_of(i)) = total(drawn%corner_of(i)) + drawn%weight(i)
    end do
    do i = 1, size(drawn%weight)
      if (total(drawn%corner_of(i)) > 0.0_rk) then
        drawn%weight(i) = drawn%weight(i)/total(drawn%corner_of(i))
      end if
    end do
  end subroutine make_means

  !> Opening [m], slip [m] and traction [Pa] on the corners; zero where a corner has no point.
  subroutine values_on_corners(now, drawn, values)
    type(state), intent(in) :: now
    type(drawn_joints), intent(in) :: drawn
    real(rk), intent(out) :: values(:, :) !< (num_values, corners)
    integer :: i, p
    values = 0.0_rk
    do i = 1, size(drawn%weight)
      p = drawn%point_of(i)
      associate (joint => now%joints(drawn%joint_of(i)), at_corner => values(:, drawn%corner_of(i)))
        at_corner(1) = at_corner(1) + drawn%weight(i)* &
                       (joint%jump(1, p) + joint%gap(p))
        at_corner(2:3) = at_corner(2:3) + drawn%weight(i)*joint%slip(:, p)
        at_corner(4:6) = at_corner(4:6) + drawn%weight(i)*joint%traction(:, p)
      end associate
    end do
  end subroutine values_on_corners
end module joint_surface
