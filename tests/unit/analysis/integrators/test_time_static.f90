!> Static steps, increments, supports and modes of rows of boxes against closed forms.
program test_time_static
  use kinds, only: rk
  use errors, only: error_type
  use problem_definition, only: problem
  use analysis_state, only: state
  use step_plan, only: step
  use initial_state, only: start_analysis
  use step_loop, only: run_all_steps
  use step_control, only: increment_control, start_control
  use joint_contraction, only: contraction_law
  use row_model, only: make_row, put_on_ground, add_gravity, new_step, fix, recorder, calls_of
  use testing, only: test_log, check, check_close
  implicit none

  type(test_log) :: log

  log%suite = 'time_static'
  call bar_is_pulled(log)
  call block_rests_on_joint(log)
  call floating_block_is_told(log)
  call loose_model_is_told(log)
  call increments_grow_and_shrink(log)
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
  subroutine floating_block_is_told(log)
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
  end subroutine floating_block_is_told

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
  subroutine loose_model_is_told(log)
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
  end subroutine loose_model_is_told

  !> Halves after failure, gives up at the smallest size; the end is met without a sliver.
  subroutine increments_grow_and_shrink(log)
    type(test_log), intent(inout) :: log
    type(step) :: plan
    type(increment_control) :: control
    logical :: gives_up
    integer :: i
    plan%first_increment = 0.1_rk
    plan%duration = 1.0_rk
    call start_control(plan, .false., control)
    call control%accept(3)
    call control%accept(3)
    call check_close(log, control%size, 0.15_rk, 1.0e-15_rk, 'grown after two easy increments')
    call control%cut(0.15_rk, 1.0_rk, gives_up)
    call check_close(log, control%size, 0.075_rk, 1.0e-15_rk, 'halved')
    call check(log,.not. gives_up, 'goes on')
    call slow_increments_grow(log, plan)
    plan%first_increment = 0.01_rk
    call start_control(plan, .true., control)
    do i = 1, 40
      call control%accept(3)
    end do
    call check_close(log, control%size, 0.01_rk, 1.0e-15_rk, 'dynamic increments do not grow')
    call check_close(log, control%next_size(0.99_rk + 1.0e-14_rk), 0.01_rk, 0.0_rk, 'no sliver')
    call control%cut(0.01_rk, 1.0_rk, gives_up)
    call check_close(log, control%size, 0.005_rk, 1.0e-15_rk, 'dynamic increments are halved')
    do i = 1, 10
      call control%accept(3)
    end do
    call check_close(log, control%size, 0.01_rk, 1.0e-15_rk, 'and doubled again')
    call follow_an_error(log, plan)
    plan%is_direct = .true.
    call start_control(plan, .true., control)
    call control%cut(0.01_rk, 1.0_rk, gives_up)
    call check(log, gives_up, 'direct increments are not cut')
  end subroutine increments_grow_and_shrink

  !> A size that was cut grows after four increments that converged slowly; after eight when the
  !> first one of the larger size was cut. A size that was never cut stays.
  subroutine slow_increments_grow(log, plan)
    type(test_log), intent(inout) :: log
    type(step), intent(in) :: plan
    type(increment_control) :: control
    logical :: gives_up
    integer :: i
    call start_control(plan, .false., control)
    do i = 1, 40
      call control%accept(30)
    end do
    call check_close(log, control%size, 0.1_rk, 1.0e-15_rk, 'no growth without a cut')
    call control%cut(0.1_rk, 1.0_rk, gives_up)
    call stay(log, control, 4, 0.05_rk, 'cut')
    call check_close(log, control%size, 0.075_rk, 1.0e-15_rk, 'grown')
    call control%cut(0.075_rk, 1.0_rk, gives_up)
    call stay(log, control, 8, 0.0375_rk, 'cut at once')
    call check_close(log, control%size, 0.05625_rk, 1.0e-15_rk, 'grown later')
    call control%accept(30)
    call control%cut(0.05625_rk, 1.0_rk, gives_up)
    do i = 1, 4
      call control%accept(30)
    end do
    call check(log, control%size > 0.03_rk, 'the larger size served once: four increments again')
  end subroutine slow_increments_grow

  !> Increments of one size that converge slowly.
  subroutine stay(log, control, num_increments, size_of_all, what)
    type(test_log), intent(inout) :: log
    type(increment_control), intent(inout) :: control
    integer, intent(in) :: num_increments
    real(rk), intent(in) :: size_of_all
    character(*), intent(in) :: what
    integer :: i
    do i = 1, num_increments
      call check_close(log, control%size, size_of_all, 1.0e-15_rk, what)
      call control%accept(30)
    end do
  end subroutine stay

  !> Sizes that follow an error: powers of two within the limits, doubled at their multiples.
  subroutine follow_an_error(log, given)
    type(test_log), intent(inout) :: log
    type(step), intent(in) :: given
    type(step) :: plan
    type(increment_control) :: control
    logical :: gives_up
    integer :: i
    plan = given
    plan%controls%accuracy = 0.02_rk
    plan%procedure%has_inertia = .true.
    plan%finest_increment = 0.0011_rk
    plan%largest_increment = 0.04_rk
    call start_control(plan, .true., control)
    call control%follow_error(0.01_rk, -2)
    call check_close(log, control%size, 0.0025_rk, 1.0e-15_rk, 'quartered')
    call control%follow_error(0.01_rk, -2)
    call check_close(log, control%size, 0.00125_rk, 1.0e-15_rk, 'the finest is above the limit')
    do i = 1, 10
      call control%accept(3)
    end do
    call control%follow_error(0.01125_rk, 1)
    call check_close(log, control%size, 0.00125_rk, 1.0e-15_rk, 'no multiple of the new size')
    call control%follow_error(0.0125_rk, 1)
    call check_close(log, control%size, 0.0025_rk, 1.0e-15_rk, 'doubled')
    call control%follow_error(0.015_rk, 1)
    call check_close(log, control%size, 0.0025_rk, 1.0e-15_rk, 'not again at once')
    call control%cut(0.01_rk, 0.2_rk, gives_up)
    call check_close(log, control%size, 0.00125_rk, 1.0e-15_rk, 'cut to a power of two')
  end subroutine follow_an_error

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
end program test_time_static
