!> What results draw of a joint made of JOINT8 elements: their slave faces.
module joint8_cells
  use dam_mesh, only: mesh
  use joint_points, only: joint
  use kinds, only: rk
  implicit none
  private
  public :: draw_elements

contains

  !> Fills the cells of a joint: one for each element, one corner for each slave node. A face with
  !> repeated nodes becomes a triangle.
  pure subroutine draw_elements(model, elements, side, built)
    type(mesh), intent(in) :: model
    integer, intent(in) :: elements(:) !< positions of JOINT8 elements
    integer, intent(in) :: side(:) !< 1: normal by nodes 5-6-7-8, -1: against it
    type(joint), intent(inout) :: built
    integer, allocatable :: corner_of_node(:), node_of_corner(:), first(:), corner(:)
    integer :: ring(4), e, a, k, num_corners, last, node
    allocate (corner_of_node(model%num_nodes), node_of_corner(4*size(elements)), source=0)
    allocate (first(size(elements) + 1), corner(4*size(elements)), source=1)
    num_corners = 0
    last = 0
    do e = 1, size(elements)
      ring = model%nodes(5:8, elements(e))
      if (side(e) < 0) ring = ring([1, 4, 3, 2])
      do a = 1, 4
        node = ring(a)
        if (any(ring(:a - 1) == node)) cycle
        if (corner_of_node(node) == 0) then
          num_corners = num_corners + 1
          corner_of_node(node) = num_corners
          node_of_corner(num_corners) = node
        end if
        last = last + 1
        corner(last) = corner_of_node(node)
      end do
      first(e + 1) = last + 1
    end do
    built%cells%element = elements
    built%cells%first = first
    built%cells%corner = corner(:last)
    built%cells%first_node = [(k, k=1, num_corners + 1)]
    built%cells%node = node_of_corner(:num_corners)
    built%cells%weight = spread(1.0_rk, 1, num_corners)
  end subroutine draw_elements
end module joint8_cells
