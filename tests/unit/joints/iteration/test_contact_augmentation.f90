!> Contact without penetration: a box on the ground, an arch that is shaken, and multipliers that an
!> increment cut back leaves alone. Slip beyond what small sliding allows ends a run.
program test_contact_augmentation
  use kinds, only: rk
  use errors, only: error_type
  use problem_definition, only: problem
  use analysis_state, only: state
  use amplitudes, only: amplitude
  use contact_augmentation, only: contact_multiplier, start_multiplier
  use initial_state, only: start_analysis
  use step_loop, only: run_all_steps
  use joint_law, only: joint_state, state_open, state_slip, state_stick
  use joint_contraction, only: contraction_law
  use arch_model, only: make_heavy_arch
  use row_model, only: add_gravity, fix, make_row, put_on_ground, shake_base, new_step, recorder
  use testing, only: test_log, check, check_close
  implicit none

  real(rk), parameter :: young = 3.0e10_rk, density = 2400.0_rk, gravity = 10.0_rk
  real(rk), parameter :: kn = 1.0e8_rk
  type(test_log) :: log

  log%suite = 'contact_augmentation'
  call box_does_not_sink(log)
  call both_solvers_agree(log)
  call multipliers_start_from_the_last_balance(log)
  call slip_beyond_reach_ends_the_run(log)
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> A box of 1 x 1 x 2 m weighs on a soft joint: its four corners carry a quarter each, and stay
  !> where they are. Without the option they sink by 48 kPa / KN.
  subroutine box_does_not_sink(log)
    type(test_log), intent(inout) :: log
    real(rk), parameter :: pressure = 2.0_rk*density*gravity
    type(state), allocatable :: now
    type(recorder) :: results
    call stand(log, 0.0_rk, now, results)
    call check_close(log, now%u(3, 1), -pressure/kn, 1.0e-9_rk, 'sinks by its weight')
    call stand(log, 1.0e-9_rk, now, results)
    call check_close(log, now%u(3, 1), 0.0_rk, 1.0e-9_rk, 'does not sink')
    call check_close(log, now%joints(1)%traction(1, 1), -pressure, 1.0e-5_rk, 'the same pressure')
    call check(log, now%augmentations > 0 .and. now%augmentations <= 3, 'in a few passes')
    call check(log, results%worst_error < 1.0e-9_rk, 'energy closes')
    call check(log, now%energy%strain < 1.0e-3_rk*pressure, 'contact stores nothing')
  end subroutine box_does_not_sink

  !> Puts the box on the joint.
  subroutine stand(log, penetration, now, results)
    type(test_log), intent(inout) :: log
    real(rk), intent(in) :: penetration !< [m]
    type(state), allocatable, intent(out) :: now
    type(recorder), intent(out) :: results
    type(problem) :: model
    type(error_type), allocatable :: error
    call make_row([0.0_rk, 1.0_rk], 1.0_rk, 2.0_rk, [young], [density], model)
    call put_on_ground(1, contraction_law(normal_stiffness=kn, tangent_stiffness=kn, &
                                          friction=0.5_rk, penetration=penetration), model)
    call add_gravity(gravity, model)
    call new_step('STATIC', 1.0_rk, 1.0_rk, model)
    call hold_ground(model)
    call start_analysis(model, now, error)
    call run_all_steps(model, now, results, error)
    call check(log,.not. allocated(error), 'runs')
  end subroutine stand

  !> Supports the nodes of the ground, behind the 8 of the box.
  subroutine hold_ground(model)
    type(problem), intent(inout) :: model
    integer :: dof
    do dof = 1, 3
      call fix([9, 10, 11, 12], dof, model)
    end do
  end subroutine hold_ground

  !> The condensed solver and full Newton take the same way, and no point is deeper than allowed.
  subroutine both_solvers_agree(log)
    type(test_log), intent(inout) :: log
    real(rk), parameter :: allowed = 1.0e-7_rk
    type(recorder) :: condensed, full
    type(state), allocatable :: one, other
    integer :: j
    call shake_arch('CONDENSED', allowed, condensed, one)
    call shake_arch('FULL', allowed, full, other)
    call check(log, condensed%sum_iterations == full%sum_iterations, 'as many iterations')
    call check_close(log, maxval(abs(one%u - other%u))/maxval(abs(other%u)), 0.0_rk, 1.0e-8_rk, &
                     'the same displacements')
    do j = 1, size(one%joints)
      associate (now => one%joints(j))
        call check(log, all(pack(abs(now%jump(1, :) + now%gap), now%status /= state_open) &
                            <= allowed), 'points in contact touch')
        call check(log, all(now%shift <= 0.0_rk), 'contact presses')
        call check(log, all(abs(pack(now%shift, now%status == state_open)) <= 0.0_rk), &
                   'open points have no multiplier')
      end associate
    end do
    call check(log, condensed%worst_error < 1.0e-6_rk, 'energy closes')
  end subroutine both_solvers_agree

  !> Weight, then a strong shake along the valley.
  subroutine shake_arch(joint_solver, allowed, results, now)
    character(*), intent(in) :: joint_solver
    real(rk), intent(in) :: allowed !< penetration [m]
    type(recorder), intent(inout) :: results
    type(state), allocatable, intent(out) :: now
    type(problem) :: model
    type(error_type), allocatable :: error
    type(amplitude) :: pulse
    integer :: i
    call make_heavy_arch(contraction_law(normal_stiffness=3.0e9_rk, &
                                         tangent_stiffness=4.0e10_rk, &
                                         friction=0.6_rk, &
                                         penetration=allowed), model)
    pulse%name = 'PULSE'
    pulse%time = [(0.01_rk*i, i=0, 60)]
    pulse%value = 8.0_rk*sin(20.0_rk*pulse%time)
    call shake_base(pulse, model)
    call new_step('DYNAMIC', 0.01_rk, 0.2_rk, model)
    do i = 1, 2
      model%steps(i)%controls%joint_solver = joint_solver
      model%steps(i)%controls%residual_tolerance = 1.0e-9_rk
    end do
    call start_analysis(model, now, error)
    call run_all_steps(model, now, results, error)
    if (allocated(error)) print '(a)', error%message
    call check(log,.not. allocated(error), joint_solver//' runs to the end')
  end subroutine shake_arch

  !> An increment starts with lambda = t of the converged history after any trial.
  subroutine multipliers_start_from_the_last_balance(log)
    type(test_log), intent(inout) :: log
    type(problem) :: model
    type(joint_state) :: old(1), new(1)
    type(contact_multiplier) :: multiplier
    call make_row([0.0_rk, 1.0_rk], 1.0_rk, 2.0_rk, [young], [density], model)
    call put_on_ground(1, contraction_law(normal_stiffness=1.0e9_rk, tangent_stiffness=1.0e9_rk, &
                                          penetration=1.0e-6_rk), model)
    call model%joints(1)%law%start_state(spread(0.0_rk, 1, 4), old(1))
    old(1)%status = [state_stick, state_slip, state_open, state_stick]
    old(1)%shift = [-2.0e-3_rk, -1.0e-3_rk, 0.0_rk, 0.0_rk]
    old(1)%jump(1, :) = [-1.0e-7_rk, 2.0e-7_rk, 1.0e-3_rk, 0.0_rk]
    new = old
    new(1)%shift = 1.0_rk
    call start_multiplier(model%joints, old, new, multiplier)
    call check(log, multiplier%is_there, 'penetration is limited')
    call check_close(log, new(1)%shift(1), -2.0001e-3_rk, 1.0e-15_rk, 'pressed in')
    call check_close(log, new(1)%shift(2), -0.9998e-3_rk, 1.0e-15_rk, 'shift under pressure')
    call check_close(log, new(1)%shift(3), 0.0_rk, 0.0_rk, 'open')
    call check_close(log, new(1)%shift(4), 0.0_rk, 0.0_rk, 'nothing carried')
  end subroutine multipliers_start_from_the_last_balance

  !> A box slides down a slope that its friction does not hold: what was computed is kept, the rest
  !> is not begun.
  subroutine slip_beyond_reach_ends_the_run(log)
    type(test_log), intent(inout) :: log
    real(rk), parameter :: reach = 0.02_rk, pull = 4.0_rk
    type(problem) :: model
    type(state), allocatable :: now
    type(recorder) :: results
    type(error_type), allocatable :: error
    type(amplitude) :: steady
    call make_row([0.0_rk, 1.0_rk], 1.0_rk, 1.0_rk, [young], [density], model)
    call put_on_ground(1, contraction_law(normal_stiffness=1.0e9_rk, tangent_stiffness=1.0e9_rk, &
                                          friction=0.1_rk), model)
    model%joints(1)%admissible_slip = [1.0_rk, 1.0_rk, reach, 1.0_rk]
    call add_gravity(gravity, model)
    call new_step('STATIC', 1.0_rk, 1.0_rk, model)
    steady%name = 'STEADY'
    steady%time = [0.0_rk, 100.0_rk]
    steady%value = [pull, pull]
    call shake_base(steady, model)
    call new_step('DYNAMIC', 0.01_rk, 1.0_rk, model)
    call hold_ground(model)
    call start_analysis(model, now, error)
    call run_all_steps(model, now, results, error)
    call check(log, allocated(error), 'stops')
    if (.not. allocated(error)) return
    call check(log, index(error%message, 'joint GROUND has slipped 0.0') == 1, 'names the joint')
    call check(log, index(error%message, ' at (1, 0, 0) at time 1.') > 0, 'names place and time')
    call check(log, index(error%message, 'allow small sliding only, 0.02 at') > 0, &
               'names what is allowed')
    ! From rest it moves by (pull - mu g) t^2/2.
    call check_close(log, now%step_time, sqrt(2.0_rk*reach/(pull - 0.1_rk*gravity)), 0.011_rk, &
                     'when it has gone that far')
    call check(log, results%num_increments > 10, 'what came before is kept')
    call check_close(log, results%time(size(results%time)), now%total_time, 1.0e-12_rk, &
                     'the last increment is reported')
  end subroutine slip_beyond_reach_ends_the_run
end program test_contact_augmentation
