!> The error that a reduced model leaves, from runs of the whole step with fewer modes
!> (theory.md, 7.4).
!>
!> The model is run with half and with all of its modes. The error of the model is about the
!> difference of their histories: 0.26 to 0.77 times as large in 21 models of seven dams.
module reduced_estimate
  use analysis_state, only: state
  use equilibrium, only: balance_outcome
  use hht_scheme, only: make_scheme
  use joint_operator, only: jump_operator
  use kinds, only: rk
  use problem_definition, only: problem
  use reduced_basis, only: reduced_model, keep_modes
  use reduced_increment, only: load_factors, take_reduced_increment
  use reduced_scheme, only: reduced_matrices
  use step_loads, only: step_time
  use step_plan, only: step, step_controls
  use step_system, only: dam_system
  implicit none
  private
  public :: estimate_error

  !> Error of a model over its difference from the model with half of the modes.
  real(rk), parameter :: share_of_difference = 0.5_rk
  !> A remainder below this fraction of an increment is round-off.
  real(rk), parameter :: round_off = 1.0e-9_rk
  !> Openings below this share of the displacements count as closed joints.
  real(rk), parameter :: smallest_share = 1.0e-4_rk
  !> A difference of displacements, over the largest, that counts where joints stay closed: the
  !> accuracy is that of openings, but a model of too few modes must not pass.
  real(rk), parameter :: gross_share = 0.2_rk
  !> Tolerances of the joints in these runs: far below the differences that matter, with fewer
  !> iterations.
  real(rk), parameter :: rough_residual = 1.0e-4_rk, rough_correction = 1.0e-2_rk

contains

  !> The error of the openings, over the largest, or of displacements where joints stay closed: runs
  !> the step with half and with all modes.
  subroutine estimate_error(model, plan, system, basis, start, estimate)
    type(problem), intent(in) :: model
    type(step), intent(in) :: plan
    type(dam_system), intent(in) :: system
    type(reduced_model), intent(in) :: basis
    type(state), intent(in) :: start !< of the step, with its modes
    real(rk), intent(out) :: estimate
    real(rk), allocatable :: half(:, :), whole(:, :)
    real(rk) :: difference, largest, motion
    integer :: n, points, fewer
    fewer = max(1, basis%num_modes/2)
    ! Without the motions of loose blocks a model says nothing of them. All of them are there where
    ! the shapes had more than the modes.
    if (basis%num_modes < basis%num_shapes) then
      fewer = max(fewer, count(basis%lambda <= basis%shift))
    end if
    call run_modes(model, plan, system, basis, fewer, start, half, motion)
    call run_modes(model, plan, system, basis, basis%num_modes, start, whole, motion)
    n = min(size(half, 2), size(whole, 2))
    points = system%operator%num_points
    largest = maxval([0.0_rk, abs(whole(:points, :n))])
    if (largest > smallest_share*motion) then
      difference = maxval(abs(whole(:points, :n) - half(:points, :n)))
    else ! no joints, or they stay closed
      difference = maxval([0.0_rk, abs(whole(points + 1:, :n) - half(points + 1:, :n))])
      largest = maxval([tiny(1.0_rk), abs(whole(points + 1:, :n))])
      if (points > 0 .and. difference <= gross_share*largest) difference = 0.0_rk
    end if
    difference = share_of_difference*difference
    estimate = 1.0_rk
    if (difference < largest) estimate = difference/largest
    ! Without equilibrium in all increments the estimate is the largest.
    if (n < num_increments_of(plan)) estimate = 1.0_rk
  end subroutine estimate_error

  !> The increments of a step.
  pure integer function num_increments_of(plan)
    type(step), intent(in) :: plan
    num_increments_of = ceiling(plan%duration/plan%first_increment - round_off)
  end function num_increments_of

  !> The histories of a run with the lowest modes: openings, then displacements of some nodes. Ends
  !> early at an increment without equilibrium.
  subroutine run_modes(model, plan, system, basis, num_modes, start, histories, motion)
    type(problem), intent(in) :: model
    type(step), intent(in) :: plan
    type(dam_system), intent(in) :: system
    type(reduced_model), intent(in) :: basis
    integer, intent(in) :: num_modes
    type(state), intent(in) :: start
    real(rk), allocatable, intent(out) :: histories(:, :) !< (points and probes, increments) [m]
    real(rk), intent(out) :: motion !< largest displacement of a probe [m]
    type(reduced_model) :: fewer
    type(reduced_matrices) :: matrices
    type(state), allocatable :: now, trial, other
    type(step_time) :: when
    type(balance_outcome) :: outcome
    type(step_controls) :: controls
    real(rk) :: factors(size(basis%force, 2), 2)
    integer :: i, num_increments
    controls = plan%controls
    controls%residual_tolerance = max(controls%residual_tolerance, rough_residual)
    controls%increment_tolerance = max(controls%increment_tolerance, rough_correction)
    call keep_modes(basis, num_modes, fewer)
    call matrices%prepare(fewer, make_scheme(plan%alpha, plan%first_increment, &
                                             plan%controls%joint_forces), model%joints, &
                          system%operator)
    now = start
    call shorten(num_modes, now)
    trial = now
    when = step_time(is_dynamic=.true., start=start%step_start, duration=plan%duration)
    associate (first => start%motion%modal%start_factor)
      factors(:, 2) = load_factors(system%groups, model%amplitudes, when, first)
      num_increments = num_increments_of(plan)
      motion = 0.0_rk
      allocate (histories(system%operator%num_points + size(fewer%probe), num_increments))
      do i = 1, num_increments
        call when%set_end((i - 1)*plan%first_increment, plan%first_increment)
        factors(:, 1) = factors(:, 2)
        factors(:, 2) = load_factors(system%groups, model%amplitudes, when, first)
        call take_reduced_increment(fewer, matrices, model, controls, factors, now, trial, outcome)
        if (.not. outcome%has_converged) exit
        call watch(fewer, system%operator, trial, histories(:, i))
        motion = max(motion, maxval(abs(motion_of_probes(fewer, trial))))
        call move_alloc(now, other)
        call move_alloc(trial, now)
        call move_alloc(other, trial)
      end do
    end associate
    histories = histories(:, :i - 1)
  end subroutine run_modes

  !> The state of a model with fewer modes.
  subroutine shorten(num_modes, now)
    integer, intent(in) :: num_modes
    type(state), intent(inout) :: now
    associate (modal => now%motion%modal)
      modal%y = modal%y(:num_modes)
      modal%rate = modal%rate(:num_modes)
      modal%acceleration = modal%acceleration(:num_modes)
    end associate
  end subroutine shorten

  !> The displacements of the probes since the start of the step [m].
  pure function motion_of_probes(basis, now) result(values)
    type(reduced_model), intent(in) :: basis
    type(state), intent(in) :: now
    real(rk) :: values(size(basis%probe))
    integer :: part, num_ports, num_loads
    num_ports = size(basis%path, 1)
    num_loads = size(basis%force, 2)
    values = matmul(basis%mode(basis%probe, :), now%motion%modal%y)
    do part = 1, size(basis%residual, 2)/num_ports
      values = values + matmul(basis%load_shape(basis%probe, (part - 1)*num_loads + 1: &
                                                part*num_loads), &
                               now%motion%modal%port(part*num_ports - num_loads + 1: &
                                                     part*num_ports))
    end do
  end function motion_of_probes

  !> The openings now, then the displacements of the probes.
  subroutine watch(basis, operator, now, values)
    type(reduced_model), intent(in) :: basis
    type(jump_operator), intent(in) :: operator
    type(state), intent(in) :: now
    real(rk), intent(out) :: values(:) !< [m]
    integer :: j
    values(operator%num_points + 1:) = motion_of_probes(basis, now)
    do j = 1, size(now%joints)
      values(operator%first_point(j):operator%first_point(j + 1) - 1) = &
        max(0.0_rk, now%joints(j)%jump(1, :) + now%joints(j)%gap)
    end do
  end subroutine watch
end module reduced_estimate
