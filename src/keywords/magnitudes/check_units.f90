!> Warns of defaults, constants and records in SI in a deck in other units (deck_units).
module check_units
  use contraction_keyword, only: stiffness_of_thickness
  use deck_card, only: card
  use deck_scan, only: is_keyword
  use deck_units, only: has_kilograms_per_m3, has_milliseconds, has_other_length, is_g, &
                        sign_of_other_units
  use diagnostics, only: diagnostic_list
  use kinds, only: rk
  use base_motion_cards, only: is_acceleration, moves_base
  use model_draft, only: draft
  use write_text, only: as_text
  implicit none
  private
  public :: warn_of_units

  !> The default of THICKNESS of *JOINT LAW [m].
  real(rk), parameter :: usual_thickness = 0.02_rk
  !> Between a SCALE that scales a record and one that turns it into another unit.
  real(rk), parameter :: largest_scaling = 10.0_rk
  !> 1 m/s2 in mm/s2, m/ms2 and mm/ms2.
  real(rk), parameter :: in_mm = 1.0e3_rk, in_ms = 1.0e-6_rk

  !> The units of a deck that is not in SI.
  type :: other_units
    logical :: in_metres = .true., in_seconds = .true.
    logical :: has_usual_water = .false. !< water has the density 1000
    character(:), allocatable :: why !< what shows them
  end type other_units

contains

  !> The deck must have no errors.
  subroutine warn_of_units(model, faults)
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(other_units) :: units
    integer :: record(size(model%problem%amplitudes)) !< its card
    integer :: i, a
    call find_units(model, units)
    if (units%why == '') return
    record = cards_of_records(model)
    do i = 1, size(model%cards)
      associate (this => model%cards(i))
        if (is_keyword(this, 'RESERVOIR')) then
          call warn_of_reservoir(this, units, faults)
        else if (is_keyword(this, 'JOINT LAW')) then
          call warn_of_thickness(this, units, faults)
        else if (is_keyword(this, 'INTERFACE')) then
          if (units%in_metres .or. this%has('STIFFNESS')) cycle
          call this%warn(faults, 'STIFFNESS is by default E over one unit of length '// &
                         '(in mm 1000 times as stiff)'//units%why)
        else if (units%in_metres .and. units%in_seconds) then
          cycle
        else if (is_keyword(this, 'DLOAD')) then
          call warn_of_gravity(this, units%why, faults)
        else if (moves_base(this)) then
          a = model%amplitude_of_name%find(this%word('AMPLITUDE'))
          call warn_of_record(this, model%cards(record(a)), units, faults)
        end if
      end associate
    end do
  end subroutine warn_of_units

  !> The units of the deck; `why` is '' in SI.
  subroutine find_units(model, units)
    type(draft), intent(in) :: model
    type(other_units), intent(out) :: units
    units%why = sign_of_other_units(model%problem)
    if (units%why == '') return
    units%in_metres = .not. has_other_length(model%problem)
    units%in_seconds = .not. has_milliseconds(model%problem)
    units%has_usual_water = has_kilograms_per_m3(model%problem%materials)
    units%why = ' in a deck with a '//units%why//', which is not in SI ('
    if (units%in_metres .and. units%in_seconds) then
      units%why = units%why//'t, m, s: water 1; kt, m, s: water 1e-3)'
    else if (units%in_metres) then
      units%why = units%why//'kg, m, ms: water 1000, g 9.81e-6)'
    else if (units%in_seconds) then
      units%why = units%why//'t, mm, s: water 1e-9, g 9810)'
    else
      units%why = units%why//'kg, mm, ms: water 1e-6, g 9.81e-3)'
    end if
  end subroutine find_units

  !> Water and gravity in SI.
  subroutine warn_of_reservoir(this, units, faults)
    type(card), intent(in) :: this
    type(other_units), intent(in) :: units
    type(diagnostic_list), intent(inout) :: faults
    if (.not. (units%has_usual_water .or. this%has('DENSITY'))) then
      call this%warn(faults, 'DENSITY is 1000 by default'//units%why)
    end if
    if (units%in_metres .and. units%in_seconds) return
    if (.not. this%has('GRAVITY')) then
      call this%warn(faults, 'GRAVITY is 9.81 by default'//units%why)
    else if (is_g(this%real('GRAVITY'))) then
      call this%warn(faults, 'GRAVITY of '//this%text('GRAVITY')//units%why)
    end if
  end subroutine warn_of_reservoir

  !> A thickness of a joint in metres.
  subroutine warn_of_thickness(this, units, faults)
    type(card), intent(in) :: this
    type(other_units), intent(in) :: units
    type(diagnostic_list), intent(inout) :: faults
    character(:), allocatable :: gives
    gives = stiffness_of_thickness(this)
    if (units%in_metres .or. gives == '') return
    if (.not. this%has('THICKNESS')) then
      call this%warn(faults, 'THICKNESS, which '//gives//' comes from, is 0.02 by default'// &
                     units%why)
    else if (abs(this%real('THICKNESS') - usual_thickness) <= 0.0_rk) then
      call this%warn(faults, 'THICKNESS, which '//gives//' comes from, is '// &
                     this%text('THICKNESS')//', the default for metres,'//units%why)
    end if
  end subroutine warn_of_thickness

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

  !> A weight with g in m/s2.
  subroutine warn_of_gravity(this, why, faults)
    type(card), intent(in) :: this
    character(*), intent(in) :: why
    type(diagnostic_list), intent(inout) :: faults
    integer :: line
    do line = 1, this%num_lines
      if (this%word_at(line, 2) /= 'GRAV') cycle
      if (.not. is_g(this%real_at(line, 3))) cycle
      call this%warn_at(faults, line, 3, 'gravity of '//this%text_at(line, 3)//why)
      exit
    end do
  end subroutine warn_of_gravity

  !> A record that its unit has turned into m/s2.
  subroutine warn_of_record(this, record, units, faults)
    type(card), intent(in) :: this, record !< *BASE MOTION or *BOUNDARY, and its *AMPLITUDE
    type(other_units), intent(in) :: units
    type(diagnostic_list), intent(inout) :: faults
    character(:), allocatable :: remedy
    real(rk) :: factor, conversion
    if (.not. record%has('UNIT') .and. record%word('FORMAT') /= 'AT2') return
    conversion = merge(1.0_rk, in_mm, units%in_metres)*merge(1.0_rk, in_ms, units%in_seconds)
    if (is_acceleration(this)) then
      factor = this%real_at(1, 4)
      remedy = 'a factor of '
    else
      factor = this%real('SCALE')
      remedy = 'SCALE='
    end if
    factor = abs(factor*record%real('SCALE'))/conversion
    if (max(factor, 1.0_rk/factor) <= largest_scaling) return
    call this%warn(faults, "the record '"//this%text('AMPLITUDE')//"' is turned into m/s2"// &
                   units%why//'; '//remedy//as_text(conversion)//' here turns it into '// &
                   trim(merge('m ', 'mm', units%in_metres))//'/'// &
                   trim(merge('s ', 'ms', units%in_seconds))//'2')
  end subroutine warn_of_record
end module check_units
