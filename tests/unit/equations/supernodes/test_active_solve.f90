!> Solves that repeat the upper part of a factor alone, against whole solves of a box of springs.
program test_active_solve
  use active_solve, only: repeated_solve
  use errors, only: error_type
  use kinds, only: rk
  use matrix_pattern, only: pattern
  use solver_cholmod, only: cholmod_solver
  use spring_box, only: make_box
  use testing, only: check, check_close, test_log
  implicit none
  type(test_log) :: log
  !> Round-off of sums of some hundred products of numbers near one.
  real(rk), parameter :: roundoff = 1.0e-12_rk
  log%suite = 'active_solve'
  call some_active()
  call all_active()
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1
contains

  !> A corner of the box is active: three right-hand sides that differ there.
  subroutine some_active()
    type(pattern) :: matrix
    type(cholmod_solver) :: solver
    type(repeated_solve) :: repeated
    type(error_type), allocatable :: error
    real(rk), allocatable :: values(:), rhs(:), half(:), x(:), whole(:, :)
    integer, allocatable :: active(:)
    integer :: k, pass
    call make_box(matrix, values, 0)
    call solver%analyse(matrix, error)
    active = [(k, k=1, matrix%num_free/20)]
    rhs = [(cos(real(k, rk)), k=1, matrix%num_free)]
    call repeated%choose(solver, active, 0.0_rk*rhs)
    call check(log, repeated%is_there(solver), 'a corner is less than the whole')
    call solver%factorise(matrix, values, error)
    allocate (x(size(rhs)))
    call repeated%start(solver, rhs, error)
    do pass = 1, 3
      rhs(active) = rhs(active) + [(sin(real(pass*k, rk)), k=1, size(active))]
      whole = reshape(rhs, [size(rhs), 1])
      call solver%solve(whole, error)
      half = rhs
      call repeated%forward(solver, half, error)
      call repeated%backward(solver, half, pass > 1, x, error)
      call check_close(log, maxval(abs(x(active) - whole(active, 1))), 0.0_rk, roundoff, &
                       'active unknowns')
      if (pass == 1) call check_close(log, maxval(abs(x - whole(:, 1))), 0.0_rk, roundoff, 'all')
      if (pass == 2) call check(log, maxval(abs(x - whole(:, 1))) > 1.0e-6_rk, 'others stay')
    end do
    call repeated%complete(solver, x, error)
    call check_close(log, maxval(abs(x - whole(:, 1))), 0.0_rk, roundoff, 'completed')
    call check(log, allocated(error) .eqv. .false., 'no error')
  end subroutine some_active

  !> Nothing is gained where every unknown is active.
  subroutine all_active()
    type(pattern) :: matrix
    type(cholmod_solver) :: solver
    type(repeated_solve) :: repeated
    type(error_type), allocatable :: error
    real(rk), allocatable :: values(:)
    integer :: k
    call make_box(matrix, values, 0)
    call solver%analyse(matrix, error)
    call repeated%choose(solver, [(k, k=1, matrix%num_free)], 0.0_rk*values(:matrix%num_free))
    call check(log, repeated%is_there(solver) .eqv. .false., 'all unknowns are active')
  end subroutine all_active
end program test_active_solve
