!> The product of a sparse symmetric matrix with two vectors: the matrix is read once.
module pair_product
  use global_vectors, only: multiply
  use kinds, only: rk
  use matrix_pattern, only: pattern
  use ranks, only: add_over_ranks
  implicit none
  private
  public :: multiply_pair

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
    allocate (x(2, matrix%num_total))
    allocate (y(2, matrix%num_total), source=0.0_rk)
    x(1, :) = x1
    x(2, :) = x2
    call add_columns(matrix, values, x, y)
    y1 = y(1, :)
    y2 = y(2, :)
    if (.not. matrix%is_shared) return
    call add_over_ranks(y1)
    call add_over_ranks(y2)
  end subroutine multiply_pair

  !> Adds the products of all columns and of their mirror images.
  pure subroutine add_columns(matrix, values, x, y)
    type(pattern), intent(in) :: matrix !< symmetric
    real(rk), contiguous, intent(in) :: values(:)
    real(rk), contiguous, intent(in) :: x(:, :) !< (2, num_total)
    real(rk), contiguous, intent(inout) :: y(:, :) !< (2, num_total)
    integer :: j
    j = 1
    do while (j <= matrix%num_total)
      if (matrix%alike(j) >= 3) then
        call add_three(values, matrix%row, matrix%column_start(j:j + 3), j, x, y)
        j = j + 3
      else
        call add_one(values, matrix%row, matrix%column_start(j:j + 1), j, x, y)
        j = j + 1
      end if
    end do
  end subroutine add_columns

  !> One column.
  pure subroutine add_one(values, row, start, j, x, y)
    real(rk), contiguous, intent(in) :: values(:)
    integer, contiguous, intent(in) :: row(:)
    integer, intent(in) :: start(2) !< of the column and of the next one
    integer, intent(in) :: j !< the column
    real(rk), contiguous, intent(in) :: x(:, :)
    real(rk), contiguous, intent(inout) :: y(:, :)
    real(rk) :: own(2), sum_j(2)
    integer :: k, i
    own = x(:, j)
    sum_j = values(start(1))*own
    do k = start(1) + 1, start(2) - 1
      i = row(k)
      sum_j = sum_j + values(k)*x(:, i)
      y(:, i) = y(:, i) + values(k)*own
    end do
    y(:, j) = y(:, j) + sum_j
  end subroutine add_one

  !> Three columns of one node: rows are read once for all.
  pure subroutine add_three(values, row, start, j, x, y)
    real(rk), contiguous, intent(in) :: values(:)
    integer, contiguous, intent(in) :: row(:)
    integer, intent(in) :: start(4) !< of the columns and of the next one
    integer, intent(in) :: j !< the first column
    real(rk), contiguous, intent(in) :: x(:, :)
    real(rk), contiguous, intent(inout) :: y(:, :)
    real(rk), dimension(2) :: q1, q2, q3, y1, y2, y3
    real(rk) :: a, b, c
    integer :: k, i
    q1 = x(:, j)
    q2 = x(:, j + 1)
    q3 = x(:, j + 2)
    associate (first => start(1), second => start(2), third => start(3))
      y1 = values(first)*q1 + values(first + 1)*q2 + values(first + 2)*q3
      y2 = values(first + 1)*q1 + values(second)*q2 + values(second + 1)*q3
      y3 = values(first + 2)*q1 + values(second + 1)*q2 + values(third)*q3
      do k = 1, start(4) - third - 1
        i = row(third + k)
        a = values(first + 2 + k)
        b = values(second + 1 + k)
        c = values(third + k)
        y1 = y1 + a*x(:, i)
        y2 = y2 + b*x(:, i)
        y3 = y3 + c*x(:, i)
        y(:, i) = y(:, i) + a*q1 + b*q2 + c*q3
      end do
    end associate
    y(:, j) = y(:, j) + y1
    y(:, j + 1) = y(:, j + 1) + y2
    y(:, j + 2) = y(:, j + 2) + y3
  end subroutine add_three
end module pair_product
