!> Rayleigh damping C = alpha M + beta K from one ratio at two frequencies.
module damping_rayleigh
  use kinds, only: rk
  implicit none
  private
  public :: rayleigh_coefficients

  real(rk), parameter :: pi = acos(-1.0_rk)

contains

  !> The damping ratio is alpha/(2 w) + beta w/2; it is `ratio` at both frequencies.
  pure subroutine rayleigh_coefficients(ratio, f1, f2, alpha, beta)
    real(rk), intent(in) :: ratio !< of critical damping
    real(rk), intent(in) :: f1, f2 !< > 0 [Hz]
    real(rk), intent(out) :: alpha !< [1/s]
    real(rk), intent(out) :: beta !< [s]
    real(rk) :: w1, w2
    w1 = 2.0_rk*pi*f1
    w2 = 2.0_rk*pi*f2
    alpha = 2.0_rk*ratio*w1*w2/(w1 + w2)
    beta = 2.0_rk*ratio/(w1 + w2)
  end subroutine rayleigh_coefficients
end module damping_rayleigh
