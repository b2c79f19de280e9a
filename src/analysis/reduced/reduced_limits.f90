!> What a reduced model does not hold, and the reader of the deck cannot know.
module reduced_limits
  use analysis_state, only: state
  use errors, only: error_type, raise
  use guest_forces, only: has_histories
  use kinds, only: rk
  use step_loads, only: support
  use step_system, only: dam_system
  use write_text, only: as_text
  implicit none
  private
  public :: refuse_size

  !> Most points of joints: their compliance is a dense matrix.
  integer, parameter :: most_points = 1500
  real(rk), parameter :: round_off = 1.0e-12_rk !< of a displacement

contains

  !> Error: too many points of joints, forces with a history, supports that move at once.
  subroutine refuse_size(system, now, error)
    type(dam_system), intent(in) :: system
    type(state), intent(in) :: now
    type(error_type), allocatable, intent(out) :: error
    if (system%operator%num_points > most_points) then
      call raise(error, '*DYNAMIC, REDUCED holds up to '//as_text(most_points)//' points of '// &
                 'joints, and the model has '//as_text(system%operator%num_points)// &
                 '; take *DYNAMIC without REDUCED')
    else if (has_histories(now%guests)) then
      call raise(error, '*DYNAMIC, REDUCED holds no forces with a history other than those of '// &
                 'joints; take *DYNAMIC without REDUCED')
    else if (any(moves_at_once(system%supports))) then
      call raise(error, '*DYNAMIC, REDUCED: a support of the step moves at its start, and a '// &
                 'reduced model holds its supports; take *DYNAMIC without REDUCED, or move '// &
                 'the support in a step before')
    end if
  end subroutine refuse_size

  !> Whether a support has another displacement in the step than at its start.
  elemental logical function moves_at_once(held)
    type(support), intent(in) :: held
    moves_at_once = abs(held%value - held%start_value) &
                    > round_off*max(abs(held%value), abs(held%start_value))
  end function moves_at_once

end module reduced_limits
