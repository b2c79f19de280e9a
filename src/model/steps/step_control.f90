!> Controls the size of increments: it grows after quick convergence and is cut without convergence.
!> A static increment that was cut grows again after many that have converged, however slowly: where
!> concrete softens, smaller increments take as many iterations as larger ones.
module step_control
  use kinds, only: rk
  use step_plan, only: step
  implicit none
  private
  public :: increment_control, start_control, roundoff

  real(rk), parameter :: static_growth = 1.5_rk
  real(rk), parameter :: dynamic_growth = 2.0_rk !< doubling returns to earlier sizes
  real(rk), parameter :: cut_factor = 0.5_rk
  real(rk), parameter :: smallest_ratio = 0.1_rk !< smallest factor of one cut
  integer, parameter :: easy_iterations = 5 !< at most, of an increment that may grow
  integer, parameter :: easy_increments = 2 !< in a row, before a static step grows
  integer, parameter :: easy_dynamic_increments = 10 !< in a row: a new size is factored anew
  !> Increments in a row without a cut, before a static step grows that was cut; twice as many after
  !> each growth that was cut at once, up to the most.
  integer, parameter :: steady_increments = 4, most_steady_increments = 64
  !> Cuts in a row; after so many an increment is as small as the round-off of the time.
  integer, parameter :: most_cuts_in_a_row = 40
  !> Round-off of times, over the increment: a sum of n equal increments is off by up to n^2*1e-16.
  real(rk), parameter :: roundoff = 1.0e-6_rk

  integer, parameter :: most_halvings = 60

  !> A new component gets a line in save and load of state_archive.
  type :: increment_control
    real(rk) :: size = 0.0_rk !< of the next increment [s]
    real(rk) :: last_size = 0.0_rk !< of the last increment that was cut [s]
    real(rk) :: smallest = 0.0_rk, largest = 0.0_rk !< [s]
    !> With *CONTROLS, ACCURACY: the first increment, and the smallest that accuracy asks for [s].
    !> Sizes are powers of two of the first. 0 where sizes do not follow the estimated error
    real(rk) :: first = 0.0_rk, finest = 0.0_rk
    real(rk) :: duration = 0.0_rk !< of the step [s]
    real(rk) :: growth = static_growth
    integer :: easy_needed = easy_increments
    logical :: is_direct = .false.
    integer :: easy_so_far = 0, cuts_in_a_row = 0, cutbacks = 0
    integer :: steady_so_far = 0 !< increments since the size has changed
    integer :: steady_needed = steady_increments
    logical :: has_tried = .false. !< the size has grown after steady increments, none has ended yet
  contains
    procedure :: next_size, accept, may_cut, cut, least_size, follow_error
    procedure, private :: on_grid, is_steady
  end type increment_control

contains

  !> The rules of a step. A dynamic step grows beyond its first increment only when the deck names a
  !> larger one: its size is a matter of accuracy, not of convergence.
  pure subroutine start_control(plan, is_dynamic, control)
    type(step), intent(in) :: plan
    logical, intent(in) :: is_dynamic
    type(increment_control), intent(out) :: control
    control%size = min(plan%first_increment, plan%duration)
    control%duration = plan%duration
    control%is_direct = plan%is_direct
    control%smallest = plan%smallest_increment
    if (control%smallest <= 0.0_rk) control%smallest = plan%default_smallest()
    control%smallest = min(control%smallest, control%size)
    control%largest = min(plan%largest_increment, plan%duration)
    if (.not. is_dynamic) return
    if (plan%follows_accuracy()) then
      control%first = control%size
      control%finest = control%first
      do while (0.5_rk*control%finest >= max(plan%finest_increment, control%smallest) &
                *(1.0_rk - roundoff))
        control%finest = 0.5_rk*control%finest
      end do
    end if
    control%growth = dynamic_growth
    control%easy_needed = easy_dynamic_increments
    if (plan%largest_increment >= huge(1.0_rk)) control%largest = control%size
    if (plan%follows_accuracy()) control%size = control%on_grid(control%largest)
  end subroutine start_control

  !> Size of the increment that starts at a time, not past the end of the step. If the remaining
  !> time differs by round-off only, the size stays and needs no new factorisation.
  pure real(rk) function next_size(self, time) result(size)
    class(increment_control), intent(in) :: self
    real(rk), intent(in) :: time !< within the step [s]
    size = self%size
    if (self%duration - time < self%size*(1.0_rk - roundoff)) size = self%duration - time
  end function next_size

  !> An increment has converged.
  pure subroutine accept(self, iterations)
    class(increment_control), intent(inout) :: self
    integer, intent(in) :: iterations
    self%cuts_in_a_row = 0
    self%easy_so_far = merge(self%easy_so_far + 1, 0, iterations <= easy_iterations)
    self%steady_so_far = self%steady_so_far + 1
    if (self%has_tried) self%steady_needed = steady_increments
    self%has_tried = .false.
    if (self%is_direct .or. self%first > 0.0_rk) return
    if (self%easy_so_far < self%easy_needed) then
      if (.not. self%is_steady()) return
      self%has_tried = .true.
    end if
    if (self%size*self%growth <= self%largest*(1.0_rk + roundoff)) then
      self%size = self%size*self%growth
    else if (self%easy_needed == easy_increments) then
      self%size = self%largest
    end if
    self%easy_so_far = 0
    self%steady_so_far = 0
  end subroutine accept

  !> Whether a static step that was cut may grow though its increments converge slowly.
  pure logical function is_steady(self)
    class(increment_control), intent(in) :: self
    is_steady = self%easy_needed == easy_increments .and. self%cutbacks > 0 &
                .and. self%steady_so_far >= self%steady_needed
  end function is_steady

  !> The estimated error chooses the size of the next increment, after `accept`. The size is doubled
  !> where a multiple of the new size ends, so that multiples of the first increment are met.
  pure subroutine follow_error(self, time, doublings)
    class(increment_control), intent(inout) :: self
    real(rk), intent(in) :: time !< within the step [s]
    integer, intent(in) :: doublings !< of the size; negative: halvings
    real(rk) :: wanted
    if (.not. self%first > 0.0_rk .or. doublings == 0) return
    if (doublings < 0) then
      wanted = max(self%size*2.0_rk**doublings, self%finest)
      if (wanted < self%size) self%easy_so_far = 0
      self%size = min(self%size, wanted)
      return
    end if
    wanted = 2.0_rk*self%size
    if (self%easy_so_far < self%easy_needed) return
    if (wanted > self%largest*(1.0_rk + roundoff)) return
    if (abs(time/wanted - anint(time/wanted)) > roundoff*max(1.0_rk, time/wanted)) return
    self%size = wanted
    self%easy_so_far = 0
  end subroutine follow_error

  !> The largest power of two of the first increment up to a size.
  pure real(rk) function on_grid(self, size) result(grid)
    class(increment_control), intent(in) :: self
    real(rk), intent(in) :: size !< [s]
    integer :: halvings
    grid = self%first
    do halvings = 1, most_halvings
      if (grid <= size*(1.0_rk + roundoff)) exit
      grid = 0.5_rk*grid
    end do
  end function on_grid

  !> The smallest increment that halving can still reach.
  pure real(rk) function least_size(self) result(size)
    class(increment_control), intent(in) :: self
    size = max(self%smallest, self%size*cut_factor**(most_cuts_in_a_row - self%cuts_in_a_row))
  end function least_size

  !> Whether an increment without convergence can be cut at all.
  pure logical function may_cut(self, size)
    class(increment_control), intent(in) :: self
    real(rk), intent(in) :: size !< of the increment [s]
    may_cut = .not. self%is_direct .and. self%cuts_in_a_row < most_cuts_in_a_row &
              .and. cut_factor*size >= self%smallest
  end function may_cut

  !> An increment has not converged: halves its size, or reduces it further if a material requests
  !> that, or gives up.
  pure subroutine cut(self, size, ratio, gives_up)
    class(increment_control), intent(inout) :: self
    real(rk), intent(in) :: size !< of the increment that failed [s]
    real(rk), intent(in) :: ratio !< requested over present size; 1 without a request
    logical, intent(out) :: gives_up
    self%last_size = size
    self%cuts_in_a_row = self%cuts_in_a_row + 1
    self%easy_so_far = 0
    self%steady_so_far = 0
    if (self%has_tried) self%steady_needed = min(2*self%steady_needed, most_steady_increments)
    self%has_tried = .false.
    self%size = min(cut_factor, max(ratio, smallest_ratio))*size
    if (self%first > 0.0_rk) self%size = self%on_grid(self%size)
    gives_up = self%is_direct .or. self%cuts_in_a_row > most_cuts_in_a_row &
               .or. self%size < self%smallest*(1.0_rk - roundoff)
    if (.not. gives_up) self%cutbacks = self%cutbacks + 1
  end subroutine cut
end module step_control
