!> Completes the stages of a deck, and checks them.
module finish_stages
  use deck_scan, only: is_keyword, steps_of_cards
  use diagnostics, only: diagnostic_list
  use element_catalogue, only: is_solid
  use model_draft, only: draft
  use stage_faces, only: complete_parts
  use stage_ties, only: check_tied_faces
  use step_plan, only: step_before
  use write_text, only: as_text
  implicit none
  private
  public :: complete_stages

contains

  !> Marks the steps that change a stage. Nothing happens in a deck without stages.
  subroutine complete_stages(model, faults)
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer :: s
    call check_places(model, faults)
    call note_grouted(model)
    if (.not. model%problem%stages%is_there_any()) return
    associate (steps => model%problem%steps)
      do s = 1, size(steps)
        ! Grout that has hardened before a *FREQUENCY step: the step after it books the energy.
        steps(s)%changes_stage = model%problem%stages%changes_elements(s) &
                                 .or. hardens(model, s, .false.) &
                                 .or. hardens(model, s - 1, .true.) &
                                 .or. hardens(model, step_before(steps, s), .true.)
      end do
    end associate
    if (.not. allocated(model%problem%stages%is_absent)) return
    model%problem%stages%material = model%problem%mesh%material_of_element
    if (.not. faults%has_errors()) call check_tied_faces(model, faults)
    if (.not. faults%has_errors()) call complete_parts(model, faults)
    if (.not. faults%has_errors()) call warn_of_nothing_left(model, faults)
  end subroutine complete_stages

  !> The first step of a deck without errors whose solids are all absent.
  subroutine warn_of_nothing_left(model, faults)
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer :: step(size(model%cards)), i, s
    logical :: is_of_solid(model%problem%mesh%num_elements)
    is_of_solid = is_solid(model%problem%mesh%element_type)
    step = steps_of_cards(model%cards)
    do s = 1, size(model%problem%steps)
      if (any(is_of_solid .and. .not. model%problem%stages%is_absent(:, s))) cycle
      do i = 1, size(step)
        if (step(i) /= s .or. .not. is_keyword(model%cards(i), 'MODEL CHANGE')) cycle
        call model%cards(i)%warn(faults, 'no solid is left in step '//as_text(s))
        return
      end do
    end do
  end subroutine warn_of_nothing_left

  !> Stages change in static steps; models with *INTERFACE or with springs of ties have none.
  subroutine check_places(model, faults)
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer :: i, s
    s = 0
    do i = 1, size(model%cards)
      if (is_keyword(model%cards(i), 'STEP')) s = s + 1
      if (.not. (is_keyword(model%cards(i), 'MODEL CHANGE') .or. &
                 is_keyword(model%cards(i), 'GROUT'))) cycle
      if (s < 1 .or. s > model%num_steps) cycle
      if (.not. model%problem%steps(s)%procedure%is_static()) then
        call model%cards(i)%fault(faults, 'a stage begins in a step that is not static', &
                                  '*STATIC in this step')
      else if (is_keyword(model%cards(i), 'MODEL CHANGE') .and. size(model%interfaces) > 0) then
        call model%cards(i)%fault(faults, 'the model has an *INTERFACE, whose quadrilaterals '// &
                                  'would stay without a solid', '*TIE or *JOINT between surfaces')
      else if (is_keyword(model%cards(i), 'MODEL CHANGE') .and. has_springs(model)) then
        call model%cards(i)%fault(faults, 'the model has a *TIE with STIFFNESS, whose springs '// &
                                  'would be strained when they appear between settled faces', &
                                  '*TIE without STIFFNESS, or *JOINT')
      end if
    end do
  end subroutine check_places

  !> Whether a tie is made of springs.
  pure logical function has_springs(model)
    type(draft), intent(in) :: model
    has_springs = .false.
    if (allocated(model%ties)) has_springs = any(model%ties%stiffness > 0.0)
  end function has_springs

  !> The joints that some step grouts.
  subroutine note_grouted(model)
    type(draft), intent(inout) :: model
    integer :: s
    do s = 1, size(model%problem%steps)
      if (.not. allocated(model%problem%steps(s)%grouts)) cycle
      associate (plan => model%problem%stages)
        if (.not. allocated(plan%is_grouted)) then
          allocate (plan%is_grouted(size(model%joints)), source=.false.)
        end if
        plan%is_grouted(model%problem%steps(s)%grouts%joint) = .true.
      end associate
    end do
  end subroutine note_grouted

  !> Whether a step has grout with, or without, pressure.
  pure logical function hardens(model, s, has_pressure)
    type(draft), intent(in) :: model
    integer, intent(in) :: s !< step; 0 has none
    logical, intent(in) :: has_pressure
    hardens = .false.
    if (s < 1) return
    if (.not. allocated(model%problem%steps(s)%grouts)) return
    hardens = any((model%problem%steps(s)%grouts%pressure > 0.0) .eqv. has_pressure)
  end function hardens
end module finish_stages
