!> The equations of one increment, and the one measure of their balance.
!>
!> Joints and solids stop within the tolerance, each by its own forces; their remainders can add up
!> to more. The increment is then solved again from its solution, with tighter tolerances for both.
module increment_balance
  use equilibrium, only: balance_outcome, force_balance
  use global_vectors, only: norm
  use kinds, only: rk
  use unknown_parts, only: unknown_part
  implicit none
  private
  public :: increment_task

  !> The problem of one increment.
  type :: increment_task
    type(force_balance) :: balance !< without the initial-stress force
    real(rk), allocatable :: start(:) !< (num_total) u at x = 0, supports in place [m]
    real(rk), allocatable :: velocity(:) !< (num_total) at x = 0; dynamic steps only [m/s]
    real(rk) :: velocity_of_x = 0.0_rk !< dv/dx [1/s]
    real(rk), allocatable :: predicted(:) !< (free unknowns) x of a motion that goes on [m]
    !> (num_total) rates of prescribed unknowns at the end; dynamic steps whose supports follow an
    !> amplitude only [m/s], [m/s2]
    real(rk), allocatable :: support_v(:), support_a(:)
    real(rk), allocatable :: x(:) !< (num_total) solution; zero on prescribed unknowns [m]
    real(rk) :: reference_force = 0.0_rk !< largest known force [N]
    logical :: counts_reactions = .false. !< reactions are part of the reference force
    real(rk) :: tolerance = 0.0_rk !< of the residual of all forces
    real(rk) :: share = 1.0_rk !< tolerance of joints and of solids, over `tolerance`
    real(rk) :: residual = huge(1.0_rk) !< of the last pass
    integer :: iterations = 0 !< of all passes
    logical :: is_refined = .false. !< `x` is a solution to be refined
  contains
    procedure :: check_balance
  end type increment_task

  real(rk), parameter :: tighter = 0.1_rk !< factor of `share` from pass to pass
  real(rk), parameter :: tightest = 1.0e-4_rk !< smallest share
  !> A pass that does not reduce the residual to this fraction is the last.
  real(rk), parameter :: useful_pass = 0.7_rk

contains

  !> Measures the residual of all forces, those of the laws included, over the reference force. It
  !> decides convergence, and whether another pass follows (`is_refined`). The outcome counts the
  !> iterations of all passes.
  subroutine check_balance(self, part, unbalance, reference, outcome)
    class(increment_task), intent(inout) :: self
    type(unknown_part), intent(in) :: part
    real(rk), intent(in) :: unbalance(:) !< (free unknowns) [N]
    real(rk), intent(in) :: reference !< [N]
    type(balance_outcome), intent(inout) :: outcome
    real(rk) :: last
    self%iterations = self%iterations + outcome%iterations
    outcome%iterations = self%iterations
    last = self%residual
    self%residual = norm(part, unbalance)/max(reference, tiny(1.0_rk))
    outcome%residual = self%residual
    outcome%tolerance = self%tolerance
    outcome%has_converged = self%residual <= self%tolerance
    self%is_refined = .not. outcome%has_converged .and. self%share > tightest &
                      .and. self%residual < useful_pass*last
    if (self%is_refined) self%share = tighter*self%share
  end subroutine check_balance
end module increment_balance
