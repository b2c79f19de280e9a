!> Which criterion an increment without equilibrium does not meet, and what a user can do.
module failure_remedy
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use kinds, only: rk
  use equilibrium, only: balance_outcome, unmet_criterion, of_increment, of_jumps, of_solves
  use step_plan, only: step, step_controls
  use joint_points, only: dam_joint
  use step_control, only: increment_control
  use write_text, only: as_text
  implicit none
  private
  public :: name_criterion, name_remedy, name_slave_side

  real(rk), parameter :: much_finer = 1.5_rk !< slave nodes over master nodes of a joint

contains

  !> The criterion that the last iterate does not meet, its value and its tolerance.
  pure function name_criterion(plan, outcome) result(text)
    type(step), intent(in) :: plan
    type(balance_outcome), intent(in) :: outcome
    character(:), allocatable :: text
    type(unmet_criterion) :: unmet
    unmet = unmet_of(plan, outcome)
    select case (unmet%name)
    case (of_increment)
      text = 'the last correction is '//short(unmet%value)//' of the increment ('// &
             'tolerance '//short(unmet%tolerance)//', *CONTROLS, INCREMENT; residual '// &
             short(outcome%residual)//' is within its tolerance)'
    case (of_jumps)
      text = 'the relative displacements of the solution and those of the joint laws differ '// &
             'by '//short(unmet%value)//' of the forces (tolerance '//short(unmet%tolerance)// &
             ', half of *CONTROLS, RESIDUAL)'
    case (of_solves)
      text = 'the solver leaves '//short(unmet%value)//' of the forces (tolerance '// &
             short(unmet%tolerance)//', 0.3 times *CONTROLS, RESIDUAL)'
    case default
      text = 'residual '//short(unmet%value)
      if (ieee_is_nan(unmet%value)) text = 'the iteration diverges: residual not a number'
      text = text//' (tolerance '//short(unmet%tolerance)// &
             ', *CONTROLS, RESIDUAL)'
    end select
  end function name_criterion

  !> The criterion that the last iterate does not meet.
  pure type(unmet_criterion) function unmet_of(plan, outcome) result(unmet)
    type(step), intent(in) :: plan
    type(balance_outcome), intent(in) :: outcome
    real(rk) :: tolerance
    unmet = outcome%unmet
    if (unmet%name /= '') return
    tolerance = outcome%tolerance
    if (.not. tolerance > 0.0_rk) tolerance = plan%controls%residual_tolerance
    unmet = unmet_criterion('', outcome%residual, tolerance)
    if (.not. outcome%residual <= tolerance) return ! NaN, too
    if (.not. outcome%correction > plan%controls%increment_tolerance) return
    unmet = unmet_criterion(of_increment, outcome%correction, plan%controls%increment_tolerance)
  end function unmet_of

  !> DIRECT, a tolerance, PRECISION, ITERATIONS or the smallest increment, where one of these ended
  !> the step.
  pure function name_remedy(plan, control, outcome) result(text)
    type(step), intent(in) :: plan
    type(increment_control), intent(in) :: control !< after the last reduction
    type(balance_outcome), intent(in) :: outcome !< of the last attempt
    character(:), allocatable :: text
    character(:), allocatable :: more
    more = numerical_remedy(plan, outcome)
    text = ''
    if (control%is_direct) then
      text = '; the increment is fixed (DIRECT): leave DIRECT out'
      if (more /= '') text = text//', or '//more
      return
    end if
    if (more /= '') text = '; '//more
    if (control%size >= control%smallest) return
    text = text//'; the smallest increment of the step is '//as_text(control%smallest)//' s: '// &
           'name a smaller one on the data line of *'//trim(plan%procedure%name)
  end function name_remedy

  !> What of *CONTROLS helps with the criterion that is not met; '' for nothing. A residual that
  !> meets the default is near round-off: more iterations do not reduce it.
  pure function numerical_remedy(plan, outcome) result(text)
    type(step), intent(in) :: plan
    type(balance_outcome), intent(in) :: outcome
    character(:), allocatable :: text
    character(:), allocatable :: precision
    type(unmet_criterion) :: unmet
    type(step_controls) :: usual
    precision = ''
    if (plan%controls%precision /= 'DOUBLE') precision = 'name PRECISION=DOUBLE, or '
    text = ''
    unmet = unmet_of(plan, outcome)
    if (unmet%name == of_jumps .or. unmet%name == of_solves .or. &
        (unmet%name == '' .and. unmet%value <= usual%residual_tolerance)) then
      text = precision//'name a larger RESIDUAL (*CONTROLS)'
      return
    else if (unmet%name == of_increment) then
      text = precision//'name a larger INCREMENT (*CONTROLS)'
      if (outcome%worst_point > 0) return ! joints have had many more iterations
    end if
    if (outcome%iterations < plan%controls%max_iterations) return
    if (text /= '') text = text//', or '
    text = text//'allow more than '//limit_of(plan)
  end function numerical_remedy

  !> A measure with three digits.
  pure function short(value) result(text)
    real(rk), intent(in) :: value
    character(:), allocatable :: text
    character(12) :: digits
    write (digits, '(es8.2)') value
    text = trim(adjustl(digits))
  end function short

  !> 'ITERATIONS=15 (*CONTROLS)'.
  pure function limit_of(plan) result(text)
    type(step), intent(in) :: plan
    character(:), allocatable :: text
    text = 'ITERATIONS='//as_text(plan%controls%max_iterations)//' (*CONTROLS)'
  end function limit_of

  !> The advice to exchange the sides of a joint whose slave has the finer mesh: the coarser slave
  !> has fewer points, with smoother tractions (different_meshes.md, 13.2).
  pure function name_slave_side(joint) result(text)
    type(dam_joint), intent(in) :: joint
    character(:), allocatable :: text
    logical :: is_master(maxval(joint%node)), is_slave(maxval(joint%node))
    integer :: p
    text = ''
    if (joint%is_matching) return
    is_master = .false.
    is_slave = .false.
    do p = 1, joint%num_points
      is_slave(joint%node(joint%first(p):joint%first_master(p) - 1)) = .true.
      is_master(joint%node(joint%first_master(p):joint%first(p + 1) - 1)) = .true.
    end do
    if (count(is_slave) <= much_finer*count(is_master)) return
    text = ', whose slave has the finer mesh: make the coarser surface the slave'
  end function name_slave_side
end module failure_remedy
