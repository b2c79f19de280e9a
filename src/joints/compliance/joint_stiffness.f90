!> Adds the stiffness of joints, given the rows of their jump operator B (v = B q).
module joint_stiffness
  use kinds, only: rk
  use joint_rows, only: num_axes, row_of
  use matrix_pattern, only: pattern, add_block
  use sorted_lists, only: sorted_unique, place_in
  implicit none
  private
  public :: add_joint_stiffness

contains

  !> Adds B^T (area D) B, point by point. In a symmetric matrix the symmetric part of D counts.
  subroutine add_joint_stiffness(row_start, unknown, coefficient, area, is_here, tangent, matrix, &
                                 values)
    integer, intent(in) :: row_start(:) !< (rows + 1) of B
    integer, intent(in) :: unknown(:) !< columns of B
    real(rk), intent(in) :: coefficient(:) !< values of B
    real(rk), intent(in) :: area(:) !< (points) [m2]
    logical, intent(in) :: is_here(:) !< (points) to be added by this rank
    real(rk), intent(in) :: tangent(:, :, :) !< (3, 3, points) D [Pa/m]
    type(pattern), intent(in) :: matrix
    real(rk), intent(inout) :: values(:)
    integer, allocatable :: column(:)
    real(rk), allocatable :: b(:, :)
    real(rk) :: d(3, 3)
    integer :: p, row, first, last
    do p = 1, size(area)
      if (.not. is_here(p)) cycle
      d = tangent(:, :, p)
      if (matrix%is_symmetric) d = 0.5_rk*(d + transpose(d))
      row = row_of(p, 1)
      first = row_start(row)
      last = row_start(row + num_axes) - 1
      call gather_rows(row_start(row:row + num_axes) - first + 1, unknown(first:last), &
                       coefficient(first:last), column, b)
      call add_block(matrix, column, area(p)*matmul(transpose(b), matmul(d, b)), values)
    end do
  end subroutine add_joint_stiffness

  !> The three rows of a point as a dense matrix over its unknowns.
  subroutine gather_rows(start, unknown, coefficient, column, b)
    integer, intent(in) :: start(num_axes + 1) !< of each row in the lists that follow
    integer, intent(in) :: unknown(:)
    real(rk), intent(in) :: coefficient(:)
    integer, allocatable, intent(out) :: column(:) !< the unknowns, ascending
    real(rk), allocatable, intent(out) :: b(:, :) !< (3, columns)
    integer :: i, k
    column = sorted_unique(unknown)
    allocate (b(num_axes, size(column)), source=0.0_rk)
    do i = 1, num_axes
      do k = start(i), start(i + 1) - 1
        associate (place => place_in(column, unknown(k)))
          b(i, place) = b(i, place) + coefficient(k)
        end associate
      end do
    end do
  end subroutine gather_rows
end module joint_stiffness
