!> The friction scale r for points that slide together and alone, for a structure with a given
!> compliance.
program test_joint_compliance
  use dense_factor, only: factorise_dense, lu_factor, solve_factored
  use joint_compliance, only: find_friction_scale
  use joint_operator, only: jump_operator
  use kinds, only: rk
  use testing, only: check, check_close, test_log
  implicit none

  real(rk), parameter :: own = 2.0e-9_rk, coupling = -1.5e-9_rk ! [m/N]
  real(rk), parameter :: area = 2.0_rk, weight = 1.25_rk
  type(test_log) :: log

  log%suite = 'joint_compliance'
  call scales_follow_the_structure(log)
  call scale_is_never_above_the_joint(log)
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> Two points; a force along the joint at one moves the other the other way. Together they count
  !> by absolute values, alone by their own compliance. 0.8 is the factor of theory.md, 2.3.
  subroutine scales_follow_the_structure(log)
    type(test_log), intent(inout) :: log
    real(rk), allocatable :: scale(:, :)
    real(rk) :: together, alone
    call find_scales(1.0e11_rk, scale)
    together = 0.8_rk/(weight*area*(own + abs(coupling)))
    alone = 0.8_rk/(weight*area*own)
    call check(log, all(shape(scale) == [2, 2]), 'two for each point')
    ! A part of 1e-6 of the joint's stiffness, 2.5e5 N/m, stays in the structure of some 1e8 N/m.
    call check_close(log, scale(1, 1)/together, 1.0_rk, 2.0e-3_rk, 'together, first point')
    call check_close(log, scale(1, 2)/together, 1.0_rk, 2.0e-3_rk, 'together, second point')
    call check_close(log, scale(2, 1)/alone, 1.0_rk, 2.0e-3_rk, 'alone')
  end subroutine scales_follow_the_structure

  !> A soft joint limits both.
  subroutine scale_is_never_above_the_joint(log)
    type(test_log), intent(inout) :: log
    real(rk), allocatable :: scale(:, :)
    call find_scales(1.0e6_rk, scale)
    call check_close(log, maxval(abs(scale - 1.0e6_rk)), 0.0_rk, 1.0e-3_rk, 'the joint''s own')
  end subroutine scale_is_never_above_the_joint

  !> Closes the joint on the structure, G = (I + G_0 W k)^-1 G_0, and computes r.
  subroutine find_scales(stiffness, scale)
    real(rk), intent(in) :: stiffness !< in all directions [Pa/m]
    real(rk), allocatable, intent(out) :: scale(:, :)
    type(jump_operator) :: operator
    type(lu_factor) :: factor
    real(rk), allocatable :: matrix(:, :)
    real(rk) :: structure(6, 6), closed(6, 6), reference(3, 2)
    integer :: i
    structure = 0.0_rk
    do i = 1, 6
      structure(i, i) = own
    end do
    do i = 1, 3
      structure(i, i + 3) = coupling
      structure(i + 3, i) = coupling
    end do
    matrix = weight*area*stiffness*structure
    do i = 1, 6
      matrix(i, i) = matrix(i, i) + 1.0_rk
    end do
    closed = structure
    call factorise_dense(matrix, factor)
    call solve_factored(factor, closed)
    operator%num_points = 2
    operator%area = [area, area]
    reference = stiffness
    call find_friction_scale(closed, operator, reference, weight, scale)
  end subroutine find_scales
end program test_joint_compliance
