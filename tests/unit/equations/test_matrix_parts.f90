!> A part of a matrix: the unknowns near a seed, and their rows and columns.
program test_matrix_parts
  use kinds, only: rk
  use matrix_parts, only: grow_part, list_neighbours, neighbour_lists, take_part
  use matrix_pattern, only: pattern, position_of
  use testing, only: check, check_close, test_log
  implicit none
  integer, parameter :: n = 12
  type(test_log) :: log
  type(pattern) :: chain, part
  type(neighbour_lists) :: neighbours
  real(rk), allocatable :: values(:), part_values(:)
  integer, allocatable :: unknown(:)
  integer :: j
  log%suite = 'matrix_parts'
  call make_chain(chain, values)
  call list_neighbours(chain, neighbours)
  call grow_part(neighbours, [5, 5], 2, unknown)
  call check(log, size(unknown) == 5, 'two layers on either side')
  call check(log, all(unknown == [(j, j=3, 7)]), 'ascending')
  call grow_part(neighbours, [2, n], 1, unknown)
  call check(log, all(unknown == [1, 2, 3, n - 1, n]), 'two seeds')
  call grow_part(neighbours, [integer ::], 3, unknown)
  call check(log, size(unknown) == 0, 'no seed')
  call grow_part(neighbours, [1, 4], 1, unknown)
  call take_part(chain, values, unknown, part, part_values)
  call check(log, part%num_free == 5 .and. part%num_total == 5, 'unknowns of the part')
  do j = 1, 5
    call check_close(log, part_values(part%column_start(j)), real(100*unknown(j), rk), 0.0_rk, &
                     'diagonal')
    if (j == 5) exit
    call check(log, part%free_entries(j) == 2, 'one neighbour below')
    call check_close(log, part_values(position_of(part, j + 1, j)), -real(unknown(j), rk), 0.0_rk, &
                     'entry of two neighbours')
  end do
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> A chain of n unknowns: 100 j on the diagonal, -j between j and j + 1.
  subroutine make_chain(matrix, values)
    type(pattern), intent(out) :: matrix
    real(rk), allocatable, intent(out) :: values(:)
    integer :: j
    matrix%num_free = n
    matrix%num_total = n
    matrix%column_start = [(2*j - 1, j=1, n), 2*n]
    matrix%free_entries = [(2, j=1, n - 1), 1]
    matrix%row = [([j, j + 1], j=1, n - 1), n]
    values = [([100.0_rk*j, -1.0_rk*j], j=1, n - 1), 100.0_rk*n]
  end subroutine make_chain
end program test_matrix_parts
