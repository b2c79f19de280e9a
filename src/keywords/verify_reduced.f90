!> Checks of *DYNAMIC, REDUCED: what a reduced model cannot hold (theory.md, 7.4).
module verify_reduced
  use amplitudes, only: amplitude
  use diagnostics, only: diagnostic_list
  use heat_plan, only: heat_rule
  use kinds, only: rk
  use model_draft, only: draft
  use step_plan, only: step
  implicit none
  private
  public :: verify_reduced_steps, first_nonlinear

  character(*), parameter :: remedy = '*DYNAMIC without REDUCED'

contains

  !> Reports each step with a reduced model that has to be run in full.
  subroutine verify_reduced_steps(model, faults)
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer :: s
    do s = 1, size(model%problem%steps)
      associate (plan => model%problem%steps(s))
        if (plan%procedure%scheme /= 'REDUCED') cycle
        call refuse_solids(model, s, faults)
        call refuse_water(model, s, faults)
        if (model%equations%num > 0) then
          call refuse(model, s, 'the model has equations (*EQUATION, *MPC)', faults)
        end if
        call refuse_stages(model, s, faults)
        if (model%problem%heat%has_expansion .and. changes_temperature(model, s)) then
          call refuse(model, s, 'the step changes temperatures of materials that expand '// &
                      '(*TEMPERATURE), and a reduced model holds those that it starts with', faults)
        end if
        if (any(plan%fixities%amplitude > 0)) then
          call refuse(model, s, 'a support of the step moves, and a reduced model holds its '// &
                      'supports', faults)
        end if
        if (plan%controls%joint_solver == 'FULL') then
          call refuse(model, s, 'JOINT SOLVER=FULL is the solver of the full model', faults)
        end if
      end associate
    end do
  end subroutine verify_reduced_steps

  !> Solids that crack or yield.
  subroutine refuse_solids(model, s, faults)
    type(draft), intent(in) :: model
    integer, intent(in) :: s !< step
    type(diagnostic_list), intent(inout) :: faults
    integer :: i
    i = first_nonlinear(model)
    if (i > 0) call refuse(model, s, 'material '//model%problem%materials(i)%name// &
                           ' is not linear elastic, and a reduced model holds linear elastic '// &
                           'solids with joints', faults)
  end subroutine refuse_solids

  !> The first material of an element that cracks or yields; 0 where none does. Materials that no
  !> element has are warned of elsewhere.
  pure integer function first_nonlinear(model) result(first)
    type(draft), intent(in) :: model
    do first = 1, size(model%problem%materials)
      if (.not. allocated(model%problem%materials(first)%law)) cycle
      if (.not. model%problem%materials(first)%law%is_nonlinear) cycle
      if (any(model%problem%mesh%material_of_element == first)) return
    end do
    first = 0
  end function first_nonlinear

  !> Elements that are not there yet.
  subroutine refuse_stages(model, s, faults)
    type(draft), intent(in) :: model
    integer, intent(in) :: s !< step
    type(diagnostic_list), intent(inout) :: faults
    if (.not. allocated(model%problem%stages%is_absent)) return
    if (.not. any(model%problem%stages%is_absent(:, s))) return
    call refuse(model, s, 'elements are absent in the step (*MODEL CHANGE), and a reduced '// &
                'model holds a complete dam', faults)
  end subroutine refuse_stages

  !> Whether a step may change temperatures. Histories over the total time that have acted before
  !> the step, and have ended there, do not.
  pure logical function changes_temperature(model, s) result(changes)
    type(draft), intent(in) :: model
    integer, intent(in) :: s !< step
    real(rk) :: start
    integer :: r
    associate (plan => model%problem%steps(s))
      changes = plan%restores_temperature
      if (.not. allocated(plan%heats)) return
      start = sum([(passed(model%problem%steps(r)), r=1, s - 1)])
      do r = 1, size(plan%heats)
        changes = changes .or. plan%heats(r)%step == s .or. &
                  end_of(plan%heats(r), model%problem%amplitudes) > start
      end do
    end associate
  end function changes_temperature

  !> The total time from which on the temperatures of a rule stay as they are; infinite where the
  !> rule belongs to its step.
  pure real(rk) function end_of(rule, histories)
    type(heat_rule), intent(in) :: rule
    type(amplitude), intent(in) :: histories(:)
    end_of = huge(end_of)
    if (.not. rule%goes_on(histories)) return
    if (rule%amplitude > 0) then
      end_of = maxval(histories(rule%amplitude)%time)
    else
      end_of = maxval(rule%time)
    end if
  end function end_of

  !> Time that a step takes [s].
  pure real(rk) function passed(plan)
    type(step), intent(in) :: plan
    passed = merge(0.0_rk, plan%duration, plan%procedure%finds_modes)
  end function passed

  !> Water that follows the open points of a joint.
  subroutine refuse_water(model, s, faults)
    type(draft), intent(in) :: model
    integer, intent(in) :: s !< step
    type(diagnostic_list), intent(inout) :: faults
    integer :: i
    do i = 1, size(model%problem%steps(s)%loads)
      associate (item => model%problem%loads(model%problem%steps(s)%loads(i)%load)%item)
        if (.not. item%follows_opening) cycle
        call refuse(model, s, 'the uplift '//item%name//' follows the open points (PROFILE=OPEN)', &
                    faults)
        return
      end associate
    end do
  end subroutine refuse_water

  !> A fault at the card of the procedure.
  subroutine refuse(model, s, found, faults)
    type(draft), intent(in) :: model
    integer, intent(in) :: s !< step
    character(*), intent(in) :: found
    type(diagnostic_list), intent(inout) :: faults
    call model%cards(model%procedure_card(s))%fault(faults, found, remedy)
  end subroutine refuse
end module verify_reduced
