!> Solids that soften in steps: bars against closed forms, the order of Newton's method, energies,
!> joints, and a law that fails.
program test_solid_iteration
  use kinds, only: rk
  use errors, only: error_type
  use amplitudes, only: amplitude
  use problem_definition, only: problem
  use analysis_state, only: state
  use initial_state, only: start_analysis
  use step_loop, only: run_all_steps
  use joint_contraction, only: contraction_law
  use material_elastic, only: elastic_law
  use row_model, only: make_row, put_at_wall, shake_base, new_step, fix, kick, recorder, &
                       calls_of
  use softening_law, only: damage_law, put_law
  use equilibrium, only: balance_outcome
  use state_transfer, only: start_motion
  use increment_balance, only: increment_task
  use solid_iteration, only: solid_solver
  use step_equilibrium, only: make_equilibrium, prepare_equilibrium, add_moving_supports
  use step_loads, only: step_time, prescribed_values
  use run_ledger, only: ledger
  use step_system, only: dam_system, build_structure, build_loads
  use testing, only: test_log, check, check_close
  implicit none

  type(test_log) :: log
  real(rk), parameter :: young = 3.0e10_rk
  character(10), parameter :: tangents(3) = [character(10) :: 'CONSISTENT', 'SECANT', 'ELASTIC']
  integer :: i

  log%suite = 'solid_iteration'
  do i = 1, 3
    call one_box_softens(tangents(i), log)
    call weak_box_localises(tangents(i), log)
    call bar_is_shaken(tangents(i), log)
    call joint_is_beside(tangents(i), log)
  end do
  call elastic_bar_costs_nothing(log)
  call law_gives_up(log)
  call law_wants_less(log)
  call starts_cracked(log)
  call newton_is_quadratic(log)
  call auto_falls_back(log)
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> A row of boxes of 1 m x 0.5 m x 0.5 m, Poisson's ratio 0, fixed at the left end, with a
  !> prescribed motion of the right end.
  subroutine make_bar(num_boxes, pull, increment, tangent, model)
    integer, intent(in) :: num_boxes
    real(rk), intent(in) :: pull !< of the right end in one static step [m]
    real(rk), intent(in) :: increment
    character(*), intent(in) :: tangent
    type(problem), intent(out) :: model
    integer :: k
    call make_row([(real(k, rk), k=0, num_boxes)], 0.5_rk, 0.5_rk, spread(young, 1, num_boxes), &
                  spread(2400.0_rk, 1, num_boxes), model)
    call new_step('STATIC', increment, 1.0_rk, model)
    model%steps(1)%controls%tangent = tangent
    model%steps(1)%controls%residual_tolerance = 1.0e-10_rk
    model%steps(1)%is_direct = .true.
    call fix([1, 2, 3, 4], 1, model)
    call fix([1, 2], 3, model)
    call fix([1, 4], 2, model)
    if (.not. abs(pull) > 0.0_rk) return
    call fix([4*num_boxes + 1, 4*num_boxes + 2, 4*num_boxes + 3, 4*num_boxes + 4], 1, model)
    associate (last => size(model%steps(1)%fixities))
      model%steps(1)%fixities(last - 3:)%value = pull
    end associate
  end subroutine make_bar

  !> Runs it.
  subroutine run(model, results, now, log)
    type(problem), intent(inout) :: model
    type(recorder), intent(inout) :: results
    type(state), allocatable, intent(out) :: now
    type(test_log), intent(inout) :: log
    type(error_type), allocatable :: error
    call results%costs%open()
    call start_analysis(model, now, error)
    call run_all_steps(model, now, results, error)
    if (allocated(error)) print '(a)', error%message
    call check(log,.not. allocated(error), model%steps(1)%controls%tangent//' runs to the end')
    call check_close(log, results%worst_error, 0.0_rk, 1.0e-8_rk, &
                     model%steps(1)%controls%tangent//': error of the energy balance')
  end subroutine run

  !> sigma = E e0 exp(-(e - e0)/ef) in one box that is pulled: force, stored and fracture energy.
  subroutine one_box_softens(tangent, log)
    character(*), intent(in) :: tangent
    type(test_log), intent(inout) :: log
    type(problem) :: model
    type(recorder) :: results
    type(state), allocatable :: now
    real(rk) :: stress, strain, work
    call make_bar(1, 1.0e-3_rk, 0.01_rk, tangent, model)
    call put_law(damage_law(elastic=elastic_law(young=young)), [1], model)
    call run(model, results, now, log)
    strain = 1.0e-3_rk
    stress = young*1.0e-4_rk*exp(-0.9_rk)
    call check_close(log, sum(now%reaction(1, 5:8)), 0.25_rk*stress, 1.0e-7_rk*stress, 'force')
    call check_close(log, now%energy%strain, 0.125_rk*stress*strain, 1.0e-7_rk*stress*strain, &
                     'stored energy')
    ! Work under the curve, less what is stored; means of 100 increments: some (0.01)^2.
    work = 0.25_rk*young*1.0e-4_rk*(0.5e-4_rk + 1.0e-3_rk*(1.0_rk - exp(-0.9_rk)))
    call check_close(log, now%energy%fracture, work - 0.125_rk*stress*strain, 1.0e-3_rk*work, &
                     'fracture energy')
    call check(log, now%energy%crushing <= 0.0_rk, 'no crushing')
  end subroutine one_box_softens

  !> Five boxes, the middle one weak: it softens, the others unload. At the end its strain e follows
  !> from the force they share, 4 sigma/E + e = 1e-3 with sigma = E e0 exp(-(e - e0)/ef).
  subroutine weak_box_localises(tangent, log)
    character(*), intent(in) :: tangent
    type(test_log), intent(inout) :: log
    type(problem) :: model
    type(recorder) :: results
    type(state), allocatable :: now
    real(rk) :: e
    integer :: k
    call make_bar(5, 1.0e-3_rk, 0.05_rk, tangent, model)
    call put_law(damage_law(elastic=elastic_law(young=young), threshold=1.5e-4_rk), [1, 2, 4, 5], &
                 model)
    call put_law(damage_law(elastic=elastic_law(young=young), threshold=0.9e-4_rk), [3], model)
    call run(model, results, now, log)
    e = 1.0e-3_rk
    do k = 1, 200
      e = 1.0e-3_rk - 4.0_rk*0.9e-4_rk*exp(-(e - 0.9e-4_rk)/1.0e-3_rk)
    end do
    call check_close(log, now%u(1, 13) - now%u(1, 9), e, 1.0e-5_rk*e, 'strain of the weak box')
    call check(log, results%most_iterations > 1, 'iterates')
  end subroutine weak_box_localises

  !> A bar cracks near its end when its base is shaken along it.
  subroutine bar_is_shaken(tangent, log)
    character(*), intent(in) :: tangent
    type(test_log), intent(inout) :: log
    type(problem) :: model
    type(recorder) :: results
    type(state), allocatable :: now
    real(rk), save :: reference = 0.0_rk
    call make_bar(6, 0.0_rk, 1.0_rk, tangent, model)
    call shake(model)
    model%steps(2)%controls = model%steps(1)%controls
    call put_law(damage_law(elastic=elastic_law(young=young), threshold=2.0e-5_rk, &
                            slope=1.0e-3_rk), [1, 2, 3, 4, 5, 6], model)
    results%watched_node = 25
    call run(model, results, now, log)
    call check(log, now%energy%fracture > 1.0e-3_rk*now%energy%largest, 'cracks')
    call check(log, abs(now%energy%numerical) < 0.1_rk*now%energy%largest, 'stepping takes little')
    if (tangent == tangents(1)) reference = now%u(1, 25)
    call check_close(log, now%u(1, 25), reference, 1.0e-5_rk*maxval(abs(results%u)), &
                     'the same motion with all tangents')
  end subroutine bar_is_shaken

  subroutine shake(model)
    type(problem), intent(inout) :: model
    type(amplitude) :: pulse
    integer :: k
    pulse%name = 'PULSE'
    pulse%time = [(0.001_rk*k, k=0, 60)]
    pulse%value = 60.0_rk*sin(300.0_rk*pulse%time)
    call shake_base(pulse, model)
    call new_step('DYNAMIC', 5.0e-4_rk, 0.05_rk, model)
  end subroutine shake

  !> A joint without strength at the wall opens and closes while the bar cracks.
  subroutine joint_is_beside(tangent, log)
    character(*), intent(in) :: tangent
    type(test_log), intent(inout) :: log
    type(problem) :: model
    type(recorder) :: results
    type(state), allocatable :: now
    real(rk), save :: reference = 0.0_rk
    integer :: k
    call make_row([(real(k, rk), k=0, 4)], 0.5_rk, 0.5_rk, spread(young, 1, 4), &
                  spread(2400.0_rk, 1, 4), model)
    call put_at_wall(contraction_law(normal_stiffness=1.0e12_rk, tangent_stiffness=1.0e12_rk, &
                                     friction=0.5_rk), model)
    call shake(model)
    model%steps(1)%controls%tangent = tangent
    model%steps(1)%controls%residual_tolerance = 1.0e-10_rk
    call put_law(damage_law(elastic=elastic_law(young=young, poisson=0.2_rk), threshold=3.0e-6_rk, &
                            slope=1.0e-4_rk), [1, 2, 3, 4], model)
    results%watched_node = 17
    call run(model, results, now, log)
    call check(log, now%energy%fracture > 1.0e-3_rk*now%energy%largest, 'cracks')
    if (tangent == tangents(1)) reference = now%u(1, 17)
    call check_close(log, now%u(1, 17), reference, 1.0e-5_rk*maxval(abs(results%u)), &
                     'the same motion with all tangents')
  end subroutine joint_is_beside

  !> Below its strength a solid takes one solve an increment and one factor.
  subroutine elastic_bar_costs_nothing(log)
    type(test_log), intent(inout) :: log
    type(problem) :: model
    type(recorder) :: results
    type(state), allocatable :: now
    call make_bar(5, 4.0e-4_rk, 0.1_rk, 'CONSISTENT', model)
    call put_law(damage_law(elastic=elastic_law(young=young)), [1, 2, 3, 4, 5], model)
    call run(model, results, now, log)
    call check(log, results%most_iterations == 1, 'one iteration')
    call check(log, calls_of(results, 'factor structure') == 1, 'one factor')
    call check(log, calls_of(results, 'update inelastic solids') == 10, &
               'laws are called once an increment')
  end subroutine elastic_bar_costs_nothing

  !> A law that cannot go on ends the run where it was, with its own words.
  subroutine law_gives_up(log)
    type(test_log), intent(inout) :: log
    type(problem) :: model
    type(recorder) :: results
    type(state), allocatable :: now
    type(error_type), allocatable :: error
    call make_bar(1, 1.0e-3_rk, 0.1_rk, 'CONSISTENT', model)
    model%steps(1)%is_direct = .false.
    call put_law(damage_law(elastic=elastic_law(young=young), largest_strain=5.0e-4_rk), [1], model)
    call results%costs%open()
    call start_analysis(model, now, error)
    call run_all_steps(model, now, results, error)
    call check(log, allocated(error), 'an error')
    if (.not. allocated(error)) return
    call check(log, index(error%message, 'material SOFT, element 1, point 1: strained too far ' &
                          //'(increment ') == 1, 'names law, element, point, increment: ' &
               //error%message)
    call check(log, now%u(1, 5) > 4.9e-4_rk .and. now%u(1, 5) <= 5.0e-4_rk, &
               'the last state is kept, cut down to the limit')
  end subroutine law_gives_up

  !> A law that wants a smaller increment gets it at once: it is not asked again with the tangent
  !> that stands by. Each increment is elastic and takes one call.
  subroutine law_wants_less(log)
    type(test_log), intent(inout) :: log
    type(problem) :: model
    type(recorder) :: results
    type(state), allocatable :: now
    call make_bar(1, 0.8e-4_rk, 1.0_rk, 'AUTO', model)
    model%steps(1)%is_direct = .false.
    call put_law(damage_law(elastic=elastic_law(young=young), largest_change=2.0e-5_rk), [1], model)
    call run(model, results, now, log)
    call check(log, now%cutbacks > 0, 'increments are cut')
    call check(log, calls_of(results, 'update inelastic solids') &
               == results%num_increments + now%cutbacks, &
               'one call for each increment, taken or cut')
  end subroutine law_wants_less

  !> Initial displacements beyond the strength: what they have dissipated is there from the start,
  !> and the energies add up (`run` checks it).
  subroutine starts_cracked(log)
    type(test_log), intent(inout) :: log
    type(problem) :: model
    type(recorder) :: results
    type(state), allocatable :: now
    call make_bar(1, 0.0_rk, 1.0_rk, 'AUTO', model)
    model%steps = model%steps(:0)
    call new_step('DYNAMIC', 1.0e-6_rk, 1.0e-5_rk, model)
    model%steps(1)%controls%residual_tolerance = 1.0e-10_rk
    call fix([1, 2, 3, 4], 1, model)
    call kick([5, 6, 7, 8], 1, 5.0e-4_rk, .false., model)
    call put_law(damage_law(elastic=elastic_law(young=young)), [1], model)
    call run(model, results, now, log)
    call check(log, now%energy%fracture > 0.1_rk*now%energy%initial, 'cracks at the start')
  end subroutine starts_cracked

  !> Residuals of one large increment of a crooked bar: the order log(r3/r2)/log(r2/r1) of the last
  !> three above round-off is that of Newton's method, 2.
  subroutine newton_is_quadratic(log)
    type(test_log), intent(inout) :: log
    type(problem) :: model
    type(balance_outcome) :: outcome
    real(rk) :: order
    integer :: last, k
    call make_bar(8, 1.2e-3_rk, 1.0_rk, 'CONSISTENT', model)
    model%steps(1)%controls%residual_tolerance = 1.0e-13_rk
    model%mesh%x = model%mesh%x + 0.05_rk*sin(reshape([(37.0_rk*k, k=1, size(model%mesh%x))], &
                                                      shape(model%mesh%x)))
    call put_law(damage_law(elastic=elastic_law(young=young, poisson=0.2_rk)), &
                 [4], model)
    call solve_increment(model, outcome)
    print '(a,*(es9.1))', 'residuals of Newton iterations:', outcome%history
    call check(log, outcome%has_converged, 'Newton converges')
    last = count(outcome%history > 1.0e-12_rk)
    associate (r => log10(outcome%history(last - 2:last)))
      order = (r(3) - r(2))/(r(2) - r(1))
    end associate
    call check(log, order > 1.8_rk, 'quadratically')
  end subroutine newton_is_quadratic

  !> The other boxes come to their strength with the weak one, and Newton's method does not know
  !> which of them is to crack; the secant that follows it does.
  subroutine auto_falls_back(log)
    type(test_log), intent(inout) :: log
    type(problem) :: model
    type(recorder) :: results
    type(state), allocatable :: now
    call make_bar(5, 1.0e-3_rk, 0.05_rk, 'AUTO', model)
    call put_law(damage_law(elastic=elastic_law(young=young)), [1, 2, 4, 5], model)
    call put_law(damage_law(elastic=elastic_law(young=young), threshold=0.9e-4_rk), [3], model)
    call run(model, results, now, log)
    call check(log, results%num_increments == 20, 'in as many increments')
  end subroutine auto_falls_back

  !> The first increment of a static step, by itself.
  subroutine solve_increment(model, outcome)
    type(problem), intent(inout) :: model
    type(balance_outcome), intent(out) :: outcome
    type(dam_system) :: system
    type(solid_solver) :: solids
    type(increment_task) :: task
    type(state), allocatable :: now, after
    type(ledger) :: costs
    type(error_type), allocatable :: error
    call start_analysis(model, now, error)
    call build_structure(model, model%steps(1), system, costs, error)
    call build_loads(model, model%steps(1), now%u, system, costs)
    call make_equilibrium(model%steps(1), system, .false., solids%solver, error)
    call prepare_equilibrium(model, system, system%stiffness, 1.0_rk, solids%solver, error)
    call start_motion(system%numbers, model%joints, now, has_inertia=.false.)
    call solids%open(model, system, model%steps(1), now)
    call solids%open_increment(now, 1.0_rk)
    solids%values = system%stiffness
    after = now
    task%start = now%motion%q
    call prescribed_values(system%supports, model%amplitudes, step_time(now=1.0_rk), task%start)
    allocate (task%x(size(task%start)), task%balance%rhs(system%matrix%num_free))
    task%balance%rhs = 0.0_rk
    call add_moving_supports(system, system%stiffness, task%start, task%balance%rhs)
    task%counts_reactions = .true.
    call solids%solve_increment(model, system, task, now, after, outcome, error)
  end subroutine solve_increment
end program test_solid_iteration
