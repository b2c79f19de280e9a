!> Residuals of joints.
program test_joint_iteration
  use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
  use joint_forces, only: joint_field
  use joint_iteration, only: close_iteration, goes_on, iteration_history, joint_increment, &
                             smallest_force
  use kinds, only: rk
  use step_plan, only: step_controls
  use testing, only: check, test_log
  implicit none
  type(test_log) :: log
  type(joint_field) :: field

  log%suite = 'joint_iteration'
  ! All joints are open: nothing carries a force, and that of the linearised laws is divided by it.
  call check(log, 1.0e12_rk < huge(1.0_rk)*smallest_force(field), 'a residual without forces')
  field%start_force = 2.0_rk
  call check(log, abs(smallest_force(field) - 2.0_rk) <= 0.0_rk, 'the force at the start')
  call iteration_without_numbers_ends(log)
  call cycles_end(log)
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> Numbers that are none do not get better: the iteration ends at once.
  subroutine iteration_without_numbers_ends(log)
    type(test_log), intent(inout) :: log
    type(joint_increment) :: now
    type(iteration_history) :: history
    type(step_controls), target :: controls
    now%controls => controls
    allocate (history%unbalance(0), history%step(0))
    now%outcome%iterations = 1
    now%outcome%unbalance = 0.5_rk
    call close_iteration(now, history)
    call check(log, goes_on(history, now), 'a residual')
    now%outcome%iterations = 2
    now%outcome%unbalance = ieee_value(1.0_rk, ieee_quiet_nan)
    call close_iteration(now, history)
    call check(log,.not. goes_on(history, now), 'not a number')
    call check(log,.not. now%outcome%has_converged, 'not converged')
  end subroutine iteration_without_numbers_ends

  !> Residuals and corrections that repeat are a cycle. Residuals alone are one where the smallest
  !> stiffness carries a block.
  subroutine cycles_end(log)
    type(test_log), intent(inout) :: log
    call check(log, length_of_iteration(1.0_rk, .false.) == 3, 'a cycle')
    call check(log, length_of_iteration(0.5_rk, .false.) == most_iterations(), 'no cycle')
    call check(log, length_of_iteration(2.0_rk, .true.) == 3, 'a block that has left its supports')
  end subroutine cycles_end

  !> Iterations of *CONTROLS.
  integer function most_iterations()
    type(step_controls) :: controls
    most_iterations = controls%max_iterations
  end function most_iterations

  !> Iterations whose residuals are the same; each correction is that before it times a factor.
  integer function length_of_iteration(factor, is_driven) result(length)
    real(rk), intent(in) :: factor
    logical, intent(in) :: is_driven
    type(joint_increment) :: now
    type(iteration_history) :: history
    type(step_controls), target :: controls
    now%controls => controls
    allocate (history%unbalance(0), history%step(0))
    now%outcome%is_driven = is_driven
    now%outcome%unbalance = 1.0_rk
    now%step = 1.0_rk
    length = 0
    do while (goes_on(history, now) .and. length < 100)
      length = length + 1
      now%outcome%iterations = length
      now%step = factor*now%step
      call close_iteration(now, history)
    end do
  end function length_of_iteration
end program test_joint_iteration
