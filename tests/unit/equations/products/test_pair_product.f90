!> The product of a matrix with two vectors against two products with one.
program test_pair_product
  use global_vectors, only: multiply
  use kinds, only: rk
  use matrix_pattern, only: full_pattern, pattern, spread_values
  use pair_product, only: multiply_pair
  use testing, only: check_close, test_log
  implicit none
  integer, parameter :: n = 10
  type(test_log) :: log
  type(pattern) :: lower, full
  real(rk), allocatable :: values(:), full_values(:)
  log%suite = 'pair_product'
  call make_matrix()
  call compare(lower, values, 'symmetric')
  allocate (full_values(size(full%row)))
  call spread_values(lower, values, full, full_values)
  call compare(full, full_values, 'unsymmetric')
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> Unknowns 1 to 3 and 5 to 7 are nodes, whose columns are alike; 4, 8, 9 and 10 stand alone.
  subroutine make_matrix()
    integer :: i
    lower%num_total = n
    lower%num_free = n
    lower%row = [1, 2, 3, 5, 6, 7, 10, 2, 3, 5, 6, 7, 10, 3, 5, 6, 7, 10, 4, 8, &
                 5, 6, 7, 9, 6, 7, 9, 7, 9, 8, 10, 9, 10]
    lower%column_start = [1, 8, 14, 19, 21, 25, 28, 30, 32, 33, 34]
    lower%alike = [3, 2, 1, 1, 3, 2, 1, 1, 1, 1]
    values = [(real(mod(7*i, 13) - 6, rk), i=1, size(lower%row))]
    call full_pattern(lower, full)
  end subroutine make_matrix

  !> Entries are small integers: their sums and products are exact.
  subroutine compare(matrix, entries, what)
    type(pattern), intent(in) :: matrix
    real(rk), contiguous, intent(in) :: entries(:)
    character(*), intent(in) :: what
    real(rk), dimension(n) :: x1, x2, y1, y2, product
    integer :: i
    x1 = [(real(mod(3*i, 11) - 5, rk), i=1, n)]
    x2 = [(real(mod(5*i, 7) - 3, rk), i=1, n)]
    call multiply_pair(matrix, entries, x1, x2, y1, y2)
    call multiply(matrix, entries, x1, product)
    call check_close(log, sum(abs(y1 - product)), 0.0_rk, 0.0_rk, what//', first vector')
    call multiply(matrix, entries, x2, product)
    call check_close(log, sum(abs(y2 - product)), 0.0_rk, 0.0_rk, what//', second vector')
  end subroutine compare
end program test_pair_product
