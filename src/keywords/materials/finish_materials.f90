!> Completes the laws of all materials after the whole deck is read.
module finish_materials
  use diagnostics, only: diagnostic_list
  use finish_user_materials, only: check_library
  use model_draft, only: draft, material_request
  implicit none
  private
  public :: complete_materials

contains

  !> Completes each request. The request is moved out of the draft meanwhile: both are arguments.
  subroutine complete_materials(model, faults)
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    class(material_request), allocatable :: request
    integer :: i
    call check_library(model, faults)
    do i = 1, size(model%material_requests)
      call move_alloc(model%material_requests(i)%item, request)
      call request%complete(model, faults)
      call move_alloc(request, model%material_requests(i)%item)
    end do
  end subroutine complete_materials
end module finish_materials
