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
  public :: record_header, settle_unit, find_further_scale, choices_of_units
  public :: factor_beside_scale, repeats_unit

  character(*), parameter :: choices_of_units = 'G | M/S2 | CM/S2'
  character(*), parameter :: expected_unit = 'UNIT=G, M/S2 or CM/S2, and in SCALE only what '// &
                             'scales the record in m/s2'
  character(*), parameter :: separators = ' ():=,;'//achar(9)//achar(13)
  character(*), parameter :: words_of_g = ' G G''S '
  character(*), parameter :: words_of_m = ' M/S2 M/S/S M/S^2 M/S**2 M/SEC2 M/SEC/SEC '// &
                             'M/SEC^2 M/SEC**2 '
  character(*), parameter :: words_of_cm = ' CM/S2 CM/S/S CM/S^2 CM/S**2 CM/SEC2 CM/SEC/SEC '// &
                             'CM/SEC^2 CM/SEC**2 GAL GALS '
  !> Words between UNIT or UNITS and the unit; words of the line that says what a record is.
  character(*), parameter :: fillers = ' OF IN IS ARE THE '
  character(*), parameter :: words_of_headings = ' TIME SERIES HISTORY IN '
  character(*), parameter :: words_of_records = ' SERIES HISTORY '
  real(rk), parameter :: same_factor = 0.01_rk !< relative: 9.8, 9.80665 and 9.81 are g

  !> What the header of an AT2 file says of its values, in upper case.
  type :: record_header
    character(:), allocatable :: unit !< 'G', 'M/S2', 'CM/S2', '' where none of them is named
    character(:), allocatable :: unknown !< word in the place of a unit, '' for none
    character(:), allocatable :: quantity !< 'ACCELERATION', 'VELOCITY', ..; '' where not named
    character(:), allocatable :: other !< a second unit, '' for none
    !> The unit stands in a line that says what the record is; others, as titles, do not count
    logical :: is_of_record = .false.
  contains
    procedure :: note_line, is_no_acceleration, names_two
    procedure, private :: note_unit
  end type record_header

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

  !> Takes what a line says: '.. TIME SERIES IN UNITS OF G', 'units: cm/sec2'. The first unit
  !> of a line counts, and acceleration before velocity, which may belong to a station.
  pure subroutine note_line(self, line)
    class(record_header), intent(inout) :: self
    character(*), intent(in) :: line
    character(:), allocatable :: word, quantity, unit, unknown
    logical :: is_named, is_heading, is_of_record
    integer :: last
    quantity = ''
    unit = ''
    unknown = ''
    is_named = .false.
    is_heading = .false.
    is_of_record = .false.
    last = 0
    do
      call take_word(line, last, word)
      if (word == '') exit
      if (index(quantity, 'ACCEL') == 0 .and. names_quantity(word)) quantity = word
      is_heading = is_heading .or. index(words_of_headings, ' '//word//' ') > 0
      is_of_record = is_of_record .or. names_quantity(word) &
                     .or. index(words_of_records, ' '//word//' ') > 0
      if (unit == '') unit = unit_of_word(word, is_named)
      if (is_named .and. unknown == '' .and. index(fillers, ' '//word//' ') == 0) unknown = word
      is_named = is_named .or. index(word, 'UNIT') == 1
    end do
    if (unit /= '') unknown = ''
    if (unit//unknown /= '') call self%note_unit(unit, unknown, is_of_record)
    if (self%quantity == '' .and. (is_heading .or. is_named)) self%quantity = quantity
    if (index(quantity, 'ACCEL') == 1) self%quantity = quantity
  end subroutine note_line

  !> Takes the unit of a line. A line that says what the record is comes before others, and a unit
  !> that is known before another word.
  pure subroutine note_unit(self, unit, unknown, is_of_record)
    class(record_header), intent(inout) :: self
    character(*), intent(in) :: unit, unknown !< of the line; one of them is ''
    logical, intent(in) :: is_of_record
    logical :: is_first
    if (self%is_of_record .and. .not. is_of_record) return
    is_first = self%unit//self%unknown == '' .or. (is_of_record .and. .not. self%is_of_record)
    if (is_first .or. (self%unit == '' .and. unit /= '')) then
      self%unit = unit
      self%unknown = unknown
      self%other = ''
      self%is_of_record = is_of_record
    else if (unit /= '' .and. unit /= self%unit) then
      self%other = unit
    end if
  end subroutine note_unit

  !> Whether the header names two units, neither of which comes before the other.
  pure logical function names_two(self)
    class(record_header), intent(in) :: self
    names_two = self%other /= ''
  end function names_two

  !> Whether a word is that of a motion.
  pure logical function names_quantity(word)
    character(*), intent(in) :: word
    names_quantity = any(index(word, ['ACCEL', 'VELOC', 'DISPL']) == 1)
  end function names_quantity

  !> The next word of a line in upper case, without a full stop; '' at the end.
  pure subroutine take_word(line, last, word)
    character(*), intent(in) :: line
    integer, intent(inout) :: last !< letter of the word before, then of this one
    character(:), allocatable, intent(out) :: word
    integer :: first
    word = ''
    first = verify(line(last + 1:), separators) + last
    if (first == last) return
    last = scan(line(first:), separators) + first - 2
    if (last < first) last = len(line)
    word = upper_case(line(first:last))
    if (len(word) > 1 .and. word(len(word):) == '.') word = word(:len(word) - 1)
  end subroutine take_word

  !> The unit that a word stands for, '' for none. A G counts where the line names a unit.
  pure function unit_of_word(word, is_named) result(unit)
    character(*), intent(in) :: word
    logical, intent(in) :: is_named
    character(:), allocatable :: unit
    unit = ''
    if (index(words_of_m, ' '//word//' ') > 0) unit = 'M/S2'
    if (index(words_of_cm, ' '//word//' ') > 0) unit = 'CM/S2'
    if (is_named .and. index(words_of_g, ' '//word//' ') > 0) unit = 'G'
  end function unit_of_word

  !> Whether the header says that the record is of velocity or displacement.
  pure logical function is_no_acceleration(self)
    class(record_header), intent(in) :: self
    is_no_acceleration = self%quantity /= '' .and. index(self%quantity, 'ACCEL') /= 1
  end function is_no_acceleration

  !> The unit of an AT2 file: that of UNIT, which its header must not contradict, or that of the
  !> header.
  subroutine settle_unit(this, header, faults, own_factor)
    type(card), intent(in) :: this
    type(record_header), intent(in) :: header
    type(diagnostic_list), intent(inout) :: faults
    real(rk), intent(inout) :: own_factor !< besides SCALE and UNIT
    if (header%is_no_acceleration()) then
      call this%fault_parameter(faults, 'INPUT', 'the header of the file says '// &
                                header%quantity, 'a record of acceleration')
    else if (header%names_two()) then
      call choose_unit(this, header, faults)
    else if (header%unit == '' .and. header%unknown /= '') then
      call take_unknown_unit(this, header%unknown, faults)
    else if (.not. this%has('UNIT')) then
      call find_own_factor(this, header%unit, faults, own_factor)
    else if (header%unit /= '' .and. this%word('UNIT') /= header%unit) then
      call this%fault_parameter(faults, 'UNIT', 'the header of the file names the unit '// &
                                header%unit, 'no UNIT, or UNIT='//header%unit)
    end if
  end subroutine settle_unit

  !> Of two units of a header UNIT says which is that of the values.
  subroutine choose_unit(this, header, faults)
    type(card), intent(in) :: this
    type(record_header), intent(in) :: header
    type(diagnostic_list), intent(inout) :: faults
    if (this%word('UNIT') == header%unit .or. this%word('UNIT') == header%other) return
    call this%fault_parameter(faults, trim(merge('UNIT ', 'INPUT', this%has('UNIT'))), &
                              'the header of the file names two units, '//header%unit//' and '// &
                              header%other, 'UNIT='//header%unit//' or UNIT='//header%other)
  end subroutine choose_unit

  !> A unit that is none of those known: SCALE alone can convert it.
  subroutine take_unknown_unit(this, unknown, faults)
    type(card), intent(in) :: this
    character(*), intent(in) :: unknown !< word of the header
    type(diagnostic_list), intent(inout) :: faults
    character(:), allocatable :: problem
    problem = "the header of the file names the unit '"//unknown//"', which is not known"
    if (this%has('SCALE') .and. .not. this%has('UNIT')) then
      call this%warn(faults, problem//': SCALE='//this%text('SCALE')//' is taken as its '// &
                     'conversion to m/s2')
      return
    end if
    call this%fault_parameter(faults, trim(merge('UNIT ', 'INPUT', this%has('UNIT'))), problem, &
                              'no UNIT, and in SCALE the factor from this unit to m/s2')
  end subroutine take_unknown_unit

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
