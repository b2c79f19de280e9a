!> Warns of numbers that no dam has, in a deck that is otherwise right: densities and moduli of two
!> systems of units, an angle in place of a coefficient of friction.
module check_magnitudes
  use deck_card, only: card
  use deck_scan, only: is_keyword
  use deck_units, only: unit_of_length, unit_of_time
  use diagnostics, only: diagnostic_list
  use kinds, only: rk
  use model_draft, only: draft
  use write_text, only: as_short_text, as_text
  implicit none
  private
  public :: warn_of_magnitudes

  !> Density of water over that of the heaviest solid: 0.4 beside concrete, 0.05 beside gold, 2
  !> beside light wood. Two systems of units differ by 1000 and more.
  real(rk), parameter :: least_share = 0.05_rk, largest_share = 2.0_rk
  !> A solid is massless by a tiny density below this part of the largest density.
  real(rk), parameter :: massless_share = 1.0e-3_rk
  !> Speed sqrt(E/density) of the fastest solid of a dam: 2500 m/s to 4000 m/s in concrete, 30 m/s
  !> in soft clay. A modulus in MPa beside kg/m3 gives concrete 3 m/s, one in GPa beside t/mm3
  !> 80 m/s to 130 m/s, as in loose soil [m/s].
  real(rk), parameter :: slowest_in_si = 20.0_rk, slowest_in_mm = 150.0_rk
  !> In millimetres speeds lie below: 1e5 m/s in solids 1000 times as stiff as concrete, which stand
  !> for rigid bodies. A modulus in Pa beside t/mm3 gives 3e6 m/s [m/s].
  real(rk), parameter :: fastest_in_mm = 1.0e6_rk
  !> Angles of friction of rock and joints in degrees. As coefficients none of them is a friction;
  !> larger ones prevent sliding.
  real(rk), parameter :: least_angle = 15.0_rk, largest_angle = 75.0_rk
  real(rk), parameter :: degree = acos(-1.0_rk)/180.0_rk

contains

  !> The deck must have no errors.
  subroutine warn_of_magnitudes(model, faults)
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer :: i
    call warn_of_speeds(model, faults)
    do i = 1, size(model%cards)
      if (is_keyword(model%cards(i), 'RESERVOIR')) then
        call warn_of_water(model%cards(i), maxval([0.0_rk, model%problem%materials%density]), &
                           faults)
      else if (is_keyword(model%cards(i), 'JOINT LAW')) then
        call warn_of_friction(model%cards(i), faults)
      end if
    end do
  end subroutine warn_of_magnitudes

  !> Water that is much lighter or heavier than the solids.
  subroutine warn_of_water(this, heaviest, faults)
    type(card), intent(in) :: this
    real(rk), intent(in) :: heaviest !< density of solids, 0 without mass [kg/m3]
    type(diagnostic_list), intent(inout) :: faults
    real(rk) :: share
    if (.not. this%has('DENSITY') .or. heaviest <= 0.0_rk) return
    share = this%real('DENSITY')/heaviest
    if (share >= least_share .and. share <= largest_share) return
    call this%warn(faults, 'DENSITY of the water is '//as_short_text(share)//' times that of '// &
                   'the heaviest solid, '//as_text(heaviest), 'both in the same unit, as 1000 '// &
                   'beside 2400 for concrete')
  end subroutine warn_of_water

  !> Solids in which waves are too slow or too fast for any dam. The fastest solid counts against
  !> the lower bound, so that soil may stand beside concrete, and the slowest against the upper
  !> bound, so that one of several solids may be rigid.
  subroutine warn_of_speeds(model, faults)
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    real(rk) :: speed(size(model%problem%materials)), metre, second
    logical :: has_waves(size(model%problem%materials))
    integer :: i
    metre = unit_of_length(model%problem%materials)
    second = unit_of_time(model%problem)
    if (metre <= 0.0_rk .or. second <= 0.0_rk .or. .not. uses_density(model)) return
    associate (list => model%problem%materials)
      has_waves = list%density > massless_share*maxval([0.0_rk, list%density]) &
                  .and. list%young > 0.0_rk
      if (.not. any(has_waves)) return
      speed = 0.0_rk
      where (has_waves) speed = second*sqrt(list%young/list%density)/metre
    end associate
    i = maxloc(speed, dim=1, mask=has_waves)
    if (speed(i) < merge(slowest_in_mm, slowest_in_si, metre > 1.0_rk)) then
      call warn_of_speed(model, i, speed(i), faults)
    end if
    i = minloc(speed, dim=1, mask=has_waves)
    if (metre <= 1.0_rk .or. speed(i) <= fastest_in_mm) return
    call warn_of_speed(model, i, speed(i), faults)
  end subroutine warn_of_speeds

  !> Whether a motion, a frequency or a weight depends on the densities.
  pure logical function uses_density(model)
    type(draft), intent(in) :: model
    associate (procedures => model%problem%steps%procedure)
      uses_density = any(procedures%has_inertia .or. procedures%finds_modes) &
                     .or. model%problem%gravity > 0.0_rk
    end associate
  end function uses_density

  subroutine warn_of_speed(model, i, speed, faults)
    type(draft), intent(in) :: model
    integer, intent(in) :: i !< material
    real(rk), intent(in) :: speed !< [m/s]
    type(diagnostic_list), intent(inout) :: faults
    associate (now => model%problem%materials(i))
      call model%cards(model%material_origin(i)%card)%warn( &
        faults, "Young's modulus of "//as_text(now%young)//' and *DENSITY of '// &
        as_text(now%density)//' give waves of '//as_short_text(speed)//' m/s', 'both in one '// &
        'system of units: concrete has 3000 m/s, the root of modulus over density')
    end associate
  end subroutine warn_of_speed

  !> FRICTION in degrees.
  subroutine warn_of_friction(this, faults)
    type(card), intent(in) :: this
    type(diagnostic_list), intent(inout) :: faults
    real(rk) :: friction
    friction = this%real('FRICTION')
    if (friction < least_angle .or. friction > largest_angle) return
    call this%warn(faults, 'FRICTION of '//this%text('FRICTION')//' is a coefficient, not an '// &
                   'angle', 'for an angle of '//this%text('FRICTION')//' degrees FRICTION='// &
                   as_short_text(tan(degree*friction)))
  end subroutine warn_of_friction
end module check_magnitudes
