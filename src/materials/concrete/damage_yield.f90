!> Yield surface, damage and share of tension of plastic-damage concrete, in principal effective
!> stresses s_1 >= s_2 >= s_3 (tension positive; p positive in compression).
module damage_yield
  use damage_model, only: concrete_model
  use kinds, only: rk
  implicit none
  private
  public :: yield_value, yield_at, tension_share, total_damage, damage_gradient

  !> F of Eq. 19 and its derivatives.
  type :: yield_value
    real(rk) :: value = 0.0_rk !< F [Pa]
    real(rk) :: by_q = 0.0_rk, by_p = 0.0_rk, by_largest = 0.0_rk !< dF/dq, dF/dp, dF/ds_1
    real(rk) :: by_tension = 0.0_rk, by_compression = 0.0_rk !< by the effective strengths
  end type yield_value

  !> d of Eq. 15 and its derivatives.
  type :: damage_gradient
    real(rk) :: value = 0.0_rk
    real(rk) :: by_tension = 0.0_rk, by_compression = 0.0_rk, by_share = 0.0_rk !< d_t, d_c, r
  end type damage_gradient

contains

  !> F of Eqs. 19-23, with beta at least zero: a negative beta would open the surface towards
  !> tension. Crushed concrete, with c below (1 + alpha)/(1 - alpha) t, then has a strength in
  !> tension below t.
  pure elemental function yield_at(model, q, p, largest, tension, compression) result(f)
    type(concrete_model), intent(in) :: model
    real(rk), intent(in) :: q, p, largest !< Eqs. 20-21 and s_1 [Pa]
    real(rk), intent(in) :: tension, compression !< effective strengths t, c [Pa]
    type(yield_value) :: f
    real(rk) :: beta, scale, ratio
    scale = 1.0_rk/(1.0_rk - model%alpha)
    f%by_q = scale
    f%by_p = -3.0_rk*model%alpha*scale
    f%by_compression = -1.0_rk
    f%value = f%by_q*q + f%by_p*p - compression
    if (largest > 0.0_rk) then
      ratio = compression/tension
      beta = ratio*(1.0_rk - model%alpha) - (1.0_rk + model%alpha)
      if (beta <= 0.0_rk) return
      f%by_largest = beta*scale
      f%by_tension = -ratio/tension*largest
      f%by_compression = largest/tension - 1.0_rk
    else
      f%by_largest = model%gamma*scale
    end if
    f%value = f%value + f%by_largest*largest
  end function yield_at

  !> r, the share of tension in a state, sum <s_i>/sum |s_i| (paper_notes.md, 8), and dr/ds_i.
  pure subroutine tension_share(s, share, gradient)
    real(rk), intent(in) :: s(3)
    real(rk), intent(out) :: share, gradient(3)
    real(rk) :: whole, inverse
    integer :: i
    whole = abs(s(1)) + abs(s(2)) + abs(s(3))
    share = 0.0_rk
    gradient = 0.0_rk
    if (whole <= tiny(whole)) return
    inverse = 1.0_rk/whole
    share = (max(s(1), 0.0_rk) + max(s(2), 0.0_rk) + max(s(3), 0.0_rk))/whole
    do i = 1, 3
      gradient(i) = merge(1.0_rk - share, share, s(i) > 0.0_rk)*inverse
    end do
  end subroutine tension_share

  !> d of Eqs. 15-16.
  pure elemental function total_damage(model, tension, compression, share) result(d)
    type(concrete_model), intent(in) :: model
    real(rk), intent(in) :: tension, compression !< d_t, d_c
    real(rk), intent(in) :: share !< r
    type(damage_gradient) :: d
    real(rk) :: s_t, s_c, rest_t, rest_c
    s_t = 1.0_rk - model%tension_recovery*share
    s_c = 1.0_rk - model%compression_recovery*(1.0_rk - share)
    rest_c = 1.0_rk - s_t*compression
    rest_t = 1.0_rk - s_c*tension
    d%value = 1.0_rk - rest_c*rest_t
    d%by_tension = s_c*rest_c
    d%by_compression = s_t*rest_t
    d%by_share = rest_c*tension*model%compression_recovery &
                 - rest_t*compression*model%tension_recovery
  end function total_damage
end module damage_yield
