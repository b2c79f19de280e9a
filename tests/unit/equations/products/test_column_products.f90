!> Products of a sparse symmetric matrix with many vectors against a dense product.
program test_column_products
  use column_products, only: multiply_columns
  use kinds, only: rk
  use matrix_pattern, only: pattern
  use testing, only: check_close, test_log
  implicit none
  integer, parameter :: n = 7, num_free = 5
  type(test_log) :: log
  type(pattern) :: matrix
  real(rk) :: values(2*n - 1), dense(n, n)
  integer :: columns
  log%suite = 'column_products'
  call make_matrix()
  do columns = 0, 19
    call compare(columns)
  end do
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> Each unknown is coupled with the next one. Two unknowns are prescribed.
  subroutine make_matrix()
    integer :: j
    matrix%num_total = n
    matrix%num_free = num_free
    matrix%column_start = [(2*j - 1, j=1, n), 2*n]
    matrix%row = [(j, j + 1, j=1, n - 1), n]
    values = [(real(j, rk), j=1, 2*n - 1)]
    dense = 0.0_rk
    dense(n, n) = values(2*n - 1)
    do j = 1, n - 1
      dense(j, j) = values(2*j - 1)
      dense(j + 1, j) = values(2*j)
      dense(j, j + 1) = values(2*j)
    end do
  end subroutine make_matrix

  !> Entries are small integers: their sums and products are exact.
  subroutine compare(columns)
    integer, intent(in) :: columns
    real(rk) :: x(num_free, columns), y(num_free, columns)
    integer :: i, j
    do j = 1, columns
      x(:, j) = [(real(mod(3*i + j*i, 11) - 5, rk), i=1, num_free)]
    end do
    call multiply_columns(matrix, values, x, y)
    call check_close(log, sum(abs(y - matmul(dense(:num_free, :num_free), x))), 0.0_rk, 0.0_rk, &
                     'free unknowns')
  end subroutine compare
end program test_column_products
