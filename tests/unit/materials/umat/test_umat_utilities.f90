!> ROTSIG, SINV, SPRINC, SPRIND against tensors whose answers are known.
program test_umat_utilities
  use kinds, only: rk
  use testing, only: check, check_close, test_log
  use umat_utilities, only: rotsig, sinv, sprinc, sprind
  implicit none
  type(test_log) :: log
  real(rk), parameter :: round_off = 1.0e-14_rk !< some operations on numbers near one
  real(rk), parameter :: quarter_turn(3, 3) = reshape([0, 1, 0, -1, 0, 0, 0, 0, 1], [3, 3])*1.0_rk

  log%suite = 'umat_utilities'
  call turn(log)
  call invariants(log)
  call repeated_values(log)
  call directions(log)
  call fewer_components(log)
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> A quarter turn about axis 3 takes axis 1 to axis 2: 11 and 22 change places, 13 becomes 23.
  subroutine turn(log)
    type(test_log), intent(inout) :: log
    real(rk) :: found(6)
    call rotsig([1.0_rk, 2.0_rk, 3.0_rk, 4.0_rk, 5.0_rk, 6.0_rk], quarter_turn, found, 1, 3, 3)
    call check(log, maxval(abs(found - [2, 1, 3, -4, -6, 5])) <= round_off, 'stress turned')
    call rotsig([1.0_rk, 2.0_rk, 3.0_rk, 4.0_rk, 5.0_rk, 6.0_rk], quarter_turn, found, 2, 3, 3)
    call check(log, maxval(abs(found - [2, 1, 3, -4, -6, 5])) <= round_off, 'strain turned')
  end subroutine turn

  !> A bar under 3 with a shear of 4: mean 1, von Mises sqrt(9 + 3*16).
  subroutine invariants(log)
    type(test_log), intent(inout) :: log
    real(rk) :: mean, mises
    call sinv([3.0_rk, 0.0_rk, 0.0_rk, 0.0_rk, 4.0_rk, 0.0_rk], mean, mises, 3, 3)
    call check_close(log, mean, 1.0_rk, round_off, 'mean stress')
    call check_close(log, mises, sqrt(57.0_rk), 10.0_rk*round_off, 'von Mises')
  end subroutine invariants

  subroutine repeated_values(log)
    type(test_log), intent(inout) :: log
    real(rk) :: values(3)
    call sprinc([2.0_rk, 2.0_rk, 2.0_rk, 0.0_rk, 0.0_rk, 0.0_rk], values, 1, 3, 3)
    call check(log, maxval(abs(values - 2.0_rk)) <= round_off, 'hydrostatic')
    call sprinc([0.0_rk, 0.0_rk, 0.0_rk, 1.0_rk, 1.0_rk, 1.0_rk], values, 1, 3, 3)
    call check(log, maxval(abs(values - [2, -1, -1])) <= 4.0_rk*round_off, 'equal shears')
    call sprinc([0.0_rk, 0.0_rk, 0.0_rk, 2.0_rk, 2.0_rk, 2.0_rk], values, 2, 3, 3)
    call check(log, maxval(abs(values - [2, -1, -1])) <= 4.0_rk*round_off, 'equal gammas')
  end subroutine repeated_values

  !> The directions rebuild the tensor, and are a right or left system of unit vectors.
  subroutine directions(log)
    type(test_log), intent(inout) :: log
    real(rk), parameter :: s(6) = [3.0_rk, -1.0_rk, 0.5_rk, 0.7_rk, -2.0_rk, 0.2_rk]
    real(rk) :: values(3), axes(3, 3), matrix(3, 3)
    integer :: k
    call sprind(s, values, axes, 1, 3, 3)
    matrix = 0.0_rk
    do k = 1, 3
      matrix = matrix + values(k)*spread(axes(k, :), 2, 3)*spread(axes(k, :), 1, 3)
    end do
    call check(log, maxval(abs([matrix(1, 1), matrix(2, 2), matrix(3, 3), matrix(1, 2), &
                                matrix(1, 3), matrix(2, 3)] - s)) <= 10.0_rk*round_off, &
               'sum of value times axis times axis')
    matrix = matmul(axes, transpose(axes))
    call check(log, abs(sum(matrix**2) - 3.0_rk) <= 10.0_rk*round_off, 'unit vectors')
    call check(log, values(1) >= values(2) .and. values(2) >= values(3), 'the largest first')
  end subroutine directions

  !> Plane stress: 11, 22 and 12 only.
  subroutine fewer_components(log)
    type(test_log), intent(inout) :: log
    real(rk) :: values(3), mean, mises
    call sprinc([0.0_rk, 0.0_rk, 1.0_rk], values, 1, 2, 1)
    call check(log, maxval(abs(values - [1, 0, -1])) <= round_off, 'pure shear in a plane')
    call sinv([0.0_rk, 0.0_rk, 1.0_rk], mean, mises, 2, 1)
    call check_close(log, mises, sqrt(3.0_rk), round_off, 'von Mises in a plane')
  end subroutine fewer_components
end program test_umat_utilities
