!> Fields of solids: at integration points, in inelastic blocks, and as means on nodes.
module solid_fields
  use kinds, only: rk
  use problem_definition, only: problem
  use analysis_state, only: state
  use law_fields, only: field_at_points, field_of_block, width_of_field
  use principal_loops, only: principals
  use stress_fields, only: recovered_fields
  use tensor6, only: principal_values
  use field_type, only: result_field
  use thermal_recovery, only: add_expansion, has_expansion
  implicit none
  private
  public :: stress_on_nodes, stress_of_solids, stress_of_block
  public :: strain_on_nodes, strain_of_solids, strain_of_block
  public :: principals_on_nodes, principals_of_solids
  public :: extreme_on_nodes, extreme_near_nodes, extreme_of_block
  public :: width_in_blocks, law_width, law_on_nodes, law_of_solids, law_of_block

contains

  !> S on nodes.
  subroutine stress_on_nodes(self, model, now, stresses, values)
    class(result_field), intent(in) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(recovered_fields), intent(inout) :: stresses
    real(rk), allocatable, intent(out) :: values(:, :) !< (6, nodes) [Pa]
    call stresses%need_node_stress(model, now)
    values = stresses%node_stress
  end subroutine stress_on_nodes

  !> S at points.
  subroutine stress_of_solids(self, model, now, stresses, solids, values)
    class(result_field), intent(in) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(recovered_fields), intent(inout) :: stresses
    integer, intent(in) :: solids(:)
    real(rk), allocatable, intent(out) :: values(:, :, :) !< (6, max_points, solids) [Pa]
    call stresses%need_points(model, now)
    values = stresses%point_stress(:, :, solids)
  end subroutine stress_of_solids

  !> S of a block.
  subroutine stress_of_block(self, model, now, block, values)
    class(result_field), intent(in) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    integer, intent(in) :: block
    real(rk), allocatable, intent(out) :: values(:, :) !< (6, points) [Pa]
    values = now%points(block)%stress
  end subroutine stress_of_block

  !> E on nodes.
  subroutine strain_on_nodes(self, model, now, stresses, values)
    class(result_field), intent(in) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(recovered_fields), intent(inout) :: stresses
    real(rk), allocatable, intent(out) :: values(:, :) !< (6, nodes)
    call stresses%need_node_strain(model, now)
    values = stresses%node_strain
  end subroutine strain_on_nodes

  !> E at points.
  subroutine strain_of_solids(self, model, now, stresses, solids, values)
    class(result_field), intent(in) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(recovered_fields), intent(inout) :: stresses
    integer, intent(in) :: solids(:)
    real(rk), allocatable, intent(out) :: values(:, :, :) !< (6, max_points, solids)
    call stresses%need_point_strain(model, now)
    values = stresses%point_strain(:, :, solids)
  end subroutine strain_of_solids

  !> E of a block.
  subroutine strain_of_block(self, model, now, block, values)
    class(result_field), intent(in) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    integer, intent(in) :: block
    real(rk), allocatable, intent(out) :: values(:, :) !< (6, points)
    real(rk), allocatable :: total(:, :, :)
    values = now%points(block)%strain
    associate (part => model%inelastic(block))
      if (.not. has_expansion(model, now, part%elements)) return
      total = reshape(values, [6, part%points_of_element, size(part%elements)])
      call add_expansion(model, now, part%elements, total)
      values = reshape(total, shape(values))
    end associate
  end subroutine strain_of_block

  !> SP on nodes.
  subroutine principals_on_nodes(self, model, now, stresses, values)
    class(result_field), intent(in) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(recovered_fields), intent(inout) :: stresses
    real(rk), allocatable, intent(out) :: values(:, :) !< (3, nodes) [Pa]
    call stresses%need_principals(model, now)
    values = stresses%node_principal
  end subroutine principals_on_nodes

  !> SP at points.
  subroutine principals_of_solids(self, model, now, stresses, solids, values)
    class(result_field), intent(in) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(recovered_fields), intent(inout) :: stresses
    integer, intent(in) :: solids(:)
    real(rk), allocatable, intent(out) :: values(:, :, :) !< (3, max_points, solids) [Pa]
    integer :: s, q
    call stresses%need_points(model, now)
    allocate (values(3, size(stresses%point_stress, 2), size(solids)))
    do s = 1, size(solids)
      do q = 1, size(values, 2)
        values(:, q, s) = principal_values(stresses%point_stress(:, q, solids(s)))
      end do
    end do
  end subroutine principals_of_solids

  !> S1 or S3 on nodes.
  subroutine extreme_on_nodes(self, model, now, stresses, values)
    class(result_field), intent(in) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(recovered_fields), intent(inout) :: stresses
    real(rk), allocatable, intent(out) :: values(:, :) !< (1, nodes) [Pa]
    integer :: i
    call stresses%need_principals(model, now)
    i = number_of_extreme(self)
    values = stresses%node_principal(i:i, :)
  end subroutine extreme_on_nodes

  !> Number of the principal stress: 1 is the largest, 3 the smallest.
  pure integer function number_of_extreme(self) result(number)
    class(result_field), intent(in) :: self
    number = merge(3, 1, self%wants_smallest)
  end function number_of_extreme

  !> 1 where a material has a law with states at its points, else 0.
  integer function width_in_blocks(self, model)
    class(result_field), intent(in) :: self
    type(problem), intent(in) :: model
    width_in_blocks = 0
    if (.not. allocated(model%inelastic)) return
    if (size(model%inelastic) > 0) width_in_blocks = self%num_endings()
  end function width_in_blocks

  !> S1_POINT or S3_POINT on nodes.
  subroutine extreme_near_nodes(self, model, now, stresses, values)
    class(result_field), intent(in) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(recovered_fields), intent(inout) :: stresses
    real(rk), allocatable, intent(out) :: values(:, :) !< (1, nodes) [Pa]
    call stresses%points_on_nodes(model, now, number_of_extreme(self), values)
  end subroutine extreme_near_nodes

  !> S1_POINT or S3_POINT of a block.
  subroutine extreme_of_block(self, model, now, block, values)
    class(result_field), intent(in) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    integer, intent(in) :: block
    real(rk), allocatable, intent(out) :: values(:, :) !< (1, points) [Pa]
    integer :: i
    values = principals(now%points(block)%stress)
    i = number_of_extreme(self)
    values = values(i:i, :)
  end subroutine extreme_of_block

  !> Components of a field of laws.
  integer function law_width(self, model)
    class(result_field), intent(in) :: self
    type(problem), intent(in) :: model
    law_width = width_of_field(model, self%name)
  end function law_width

  !> A field of laws on nodes.
  subroutine law_on_nodes(self, model, now, stresses, values)
    class(result_field), intent(in) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(recovered_fields), intent(inout) :: stresses
    real(rk), allocatable, intent(out) :: values(:, :)
    call stresses%field_on_nodes(model, now, self%name, values)
  end subroutine law_on_nodes

  !> A field of laws at points.
  subroutine law_of_solids(self, model, now, stresses, solids, values)
    class(result_field), intent(in) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(recovered_fields), intent(inout) :: stresses
    integer, intent(in) :: solids(:)
    real(rk), allocatable, intent(out) :: values(:, :, :)
    call stresses%need_plan(model)
    call field_at_points(model, stresses%plan, now, self%name, values)
    values = values(:, :, solids)
  end subroutine law_of_solids

  !> A field of laws in a block.
  subroutine law_of_block(self, model, now, block, values)
    class(result_field), intent(in) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    integer, intent(in) :: block
    real(rk), allocatable, intent(out) :: values(:, :)
    call field_of_block(model, now, block, self%name, values)
  end subroutine law_of_block
end module solid_fields
