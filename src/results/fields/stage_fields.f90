!> The field STAGE: when an element was added (theory.md, 15.1).
module stage_fields
  use kinds, only: rk
  use problem_definition, only: problem
  use analysis_state, only: state
  use stress_fields, only: recovered_fields
  use field_type, only: result_field
  implicit none
  private
  public :: width_in_stages, stage_of_elements, stage_on_nodes

contains

  !> 1 where elements come or go, else 0.
  integer function width_in_stages(self, model) result(width)
    class(result_field), intent(in) :: self
    type(problem), intent(in) :: model
    width = 0
    if (allocated(model%stages%is_absent)) width = self%num_endings()
  end function width_in_stages

  !> The step in which each element was added, 0 where it is absent.
  subroutine stage_of_elements(self, model, now, stresses, values)
    class(result_field), intent(in) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(recovered_fields), intent(inout) :: stresses
    real(rk), allocatable, intent(out) :: values(:) !< (elements)
    values = real(model%stages%step_of_elements(now%step), rk)
  end subroutine stage_of_elements

  !> The first step of the elements at each node, 0 where none is there.
  subroutine stage_on_nodes(self, model, now, stresses, values)
    class(result_field), intent(in) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(recovered_fields), intent(inout) :: stresses
    real(rk), allocatable, intent(out) :: values(:, :) !< (1, nodes)
    integer :: added(model%mesh%num_elements), e, a
    added = model%stages%step_of_elements(now%step)
    allocate (values(1, model%mesh%num_nodes), source=0.0_rk)
    do e = 1, model%mesh%num_elements
      if (added(e) == 0) cycle
      do a = 1, size(model%mesh%nodes, 1)
        associate (node => model%mesh%nodes(a, e))
          if (node == 0) cycle
          if (values(1, node) < 0.5_rk .or. values(1, node) > added(e)) values(1, node) = added(e)
        end associate
      end do
    end do
  end subroutine stage_on_nodes
end module stage_fields
