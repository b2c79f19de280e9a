!> State of the iteration on inelastic solids within an increment, and what it says of the matrix.
module solid_iterate
  use increment_balance, only: increment_task
  use kinds, only: rk
  implicit none
  private
  public :: iterate_state, falls_too_slowly

  !> State of the iteration.
  type :: iterate_state
    type(increment_task) :: task !< with the initial-stress force in its right-hand side
    real(rk), allocatable :: rhs(:) !< without it
    real(rk), allocatable :: guess(:), answer(:) !< (free unknowns) s and s' [N]
    real(rk), allocatable :: unbalance(:) !< s' - s at the last point of linearisation [N]
    real(rk), allocatable :: base(:) !< s' there [N]
    real(rk) :: share = 1.0_rk !< fraction of the Newton step
    real(rk) :: force = huge(1.0_rk), last_force = huge(1.0_rk) !< norms of w (s' - s) [N]
    real(rk) :: base_force = huge(1.0_rk) !< the same at the last point of linearisation [N]
    integer :: tries = 0 !< iterations with the present matrix
    real(rk) :: moved = 0.0_rk !< norm of the last change of the displacements [m]
    logical :: is_lost = .false. !< the tangent is singular
    logical :: has_solved = .false. !< with the present matrix and active unknowns
    logical :: has_further = .false. !< further elements take part from now on
    integer :: first = 1 !< residual of the iteration with these elements
  contains
    procedure :: is_slow, has_grown
  end type iterate_state

  integer, parameter :: window = 15 !< iterations that give the rate of convergence
  !> A matrix is updated unless its iterations reduce the residual to this fraction.
  real(rk), parameter :: sufficient_decrease = 0.1_rk
  !> A Newton step that increases the residual by more than this factor is halved.
  real(rk), parameter :: largest_growth = 1.0_rk
  real(rk), parameter :: smallest_share = 0.1_rk !< of a step

contains

  !> Whether the matrix reduces the residual too slowly.
  pure logical function is_slow(self, patience)
    class(iterate_state), intent(in) :: self
    integer, intent(in) :: patience
    is_slow = self%tries > patience .and. self%force > sufficient_decrease*self%base_force
  end function is_slow

  !> Whether the residual, if it goes on at the rate of the last iterations, is still above the
  !> tolerance after those that remain.
  pure logical function falls_too_slowly(history, tolerance, remaining)
    real(rk), intent(in) :: history(:) !< residuals of all iterations
    real(rk), intent(in) :: tolerance
    integer, intent(in) :: remaining !< iterations
    real(rk) :: reduction
    falls_too_slowly = .false.
    if (size(history) <= window) return
    associate (last => history(size(history)), first => history(size(history) - window))
      reduction = last/max(first, tiny(1.0_rk))
      falls_too_slowly = last*reduction**(real(remaining, rk)/window) > tolerance
    end associate
  end function falls_too_slowly

  !> Whether a Newton step has increased the residual and must be halved.
  pure logical function has_grown(self)
    class(iterate_state), intent(in) :: self
    has_grown = self%force > largest_growth*self%base_force .and. self%share > smallest_share
  end function has_grown
end module solid_iterate
