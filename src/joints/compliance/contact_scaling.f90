!> The scale r of the augmented contact, and the compliance of the structure with open joints, group
!> by group: the joints of other groups are closed.
module contact_scaling
  use block_compliance, only: compliance_blocks
  use dense_factor, only: lu_factor, factorise_dense, solve_factored
  use joint_operator, only: jump_operator
  use joint_rows, only: num_axes, row_of
  use kinds, only: rk
  use ranks, only: add_over_ranks
  implicit none
  private
  public :: contact_scale, open_group, find_contact_scale

  !> r of the augmented form per area, at most the stiffness of the joint (theory.md, 2.3).
  type :: contact_scale
    !> (2, points) of a point alone, normal and along the joint: the stiffness that the structure
    !> and the joint's own spring show at this point [Pa/m]
    real(rk), allocatable :: own(:, :)
    real(rk), allocatable :: shared(:) !< (points) of all points that slide together [Pa/m]
  end type contact_scale

  !> Compliance C of the structure at the open joints of a group.
  type :: open_group
    real(rk), allocatable :: compliance(:, :) !< (rows, rows) [m/N]
  end type open_group

  !> r over the stiffness of the structure for common sliding (different_meshes.md, 13.5).
  real(rk), parameter :: scale_factor = 0.8_rk
  !> Fraction of k_ref that stays in G when k_ref is removed, so that a block held by joints alone
  !> has a stiffness.
  real(rk), parameter :: kept_stiffness = 1.0e-6_rk

contains

  !> r of the augmented form, and C of all groups of this rank. C is (I - G W k_ref)^-1 G with the
  !> own block of the group, W = weight*area; a part of k_ref stays so that C exists for blocks that
  !> only joints hold.
  subroutine find_contact_scale(blocks, operator, k_ref, weight, scale, opened)
    type(compliance_blocks), intent(in) :: blocks !< G with the closed joints
    type(jump_operator), intent(in) :: operator
    real(rk), intent(in) :: k_ref(:, :) !< (3, points) [Pa/m]
    real(rk), intent(in) :: weight !< of the joint forces
    type(contact_scale), intent(out) :: scale
    type(open_group), allocatable, intent(out) :: opened(:) !< (groups)
    integer :: g
    allocate (opened(blocks%groups%num_groups))
    allocate (scale%shared(operator%num_points), source=0.0_rk)
    allocate (scale%own(2, operator%num_points), source=0.0_rk)
    !$omp parallel do schedule(dynamic) default(none) if (size(opened) > 1) &
    !$omp shared(blocks, operator, k_ref, weight, scale, opened)
    do g = 1, size(opened)
      if (.not. blocks%groups%is_here(g)) cycle
      call scale_group(blocks, g, weight*operator%area, k_ref, scale, opened(g))
    end do
    !$omp end parallel do
    if (blocks%groups%is_divided()) then
      call add_over_ranks(scale%shared)
      call add_over_ranks(scale%own)
    end if
  end subroutine find_contact_scale

  !> C of a group.
  subroutine open_joints(compliance, share, k_ref, open_compliance)
    real(rk), intent(in) :: compliance(:, :) !< G (rows, rows) [m/N]
    real(rk), intent(in) :: share(:) !< (points) weight*area [m2]
    real(rk), intent(in) :: k_ref(:, :) !< (3, points) [Pa/m]
    real(rk), allocatable, intent(out) :: open_compliance(:, :) !< (rows, rows) [m/N]
    type(lu_factor) :: factor
    real(rk), allocatable :: matrix(:, :)
    real(rk) :: joint_stiffness
    integer :: m, p, i, row
    m = size(compliance, 1)
    allocate (matrix(m, m))
    do p = 1, size(share)
      do i = 1, num_axes
        row = row_of(p, i)
        joint_stiffness = (1.0_rk - kept_stiffness)*share(p)*k_ref(i, p)
        matrix(:, row) = -joint_stiffness*compliance(:, row)
        matrix(row, row) = 1.0_rk + matrix(row, row)
      end do
    end do
    open_compliance = compliance
    call factorise_dense(matrix, factor)
    call solve_factored(factor, open_compliance)
  end subroutine open_joints

  !> C and r of the points of a group.
  subroutine scale_group(blocks, group, share, k_ref, scale, opened)
    type(compliance_blocks), intent(in) :: blocks
    integer, intent(in) :: group
    real(rk), intent(in) :: share(:) !< (points) weight*area [m2]
    real(rk), intent(in) :: k_ref(:, :) !< (3, points) [Pa/m]
    type(contact_scale), intent(inout) :: scale
    type(open_group), intent(inout) :: opened
    real(rk) :: flexibility, with_others
    integer :: k, p, j, row, slip(2), other_slip(2)
    associate (point => blocks%groups%members(group))
      call open_joints(blocks%block(group, group)%values, share(point), k_ref(:, point), &
                       opened%compliance)
      with_others = 1.0_rk + outer_coupling(blocks, group)
      do k = 1, size(point)
        p = point(k)
        row = row_of(k, 1)
        slip = row_of(k, [2, 3])
        flexibility = 0.0_rk
        do j = 1, size(point)
          other_slip = row_of(j, [2, 3])
          flexibility = flexibility &
                        + share(point(j))*(abs(opened%compliance(other_slip(1), slip(1))) &
                                           + abs(opened%compliance(other_slip(2), slip(2))))
        end do
        scale%shared(p) = common_scale(with_others*flexibility, minval(k_ref(2:3, p)))
        scale%own(1, p) = 1.0_rk/(share(p)*opened%compliance(row, row) + 1.0_rk/k_ref(1, p))
        scale%own(2, p) = 1.0_rk/(share(p)*largest_of(opened%compliance(slip, slip)) &
                                  + 1.0_rk/minval(k_ref(2:3, p)))
      end do
    end associate
  end subroutine scale_group

  !> Sum of the couplings of a group with others.
  pure real(rk) function outer_coupling(blocks, group)
    type(compliance_blocks), intent(in) :: blocks
    integer, intent(in) :: group
    outer_coupling = sum(blocks%block(:, group)%coupling) - 1.0_rk
  end function outer_coupling

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
end module contact_scaling
