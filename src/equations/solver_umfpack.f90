!> Unsymmetric equations by UMFPACK: the consistent tangent of sliding joints.
module solver_umfpack
  use, intrinsic :: iso_c_binding, only: c_associated, c_double, c_int, c_null_ptr, c_ptr
  use kinds, only: rk
  use errors, only: error_type, raise, system_failed
  use matrix_pattern, only: pattern
  use linear_solver, only: equation_solver
  use blas_threads, only: use_many_threads, use_one_thread
  implicit none
  private
  public :: umfpack_solver

  !> Indices in UMFPACK's list of settings and their values, from its manual.
  integer, parameter :: num_settings = 20, num_answers = 90
  integer, parameter :: at_strategy = 6, at_refinements = 8, at_ordering = 11
  real(rk), parameter :: is_nearly_symmetric = 3.0_rk, by_metis = 3.0_rk
  integer, parameter :: is_singular = 1, without_memory = -1, with_a = 0

  type, extends(equation_solver) :: umfpack_solver
    type(c_ptr), private :: plan = c_null_ptr, factor = c_null_ptr
    integer(c_int), allocatable, private :: start(:), row(:) !< the free part, 0-based
    integer, allocatable, private :: entry(:) !< where its values stand in the full matrix
    real(rk), allocatable, private :: values(:)
    real(rk), private :: settings(num_settings) = 0.0_rk
  contains
    procedure :: analyse, factorise, solve
    final :: release
  end type umfpack_solver

  ! Some of these procedures do not pass the lengths of their lists.
  ! allow(assumed-size)
  interface
    subroutine umfpack_di_defaults(settings) bind(c)
      import :: c_double
      implicit none
      real(c_double), intent(inout) :: settings(*)
    end subroutine umfpack_di_defaults

    function umfpack_di_symbolic(rows, columns, start, row, values, plan, settings, answers) &
      result(status) bind(c)
      import :: c_ptr, c_int, c_double
      implicit none
      integer(c_int), value :: rows, columns
      integer(c_int), intent(in) :: start(*), row(*)
      real(c_double), intent(in) :: values(*), settings(*)
      type(c_ptr), intent(inout) :: plan
      real(c_double), intent(inout) :: answers(*)
      integer(c_int) :: status
    end function umfpack_di_symbolic

    function umfpack_di_numeric(start, row, values, plan, factor, settings, answers) &
      result(status) bind(c)
      import :: c_ptr, c_int, c_double
      implicit none
      integer(c_int), intent(in) :: start(*), row(*)
      real(c_double), intent(in) :: values(*), settings(*)
      type(c_ptr), value :: plan
      type(c_ptr), intent(inout) :: factor
      real(c_double), intent(inout) :: answers(*)
      integer(c_int) :: status
    end function umfpack_di_numeric

    function umfpack_di_solve(sys, start, row, values, x, b, factor, settings, answers) &
      result(status) bind(c)
      import :: c_ptr, c_int, c_double
      implicit none
      integer(c_int), value :: sys
      integer(c_int), intent(in) :: start(*), row(*)
      real(c_double), intent(in) :: values(*), b(*), settings(*)
      real(c_double), intent(out) :: x(*)
      type(c_ptr), value :: factor
      real(c_double), intent(inout) :: answers(*)
      integer(c_int) :: status
    end function umfpack_di_solve

    subroutine umfpack_di_free_symbolic(plan) bind(c)
      import :: c_ptr
      implicit none
      type(c_ptr), intent(inout) :: plan
    end subroutine umfpack_di_free_symbolic

    subroutine umfpack_di_free_numeric(factor) bind(c)
      import :: c_ptr
      implicit none
      type(c_ptr), intent(inout) :: factor
    end subroutine umfpack_di_free_numeric
  end interface

contains

  !> Copies the free part of the full pattern. UMFPACK plans with the first values.
  subroutine analyse(self, matrix, error)
    class(umfpack_solver), intent(inout) :: self
    type(pattern), intent(in) :: matrix !< full, not symmetric
    type(error_type), allocatable, intent(out) :: error
    integer :: j, k, first
    if (matrix%is_symmetric) then
      call raise(error, 'UMFPACK needs both triangles of the matrix', system_failed)
      return
    end if
    call release(self)
    if (allocated(self%start)) deallocate (self%start, self%row, self%entry, self%values)
    allocate (self%start(matrix%num_free + 1))
    self%start(1) = 0
    do j = 1, matrix%num_free
      self%start(j + 1) = self%start(j) + matrix%free_entries(j)
    end do
    allocate (self%row(self%start(matrix%num_free + 1)))
    allocate (self%entry(size(self%row)), self%values(size(self%row)))
    do j = 1, matrix%num_free
      first = matrix%column_start(j)
      do k = 1, matrix%free_entries(j)
        self%entry(self%start(j) + k) = first + k - 1
        self%row(self%start(j) + k) = matrix%row(first + k - 1) - 1
      end do
    end do
  end subroutine analyse

  !> Factors the free part. Fails if this part is singular.
  subroutine factorise(self, matrix, values, error)
    class(umfpack_solver), intent(inout) :: self
    type(pattern), intent(in) :: matrix !< as analysed
    real(rk), intent(in) :: values(:)
    type(error_type), allocatable, intent(out) :: error
    real(rk) :: answers(num_answers)
    integer(c_int) :: status
    integer :: levels
    self%failed_unknown = 0
    if (matrix%num_free == 0) return
    self%values(:) = values(self%entry)
    call use_many_threads(levels)
    status = 0
    if (.not. c_associated(self%plan)) then
      call umfpack_di_defaults(self%settings)
      self%settings(at_strategy) = is_nearly_symmetric
      self%settings(at_ordering) = by_metis
      self%settings(at_refinements) = 0.0_rk
      status = umfpack_di_symbolic(matrix%num_free, matrix%num_free, self%start, self%row, &
                                   self%values, self%plan, self%settings, answers)
    end if
    if (c_associated(self%factor)) call umfpack_di_free_numeric(self%factor)
    if (status == 0) status = umfpack_di_numeric(self%start, self%row, self%values, self%plan, &
                                                 self%factor, self%settings, answers)
    call use_one_thread(levels)
    if (status == is_singular) then
      call raise(error, 'the tangent is singular')
    else if (status == without_memory) then
      call raise(error, 'no memory for the factor of the tangent', system_failed)
    else if (status /= 0) then
      call raise(error, 'UMFPACK failed to factor the tangent', system_failed)
    end if
  end subroutine factorise

  !> Solves for each column of `b`, in place.
  subroutine solve(self, b, error)
    class(umfpack_solver), intent(inout) :: self
    real(rk), intent(inout) :: b(:, :) !< (num_free, right-hand sides)
    type(error_type), allocatable, intent(out) :: error
    real(rk) :: answers(num_answers)
    real(rk), allocatable :: x(:)
    integer :: k
    integer(c_int) :: status
    if (size(b, 1) == 0) return
    allocate (x(size(b, 1)))
    do k = 1, size(b, 2)
      status = umfpack_di_solve(with_a, self%start, self%row, self%values, x, b(:, k), &
                                self%factor, self%settings, answers)
      b(:, k) = x
      if (status == 0) cycle
      call raise(error, 'UMFPACK failed to solve the equations', system_failed)
      return
    end do
  end subroutine solve

  !> Frees the memory of UMFPACK.
  subroutine release(self)
    type(umfpack_solver), intent(inout) :: self
    if (c_associated(self%factor)) call umfpack_di_free_numeric(self%factor)
    if (c_associated(self%plan)) call umfpack_di_free_symbolic(self%plan)
    self%factor = c_null_ptr
    self%plan = c_null_ptr
  end subroutine release
end module solver_umfpack
