!> Distributed equations of PETSc behind plain arguments: petsc_bridge.c, or without_petsc.c in the
!> plain program. All ranks call every procedure.
module petsc_equations
  use, intrinsic :: iso_c_binding, only: c_double, c_int, c_ptr, c_size_t
  implicit none
  private
  public :: has_petsc, start_petsc, plan_petsc, sum_petsc, factor_petsc, solve_petsc
  public :: finish_petsc
  public :: entries_of_petsc, memory_of_petsc, shift_of_petsc
  public :: take_petsc_patch, rows_of_petsc_patch, solve_petsc_patch, drop_petsc_patch
  public :: by_cholesky, by_iteration, by_lu, by_compressed
  public :: is_done, is_singular, is_slow

  integer(c_int), parameter :: by_cholesky = 1 !< L L^T by MUMPS
  !> Conjugate gradients with an incomplete factor and the motions of groups of nodes
  integer(c_int), parameter :: by_iteration = 2
  integer(c_int), parameter :: by_lu = 3 !< L U by MUMPS, of a matrix that is not symmetric
  !> Conjugate gradients with L L^T by MUMPS whose blocks have low rank
  integer(c_int), parameter :: by_compressed = 4
  integer(c_int), parameter :: is_done = 0, is_singular = 1, is_slow = 2 !< outcomes; else a failure

  interface
    !> Not 0 where the program is built with PETSc.
    function has_petsc() result(answer) bind(c, name='keyway_has_petsc')
      import :: c_int
      implicit none
      integer(c_int) :: answer
    end function has_petsc

    !> Fails with a null pointer where the program is built without PETSc.
    function start_petsc() result(handle) bind(c, name='keyway_petsc_start')
      import :: c_ptr
      implicit none
      type(c_ptr) :: handle
    end function start_petsc

    !> Plans a matrix from the places of what this rank adds: entries (by_lu), else blocks of 3 x 3
    !> in the upper triangle.
    function plan_petsc(handle, method, rows, rigid, entries, row, column) result(status) &
      bind(c, name='keyway_petsc_plan')
      import :: c_double, c_int, c_ptr, c_size_t
      implicit none
      type(c_ptr), value :: handle
      integer(c_int), value :: method, rows !< own rows
      real(c_double), intent(in) :: rigid(rows, 6)
      integer(c_size_t), value :: entries
      !> From 0; by_lu overwrites them
      integer(c_int), intent(inout) :: row(entries), column(entries)
      integer(c_int) :: status
    end function plan_petsc

    !> Sums what all ranks add.
    function sum_petsc(handle, values) result(status) bind(c, name='keyway_petsc_sum')
      import :: c_double, c_int, c_ptr
      implicit none
      type(c_ptr), value :: handle
      !> In the order of the plan; a block has nine, row by row
      ! allow(assumed-size)
      real(c_double), intent(in) :: values(*)
      integer(c_int) :: status
    end function sum_petsc

    !> Prepares the solver for the sum.
    function factor_petsc(handle) result(status) bind(c, name='keyway_petsc_factor')
      import :: c_int, c_ptr
      implicit none
      type(c_ptr), value :: handle
      integer(c_int) :: status
    end function factor_petsc

    !> Solves for the own rows of right-hand sides, in place. An iteration ends at a residual of
    !> 1e-10 of the right-hand side, or of `admissible` where that is larger.
    function solve_petsc(handle, rows, sides, admissible, b, iterations) result(status) &
      bind(c, name='keyway_petsc_solve')
      import :: c_double, c_int, c_ptr
      implicit none
      type(c_ptr), value :: handle
      integer(c_int), value :: rows, sides
      real(c_double), value :: admissible !< norm over all ranks
      real(c_double), intent(inout) :: b(rows, sides)
      integer(c_int), intent(out) :: iterations(sides)
      integer(c_int) :: status
    end function solve_petsc

    !> Entries of the factor or, without one, of the matrix, on this rank.
    function entries_of_petsc(handle) result(entries) bind(c, name='keyway_petsc_entries')
      import :: c_double, c_ptr
      implicit none
      type(c_ptr), value :: handle
      real(c_double) :: entries
    end function entries_of_petsc

    !> Memory of the last factor; 0 without one.
    subroutine memory_of_petsc(handle, memory) bind(c, name='keyway_petsc_memory')
      import :: c_int, c_ptr
      implicit none
      type(c_ptr), value :: handle
      integer(c_int), intent(out) :: memory(2) !< on one rank at most, on all ranks [MB]
    end subroutine memory_of_petsc

    !> What the diagonal has got more, relative to it, for the incomplete factor; 0 for the usual
    !> hundredth.
    function shift_of_petsc(handle) result(shift) bind(c, name='keyway_petsc_shift')
      import :: c_double, c_ptr
      implicit none
      type(c_ptr), value :: handle
      real(c_double) :: shift
    end function shift_of_petsc

    !> Takes the rows within some layers of neighbours of the rows `seed`, and factors their part of
    !> the matrix. A rank keeps its patch where it gives no seeds, and where the new one would have
    !> more rows than `most`.
    function take_petsc_patch(handle, layers, most, count, seed, rows) result(status) &
      bind(c, name='keyway_petsc_patch')
      import :: c_int, c_ptr
      implicit none
      type(c_ptr), value :: handle
      integer(c_int), value :: layers, most, count
      integer(c_int), intent(in) :: seed(count) !< from 0
      integer(c_int), intent(out) :: rows !< of the patch of this rank; 0: there are too many
      integer(c_int) :: status
    end function take_petsc_patch

    !> The rows of the patch of this rank.
    function rows_of_petsc_patch(handle, rows, row) result(status) &
      bind(c, name='keyway_petsc_patch_rows')
      import :: c_int, c_ptr
      implicit none
      type(c_ptr), value :: handle
      integer(c_int), value :: rows
      integer(c_int), intent(out) :: row(rows) !< from 0
      integer(c_int) :: status
    end function rows_of_petsc_patch

    !> Solves for columns over the patch of this rank, in place. Other ranks take no part.
    function solve_petsc_patch(handle, rows, sides, b) result(status) &
      bind(c, name='keyway_petsc_solve_patch')
      import :: c_double, c_int, c_ptr
      implicit none
      type(c_ptr), value :: handle
      integer(c_int), value :: rows, sides
      real(c_double), intent(inout) :: b(rows, sides)
      integer(c_int) :: status
    end function solve_petsc_patch

    !> Frees the patch of this rank.
    subroutine drop_petsc_patch(handle) bind(c, name='keyway_petsc_drop_patch')
      import :: c_ptr
      implicit none
      type(c_ptr), value :: handle
    end subroutine drop_petsc_patch

    subroutine finish_petsc(handle) bind(c, name='keyway_petsc_finish')
      import :: c_ptr
      implicit none
      type(c_ptr), value :: handle
    end subroutine finish_petsc
  end interface
end module petsc_equations
