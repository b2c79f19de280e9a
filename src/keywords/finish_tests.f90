!> What `keyway --material` needs of a deck: tests, and laws for their materials.
module finish_tests
  use diagnostics, only: diagnostic_list
  use finish_concrete, only: complete_concretes
  use finish_user_materials, only: complete_user_materials
  use model_draft, only: draft
  implicit none
  private
  public :: complete_tests

contains

  !> Checks the tests; mesh and steps may be missing.
  subroutine complete_tests(model, faults)
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer :: i
    if (size(model%cards) == 0) return
    call complete_concretes(model, faults)
    call complete_user_materials(model, faults)
    if (size(model%scene%tests) == 0 .and. .not. faults%has_errors()) then
      call model%cards(size(model%cards))%fault(faults, 'the deck ends without a test', &
                                                '*MATERIAL TEST')
    end if
    do i = 1, size(model%scene%tests)
      call check_law(model, i, faults)
    end do
  end subroutine complete_tests

  !> The material of a test has a law.
  subroutine check_law(model, number, faults)
    type(draft), intent(in) :: model
    integer, intent(in) :: number !< of the test
    type(diagnostic_list), intent(inout) :: faults
    integer :: i
    i = model%scene%tests(number)%material
    if (i == 0) return ! told
    if (allocated(model%scene%materials(i)%law)) return
    if (any(model%scene%tests(:number - 1)%material == i)) return ! told
    if (any(model%concretes%material == i)) return ! told there
    if (any(model%user_materials%material == i)) return ! told there
    call model%cards(model%material_origin(i)%card)%fault( &
      faults, "material '"//model%scene%materials(i)%name//"' has no stiffness", '*ELASTIC')
  end subroutine check_law
end module finish_tests
