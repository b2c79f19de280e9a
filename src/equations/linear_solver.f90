!> What every linear solver can do. A distributed back end would come in behind this type.
module linear_solver
  use kinds, only: rk
  use errors, only: error_type, raise
  use matrix_pattern, only: pattern
  implicit none
  private
  public :: equation_solver

  type, abstract :: equation_solver
    integer :: failed_unknown = 0 !< whose pivot made the last factorisation fail, 0 for none
  contains
    procedure(analyse), deferred :: analyse
    procedure(factorise), deferred :: factorise
    procedure(solve), deferred :: solve
    procedure :: take_end
    procedure :: eliminate => solve_no_half
    procedure :: substitute => solve_no_half
  end type equation_solver

  abstract interface
    !> Orders the unknowns and plans the factor; once per pattern.
    subroutine analyse(self, matrix, error)
      import :: equation_solver, pattern, error_type
      implicit none
      class(equation_solver), intent(inout) :: self
      type(pattern), intent(in) :: matrix
      type(error_type), allocatable, intent(out) :: error
    end subroutine analyse

    !> Factors the free part of the matrix. Fails when it is singular or not positive definite and
    !> names the unknown.
    subroutine factorise(self, matrix, values, error)
      import :: equation_solver, pattern, error_type, rk
      implicit none
      class(equation_solver), intent(inout) :: self
      type(pattern), intent(in) :: matrix
      real(rk), intent(in) :: values(:)
      type(error_type), allocatable, intent(out) :: error
    end subroutine factorise

    !> Solves for each column of `b`, in place.
    subroutine solve(self, b, error)
      import :: equation_solver, error_type, rk
      implicit none
      class(equation_solver), intent(inout) :: self
      real(rk), intent(inout) :: b(:, :) !< (free unknowns, right-hand sides)
      type(error_type), allocatable, intent(out) :: error
    end subroutine solve
  end interface

contains

  !> The dense end of a factor L L^T whose last columns are the last unknowns. A solve can halt
  !> before it: `eliminate` gives y = L^-1 P b, `substitute` x = P^T L^-T y. Not every solver can.
  subroutine take_end(self, num_last, block, unknown, is_there)
    class(equation_solver), intent(in) :: self
    integer, intent(in) :: num_last !< unknowns at the end
    real(rk), allocatable, intent(out) :: block(:, :) !< (num_last, num_last) lower triangle
    integer, allocatable, intent(out) :: unknown(:) !< of each column of the block
    logical, intent(out) :: is_there
    allocate (block(0, 0), unknown(0))
    is_there = .false.
  end subroutine take_end

  !> One half of a solve, for solvers that have none.
  subroutine solve_no_half(self, b, error)
    class(equation_solver), intent(inout) :: self
    real(rk), intent(inout) :: b(:) !< (free unknowns)
    type(error_type), allocatable, intent(out) :: error
    call raise(error, 'this solver solves at once')
  end subroutine solve_no_half
end module linear_solver
