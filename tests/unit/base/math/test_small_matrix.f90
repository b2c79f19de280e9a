!> Small matrices against their own definitions.
program test_small_matrix
  use kinds, only: rk
  use small_matrix, only: cross_product, determinant3, invert3, outer_product, solve_dense
  use testing, only: check, check_close, repeat_chance, test_log
  implicit none
  type(test_log) :: log
  log%suite = 'small_matrix'
  call repeat_chance(1)
  call three_by_three()
  call dense_systems()
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> Determinant, inverse, products.
  subroutine three_by_three()
    real(rk) :: a(3, 3), inverse(3, 3), unit(3, 3), determinant
    integer :: i
    a = reshape([2.0_rk, 1.0_rk, 0.0_rk, -1.0_rk, 3.0_rk, 1.0_rk, 0.5_rk, 0.0_rk, 4.0_rk], [3, 3])
    unit = 0.0_rk
    do i = 1, 3
      unit(i, i) = 1.0_rk
    end do
    call check_close(log, determinant3(a), 28.5_rk, 1.0e-14_rk, 'determinant')
    call invert3(a, inverse, determinant)
    call check_close(log, determinant, 28.5_rk, 1.0e-14_rk, 'determinant beside the inverse')
    call check_close(log, maxval(abs(matmul(a, inverse) - unit)), 0.0_rk, 1.0e-15_rk, 'inverse')
    a(:, 2) = 2.0_rk*a(:, 1)
    call invert3(a, inverse, determinant)
    call check(log, maxval(abs(inverse)) <= 0.0_rk .and. abs(determinant) <= 0.0_rk, 'singular')
    call check_close(log, norm2(cross_product([1.0_rk, 0.0_rk, 0.0_rk], &
                                              [0.0_rk, 1.0_rk, 0.0_rk]) - &
                                [0.0_rk, 0.0_rk, 1.0_rk]), 0.0_rk, 0.0_rk, 'cross product')
    a = outer_product([1.0_rk, 2.0_rk, 3.0_rk], [4.0_rk, 5.0_rk, 6.0_rk])
    call check_close(log, a(2, 3), 12.0_rk, 0.0_rk, 'outer product')
  end subroutine three_by_three

  !> Systems that need their pivots, and one without a solution.
  subroutine dense_systems()
    real(rk) :: a(6, 6), x(6, 2), b(6, 2), found(6, 2)
    logical :: is_singular
    call random_number(a)
    call random_number(x)
    a(1, 1) = 0.0_rk
    b = matmul(a, x)
    call solve_dense(a, b, found, is_singular)
    call check(log,.not. is_singular, 'regular')
    call check_close(log, maxval(abs(found - x)), 0.0_rk, 1.0e-11_rk, 'solution')
    a(:, 4) = 0.0_rk
    call solve_dense(a, b, found, is_singular)
    call check(log, is_singular, 'singular')
  end subroutine dense_systems
end program test_small_matrix
