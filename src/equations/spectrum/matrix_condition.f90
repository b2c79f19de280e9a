!> Estimates the condition of a factored symmetric matrix.
!>
!> The matrix is scaled to a unit diagonal, S = D^-1/2 K D^-1/2, because unknowns of different
!> stiffness (jumps of a stiff joint, displacements) cost a Cholesky factor no digits. The result
!> is |S|_1 |S^-1|_1. The second norm is estimated by Hager and Higham (Higham 1988, ACM TOMS 14;
!> LAPACK's dlacn2) with 4 or 5 solves: a lower bound, mostly exact to a factor of 3.
module matrix_condition
  use kinds, only: rk
  use errors, only: error_type
  use global_vectors, only: diagonal
  use matrix_pattern, only: pattern
  use ranks, only: add_over_ranks
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
    real(rk), allocatable :: root(:), x(:, :), v(:)
    integer, allocatable :: sign_of(:)
    integer :: n, kase, kept(3)
    n = matrix%num_free
    condition = 0.0_rk
    if (n == 0) return
    allocate (root(matrix%num_total), v(n), x(n, 1), sign_of(n))
    call diagonal(matrix, values, root)
    root = sqrt(root(:n))
    kase = 0
    do
      call dlacn2(n, v, x(:, 1), sign_of, condition, kase, kept)
      if (kase == 0) exit
      x(:, 1) = root*x(:, 1)
      call factor%solve_within(solve_residual*norm2(x), x, error)
      if (allocated(error)) return
      x(:, 1) = root*x(:, 1)
    end do
    condition = condition*scaled_norm(matrix, values, root)
  end subroutine estimate_condition

  !> |S|_1 from the lower triangle. Of a shared matrix an upper bound: magnitudes of the parts are
  !> added.
  real(rk) function scaled_norm(matrix, values, root) result(norm)
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
    if (matrix%is_shared) call add_over_ranks(column)
    norm = maxval(column)
  end function scaled_norm
end module matrix_condition
