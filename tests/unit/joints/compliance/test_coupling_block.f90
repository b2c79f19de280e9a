!> Blocks of the compliance as products of narrow matrices: their error is the one that is allowed.
program test_coupling_block
  use coupling_block, only: dense_block, make_block, transpose_block
  use kinds, only: rk
  use testing, only: check, check_close, test_log
  implicit none

  integer, parameter :: m = 90, n = 60
  type(test_log) :: log
  real(rk) :: smooth(m, n), rough(m, n), x(n), y(m), z(n)
  type(dense_block) :: block, turned
  integer :: i, j

  log%suite = 'coupling_block'
  do j = 1, n
    do i = 1, m
      smooth(i, j) = 1.0_rk/(3.0_rk + real(i, rk)/m + real(j, rk)/n)
      rough(i, j) = sin(12.9_rk*i*j + 0.7_rk*i)
    end do
  end do
  x = [(cos(0.3_rk*j), j=1, n)]
  z = [(sin(0.2_rk*i), i=1, n)]
  call make_block(smooth, 1.0e-3_rk, 1.0e-9_rk, block)
  call check(log, allocated(block%left) .and. .not. allocated(block%values), 'smooth: narrow')
  call check(log, block%num_entries() <= 10*(m + n), 'smooth: low rank')
  call check(log, norm2(block%as_values() - smooth) <= 1.0e-9_rk, 'smooth: accurate')
  y = 1.0_rk
  call block%add_to(x, y)
  call check(log, norm2(y - 1.0_rk - matmul(smooth, x)) <= 1.0e-9_rk*norm2(x), 'product')
  call transpose_block(block, turned)
  z = 0.0_rk
  call turned%add_to(y, z)
  call check(log, norm2(z - matmul(y, smooth)) <= 1.0e-9_rk*norm2(y), 'transposed product')
  call make_block(rough, 1.0e-3_rk, 1.0e-9_rk, block)
  call check(log, allocated(block%values), 'rough: dense')
  call make_block(smooth, 1.0e-3_rk, 0.0_rk, block)
  call check_close(log, norm2(block%as_values() - smooth), 0.0_rk, 0.0_rk, 'exact')
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1
end program test_coupling_block
