!> Solves of CHOLMOD alone, with the stiffness of the first step of a deck, joints closed:
!> bench_bare_solve DECK. Prints two lines, in the order of elimination of the program and in that
!> of METIS: entries of the factor, seconds of the factor and of each solve. The BLAS has
!> OPENBLAS_NUM_THREADS.
program bench_bare_solve
  use, intrinsic :: iso_c_binding, only: c_double, c_int, c_loc, c_null_ptr, c_ptr
  use kinds, only: rk
  use blas_threads, only: restart_with_fast_libraries
  use diagnostics, only: diagnostic_list
  use errors, only: error_type
  use joint_forces, only: reference_stiffness
  use joint_iteration, only: closed_tangent
  use problem_definition, only: problem
  use read_deck, only: read_problem
  use run_ledger, only: ledger
  use solver_cholmod, only: cholmod_solver
  use step_system, only: dam_system, build_structure
  implicit none
  integer, parameter :: num_solves = 30

  interface
    function bare_solve(n, start, used, row, values, order, count, entries, factor, &
                        seconds) result(status) bind(c)
      import :: c_int, c_double, c_ptr
      implicit none
      integer(c_int), value :: n, count
      integer(c_int), intent(in) :: start(n + 1), used(n), row(*)
      real(c_double), intent(in) :: values(*)
      type(c_ptr), value :: order
      real(c_double), intent(out) :: entries, factor, seconds(count)
      integer(c_int) :: status
    end function bare_solve
  end interface

  type(problem), allocatable, target :: model
  type(dam_system) :: system
  type(ledger) :: costs
  integer(c_int), allocatable, target :: order(:)
  call restart_with_fast_libraries(0)
  call build_matrix()
  call plan_order()
  call time_solves(c_loc(order))
  call time_solves(c_null_ptr)

contains

  !> Stiffness with closed joints.
  subroutine build_matrix()
    type(diagnostic_list) :: faults
    type(error_type), allocatable :: error
    character(:), allocatable :: echo
    real(rk), allocatable :: reference(:, :)
    character(400) :: path
    call get_command_argument(1, path)
    call read_problem(trim(path), model, faults, echo)
    if (faults%has_errors()) error stop 'the deck has faults'
    call costs%open()
    call build_structure(model, model%steps(1), system, costs, error)
    if (allocated(error)) error stop 'no stiffness'
    call reference_stiffness(model%joints, system%operator, reference)
    call system%operator%add_stiffness(closed_tangent(reference), system%matrix, system%stiffness)
  end subroutine build_matrix

  !> That of the program.
  subroutine plan_order()
    type(cholmod_solver) :: solver
    type(error_type), allocatable :: error
    call solver%analyse(system%matrix, error)
    if (allocated(error)) error stop 'no order of elimination'
    order = solver%order - 1
  end subroutine plan_order

  !> Rows and columns of CHOLMOD count from 0.
  subroutine time_solves(chosen)
    type(c_ptr), intent(in) :: chosen !< order of elimination
    integer(c_int), allocatable :: start(:), row(:)
    real(rk) :: entries, factor, seconds(num_solves)
    integer :: n
    n = system%matrix%num_free
    start = system%matrix%column_start(:n + 1) - 1
    row = system%matrix%row(:start(n + 1)) - 1
    if (bare_solve(n, start, system%matrix%free_entries(:n), row, system%stiffness, chosen, &
                   num_solves, entries, factor, seconds) /= 0) error stop 'no solution'
    write (*, '(*(1x,es12.5))') entries, factor, seconds
  end subroutine time_solves
end program bench_bare_solve
