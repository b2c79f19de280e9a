!> Compliance of the structure at the points of its joints, G = B K_0^-1 B^T, by solves.
module joint_compliance
  use kinds, only: rk
  use errors, only: error_type
  use joint_rows, only: num_rows
  use linear_solver, only: equation_solver
  use joint_operator, only: jump_operator
  implicit none
  private
  public :: find_compliance

  integer, parameter :: block_size = 48 !< right-hand sides solved at once

contains

  !> Computes G by solves with blocks of right-hand sides.
  subroutine find_compliance(factor, operator, num_free, compliance, error)
    class(equation_solver), intent(inout) :: factor !< of K_0
    type(jump_operator), intent(in) :: operator
    integer, intent(in) :: num_free
    real(rk), allocatable, intent(out) :: compliance(:, :) !< (rows, rows) [m/N]
    type(error_type), allocatable, intent(out) :: error
    real(rk), allocatable :: b(:, :)
    integer :: m, first, last, row
    m = num_rows(operator%num_points)
    allocate (compliance(m, m), b(num_free, min(block_size, m)))
    do first = 1, m, block_size
      last = min(first + block_size - 1, m)
      b = 0.0_rk
      do row = first, last
        call spread_row(operator, row, b(:, row - first + 1))
      end do
      call factor%solve(b, error)
      if (allocated(error)) return
      do row = first, last
        call apply_rows(operator, b(:, row - first + 1), compliance(:, row))
      end do
    end do
    compliance = 0.5_rk*(compliance + transpose(compliance))
  end subroutine find_compliance

  !> One row of B as a column over the free unknowns.
  pure subroutine spread_row(operator, row, column)
    type(jump_operator), intent(in) :: operator
    integer, intent(in) :: row
    real(rk), intent(inout) :: column(:) !< zero on entry
    integer :: k
    do k = operator%row_start(row), operator%row_start(row + 1) - 1
      if (operator%unknown(k) <= size(column)) column(operator%unknown(k)) = operator%coefficient(k)
    end do
  end subroutine spread_row

  !> B times a column over the free unknowns.
  pure subroutine apply_rows(operator, column, product)
    type(jump_operator), intent(in) :: operator
    real(rk), intent(in) :: column(:)
    real(rk), intent(out) :: product(:) !< (rows)
    integer :: row, k
    do row = 1, size(product)
      product(row) = 0.0_rk
      do k = operator%row_start(row), operator%row_start(row + 1) - 1
        if (operator%unknown(k) > size(column)) cycle
        product(row) = product(row) + operator%coefficient(k)*column(operator%unknown(k))
      end do
    end do
  end subroutine apply_rows
end module joint_compliance
