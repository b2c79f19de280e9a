!> The pattern of all symmetric matrices of a step: lower triangle by columns, free unknowns first.
!>
!> Stiffness, mass and damping share one pattern; each is only an array of values.
module matrix_pattern
  implicit none
  private
  public :: pattern

  type :: pattern
    integer :: num_free = 0 !< free unknowns come first
    integer :: num_total = 0 !< free and prescribed
    integer, allocatable :: column_start(:) !< (num_total + 1), 1-based
    integer, allocatable :: row(:) !< ascending in each column, the diagonal first
    integer, allocatable :: free_entries(:) !< entries of each column in rows <= num_free
  end type pattern
end module matrix_pattern
