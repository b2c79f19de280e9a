!> The order of tensor components in VTK, and the codes of its cells.
module vtk_order
  use kinds, only: rk
  implicit none
  private
  public :: tensor_in_vtk_order, tensor_names_in_vtk_order, cell_of_solid
  public :: cell_of_polygon

  integer, parameter :: cell_triangle = 5, cell_polygon = 7, cell_quad = 9
  integer, parameter :: cell_hexahedron = 12, cell_wedge = 13

contains

  !> From 11 22 33 12 13 23 to VTK's XX YY ZZ XY YZ XZ.
  pure function tensor_in_vtk_order(tensor) result(ordered)
    real(rk), intent(in) :: tensor(:, :) !< (6, n)
    real(rk) :: ordered(6, size(tensor, 2))
    ordered(:4, :) = tensor(:4, :)
    ordered(5, :) = tensor(6, :)
    ordered(6, :) = tensor(5, :)
  end function tensor_in_vtk_order

  !> 'S11,S22,S33,S12,S23,S13' for the tensor S.
  pure function tensor_names_in_vtk_order(name) result(list)
    character(*), intent(in) :: name
    character(:), allocatable :: list
    list = name//'11,'//name//'22,'//name//'33,'//name//'12,'//name//'23,'//name//'13'
  end function tensor_names_in_vtk_order

  !> The VTK cell of an 8-node solid. A hexahedron keeps the order of its nodes. A solid with one
  !> collapsed edge on each of two opposite faces becomes a wedge. Other solids with repeated nodes
  !> stay hexahedra.
  pure subroutine cell_of_solid(nodes, kind, corners, num_corners)
    integer, intent(in) :: nodes(8)
    integer, intent(out) :: kind, corners(8), num_corners
    !> Corners around two opposite faces, right-handed about the direction from the first to the
    !> second.
    integer, parameter :: near(4, 3) = reshape([1, 2, 3, 4, 1, 4, 8, 5, 1, 5, 6, 2], [4, 3])
    integer, parameter :: far(4, 3) = reshape([5, 6, 7, 8, 2, 3, 7, 6, 4, 8, 7, 3], [4, 3])
    integer :: ring, k, next
    kind = cell_hexahedron
    corners = nodes
    num_corners = 8
    if (num_distinct(nodes) /= 6) return
    do ring = 1, 3
      do k = 1, 4
        next = mod(k, 4) + 1
        if (nodes(near(k, ring)) /= nodes(near(next, ring))) cycle
        if (nodes(far(k, ring)) /= nodes(far(next, ring))) cycle
        kind = cell_wedge
        num_corners = 6
        corners = 0
        corners(:3) = nodes(without(near(:, ring), next))
        corners(4:6) = nodes(without(far(:, ring), next))
        return
      end do
    end do
  end subroutine cell_of_solid

  !> The cell of a polygon.
  pure elemental integer function cell_of_polygon(num_corners) result(kind)
    integer, intent(in) :: num_corners
    select case (num_corners)
    case (3)
      kind = cell_triangle
    case (4)
      kind = cell_quad
    case default
      kind = cell_polygon
    end select
  end function cell_of_polygon

  !> The ring without its member number `left_out`.
  pure function without(ring, left_out) result(triangle)
    integer, intent(in) :: ring(4), left_out
    integer :: triangle(3)
    triangle(:left_out - 1) = ring(:left_out - 1)
    triangle(left_out:) = ring(left_out + 1:)
  end function without

  !> How many of the nodes differ.
  pure integer function num_distinct(nodes) result(count)
    integer, intent(in) :: nodes(:)
    integer :: a
    count = 0
    do a = 1, size(nodes)
      if (.not. any(nodes(:a - 1) == nodes(a))) count = count + 1
    end do
  end function num_distinct
end module vtk_order
