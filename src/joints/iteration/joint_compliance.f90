!> Compliance of the structure at the points of its joints, G = B K_0^-1 B^T, and the scale r of the
!> augmented contact that follows from G.
module joint_compliance
  use kinds, only: rk
  use errors, only: error_type
  use joint_rows, only: num_axes, num_rows, row_of
  use linear_solver, only: equation_solver
  use joint_operator, only: jump_operator
  use dense_factor, only: lu_factor, factorise_dense, solve_factored
  implicit none
  private
  public :: contact_scale, find_compliance, find_contact_scale

  !> r of the augmented form per area, at most the stiffness of the joint (theory.md, 2.3).
  type :: contact_scale
    !> (2, points) of a point alone, normal and along the joint: the stiffness that the structure
    !> and the joint's own spring show at this point [Pa/m]
    real(rk), allocatable :: own(:, :)
    real(rk), allocatable :: shared(:) !< (points) of all points that slide together [Pa/m]
  end type contact_scale

  integer, parameter :: block_size = 48 !< right-hand sides solved at once
  !> r over the stiffness of the structure for common sliding (different_meshes.md, 13.5).
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

  !> r of the augmented form, and the compliance C of the structure with open joints. C is
  !> (I - G W k_ref)^-1 G, W = weight*area; a part of k_ref stays so that C exists for blocks that
  !> only joints hold.
  subroutine find_contact_scale(compliance, operator, k_ref, weight, scale, open_compliance)
    real(rk), intent(in) :: compliance(:, :) !< G with the closed joints [m/N]
    type(jump_operator), intent(in) :: operator
    real(rk), intent(in) :: k_ref(:, :) !< (3, points) [Pa/m]
    real(rk), intent(in) :: weight !< of the joint forces
    type(contact_scale), intent(out) :: scale
    real(rk), allocatable, intent(out) :: open_compliance(:, :) !< C (rows, rows) [m/N]
    type(lu_factor) :: factor
    real(rk), allocatable :: matrix(:, :)
    real(rk) :: joint_stiffness, flexibility
    integer :: m, p, i, j, row, slip(2), other_slip(2)
    m = size(compliance, 1)
    allocate (matrix(m, m), scale%shared(operator%num_points), scale%own(2, operator%num_points))
    do p = 1, operator%num_points
      do i = 1, num_axes
        row = row_of(p, i)
        joint_stiffness = (1.0_rk - kept_stiffness)*weight*operator%area(p)*k_ref(i, p)
        matrix(:, row) = -joint_stiffness*compliance(:, row)
        matrix(row, row) = 1.0_rk + matrix(row, row)
      end do
    end do
    open_compliance = compliance
    call factorise_dense(matrix, factor)
    call solve_factored(factor, open_compliance)
    do p = 1, operator%num_points
      slip = row_of(p, [2, 3])
      row = row_of(p, 1)
      flexibility = 0.0_rk
      do j = 1, operator%num_points
        other_slip = row_of(j, [2, 3])
        flexibility = flexibility &
                      + weight*operator%area(j)*(abs(open_compliance(other_slip(1), slip(1))) &
                                                 + abs(open_compliance(other_slip(2), slip(2))))
      end do
      scale%shared(p) = common_scale(flexibility, minval(k_ref(2:3, p)))
      associate (share => weight*operator%area(p))
        scale%own(1, p) = 1.0_rk/(share*open_compliance(row, row) + 1.0_rk/k_ref(1, p))
        scale%own(2, p) = 1.0_rk/(share*largest_of(open_compliance(slip, slip)) &
                                  + 1.0_rk/minval(k_ref(2:3, p)))
      end associate
    end do
  end subroutine find_contact_scale

  !> r of all points together from a compliance in two directions.
  pure real(rk) function common_scale(flexibility, most)
    real(rk), intent(in) :: flexibility !< [m/Pa]
    real(rk), intent(in) :: most !< [Pa/m]
    common_scale = most
    if (flexibility*most > 2.0_rk*scale_factor) common_scale = 2.0_rk*scale_factor/flexibility
  end function common_scale

  !> Largest eigenvalue of a symmetric matrix.
  pure real(rk) function largest_of(block)
    real(rk), intent(in) :: block(2, 2)
    largest_of = 0.5_rk*(block(1, 1) + block(2, 2)) &
                 + hypot(0.5_rk*(block(1, 1) - block(2, 2)), 0.5_rk*(block(1, 2) + block(2, 1)))
  end function largest_of
end module joint_compliance
