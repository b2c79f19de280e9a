!> Warns of amplitudes, materials, joint laws and surface interactions that nothing uses.
module check_unused
  use deck_scan, only: is_keyword
  use diagnostics, only: diagnostic_list
  use model_draft, only: draft, law_of_joint
  use text_table, only: text_numbers
  implicit none
  private
  public :: warn_of_unused

contains

  !> The deck must have no errors.
  subroutine warn_of_unused(model, faults)
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    call warn_of_amplitudes(model, faults)
    call warn_of_materials(model, faults)
    call warn_of_laws(model, faults)
    call warn_of_interactions(model, faults)
  end subroutine warn_of_unused

  !> An amplitude is used if the parameter AMPLITUDE of a card names it.
  subroutine warn_of_amplitudes(model, faults)
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(text_numbers) :: used
    integer :: i, number
    do i = 1, size(model%cards)
      if (is_keyword(model%cards(i), 'AMPLITUDE') .or. is_keyword(model%cards(i), 'STEP')) cycle
      if (model%cards(i)%has('AMPLITUDE')) then
        call used%find_or_add(model%cards(i)%word('AMPLITUDE'), number)
      end if
    end do
    do i = 1, size(model%cards)
      if (.not. is_keyword(model%cards(i), 'AMPLITUDE')) cycle
      if (used%find(model%cards(i)%word('NAME')) > 0) cycle
      call model%cards(i)%warn(faults, "nothing uses amplitude '"// &
                               model%cards(i)%text('NAME')//"'")
    end do
  end subroutine warn_of_amplitudes

  !> A material is used if a section or a test names it.
  subroutine warn_of_materials(model, faults)
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    logical :: is_used(size(model%problem%materials))
    integer :: i, s
    is_used = .false.
    do s = 1, size(model%sections)
      is_used(model%material_of_name%find(model%sections(s)%material)) = .true.
    end do
    do i = 1, size(is_used)
      if (is_used(i) .or. any(model%problem%tests%material == i)) cycle
      associate (place => model%cards(model%material_origin(i)%card))
        call place%warn(faults, "nothing uses material '"//place%text('NAME')//"'")
      end associate
    end do
  end subroutine warn_of_materials

  !> A surface interaction is used if a contact pair names it.
  subroutine warn_of_interactions(model, faults)
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    logical :: is_used
    integer :: i, j
    do i = 1, size(model%interactions)
      is_used = .false.
      do j = 1, size(model%joints)
        is_used = is_used .or. (model%joints(j)%contact_law > 0 .and. &
                                model%joints(j)%law == model%interactions(i)%name)
      end do
      if (is_used) cycle
      associate (place => model%cards(model%interactions(i)%spot%card))
        call place%warn(faults, "nothing uses surface interaction '"//place%text('NAME')//"'")
      end associate
    end do
  end subroutine warn_of_interactions

  !> A joint law is used if a joint names it.
  subroutine warn_of_laws(model, faults)
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    logical :: is_used
    integer :: i, j
    do i = 1, size(model%laws)
      is_used = any([(law_of_joint(model, j) == i, j=1, size(model%joints))])
      if (is_used) cycle
      associate (place => model%cards(model%laws(i)%spot%card))
        call place%warn(faults, "nothing uses joint law '"//place%text('NAME')//"'")
      end associate
    end do
  end subroutine warn_of_laws
end module check_unused
