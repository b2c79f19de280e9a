!> A factor in single precision, refined: solutions as with a factor in double precision, with and
!> without a part that stays in double precision, and for a matrix beyond single precision.
program test_refined_solve
  use errors, only: error_type
  use kinds, only: rk
  use matrix_pattern, only: pattern
  use refined_solve, only: exact_matrix
  use solver_cholmod, only: cholmod_solver
  use spring_box, only: make_box
  use testing, only: check, check_close, test_log
  implicit none
  type(test_log) :: log
  !> Of sums of some hundred products of numbers near one.
  real(rk), parameter :: roundoff = 1.0e-12_rk
  log%suite = 'refined_solve'
  call compare(0, 1.0_rk, 'all in single precision')
  call compare(200, 1.0_rk, 'a part in double precision')
  call compare(0, 1.0e9_rk, 'a stiff unknown in each ten')
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1
contains

  !> Solutions and halves of solves; every tenth unknown has a spring to the ground of its own.
  subroutine compare(num_double, spring, what)
    integer, intent(in) :: num_double
    real(rk), intent(in) :: spring
    character(*), intent(in) :: what
    type(pattern) :: matrix
    type(cholmod_solver) :: solver
    type(exact_matrix) :: exact
    type(error_type), allocatable :: error
    real(rk), allocatable :: values(:), none(:, :), x(:), whole(:, :), rough(:, :)
    real(rk) :: size_of
    integer :: k, pass
    call make_box(matrix, values, 0)
    do k = 1, matrix%num_free, 10
      values(matrix%column_start(k)) = values(matrix%column_start(k)) + spring
    end do
    call solver%analyse(matrix, error)
    do pass = 1, 3
      call solver%factorise(matrix, values, error)
      x = [(cos(real(pass*k, rk)), k=1, matrix%num_free)]
      whole = reshape(x, [size(x), 1])
      rough = whole
      call solver%solve(whole, error)
      size_of = maxval(abs(whole))
      call exact%round_factor(matrix, values, none, [(k, k=1, num_double)], solver)
      call check(log, exact%is_rounded(), what//': is rounded')
      call solver%solve(rough, error)
      call check(log, maxval(abs(rough - whole)) > roundoff*size_of, what//': 7 digits')
      call exact%solve(solver, 0.0_rk, x, error)
      call check(log, allocated(error) .eqv. .false., what//': no error')
      call check_close(log, maxval(abs(x - whole(:, 1)))/size_of, 0.0_rk, roundoff, what)
      if (pass == 2) values = 2.0_rk*values
      call exact%forget()
      call check(log,.not. exact%is_rounded(), what//': forgotten')
    end do
  end subroutine compare
end program test_refined_solve
