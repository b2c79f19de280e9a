!> Groups of nodes that guests and ties connect, in addition to the elements.
module bonded_nodes
  use guest_list, only: guests_of_model, list_guest_cells
  use guest_type, only: guest_reference
  use problem_definition, only: problem
  use row_tables, only: row_table
  implicit none
  private
  public :: list_groups

contains

  !> The cells of the guests (points of joints, segments of springs), and each node of a tie with
  !> the nodes that it follows.
  subroutine list_groups(model, groups)
    type(problem), intent(in), target :: model
    type(row_table), intent(out) :: groups
    type(guest_reference), allocatable :: guests(:)
    integer :: j, k
    call guests_of_model(model, guests)
    call list_guest_cells(guests, groups)
    do j = 1, size(model%ties)
      associate (tie => model%ties(j))
        do k = 1, size(tie%node)
          call groups%append([tie%node(k), tie%master(tie%first(k):tie%first(k + 1) - 1)])
        end do
      end associate
    end do
    call groups%finish()
  end subroutine list_groups
end module bonded_nodes
