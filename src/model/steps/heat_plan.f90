!> The temperatures of a deck: at the start of the analysis, and as the steps prescribe them.
module heat_plan
  use amplitudes, only: amplitude
  use kinds, only: rk
  implicit none
  private
  public :: heat_rule, heating

  !> Temperatures of some nodes in a step: final values, values times an amplitude, or a table over
  !> time. Of two rules for a node the later one acts.
  type :: heat_rule
    integer, allocatable :: nodes(:) !< positions
    real(rk), allocatable :: time(:) !< of the rows, ascending; size 0: one row, no time [s]
    real(rk), allocatable :: value(:, :) !< (times, nodes) [K]
    integer :: amplitude = 0 !< position; 0 for none
    logical :: uses_total_time = .false. !< of `time`, else the time within the step
    integer :: step = 0 !< that gives the rule
  contains
    procedure :: goes_on
  end type heat_rule

  !> Nothing is allocated in a deck without temperatures.
  type :: heating
    real(rk), allocatable :: initial(:) !< (nodes) at the start of the analysis [K]
    logical :: has_expansion = .false. !< of a material in use
  contains
    procedure :: is_there_any
  end type heating

contains

  !> Whether the deck has temperatures.
  pure logical function is_there_any(self)
    class(heating), intent(in) :: self
    is_there_any = allocated(self%initial)
  end function is_there_any

  !> Whether a rule acts in later steps too: its clock is the total time.
  pure logical function goes_on(self, histories)
    class(heat_rule), intent(in) :: self
    type(amplitude), intent(in) :: histories(:)
    goes_on = size(self%time) > 0 .and. self%uses_total_time
    if (self%amplitude > 0) goes_on = histories(self%amplitude)%uses_total_time
  end function goes_on
end module heat_plan
