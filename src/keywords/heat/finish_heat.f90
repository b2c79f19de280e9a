!> Completes the temperatures of a deck, and warns of those without effect.
module finish_heat
  use deck_scan, only: is_keyword, steps_of_cards
  use diagnostics, only: diagnostic_list
  use kinds, only: rk
  use model_draft, only: draft
  implicit none
  private
  public :: complete_heat, warn_of_heat

contains

  !> Temperatures start from zero where the deck gives no initial ones.
  subroutine complete_heat(model)
    type(draft), intent(inout) :: model
    integer :: m
    associate (heat => model%problem%heat, mesh => model%problem%mesh)
      if (first_card(model, 'TEMPERATURE') > 0 .and. .not. allocated(heat%initial)) then
        allocate (heat%initial(mesh%num_nodes), source=0.0_rk)
      end if
      do m = 1, size(model%problem%materials)
        if (.not. allocated(model%problem%materials(m)%expansion)) cycle
        heat%has_expansion = heat%has_expansion .or. any(mesh%material_of_element == m)
      end do
    end associate
  end subroutine complete_heat

  !> Position of the first card of a keyword, 0 for none.
  pure integer function first_card(model, name) result(found)
    type(draft), intent(in) :: model
    character(*), intent(in) :: name
    do found = 1, size(model%cards)
      if (is_keyword(model%cards(found), name)) return
    end do
    found = 0
  end function first_card

  !> Temperatures of materials that do not expand, expansion without temperatures, and temperatures
  !> of steps that find modes. A UMAT gets the temperatures in any case.
  subroutine warn_of_heat(model, faults)
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer :: step(size(model%cards))
    integer :: found, i
    found = first_card(model, 'TEMPERATURE')
    if (found > 0 .and. .not. (model%problem%heat%has_expansion .or. &
                               first_card(model, 'USER MATERIAL') > 0)) then
      call model%cards(found)%warn(faults, 'the temperatures have no effect: no material in '// &
                                   'use expands', '*EXPANSION in a material')
    end if
    found = first_card(model, 'EXPANSION')
    if (found > 0 .and. .not. first_card(model, 'TEMPERATURE') > 0) then
      call model%cards(found)%warn(faults, 'the expansion has no effect: no temperature changes', &
                                   '*TEMPERATURE in a step')
    end if
    step = steps_of_cards(model%cards)
    do i = 1, size(step)
      if (step(i) == 0 .or. .not. is_keyword(model%cards(i), 'TEMPERATURE')) cycle
      if (.not. model%problem%steps(step(i))%procedure%finds_modes) cycle
      call model%cards(i)%warn(faults, 'has no effect in a step *FREQUENCY')
    end do
  end subroutine warn_of_heat
end module finish_heat
