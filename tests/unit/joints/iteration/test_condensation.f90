!> The condensed solver against full Newton on a jointed arch: the same iterates, with jumps as
!> unknowns of all points and without them where both ends are held in one direction.
program test_condensation
  use kinds, only: rk
  use errors, only: error_type
  use problem_definition, only: problem
  use analysis_state, only: state
  use amplitudes, only: amplitude
  use condensation, only: condensed_equilibrium
  use equilibrium, only: force_balance
  use initial_state, only: start_analysis
  use step_loop, only: run_all_steps
  use joint_law, only: state_open, state_slip
  use joint_contraction, only: contraction_law
  use arch_model, only: make_heavy_arch
  use row_model, only: shake_base, new_step, recorder, calls_of, fix
  use testing, only: test_log, check, check_close
  implicit none

  type(test_log) :: log

  log%suite = 'condensation'
  call compare(.false.)
  call compare(.true.)
  call limit_solves()
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> Compares both solvers.
  subroutine compare(is_held)
    logical, intent(in) :: is_held !< the first joint's nodes, in one direction
    type(recorder) :: condensed, full
    type(state), allocatable :: state_condensed, state_full
    call condensed%costs%open()
    call shake_arch('CONDENSED', is_held, condensed, state_condensed)
    call shake_arch('FULL', is_held, full, state_full)
    call check(log, calls_of(condensed, 'solve forward structure') > 0 .and. &
               calls_of(condensed, 'solve structure') == 0, &
               'one solve an increment')
    ! Jumps that are differences of displacements have fewer digits, and an iteration may be judged
    ! otherwise.
    call check(log, abs(condensed%sum_iterations - full%sum_iterations) <= merge(2, 0, is_held), &
               'as many iterations')
    call check(log, condensed%most_iterations > 2, 'friction and contact iterate')
    call check(log, condensed%most_iterations <= 10, 'at most ten iterations')
    call check_close(log, maxval(abs(state_condensed%u - state_full%u))/maxval(abs(state_full%u)), &
                     0.0_rk, 1.0e-9_rk, 'the same displacements')
    associate (status => state_full%joints(1)%status)
      call check(log, any(status == state_open) .or. any(status == state_slip), 'open or sliding')
    end associate
    call check(log, condensed%worst_error < 1.0e-6_rk, 'energy closes')
  end subroutine compare

  !> What solves may leave: a part of RESIDUAL times the largest force, and in statics of INCREMENT
  !> times the forces of the increment, which may be far smaller.
  subroutine limit_solves()
    type(condensed_equilibrium) :: solver
    type(force_balance) :: balance
    real(rk) :: moving
    balance%rhs = [3.0_rk, 4.0_rk]
    balance%reference_force = 1.0e6_rk
    solver%controls%residual_tolerance = 1.0e-6_rk
    solver%controls%increment_tolerance = 1.0e-4_rk
    moving = solver%admissible_residual(balance)
    balance%is_static = .true.
    call check_close(log, solver%admissible_residual(balance)/moving, 5.0e-4_rk, 1.0e-15_rk, &
                     'a small static increment')
    balance%rhs = 1.0e6_rk*balance%rhs
    call check_close(log, solver%admissible_residual(balance)/moving, 5.0_rk, 1.0e-12_rk, &
                     'a large one')
    balance%rhs = 0.0_rk*balance%rhs
    call check_close(log, solver%admissible_residual(balance)/moving, 1.0_rk, 1.0e-15_rk, &
                     'one without forces')
  end subroutine limit_solves

  !> Weight, then a strong shake along the valley.
  subroutine shake_arch(joint_solver, is_held, results, now)
    character(*), intent(in) :: joint_solver
    logical, intent(in) :: is_held
    type(recorder), intent(inout) :: results
    type(state), allocatable, intent(out) :: now
    type(problem) :: model
    type(error_type), allocatable :: error
    type(amplitude) :: pulse
    integer :: i
    call make_heavy_arch(contraction_law(normal_stiffness=1.0e11_rk, &
                                         tangent_stiffness=4.0e10_rk, &
                                         friction=0.6_rk), model)
    pulse%name = 'PULSE'
    pulse%time = [(0.01_rk*i, i=0, 60)]
    pulse%value = 8.0_rk*sin(20.0_rk*pulse%time)
    call shake_base(pulse, model)
    call new_step('DYNAMIC', 0.01_rk, 0.4_rk, model)
    if (is_held) call fix(model%joints(1)%node, 3, model)
    do i = 1, 2
      model%steps(i)%controls%joint_solver = joint_solver
      model%steps(i)%controls%residual_tolerance = 1.0e-9_rk
    end do
    call start_analysis(model, now, error)
    call run_all_steps(model, now, results, error)
    if (allocated(error)) print '(a)', error%message
    call check(log,.not. allocated(error), joint_solver//' runs to the end')
  end subroutine shake_arch
end program test_condensation
