!> Dual solutions: what a unit force does where and as a result is largest (theory.md, 14.2). They
!> weigh what is missing in the equations by its effect on that result.
module dual_solutions
  use kinds, only: rk
  implicit none
  private
  public :: dual_solution, of_displacement, of_opening

  integer, parameter :: of_displacement = 1, of_opening = 2 !< the results

  type :: dual_solution
    integer :: goal = 0 !< `of_displacement` or `of_opening`
    real(rk) :: value = 0.0_rk !< the result, the largest of its kind [m]
    real(rk), allocatable :: u(:, :) !< (3, nodes) displacement under the unit force [m/N]
    real(rk) :: joints = -1.0_rk !< error by the springs of closed joints; -1: not known [m]
    real(rk) :: iteration = -1.0_rk !< error by the residual of the iteration; -1: not known [m]
  end type dual_solution
end module dual_solutions
