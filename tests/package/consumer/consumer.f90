!> Principal stresses of pure shear, and a small system of equations solved by CHOLMOD.
program consumer
  use errors, only: error_type
  use kinds, only: rk
  use matrix_pattern, only: pattern
  use solver_cholmod, only: cholmod_solver
  use tensor6, only: principal_values
  implicit none
  type(cholmod_solver) :: solver
  type(pattern) :: chain
  type(error_type), allocatable :: error
  real(rk) :: force(3, 1)

  chain%num_free = 3
  chain%num_total = 3
  chain%column_start = [1, 3, 5, 6]
  chain%row = [1, 2, 2, 3, 3]
  chain%free_entries = [2, 2, 1]
  force(:, 1) = [1.0_rk, 0.0_rk, 1.0_rk] ! of a chain of springs between two walls: u = 1, 1, 1
  call solver%analyse(chain, error)
  if (.not. allocated(error)) then
    call solver%factorise(chain, [2.0_rk, -1.0_rk, 2.0_rk, -1.0_rk, 2.0_rk], error)
  end if
  if (.not. allocated(error)) call solver%solve(force, error)
  if (allocated(error)) error stop 'consumer: no solution'
  write (*, '(6f8.4)') force, principal_values([0.0_rk, 0.0_rk, 0.0_rk, 1.0_rk, 0.0_rk, 0.0_rk])
end program consumer
