!> What every linear solver can do. A distributed back end would come in behind this type.
module linear_solver
  use kinds, only: rk
  use errors, only: error_type
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
end module linear_solver
