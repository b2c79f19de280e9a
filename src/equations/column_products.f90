!> Products of a sparse matrix with two or many vectors: a symmetric matrix is read once for all.
module column_products
  use global_vectors, only: multiply
  use kinds, only: rk
  use matrix_pattern, only: pattern
  use symmetric_product, only: keyway_multiply_eight, keyway_multiply_two
  implicit none
  private
  public :: multiply_columns, multiply_pair

  integer, parameter :: num_together = 8

contains

  !> y1 = A x1 and y2 = A x2 over all unknowns, prescribed ones included.
  subroutine multiply_pair(matrix, values, x1, x2, y1, y2)
    type(pattern), intent(in) :: matrix
    real(rk), contiguous, intent(in) :: values(:) !< of A
    real(rk), intent(in) :: x1(:), x2(:) !< (num_total)
    real(rk), contiguous, intent(out) :: y1(:), y2(:) !< (num_total)
    real(rk), allocatable :: x(:, :), y(:, :)
    if (.not. matrix%is_symmetric) then
      call multiply(matrix, values, x1, y1)
      call multiply(matrix, values, x2, y2)
      return
    end if
    allocate (x(2, matrix%num_total), y(2, matrix%num_total))
    x(1, :) = x1
    x(2, :) = x2
    call keyway_multiply_two(matrix%num_total, size(values), matrix%column_start, matrix%alike, &
                             matrix%row, values, x, y)
    y1 = y(1, :)
    y2 = y(2, :)
    if (.not. matrix%is_shared) return
    call matrix%part%add(y1)
    call matrix%part%add(y2)
  end subroutine multiply_pair

  !> y = A x for each column, over the free unknowns; prescribed ones are zero.
  subroutine multiply_columns(matrix, values, x, y)
    type(pattern), intent(in) :: matrix
    real(rk), intent(in), contiguous :: values(:) !< of A
    real(rk), intent(in) :: x(:, :) !< (num_free, columns)
    real(rk), intent(out) :: y(:, :) !< (num_free, columns)
    integer :: first
    if (matrix%is_symmetric .and. .not. matrix%is_shared) then
      do first = 1, size(x, 2), num_together
        associate (last => min(first + num_together - 1, size(x, 2)))
          call multiply_together(matrix, values, x(:, first:last), y(:, first:last))
        end associate
      end do
    else
      call multiply_each(matrix, values, x, y)
    end if
  end subroutine multiply_columns

  !> The product with up to eight columns.
  subroutine multiply_together(matrix, values, x, y)
    type(pattern), intent(in) :: matrix !< symmetric
    real(rk), intent(in), contiguous :: values(:)
    real(rk), intent(in) :: x(:, :)
    real(rk), intent(out) :: y(:, :)
    real(rk), allocatable :: side_by_side(:, :), product(:, :)
    integer :: i
    allocate (side_by_side(num_together, matrix%num_total), source=0.0_rk)
    allocate (product(num_together, matrix%num_total))
    do i = 1, size(x, 1)
      side_by_side(:size(x, 2), i) = x(i, :)
    end do
    call keyway_multiply_eight(matrix%num_total, size(values), matrix%column_start, &
                               matrix%alike, matrix%row, values, side_by_side, product)
    do i = 1, size(y, 1)
      y(i, :) = product(:size(y, 2), i)
    end do
  end subroutine multiply_together

  !> The product with one column after the other.
  subroutine multiply_each(matrix, values, x, y)
    type(pattern), intent(in) :: matrix
    real(rk), intent(in), contiguous :: values(:)
    real(rk), intent(in) :: x(:, :)
    real(rk), intent(out) :: y(:, :)
    real(rk), dimension(matrix%num_total) :: column, product
    integer :: k
    column = 0.0_rk
    do k = 1, size(x, 2)
      column(:size(x, 1)) = x(:, k)
      call multiply(matrix, values, column, product)
      y(:, k) = product(:size(y, 1))
    end do
  end subroutine multiply_each
end module column_products
