!> Substitution by threads in subtrees of the factor: solutions of the equations with the same bits
!> for any number of threads, for the whole factor and for its parts.
program test_subtrees
  use active_solve, only: repeated_solve
  use errors, only: error_type
  use global_vectors, only: multiply
  use kinds, only: rk
  use matrix_pattern, only: pattern
  use omp_lib, only: omp_set_num_threads
  use solver_cholmod, only: cholmod_solver
  use spring_box, only: make_box
  use testing, only: check, check_close, test_log
  implicit none
  type(test_log) :: log
  !> Round-off of sums of some hundred products of numbers up to 100.
  real(rk), parameter :: roundoff = 1.0e-12_rk
  integer, parameter :: many(4) = [2, 3, 4, 7]
  integer, parameter :: nodes_of_side = 14 !< a factor that is worth waking threads up
  integer :: i, num_last
  log%suite = 'subtrees'
  do num_last = 0, 60, 60
    do i = 1, size(many)
      call compare(many(i), num_last)
    end do
  end do
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1
contains

  subroutine compare(num_threads, num_last)
    integer, intent(in) :: num_threads
    integer, intent(in) :: num_last !< unknowns at the end of the order
    real(rk), allocatable :: one(:, :), several(:, :)
    call solve_all(1, num_last, one)
    call solve_all(num_threads, num_last, several)
    call check(log, all(abs(one - several) <= 0.0_rk), 'the same bits')
  end subroutine compare

  !> A whole solution, and two of solves with a corner of the box active. One thread factors: the
  !> BLAS adds in another order with several.
  subroutine solve_all(num_threads, num_last, x)
    integer, intent(in) :: num_threads, num_last
    real(rk), allocatable, intent(out) :: x(:, :) !< (free unknowns, solves)
    type(pattern) :: matrix
    type(cholmod_solver) :: solver
    type(repeated_solve) :: repeated
    type(error_type), allocatable :: error
    real(rk), allocatable :: values(:), rhs(:), half(:), whole(:), left(:)
    integer, allocatable :: active(:)
    integer :: k, pass
    call make_box(matrix, values, num_last, nodes_of_side)
    call omp_set_num_threads(num_threads)
    call solver%analyse(matrix, error)
    call omp_set_num_threads(1)
    active = [(k, k=1, matrix%num_free/20)]
    rhs = [(cos(real(k, rk)), k=1, matrix%num_free)]
    allocate (x(size(rhs), 3))
    x(:, 1) = rhs
    call repeated%choose(solver, active, 0.0_rk*rhs)
    call solver%factorise(matrix, values, error)
    call solver%solve(x(:, 1:1), error)
    call repeated%start(solver, 0.0_rk, rhs, error)
    do pass = 2, 3
      rhs(active) = rhs(active) + [(sin(real(pass*k, rk)), k=1, size(active))]
      half = rhs
      call repeated%forward(solver, half, error)
      call repeated%backward(solver, half, .false., x(:, pass), error)
    end do
    call check(log, allocated(error) .eqv. .false., 'no error')
    allocate (left(matrix%num_total), whole(matrix%num_total), source=0.0_rk)
    whole(:matrix%num_free) = x(:, 3)
    call multiply(matrix, values, whole, left)
    call check_close(log, maxval(abs(left(:matrix%num_free) - rhs)), 0.0_rk, roundoff, 'residual')
  end subroutine solve_all
end program test_subtrees
