!> Estimates the condition of a factored symmetric matrix.
!>
!> The matrix is scaled to a unit diagonal, S = D^-1/2 K D^-1/2, because unknowns of different
!> stiffness (jumps of a stiff joint, displacements) cost a Cholesky factor no digits. The result
!> is |S|_1 |S^-1|_1. The second norm is estimated by Hager and Higham (Higham 1988, ACM TOMS 14;
!> LAPACK's dlacn2) with 4 or 5 solves: a lower bound, mostly exact to a factor of 3.
module matrix_condition
  use kinds, only: rk
  use errors, only: error_type
  use global_vectors, only: diagonal, largest_entry, norm
  use matrix_pattern, only: pattern
  use ranks, only: gather_rows, this_rank
  use unknown_layout, only: num_rows, own_rows, row_layout
  use linear_solver, only: equation_solver
  implicit none
  private
  public :: estimate_condition

  !> Residual of a solve by iteration, over its right-hand side: an estimate to a factor of 3 needs
  !> no more.
  real(rk), parameter :: solve_residual = 1.0e-3_rk

  interface
    subroutine dlacn2(n, v, x, isgn, est, kase, isave)
      import :: rk
      implicit none
      integer, intent(in) :: n
      real(rk), intent(inout) :: v(n), x(n), est
      integer, intent(inout) :: isgn(n), kase, isave(3)
    end subroutine dlacn2
  end interface

contains

  !> Estimates the condition of the free part of the matrix that the solver has factored.
  subroutine estimate_condition(matrix, values, factor, condition, error)
    type(pattern), intent(in) :: matrix !< symmetric
    real(rk), intent(in) :: values(:)
    class(equation_solver), intent(inout) :: factor
    real(rk), intent(out) :: condition
    type(error_type), allocatable, intent(out) :: error
    real(rk), allocatable :: root(:), x(:), v(:)
    integer, allocatable :: sign_of(:)
    integer :: n, kase, kept(3)
    n = matrix%num_free
    if (matrix%part%is_divided) n = num_rows(matrix%layout)
    condition = 0.0_rk
    if (n == 0) return
    allocate (root(matrix%num_total), v(n), x(n), sign_of(n))
    call diagonal(matrix, values, root)
    root = sqrt(root(:matrix%num_free))
    kase = 0
    do
      call dlacn2(n, v, x, sign_of, condition, kase, kept)
      if (kase == 0) exit
      call solve_scaled(matrix, root, factor, x, error)
      if (allocated(error)) return
    end do
    condition = condition*scaled_norm(matrix, values, root)
  end subroutine estimate_condition

  !> x = S^-1 x, in place. Where vectors are divided x has the rows of all ranks; rows without an
  !> unknown keep their entries.
  subroutine solve_scaled(matrix, root, factor, x, error)
    type(pattern), intent(in) :: matrix
    real(rk), intent(in) :: root(:) !< (num_free)
    class(equation_solver), intent(inout) :: factor
    real(rk), intent(inout) :: x(:) !< (num_free, or rows of all ranks)
    type(error_type), allocatable, intent(out) :: error
    real(rk) :: own(size(root), 1)
    if (matrix%part%is_divided) then
      own(:, 1) = root*x(matrix%layout%row + 1)
    else
      own(:, 1) = root*x
    end if
    call factor%solve_within(solve_residual*norm(matrix%part, own(:, 1)), own, error)
    if (allocated(error)) return
    own(:, 1) = root*own(:, 1)
    if (matrix%part%is_divided) then
      call put_rows(matrix%layout, own(:, 1), x)
    else
      x = own(:, 1)
    end if
  end subroutine solve_scaled

  !> Puts the own rows of all ranks together.
  subroutine put_rows(layout, own, x)
    type(row_layout), intent(in) :: layout
    real(rk), intent(in) :: own(:) !< (num_free)
    real(rk), contiguous, intent(inout) :: x(:) !< (rows of all ranks)
    real(rk), allocatable :: mine(:)
    integer :: bounds(2), j
    bounds = own_rows(layout, this_rank())
    do j = 1, size(own)
      x(layout%row(j) + 1) = own(j)
    end do
    mine = x(bounds(1) + 1:bounds(2) + 1)
    call gather_rows(layout%first_row, mine, x)
  end subroutine put_rows

  !> |S|_1 from the lower triangle. Of a shared matrix an upper bound: magnitudes of the parts are
  !> added.
  real(rk) function scaled_norm(matrix, values, root) result(largest)
    type(pattern), intent(in) :: matrix
    real(rk), intent(in) :: values(:)
    real(rk), intent(in) :: root(:) !< (free unknowns) of the diagonal
    real(rk) :: column(size(root)), entry
    integer :: j, k, i
    column = 0.0_rk
    do j = 1, matrix%num_free
      do k = matrix%column_start(j), matrix%column_start(j) + matrix%free_entries(j) - 1
        i = matrix%row(k)
        entry = abs(values(k))/(root(i)*root(j))
        column(j) = column(j) + entry
        if (i /= j) column(i) = column(i) + entry
      end do
    end do
    if (matrix%is_shared) call matrix%part%add(column)
    largest = largest_entry(matrix%part, column)
  end function scaled_norm
end module matrix_condition
