!> Loads and supports of a step: patterns over the unknowns and their factors in time.
!>
!> Loads with equal factors at all times are summed into one pattern.
module step_loads
  use kinds, only: rk
  use amplitudes, only: amplitude, amplitude_at
  use step_control, only: roundoff
  use step_plan, only: step, step_load
  use problem_definition, only: problem
  use dof_numbering, only: numbering
  use matrix_pattern, only: pattern
  use assemble_forces, only: assemble_force, inertia_force
  use guest_list, only: guests_of_model
  use guest_type, only: guest, guest_reference
  use ranks, only: is_true_everywhere
  use run_ledger, only: ledger
  implicit none
  private
  public :: load_group, support, step_time, gather_loads, gather_supports
  public :: external_force, prescribed_values, factor_at

  !> Time at which a factor is evaluated.
  type :: step_time
    logical :: is_dynamic = .false.
    real(rk) :: now = 0.0_rk !< since the start of the step [s]
    real(rk) :: start = 0.0_rk !< total time at the start of the step [s]
    real(rk) :: duration = 1.0_rk !< of the step [s]
    real(rk) :: increment = 0.0_rk !< the one that ends now [s]
  contains
    procedure :: set_end, clock
  end type step_time

  !> Loads with equal factors. Uplift with PROFILE=OPEN has a group of its own.
  type :: load_group
    type(step_load) :: rule
    integer :: uplift = 0 !< position of that uplift load, 0 for none
    real(rk), allocatable :: pressure(:) !< (points of its joint) now, at factor 1 [Pa]
    logical, allocatable :: lets_water_in(:) !< (points of its joint) open for this pressure
    real(rk), allocatable :: force(:) !< (num_total) at factor 1 [N]
  end type load_group

  !> A prescribed unknown.
  type :: support
    integer :: unknown = 0
    real(rk) :: start_value = 0.0_rk !< at the start of the step [m]
    real(rk) :: value = 0.0_rk !< prescribed, times the amplitude [m]
    integer :: amplitude = 0 !< 0 for none
  end type support

contains

  !> Sets the end of an increment; a remainder of round-off size is added to it.
  pure subroutine set_end(self, from, increment)
    class(step_time), intent(inout) :: self
    real(rk), intent(in) :: from !< since the start of the step [s]
    real(rk), intent(in) :: increment !< [s]
    self%increment = increment
    self%now = from + increment
    if (self%duration - self%now < roundoff*increment) self%now = self%duration
  end subroutine set_end

  !> Sums the patterns of the loads of a step and of the guests of every step, base motion included,
  !> into groups of equal factors.
  subroutine gather_loads(model, plan, numbers, matrix, mass, groups, costs)
    type(problem), intent(in), target :: model
    type(step), intent(in) :: plan
    type(numbering), intent(in) :: numbers
    type(pattern), intent(in) :: matrix
    real(rk), intent(in) :: mass(:) !< values; size 0 without inertia
    type(load_group), allocatable, intent(out) :: groups(:)
    type(ledger), intent(in) :: costs
    type(guest_reference), allocatable :: guests(:)
    real(rk) :: force(numbers%num_total)
    logical :: has_inertia
    integer :: i, group
    allocate (groups(0))
    has_inertia = .not. is_true_everywhere(size(mass) == 0) ! a rank may have no elements
    do i = 1, size(plan%loads)
      associate (item => model%loads(plan%loads(i)%load)%item)
        call costs%start('assemble', item%name, item%kind)
        if (item%follows_opening) then
          call open_group(plan%loads(i), numbers%num_total, groups, group)
          groups(group)%uplift = plan%loads(i)%load
        else
          call assemble_force(model, item, numbers, force)
          if (has_inertia) call add_base_motion(item, numbers, matrix, mass, force)
          call add_to_group(plan%loads(i), force, groups)
        end if
        call costs%stop()
      end associate
    end do
    call guests_of_model(model, guests)
    do i = 1, size(guests)
      if (.not. guests(i)%item%has_force()) cycle
      call assemble_force(model, guests(i)%item, numbers, force)
      call add_to_group(step_load(start_factor=1.0_rk), force, groups)
    end do
  end subroutine gather_loads

  !> Adds a pattern to the group with its factor.
  subroutine add_to_group(rule, force, groups)
    type(step_load), intent(in) :: rule
    real(rk), intent(in) :: force(:) !< (num_total) [N]
    type(load_group), allocatable, intent(inout) :: groups(:)
    integer :: group
    call find_group(rule, size(force), groups, group)
    groups(group)%force = groups(group)%force + force
  end subroutine add_to_group

  !> -M r times the acceleration of the base by one load.
  subroutine add_base_motion(item, numbers, matrix, mass, force)
    class(guest), intent(in) :: item
    type(numbering), intent(in) :: numbers
    type(pattern), intent(in) :: matrix
    real(rk), intent(in) :: mass(:)
    real(rk), intent(inout) :: force(:)
    real(rk) :: acceleration(3), inertia(size(force))
    integer :: direction
    acceleration = 0.0_rk
    call item%add_base_acceleration(acceleration)
    do direction = 1, 3
      if (.not. abs(acceleration(direction)) > 0.0_rk) cycle
      call inertia_force(numbers, matrix, mass, direction, inertia)
      force = force + acceleration(direction)*inertia
    end do
  end subroutine add_base_motion

  !> Finds the group with the factor of a load, or adds one.
  subroutine find_group(rule, num_unknowns, groups, found)
    type(step_load), intent(in) :: rule
    integer, intent(in) :: num_unknowns
    type(load_group), allocatable, intent(inout) :: groups(:)
    integer, intent(out) :: found
    do found = 1, size(groups)
      if (groups(found)%uplift == 0 .and. follows(groups(found)%rule, rule)) return
    end do
    call open_group(rule, num_unknowns, groups, found)
  end subroutine find_group

  !> Adds a group without forces.
  subroutine open_group(rule, num_unknowns, groups, added)
    type(step_load), intent(in) :: rule
    integer, intent(in) :: num_unknowns
    type(load_group), allocatable, intent(inout) :: groups(:)
    integer, intent(out) :: added
    type(load_group) :: fresh
    fresh%rule = rule
    allocate (fresh%force(num_unknowns))
    fresh%force = 0.0_rk
    groups = [groups, fresh]
    added = size(groups)
  end subroutine open_group

  !> Whether two loads always have the same factor.
  pure logical function follows(a, b)
    type(step_load), intent(in) :: a, b
    follows = a%amplitude == b%amplitude .and. abs(a%start_factor - b%start_factor) <= 0.0_rk &
              .and. abs(a%end_factor - b%end_factor) <= 0.0_rk
  end function follows

  !> Prescribed unknowns of a step, with their displacements at its start.
  subroutine gather_supports(plan, numbers, u, supports)
    type(step), intent(in) :: plan
    type(numbering), intent(in) :: numbers
    real(rk), intent(in) :: u(:, :) !< (3, nodes) at the start of the step [m]
    type(support), allocatable, intent(out) :: supports(:)
    integer :: k, unknown, num_found
    allocate (supports(size(plan%fixities)))
    num_found = 0
    do k = 1, size(plan%fixities)
      associate (fixity => plan%fixities(k))
        unknown = numbers%unknown_of(fixity%node, fixity%dof)
        if (unknown == 0) cycle ! a node without elements
        num_found = num_found + 1
        supports(num_found) = support(unknown, u(fixity%dof, fixity%node), fixity%value, &
                                      fixity%amplitude)
      end associate
    end do
    supports = supports(:num_found)
  end subroutine gather_supports

  !> Forces of all loads at one time.
  subroutine external_force(groups, histories, when, force)
    type(load_group), intent(in) :: groups(:)
    type(amplitude), intent(in) :: histories(:)
    type(step_time), intent(in) :: when
    real(rk), intent(out) :: force(:) !< (num_total) [N]
    real(rk) :: factor
    integer :: i
    force = 0.0_rk
    do i = 1, size(groups)
      associate (rule => groups(i)%rule)
        factor = factor_at(rule%start_factor, rule%end_factor, rule%amplitude, histories, when)
      end associate
      if (abs(factor) > 0.0_rk) force = force + factor*groups(i)%force
    end do
  end subroutine external_force

  !> Sets the displacements of the prescribed unknowns at one time.
  subroutine prescribed_values(supports, histories, when, q)
    type(support), intent(in) :: supports(:)
    type(amplitude), intent(in) :: histories(:)
    type(step_time), intent(in) :: when
    real(rk), intent(inout) :: q(:) !< (num_total) [m]
    integer :: i
    do i = 1, size(supports)
      associate (item => supports(i))
        q(item%unknown) = factor_at(item%start_value, item%value, item%amplitude, histories, when)
      end associate
    end do
  end subroutine prescribed_values

  !> Factor at a time: by an amplitude, else a ramp in static and a jump in dynamic steps.
  pure real(rk) function factor_at(first, last, history, histories, when) result(factor)
    real(rk), intent(in) :: first, last !< at the start and at the end of the step
    integer, intent(in) :: history !< amplitude, 0 for none
    type(amplitude), intent(in) :: histories(:)
    type(step_time), intent(in) :: when
    if (history > 0) then
      associate (own => histories(history))
        factor = last*amplitude_at(own, when%clock(own%uses_total_time))
      end associate
    else if (when%is_dynamic) then
      factor = last
    else
      factor = first + (last - first)*when%now/when%duration
    end if
  end function factor_at

  !> The time on the clock of the analysis, or on that of the step [s].
  pure real(rk) function clock(self, uses_total_time)
    class(step_time), intent(in) :: self
    logical, intent(in) :: uses_total_time
    clock = self%now
    if (uses_total_time) clock = self%start + self%now
  end function clock
end module step_loads
