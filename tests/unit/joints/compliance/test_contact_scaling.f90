!> The scale r of points that move together and alone, and the compliance with open joints, for a
!> structure with a given compliance.
program test_contact_scaling
  use dense_factor, only: factorise_dense, lu_factor, solve_factored
  use block_compliance, only: compliance_blocks, take_blocks
  use contact_scaling, only: contact_scale, find_contact_scale, open_group
  use joint_operator, only: joint_springs, jump_operator
  use kinds, only: rk
  use point_groups, only: group_list, single_group
  use testing, only: check, check_close, test_log
  implicit none

  real(rk), parameter :: own = 2.0e-9_rk, coupling = -1.5e-9_rk ! [m/N]
  real(rk), parameter :: area = 2.0_rk, weight = 1.25_rk
  type(test_log) :: log

  log%suite = 'contact_scaling'
  call scales_follow_the_structure(log)
  call scale_is_never_above_the_joint(log)
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> Two points; a force along the joint at one moves the other the other way. Together they count
  !> by absolute values, alone by their own compliance and that of the joint's springs. 0.8 is the
  !> factor of different_meshes.md, 13.5.
  subroutine scales_follow_the_structure(log)
    type(test_log), intent(inout) :: log
    type(contact_scale) :: scale
    real(rk), allocatable :: open_compliance(:, :)
    real(rk) :: together, alone
    call find_scales([1.0e11_rk, 0.4e11_rk], scale, open_compliance)
    together = 0.8_rk/(weight*area*(own + abs(coupling)))
    alone = 1.0_rk/(weight*area*own)
    ! A part of 1e-6 of the joint's stiffness, 2.5e5 N/m, stays in the structure of some 1e8 N/m.
    call check_close(log, scale%shared(1)/together, 1.0_rk, 2.0e-3_rk, 'together, first point')
    call check_close(log, scale%shared(2)/together, 1.0_rk, 2.0e-3_rk, 'together, second point')
    call check_close(log, scale%own(1, 1)*(1/alone + 1.0e-11_rk), 1.0_rk, 2.0e-3_rk, 'normal')
    call check_close(log, scale%own(2, 2)*(1/alone + 2.5e-11_rk), 1.0_rk, 2.0e-3_rk, 'along')
    call check_close(log, maxval(abs(open_compliance - structure()))/own, 0.0_rk, 2.0e-3_rk, &
                     'the compliance with open joints')
  end subroutine scales_follow_the_structure

  !> A soft joint limits both.
  subroutine scale_is_never_above_the_joint(log)
    type(test_log), intent(inout) :: log
    type(contact_scale) :: scale
    real(rk), allocatable :: open_compliance(:, :)
    call find_scales([1.0e6_rk, 1.0e6_rk], scale, open_compliance)
    call check_close(log, maxval(abs(scale%shared - 1.0e6_rk)), 0.0_rk, 1.0e-3_rk, 'together')
    ! The structure is 80 times as stiff as the joint's point, 2.5e6 N/m.
    call check(log, all(scale%own < 1.0e6_rk .and. scale%own > 0.98e6_rk), 'alone')
  end subroutine scale_is_never_above_the_joint

  !> Compliance of the two points without the joint.
  pure function structure() result(c)
    real(rk) :: c(6, 6) !< [m/N]
    integer :: i
    c = 0.0_rk
    do i = 1, 6
      c(i, i) = own
    end do
    do i = 1, 3
      c(i, i + 3) = coupling
      c(i + 3, i) = coupling
    end do
  end function structure

  !> Closes the joint on the structure, G = (I + G_0 W k)^-1 G_0, and computes r.
  subroutine find_scales(stiffness, scale, open_compliance)
    real(rk), intent(in) :: stiffness(2) !< normal, along the joint [Pa/m]
    type(contact_scale), intent(out) :: scale
    real(rk), allocatable, intent(out) :: open_compliance(:, :)
    type(jump_operator) :: operator
    type(lu_factor) :: factor
    type(group_list) :: groups
    type(compliance_blocks) :: blocks
    type(open_group), allocatable :: opened(:)
    real(rk), allocatable :: matrix(:, :)
    real(rk) :: closed(6, 6), reference(3, 2)
    integer :: i
    operator%num_points = 2
    operator%area = [area, area]
    reference = spread([stiffness, stiffness(2)], 2, 2)
    matrix = weight*area*structure()*spread([reference], 1, 6)
    do i = 1, 6
      matrix(i, i) = matrix(i, i) + 1.0_rk
    end do
    closed = structure()
    call factorise_dense(matrix, factor)
    call solve_factored(factor, closed)
    call single_group(2, groups)
    call take_blocks(closed, joint_springs(operator, reference, weight), groups, 0.0_rk, blocks)
    call find_contact_scale(blocks, operator, reference, weight, scale, opened)
    open_compliance = opened(1)%compliance
  end subroutine find_scales
end program test_contact_scaling
