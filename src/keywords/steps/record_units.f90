!> Units of records of ground motion: by UNIT of *AMPLITUDE, or by the header of an AT2 file.
!>
!> Records become m/s2. A SCALE that is the conversion itself (9.81 for a record in g) is taken as
!> such; another SCALE beside a unit of the file alone is ambiguous.
module record_units
  use amplitudes, only: one_g
  use deck_card, only: card
  use diagnostics, only: diagnostic_list
  use kinds, only: rk
  use parse_text, only: upper_case
  use write_text, only: as_text
  implicit none
  private
  public :: factor_of_unit, unit_in_header, settle_unit, find_further_scale, choices_of_units
  public :: factor_beside_scale, repeats_unit

  character(*), parameter :: choices_of_units = 'G | M/S2 | CM/S2'
  character(*), parameter :: expected_unit = 'UNIT=G, M/S2 or CM/S2, and in SCALE only what '// &
                             'scales the record in m/s2'
  character(*), parameter :: separators = ' ():=,;'//achar(9)
  character(*), parameter :: words_of_g = ' G G''S '
  character(*), parameter :: words_of_m = ' M/S2 M/S/S M/S^2 M/S**2 M/SEC2 M/SEC/SEC '
  character(*), parameter :: words_of_cm = ' CM/S2 CM/S/S CM/S^2 CM/S**2 CM/SEC2 CM/SEC/SEC '// &
                             'CM/SEC**2 GAL GALS '
  real(rk), parameter :: same_factor = 0.01_rk !< relative: 9.8, 9.80665 and 9.81 are g

contains

  !> Factor that turns a record in this unit into m/s2; 1 for no unit.
  pure real(rk) function factor_of_unit(unit) result(factor)
    character(*), intent(in) :: unit !< 'G', 'M/S2', 'CM/S2' or ''
    factor = 1.0_rk
    if (unit == 'G') factor = one_g
    if (unit == 'CM/S2') factor = 0.01_rk
  end function factor_of_unit

  !> Factor of UNIT besides SCALE: 1 where SCALE is the conversion.
  real(rk) function factor_beside_scale(this, unit, faults) result(factor)
    class(card), intent(in) :: this
    character(*), intent(in) :: unit !< of the record, '' for none
    type(diagnostic_list), intent(inout) :: faults
    factor = factor_of_unit(unit)
    if (.not. repeats_unit(unit, this%real('SCALE'))) return
    factor = 1.0_rk
    call this%warn(faults, 'SCALE='//this%text('SCALE')//' is taken as the conversion of the '// &
                   'record to m/s2, which UNIT='//unit//' asks for as well')
  end function factor_beside_scale

  !> The unit that a line of a header names, '' without one: '.. IN UNITS OF G', 'units: cm/sec2'.
  pure function unit_in_header(line) result(unit)
    character(*), intent(in) :: line
    character(:), allocatable :: unit
    character(:), allocatable :: word
    integer :: first, last
    logical :: is_named
    unit = ''
    is_named = .false.
    last = 0
    do
      first = verify(line(last + 1:), separators) + last
      if (first == last) return
      last = scan(line(first:), separators) + first - 2
      if (last < first) last = len(line)
      word = upper_case(line(first:last))
      is_named = is_named .or. index(word, 'UNIT') == 1
      if (index(words_of_m, ' '//word//' ') > 0) unit = 'M/S2'
      if (index(words_of_cm, ' '//word//' ') > 0) unit = 'CM/S2'
      if (is_named .and. index(words_of_g, ' '//word//' ') > 0) unit = 'G'
      if (unit /= '') return
    end do
  end function unit_in_header

  !> The unit of an AT2 file: that of UNIT, which its header must not contradict, or that of the
  !> header.
  subroutine settle_unit(this, unit, faults, own_factor)
    type(card), intent(in) :: this
    character(*), intent(in) :: unit !< of the file, '' where the file does not name it
    type(diagnostic_list), intent(inout) :: faults
    real(rk), intent(inout) :: own_factor !< besides SCALE and UNIT
    if (.not. this%has('UNIT')) then
      call find_own_factor(this, unit, faults, own_factor)
    else if (unit /= '' .and. this%word('UNIT') /= unit) then
      call this%fault_parameter(faults, 'UNIT', 'the header of the file names the unit '//unit, &
                                'no UNIT, or UNIT='//unit)
    end if
  end subroutine settle_unit

  !> Factor of the values of an *AMPLITUDE without UNIT whose file names a unit.
  subroutine find_own_factor(this, unit, faults, factor)
    type(card), intent(in) :: this
    character(*), intent(in) :: unit !< of the file, '' where the file does not name it
    type(diagnostic_list), intent(inout) :: faults
    real(rk), intent(out) :: factor !< besides SCALE
    factor = 1.0_rk
    if (unit == '') then
      if (is_conversion(this%real('SCALE'), one_g) .or. &
          is_conversion(this%real('SCALE'), factor_of_unit('CM/S2'))) return
      call this%fault_parameter(faults, 'INPUT', 'the header of the file does not name the '// &
                                'unit of the record', expected_unit)
      return
    end if
    call settle_scale(this, factor_of_unit(unit), faults, factor)
  end subroutine find_own_factor

  !> SCALE of a *BASE MOTION whose record was turned into m/s2, by UNIT or by a unit that only its
  !> file names.
  subroutine find_further_scale(this, unit, own_factor, faults, scale)
    type(card), intent(in) :: this
    character(*), intent(in) :: unit !< UNIT of the record, '' for none
    real(rk), intent(in) :: own_factor !< of the unit that the file names, 1 for none
    type(diagnostic_list), intent(inout) :: faults
    real(rk), intent(out) :: scale
    real(rk) :: factor
    if (unit /= '') then
      scale = this%real('SCALE')*factor_beside_scale(this, unit, faults)/factor_of_unit(unit)
      return
    end if
    call settle_scale(this, own_factor, faults, factor)
    scale = this%real('SCALE')*factor/own_factor
  end subroutine find_further_scale

  !> The factor besides SCALE: that of the unit, or 1 where SCALE is the conversion.
  subroutine settle_scale(this, of_unit, faults, factor)
    type(card), intent(in) :: this
    real(rk), intent(in) :: of_unit !< factor of the unit that the file names
    type(diagnostic_list), intent(inout) :: faults
    real(rk), intent(out) :: factor
    real(rk) :: scale
    scale = this%real('SCALE')
    factor = of_unit
    if (abs(of_unit - 1.0_rk) <= 0.0_rk .or. abs(scale - 1.0_rk) <= 0.0_rk) return
    if (is_conversion(scale, of_unit)) then
      factor = 1.0_rk
      call this%warn(faults, 'SCALE='//this%text('SCALE')//' is taken as the conversion of the '// &
                     'record to m/s2: its file names the unit; UNIT in *AMPLITUDE does it as well')
      return
    end if
    call this%fault_parameter(faults, 'SCALE', 'the file of the record names a unit of '// &
                              as_text(of_unit)//' m/s2; SCALE='//this%text('SCALE')// &
                              ' is ambiguous', 'in *AMPLITUDE '//expected_unit)
  end subroutine settle_scale

  !> Whether a scale is the conversion that a unit asks for as well.
  pure logical function repeats_unit(unit, scale)
    character(*), intent(in) :: unit !< '' for none
    real(rk), intent(in) :: scale
    repeats_unit = abs(factor_of_unit(unit) - 1.0_rk) > 0.0_rk .and. &
                   is_conversion(scale, factor_of_unit(unit))
  end function repeats_unit

  pure logical function is_conversion(scale, factor)
    real(rk), intent(in) :: scale, factor
    is_conversion = abs(abs(scale) - factor) <= same_factor*factor
  end function is_conversion
end module record_units
