!> Uplift in joints during a step: wet points, and the pressure there.
!>
!> With PROFILE=OPEN the forces are constant in an increment. A static increment is solved again
!> until the wet points are the open points. A dynamic increment takes the points that were open at
!> the end of the previous increment.
module joint_water
  use kinds, only: rk
  use joint_law, only: absent_points, joint_state, state_open
  use joint_operator, only: jump_operator
  use problem_definition, only: problem
  use step_loads, only: load_group, step_time, factor_at
  use step_plan, only: step, step_load
  use run_ledger, only: ledger
  implicit none
  private
  public :: update_uplift, resume_uplift, record_uplift, press_grout

contains

  !> Updates the uplift for the open points of joints.
  subroutine update_uplift(model, operator, states, groups, costs, has_changed)
    type(problem), intent(in) :: model
    type(jump_operator), intent(in) :: operator
    type(joint_state), intent(in) :: states(:)
    type(load_group), intent(inout) :: groups(:)
    type(ledger), intent(in) :: costs
    logical, intent(out) :: has_changed !< a force has
    logical :: changes
    integer :: g
    has_changed = .false.
    do g = 1, size(groups)
      if (groups(g)%uplift == 0) cycle
      associate (water => model%loads(groups(g)%uplift)%item)
        call set_uplift(model, operator, states(water%wet_joint)%status == state_open, costs, &
                        groups(g), changes)
        has_changed = has_changed .or. changes
      end associate
    end do
  end subroutine update_uplift

  !> The uplift of the last increment, at the start of a step in which the motion goes on: the water
  !> of points that have opened or closed in it comes in the next increment, as within a step.
  subroutine resume_uplift(model, operator, states, groups, costs)
    type(problem), intent(in) :: model
    type(jump_operator), intent(in) :: operator
    type(joint_state), intent(in) :: states(:) !< with the open points of the last increment
    type(load_group), intent(inout) :: groups(:)
    type(ledger), intent(in) :: costs
    logical, allocatable :: lets_water_in(:)
    logical :: changes
    integer :: g
    do g = 1, size(groups)
      if (groups(g)%uplift == 0) cycle
      associate (now => states(model%loads(groups(g)%uplift)%item%wet_joint))
        lets_water_in = now%status == state_open
        if (allocated(now%lets_water_in)) lets_water_in = now%lets_water_in
        call set_uplift(model, operator, lets_water_in, costs, groups(g), changes)
      end associate
    end do
  end subroutine resume_uplift

  !> The pressure of one load, and its forces.
  subroutine set_uplift(model, operator, is_open, costs, group, has_changed)
    type(problem), intent(in) :: model
    type(jump_operator), intent(in) :: operator
    logical, intent(in) :: is_open(:) !< (points of the joint)
    type(ledger), intent(in) :: costs
    type(load_group), intent(inout) :: group
    logical, intent(out) :: has_changed
    real(rk), allocatable :: pressure(:)
    associate (water => model%loads(group%uplift)%item)
      call costs%start('update', water%name, water%kind)
      allocate (pressure(size(is_open)))
      call water%joint_pressure(is_open, pressure)
      if (.not. allocated(group%pressure)) group%pressure = 0.0_rk*pressure
      group%lets_water_in = is_open
      has_changed = any(abs(pressure - group%pressure) > 0.0_rk)
      if (has_changed) then
        group%force = 0.0_rk
        call push_faces(operator, water%wet_joint, pressure, group%force)
      end if
      call costs%stop()
    end associate
    call move_alloc(pressure, group%pressure)
  end subroutine set_uplift

  !> The grout of a step presses the faces apart, until the end of the step where it hardens.
  subroutine press_grout(plan, operator, num_unknowns, states, groups)
    type(step), intent(in) :: plan
    type(jump_operator), intent(in) :: operator
    integer, intent(in) :: num_unknowns !< free and prescribed
    type(joint_state), intent(in) :: states(:)
    type(load_group), allocatable, intent(inout) :: groups(:)
    type(load_group) :: fresh
    integer :: g
    if (.not. allocated(plan%grouts)) return
    fresh%rule = step_load(start_factor=0.0_rk, end_factor=1.0_rk)
    do g = 1, size(plan%grouts)
      associate (grout => plan%grouts(g))
        if (grout%pressure <= 0.0_rk) cycle
        fresh%force = spread(0.0_rk, 1, num_unknowns)
        call push_faces(operator, grout%joint, &
                        merge(grout%pressure, 0.0_rk, states(grout%joint)%is_pressed), &
                        fresh%force)
        groups = [groups, fresh]
      end associate
    end do
  end subroutine press_grout

  !> Forces B^T (area p) that open one joint.
  subroutine push_faces(operator, joint, pressure, force)
    type(jump_operator), intent(in) :: operator
    integer, intent(in) :: joint !< joint
    real(rk), intent(in) :: pressure(:) !< (points of the joint) [Pa]
    real(rk), intent(inout) :: force(:) !< (num_total) [N]
    real(rk) :: traction(3, operator%num_points)
    traction = 0.0_rk
    traction(1, operator%first_point(joint):operator%first_point(joint + 1) - 1) = pressure
    call operator%add_forces(traction, force)
  end subroutine push_faces

  !> Records the uplift pressure at the points of joints, for the results.
  subroutine record_uplift(model, loads, groups, when, states, costs)
    type(problem), intent(in) :: model
    type(step_load), intent(in) :: loads(:) !< of the step
    type(load_group), intent(in) :: groups(:)
    type(step_time), intent(in) :: when
    type(joint_state), intent(inout) :: states(:)
    type(ledger), intent(in) :: costs
    integer :: i, j
    do j = 1, size(states)
      if (allocated(states(j)%water)) deallocate (states(j)%water)
      if (allocated(states(j)%lets_water_in)) deallocate (states(j)%lets_water_in)
    end do
    do i = 1, size(loads)
      associate (water => model%loads(loads(i)%load)%item)
        if (water%wet_joint == 0) cycle
        call costs%start('recover', water%name, water%kind)
        call add_pressure(model, loads(i), groups, when, states(water%wet_joint))
        call costs%stop()
      end associate
    end do
  end subroutine record_uplift

  !> Adds the pressure that one load brings to its joint; a point that is absent has none.
  subroutine add_pressure(model, rule, groups, when, now)
    type(problem), intent(in) :: model
    type(step_load), intent(in) :: rule
    type(load_group), intent(in) :: groups(:)
    type(step_time), intent(in) :: when
    type(joint_state), intent(inout) :: now
    real(rk) :: pressure(size(now%status)), factor
    integer :: g
    factor = factor_at(rule%start_factor, rule%end_factor, rule%amplitude, model%amplitudes, when)
    g = findloc(groups%uplift, rule%load, dim=1)
    if (g > 0) then
      pressure = groups(g)%pressure
      now%lets_water_in = groups(g)%lets_water_in
    else
      call model%loads(rule%load)%item%joint_pressure(now%status == state_open, pressure)
    end if
    where (absent_points(now)) pressure = 0.0_rk
    if (.not. allocated(now%water)) now%water = 0.0_rk*pressure
    now%water = now%water + factor*pressure
  end subroutine add_pressure
end module joint_water
