!> Checks of *DYNAMIC, REDUCED: what a reduced model cannot hold (theory.md, 7.4).
module verify_reduced
  use diagnostics, only: diagnostic_list
  use model_draft, only: draft
  implicit none
  private
  public :: verify_reduced_steps

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
        if (model%problem%stages%is_there_any()) then
          call refuse(model, s, 'the model is built in stages (*MODEL CHANGE, *GROUT)', faults)
        end if
        if (model%problem%heat%has_expansion .and. model%problem%heat%is_there_any()) then
          call refuse(model, s, 'the model has temperatures (*TEMPERATURE) and materials that '// &
                      'expand', faults)
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
    do i = 1, size(model%problem%materials)
      associate (material => model%problem%materials(i))
        if (.not. allocated(material%law)) cycle
        if (.not. material%law%is_nonlinear) cycle
        call refuse(model, s, 'material '//material%name//' is not linear elastic, and a '// &
                    'reduced model holds linear elastic solids with joints', faults)
        return
      end associate
    end do
  end subroutine refuse_solids

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
