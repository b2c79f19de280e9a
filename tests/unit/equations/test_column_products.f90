!> Products of a sparse matrix with one, two and many vectors against a dense product, and those of
!> a matrix that is taken in two parts against sums over its entries.
program test_column_products
  use column_products, only: multiply_columns, multiply_pair
  use global_vectors, only: multiply
  use kinds, only: rk
  use matrix_pattern, only: full_pattern, pattern, spread_values
  use omp_lib, only: omp_set_num_threads
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
  call compare_large(num_threads=1)
  call compare_large(num_threads=2)
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

  !> A matrix of more entries than one part has (fewest_for_parts in symmetric_product.c).
  subroutine compare_large(num_threads)
    integer, intent(in) :: num_threads
    type(pattern) :: chain
    real(rk), allocatable :: entries(:)
    real(rk), allocatable, dimension(:) :: x1, x2, y1, y2
    integer :: i
    call omp_set_num_threads(num_threads)
    call make_chain(chain, entries)
    x1 = [(real(mod(3*i, 11) - 5, rk), i=1, chain%num_total)]
    x2 = [(real(mod(5*i, 7) - 3, rk), i=1, chain%num_total)]
    allocate (y1, y2, mold=x1)
    call multiply(chain, entries, x1, y1)
    call check_close(log, sum(abs(y1 - sum_of_entries(chain, entries, x1))), 0.0_rk, 0.0_rk, &
                     'two parts, one vector')
    call multiply_pair(chain, entries, x1, x2, y1, y2)
    call check_close(log, sum(abs(y1 - sum_of_entries(chain, entries, x1))), 0.0_rk, 0.0_rk, &
                     'two parts, first')
    call check_close(log, sum(abs(y2 - sum_of_entries(chain, entries, x2))), 0.0_rk, 0.0_rk, &
                     'two parts, second')
    call compare_eight(chain, entries, x1)
  end subroutine compare_large

  !> A chain of nodes, each of which is joined to the next 24: 1 299 000 entries of small integers.
  subroutine make_chain(chain, entries)
    type(pattern), intent(out) :: chain
    real(rk), allocatable, intent(out) :: entries(:)
    integer, parameter :: num_nodes = 6000, neighbours = 24
    integer :: j, k, last
    chain%num_total = 3*num_nodes
    chain%num_free = chain%num_total
    chain%alike = [(3 - mod(j, 3), j=0, chain%num_total - 1)]
    allocate (chain%column_start(chain%num_total + 1), source=1)
    do j = 1, chain%num_total
      last = min(3*((j - 1)/3 + neighbours + 1), chain%num_total)
      chain%column_start(j + 1) = chain%column_start(j) + last - j + 1
    end do
    entries = [(real(mod(7*k, 13) - 6, rk), k=1, chain%column_start(chain%num_total + 1) - 1)]
    allocate (chain%row(size(entries)))
    do j = 1, chain%num_total
      do k = chain%column_start(j), chain%column_start(j + 1) - 1
        chain%row(k) = j + k - chain%column_start(j)
      end do
    end do
  end subroutine make_chain

  !> A x, entry by entry.
  pure function sum_of_entries(matrix, entries, x) result(y)
    type(pattern), intent(in) :: matrix !< symmetric
    real(rk), intent(in) :: entries(:), x(:)
    real(rk) :: y(size(x))
    integer :: j, k
    y = 0.0_rk
    do j = 1, matrix%num_total
      do k = matrix%column_start(j), matrix%column_start(j + 1) - 1
        y(matrix%row(k)) = y(matrix%row(k)) + entries(k)*x(j)
        if (matrix%row(k) /= j) y(j) = y(j) + entries(k)*x(matrix%row(k))
      end do
    end do
  end function sum_of_entries

  !> Eight columns.
  subroutine compare_eight(chain, entries, x1)
    type(pattern), intent(in) :: chain
    real(rk), contiguous, intent(in) :: entries(:)
    real(rk), intent(in) :: x1(:)
    real(rk) :: x(size(x1), 8), y(size(x1), 8)
    integer :: k
    do k = 1, 8
      x(:, k) = real(k, rk)*x1
    end do
    call multiply_columns(chain, entries, x, y)
    do k = 1, 8
      call check_close(log, sum(abs(y(:, k) - sum_of_entries(chain, entries, x(:, k)))), 0.0_rk, &
                       0.0_rk, 'two parts, eight vectors')
    end do
  end subroutine compare_eight
end program test_column_products
