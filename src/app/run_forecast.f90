!> What a run will take: time and memory, from counts of the model, the planned entries of the
!> factor and the speed of this machine, measured for a moment.
!>
!> The coefficients are those of runs on two cores of 2.2 GHz (`reference_rate`). Joints and cracks
!> take the iterations of strong motions. Dense matrices of joints grow with their points squared,
!> or with their points where joints are separators in the factor.
module run_forecast
  use dense_products, only: times
  use errors, only: error_type
  use kinds, only: rk
  use problem_definition, only: problem
  use run_ledger, only: ledger
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
    real(rk) :: analysis = 0.0_rk !< seconds that the analysis has just taken
  end type run_counts

  real(rk), parameter :: reference_rate = 45.0e9_rk !< products of matrices [operations/s]
  integer, parameter :: size_of_trial = 384, num_trials = 3
  real(rk), parameter :: largest = 3.0e5_rk !< unknowns of a model whose factor is planned
  !> Points of joints that stay together at the end of the factor; of more points each group is a
  !> separator, and the inverse of the factor is kept in its pattern for a moment.
  real(rk), parameter :: most_at_the_end = 1500.0_rk

  ! On the reference machine [s]: per entry of the factor, unknown, point of a joint, integration
  ! point of a law and increment.
  real(rk), parameter :: factor_time = 1.0e-11_rk, solve_time = 1.6e-9_rk
  real(rk), parameter :: products_time = 3.0e-7_rk, envelope_time = 1.3e-7_rk
  real(rk), parameter :: point_time = 3.0e-5_rk, law_time = 1.5e-6_rk, law_iterations = 8.0_rk
  real(rk), parameter :: output_time = 3.0e-4_rk

contains

  !> A section of `keyway --check`; '' where no step has displacements.
  function forecast_of(model, costs) result(text)
    type(problem), intent(in) :: model
    type(ledger), intent(in) :: costs
    character(:), allocatable :: text
    character, parameter :: nl = new_line('a')
    type(run_counts) :: counts
    real(rk) :: time, slowness
    logical :: is_counted
    integer :: i
    text = ''
    if (size(model%steps) == 0) return
    call count_work(model, costs, counts, is_counted)
    if (.not. is_counted) return
    slowness = reference_rate/measured_rate()
    time = 0.1_rk + 2.0_rk*counts%analysis
    do i = 1, size(model%steps)
      time = time + slowness*time_of_step(model%steps(i), counts)
    end do
    text = 'Cost on this machine, as it is busy now'//nl// &
           '  unknowns                '//as_text(nint(counts%unknowns))//nl// &
           '  entries of the factor   '//as_short_text(counts%entries)//nl// &
           '  time                    about '//as_short_text(rounded(time))//' s'//nl// &
           '  memory                  about '// &
           as_short_text(rounded(memory_of(counts)))//' MB'
  end function forecast_of

  !> Builds the structure of the first step and plans its factor.
  subroutine count_work(model, costs, counts, is_counted)
    type(problem), intent(in) :: model
    type(ledger), intent(in) :: costs
    type(run_counts), intent(out) :: counts
    logical, intent(out) :: is_counted
    type(dam_system) :: system
    type(cholmod_solver) :: factor
    type(error_type), allocatable :: error
    real(rk) :: bytes, peak, started_at
    integer :: i
    is_counted = .false.
    if (3.0_rk*model%mesh%num_nodes > largest) return
    started_at = wall_clock()
    call build_structure(model, model%steps(1), system, costs, error)
    if (allocated(error)) return
    call factor%analyse(system%matrix, error)
    if (allocated(error)) return
    counts%analysis = wall_clock() - started_at
    counts%unknowns = real(system%matrix%num_free, rk)
    counts%points = real(system%operator%num_points, rk)
    if (allocated(model%inelastic)) then
      do i = 1, size(model%inelastic)
        counts%law_points = counts%law_points + model%inelastic(i)%points%num_points
      end do
    end if
    call factor%statistics(counts%entries, bytes, peak)
    is_counted = .true.
  end subroutine count_work

  !> Time of a step on the reference machine [s].
  real(rk) function time_of_step(plan, counts) result(time)
    type(step), intent(in) :: plan
    type(run_counts), intent(in) :: counts
    real(rk) :: solve, increments, iterations
    solve = solve_time*counts%entries
    time = factor_time*counts%entries**1.5_rk + 2.0_rk*counts%analysis
    if (plan%procedure%finds_modes) then
      time = time + 4.0_rk*plan%num_modes*solve
      return
    end if
    increments = max(1.0_rk, plan%duration/max(plan%first_increment, tiny(1.0_rk)))
    iterations = 0.0_rk
    if (counts%law_points > 0.0_rk) iterations = law_iterations
    time = time + increments*(output_time + solve + products_time*counts%unknowns &
                              + point_time*counts%points &
                              + iterations*(0.7_rk*solve + law_time*counts%law_points))
    if (allocated(plan%envelope)) time = time + increments*envelope_time*counts%unknowns
  end function time_of_step

  !> Memory [MB].
  pure real(rk) function memory_of(counts) result(memory)
    type(run_counts), intent(in) :: counts
    memory = 22.0_rk + 1.0e-5_rk*counts%entries + 2.5e-3_rk*counts%unknowns &
             + 1.0e-3_rk*counts%law_points
    if (counts%points <= most_at_the_end) then
      memory = memory + 2.4e-4_rk*counts%points**2
    else
      memory = memory + 0.8e-5_rk*counts%entries + 0.08_rk*counts%points
    end if
  end function memory_of

  !> Speed of products of matrices now, the best of some trials [operations/s].
  real(rk) function measured_rate() result(rate)
    real(rk), allocatable :: a(:, :), b(:, :), c(:, :)
    real(rk) :: started_at
    integer :: i
    allocate (a(size_of_trial, size_of_trial), b(size_of_trial, size_of_trial), source=1.0_rk)
    allocate (c(size_of_trial, size_of_trial))
    rate = 1.0_rk
    do i = 1, num_trials
      started_at = wall_clock()
      c = times(a, b)
      rate = max(rate, 2.0_rk*real(size_of_trial, rk)**3/max(wall_clock() - started_at, 1.0e-6_rk))
    end do
  end function measured_rate

  !> One significant digit, or two below 3: a forecast has no more.
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
