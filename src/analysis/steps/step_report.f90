!> Reports of a step: end of an increment, and failure.
module step_report
  use kinds, only: rk
  use errors, only: error_type, raise
  use problem_definition, only: problem
  use step_plan, only: step
  use analysis_state, only: state
  use increment_listener, only: listener
  use instance_list, only: own_name_of_node
  use equilibrium, only: balance_outcome
  use step_loads, only: step_time
  use step_system, only: dam_system
  use admissible_slip, only: check_slip
  use user_increments, only: end_user_increment
  use failure_remedy, only: name_criterion, name_remedy, name_slave_side
  use write_text, only: as_text
  implicit none
  private
  public :: check_count, close_increment, count_increment, report_failure, line_of_cut

contains

  !> Counts a converged increment.
  subroutine count_increment(plan, when, outcome, now)
    type(step), intent(in) :: plan
    type(step_time), intent(in) :: when !< the end of the increment
    type(balance_outcome), intent(in) :: outcome
    type(state), intent(inout) :: now
    now%increment = now%increment + 1
    now%iterations = outcome%iterations
    now%augmentations = outcome%augmentations
    now%cutbacks = now%control%cutbacks
    now%residual = outcome%residual
    now%has_held_switches = outcome%has_held_switches
    now%increment_size = when%increment
    now%step_time = when%now
    now%total_time = when%start + when%now
    now%is_last_of_step = now%step_time >= plan%duration
  end subroutine count_increment

  !> Reports a converged increment to the listener.
  subroutine close_increment(model, now, results, error)
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    class(listener), intent(inout) :: results
    type(error_type), allocatable, intent(out) :: error
    call results%report_increment(model, now, error)
    if (allocated(error)) return
    call end_user_increment(model, now, results, error)
    if (allocated(error)) return
    call check_slip(model%joints, now%joints, now%total_time, error)
  end subroutine close_increment

  !> Stops a step that may not have another increment, also where a run is continued there.
  subroutine check_count(plan, now, error)
    type(step), intent(in) :: plan
    type(state), intent(in) :: now !< before the end of the step
    type(error_type), allocatable, intent(out) :: error
    if (now%increment < plan%max_increments) return
    call raise(error, "step '"//plan%name//"' has not ended after "// &
               count_text(plan%max_increments)//' increments, at '//as_text(now%step_time)// &
               ' of '//as_text(plan%duration)//' s: raise INC of *STEP')
  end subroutine check_count

  !> Error that names what did not converge, and where.
  subroutine report_failure(model, system, outcome, now, error)
    type(problem), intent(in) :: model
    type(dam_system), intent(in) :: system
    type(balance_outcome), intent(in) :: outcome
    type(state), intent(in) :: now
    type(error_type), allocatable, intent(out) :: error
    character(480) :: text
    character(:), allocatable :: remedy
    if (allocated(outcome%failure)) then
      call raise(error, failure_text(outcome, now))
      return
    end if
    if (outcome%gives_up) then
      write (text, '(a,g0.3,a,i0,a,es8.1,a,es12.5)') 'the penetration of a contact is ', &
        outcome%penetration, ' times the limit of *JOINT LAW, PENETRATION after ', &
        outcome%augmentations, ' augmentations (a larger KN needs fewer) with an increment of ', &
        now%control%last_size, ', last equilibrium at time ', now%total_time
    else
      write (text, '(2a,es8.1,a,es12.5)') &
        'no equilibrium: '//what_is_unmet(model%steps(now%step), outcome), &
        ' with an increment of ', now%control%last_size, ', last equilibrium at time ', &
        now%total_time
    end if
    remedy = advice_beyond_peak(model, outcome, now%step)// &
             advice_on_blocks(model%steps(now%step), outcome)// &
             name_remedy(model%steps(now%step), now%control, outcome)
    call raise(error, trim(text)//worst_place(model, system, outcome)//remedy)
  end subroutine report_failure

  !> The line of the log on an increment that has been cut.
  function line_of_cut(model, system, outcome, now) result(line)
    type(problem), intent(in) :: model
    type(dam_system), intent(in) :: system
    type(balance_outcome), intent(in) :: outcome
    type(state), intent(in) :: now !< before the increment
    character(:), allocatable :: line
    associate (plan => model%steps(now%step), control => now%control)
      line = 'cut-back: step '//count_text(now%step)//'  increment '// &
             count_text(now%increment + 1)//' of '//as_text(control%last_size)//' s from time '// &
             as_text(now%total_time)//' on'
      if (allocated(outcome%failure)) then
        line = line//': '//outcome%failure
      else if (outcome%gives_up) then
        line = line//': the penetration of a contact stays above *JOINT LAW, PENETRATION '// &
               '(a larger KN needs fewer augmentations)'
      else
        line = line//': '//what_is_unmet(plan, outcome)//worst_place(model, system, outcome)
      end if
      line = line//'; the next has '//as_text(control%next_size(now%step_time))//' s'
    end associate
  end function line_of_cut

  !> The criterion that is not met, after how many iterations.
  pure function what_is_unmet(plan, outcome) result(text)
    type(step), intent(in) :: plan
    type(balance_outcome), intent(in) :: outcome
    character(:), allocatable :: text
    text = name_criterion(plan, outcome)//' after '//count_text(outcome%iterations)// &
           trim(merge(' iteration ', ' iterations', outcome%iterations == 1))
  end function what_is_unmet

  !> Largest residual of joints, or of inelastic solids: '; largest at node 12 at (0., 1., 3.)'.
  pure function worst_place(model, system, outcome) result(text)
    type(problem), intent(in) :: model
    type(dam_system), intent(in) :: system
    type(balance_outcome), intent(in) :: outcome
    character(:), allocatable :: text
    integer :: node, p, j
    text = ''
    p = outcome%worst_point
    if (p > 0) then
      j = count(system%operator%first_point <= p)
      p = p - system%operator%first_point(j) + 1
      text = '; largest in joint '//model%joints(j)%name//' at '// &
             place_text(model%joints(j)%x(:, p))//name_slave_side(model%joints(j))
    else if (outcome%worst_node > 0) then
      node = outcome%worst_node
      text = '; largest at node '//count_text(model%mesh%node_id(node))// &
             own_name_of_node(model%outside, model%instances, model%mesh%node_id(node))//' at '// &
             place_text(model%mesh%x(:, node))
    end if
  end function worst_place

  !> What helps inelastic solids in a static step that have lost their equilibrium.
  pure function advice_beyond_peak(model, outcome, step) result(text)
    type(problem), intent(in) :: model
    type(balance_outcome), intent(in) :: outcome
    integer, intent(in) :: step
    character(:), allocatable :: text
    text = ''
    if (outcome%worst_point > 0 .or. outcome%worst_node == 0) return
    if (.not. model%steps(step)%procedure%is_static()) return
    text = ' (beyond its peak load a cracking structure needs prescribed displacements, '// &
           'not forces; with these, smaller increments or *CONTROLS, TANGENT='
    if (model%steps(step)%controls%tangent == 'AUTO') then
      text = text//'CONSISTENT)'
    else
      text = text//'AUTO)'
    end if
  end function advice_beyond_peak

  !> What ends the equilibrium of joints in a static step, however small its increments are.
  pure function advice_on_blocks(plan, outcome) result(text)
    type(step), intent(in) :: plan
    type(balance_outcome), intent(in) :: outcome
    character(:), allocatable :: text
    text = ''
    if (outcome%worst_point == 0 .or. outcome%gives_up) return
    if (.not. plan%procedure%is_static()) return
    text = ' (a block may have become free, or the load may exceed what joints and supports '// &
           'can bear: no setting of *CONTROLS changes that)'
  end function advice_on_blocks

  !> Failure of a material, or of uplift in a joint, in the smallest increment.
  pure function failure_text(outcome, now) result(text)
    type(balance_outcome), intent(in) :: outcome
    type(state), intent(in) :: now
    character(:), allocatable :: text
    character(120) :: place
    write (place, '(a,i0,a,es8.1,a,es12.5)') ' (increment ', now%increment + 1, ' of ', &
      now%control%last_size, ' s, last equilibrium at time ', now%total_time
    text = outcome%failure//trim(place)//')'
    if (now%control%is_direct) text = text//'; the increment is fixed (DIRECT): leave DIRECT '// &
                                      'out, so that the increment may be cut'
  end function failure_text

  !> A whole number as text.
  pure function count_text(number) result(text)
    integer, intent(in) :: number
    character(:), allocatable :: text
    character(12) :: digits
    write (digits, '(i0)') number
    text = trim(digits)
  end function count_text

  !> Coordinates as text.
  pure function place_text(x) result(text)
    real(rk), intent(in) :: x(3) !< [m]
    character(:), allocatable :: text
    text = '('//as_text(x(1))//', '//as_text(x(2))//', '//as_text(x(3))//')'
  end function place_text
end module step_report
