!> The list of solvers of the equilibrium with joints: JOINT SOLVER of *CONTROLS. A new solver is a
!> file of its own, and here its `use`, its name and its line in `list_solvers`.
module equilibrium_catalogue
  use condensation, only: condensed_equilibrium
  use equilibrium, only: equilibrium_solver
  use newton_full, only: full_equilibrium
  implicit none
  private
  public :: make_joint_solver, names_of_joint_solvers, condensed_solver, full_solver

  character(*), parameter :: condensed_solver = 'CONDENSED' !< symmetric matrices only
  character(*), parameter :: full_solver = 'FULL'
  integer, parameter :: longest_name = 16, most_solvers = 10

  !> A solver that has not been prepared.
  type :: solver_entry
    character(longest_name) :: name
    class(equilibrium_solver), allocatable :: solver
  end type solver_entry

contains

  !> The list itself.
  subroutine list_solvers(entries, num_entries)
    type(solver_entry), intent(out) :: entries(most_solvers)
    integer, intent(out) :: num_entries
    type(condensed_equilibrium) :: condensed
    type(full_equilibrium) :: full
    num_entries = 0
    call add(condensed_solver, condensed)
    call add(full_solver, full)
  contains
    subroutine add(name, solver)
      character(*), intent(in) :: name
      class(equilibrium_solver), intent(in) :: solver
      num_entries = num_entries + 1
      entries(num_entries)%name = name
      allocate (entries(num_entries)%solver, source=solver)
    end subroutine add
  end subroutine list_solvers

  !> The solver of that name; it stays unallocated where no solver has the name.
  subroutine make_joint_solver(name, solver)
    character(*), intent(in) :: name !< upper case
    class(equilibrium_solver), allocatable, intent(out) :: solver
    type(solver_entry) :: entries(most_solvers)
    integer :: num_entries, i
    call list_solvers(entries, num_entries)
    do i = 1, num_entries
      if (entries(i)%name == name) call move_alloc(entries(i)%solver, solver)
    end do
  end subroutine make_joint_solver

  !> All names, as the choices of a parameter.
  function names_of_joint_solvers() result(choices)
    character(:), allocatable :: choices !< 'A | B'
    type(solver_entry) :: entries(most_solvers)
    integer :: num_entries, i
    call list_solvers(entries, num_entries)
    choices = trim(entries(1)%name)
    do i = 2, num_entries
      choices = choices//' | '//trim(entries(i)%name)
    end do
  end function names_of_joint_solvers
end module equilibrium_catalogue
