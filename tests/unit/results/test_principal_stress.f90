!> Principal values against known tensors, also with double roots.
program test_principal_stress
  use kinds, only: rk
  use principal_stress, only: principal_values
  use testing, only: test_log, check_close
  implicit none
  type(test_log) :: log
  real(rk) :: values(3)
  log%suite = 'principal_stress'
  ! Uniaxial along (1,1,1)/sqrt(3): a double root at zero.
  values = principal_values([1.0_rk, 1.0_rk, 1.0_rk, 1.0_rk, 1.0_rk, 1.0_rk])
  call compare(log, values, [3.0_rk, 0.0_rk, 0.0_rk], 'uniaxial')
  values = principal_values([2.0_rk, 2.0_rk, 5.0_rk, -1.0_rk, 0.0_rk, 0.0_rk])
  call compare(log, values, [5.0_rk, 3.0_rk, 1.0_rk], 'plane')
  values = principal_values([-1.0_rk, -1.0_rk, -1.0_rk, 0.0_rk, 0.0_rk, 0.0_rk])
  call compare(log, values, [-1.0_rk, -1.0_rk, -1.0_rk], 'pressure')
  values = principal_values([0.0_rk, 0.0_rk, 0.0_rk, 2.0_rk, 0.0_rk, 0.0_rk])
  call compare(log, values, [2.0_rk, 0.0_rk, -2.0_rk], 'shear')
  values = principal_values([1.0_rk, 4.0_rk, 6.0_rk, 2.0_rk, 3.0_rk, 5.0_rk])
  call compare(log, values, [11.344814282762078_rk, 0.17091518882718_rk, -0.515729471589257_rk], &
               'full')
  print '(i0,a,i0,a)', log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> Three values, to roundoff of the largest.
  subroutine compare(log, found, expected, what)
    type(test_log), intent(inout) :: log
    real(rk), intent(in) :: found(3), expected(3)
    character(*), intent(in) :: what
    integer :: i
    do i = 1, 3
      call check_close(log, found(i), expected(i), 1.0e-13_rk*maxval(abs(expected)), what)
    end do
  end subroutine compare
end program test_principal_stress
