!> Warns of defaults, constants and records in SI in a deck in other units, which the densities or
!> Young's moduli of its solids show. The speed of waves sqrt(E/rho) shows the unit of length: the
!> units of force and mass do not count in it.
module check_units
  use deck_card, only: card
  use deck_scan, only: is_keyword
  use diagnostics, only: diagnostic_list
  use kinds, only: rk
  use material_law, only: material
  use base_motion_cards, only: is_acceleration, moves_base
  use model_draft, only: draft
  use write_text, only: as_text
  implicit none
  private
  public :: sign_of_other_units, has_other_length, unit_of_length, warn_of_units

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
  !> Range of g in m/s2 as decks write it.
  real(rk), parameter :: least_g = 9.7_rk, largest_g = 10.1_rk
  !> The default of THICKNESS of *JOINT LAW [m].
  real(rk), parameter :: usual_thickness = 0.02_rk
  !> A SCALE below scales a record, one above turns m/s2 into mm/s2.
  real(rk), parameter :: largest_scale = 100.0_rk

contains

  !> What shows that a deck is not in SI: '*DENSITY of 2.4e-9'; '' for a deck in SI.
  pure function sign_of_other_units(materials) result(words)
    type(material), intent(in) :: materials(:)
    character(:), allocatable :: words
    real(rk) :: heaviest, stiffest
    words = ''
    heaviest = maxval([0.0_rk, materials%density])
    stiffest = maxval([0.0_rk, materials%young])
    if (heaviest >= lightest_solid) return
    if (heaviest > 0.0_rk) then
      words = '*DENSITY of '//as_text(heaviest)
    else if (stiffest > 0.0_rk .and. stiffest < softest_solid) then
      words = "Young's modulus of "//as_text(stiffest)
    end if
  end function sign_of_other_units

  !> Whether the unit of length is not the metre. Without a solid that has mass and E the density
  !> shows it; without any density E in MPa counts as one of millimetres.
  pure logical function has_other_length(materials)
    type(material), intent(in) :: materials(:)
    real(rk) :: slowest, heaviest
    integer :: i
    has_other_length = sign_of_other_units(materials) /= ''
    if (.not. has_other_length) return
    slowest = huge(1.0_rk)
    do i = 1, size(materials)
      if (materials(i)%density <= 0.0_rk .or. materials(i)%young <= 0.0_rk) cycle
      slowest = min(slowest, sqrt(materials(i)%young/materials(i)%density))
    end do
    heaviest = maxval([0.0_rk, materials%density])
    if (slowest < huge(1.0_rk)) then
      has_other_length = slowest > fastest_solid
    else if (heaviest > 0.0_rk) then
      has_other_length = heaviest < lightest_in_metres
    end if
  end function has_other_length

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
      metre = 1000.0_rk
    end if
  end function unit_of_length

  !> The deck must have no errors.
  subroutine warn_of_units(model, faults)
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    character(:), allocatable :: why
    logical :: in_metres
    integer :: record(size(model%problem%amplitudes)) !< its card
    integer :: i, a
    why = sign_of_other_units(model%problem%materials)
    if (why == '') return
    record = cards_of_records(model)
    why = ' in a deck with a '//why//', which is not in SI ('
    in_metres = .not. has_other_length(model%problem%materials)
    if (in_metres) then
      why = why//'t, m, s: water 1; kt, m, s: water 1e-3)'
    else
      why = why//'t, mm, s: water 1e-9, g 9810)'
    end if
    do i = 1, size(model%cards)
      associate (this => model%cards(i))
        if (is_keyword(this, 'RESERVOIR')) then
          if (.not. this%has('DENSITY')) call this%warn(faults, 'DENSITY is 1000 by default'//why)
          if (.not. (in_metres .or. this%has('GRAVITY'))) then
            call this%warn(faults, 'GRAVITY is 9.81 by default'//why)
          else if (.not. in_metres .and. is_g_in_metres(this%real('GRAVITY'))) then
            call this%warn(faults, 'GRAVITY of '//this%text('GRAVITY')//why)
          end if
        else if (in_metres) then
          cycle
        else if (is_keyword(this, 'JOINT LAW')) then
          if (this%has('KN')) cycle
          if (.not. this%has('THICKNESS')) then
            call this%warn(faults, 'THICKNESS, which KN comes from, is 0.02 by default'//why)
          else if (abs(this%real('THICKNESS') - usual_thickness) <= 0.0_rk) then
            call this%warn(faults, 'THICKNESS, which KN comes from, is '// &
                           this%text('THICKNESS')//', the default for metres,'//why)
          end if
        else if (is_keyword(this, 'INTERFACE')) then
          if (.not. this%has('STIFFNESS')) then
            call this%warn(faults, 'STIFFNESS is by default E over one unit of length '// &
                           '(in mm 1000 times as stiff)'//why)
          end if
        else if (is_keyword(this, 'DLOAD')) then
          call warn_of_gravity(this, why, faults)
        else if (moves_base(this)) then
          a = model%amplitude_of_name%find(this%word('AMPLITUDE'))
          call warn_of_record(this, model%cards(record(a)), why, faults)
        end if
      end associate
    end do
  end subroutine warn_of_units

  !> The card of each amplitude.
  pure function cards_of_records(model) result(place)
    type(draft), intent(in) :: model
    integer :: place(size(model%problem%amplitudes))
    integer :: i
    do i = 1, size(model%cards)
      if (.not. is_keyword(model%cards(i), 'AMPLITUDE')) cycle
      place(model%amplitude_of_name%find(model%cards(i)%word('NAME'))) = i
    end do
  end function cards_of_records

  pure logical function is_g_in_metres(g)
    real(rk), intent(in) :: g
    is_g_in_metres = abs(g) >= least_g .and. abs(g) <= largest_g
  end function is_g_in_metres

  !> A weight with g in m/s2.
  subroutine warn_of_gravity(this, why, faults)
    type(card), intent(in) :: this
    character(*), intent(in) :: why
    type(diagnostic_list), intent(inout) :: faults
    integer :: line
    do line = 1, this%num_lines
      if (this%word_at(line, 2) /= 'GRAV') cycle
      if (.not. is_g_in_metres(this%real_at(line, 3))) cycle
      call this%warn_at(faults, line, 3, 'gravity of '//this%text_at(line, 3)//why)
      exit
    end do
  end subroutine warn_of_gravity

  !> A record that its unit has turned into m/s2.
  subroutine warn_of_record(this, record, why, faults)
    type(card), intent(in) :: this, record !< *BASE MOTION or *BOUNDARY, and its *AMPLITUDE
    character(*), intent(in) :: why
    type(diagnostic_list), intent(inout) :: faults
    character(:), allocatable :: remedy
    real(rk) :: factor
    if (.not. record%has('UNIT') .and. record%word('FORMAT') /= 'AT2') return
    if (is_acceleration(this)) then
      factor = this%real_at(1, 4)
      remedy = 'a factor of 1000'
    else
      factor = this%real('SCALE')
      remedy = 'SCALE=1000'
    end if
    if (abs(factor*record%real('SCALE')) >= largest_scale) return
    call this%warn(faults, "the record '"//this%text('AMPLITUDE')//"' is turned into m/s2"// &
                   why//'; '//remedy//' here turns it into mm/s2')
  end subroutine warn_of_record
end module check_units
