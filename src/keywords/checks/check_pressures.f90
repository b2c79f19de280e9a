!> Warns of a pressure of an earlier step that goes on beside a new one of its kind on the same face
!> under another name: a load is replaced under its own name alone.
module check_pressures
  use check_loads, only: card_of_dload
  use deck_scan, only: steps_of_cards
  use diagnostics, only: diagnostic_list
  use kinds, only: rk
  use load_pressure, only: pressure_load
  use model_draft, only: draft
  use step_plan, only: step_load
  use write_text, only: as_text
  implicit none
  private
  public :: warn_of_pressures

contains

  !> The deck must have no errors.
  subroutine warn_of_pressures(model, faults)
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer :: i, k, element, s
    do s = 2, size(model%problem%steps)
      associate (before => model%problem%steps(s - 1)%loads, now => model%problem%steps(s)%loads)
        do i = 1, size(now)
          if (any(before%load == now(i)%load)) cycle
          do k = 1, size(now)
            if (.not. any(before%load == now(k)%load) .or. is_ending(now(k))) cycle
            element = shared_element(model, now(k)%load, now(i)%load)
            if (element == 0) cycle
            call warn_of_both(model, s, element, now(k)%load, now(i)%load, faults)
            exit
          end do
        end do
      end associate
    end do
  end subroutine warn_of_pressures

  !> Whether a load fades to zero in its step.
  pure logical function is_ending(work)
    type(step_load), intent(in) :: work
    is_ending = work%amplitude == 0 .and. abs(work%end_factor) <= 0.0_rk
  end function is_ending

  !> An element with a face that two pressures of *DLOAD of one kind push; 0 for none.
  pure integer function shared_element(model, first, second) result(element)
    type(draft), intent(in) :: model
    integer, intent(in) :: first, second !< loads
    integer, allocatable :: pushed(:) !< (elements) a bit for each face of the first load
    integer :: i
    element = 0
    if (model%problem%loads(first)%item%family /= 'DLOAD') return
    if (model%problem%loads(second)%item%family /= 'DLOAD') return
    if (model%problem%loads(first)%item%target == model%problem%loads(second)%item%target) return
    select type (old => model%problem%loads(first)%item)
    type is (pressure_load)
      select type (new => model%problem%loads(second)%item)
      type is (pressure_load)
        if (old%is_hydrostatic .neqv. new%is_hydrostatic) return
        allocate (pushed(model%problem%mesh%num_elements), source=0)
        do i = 1, size(old%faces%element)
          associate (e => old%faces%element(i))
            pushed(e) = ibset(pushed(e), old%faces%face(i))
          end associate
        end do
        do i = 1, size(new%faces%element)
          element = new%faces%element(i)
          if (btest(pushed(element), new%faces%face(i))) return
        end do
        element = 0
      end select
    end select
  end function shared_element

  !> The warning, at the last card that gives the new load.
  subroutine warn_of_both(model, s, element, first, second, faults)
    type(draft), intent(in) :: model
    integer, intent(in) :: s !< step
    integer, intent(in) :: element !< position
    integer, intent(in) :: first, second !< loads
    type(diagnostic_list), intent(inout) :: faults
    integer :: found
    found = card_of_dload(model, steps_of_cards(model%cards), s, &
                          model%problem%loads(second)%item%target)
    associate (loads => model%problem%loads)
      call model%cards(found)%warn( &
        faults, 'element '//as_text(model%problem%mesh%element_id(element))//' keeps the '// &
        "pressure '"//loads(first)%item%target//"' of an earlier step beside '"// &
        loads(second)%item%target//"': a load is replaced under its own name, or with OP=NEW")
    end associate
  end subroutine warn_of_both
end module check_pressures
