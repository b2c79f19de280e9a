!> UMFPACK on a box of springs with an unsymmetric addition, through the catalogue.
program test_solver_umfpack
  use kinds, only: rk
  use errors, only: error_type
  use testing, only: test_log, check, check_close
  use matrix_pattern, only: pattern, full_pattern, spread_values, multiply
  use linear_solver, only: equation_solver
  use solver_catalogue, only: make_solver, unsymmetric_solver
  use spring_box, only: make_box
  implicit none
  type(test_log) :: log
  type(pattern) :: lower, full
  class(equation_solver), allocatable :: solver
  type(error_type), allocatable :: error
  real(rk), allocatable :: values(:), full_values(:), q(:), b(:, :)
  integer :: j
  log%suite = 'solver_umfpack'
  call make_box(lower, values, 0)
  call full_pattern(lower, full)
  allocate (full_values(size(full%row)), q(full%num_total), b(full%num_total, 1))
  call spread_values(lower, values, full, full_values)
  full_values = full_values*[(1.0_rk + 0.01_rk*sin(real(j, rk)), j=1, size(full_values))]
  q = [(cos(real(j, rk)), j=1, size(q))]
  q(full%num_free + 1:) = 0.0_rk
  call make_solver(unsymmetric_solver, solver, error)
  call solver%analyse(lower, error)
  call check(log, allocated(error), 'a lower triangle is refused')
  call solver%analyse(full, error)
  call check(log, allocated(error) .eqv. .false., 'analyse')
  do j = 1, 2
    full_values = full_values*j
    call solver%factorise(full, full_values, error)
    call check(log, allocated(error) .eqv. .false., 'factorise')
    call multiply(full, full_values, q, b(:, 1))
    call solver%solve(b(:full%num_free, :), error)
    call check_close(log, maxval(abs(b(:full%num_free, 1) - q(:full%num_free))), 0.0_rk, &
                     1.0e-11_rk, 'K^-1 K q')
  end do
  full_values = 0.0_rk
  call solver%factorise(full, full_values, error)
  call check(log, allocated(error), 'a singular tangent is an error')
  call make_solver('MAGIC', solver, error)
  call check(log, allocated(error), 'an unknown solver is an error')
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1
end program test_solver_umfpack
