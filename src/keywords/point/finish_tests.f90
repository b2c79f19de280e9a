!> Checks a deck for `keyway --material`: it has tests, and their materials have suitable laws.
module finish_tests
  use diagnostics, only: diagnostic_list
  use finish_materials, only: complete_materials
  use material_catalogue, only: names_of_laws
  use model_draft, only: draft, has_request
  implicit none
  private
  public :: complete_tests

contains

  !> Checks the tests; mesh and steps may be missing.
  subroutine complete_tests(model, faults)
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer :: i, j
    if (size(model%cards) == 0) return
    call complete_materials(model, faults)
    if (size(model%problem%tests) == 0 .and. .not. faults%has_errors()) then
      call model%cards(size(model%cards))%fault(faults, 'the deck ends without a test', &
                                                '*MATERIAL TEST')
    end if
    do i = 1, size(model%problem%tests)
      call check_law(model, i, faults)
    end do
    if (faults%has_errors()) return
    do i = 1, size(model%problem%tests)
      do j = 1, size(model%material_requests)
        associate (request => model%material_requests(j)%item)
          if (request%material == model%problem%tests(i)%material) then
            call request%check_test(i, model, faults)
          end if
        end associate
      end do
    end do
  end subroutine complete_tests

  !> Reports a material of a test without a law.
  subroutine check_law(model, number, faults)
    type(draft), intent(in) :: model
    integer, intent(in) :: number !< of the test
    type(diagnostic_list), intent(inout) :: faults
    integer :: i
    i = model%problem%tests(number)%material
    if (i == 0) return ! reported
    if (allocated(model%problem%materials(i)%law)) return
    if (any(model%problem%tests(:number - 1)%material == i)) return ! reported
    if (has_request(model, i)) return ! reported by the request
    call model%cards(model%material_origin(i)%card)%fault( &
      faults, "material '"//model%problem%materials(i)%name//"' has no stiffness", names_of_laws())
  end subroutine check_law
end module finish_tests
