!> What a run will take: time, memory and files, from counts of the model, the planned entries of
!> the factor and the speed of this machine.
!>
!> The coefficients are those of runs on two processors of the machine whose speeds are `reference`.
!> Joints and cracks take the iterations of strong motions; in short increments cracks take fewer.
!> Dense matrices of joints grow with their points squared, or with their points where joints are
!> separators in the factor.
module run_forecast
  use errors, only: error_type
  use kinds, only: rk
  use machine_speed, only: find_speeds, speed
  use node_dofs, only: num_directions
  use omp_lib, only: omp_get_max_threads
  use problem_definition, only: problem
  use ranks, only: num_ranks
  use run_file_sizes, only: num_planned, size_of_files
  use run_ledger, only: ledger, ledger_part
  use solver_cholmod, only: cholmod_solver
  use step_plan, only: step
  use step_system, only: build_structure, dam_system
  use timer, only: wall_clock
  use write_text, only: as_short_text, as_text
  implicit none
  private
  public :: forecast_of

  !> What the costs depend on.
  type :: run_counts
    real(rk) :: unknowns = 0.0_rk, points = 0.0_rk !< of joints
    real(rk) :: law_points = 0.0_rk !< integration points of inelastic solids
    real(rk) :: entries = 0.0_rk !< of the factor
    real(rk) :: reading = 0.0_rk !< seconds that reading the deck has taken
    real(rk) :: analysis = 0.0_rk !< seconds that building and planning the first matrix has taken
  end type run_counts

  type(speed), parameter :: reference = speed(products=5.8e10_rk, sweeps=2.8e9_rk)
  integer, parameter :: most_planned = 300000 !< unknowns of a model whose factor is planned
  integer, parameter :: width_of_names = 24 !< in lines of the forecast
  !> Points of joints that stay together at the end of the factor. Of more points in statics each
  !> group is a separator, and the inverse of the factor is kept in its pattern for a moment.
  real(rk), parameter :: most_in_motion = 1500.0_rk, most_in_statics = 3000.0_rk
  real(rk), parameter :: busy = 1.5_rk !< times as slow as ever measured: it is said

  ! On the reference machine [s].
  real(rk), parameter :: start_time = 0.004_rk, step_time = 0.005_rk
  real(rk), parameter :: factor_time = 2.0e-11_rk !< per entry to the power of 1.5
  real(rk), parameter :: solve_time = 0.75e-9_rk !< per entry of a factor near the processor
  real(rk), parameter :: far_solve_time = 1.1e-9_rk !< per entry of a factor in the memory
  real(rk), parameter :: far_entries = 1.6e7_rk
  real(rk), parameter :: products_time = 2.7e-7_rk, envelope_time = 1.2e-7_rk !< per unknown
  real(rk), parameter :: point_time = 1.5e-5_rk, pair_time = 1.2e-8_rk !< of joints
  real(rk), parameter :: law_time = 6.5e-8_rk
  real(rk), parameter :: law_iterations = 10.0_rk, static_iterations = 15.0_rk
  real(rk), parameter :: long_increment = 0.01_rk !< with all of law_iterations [s]
  real(rk), parameter :: fewest_iterations = 2.0_rk
  !> JOINT SOLVER=FULL and TANGENT=CONSISTENT: factors of an increment, and their time over that of
  !> a symmetric matrix. They were counted in dams of 3879 and 7029 unknowns at 0.5 g.
  real(rk), parameter :: joint_factors = 4.0_rk, consistent_factors = 6.0_rk
  real(rk), parameter :: unsymmetric_time = 2.0_rk
  !> *DYNAMIC, REDUCED: solves and factors for the shapes, and runs over the step.
  real(rk), parameter :: shape_solves = 150.0_rk, shape_factors = 4.0_rk, num_trials = 3.0_rk
  real(rk), parameter :: expand_time = 1.2e-6_rk !< per unknown, of displacements for envelopes
  real(rk), parameter :: iteration_time = 6.0e-8_rk !< of inelastic solids, per unknown
  real(rk), parameter :: mode_solves = 10.0_rk !< for each mode
  real(rk), parameter :: set_up_solves = 15.0_rk !< of a step with joints
  real(rk), parameter :: output_time = 2.5e-4_rk, file_time = 4.0e-3_rk !< per increment, per MB
  real(rk), parameter :: serial_share = 0.4_rk !< of an increment without laws

  ! Memory [MB].
  real(rk), parameter :: program_memory = 23.0_rk
  real(rk), parameter :: static_memory = 2.5e-3_rk, dynamic_memory = 4.0e-3_rk !< per unknown
  real(rk), parameter :: entry_memory = 1.2e-5_rk !< per entry of the factor
  real(rk), parameter :: inverse_memory = 0.6e-5_rk !< per entry, of the inverse in its pattern
  real(rk), parameter :: copy_memory = 4.0e-6_rk !< per entry, of a copy in single precision
  real(rk), parameter :: law_memory = 1.9e-3_rk !< per point of C3D8; 1.1e-3 more with operators
  real(rk), parameter :: point_memory = 0.08_rk, pair_memory = 2.4e-4_rk !< of joints

contains

  !> A section of `keyway --check`; '' where the deck has no steps.
  function forecast_of(model, costs) result(text)
    type(problem), intent(in) :: model
    type(ledger), intent(in) :: costs
    character(:), allocatable :: text
    type(run_counts) :: counts
    character(:), allocatable :: why_not
    type(speed) :: now, best
    real(rk) :: time, delay, files
    text = ''
    if (size(model%steps) == 0) return
    files = size_of_files(model, real(sum([0, model%joints%num_points]), rk))
    call count_work(model, costs, counts, why_not)
    if (why_not /= '') then
      text = 'Cost on this machine'//row('time, memory', 'no forecast: '//why_not)// &
             row('files', about(files, ' MB'))
      return
    end if
    call find_speeds(now, best)
    delay = slowness(now)/slowness(best)
    counts%reading = counts%reading/delay
    time = time_of_run(model%steps, counts, slowness(best)) + file_time*files
    text = 'Cost on this machine, when it is idle'
    if (num_ranks() > 1) text = text//', in one process'
    text = text// &
           row('unknowns', as_text(nint(counts%unknowns)))// &
           row('entries of the factor', as_short_text(counts%entries))// &
           row('time', about(time, ' s'))// &
           row('memory', about(memory_of(model%steps, counts), ' MB'))// &
           row('files', about(files, ' MB'))
    if (delay > busy) then
      text = text//new_line('a')//'  the machine is busy now: '//about(delay*time, ' s')
    end if
  end function forecast_of

  !> A line with a name and a value.
  pure function row(name, value) result(line)
    character(*), intent(in) :: name, value
    character(:), allocatable :: line
    character(width_of_names) :: room
    room = name
    line = new_line('a')//'  '//room//value
  end function row

  !> 'about 25 MB'.
  pure function about(number, unit) result(text)
    real(rk), intent(in) :: number
    character(*), intent(in) :: unit
    character(:), allocatable :: text
    text = 'about '//as_short_text(rounded(number))//unit
  end function about

  !> Builds the structure of the first step and plans its factor, or says why it does not.
  subroutine count_work(model, costs, counts, why_not)
    type(problem), intent(in) :: model
    type(ledger), intent(in) :: costs
    type(run_counts), intent(out) :: counts
    character(:), allocatable, intent(out) :: why_not !< '' for counts that are complete
    type(dam_system) :: system
    type(cholmod_solver) :: factor
    type(error_type), allocatable :: error
    type(ledger_part), allocatable :: parts(:)
    real(rk) :: bytes, peak, started_at, worked_at, worked
    if (num_directions*model%mesh%num_nodes > most_planned) then
      why_not = 'planning the factor of more than '//as_text(most_planned)// &
                ' unknowns takes too long'
      return
    end if
    call costs%read_parts(parts, counts%reading) ! with the compiler of a UMAT
    ! The processor time does not count what other programs take, the wall clock not what threads do
    ! at once.
    started_at = wall_clock()
    call cpu_time(worked_at)
    call build_structure(model, model%steps(1), system, costs, error)
    if (.not. allocated(error)) call factor%analyse(system%matrix, error)
    if (allocated(error)) then
      why_not = error%message
      return
    end if
    call cpu_time(worked)
    counts%analysis = min(wall_clock() - started_at, worked - worked_at)
    counts%unknowns = real(system%matrix%num_free, rk)
    counts%points = real(system%operator%num_points, rk)
    counts%law_points = law_points_of(model)
    call factor%statistics(counts%entries, bytes, peak)
    why_not = ''
  end subroutine count_work

  !> Integration points of inelastic solids.
  pure real(rk) function law_points_of(model) result(total)
    type(problem), intent(in) :: model
    integer :: i
    total = 0.0_rk
    if (.not. allocated(model%inelastic)) return
    do i = 1, size(model%inelastic)
      total = total + model%inelastic(i)%num_points()
    end do
  end function law_points_of

  !> How slow a machine is, over the reference. Solves and products with sparse matrices are
  !> limited by the memory, laws and factors by the processor.
  pure real(rk) function slowness(machine)
    type(speed), intent(in) :: machine
    slowness = sqrt(reference%products/machine%products*reference%sweeps/machine%sweeps)
  end function slowness

  !> Time of a run [s].
  real(rk) function time_of_run(steps, counts, slow) result(time)
    type(step), intent(in) :: steps(:)
    type(run_counts), intent(in) :: counts
    real(rk), intent(in) :: slow !< this machine over the reference
    integer :: i
    time = slow*start_time + counts%reading
    do i = 1, size(steps)
      time = time + counts%analysis + slow*time_of_step(steps(i), counts)
    end do
  end function time_of_run

  !> Time of a step on the reference machine, without what is counted from the run [s].
  real(rk) function time_of_step(plan, counts) result(time)
    type(step), intent(in) :: plan
    type(run_counts), intent(in) :: counts
    real(rk) :: solve, factor, joints, increment, iterations, share, spread
    ! Two threads did the work of the reference.
    spread = 2.0_rk/omp_get_max_threads()
    share = serial_share + (1.0_rk - serial_share)*spread
    solve = counts%entries*(solve_time + (far_solve_time - solve_time) &
                            *min(1.0_rk, counts%entries/far_entries))
    factor = spread*factor_time*counts%entries**1.5_rk
    time = step_time + factor
    if (plan%procedure%finds_modes) then
      time = time + share*mode_solves*plan%num_modes*solve
      return
    end if
    joints = counts%points*(point_time + pair_time*min(counts%points, most_at_the_end(plan)))
    if (counts%points > 0.0_rk) time = time + share*set_up_solves*solve
    if (plan%procedure%scheme == 'REDUCED') then
      time = time + shape_factors*factor + share*shape_solves*solve &
             + num_planned(plan)*(output_time + num_trials*joints)
      if (has_envelope(plan)) time = time + num_planned(plan)*expand_time*counts%unknowns
      return
    end if
    iterations = iterations_of(plan, counts)
    increment = solve + products_time*counts%unknowns + joints &
                + iterations*(solve + iteration_time*counts%unknowns)
    if (has_envelope(plan)) increment = increment + envelope_time*counts%unknowns
    time = time + num_planned(plan)*(output_time + share*increment &
                                     + iterations*spread*law_time*counts%law_points &
                                     + factors_of(plan, counts)*unsymmetric_time*factor)
  end function time_of_step

  !> Whether a step has *ENVELOPE of fields that need displacements.
  pure logical function has_envelope(plan)
    type(step), intent(in) :: plan
    has_envelope = .false.
    if (allocated(plan%envelope)) has_envelope = any(plan%envelope /= 'OPENING')
  end function has_envelope

  !> Iterations of an increment on cracks.
  pure real(rk) function iterations_of(plan, counts) result(iterations)
    type(step), intent(in) :: plan
    type(run_counts), intent(in) :: counts
    iterations = 0.0_rk
    if (.not. counts%law_points > 0.0_rk) return
    iterations = static_iterations
    if (plan%procedure%is_static()) return
    iterations = law_iterations*min(1.0_rk, plan%first_increment/long_increment)
    iterations = max(fewest_iterations, iterations)
  end function iterations_of

  !> Factors of an increment, where its tangents are factored.
  pure real(rk) function factors_of(plan, counts) result(factors)
    type(step), intent(in) :: plan
    type(run_counts), intent(in) :: counts
    factors = 0.0_rk
    if (counts%law_points > 0.0_rk .and. plan%controls%tangent == 'CONSISTENT') then
      factors = consistent_factors
    end if
    if (counts%points > 0.0_rk .and. plan%controls%joint_solver == 'FULL') then
      factors = max(factors, joint_factors, iterations_of(plan, counts))
    end if
  end function factors_of

  !> Memory [MB]. A dynamic step has mass, damping and the matrix of the increment as well.
  pure real(rk) function memory_of(steps, counts) result(memory)
    type(step), intent(in) :: steps(:)
    type(run_counts), intent(in) :: counts
    real(rk) :: of_unknown
    of_unknown = static_memory
    if (any(steps%procedure%has_inertia)) of_unknown = dynamic_memory
    memory = program_memory + entry_memory*counts%entries + of_unknown*counts%unknowns &
             + law_memory*counts%law_points
    if (any(has_copy(steps))) memory = memory + copy_memory*counts%entries
    if (counts%points <= maxval(most_at_the_end(steps))) then
      memory = memory + pair_memory*counts%points**2
    else
      memory = memory + inverse_memory*counts%entries + point_memory*counts%points
    end if
  end function memory_of

  !> Most points of joints at the end of the factor of a step.
  elemental real(rk) function most_at_the_end(plan)
    type(step), intent(in) :: plan
    most_at_the_end = merge(most_in_motion, most_in_statics, plan%procedure%has_inertia)
  end function most_at_the_end

  !> Whether a step keeps a copy of the factor in single precision.
  elemental logical function has_copy(plan)
    type(step), intent(in) :: plan
    has_copy = plan%procedure%scheme == 'HHT' .and. plan%controls%precision == 'MIXED'
  end function has_copy

  !> Two significant digits, the second a 0 or 5 above 3: a forecast has no more.
  pure real(rk) function rounded(number)
    real(rk), intent(in) :: number
    real(rk) :: unit
    rounded = number
    if (number <= 0.0_rk) return
    unit = 10.0_rk**(floor(log10(number)) - 1)
    if (number/unit >= 30.0_rk) unit = 5.0_rk*unit
    rounded = unit*anint(number/unit)
  end function rounded
end module run_forecast
