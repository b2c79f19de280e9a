!> Solves that repeat the upper part of a factor alone, against whole solves of a box of springs.
program test_active_solve
  use active_solve, only: repeated_solve
  use errors, only: error_type
  use global_vectors, only: multiply, norm
  use kinds, only: rk
  use matrix_pattern, only: pattern
  use solver_cholmod, only: cholmod_solver
  use spring_box, only: make_box
  use testing, only: check, check_close, test_log
  implicit none
  type(test_log) :: log
  !> Round-off of sums of some hundred products of numbers near one.
  real(rk), parameter :: roundoff = 1.0e-12_rk
  !> Unit round-off of single precision.
  real(rk), parameter :: rounding = 2.0_rk**(-24)
  log%suite = 'active_solve'
  call some_active()
  call all_active()
  call differences_in_single()
  call partial_differences()
  call nothing_admissible()
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
    call repeated%start(solver, 0.0_rk, rhs, error)
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

  !> Right-hand sides that change a little: the copy solves for the differences. Its rounding stays
  !> below the estimate, a solution further each time, but is seen.
  subroutine differences_in_single()
    type(pattern) :: matrix
    type(cholmod_solver) :: solver
    type(repeated_solve) :: repeated
    real(rk), allocatable :: values(:), rhs(:), x(:), last(:)
    real(rk) :: most, left
    integer :: k, pass
    call open_copy(matrix, values, solver, repeated)
    rhs = [(cos(real(k, rk)), k=1, matrix%num_free)]
    allocate (x(size(rhs)), last(size(rhs)), source=0.0_rk)
    most = 0.0_rk
    do pass = 1, 10
      last = x
      rhs = rhs + [(1.0e-3_rk*sin(real(pass*k, rk)), k=1, size(rhs))]
      call solve_next(solver, repeated, norm(rhs), rhs, .false., x)
      left = norm(rhs - forces_of(matrix, values, x))
      if (pass > 2) then
        most = most + rounding*norm(values(matrix%column_start(:size(rhs)))*(x - last))
        call check(log, left <= most, 'the estimate is an upper bound')
        call check(log, left >= 0.02_rk*most, 'the estimate is not far away')
      else
        call check_close(log, left, 0.0_rk, roundoff*norm(rhs), 'double precision at first')
      end if
    end do
    call check(log, repeated%describe() == '8 of the last 10 solutions in single precision '// &
               '(PRECISION=MIXED)', 'counted')
    call repeated%leave()
    call solve_next(solver, repeated, norm(rhs), rhs, .false., x)
    call check_close(log, norm(rhs - forces_of(matrix, values, x)), 0.0_rk, roundoff*norm(rhs), &
                     'double precision far from the last solution')
  end subroutine differences_in_single

  !> The same with active unknowns: three right-hand sides for each solution that is completed.
  subroutine partial_differences()
    type(pattern) :: matrix
    type(cholmod_solver) :: solver
    type(repeated_solve) :: repeated
    type(error_type), allocatable :: error
    real(rk), allocatable :: values(:), rhs(:), x(:), half(:)
    integer, allocatable :: active(:)
    integer :: k, pass, inner
    call open_copy(matrix, values, solver, repeated)
    active = [(k, k=1, matrix%num_free/20)]
    rhs = [(cos(real(k, rk)), k=1, matrix%num_free)]
    allocate (x(size(rhs)))
    call repeated%choose(solver, active, 0.0_rk*rhs)
    do pass = 1, 6
      rhs = rhs + [(1.0e-3_rk*sin(real(pass*k, rk)), k=1, size(rhs))]
      call solve_next(solver, repeated, norm(rhs), rhs, .true., x)
      do inner = 1, 2
        rhs(active) = rhs(active) + [(1.0e-3_rk*cos(real(inner*k, rk)), k=1, size(active))]
        half = rhs
        call repeated%forward(solver, half, error)
        call repeated%backward(solver, half, .true., x, error)
      end do
      call repeated%complete(solver, x, error)
      call check_close(log, norm(rhs - forces_of(matrix, values, x)), 0.0_rk, &
                       1.0e-6_rk*norm(rhs), 'balance of a completed solution')
    end do
    call check(log, repeated%describe() == '4 of the last 6 solutions in single precision '// &
               '(PRECISION=MIXED)', 'all but the first two')
    call check(log, allocated(error) .eqv. .false., 'no error')
  end subroutine partial_differences

  !> Where rounding is not admissible solutions are those in double precision.
  subroutine nothing_admissible()
    type(pattern) :: matrix
    type(cholmod_solver) :: solver
    type(repeated_solve) :: repeated
    real(rk), allocatable :: values(:), rhs(:), x(:)
    integer :: k, pass
    call open_copy(matrix, values, solver, repeated)
    rhs = [(cos(real(k, rk)), k=1, matrix%num_free)]
    allocate (x(size(rhs)))
    do pass = 1, 4
      rhs = rhs + [(1.0e-3_rk*sin(real(pass*k, rk)), k=1, size(rhs))]
      call solve_next(solver, repeated, 0.0_rk, rhs, .false., x)
      call check_close(log, norm(rhs - forces_of(matrix, values, x)), 0.0_rk, roundoff*norm(rhs), &
                       'double precision')
    end do
  end subroutine nothing_admissible

  !> A factor of the box with its copy.
  subroutine open_copy(matrix, values, solver, repeated)
    type(pattern), intent(out) :: matrix
    real(rk), allocatable, intent(out) :: values(:)
    type(cholmod_solver), intent(inout) :: solver
    type(repeated_solve), intent(inout) :: repeated
    type(error_type), allocatable :: error
    logical :: has_copy
    call make_box(matrix, values, 0)
    call solver%analyse(matrix, error)
    call solver%factorise(matrix, values, error)
    call solver%copy_single(has_copy)
    call check(log, has_copy, 'there is a copy')
    call repeated%open(solver, has_copy, values(matrix%column_start(:matrix%num_free)))
    call check(log, repeated%is_there(solver), 'solves can be repeated')
  end subroutine open_copy

  !> One right-hand side from its start.
  subroutine solve_next(solver, repeated, admissible, rhs, is_partial, x)
    type(cholmod_solver), intent(inout) :: solver
    type(repeated_solve), intent(inout) :: repeated
    real(rk), intent(in) :: admissible, rhs(:)
    logical, intent(in) :: is_partial
    real(rk), intent(out) :: x(:)
    type(error_type), allocatable :: error
    real(rk) :: half(size(rhs))
    half = rhs
    call repeated%start(solver, admissible, rhs, error)
    call repeated%forward(solver, half, error)
    call repeated%backward(solver, half, is_partial, x, error)
    call check(log, allocated(error) .eqv. .false., 'no error')
  end subroutine solve_next

  !> A x on the free unknowns.
  function forces_of(matrix, values, x) result(force)
    type(pattern), intent(in) :: matrix
    real(rk), intent(in) :: values(:), x(:)
    real(rk) :: force(size(x))
    real(rk), dimension(matrix%num_total) :: q, all_forces
    q = 0.0_rk
    q(:size(x)) = x
    call multiply(matrix, values, q, all_forces)
    force = all_forces(:size(x))
  end function forces_of
end program test_active_solve
