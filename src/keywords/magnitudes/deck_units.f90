!> The units of a deck, as its numbers show them: densities, Young's moduli and weights. The speed
!> of waves sqrt(E/rho) shows the unit of length, whatever the units of force and mass are; gravity
!> shows the unit of time.
module deck_units
  use amplitudes, only: one_g
  use kinds, only: rk
  use load_gravity, only: gravity_load
  use material_law, only: material
  use problem_definition, only: problem
  use write_text, only: as_text
  implicit none
  private
  public :: sign_of_other_units, has_kilograms_per_m3, has_other_length, has_milliseconds
  public :: note_units, unit_of_length, unit_of_time, gravity_of, is_g

  !> Densities of solids in SI lie above: a tenth of that of water. Concrete has 2.4 in t/m3, 2.4e-3
  !> in kt/m3 (MN, m, s) and 2.4e-9 in t/mm3 [kg/m3].
  real(rk), parameter :: lightest_solid = 100.0_rk
  !> Young's moduli of solids in SI lie above, in MPa below [Pa].
  real(rk), parameter :: softest_solid = 1.0e6_rk
  !> Speeds sqrt(E/rho) in m/s lie below: 3e3 in concrete, 5e3 in steel. Those in mm/s lie above,
  !> but for solids of less than 30 m/s.
  real(rk), parameter :: fastest_solid = 3.0e4_rk
  !> Densities per mm3 lie below (2.4e-6 in kg/mm3), per m3 above (2.4e-3 in kt/m3).
  real(rk), parameter :: lightest_in_metres = 1.0e-4_rk
  !> Densities of the heaviest solid in t/mm3: concrete has 2.4e-9, gold 1.9e-8. Below, a density
  !> may stand for no mass.
  real(rk), parameter :: least_in_tonnes = 1.5e-9_rk, largest_in_tonnes = 2.0e-8_rk
  !> Densities in g/mm3, kg/mm3 and t/mm3 lie below: concrete has 2.4e-3 in g/mm3.
  real(rk), parameter :: heaviest_in_mm = 0.1_rk
  !> Range of g in m/s2 as decks write it.
  real(rk), parameter :: least_g = 9.7_rk, largest_g = 10.1_rk
  !> Milliseconds in a second; mm/s2 in 1 m/s2.
  real(rk), parameter :: thousand = 1000.0_rk
  !> First increments of motions of the ground lie below [s]. Those in ms lie above.
  real(rk), parameter :: longest_increment = 0.2_rk

contains

  !> Notes the units once for the whole deck.
  subroutine note_units(model)
    type(problem), intent(inout) :: model
    model%gravity = weight_of(model)
    model%sign_of_units = sign_of_other_units(model)
    model%has_other_acceleration = has_other_acceleration(model)
  end subroutine note_units

  !> What shows that a deck is not in SI: '*DENSITY of 2.4e-9'; '' for a deck in SI.
  pure function sign_of_other_units(model) result(words)
    type(problem), intent(in) :: model
    character(:), allocatable :: words
    real(rk) :: heaviest, stiffest
    words = ''
    heaviest = maxval([0.0_rk, model%materials%density])
    stiffest = maxval([0.0_rk, model%materials%young])
    if (heaviest >= lightest_solid) then
      if (has_milliseconds(model)) words = 'gravity of '//as_text(model%gravity)
    else if (heaviest > 0.0_rk) then
      words = '*DENSITY of '//as_text(heaviest)
    else if (stiffest > 0.0_rk .and. stiffest < softest_solid) then
      words = "Young's modulus of "//as_text(stiffest)
    end if
  end function sign_of_other_units

  !> Whether the densities are those of SI.
  pure logical function has_kilograms_per_m3(materials)
    type(material), intent(in) :: materials(:)
    has_kilograms_per_m3 = maxval([0.0_rk, materials%density]) >= lightest_solid
  end function has_kilograms_per_m3

  !> Whether the unit of length is not the metre. Without a solid that has mass and E the density
  !> shows it; without any density E in MPa counts as one of millimetres.
  pure logical function has_other_length(model)
    type(problem), intent(in) :: model
    real(rk) :: slowest, heaviest
    has_other_length = sign_of_other_units(model) /= ''
    if (.not. has_other_length) return
    slowest = slowest_waves(model%materials)
    heaviest = maxval([0.0_rk, model%materials%density])
    if (has_milliseconds(model)) then
      has_other_length = .not. is_g(thousand**2*model%gravity)
    else if (slowest < huge(1.0_rk)) then
      has_other_length = slowest > fastest_solid
    else if (heaviest > 0.0_rk) then
      has_other_length = heaviest < lightest_in_metres
    end if
  end function has_other_length

  !> sqrt(E/rho) of the slowest solid; huge where none has mass and E.
  pure real(rk) function slowest_waves(materials) result(slowest)
    type(material), intent(in) :: materials(:)
    integer :: i
    slowest = huge(1.0_rk)
    do i = 1, size(materials)
      if (materials(i)%density <= 0.0_rk .or. materials(i)%young <= 0.0_rk) cycle
      slowest = min(slowest, sqrt(materials(i)%young/materials(i)%density))
    end do
  end function slowest_waves

  !> Whether times are in ms: the weights have g in m/ms2 or mm/ms2, and waves have speeds in these
  !> units.
  pure logical function has_milliseconds(model)
    type(problem), intent(in) :: model
    real(rk) :: g, slowest
    g = model%gravity
    slowest = slowest_waves(model%materials)
    if (slowest >= huge(1.0_rk)) slowest = 0.0_rk
    has_milliseconds = is_g(thousand**2*g) .and. slowest <= fastest_solid/thousand
    if (has_milliseconds) return
    has_milliseconds = is_g(thousand*g) .and. slowest <= fastest_solid &
                       .and. maxval([0.0_rk, model%materials%density]) < heaviest_in_mm
  end function has_milliseconds

  !> Whether accelerations are, or may be, in another unit than m/s2.
  pure logical function has_other_acceleration(model)
    type(problem), intent(in) :: model
    has_other_acceleration = has_other_length(model) &
                             .or. abs(unit_of_time(model) - 1.0_rk) > 0.0_rk
  end function has_other_acceleration

  !> Length of a metre in the unit of length of the deck, 1 or 1000; 0 where the densities do not
  !> show it beyond doubt: those per ft3, in3 and cm3 lie between.
  pure real(rk) function unit_of_length(materials) result(metre)
    type(material), intent(in) :: materials(:)
    real(rk) :: heaviest
    heaviest = maxval([0.0_rk, materials%density])
    metre = 0.0_rk
    if (heaviest >= lightest_solid) then
      metre = 1.0_rk
    else if (heaviest >= least_in_tonnes .and. heaviest <= largest_in_tonnes) then
      metre = thousand
    end if
  end function unit_of_length

  !> A second in the unit of time of the deck, 1 or 1000; 0 where no weight shows it and increments
  !> are longer than those of motions in seconds.
  pure real(rk) function unit_of_time(model) result(second)
    type(problem), intent(in) :: model
    integer :: s
    second = 1.0_rk
    if (has_milliseconds(model)) second = thousand
    if (is_g(model%gravity) .or. is_g(model%gravity/thousand)) return
    if (second > 1.0_rk .or. .not. allocated(model%steps)) return
    do s = 1, size(model%steps)
      if (.not. model%steps(s)%procedure%has_inertia) cycle
      if (model%steps(s)%first_increment > longest_increment) second = 0.0_rk
    end do
  end function unit_of_time

  !> Acceleration of gravity in the unit of the deck; 0 where neither the density nor a weight shows
  !> it.
  pure real(rk) function gravity_of(model) result(g)
    type(problem), intent(in) :: model
    real(rk) :: metre, second
    metre = unit_of_length(model%materials)
    second = unit_of_time(model)
    if (metre <= 0.0_rk) then
      g = model%gravity
    else if (second <= 0.0_rk) then
      g = 0.0_rk
    else
      g = one_g*metre/second**2
    end if
  end function gravity_of

  !> The largest acceleration of the weights, 0 without weights.
  pure real(rk) function weight_of(model) result(g)
    type(problem), intent(in) :: model
    integer :: s, i
    g = 0.0_rk
    if (.not. allocated(model%steps)) return
    do s = 1, size(model%steps)
      if (.not. allocated(model%steps(s)%loads)) cycle
      do i = 1, size(model%steps(s)%loads)
        associate (work => model%steps(s)%loads(i))
          select type (weight => model%loads(work%load)%item)
          type is (gravity_load)
            g = max(g, abs(work%end_factor)*norm2(weight%acceleration))
          end select
        end associate
      end do
    end do
  end function weight_of

  !> Whether a number is g in m/s2, of either sign.
  pure logical function is_g(acceleration)
    real(rk), intent(in) :: acceleration
    is_g = abs(acceleration) >= least_g .and. abs(acceleration) <= largest_g
  end function is_g
end module deck_units
