!> The top of a factor: the supernodes with chosen unknowns, and all their ancestors in the
!> elimination tree. They are the factor of the Schur complement onto their unknowns. A solve that
!> changes forces on these unknowns alone, and wants these alone, needs no other part of the factor.
module factor_top
  use, intrinsic :: iso_c_binding, only: c_double, c_int, c_null_ptr, c_ptr
  use errors, only: error_type, raise, system_failed
  use kinds, only: rk
  implicit none
  private
  public :: top_of_factor, choose_top

  type :: top_of_factor
    logical :: is_there = .false.
    integer :: num_free = 0
    type(c_ptr), private :: handle = c_null_ptr !< of the solver, which must live as long
  contains
    procedure :: add_forces, solve_for_top, inverse_block, forget_inverse
    procedure :: start_inverse, expect, invert_for, release, first_supernode
  end type top_of_factor

  interface
    function keyway_cholmod_choose_top(handle, n, count, unknown) result(status) bind(c)
      import :: c_ptr, c_int
      implicit none
      type(c_ptr), value :: handle
      integer(c_int), value :: n, count
      integer(c_int), intent(in) :: unknown(count)
      integer(c_int) :: status
    end function keyway_cholmod_choose_top

    function keyway_cholmod_add_to_top(handle, n, b, y) result(status) bind(c)
      import :: c_ptr, c_int, c_double
      implicit none
      type(c_ptr), value :: handle
      integer(c_int), value :: n
      real(c_double), intent(in) :: b(n)
      real(c_double), intent(inout) :: y(n)
      integer(c_int) :: status
    end function keyway_cholmod_add_to_top

    function keyway_cholmod_solve_top(handle, n, y, x) result(status) bind(c)
      import :: c_ptr, c_int, c_double
      implicit none
      type(c_ptr), value :: handle
      integer(c_int), value :: n
      real(c_double), intent(in) :: y(n)
      real(c_double), intent(inout) :: x(n)
      integer(c_int) :: status
    end function keyway_cholmod_solve_top

    function keyway_cholmod_start_inverse(handle) result(status) bind(c)
      import :: c_ptr, c_int
      implicit none
      type(c_ptr), value :: handle
      integer(c_int) :: status
    end function keyway_cholmod_start_inverse

    subroutine keyway_cholmod_expect(handle, count, unknown, uses) bind(c)
      import :: c_ptr, c_int
      implicit none
      type(c_ptr), value :: handle
      integer(c_int), value :: count, uses
      integer(c_int), intent(in) :: unknown(count)
    end subroutine keyway_cholmod_expect

    function keyway_cholmod_first_super(handle, count, unknown) result(first) bind(c)
      import :: c_ptr, c_int
      implicit none
      type(c_ptr), value :: handle
      integer(c_int), value :: count
      integer(c_int), intent(in) :: unknown(count)
      integer(c_int) :: first
    end function keyway_cholmod_first_super

    function keyway_cholmod_invert_top(handle, first) result(status) bind(c)
      import :: c_ptr, c_int
      implicit none
      type(c_ptr), value :: handle
      integer(c_int), value :: first
      integer(c_int) :: status
    end function keyway_cholmod_invert_top

    function keyway_cholmod_inverse(handle, rows, row, columns, column, block) result(missing) &
      bind(c)
      import :: c_ptr, c_int, c_double
      implicit none
      type(c_ptr), value :: handle
      integer(c_int), value :: rows, columns
      integer(c_int), intent(in) :: row(rows), column(columns)
      real(c_double), intent(out) :: block(rows, columns)
      integer(c_int) :: missing
    end function keyway_cholmod_inverse

    subroutine keyway_cholmod_forget_inverse(handle) bind(c)
      import :: c_ptr
      implicit none
      type(c_ptr), value :: handle
    end subroutine keyway_cholmod_forget_inverse
  end interface

contains

  !> Chooses the top of a planned factor of CHOLMOD.
  subroutine choose_top(handle, num_free, unknown, top)
    type(c_ptr), intent(in) :: handle
    integer, intent(in) :: num_free
    integer, intent(in) :: unknown(:) !< that the top must hold
    type(top_of_factor), intent(out) :: top
    top%handle = handle
    top%num_free = num_free
    top%is_there = keyway_cholmod_choose_top(handle, num_free, size(unknown), unknown - 1) == 0
  end subroutine choose_top

  !> Adds forces on unknowns of the top to a forward substitution.
  subroutine add_forces(self, force, half, error)
    class(top_of_factor), intent(in) :: self
    real(rk), intent(in) :: force(:) !< (free unknowns) zero outside of the top
    real(rk), intent(inout) :: half(:) !< (free unknowns) in the order of elimination
    type(error_type), allocatable, intent(out) :: error
    if (keyway_cholmod_add_to_top(self%handle, self%num_free, force, half) /= 0) then
      call raise(error, 'no memory to solve the equations', system_failed)
    end if
  end subroutine add_forces

  !> The unknowns of the top that follow from a forward substitution; others stay.
  subroutine solve_for_top(self, half, x, error)
    class(top_of_factor), intent(in) :: self
    real(rk), intent(in) :: half(:) !< (free unknowns) in the order of elimination
    real(rk), intent(inout) :: x(:) !< (free unknowns)
    type(error_type), allocatable, intent(out) :: error
    if (keyway_cholmod_solve_top(self%handle, self%num_free, half, x) /= 0) then
      call raise(error, 'no memory to solve the equations', system_failed)
    end if
  end subroutine solve_for_top

  !> Starts the inverse of the matrix in the pattern of the top, without any of its entries.
  subroutine start_inverse(self, has_failed)
    class(top_of_factor), intent(in) :: self
    logical, intent(out) :: has_failed !< no memory
    has_failed = keyway_cholmod_start_inverse(self%handle) /= 0
  end subroutine start_inverse

  !> Announces a use of entries with some unknowns: they are held until their release.
  subroutine expect(self, unknown)
    class(top_of_factor), intent(in) :: self
    integer, intent(in) :: unknown(:) !< of the top
    call keyway_cholmod_expect(self%handle, size(unknown), unknown - 1, 1)
  end subroutine expect

  !> Computes the entries of the inverse with some unknowns, and those that these depend on.
  subroutine invert_for(self, unknown, has_failed)
    class(top_of_factor), intent(in) :: self
    integer, intent(in) :: unknown(:) !< of the top
    logical, intent(out) :: has_failed !< no memory
    has_failed = keyway_cholmod_invert_top(self%handle, self%first_supernode(unknown)) /= 0
  end subroutine invert_for

  !> Ends a use of entries with some unknowns; frees those that no other entry depends on.
  subroutine release(self, unknown)
    class(top_of_factor), intent(in) :: self
    integer, intent(in) :: unknown(:) !< of the top
    call keyway_cholmod_expect(self%handle, size(unknown), unknown - 1, -1)
  end subroutine release

  !> The first supernode with some unknowns; supernodes are inverted from the last to the first.
  integer function first_supernode(self, unknown) result(first)
    class(top_of_factor), intent(in) :: self
    integer, intent(in) :: unknown(:) !< of the top
    first = keyway_cholmod_first_super(self%handle, size(unknown), unknown - 1)
  end function first_supernode

  !> Entries of the inverse; those outside of the pattern are zero.
  subroutine inverse_block(self, row, column, block, missing)
    class(top_of_factor), intent(in) :: self
    integer, intent(in) :: row(:), column(:) !< unknowns of the top
    real(rk), intent(out) :: block(:, :) !< (rows, columns)
    integer, intent(out) :: missing !< entries outside of the pattern, -1: no memory
    missing = keyway_cholmod_inverse(self%handle, size(row), row - 1, size(column), column - 1, &
                                     block)
  end subroutine inverse_block

  !> Frees the inverse.
  subroutine forget_inverse(self)
    class(top_of_factor), intent(in) :: self
    call keyway_cholmod_forget_inverse(self%handle)
  end subroutine forget_inverse
end module factor_top
