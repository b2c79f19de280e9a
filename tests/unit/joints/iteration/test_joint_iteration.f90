!> Residuals of joints.
program test_joint_iteration
  use joint_forces, only: joint_field
  use joint_iteration, only: smallest_force
  use kinds, only: rk
  use testing, only: check, test_log
  implicit none
  type(test_log) :: log
  type(joint_field) :: field

  log%suite = 'joint_iteration'
  ! All joints are open: nothing carries a force, and that of the linearised laws is divided by it.
  call check(log, 1.0e12_rk < huge(1.0_rk)*smallest_force(field), 'a residual without forces')
  field%start_force = 2.0_rk
  call check(log, abs(smallest_force(field) - 2.0_rk) <= 0.0_rk, 'the force at the start')
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1
end program test_joint_iteration
