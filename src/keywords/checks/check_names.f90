!> Refuses two names that are one in job.h5, where a '/' becomes a '_'.
module check_names
  use diagnostics, only: diagnostic_list
  use file_system, only: link_name
  use model_draft, only: draft
  use named_things, only: joint_names, set_names, surface_names
  use text_table, only: text_numbers
  implicit none
  private
  public :: verify_names

contains

  !> The deck must have no errors.
  subroutine verify_names(model, faults)
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    call compare(set_names(model%node_sets), 'NSET', model, faults)
    call compare(set_names(model%element_sets), 'ELSET', model, faults)
    call compare(surface_names(model), 'NAME', model, faults)
    call compare(joint_names(model), 'NAME', model, faults)
  end subroutine verify_names

  !> Reports names with a '/' that are another name without it.
  subroutine compare(names, parameter_name, model, faults)
    character(*), intent(in) :: names(:)
    character(*), intent(in) :: parameter_name !< that gives the names
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(text_numbers) :: links
    integer :: first(size(names)), second(size(names)) !< (links) their names, 0 for none
    integer :: i, j, n, place
    if (all(index(names, '/') == 0)) return
    first = 0
    second = 0
    do i = 1, size(names)
      call links%find_or_add(trim(link_name(names(i))), n)
      if (first(n) == 0) then
        first(n) = i
      else if (second(n) == 0) then
        second(n) = i
      end if
    end do
    do i = 1, size(names)
      if (index(names(i), '/') == 0) cycle
      n = links%find(trim(link_name(names(i))))
      j = merge(second(n), first(n), first(n) == i)
      if (j == 0) cycle
      place = card_with(names(i), parameter_name, model)
      if (place == 0) cycle
      call model%cards(place)%fault_parameter( &
        faults, parameter_name, "'"//trim(names(i))//"' and '"//trim(names(j))// &
        "' are one name in job.h5", "names that differ by more than '/' and '_'")
      return
    end do
  end subroutine compare

  !> The first card whose parameter has this value, 0 without one.
  pure integer function card_with(name, parameter_name, model) result(found)
    character(*), intent(in) :: name, parameter_name
    type(draft), intent(in) :: model
    do found = 1, size(model%cards)
      if (model%cards(found)%word(parameter_name) == name) return
    end do
    found = 0
  end function card_with
end module check_names
