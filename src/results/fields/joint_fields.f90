!> Fields of joints: at their points, and the opening on nodes.
module joint_fields
  use kinds, only: rk
  use problem_definition, only: problem
  use analysis_state, only: state
  use joint_readings, only: opening_at_points, opening_at_nodes
  use stress_fields, only: recovered_fields
  use field_type, only: result_field
  implicit none
  private
  public :: has_joints, opening_on_nodes
  public :: opening_of_joint, slip_of_joint, traction_of_joint, state_of_joint
  public :: used_slip_of_joint, water_of_joint, phase_of_joint

contains

  !> The model has joints.
  logical function has_joints(self, model, now)
    class(result_field), intent(in) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    has_joints = size(model%joints) > 0
  end function has_joints

  !> OPENING on the nodes of joints, zero on others.
  subroutine opening_on_nodes(self, model, now, stresses, values)
    class(result_field), intent(in) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(recovered_fields), intent(inout) :: stresses
    real(rk), allocatable, intent(out) :: values(:, :) !< (1, nodes) [m]
    values = reshape(opening_at_nodes(model, now), [1, model%mesh%num_nodes])
  end subroutine opening_on_nodes

  !> OPENING.
  subroutine opening_of_joint(self, model, now, number, values)
    class(result_field), intent(in) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    integer, intent(in) :: number
    real(rk), allocatable, intent(out) :: values(:, :) !< (1, points) [m]
    values = one_row(opening_at_points(now%joints(number)))
  end subroutine opening_of_joint

  !> SLIP.
  subroutine slip_of_joint(self, model, now, number, values)
    class(result_field), intent(in) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    integer, intent(in) :: number
    real(rk), allocatable, intent(out) :: values(:, :) !< (2, points) [m]
    values = now%joints(number)%slip
  end subroutine slip_of_joint

  !> TRACTION.
  subroutine traction_of_joint(self, model, now, number, values)
    class(result_field), intent(in) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    integer, intent(in) :: number
    real(rk), allocatable, intent(out) :: values(:, :) !< (3, points) [Pa]
    values = now%joints(number)%traction
  end subroutine traction_of_joint

  !> STATE, a whole number.
  subroutine state_of_joint(self, model, now, number, values)
    class(result_field), intent(in) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    integer, intent(in) :: number
    real(rk), allocatable, intent(out) :: values(:, :) !< (1, points)
    values = one_row(real(now%joints(number)%status, rk))
  end subroutine state_of_joint

  !> REACH_USED: sliding over admissible slip; 0 where the slip has no limit.
  subroutine used_slip_of_joint(self, model, now, number, values)
    class(result_field), intent(in) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    integer, intent(in) :: number
    real(rk), allocatable, intent(out) :: values(:, :) !< (1, points)
    integer :: p
    associate (jump => now%joints(number)%jump, limit => model%joints(number)%admissible_slip)
      allocate (values(1, size(limit)), source=0.0_rk)
      do p = 1, size(limit)
        if (limit(p) < huge(1.0_rk)) values(1, p) = hypot(jump(2, p), jump(3, p))/limit(p)
      end do
    end associate
  end subroutine used_slip_of_joint

  !> WATER; joints without uplift have none.
  subroutine water_of_joint(self, model, now, number, values)
    class(result_field), intent(in) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    integer, intent(in) :: number
    real(rk), allocatable, intent(out) :: values(:, :) !< (1, points) [Pa]
    if (allocated(now%joints(number)%water)) values = one_row(now%joints(number)%water)
  end subroutine water_of_joint

  !> GROUTED, a whole number; joints without stages have none.
  subroutine phase_of_joint(self, model, now, number, values)
    class(result_field), intent(in) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    integer, intent(in) :: number
    real(rk), allocatable, intent(out) :: values(:, :) !< (1, points)
    if (allocated(now%joints(number)%phase)) then
      values = one_row(real(now%joints(number)%phase, rk))
    end if
  end subroutine phase_of_joint

  !> A list as a table of one row.
  pure function one_row(list) result(row)
    real(rk), intent(in) :: list(:)
    real(rk) :: row(1, size(list))
    row(1, :) = list
  end function one_row
end module joint_fields
