!> Elements that lack something: one message for all of them.
module bare_elements
  use diagnostics, only: diagnostic_list
  use model_draft, only: draft
  use write_text, only: as_text
  implicit none
  private
  public :: tell_bare

contains

  !> Points at the first of the elements that lack something.
  subroutine tell_bare(is_bare, lack, expected, model, faults)
    logical, intent(in) :: is_bare(:) !< (elements)
    character(*), intent(in) :: lack, expected
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    character(:), allocatable :: others
    integer :: e
    if (.not. any(is_bare)) return
    e = findloc(is_bare, .true., dim=1)
    others = ''
    if (count(is_bare) > 1) others = ', as '//as_text(count(is_bare) - 1)//' more'
    associate (spot => model%element_origin(e))
      call model%cards(spot%card)%fault_at(faults, spot%line, 1, 'element '// &
                                           as_text(model%scene%mesh%element_id(e))//' has '// &
                                           lack//others, expected)
    end associate
  end subroutine tell_bare
end module bare_elements
