!> Products of a sparse matrix with one, two and many vectors against a dense product.
program test_column_products
  use column_products, only: multiply_columns, multiply_pair
  use global_vectors, only: multiply
  use kinds, only: rk
  use matrix_pattern, only: full_pattern, pattern, spread_values
  use testing, only: check_close, test_log
  implicit none
  integer, parameter :: n = 10, num_free = 8
  type(test_log) :: log
  type(pattern) :: lower, full
  real(rk), allocatable :: values(:), full_values(:)
  real(rk) :: dense(n, n)
  log%suite = 'column_products'
  call make_matrix()
  call compare(lower, values, 'symmetric')
  allocate (full_values(size(full%row)))
  call spread_values(lower, values, full, full_values)
  call compare(full, full_values, 'unsymmetric')
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> Unknowns 1 to 3 and 5 to 7 are nodes, whose columns are alike; 4, 8, 9 and 10 stand alone. Two
  !> unknowns are prescribed. Entries are small integers: their sums and products are exact.
  subroutine make_matrix()
    integer :: i, j, k
    lower%num_total = n
    lower%num_free = num_free
    lower%row = [1, 2, 3, 5, 6, 7, 10, 2, 3, 5, 6, 7, 10, 3, 5, 6, 7, 10, 4, 8, &
                 5, 6, 7, 9, 6, 7, 9, 7, 9, 8, 10, 9, 10]
    lower%column_start = [1, 8, 14, 19, 21, 25, 28, 30, 32, 33, 34]
    lower%alike = [3, 2, 1, 1, 3, 2, 1, 1, 1, 1]
    values = [(real(mod(7*i, 13) - 6, rk), i=1, size(lower%row))]
    call full_pattern(lower, full)
    dense = 0.0_rk
    do j = 1, n
      do k = lower%column_start(j), lower%column_start(j + 1) - 1
        dense(lower%row(k), j) = values(k)
        dense(j, lower%row(k)) = values(k)
      end do
    end do
  end subroutine make_matrix

  !> One vector, two vectors, and up to nineteen.
  subroutine compare(matrix, entries, what)
    type(pattern), intent(in) :: matrix
    real(rk), contiguous, intent(in) :: entries(:)
    character(*), intent(in) :: what
    real(rk), dimension(n) :: x1, x2, y1, y2
    integer :: i, columns
    x1 = [(real(mod(3*i, 11) - 5, rk), i=1, n)]
    x2 = [(real(mod(5*i, 7) - 3, rk), i=1, n)]
    call multiply(matrix, entries, x1, y1)
    call check_close(log, sum(abs(y1 - matmul(dense, x1))), 0.0_rk, 0.0_rk, what//', one vector')
    call multiply_pair(matrix, entries, x1, x2, y1, y2)
    call check_close(log, sum(abs(y1 - matmul(dense, x1))), 0.0_rk, 0.0_rk, what//', first')
    call check_close(log, sum(abs(y2 - matmul(dense, x2))), 0.0_rk, 0.0_rk, what//', second')
    do columns = 0, 19
      call compare_columns(matrix, entries, columns, what)
    end do
  end subroutine compare

  !> Prescribed unknowns are zero.
  subroutine compare_columns(matrix, entries, columns, what)
    type(pattern), intent(in) :: matrix
    real(rk), contiguous, intent(in) :: entries(:)
    integer, intent(in) :: columns
    character(*), intent(in) :: what
    real(rk) :: x(num_free, columns), y(num_free, columns)
    integer :: i, j
    do j = 1, columns
      x(:, j) = [(real(mod(3*i + j*i, 11) - 5, rk), i=1, num_free)]
    end do
    call multiply_columns(matrix, entries, x, y)
    call check_close(log, sum(abs(y - matmul(dense(:num_free, :num_free), x))), 0.0_rk, 0.0_rk, &
                     what//', columns')
  end subroutine compare_columns
end program test_column_products
