!> The field ERROR: what the mesh leaves in the stresses (theory.md, 14.1).
module error_fields
  use kinds, only: rk
  use problem_definition, only: problem
  use analysis_state, only: state
  use stress_fields, only: recovered_fields
  use field_type, only: result_field
  implicit none
  private
  public :: error_of_elements, error_on_nodes

contains

  !> Error of each element over the norm of all stresses; the squares add up to the square of the
  !> relative error of the model.
  subroutine error_of_elements(self, model, now, stresses, values)
    class(result_field), intent(in) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(recovered_fields), intent(inout) :: stresses
    real(rk), allocatable, intent(out) :: values(:) !< (elements)
    real(rk) :: whole
    call stresses%need_error(model, now)
    whole = max(tiny(whole), sum(stresses%error_energy) + sum(stresses%stress_energy))
    allocate (values(model%mesh%num_elements), source=0.0_rk)
    values(stresses%plan%element_of_solid) = sqrt(stresses%error_energy/whole)
  end subroutine error_of_elements

  !> Means of the elements at the nodes.
  subroutine error_on_nodes(self, model, now, stresses, values)
    class(result_field), intent(in) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(recovered_fields), intent(inout) :: stresses
    real(rk), allocatable, intent(out) :: values(:, :) !< (1, nodes)
    real(rk), allocatable :: of_elements(:)
    integer :: n
    call error_of_elements(self, model, now, stresses, of_elements)
    allocate (values(1, model%mesh%num_nodes), source=0.0_rk)
    associate (plan => stresses%plan)
      do n = 1, model%mesh%num_nodes
        associate (corners => plan%corner(plan%node_start(n):plan%node_start(n + 1) - 1))
          if (size(corners) == 0) cycle
          values(1, n) = sum(of_elements(plan%element_of_solid((corners - 1)/8 + 1)))/size(corners)
        end associate
      end do
    end associate
  end subroutine error_on_nodes
end module error_fields
