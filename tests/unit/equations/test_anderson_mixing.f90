!> Anderson's acceleration of a linear iteration: it ends after as many steps as there are unknowns
!> that change, and takes the same steps when it works on these unknowns alone.
program test_anderson_mixing
  use anderson_mixing, only: mixer
  use kinds, only: rk
  use testing, only: check_close, repeat_chance, test_log
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
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> g(s) - s, which is not zero in `rows` alone.
  function change(x) result(f)
    real(rk), intent(in) :: x(:)
    real(rk) :: f(size(x))
    f = 0.0_rk
    f(rows) = 0.3_rk*matmul(matrix, x(rows)) + right - x(rows)
  end function change
end program test_anderson_mixing
