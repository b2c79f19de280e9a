!> Equations of a sparse matrix plus one of low rank, A + U U^T, by the formula of Sherman, Morrison
!> and Woodbury:
!>
!>   x = y - Z (I + U^T Z)^-1 U^T y,   y = A^-1 b,   Z = A^-1 U
!>
!> A may be unsymmetric. The Schur block of A is not that of the sum and is not given.
module solver_low_rank
  use dense_factor, only: lu_factor, factorise_dense, solve_factored
  use errors, only: error_type, raise
  use global_vectors, only: dot
  use kinds, only: rk
  use linear_solver, only: equation_solver
  use matrix_pattern, only: pattern
  use unknown_parts, only: unknown_part
  implicit none
  private
  public :: low_rank_solver, add_low_rank

  type, extends(equation_solver) :: low_rank_solver
    class(equation_solver), allocatable :: sparse !< of A
    real(rk), allocatable :: u(:, :) !< (free unknowns, rank)
    real(rk), allocatable, private :: z(:, :) !< (free unknowns, rank) Z
    type(lu_factor), private :: small !< of I + U^T Z
    type(unknown_part), private :: part !< unknowns of this rank, where vectors are divided
  contains
    procedure :: analyse, factorise, solve, keep_single, describe_iterations
  end type low_rank_solver

contains

  !> Makes a solver one of A + U U^T from its next factorisation on.
  subroutine add_low_rank(u, solver)
    real(rk), allocatable, intent(in) :: u(:, :) !< (free unknowns, rank); not allocated: no change
    class(equation_solver), allocatable, intent(inout) :: solver
    type(low_rank_solver), allocatable :: wrapper
    if (.not. allocated(u)) return
    select type (solver)
    type is (low_rank_solver)
      solver%u = u
    class default
      allocate (wrapper)
      wrapper%u = u
    end select
    if (.not. allocated(wrapper)) return
    call move_alloc(solver, wrapper%sparse)
    call move_alloc(wrapper, solver)
  end subroutine add_low_rank

  !> Plans the factor of A.
  subroutine analyse(self, matrix, error)
    class(low_rank_solver), intent(inout) :: self
    type(pattern), intent(in) :: matrix
    type(error_type), allocatable, intent(out) :: error
    call self%sparse%analyse(matrix, error)
  end subroutine analyse

  !> Factors A and I + U^T Z.
  subroutine factorise(self, matrix, values, error)
    class(low_rank_solver), intent(inout) :: self
    type(pattern), intent(in) :: matrix
    real(rk), intent(in) :: values(:) !< of A
    type(error_type), allocatable, intent(out) :: error
    real(rk), allocatable :: small(:, :)
    integer :: k
    self%part = matrix%part
    call self%sparse%factorise(matrix, values, error)
    self%failed_unknown = self%sparse%failed_unknown
    if (allocated(error)) return
    self%z = self%u
    call self%sparse%solve(self%z, error)
    if (allocated(error)) return
    allocate (small(size(self%u, 2), size(self%u, 2)))
    call project(self%part, self%u, self%z, small)
    do k = 1, size(small, 1)
      small(k, k) = 1.0_rk + small(k, k)
    end do
    call factorise_dense(small, self%small)
    if (self%small%is_singular) call raise(error, 'the tangent is singular')
  end subroutine factorise

  !> Solves for each column of `b`, in place.
  subroutine solve(self, b, error)
    class(low_rank_solver), intent(inout) :: self
    real(rk), intent(inout) :: b(:, :)
    type(error_type), allocatable, intent(out) :: error
    real(rk) :: share(size(self%u, 2), size(b, 2))
    call self%sparse%solve_within(self%admissible, b, error)
    if (allocated(error)) return
    call project(self%part, self%u, b, share)
    call solve_factored(self%small, share)
    b = b - matmul(self%z, share)
  end subroutine solve

  !> Keeps the factor of A in single precision.
  subroutine keep_single(self, unknown, is_kept)
    class(low_rank_solver), intent(inout) :: self
    integer, intent(in) :: unknown(:)
    logical, intent(out) :: is_kept
    call self%sparse%keep_single(unknown, is_kept)
  end subroutine keep_single

  !> The iterations with A.
  function describe_iterations(self) result(text)
    class(low_rank_solver), intent(in) :: self
    character(:), allocatable :: text
    text = self%sparse%describe_iterations()
  end function describe_iterations

  !> U^T B.
  subroutine project(part, u, b, product)
    type(unknown_part), intent(in) :: part
    real(rk), intent(in) :: u(:, :), b(:, :)
    real(rk), intent(out) :: product(:, :)
    integer :: i, j
    do j = 1, size(b, 2)
      do i = 1, size(u, 2)
        product(i, j) = dot(part, u(:, i), b(:, j))
      end do
    end do
  end subroutine project
end module solver_low_rank
