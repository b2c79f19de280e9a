!> Compliance of the structure at the points of its joints, G = B K_0^-1 B^T, and the friction
!> scale r that follows from G.
module joint_compliance
  use kinds, only: rk
  use errors, only: error_type
  use joint_rows, only: num_axes, num_rows, row_of
  use linear_solver, only: equation_solver
  use joint_operator, only: jump_operator
  use dense_factor, only: lu_factor, factorise_dense, solve_factored
  implicit none
  private
  public :: find_compliance, find_friction_scale

  integer, parameter :: block_size = 48 !< right-hand sides solved at once
  !> r over the stiffness of the structure for common sliding (theory.md, 2.3). From 1 on, the
  !> iteration of a block that reverses its sliding oscillates.
  real(rk), parameter :: scale_factor = 0.8_rk
  !> Fraction of k_ref that stays in G when k_ref is removed, so that a block held by joints alone
  !> has a stiffness.
  real(rk), parameter :: kept_stiffness = 1.0e-6_rk

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

  !> r of the augmented friction per area: a fraction of the tangential stiffness of the structure
  !> when all points slide together, and when one slides alone; at most k_t of the joint.
  !> Without joints the structure has the compliance G (I - W k_ref G)^-1, W = weight*area.
  subroutine find_friction_scale(compliance, operator, k_ref, weight, friction_scale)
    real(rk), intent(in) :: compliance(:, :) !< G with the closed joints [m/N]
    type(jump_operator), intent(in) :: operator
    real(rk), intent(in) :: k_ref(:, :) !< (3, points) [Pa/m]
    real(rk), intent(in) :: weight !< of the joint forces
    real(rk), allocatable, intent(out) :: friction_scale(:, :) !< (2, points) all, one [Pa/m]
    type(lu_factor) :: factor
    real(rk), allocatable :: matrix(:, :), alone(:, :)
    real(rk) :: joint_stiffness, flexibility, share
    integer :: m, p, i, j, row, slip(2), other_slip(2)
    m = size(compliance, 1)
    allocate (matrix(m, m), friction_scale(2, operator%num_points))
    do p = 1, operator%num_points
      do i = 1, num_axes
        row = row_of(p, i)
        joint_stiffness = (1.0_rk - kept_stiffness)*weight*operator%area(p)*k_ref(i, p)
        matrix(:, row) = -joint_stiffness*compliance(:, row)
        matrix(row, row) = 1.0_rk + matrix(row, row)
      end do
    end do
    alone = transpose(compliance)
    matrix = transpose(matrix)
    call factorise_dense(matrix, factor)
    call solve_factored(factor, alone)
    do p = 1, operator%num_points
      slip = row_of(p, [2, 3])
      flexibility = 0.0_rk
      do j = 1, operator%num_points
        other_slip = row_of(j, [2, 3])
        share = weight*operator%area(j)*(abs(alone(other_slip(1), slip(1))) &
                                         + abs(alone(other_slip(2), slip(2))))
        flexibility = flexibility + share
        if (j == p) friction_scale(2, p) = scale_for(share, minval(k_ref(2:3, p)))
      end do
      friction_scale(1, p) = scale_for(flexibility, minval(k_ref(2:3, p)))
    end do
  end subroutine find_friction_scale

  !> r for a compliance in two directions.
  pure real(rk) function scale_for(flexibility, most) result(friction_scale)
    real(rk), intent(in) :: flexibility !< [m/Pa]
    real(rk), intent(in) :: most !< [Pa/m]
    friction_scale = most
    if (flexibility*most > 2.0_rk*scale_factor) friction_scale = 2.0_rk*scale_factor/flexibility
  end function scale_for
end module joint_compliance
