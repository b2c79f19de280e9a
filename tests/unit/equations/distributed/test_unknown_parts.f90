!> Products and norms of a vector of which a rank owns some unknowns. In one process the sum over
!> the ranks is what this rank has.
program test_unknown_parts
  use global_vectors, only: dot, largest_entry, length, norm, total, work
  use kinds, only: rk
  use testing, only: check, check_close, test_log
  use unknown_parts, only: runs_of, unknown_part
  implicit none
  type(test_log) :: log
  type(unknown_part) :: whole, part
  !> Of eight unknowns the rank owns 2, 3, 6, 7 and 8. The last two are prescribed.
  logical, parameter :: is_own(8) = [.false., .true., .true., .false., .false., .true., .true., &
                                     .true.]
  !> Round-off of a sum of five products.
  real(rk), parameter :: roundoff = 1.0e-14_rk
  real(rk) :: x(8), y(8)
  integer :: k

  log%suite = 'unknown_parts'
  part%is_divided = .true.
  part%run = runs_of(is_own)
  allocate (part%common(0), part%neighbour(0), part%border(0), part%shared(0))
  part%first = [1]
  x = [(sqrt(real(k, rk)), k=1, 8)]
  y = [(1.0_rk - 0.3_rk*k, k=1, 8)]
  call check(log, all(part%run == reshape([2, 3, 6, 8], [2, 2])), 'runs')
  call own_entries_count()
  call slices_know_where_they_start()
  call some_rows_of_a_part()
  call whole_vectors_count_all()
  call check(log, size(runs_of([logical ::])) == 0, 'runs of nothing')
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> Each function is that of the own entries.
  subroutine own_entries_count()
    real(rk), allocatable :: a(:), b(:)
    a = pack(x, is_own)
    b = pack(y, is_own)
    call check_close(log, dot(part, x, y), dot_product(a, b), roundoff, 'dot')
    call check_close(log, norm(part, x), norm2(a), roundoff, 'norm')
    call check_close(log, length(part, x), norm2(a), roundoff, 'length')
    call check_close(log, total(part, y), sum(b), roundoff, 'total')
    call check_close(log, largest_entry(part, x), maxval(x), 0.0_rk, 'largest')
    call check_close(log, work(part, x, y, 2.0_rk*y), 1.5_rk*dot_product(a, b), roundoff, 'work')
  end subroutine own_entries_count

  !> The first six are free, the others prescribed.
  subroutine slices_know_where_they_start()
    call check_close(log, dot(part, x(:6), y(:6)), x(2)*y(2) + x(3)*y(3) + x(6)*y(6), roundoff, &
                     'free ones')
    call check_close(log, dot(part, x(7:), y(7:), skipped=6), x(7)*y(7) + x(8)*y(8), roundoff, &
                     'prescribed ones')
    call check_close(log, dot(part, x(4:5), y(4:5), skipped=3), 0.0_rk, 0.0_rk, 'none')
  end subroutine slices_know_where_they_start

  !> A vector over the unknowns 1, 3, 4, 6 and 8.
  subroutine some_rows_of_a_part()
    integer, parameter :: rows(5) = [1, 3, 4, 6, 8]
    type(unknown_part) :: some
    some = part%of_rows(rows)
    call check_close(log, dot(some, x(rows), y(rows)), x(3)*y(3) + x(6)*y(6) + x(8)*y(8), &
                     roundoff, 'some rows')
  end subroutine some_rows_of_a_part

  !> Without a division all entries count, bit by bit as without ranks.
  subroutine whole_vectors_count_all()
    call check_close(log, dot(whole, x, y), dot_product(x, y), 0.0_rk, 'dot of whole vectors')
    call check_close(log, norm(whole, x), norm2(x), 0.0_rk, 'norm of whole vectors')
    call check(log, all(whole%owns(8)), 'all are own')
  end subroutine whole_vectors_count_all
end program test_unknown_parts
