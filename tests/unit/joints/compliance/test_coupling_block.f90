!> Blocks of the compliance as products of narrow matrices: their error is the one that is allowed.
program test_coupling_block
  use coupling_block, only: dense_block, make_block
  use kinds, only: rk
  use testing, only: check, check_close, test_log
  implicit none

  integer, parameter :: m = 90, n = 60
  type(test_log) :: log
  real(rk) :: smooth(m, n), rough(m, n), x(n), y(m), z(n), allowed
  type(dense_block) :: block
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
  ! Rounding to single precision changes an entry by at most 6e-8 of itself; two matrices twice.
  allowed = 1.2e-7_rk*norm2(smooth)
  call make_block(smooth, 1.0e-3_rk, allowed, block)
  call check(log, allocated(block%left) .and. .not. allocated(block%values), 'smooth: narrow')
  call check(log, block%num_entries() <= 10*(m + n), 'smooth: low rank')
  call check(log, norm2(block%as_values() - smooth) <= allowed, 'smooth: accurate')
  y = 1.0_rk
  call block%add_to(x, y, .false.)
  call check(log, norm2(y - 1.0_rk - matmul(smooth, x)) <= 2.0_rk*allowed*norm2(x), 'product')
  z = 0.0_rk
  call block%add_transposed_to(y, z, .false.)
  call check(log, norm2(z - matmul(y, smooth)) <= 2.0_rk*allowed*norm2(y), &
             'transposed product')
  call check_rough_product('narrow')
  call make_block(smooth, 0.1_rk, allowed, block)
  call check(log, allocated(block%rounded) .and. allocated(block%left), 'strong: both')
  call check(log, norm2(block%as_values() - smooth) <= allowed, 'strong: accurate')
  call check_rough_product('strong')
  allowed = 6.0e-8_rk*norm2(rough)
  call make_block(rough, 1.0e-3_rk, allowed, block)
  call check(log, allocated(block%rounded), 'rough: dense, in single precision')
  call check_products(rough, allowed)
  call make_block(rough, 1.0e-3_rk, 1.0e-9_rk*norm2(rough), block)
  call check(log, allocated(block%values), 'rough: dense, in double precision')
  call check_products(rough, 1.0e-15_rk*norm2(rough))
  call make_block(smooth, 1.0e-3_rk, 0.0_rk, block)
  call check_close(log, norm2(block%as_values() - smooth), 0.0_rk, 0.0_rk, 'exact')
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1
contains
  !> A rough product takes fewer columns; its error is 1e-4 of the norm of the block, as it says,
  !> and what single precision adds.
  subroutine check_rough_product(name)
    character(*), intent(in) :: name
    real(rk) :: change(m), back(n)
    change = 0.0_rk
    call block%add_to(x, change, .true.)
    call check(log, norm2(change - matmul(smooth, x)) <= 1.01e-4_rk*norm2(smooth)*norm2(x), &
               name//': rough product')
    back = 0.0_rk
    call block%add_transposed_to(change, back, .true.)
    call check(log, norm2(back - matmul(change, smooth)) &
               <= 1.01e-4_rk*norm2(smooth)*norm2(change), name//': rough product, transposed')
    call check(log, block%rough_rank < 6, name//': rough rank')
  end subroutine check_rough_product

  !> Products with many and with few forces, in both directions.
  subroutine check_products(values, allowed)
    real(rk), intent(in) :: values(:, :), allowed
    real(rk) :: few(n), few_rows(m), change(m)
    change = 0.0_rk
    call block%add_to(x, change, .false.)
    call check(log, norm2(change - matmul(values, x)) <= 2.0_rk*allowed*norm2(x), 'many forces')
    few = 0.0_rk
    few(::7) = x(::7)
    change = 0.0_rk
    call block%add_to(few, change, .false.)
    call check(log, norm2(change - matmul(values, few)) <= 2.0_rk*allowed*norm2(few), 'few forces')
    few_rows = y
    call check_transposed(values, few_rows, allowed, 'many forces, transposed')
    few_rows = 0.0_rk
    few_rows(2::20) = y(2::20)
    few_rows(m) = y(m)
    call check_transposed(values, few_rows, allowed, 'few forces, transposed')
  end subroutine check_products

  subroutine check_transposed(values, force, allowed, name)
    real(rk), intent(in) :: values(:, :), force(:), allowed
    character(*), intent(in) :: name
    real(rk) :: change(n)
    change = 0.0_rk
    call block%add_transposed_to(force, change, .false.)
    call check(log, norm2(change - matmul(force, values)) <= 2.0_rk*allowed*norm2(force), name)
  end subroutine check_transposed
end program test_coupling_block
