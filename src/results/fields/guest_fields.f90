!> Fields on nodes that guests offer: rows of the table of fields for one model.
module guest_fields
  use analysis_state, only: state
  use field_type, only: at_nodes, by_guest, result_field, scalar, vector
  use guest_type, only: offered_field
  use kinds, only: rk
  use problem_definition, only: problem
  use stress_fields, only: recovered_fields
  implicit none
  private
  public :: add_guest_fields

contains

  !> Appends a row for each field that guests of the model offer; guests may share a field.
  subroutine add_guest_fields(model, table)
    type(problem), intent(in) :: model
    type(result_field), allocatable, intent(inout) :: table(:)
    type(result_field), allocatable :: longer(:)
    type(offered_field) :: offered
    integer :: i, k, n
    do i = 1, size(model%guests)
      do k = 1, model%guests(i)%item%num_fields()
        call model%guests(i)%item%describe_field(k, offered)
        if (any([(table(n)%name == offered%name, n=1, size(table))])) cycle
        allocate (longer(size(table) + 1))
        longer(:size(table)) = table
        call fill_row(offered, longer(size(longer)))
        call move_alloc(longer, table)
      end do
    end do
  end subroutine add_guest_fields

  !> The row of a field.
  subroutine fill_row(offered, row)
    type(offered_field), intent(in) :: offered
    type(result_field), intent(out) :: row
    row%name = offered%name
    row%stem = offered%name
    row%meaning = offered%meaning
    row%unit = offered%unit
    row%remark = ''
    row%requests = ''
    row%provider = by_guest
    row%place = at_nodes
    row%endings = scalar
    if (offered%num_components == 3) row%endings = vector
    row%on_nodes => values_of_guests
  end subroutine fill_row

  !> The sum over the guests that offer the field.
  subroutine values_of_guests(self, model, now, stresses, values)
    class(result_field), intent(in) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(recovered_fields), intent(inout) :: stresses
    real(rk), allocatable, intent(out) :: values(:, :) !< (components, nodes)
    type(offered_field) :: offered
    integer :: i, k
    allocate (values(self%num_endings(), model%mesh%num_nodes), source=0.0_rk)
    do i = 1, size(model%guests)
      associate (item => model%guests(i)%item)
        do k = 1, item%num_fields()
          call item%describe_field(k, offered)
          if (offered%name == self%name) call item%add_field(k, now%guests(i)%item, values)
        end do
      end associate
    end do
  end subroutine values_of_guests
end module guest_fields
