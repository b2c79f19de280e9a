!> Principal values against tensors made from known ones, apart, near and equal.
program test_tensor6
  use kinds, only: rk
  use small_matrix, only: cross_product, determinant3
  use tensor6, only: as_matrix, find_principal_values, principal_axes, principal_values, &
                     second_invariant, sum_tensors, third_invariant, trace, von_mises
  use testing, only: check_close, repeat_chance, test_log
  implicit none
  real(rk), parameter :: roundoff = 20.0_rk*epsilon(1.0_rk) !< a few operations on the largest value
  type(test_log) :: log
  log%suite = 'tensor6'
  call repeat_chance(1)
  call simple_states()
  call invariants()
  call sums_of_tensors()
  call rotated_states()
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> The principal values of a tensor.
  subroutine expect(tensor, values, what)
    real(rk), intent(in) :: tensor(6), values(3)
    character(*), intent(in) :: what
    real(rk) :: found(3), axes(3, 3)
    call check_close(log, maxval(abs(principal_values(tensor) - values)), 0.0_rk, &
                     roundoff*max(maxval(abs(values)), tiny(1.0_rk)), what)
    call find_principal_values(1, tensor, found)
    call check_close(log, maxval(abs(found - values)), 0.0_rk, &
                     roundoff*max(maxval(abs(values)), tiny(1.0_rk)), what//': of many')
    call principal_axes(tensor, found, axes)
    call check_close(log, axes_error(tensor, found, axes), 0.0_rk, &
                     roundoff*max(maxval(abs(values)), tiny(1.0_rk)), what//': axes')
  end subroutine expect

  !> What is left of the tensor when it is built again of values and axes, and of the unit matrix
  !> when it is built of the axes, and how far the values are out of order.
  pure real(rk) function axes_error(tensor, values, axes) result(error)
    real(rk), intent(in) :: tensor(6), values(3), axes(3, 3)
    real(rk) :: scaled(3, 3), unit(3, 3)
    integer :: i
    unit = matmul(transpose(axes), axes)
    do i = 1, 3
      scaled(:, i) = values(i)*axes(:, i)
      unit(i, i) = unit(i, i) - 1.0_rk
    end do
    error = maxval(abs(matmul(scaled, transpose(axes)) - as_matrix(tensor)))
    error = max(error, maxval(abs(unit))*maxval(abs(values)))
    error = max(error, values(2) - values(1), values(3) - values(2))
  end function axes_error

  !> States whose principal values are known at sight.
  subroutine simple_states()
    real(rk), parameter :: o = 0.0_rk, one = 1.0_rk
    call expect([o, o, o, o, o, o], [o, o, o], 'nothing')
    call expect([one, one, one, o, o, o]*7.0_rk, [one, one, one]*7.0_rk, 'pressure')
    call expect([o, one, o, o, o, o], [one, o, o], 'tension')
    call expect([o, o, -one, o, o, o], [o, o, -one], 'compression')
    call expect([o, o, o, o, o, one], [one, o, -one], 'shear')
    call expect([o, o, o, one, one, one], [2.0_rk, -one, -one], 'three shears')
    call expect([one, 2.0_rk, 3.0_rk, o, o, o], [3.0_rk, 2.0_rk, one], 'diagonal')
    call expect([one, one, 1.0_rk + 1.0e-13_rk, o, o, o], [1.0_rk + 1.0e-13_rk, one, one], &
                'nearly a pressure')
    call expect([one, o, o, o, o, o]*1.0e-300_rk, [one, o, o]*1.0e-300_rk, 'tiny')
    call expect([one, o, o, o, o, o]*1.0e150_rk, [one, o, o]*1.0e150_rk, 'huge')
  end subroutine simple_states

  !> Invariants of a state of shear, and against the matrix.
  subroutine invariants()
    real(rk) :: t(6)
    t = [3.0_rk, -1.0_rk, 4.0_rk, 1.5_rk, -2.0_rk, 0.5_rk]
    call check_close(log, trace(t), 6.0_rk, 0.0_rk, 'trace')
    call check_close(log, second_invariant([0.0_rk, 0.0_rk, 0.0_rk, 2.0_rk, 0.0_rk, 0.0_rk]), &
                     4.0_rk, 0.0_rk, 'J2 of shear')
    t(1:3) = t(1:3) - 2.0_rk
    call check_close(log, third_invariant(t), determinant3(as_matrix(t)), 1.0e-13_rk, 'J3')
    call check_close(log, von_mises([5.0_rk, 0.0_rk, 0.0_rk, 0.0_rk, 0.0_rk, 0.0_rk]), 5.0_rk, &
                     1.0e-14_rk, 'von Mises')
  end subroutine invariants

  !> Sums of tensors are a product of matrices.
  subroutine sums_of_tensors()
    real(rk) :: tensors(6, 5), factors(5, 3), sums(6, 3)
    call random_number(tensors)
    call random_number(factors)
    call sum_tensors(5, tensors, factors, 3, sums)
    call check_close(log, maxval(abs(sums - matmul(tensors, factors))), 0.0_rk, roundoff, &
                     'sums of tensors')
  end subroutine sums_of_tensors

  !> Random axes, values that are apart, near or equal by turns: error a few units of roundoff.
  subroutine rotated_states()
    integer, parameter :: number = 3000
    real(rk) :: axes(3, 3), values(3), matrix(3, 3), chance(3), worst, worst_axes, tensor(6)
    real(rk) :: tensors(6, number), one_by_one(3, number), together(3, number)
    integer :: i, k
    worst = 0.0_rk
    worst_axes = 0.0_rk
    do i = 1, number
      call random_axes(axes)
      call random_number(chance)
      values = 1.0_rk
      values(2) = 1.0_rk - merge(chance(2)*10.0_rk**(-mod(i, 17)), 0.0_rk, mod(i, 3) > 0)
      values(3) = values(2) - merge(chance(3)*10.0_rk**(-mod(i, 11)), 0.0_rk, mod(i, 5) > 0)
      matrix = 0.0_rk
      do k = 1, 3
        matrix = matrix + values(k)*spread(axes(:, k), 2, 3)*spread(axes(:, k), 1, 3)
      end do
      tensor = [matrix(1, 1), matrix(2, 2), matrix(3, 3), matrix(1, 2), matrix(1, 3), matrix(2, 3)]
      worst = max(worst, maxval(abs(values - principal_values(tensor))))
      tensors(:, i) = tensor
      one_by_one(:, i) = principal_values(tensor)
      call principal_axes(tensor, values, axes)
      worst_axes = max(worst_axes, axes_error(tensor, values, axes))
    end do
    call check_close(log, worst, 0.0_rk, roundoff, 'random axes')
    call find_principal_values(number, tensors, together)
    call check_close(log, maxval(abs(together - one_by_one)), 0.0_rk, roundoff, 'of many')
    call check_close(log, worst_axes, 0.0_rk, roundoff, 'axes found')
  end subroutine rotated_states

  !> Three unit axes at right angles. Two directions that are almost parallel would leave axes that
  !> are at right angles only to round-off over the sine of their angle: they are drawn again.
  subroutine random_axes(axes)
    real(rk), intent(out) :: axes(3, 3)
    real(rk) :: sine
    do
      call random_number(axes)
      axes = axes - 0.5_rk
      axes(:, 1) = axes(:, 1)/norm2(axes(:, 1))
      axes(:, 2) = axes(:, 2)/norm2(axes(:, 2))
      axes(:, 3) = cross_product(axes(:, 1), axes(:, 2))
      sine = norm2(axes(:, 3))
      if (sine > 0.5_rk) exit
    end do
    axes(:, 3) = axes(:, 3)/sine
    axes(:, 2) = cross_product(axes(:, 3), axes(:, 1))
  end subroutine random_axes
end program test_tensor6
