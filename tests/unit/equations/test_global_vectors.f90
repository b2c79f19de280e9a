!> Scalar products, norms and matrix products against sums written out.
program test_global_vectors
  use kinds, only: rk
  use testing, only: test_log, check, check_close
  use matrix_pattern, only: pattern
  use global_vectors, only: dot, norm, distance, length, total, largest_entry, multiply, &
                            diagonal
  implicit none
  ! Entries are small integers: their sums and products are exact.
  real(rk), parameter :: exact = 0.0_rk
  type(test_log) :: log
  log%suite = 'global_vectors'
  call sums()
  call norms()
  call products()
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1
contains

  subroutine sums()
    real(rk) :: x(4), none(0)
    x = [1.0_rk, -2.0_rk, 4.0_rk, 2.0_rk]
    call check_close(log, dot(x, [3.0_rk, 1.0_rk, 1.0_rk, -2.0_rk]), 1.0_rk, exact, 'x . y')
    call check_close(log, dot(none, none), 0.0_rk, exact, 'product of empty vectors')
    call check_close(log, total(x), 5.0_rk, exact, 'sum of entries')
    call check_close(log, largest_entry(x), 4.0_rk, exact, 'largest entry')
  end subroutine sums

  subroutine norms()
    real(rk) :: x(4), y(4), none(0)
    ! norm2 divides by the largest entry: a few roundings.
    real(rk), parameter :: rounding = 8.0_rk*epsilon(1.0_rk)
    x = [1.0_rk, -2.0_rk, 4.0_rk, 2.0_rk]
    y = [1.0_rk, 1.0_rk, 0.0_rk, 2.0_rk]
    call check_close(log, norm(x), 5.0_rk, 5.0_rk*rounding, 'norm of a vector')
    call check_close(log, length(x), 5.0_rk, 5.0_rk*rounding, 'length of a vector')
    call check_close(log, norm(reshape(x, [2, 2])), norm(x), exact, 'norm of a field')
    call check_close(log, distance(x, y), 5.0_rk, 5.0_rk*rounding, 'distance of vectors')
    call check_close(log, distance(reshape(x, [2, 2]), reshape(y, [2, 2])), distance(x, y), exact, &
                     'distance of fields')
    call check_close(log, norm(none), 0.0_rk, exact, 'norm of an empty vector')
    call check_close(log, norm(1.0e200_rk*x)/1.0e200_rk, 5.0_rk, 5.0_rk*rounding, &
                     'the squares of these entries would overflow')
  end subroutine norms

  !> The lower triangle of [[2, 1, 0], [1, 3, 4], [0, 4, 5]].
  subroutine products()
    type(pattern) :: matrix
    real(rk) :: y(3)
    real(rk), parameter :: values(5) = [2.0_rk, 1.0_rk, 3.0_rk, 4.0_rk, 5.0_rk]
    matrix%num_total = 3
    matrix%num_free = 3
    matrix%column_start = [1, 3, 5, 6]
    matrix%row = [1, 2, 2, 3, 3]
    matrix%alike = [1, 1, 1]
    call multiply(matrix, values, [1.0_rk, 2.0_rk, 3.0_rk], y)
    call check(log, all(abs(y - [4.0_rk, 19.0_rk, 23.0_rk]) <= exact), 'A x')
    call diagonal(matrix, values, y)
    call check(log, all(abs(y - [2.0_rk, 3.0_rk, 5.0_rk]) <= exact), 'the diagonal of A')
  end subroutine products
end program test_global_vectors
