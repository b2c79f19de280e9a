!> Static steps and modes of rows of boxes against closed forms; models without equilibrium.
program test_rows_at_rest
  use kinds, only: rk
  use errors, only: error_type
  use problem_definition, only: problem
  use analysis_state, only: state
  use initial_state, only: start_analysis
  use step_loop, only: run_all_steps
  use joint_contraction, only: contraction_law
  use row_model, only: make_row, put_on_ground, add_gravity, new_step, fix, recorder, calls_of
  use testing, only: test_log, check, check_close
  implicit none

  type(test_log) :: log

  log%suite = 'rows_at_rest'
  call bar_is_pulled(log)
  call block_rests_on_joint(log)
  call floating_block_is_reported(log)
  call loose_model_is_reported(log)
  call bar_vibrates(log)
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> A bar with one end moved by 1 mm in four increments: u and reaction are E A/L of it.
  subroutine bar_is_pulled(log)
    type(test_log), intent(inout) :: log
    type(problem) :: model
    type(recorder) :: results
    type(state), allocatable :: now
    type(error_type), allocatable :: error
    integer :: i
    call make_row([0.0_rk, 1.0_rk, 3.0_rk], 1.0_rk, 2.0_rk, [3.0e9_rk, 3.0e9_rk], &
                  [0.0_rk, 0.0_rk], model)
    call new_step('STATIC', 0.25_rk, 1.0_rk, model)
    model%steps(1)%is_direct = .true.
    do i = 1, 3
      call fix([1, 2, 3, 4], i, model)
    end do
    call fix([9, 10, 11, 12], 1, model)
    associate (last => size(model%steps(1)%fixities))
      model%steps(1)%fixities(last - 3:)%value = 1.0e-3_rk
    end associate
    call results%costs%open()
    call start_analysis(model, now, error)
    call run_all_steps(model, now, results, error)
    call check(log,.not. allocated(error), 'runs')
    call check_close(log, now%u(1, 5), 1.0e-3_rk/3.0_rk, 1.0e-15_rk, 'middle of the bar')
    call check_close(log, sum(now%reaction(1, 9:12)), 2.0e6_rk, 1.0e-3_rk, 'reaction')
    call check_close(log, now%energy%external, 1.0e3_rk, 1.0e-6_rk, 'work of the moving support')
    call check_close(log, now%energy%strain, 1.0e3_rk, 1.0e-6_rk, 'strain energy')
    call check(log, results%num_increments == 4, 'four increments')
    call check(log, calls_of(results, 'factor structure') == 1, 'factored once')
  end subroutine bar_is_pulled

  !> A block on a joint: the joint carries its weight.
  subroutine block_rests_on_joint(log)
    type(test_log), intent(inout) :: log
    type(problem) :: model
    type(recorder) :: results
    type(state), allocatable :: now
    type(error_type), allocatable :: error
    call make_block(10.0_rk, model)
    call start_analysis(model, now, error)
    call run_all_steps(model, now, results, error)
    call check(log,.not. allocated(error), 'runs')
    call check_close(log, results%pressure(size(results%pressure)), 2.4e4_rk, 1.0e-3_rk, 'pressure')
    call check_close(log, now%u(3, 1), -2.4e-5_rk, 1.0e-14_rk, 'closing')
    call check(log, results%most_iterations <= 2, 'two iterations')
  end subroutine block_rests_on_joint

  !> The same block pulled upwards has no equilibrium, and the message says where.
  subroutine floating_block_is_reported(log)
    type(test_log), intent(inout) :: log
    type(problem) :: model
    type(recorder) :: results
    type(state), allocatable :: now
    type(error_type), allocatable :: error
    call make_block(-10.0_rk, model)
    call start_analysis(model, now, error)
    call run_all_steps(model, now, results, error)
    call check(log, allocated(error), 'a block that flies off is an error')
    if (.not. allocated(error)) return
    call check(log, index(error%message, 'joint GROUND') > 0, 'the message names the joint')
    call check(log, now%step_time <= 0.0_rk .and. now%increment == 0, 'the last state is kept')
  end subroutine floating_block_is_reported

  subroutine make_block(g, model)
    real(rk), intent(in) :: g !< downwards [m/s2]
    type(problem), intent(out) :: model
    call make_row([0.0_rk, 1.0_rk], 1.0_rk, 1.0_rk, [1.0e9_rk], [2400.0_rk], model)
    call put_on_ground(1, contraction_law(normal_stiffness=1.0e9_rk, tangent_stiffness=1.0e9_rk, &
                                          friction=0.5_rk), model)
    call add_gravity(g, model)
    call new_step('STATIC', 1.0_rk, 1.0_rk, model)
  end subroutine make_block

  !> A model without supports is named by node and direction.
  subroutine loose_model_is_reported(log)
    type(test_log), intent(inout) :: log
    type(problem) :: model
    type(recorder) :: results
    type(state), allocatable :: now
    type(error_type), allocatable :: error
    call make_row([0.0_rk, 1.0_rk], 1.0_rk, 1.0_rk, [1.0e9_rk], [2400.0_rk], model)
    call add_gravity(10.0_rk, model)
    call new_step('STATIC', 1.0_rk, 1.0_rk, model)
    call fix([1, 2, 3, 4], 1, model)
    call start_analysis(model, now, error)
    call run_all_steps(model, now, results, error)
    call check(log, allocated(error), 'a loose model is an error')
    if (.not. allocated(error)) return
    call check(log, index(error%message, 'node ') > 0, 'the message names a node')
  end subroutine loose_model_is_reported

  !> Lowest frequency of one box with one free direction: w^2 = 3 E/(rho L^2).
  subroutine bar_vibrates(log)
    type(test_log), intent(inout) :: log
    type(problem) :: model
    type(recorder) :: results
    type(state), allocatable :: now
    type(error_type), allocatable :: error
    integer :: i
    call make_row([0.0_rk, 1.0_rk], 1.0_rk, 1.0_rk, [3.0e9_rk], [2400.0_rk], model)
    call new_step('FREQUENCY', 1.0_rk, 1.0_rk, model)
    model%steps(1)%num_modes = 1
    call fix([1, 2, 3, 4], 1, model)
    call fix([(i, i=1, 8)], 2, model)
    call fix([(i, i=1, 8)], 3, model)
    call start_analysis(model, now, error)
    call run_all_steps(model, now, results, error)
    call check(log,.not. allocated(error), 'runs')
    call check_close(log, results%modes(1)%hz, sqrt(9.0e9_rk/2400.0_rk)/(2.0_rk*acos(-1.0_rk)), &
                     1.0e-6_rk, 'frequency')
  end subroutine bar_vibrates
end program test_rows_at_rest
