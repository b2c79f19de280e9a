!> Common parts of the condensed and the full iteration on joint forces: linearisation of the laws
!> at a trial jump, residual and correction.
module joint_iteration
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use kinds, only: rk
  use global_vectors, only: norm, distance, length, total
  use joint_law, only: joint_state, phase_absent
  use joint_points, only: dam_joint
  use joint_operator, only: jump_operator
  use joint_forces, only: joint_field, evaluate_joints, gather_tractions, gather_jumps
  use joint_forces, only: gather_gaps, size_of_origins
  use contact_scaling, only: contact_scale
  use contact_augmentation, only: start_multiplier, measure_contact, update_multiplier
  use equilibrium, only: force_balance, balance_outcome
  use step_plan, only: step_controls
  use tresca_friction, only: evaluate_tresca
  implicit none
  private
  public :: joint_increment, iteration_history, start_iteration, linearise, take_step
  public :: excess_traction
  public :: closed_tangent, measure_residual, measure_correction, goes_on, close_iteration
  public :: smallest_force

  !> The joints of an increment and the state of their iteration. The pointers are views of what
  !> the caller owns: an increment must not outlive it.
  type :: joint_increment
    type(step_controls), pointer :: controls => null()
    type(dam_joint), pointer :: joints(:) => null()
    type(jump_operator), pointer :: operator => null()
    real(rk), pointer :: k_ref(:, :) => null() !< (3, points) stiffness of the closed joint [Pa/m]
    type(joint_state), pointer :: old(:) => null() !< converged histories
    type(joint_state), pointer :: new(:) => null() !< histories of the last evaluation
    type(joint_field) :: field !< jumps, tractions and tangents of the last evaluation
    real(rk) :: step = 0.0_rk !< norm of the last correction of all jumps [m]
    type(balance_outcome) :: outcome
  contains
    procedure :: view
  end type joint_increment

  !> Residuals and corrections of one run of Newton's iteration.
  type :: iteration_history
    real(rk), allocatable :: unbalance(:) !< of its iterations
    real(rk), allocatable :: step(:) !< norms of their corrections [m]
    integer :: least = 1 !< iteration with the least of them
    logical :: has_ended = .false. !< it has converged, cycles or gives up
  end type iteration_history

  !> Stiffness of open and sliding points in the iteration matrix, relative to k_ref. It limits the
  !> motion of a block that has no contact in one iterate. The residual does not contain it.
  real(rk), parameter :: stiffness_floor = 1.0e-10_rk
  !> Largest force that this stiffness may carry at the jumps found, over the reference force of the
  !> bulk. Beyond it a block has left its supports, and this stiffness holds it. It then carries the
  !> load, so that a force far above the load is none of this kind: joints opened by supports.
  real(rk), parameter :: most_kept = 0.05_rk
  !> r of the first iteration over that of a point alone (theory.md, 2.3): points that open or slide
  !> together show less stiffness than one alone.
  real(rk), parameter :: first_share = 0.3_rk
  !> Round-off of an opening, over the norm of all jumps.
  real(rk), parameter :: touching = 1.0e-10_rk
  !> A cycle repeats its residuals and corrections to this fraction of them; longest cycle that is
  !> looked for.
  real(rk), parameter :: same_size = 0.02_rk
  integer, parameter :: longest_cycle = 6
  !> Floor of the joint forces in the residual, as a fraction of the reference force of the bulk.
  real(rk), parameter :: smallest_share = 1.0e-6_rk
  !> Most passes of the augmented Lagrangian in an increment. About 5 are needed where the structure
  !> is as stiff as the contact.
  integer, parameter :: most_augmentations = 25
  !> Floor of the increment of the jumps, as a fraction of the jumps.
  real(rk), parameter :: smallest_increment = 1.0e-3_rk

  !> Most iterations over those of *CONTROLS; beyond those the least residual is not older than
  !> `gaining` iterations.
  integer, parameter :: most_attempts = 2, gaining = 5

  !> A residual below this is round-off: sums of some hundred products in double precision.
  real(rk), parameter :: smallest_residual = 1.0e-13_rk

contains

  !> Makes the pointers views of the arguments.
  subroutine view(self, controls, joints, operator, k_ref, old, new)
    class(joint_increment), intent(inout) :: self
    type(step_controls), intent(in), target :: controls
    type(dam_joint), intent(in), target :: joints(:)
    type(jump_operator), intent(in), target :: operator
    real(rk), intent(in), target :: k_ref(:, :) !< (3, points) [Pa/m]
    type(joint_state), intent(in), target :: old(:)
    type(joint_state), intent(inout), target :: new(:)
    self%controls => controls
    self%joints => joints
    self%operator => operator
    self%k_ref => k_ref
    self%old => old
    self%new => new
  end subroutine view

  !> Linearises the laws at the guess, or takes all joints as closed and sticking.
  subroutine start_iteration(balance, scale, now)
    type(force_balance), intent(in) :: balance
    type(contact_scale), intent(in) :: scale
    type(joint_increment), intent(inout) :: now !< with its views
    integer :: n
    n = now%operator%num_points
    associate (field => now%field, k_ref => now%k_ref)
      allocate (field%traction(3, n), field%iterate(3, n), field%tangent(3, 3, n))
      allocate (field%start_jump(3, n))
      allocate (field%num_openings(n), source=0)
      allocate (field%is_open(n), source=.false.)
      field%scale = scale
      field%scale%own = first_share*scale%own
      field%bulk_force = balance%reference_force
      field%is_static = balance%is_static
      field%jump = balance%guess
      field%response = balance%guess
      call gather_tractions(now%operator, now%old, field%traction)
      call gather_jumps(now%operator, now%old, field%start_jump)
      field%origin_size = size_of_origins(now%old)
      field%start_spring = field%traction/k_ref
      call start_multiplier(now%joints, now%old, now%new, field%contact)
      call gather_gaps(now%operator, now%new, field%gap)
      field%start_force = norm(spread(now%operator%area, 1, 3)*field%traction)
      field%multiplier = field%traction
      if (allocated(balance%guess_traction)) field%multiplier = balance%guess_traction
      field%tangent = closed_tangent(k_ref)
      if (balance%starts_closed) then
        field%iterate = k_ref*field%jump
        return
      end if
      ! A point that is open in the guess has not opened in this increment.
      field%is_open = .true.
    end associate
    call linearise(now)
    if (balance%is_static .and. .not. allocated(balance%guess_traction)) then
      call close_touching_points(now)
    end if
  end subroutine start_iteration

  !> Points that touch without traction, as those of new or grouted blocks do, are closed and stick
  !> in the first iterate: round-off would decide which of them are open.
  subroutine close_touching_points(now)
    type(joint_increment), intent(inout) :: now !< linearised at the guess
    real(rk) :: round_off
    integer :: j, p, first
    associate (field => now%field)
      round_off = touching*max(norm(field%start_jump), field%origin_size) ! [m]
      do j = 1, size(now%joints)
        first = now%operator%first_point(j)
        do p = first, now%operator%first_point(j + 1) - 1
          if (any(abs(field%start_spring(:, p)) > 0.0_rk)) cycle
          if (abs(field%start_jump(1, p) + field%gap(p)) > round_off) cycle
          if (allocated(now%old(j)%phase)) then
            if (now%old(j)%phase(p - first + 1) == phase_absent) cycle
          end if
          field%tangent(:, :, p:p) = closed_tangent(now%k_ref(:, p:p))
          field%iterate(:, p) = now%k_ref(:, p)*field%jump(:, p)
          field%is_open(p) = .false.
        end do
      end do
    end associate
  end subroutine close_touching_points

  !> Evaluates the laws and adds the smallest stiffness where a joint is open or slides.
  subroutine linearise(now)
    type(joint_increment), intent(inout) :: now
    integer :: p, i
    associate (field => now%field, k_ref => now%k_ref)
      if (allocated(field%tresca%bound)) then
        call evaluate_tresca(k_ref, field)
      else
        field%was_open = field%is_open
        call evaluate_joints(now%joints, now%operator, now%old, field, now%new)
        where (field%is_open .and. .not. field%was_open) field%num_openings = field%num_openings + 1
      end if
      do p = 1, now%operator%num_points
        do i = 1, 3
          if (field%tangent(i, i, p) < k_ref(i, p)) then
            field%tangent(i, i, p) = field%tangent(i, i, p) + stiffness_floor*k_ref(i, p)
          end if
        end do
      end do
    end associate
  end subroutine linearise

  !> Moves to the solution of the linearised equilibrium and evaluates the laws there.
  subroutine take_step(correction, linear, now)
    real(rk), intent(in) :: correction(:, :) !< (3, points) of the jumps [m]
    real(rk), intent(in) :: linear(:, :) !< (3, points) tractions of the solution [Pa]
    type(joint_increment), intent(inout) :: now
    now%step = norm(correction)
    now%field%response = now%field%jump + correction
    now%field%jump = now%field%response
    now%field%multiplier = linear
    call linearise(now)
  end subroutine take_step

  !> Whether a measure of the last iterations repeats the values before them, with any period.
  pure logical function is_repeated(measure)
    real(rk), intent(in) :: measure(:) !< of the iterations so far
    integer :: period, n
    n = size(measure)
    is_repeated = .false.
    do period = 1, min(longest_cycle, n/3)
      associate (last => measure(n - 2*period + 1:n), &
                 before => measure(n - 3*period + 1:n - period))
        is_repeated = is_repeated .or. all(abs(last - before) <= same_size*last)
      end associate
    end do
  end function is_repeated

  !> Whether Newton's iteration goes on: up to the number of *CONTROLS, and beyond it while the
  !> residual decreases.
  pure logical function goes_on(history, now)
    type(iteration_history), intent(in) :: history
    type(joint_increment), intent(in) :: now
    integer :: iteration
    iteration = now%outcome%iterations - now%outcome%pass_start
    associate (most => now%controls%max_iterations)
      goes_on = .not. history%has_ended .and. &
                (iteration < most .or. (iteration < most_attempts*most .and. &
                                        iteration - history%least < gaining))
    end associate
  end function goes_on

  !> Ends an iteration: augments the contact of joints in equilibrium, and looks for cycles. A cycle
  !> takes the same states again: residuals and corrections are repeated. A block that has left its
  !> supports moves on with the same residuals. Residuals alone may agree far from the solution,
  !> where all are 1, and near it, where one point changes its state after the other.
  subroutine close_iteration(now, history)
    type(joint_increment), intent(inout) :: now
    type(iteration_history), intent(inout) :: history
    integer :: iteration
    associate (outcome => now%outcome)
      if (outcome%has_converged) then
        call augment_contact(now)
        history%has_ended = outcome%has_converged .or. outcome%gives_up
        if (history%has_ended) return
      end if
      iteration = outcome%iterations - outcome%pass_start
      if (iteration == 0) then
        history%unbalance = [real(rk) ::]
        history%step = history%unbalance
        return
      end if
      history%has_ended = .not. ieee_is_finite(outcome%unbalance)
      if (history%has_ended) return
      history%unbalance = [history%unbalance, outcome%unbalance]
      history%step = [history%step, now%step]
      history%least = minloc(history%unbalance, 1)
      history%has_ended = is_repeated(history%unbalance) &
                          .and. (outcome%is_driven .or. is_repeated(history%step))
      outcome%is_loose = history%has_ended .and. outcome%is_driven
    end associate
  end subroutine close_iteration

  !> Augments the contact where points penetrate more than their law allows. The laws are then
  !> linearised at the equilibrium found, and the iteration continues.
  subroutine augment_contact(now)
    type(joint_increment), intent(inout) :: now
    integer :: worst_point
    associate (field => now%field, outcome => now%outcome)
      if (.not. field%contact%is_there .or. allocated(field%tresca%bound)) return
      call measure_contact(now%joints, now%operator, now%new, field%contact, outcome%penetration, &
                           worst_point)
      if (outcome%penetration <= 1.0_rk) return
      outcome%has_converged = .false.
      outcome%worst_point = worst_point
      outcome%gives_up = outcome%augmentations >= most_augmentations
      if (outcome%gives_up) return
      outcome%augmentations = outcome%augmentations + 1
      if (outcome%augmentations == 1) outcome%first_pass = outcome%iterations
      outcome%pass_start = outcome%iterations
      call update_multiplier(now%joints, now%operator, field%scale%shared/now%k_ref(1, :), &
                             field%contact, now%new)
      call gather_gaps(now%operator, now%new, field%gap)
    end associate
    call linearise(now)
  end subroutine augment_contact

  !> Tangents of closed, sticking joints.
  pure function closed_tangent(k_ref) result(tangent)
    real(rk), intent(in) :: k_ref(:, :) !< (3, points) [Pa/m]
    real(rk) :: tangent(3, 3, size(k_ref, 2)) !< [Pa/m]
    integer :: p, i
    tangent = 0.0_rk
    do p = 1, size(k_ref, 2)
      do i = 1, 3
        tangent(i, i, p) = k_ref(i, p)
      end do
    end do
  end function closed_tangent

  !> Traction of the closed joint beyond that of the law, k_ref (v - offset) - t. It enters the
  !> right-hand side because k_ref is part of the matrix.
  pure function excess_traction(k_ref, jump, offset, traction) result(excess)
    real(rk), intent(in) :: k_ref(:, :) !< (3, points) [Pa/m]
    real(rk), intent(in) :: jump(:, :), offset(:, :) !< (3, points) [m]
    real(rk), intent(in) :: traction(:, :) !< (3, points) [Pa]
    real(rk) :: excess(3, size(jump, 2)) !< [Pa]
    excess = k_ref*(jump - offset) - traction
  end function excess_traction

  !> Residual: forces of the laws minus linearised forces, over the norm of the joint forces.
  subroutine measure_residual(linear, now)
    real(rk), intent(in) :: linear(:, :) !< (3, points) tractions of the linearised solution [Pa]
    type(joint_increment), intent(inout) :: now !< its field at the new jumps
    real(rk), dimension(now%operator%num_points) :: unbalance, square
    real(rk) :: force, kept
    integer :: p
    associate (field => now%field, outcome => now%outcome, area => now%operator%area)
      do p = 1, size(unbalance)
        unbalance(p) = area(p)*sqrt(sum((field%traction(:, p) - linear(:, p))**2))
        square(p) = sum((area(p)*field%traction(:, p))**2)
      end do
      force = max(sqrt(total(square)), smallest_force(field))
      kept = 0.0_rk
      if (field%is_static) kept = norm(stiffness_floor*spread(area, 1, 3)*now%k_ref*field%jump)
      if (kept <= most_kept*field%bulk_force .or. most_kept*kept > field%bulk_force) kept = 0.0_rk
      outcome%unbalance = length(unbalance)/force
      outcome%residual = max(outcome%unbalance, kept/force)
      outcome%is_loose = .false.
      outcome%is_driven = kept > 0.0_rk
      outcome%worst_point = maxloc(unbalance, 1)
    end associate
  end subroutine measure_residual

  !> Least force that residuals are divided by.
  pure real(rk) function smallest_force(field)
    type(joint_field), intent(in) :: field
    smallest_force = max(field%start_force, smallest_share*field%bulk_force, &
                         sqrt(tiny(1.0_rk))) ! [N]; quotients by it stay finite
  end function smallest_force

  !> Remaining correction of the jumps over their increment; decides convergence. Where contact
  !> prevents jumps, the increment of traction/k_ref is the measure. Jumps that count from a grouted
  !> opening have the round-off of that opening. A residual of round-off always counts as converged:
  !> where nothing resists, round-off gives a large correction.
  subroutine measure_correction(correction, now)
    real(rk), intent(in) :: correction(:, :) !< (3, points) [m]
    type(joint_increment), intent(inout) :: now
    real(rk) :: increment, spring(3, size(correction, 2))
    associate (field => now%field, outcome => now%outcome)
      spring = field%traction/now%k_ref
      increment = max(distance(field%jump, field%start_jump), smallest_increment*norm(field%jump), &
                      distance(spring, field%start_spring), smallest_increment*norm(spring), &
                      smallest_increment*field%origin_size, tiny(1.0_rk))
      outcome%correction = norm(correction)/increment
      outcome%has_converged = outcome%correction <= now%controls%increment_tolerance .or. &
                              outcome%residual <= smallest_residual
    end associate
  end subroutine measure_correction
end module joint_iteration
