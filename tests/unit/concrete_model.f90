!> Concretes that tests of the law share.
module concrete_model
  use damage_constants, only: concrete_constants
  use kinds, only: rk
  implicit none
  private
  public :: table_one, lee_fenves

contains

  !> Table 1 and constants of the paper, 30 MPa in compression (paper_notes.md, 9-12).
  pure function table_one() result(concrete)
    type(concrete_constants) :: concrete
    concrete%young = 25.0e9_rk
    concrete%poisson = 0.167_rk
    concrete%dilation = 32.5_rk
    concrete%offset = 0.01_rk
    concrete%biaxial_ratio = 1.125_rk
    concrete%meridian_ratio = 2.0_rk/3.0_rk
    concrete%tension_damage = reshape( &
                              [0.0_rk, 0.0_rk, 0.359_rk, 0.175e-3_rk, 0.62_rk, 0.324e-3_rk, &
                               0.756_rk, 0.469e-3_rk, 0.876_rk, 0.757e-3_rk, 0.924_rk, &
                               1.044e-3_rk, 0.949_rk, 1.33e-3_rk, 0.964_rk, 1.664e-3_rk], [2, 8])
    concrete%tension = concrete%tension_damage
    concrete%tension(1, :) = [2.48e6_rk, 0.858e6_rk, 0.545e6_rk, 0.415e6_rk, 0.294e6_rk, &
                              0.234e6_rk, 0.198e6_rk, 0.169e6_rk]
    concrete%compression = reshape([30.0e6_rk, 0.0_rk], [2, 1])
  end function table_one

  !> The concrete of Lee & Fenves (1998) as the blackbear suite has it: exponential laws
  !> f ((1 + a) exp(-b kappa) - a exp(-2 b kappa)), damage 1 - exp(-c kappa), tabulated. In tension
  !> a = 0.7; in compression from the ratio of peak and yield. b from the area, c from one damage.
  pure function lee_fenves() result(concrete)
    type(concrete_constants) :: concrete
    integer, parameter :: num_rows = 60
    real(rk) :: tension(2, num_rows), compression(2, num_rows)
    real(rk) :: damage_t(2, num_rows), damage_c(2, num_rows)
    concrete%young = 31.7e9_rk
    concrete%poisson = 0.18_rk
    concrete%dilation = 36.0_rk
    concrete%offset = 0.1_rk
    ! a, b = f (1 + a/2)/g; c: 0.51 at half the strength (x = 0.3424), 0.25 at the peak (0.6328).
    call tabulate(3.48e6_rk, 0.7_rk, 3.48e6_rk*1.35_rk/12.3e3_rk, log(0.49_rk)/log(0.3424_rk), &
                  tension, damage_t)
    call tabulate(18.3e6_rk, 3.767_rk, 18.3e6_rk*2.8835_rk/68.89e3_rk, &
                  log(0.75_rk)/log(0.6328_rk), compression, damage_c)
    concrete%tension = tension
    concrete%tension_damage = damage_t
    concrete%compression = compression
    concrete%compression_damage = damage_c
  contains
    !> Rows at even steps of plastic strain until bk = 6.
    pure subroutine tabulate(f, a, b, c_over_b, strength, damage)
      real(rk), intent(in) :: f, a, b, c_over_b
      real(rk), intent(out) :: strength(2, num_rows), damage(2, num_rows)
      real(rk) :: x
      integer :: i
      do i = 1, num_rows
        x = exp(-6.0_rk*(i - 1)/(num_rows - 1))
        strength(1, i) = f*((1.0_rk + a)*x - a*x**2)
        damage(1, i) = 1.0_rk - x**c_over_b
        strength(2, i) = -log(x)/b + damage(1, i)/(1.0_rk - damage(1, i))*strength(1, i)/31.7e9_rk
      end do
      damage(2, :) = strength(2, :)
    end subroutine tabulate
  end function lee_fenves
end module concrete_model
