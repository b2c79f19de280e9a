!> A sparse matrix plus one of low rank, with CHOLMOD and UMFPACK: products are inverted.
program test_solver_low_rank
  use errors, only: error_type
  use kinds, only: rk
  use linear_solver, only: equation_solver
  use matrix_pattern, only: full_pattern, multiply, pattern, spread_values
  use solver_catalogue, only: make_solver, symmetric_solver, unsymmetric_solver
  use solver_low_rank, only: add_low_rank
  use spring_box, only: make_box
  use testing, only: check, check_close, test_log
  implicit none
  type(test_log) :: log
  type(pattern) :: lower, full
  real(rk), allocatable :: values(:), full_values(:)
  integer :: j
  log%suite = 'solver_low_rank'
  call make_box(lower, values, 0)
  call full_pattern(lower, full)
  allocate (full_values(size(full%row)))
  call spread_values(lower, values, full, full_values)
  call invert(symmetric_solver, lower, values)
  full_values = full_values*[(1.0_rk + 0.01_rk*sin(real(j, rk)), j=1, size(full_values))]
  call invert(unsymmetric_solver, full, full_values)
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> Solves (A + s U U^T) x = b for a known x, with the columns changed once.
  subroutine invert(name, matrix, entries)
    character(*), intent(in) :: name
    type(pattern), intent(in) :: matrix
    real(rk), intent(in) :: entries(:)
    class(equation_solver), allocatable :: solver
    type(error_type), allocatable :: error
    real(rk), allocatable :: u(:, :), q(:), b(:, :), lower_part(:, :), product(:)
    integer, allocatable :: unknown(:)
    integer :: i, k
    logical :: is_there
    call make_solver(name, solver, error)
    call add_low_rank(u, solver)
    call solver%analyse(matrix, error)
    call check(log, allocated(error) .eqv. .false., name//': analyse')
    allocate (q(matrix%num_total), product(matrix%num_total), source=0.0_rk)
    allocate (b(matrix%num_free, 2))
    do k = 1, 2
      u = reshape(k*sqrt(maxval(abs(entries)))*[(sin(0.7_rk*i), i=1, 3*matrix%num_free)], &
                  [matrix%num_free, 3])
      call add_low_rank(u, solver)
      call solver%factorise(matrix, entries, error)
      call check(log, allocated(error) .eqv. .false., name//': factorise')
      do i = 1, 2
        q(:matrix%num_free) = [(cos(real(i*j, rk)), j=1, matrix%num_free)]
        call multiply(matrix, entries, q, product)
        b(:, i) = product(:matrix%num_free) + matmul(u, matmul(q(:matrix%num_free), u))
      end do
      call solver%solve(b, error)
      ! round-off times the condition of the matrix; the largest entry of q is 1
      call check_close(log, maxval(abs(b(:, 2) - q(:matrix%num_free))), 0.0_rk, 1.0e-10_rk, &
                       name//': inverse of the sum')
    end do
    call solver%take_schur_block(2, lower_part, unknown, is_there)
    call check(log,.not. is_there, name//': no Schur block')
  end subroutine invert
end program test_solver_low_rank
