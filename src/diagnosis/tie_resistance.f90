!> What ties and equations resist of the motions of rigid parts.
module tie_resistance
  use dam_mesh, only: node_tie
  use errors, only: error_type
  use kinds, only: rk
  use rigid_blocks, only: add_tie, block_set
  use small_matrix, only: cross_product
  use symmetric_modes, only: find_modes
  implicit none
  private
  public :: add_resistance, scale_parts

  !> Of the largest, in squares, in the middle of a tie and over its extent: the rows of mortar ties
  !> along a line are exact to 1e-9; a tie of one row of facets, 1:100, has 1e-4.
  real(rk), parameter :: least_of_tie = 1.0e-7_rk

contains

  !> Adds the rows of a tie to the matrix sum row^T row. A tie that nearly lies on a line or in a
  !> point counts as one that does. Equations, which may be far apart, are taken as they are.
  subroutine add_resistance(parts, x, tie, matrix, error)
    type(block_set), intent(in) :: parts
    real(rk), intent(in) :: x(:, :) !< (3, nodes) [m]
    type(node_tie), intent(in) :: tie
    real(rk), intent(inout) :: matrix(:, :) !< (6*parts, 6*parts)
    type(error_type), allocatable, intent(out) :: error
    type(block_set) :: near
    real(rk), allocatable :: own(:, :), to_near(:, :), resistance(:), motion(:, :)
    integer :: b, k
    if (allocated(tie%item_direction) .or. size(tie%node) == 0) then
      call add_tie(parts, x, tie, matrix)
      return
    end if
    near = parts
    near%centre = spread(sum(x(:, tie%node), dim=2)/size(tie%node), 2, parts%num_blocks)
    near%radius = maxval([(norm2(x(:, tie%node(k)) - near%centre(:, 1)), k=1, size(tie%node)), &
                          tiny(1.0_rk)])
    allocate (own(size(matrix, 1), size(matrix, 1)), source=0.0_rk)
    call add_tie(near, x, tie, own)
    call find_modes(own, resistance, motion, error)
    if (allocated(error)) return
    where (resistance <= least_of_tie*maxval(resistance)) resistance = 0.0_rk
    allocate (to_near(size(own, 1), size(own, 1)), source=0.0_rk)
    do b = 1, parts%num_blocks
      to_near(6*b - 5:6*b, 6*b - 5:6*b) = &
        moved_centre(near%centre(:, b) - parts%centre(:, b), parts%radius(b), near%radius(b))
    end do
    to_near = matmul(transpose(motion), to_near)
    matrix = matrix + matmul(transpose(to_near), spread(resistance, 2, size(own, 1))*to_near)
  end subroutine add_resistance

  !> The motion of a part about another centre: v + w x d, and w, both as lengths.
  pure function moved_centre(d, radius, near_radius) result(matrix)
    real(rk), intent(in) :: d(3) !< from the centre of the part to the other one [m]
    real(rk), intent(in) :: radius, near_radius !< of rotations [m]
    real(rk) :: matrix(6, 6), axis(3)
    integer :: k
    matrix = 0.0_rk
    do k = 1, 3
      axis = 0.0_rk
      axis(k) = 1.0_rk
      matrix(k, k) = 1.0_rk
      matrix(:3, 3 + k) = cross_product(axis, d)/radius
      matrix(3 + k, 3 + k) = near_radius/radius
    end do
  end function moved_centre

  !> Divides rows and columns of each part by the size of its own block: numbers of supports and of
  !> rows do not count.
  pure subroutine scale_parts(matrix)
    real(rk), intent(inout) :: matrix(:, :) !< (6*parts, 6*parts)
    real(rk) :: scale(size(matrix, 1)), trace
    integer :: b, k
    do b = 1, size(scale)/6
      trace = sum([(matrix(k, k), k=6*b - 5, 6*b)])
      scale(6*b - 5:6*b) = 1.0_rk
      if (trace > 0.0_rk) scale(6*b - 5:6*b) = 1.0_rk/sqrt(trace)
    end do
    matrix = spread(scale, 2, size(scale))*matrix*spread(scale, 1, size(scale))
  end subroutine scale_parts
end module tie_resistance
