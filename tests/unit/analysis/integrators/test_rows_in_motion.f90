!> Rows of boxes in motion (HHT), free, on joints and at a wall, against closed forms.
program test_rows_in_motion
  use kinds, only: rk
  use errors, only: error_type
  use problem_definition, only: problem
  use analysis_state, only: state
  use amplitudes, only: amplitude
  use initial_state, only: start_analysis
  use step_loop, only: run_all_steps
  use joint_contraction, only: contraction_law
  use row_model, only: make_row, put_on_ground, put_at_wall, add_gravity, shake_base, new_step, &
                       fix, kick, recorder, calls_of
  use testing, only: test_log, check, check_close
  implicit none

  real(rk), parameter :: pi = acos(-1.0_rk)
  type(test_log) :: log

  log%suite = 'rows_in_motion'
  call linear_energy_closes(log)
  call order_is_two(log)
  call friction_decays(log)
  call mass_slides_on_moving_base(log)
  call block_falls_and_stays(log)
  call bar_hits_wall(log)
  call block_rocks(log)
  call bar_flies(log)
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> Runs all steps; an error fails the test.
  subroutine run(model, results, log)
    type(problem), intent(inout) :: model
    type(recorder), intent(inout) :: results
    type(test_log), intent(inout) :: log
    type(state), allocatable :: now
    type(error_type), allocatable :: error
    call start_analysis(model, now, error)
    call run_all_steps(model, now, results, error)
    if (allocated(error)) print '(a)', error%message
    call check(log,.not. allocated(error), 'runs to the end')
  end subroutine run

  !> A cantilever of four boxes, plucked: undamped, the balance closes to roundoff, with HHT too.
  subroutine linear_energy_closes(log)
    type(test_log), intent(inout) :: log
    type(problem) :: model
    type(recorder) :: results
    real(rk), parameter :: x(5) = [0.0_rk, 1.0_rk, 2.0_rk, 3.0_rk, 4.0_rk]
    integer :: i, k
    do k = 1, 2
      call make_row(x, 1.0_rk, 1.0_rk, spread(3.0e9_rk, 1, 4), spread(2400.0_rk, 1, 4), model)
      call add_gravity(9.81_rk, model)
      call new_step('DYNAMIC', 0.001_rk, 0.2_rk, model)
      model%steps(1)%alpha = merge(0.0_rk, -0.05_rk, k == 1)
      do i = 1, 3
        call fix([1, 2, 3, 4], i, model)
      end do
      call kick([17, 18, 19, 20], 2, 1.0_rk, .true., model)
      results = recorder(watched_node=17)
      call results%costs%open()
      call run(model, results, log)
      call check(log, results%worst_error < 1.0e-11_rk, 'undamped energy closes to roundoff')
      call check(log, calls_of(results, 'factor structure') == 1, 'factored once')
      call check(log, results%most_iterations == 1, 'not iterated')
      call check(log, results%num_increments == 200, '200 increments')
      if (k == 2) cycle
      call check_close(log, results%total(size(results%total)), results%total(1), &
                       results%total(1), 'energy of the trapezoidal rule is bounded')
    end do
  end subroutine linear_energy_closes

  !> One unknown, u = u0 cos(w t) with w^2 = K/M = (E/L)/(rho L/3): the error falls with dt^2.
  subroutine order_is_two(log)
    type(test_log), intent(inout) :: log
    type(problem) :: model
    type(recorder) :: results
    real(rk), parameter :: u0 = 1.0e-3_rk, alpha(2) = [0.0_rk, -0.05_rk]
    real(rk) :: w, error(2), period
    integer :: i, k
    w = sqrt(3.0_rk*3.0e9_rk/2400.0_rk)
    period = 2.0_rk*pi/w
    do i = 1, 2
      do k = 1, 2
        call make_row([0.0_rk, 1.0_rk], 1.0_rk, 1.0_rk, [3.0e9_rk], [2400.0_rk], model)
        call new_step('DYNAMIC', period/(50*k), 1.25_rk*period, model)
        model%steps(1)%alpha = alpha(i)
        call fix([1, 2, 3, 4], 1, model)
        call fix([1, 2, 3, 4, 5, 6, 7, 8], 2, model)
        call fix([1, 2, 3, 4, 5, 6, 7, 8], 3, model)
        call kick([5, 6, 7, 8], 1, u0, .false., model)
        results = recorder(watched_node=5)
        call run(model, results, log)
        error(k) = maxval(abs(results%u - u0*cos(w*results%time)))/u0
      end do
      call check_close(log, log_ratio(error), 2.0_rk, 0.05_rk, 'order in time')
    end do
  end subroutine order_is_two

  pure real(rk) function log_ratio(error)
    real(rk), intent(in) :: error(2)
    intrinsic :: log
    log_ratio = log(error(1)/error(2))/log(2.0_rk)
  end function log_ratio

  !> A mass of 1 kg on a spring of 1e4 N/m, friction 0.1, g 10: extremes 0.85, -0.65, 0.45, -0.25,
  !> 0.05 mm, then rest (code_aster SDND100, closed form).
  subroutine friction_decays(log)
    type(test_log), intent(inout) :: log
    type(problem) :: model
    type(recorder) :: results
    real(rk), parameter :: extreme(5) = 1.0e-3_rk*[0.85_rk, -0.65_rk, 0.45_rk, -0.25_rk, 0.05_rk]
    real(rk) :: half
    integer :: i
    call make_row([0.0_rk, 1.0_rk, 1.1_rk], 1.0_rk, 0.01_rk, [1.0e6_rk, 1.0e9_rk], &
                  [0.0_rk, 1000.0_rk], model)
    call put_on_ground(2, contraction_law(normal_stiffness=1.0e9_rk, tangent_stiffness=1.0e9_rk, &
                                          friction=0.1_rk), model)
    call add_gravity(10.0_rk, model)
    call new_step('STATIC', 1.0_rk, 1.0_rk, model)
    call new_step('DYNAMIC', 1.0e-4_rk, 0.2_rk, model)
    call fix([1, 2, 3, 4], 1, model)
    call fix([1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12], 2, model)
    call fix([1, 2, 3, 4], 3, model)
    results = recorder(watched_node=9)
    half = pi/sqrt(1.0e4_rk)
    call hold_and_release(model)
    call run(model, results, log)
    do i = 1, 5
      associate (near => abs(results%time - 2.0_rk - (i - 1)*half) < 0.02_rk*half)
        call check(log, any(abs(pack(results%u, near) - extreme(i)) < 0.01e-3_rk), 'extreme')
      end associate
    end do
  end subroutine friction_decays

  !> The mass is pulled to 0.85 mm in a static step of its own.
  subroutine hold_and_release(model)
    type(problem), intent(inout) :: model
    integer :: i
    model%steps = [model%steps(1), model%steps(1), model%steps(2)]
    do i = 1, 2
      model%steps(i)%fixities = [model%steps(i)%fixities, model%steps(i)%fixities(:4)]
    end do
    do i = 1, 4
      associate (plan => model%steps(2))
        plan%fixities(size(plan%fixities) - 4 + i)%node = 8 + i
        plan%fixities(size(plan%fixities) - 4 + i)%dof = 1
        plan%fixities(size(plan%fixities) - 4 + i)%value = 0.85e-3_rk
        plan%loads%start_factor = 1.0_rk
      end associate
    end do
    model%steps(1)%fixities = model%steps(1)%fixities(:size(model%steps(1)%fixities) - 4)
  end subroutine hold_and_release

  !> 1 kg on a base that moves with 1.5 sin(2 pi t), friction 0.1, g 10: peak-to-peak slip
  !> 0.0204531 m and friction work 0.0409062 J a cycle (code_aster SDND104, closed form).
  subroutine mass_slides_on_moving_base(log)
    type(test_log), intent(inout) :: log
    type(problem) :: model
    type(recorder) :: results
    type(amplitude) :: sine
    integer :: i, first
    call make_row([0.0_rk, 0.1_rk], 0.1_rk, 0.1_rk, [1.0e9_rk], [1000.0_rk], model)
    call put_on_ground(1, contraction_law(normal_stiffness=1.0e9_rk, tangent_stiffness=1.0e9_rk, &
                                          friction=0.1_rk), model)
    call add_gravity(10.0_rk, model)
    call new_step('STATIC', 1.0_rk, 1.0_rk, model)
    sine%name = 'SINE'
    sine%time = [(0.005_rk*i, i=0, 800)]
    sine%value = 1.5_rk*sin(2.0_rk*pi*sine%time)
    call shake_base(sine, model)
    call new_step('DYNAMIC', 0.005_rk, 4.0_rk, model)
    results = recorder(watched_node=1)
    call run(model, results, log)
    first = count(results%time <= 4.0_rk) ! the last cycle, after 1 s of static time
    call check_close(log, maxval(results%u(first:)) - minval(results%u(first:)), 0.0204531_rk, &
                     2.0e-4_rk, 'peak-to-peak slip')
    call check_close(log, results%friction(size(results%friction)) - results%friction(first), &
                     0.0409062_rk, 2.0e-4_rk, 'friction work of a cycle')
  end subroutine mass_slides_on_moving_base

  !> A block that falls on its joint settles at its own weight; an open one falls freely.
  subroutine block_falls_and_stays(log)
    type(test_log), intent(inout) :: log
    type(problem) :: model
    type(recorder) :: results
    call make_row([0.0_rk, 1.0_rk], 1.0_rk, 1.0_rk, [1.0e9_rk], [2400.0_rk], model)
    call put_on_ground(1, contraction_law(normal_stiffness=1.0e9_rk, tangent_stiffness=1.0e9_rk, &
                                          friction=0.5_rk, gap=0.1_rk), model)
    call add_gravity(10.0_rk, model)
    call new_step('DYNAMIC', 0.01_rk, 0.1_rk, model)
    results = recorder(watched_node=1, watched_dof=3)
    call run(model, results, log)
    call check_close(log, results%u(size(results%u)), -0.05_rk, 1.0e-12_rk, 'free fall')
    call check(log, results%worst_error < 1.0e-11_rk, 'free fall: energy closes')
    model%steps(1)%duration = 2.0_rk
    results = recorder(watched_node=1, watched_dof=3)
    call run(model, results, log)
    call check(log, maxval(results%total(20:)) < 1.02_rk*maxval(results%total(:20)), &
               'the rebounds give no energy')
  end subroutine block_falls_and_stays

  !> L 10 m, E 25 GPa, rho 2400, 1 m/s: contact lasts 6.19677 ms at 7.74597 MPa, then the bar leaves
  !> with all its energy (closed form).
  subroutine bar_hits_wall(log)
    type(test_log), intent(inout) :: log
    type(problem) :: model
    type(recorder) :: results
    integer, parameter :: n = 100
    integer :: i
    real(rk) :: dt, contact, plateau
    call make_row([(0.1_rk*i, i=0, n)], 1.0_rk, 1.0_rk, spread(25.0e9_rk, 1, n), &
                  spread(2400.0_rk, 1, n), model)
    call put_at_wall(contraction_law(normal_stiffness=1.0e12_rk, tangent_stiffness=1.0e12_rk), &
                     model)
    dt = 0.1_rk/sqrt(25.0e9_rk/2400.0_rk)
    call new_step('DYNAMIC', dt, 100*dt, model)
    call fix([(i, i=1, 4*n + 4)], 2, model)
    call fix([(i, i=1, 4*n + 4)], 3, model)
    call kick([(i, i=1, 4*n + 4)], 1, -1.0_rk, .true., model)
    model%steps(1)%duration = 300*dt
    results = recorder(watched_node=1)
    call run(model, results, log)
    contact = dt*count(results%pressure > 0.05_rk*7.74597e6_rk)
    call check_close(log, contact, 6.19677e-3_rk, 3.0_rk*dt, 'contact time')
    plateau = sum(pack(results%pressure, results%time > 1.0e-3_rk .and. results%time < 5.0e-3_rk))
    plateau = plateau/count(results%time > 1.0e-3_rk .and. results%time < 5.0e-3_rk)
    call check_close(log, plateau, 7.74597e6_rk, 0.002_rk*7.74597e6_rk, 'contact pressure')
    call check_close(log, results%total(size(results%total)), results%total(1), &
                     0.03_rk*results%total(1), 'energy after the contact')
  end subroutine bar_hits_wall

  !> A bar in free flight, 0.1 mm from a wall: all forces are round-off.
  subroutine bar_flies(log)
    type(test_log), intent(inout) :: log
    type(problem) :: model
    type(recorder) :: results
    integer, parameter :: n = 100
    integer :: i
    call make_row([(0.1_rk*i, i=0, n)], 1.0_rk, 1.0_rk, spread(25.0e9_rk, 1, n), &
                  spread(2400.0_rk, 1, n), model)
    call put_at_wall(contraction_law(normal_stiffness=1.0e12_rk, tangent_stiffness=1.0e12_rk, &
                                     gap=1.0e-4_rk), model)
    call new_step('DYNAMIC', 7.75e-6_rk, 10*7.75e-6_rk, model)
    call fix([(i, i=1, 4*n + 4)], 2, model)
    call fix([(i, i=1, 4*n + 4)], 3, model)
    call kick([(i, i=1, 4*n + 4)], 1, -1.0_rk, .true., model)
    results = recorder(watched_node=1)
    call run(model, results, log)
    call check(log, results%num_increments == 10, 'no increment is cut')
    call check_close(log, results%u(size(results%u)), -7.75e-5_rk, 1.0e-15_rk, 'free flight')
  end subroutine bar_flies

  !> A block of 1 x 4 m, free from a tilt of 0.01 about one edge: the restoring moment is constant,
  !> the quarter period sqrt(2 theta I/(W b)) = 0.15201 s (closed form, small tilt).
  subroutine block_rocks(log)
    type(test_log), intent(inout) :: log
    type(problem) :: model
    type(recorder) :: results
    real(rk), parameter :: tilt = 0.01_rk
    integer :: k, node
    call make_row([0.0_rk, 1.0_rk], 1.0_rk, 4.0_rk, [1.0e12_rk], [2400.0_rk], model)
    call put_on_ground(1, contraction_law(normal_stiffness=1.0e11_rk, tangent_stiffness=1.0e11_rk, &
                                          friction=1.0_rk), model)
    call add_gravity(9.81_rk, model)
    call new_step('DYNAMIC', 5.0e-4_rk, 0.2_rk, model)
    do node = 1, 8
      call kick([node], 1, -tilt*model%mesh%x(3, node), .false., model)
      call kick([node], 3, tilt*model%mesh%x(1, node), .false., model)
    end do
    results = recorder(watched_node=4)
    call run(model, results, log)
    k = findloc(results%u >= 0.0_rk, .true., 1)
    call check_close(log, results%time(k), 0.15201_rk, 1.0e-3_rk, 'quarter period of rocking')
  end subroutine block_rocks
end program test_rows_in_motion
