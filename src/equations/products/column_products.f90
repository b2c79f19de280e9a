!> Products of a sparse matrix with many vectors.
module column_products
  use, intrinsic :: iso_c_binding, only: c_double, c_int
  use global_vectors, only: multiply
  use kinds, only: rk
  use matrix_pattern, only: pattern
  implicit none
  private
  public :: multiply_columns

  integer, parameter :: num_together = 8

  interface
    subroutine keyway_multiply_eight(unknowns, entries, start, row, value, x, y) bind(c)
      import :: c_double, c_int
      implicit none
      integer(c_int), value :: unknowns, entries
      integer(c_int), intent(in) :: start(unknowns + 1), row(entries)
      real(c_double), intent(in) :: value(entries)
      real(c_double), intent(in) :: x(8, unknowns)
      real(c_double), intent(out) :: y(8, unknowns)
    end subroutine keyway_multiply_eight
  end interface

contains

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
    call keyway_multiply_eight(matrix%num_total, size(values), matrix%column_start, matrix%row, &
                               values, side_by_side, product)
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
