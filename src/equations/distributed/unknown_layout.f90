!> The rows of the distributed matrix: which rank owns each row, and which unknown stands in it.
!>
!> Three rows belong to one node, so that the matrix has blocks of 3 x 3. A component of a node that
!> is no free unknown has a row of its own with a diagonal entry alone.
module unknown_layout
  use kinds, only: rk
  implicit none
  private
  public :: row_layout, own_rows, num_rows
  public :: choose_solver, direct_solver, iterative_solver, compressed_solver

  integer, parameter :: choose_solver = 0 !< by the number of rows
  integer, parameter :: direct_solver = 1 !< MUMPS
  integer, parameter :: iterative_solver = 2 !< conjugate gradients
  integer, parameter :: compressed_solver = 3 !< the same, with a factor of low-rank blocks

  type :: row_layout
    integer, allocatable :: first_row(:) !< (ranks + 1) first row of each rank, from 0
    integer, allocatable :: row(:) !< (num_free) row of each free unknown, from 0
    logical, allocatable :: is_touched(:) !< (num_free) this rank adds to the row
    real(rk), allocatable :: rigid(:, :) !< (own rows, 6) motions of a rigid body [m]
    integer :: solver = choose_solver
    logical :: lacks_memory = .false. !< for the factor that its size would suggest
  end type row_layout

contains

  !> First and last row of a rank, from 0.
  pure function own_rows(layout, rank) result(bounds)
    type(row_layout), intent(in) :: layout
    integer, intent(in) :: rank !< from 0
    integer :: bounds(2)
    bounds = [layout%first_row(rank + 1), layout%first_row(rank + 2) - 1]
  end function own_rows

  !> Rows of all ranks.
  pure integer function num_rows(layout)
    type(row_layout), intent(in) :: layout
    num_rows = layout%first_row(size(layout%first_row))
  end function num_rows
end module unknown_layout
