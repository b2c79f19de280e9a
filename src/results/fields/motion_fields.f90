!> Fields of the equations of motion, on the nodes.
module motion_fields
  use kinds, only: rk
  use problem_definition, only: problem
  use analysis_state, only: state
  use stress_fields, only: recovered_fields
  use field_type, only: result_field
  implicit none
  private
  public :: displacement, velocity, acceleration, reaction
  public :: has_motion, has_reactions

contains

  !> U.
  subroutine displacement(self, model, now, stresses, values)
    class(result_field), intent(in) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(recovered_fields), intent(inout) :: stresses
    real(rk), allocatable, intent(out) :: values(:, :) !< (3, nodes) [m]
    values = now%u
  end subroutine displacement

  !> V.
  subroutine velocity(self, model, now, stresses, values)
    class(result_field), intent(in) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(recovered_fields), intent(inout) :: stresses
    real(rk), allocatable, intent(out) :: values(:, :) !< (3, nodes) [m/s]
    if (allocated(now%v)) values = now%v
  end subroutine velocity

  !> A.
  subroutine acceleration(self, model, now, stresses, values)
    class(result_field), intent(in) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(recovered_fields), intent(inout) :: stresses
    real(rk), allocatable, intent(out) :: values(:, :) !< (3, nodes) [m/s2]
    if (allocated(now%a)) values = now%a
  end subroutine acceleration

  !> RF.
  subroutine reaction(self, model, now, stresses, values)
    class(result_field), intent(in) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(recovered_fields), intent(inout) :: stresses
    real(rk), allocatable, intent(out) :: values(:, :) !< (3, nodes) [N]
    if (allocated(now%reaction)) values = now%reaction
  end subroutine reaction

  !> Velocities and accelerations belong to dynamic steps.
  logical function has_motion(self, model, now)
    class(result_field), intent(in) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    has_motion = allocated(now%v) .and. allocated(now%a)
  end function has_motion

  !> True when the solver has computed the reactions.
  logical function has_reactions(self, model, now)
    class(result_field), intent(in) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    has_reactions = allocated(now%reaction)
  end function has_reactions
end module motion_fields
