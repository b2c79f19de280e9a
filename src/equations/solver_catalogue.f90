!> The one list of equation solvers.
module solver_catalogue
  use errors, only: error_type, raise, system_failed
  use linear_solver, only: equation_solver
  use solver_cholmod, only: cholmod_solver
  use solver_petsc, only: petsc_solver
  use solver_umfpack, only: umfpack_solver
  implicit none
  private
  public :: make_solver, symmetric_solver, unsymmetric_solver

  character(*), parameter :: symmetric_solver = 'CHOLMOD' !< lower triangle, positive definite
  character(*), parameter :: unsymmetric_solver = 'UMFPACK' !< full pattern

contains

  !> The solver of that name; for a shared matrix the one that divides the factor among the ranks.
  subroutine make_solver(name, solver, error, is_shared)
    character(*), intent(in) :: name !< upper case
    class(equation_solver), allocatable, intent(out) :: solver
    type(error_type), allocatable, intent(out) :: error
    logical, intent(in), optional :: is_shared !< the matrix is a sum over all ranks
    if (present(is_shared)) then
      if (is_shared) allocate (petsc_solver :: solver)
      if (is_shared) return
    end if
    select case (name)
    case (symmetric_solver)
      allocate (cholmod_solver :: solver)
    case (unsymmetric_solver)
      allocate (umfpack_solver :: solver)
    case default
      call raise(error, "there is no equation solver '"//name//"'; expected "//symmetric_solver// &
                 ' or '//unsymmetric_solver, system_failed)
    end select
  end subroutine make_solver
end module solver_catalogue
