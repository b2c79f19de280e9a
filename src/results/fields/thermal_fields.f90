!> Fields of models with temperatures: on the nodes, and the thermal strain of solids.
module thermal_fields
  use analysis_state, only: state
  use field_type, only: result_field
  use kinds, only: rk
  use problem_definition, only: problem
  use stress_fields, only: recovered_fields
  implicit none
  private
  public :: temperature, width_of_heat, width_of_expansion, expansion_on_nodes, expansion_of_solids

contains

  !> 1 in models with temperatures, else 0.
  integer function width_of_heat(self, model)
    class(result_field), intent(in) :: self
    type(problem), intent(in) :: model
    width_of_heat = merge(self%num_endings(), 0, model%heat%is_there_any())
  end function width_of_heat

  !> 6 where a material expands and the model has temperatures, else 0.
  integer function width_of_expansion(self, model)
    class(result_field), intent(in) :: self
    type(problem), intent(in) :: model
    width_of_expansion = 0
    if (model%heat%has_expansion) width_of_expansion = width_of_heat(self, model)
  end function width_of_expansion

  !> TEMP.
  subroutine temperature(self, model, now, stresses, values)
    class(result_field), intent(in) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(recovered_fields), intent(inout) :: stresses
    real(rk), allocatable, intent(out) :: values(:, :) !< (1, nodes) [K]
    if (allocated(now%heat%temperature)) then
      values = reshape(now%heat%temperature, [1, model%mesh%num_nodes])
    end if
  end subroutine temperature

  !> THE on nodes.
  subroutine expansion_on_nodes(self, model, now, stresses, values)
    class(result_field), intent(in) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(recovered_fields), intent(inout) :: stresses
    real(rk), allocatable, intent(out) :: values(:, :) !< (6, nodes)
    call stresses%expansion_on_nodes(model, now, values)
  end subroutine expansion_on_nodes

  !> THE at points.
  subroutine expansion_of_solids(self, model, now, stresses, solids, values)
    class(result_field), intent(in) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(recovered_fields), intent(inout) :: stresses
    integer, intent(in) :: solids(:)
    real(rk), allocatable, intent(out) :: values(:, :, :) !< (6, max_points, solids)
    real(rk), allocatable :: of_all(:, :, :)
    call stresses%find_expansions(model, now, of_all)
    values = of_all(:, :, solids)
  end subroutine expansion_of_solids
end module thermal_fields
