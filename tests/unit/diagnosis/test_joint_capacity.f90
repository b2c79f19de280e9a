!> What joints could balance on one rigid block, against hand calculation.
program test_joint_capacity
  use joint_capacity, only: best_forces, find_best_forces, point_limits
  use kinds, only: rk
  use testing, only: check, check_close, test_log
  implicit none

  real(rk), parameter :: weight = 10.0_rk
  type(test_log) :: log

  log%suite = 'joint_capacity'
  call friction_and_cohesion(log)
  call a_block_on_two_points(log)
  call what_is_bonded_pulls(log)
  call a_direction_that_nothing_resists(log)
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> Jumps at points (x, 0) of a block in the plane x-z, when it moves (x, z) or rotates about y:
  !> the normal is z, the first tangent x.
  function rows_of(x) result(rows)
    real(rk), intent(in) :: x(:)
    real(rk) :: rows(3, 3*size(x))
    integer :: p
    rows = 0.0_rk
    do p = 1, size(x)
      rows(2, 3*p - 2) = 1.0_rk
      rows(3, 3*p - 2) = -x(p)
      rows(1, 3*p - 1) = 1.0_rk
    end do
  end function rows_of

  !> Shear within mu p + c and beyond; the joints pull the block down with +t, hence the signs.
  subroutine friction_and_cohesion(log)
    type(test_log), intent(inout) :: log
    type(best_forces) :: best
    type(point_limits) :: limits(2)
    limits%friction = 0.5_rk
    limits%cohesion = 1.0_rk
    call find_best_forces(rows_of([-1.0_rk, 1.0_rk]), limits, [6.9_rk, -weight, 0.0_rk], best)
    call check(log, best%left < 2.0e-3_rk, 'mu W + c holds 6.9 of 7')
    call check_close(log, sum(best%force(1, :)), -weight, 0.1_rk, 'the weight presses')
    call find_best_forces(rows_of([-1.0_rk, 1.0_rk]), limits, [8.0_rk, -weight, 0.0_rk], best)
    call check(log, best%left > 1.0e-2_rk, '8 is too much')
    call check(log, best%mechanism(1) > 0.0_rk, 'it goes where it is pushed')
  end subroutine friction_and_cohesion

  !> The resultant lies between the points, or outside.
  subroutine a_block_on_two_points(log)
    type(test_log), intent(inout) :: log
    type(best_forces) :: best
    type(point_limits) :: limits(2)
    limits%friction = 0.5_rk
    call find_best_forces(rows_of([-1.0_rk, 1.0_rk]), limits, [0.0_rk, -weight, 0.9_rk*weight], &
                          best)
    call check(log, best%left < 2.0e-3_rk, 'at 0.9 of the half width it stands')
    call check_close(log, best%force(1, 2), -0.95_rk*weight, 0.05_rk, 'on the nearer point')
    call find_best_forces(rows_of([-1.0_rk, 1.0_rk]), limits, [0.0_rk, -weight, 1.2_rk*weight], &
                          best)
    call check(log, best%left > 1.0e-2_rk, 'beyond the point it falls')
    call check(log, best%mechanism(3) > 0.0_rk, 'over it')
  end subroutine a_block_on_two_points

  !> Tension up to the strength that is left, any shear.
  subroutine what_is_bonded_pulls(log)
    type(test_log), intent(inout) :: log
    type(best_forces) :: best
    type(point_limits) :: limits(2)
    limits%is_bonded = .true.
    limits%tension = 3.0_rk
    call find_best_forces(rows_of([-1.0_rk, 1.0_rk]), limits, [50.0_rk, 5.0_rk, 0.0_rk], best)
    call check(log, best%left < 2.0e-3_rk, '5 of 6')
    call find_best_forces(rows_of([-1.0_rk, 1.0_rk]), limits, [0.0_rk, 7.0_rk, 0.0_rk], best)
    call check_close(log, best%left, 1.0_rk/7.0_rk, 1.0e-3_rk, '7 of 6')
  end subroutine what_is_bonded_pulls

  !> However small the load in it.
  subroutine a_direction_that_nothing_resists(log)
    type(test_log), intent(inout) :: log
    type(best_forces) :: best
    type(point_limits) :: limits(2)
    real(rk) :: rows(3, 6)
    rows = rows_of([-1.0_rk, 1.0_rk])
    rows(1, :) = 0.0_rk
    call find_best_forces(rows, limits, [1.0e-3_rk, -weight, 0.0_rk], best)
    call check_close(log, best%left, 1.0_rk, 0.0_rk, 'nothing balances it')
    call check_close(log, best%mechanism(2), 0.0_rk, 1.0e-12_rk, 'it does not sink')
    call check(log, best%mechanism(1) > 0.0_rk, 'it moves along')
    call find_best_forces(rows, limits, [0.0_rk, -weight, 0.0_rk], best)
    call check(log, best%left < 2.0e-3_rk, 'without that load it stands')
  end subroutine a_direction_that_nothing_resists
end program test_joint_capacity
