!> Anderson's acceleration of a linear iteration: it ends after as many steps as there are unknowns
!> that change, and takes the same steps when it works on these unknowns alone. Of an iteration with
!> kinks: it starts afresh where the change grows.
program test_anderson_mixing
  use anderson_mixing, only: mixer
  use kinds, only: rk
  use testing, only: check, check_close, repeat_chance, test_log
  implicit none
  integer, parameter :: num_unknowns = 40, steps = 7
  integer, parameter :: rows(*) = [2, 9, 17, 23, 31, 38]
  type(test_log) :: log
  type(mixer) :: all_rows, some_rows
  real(rk), dimension(num_unknowns) :: s, t, f
  real(rk) :: matrix(size(rows), size(rows)), right(size(rows))
  integer :: i
  log%suite = 'anderson_mixing'
  call repeat_chance(1)
  call random_number(matrix)
  call random_number(right)
  call random_number(s)
  t = s
  some_rows%rows = rows
  do i = 1, steps
    f = change(s)
    call all_rows%advance(f, s)
    f = change(t)
    call some_rows%advance(f, t)
  end do
  call check_close(log, maxval(abs(change(s))), 0.0_rk, 1.0e-6_rk, 'GMRES ends')
  call check_close(log, maxval(abs(s - t)), 0.0_rk, 1.0e-6_rk, 'the same with the rows alone')
  call starts_afresh(log)
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> Three changes, the last one larger: the step after it is the plain one, s + f; without a fresh
  !> start it is another. A change that grows within the next four iterations starts nothing.
  subroutine starts_afresh(log)
    type(test_log), intent(inout) :: log
    type(mixer) :: mixing
    real(rk) :: s(2), f(2), last(2)
    integer :: i
    do i = 1, 2
      call mixing%forget()
      mixing%starts_afresh = i == 1
      s = 0.0_rk
      call mixing%advance([1.0_rk, 0.0_rk], s)
      call mixing%advance([0.5_rk, 0.1_rk], s)
      call check(log, mixing%num_pairs == 1, 'a pair')
      last = s
      f = [0.4_rk, -2.0_rk]
      call mixing%advance(f, s)
      call check(log, (maxval(abs(s - last - f)) < 1.0e-14_rk) .eqv. i == 1, &
                 'a plain step after a fresh start')
      call mixing%advance(2.0_rk*f, s)
      call check(log, mixing%num_pairs == merge(1, 3, i == 1), 'pairs after a further growth')
    end do
  end subroutine starts_afresh

  !> g(s) - s, which is not zero in `rows` alone.
  function change(x) result(f)
    real(rk), intent(in) :: x(:)
    real(rk) :: f(size(x))
    f = 0.0_rk
    f(rows) = 0.3_rk*matmul(matrix, x(rows)) + right - x(rows)
  end function change
end program test_anderson_mixing
