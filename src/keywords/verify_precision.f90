!> Checks of *CONTROLS, PRECISION: where a factor in single precision, or a copy of one, cannot be
!> used (theory.md, 8).
module verify_precision
  use deck_scan, only: is_keyword, steps_of_cards
  use diagnostics, only: diagnostic_list
  use kinds, only: rk
  use model_draft, only: draft
  use step_plan, only: step
  use verify_reduced, only: first_nonlinear
  implicit none
  private
  public :: verify_precisions

contains

  !> Reports the *CONTROLS of the first step that cannot have the precision it asks for.
  subroutine verify_precisions(model, faults)
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    character(:), allocatable :: why
    integer :: s, place
    do s = 1, size(model%problem%steps)
      call find_conflict(model, model%problem%steps(s), why)
      if (.not. allocated(why)) cycle
      place = card_of_precision(model, s)
      call model%cards(place)%fault_parameter( &
        faults, 'PRECISION', trim(model%problem%steps(s)%controls%precision)//' and '//why// &
        " (step '"//model%problem%steps(s)%name//"')", 'DOUBLE in this step')
      return
    end do
  end subroutine verify_precisions

  !> What the precision of a step does not work with; not allocated: nothing.
  subroutine find_conflict(model, plan, why)
    type(draft), intent(in) :: model
    type(step), intent(in) :: plan
    character(:), allocatable, intent(out) :: why
    associate (controls => plan%controls, procedure => plan%procedure)
      if (controls%precision == 'DOUBLE' .or. procedure%finds_modes &
          .or. procedure%scheme == 'REDUCED') return
      if (controls%precision == 'MIXED' .and. procedure%has_inertia .and. &
          plan%damping%modal_ratio > 0.0_rk) then
        why = '*DAMPING, MODAL exclude each other: modal damping adds a matrix to the factor'
      else if (controls%joint_solver == 'FULL' .and. size(model%problem%joints) > 0) then
        why = 'JOINT SOLVER=FULL exclude each other: the solver factors in each iteration'
      else if (controls%tangent == 'CONSISTENT' .and. first_nonlinear(model) > 0) then
        why = 'TANGENT=CONSISTENT exclude each other: the matrix is not symmetric'
      end if
    end associate
  end subroutine find_conflict

  !> The last *CONTROLS up to a step that gives the precision.
  integer function card_of_precision(model, s) result(place)
    type(draft), intent(in) :: model
    integer, intent(in) :: s !< step
    integer :: step_of(size(model%cards)), i
    step_of = steps_of_cards(model%cards)
    place = model%procedure_card(s)
    do i = 1, size(model%cards)
      if (step_of(i) > s .or. .not. is_keyword(model%cards(i), 'CONTROLS')) cycle
      if (model%cards(i)%has('PRECISION')) place = i
    end do
  end function card_of_precision
end module verify_precision
