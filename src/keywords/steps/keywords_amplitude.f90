!> *AMPLITUDE.
module keywords_amplitude
  use amplitudes, only: amplitude
  use deck_card, only: card
  use diagnostics, only: diagnostic_list, place, severity_error
  use deck_file, only: path_of_named
  use history_file, only: number_file, read_at2_header, read_numbers
  use keyword_spec, only: keyword, field, kind_choice, kind_real, kind_text, kind_word
  use keywords_other, only: add_idle_parameters, add_refused_parameter
  use kinds, only: rk
  use model_draft, only: draft
  use record_units, only: choices_of_units, factor_beside_scale, record_header, settle_unit
  use write_text, only: as_text
  implicit none
  private
  public :: describe_amplitude, read_amplitude

  character, parameter :: nl = new_line('a')
  integer, parameter :: num_at2_headers = 4 !< lines above the values of a PEER file
  character(*), parameter :: by_pairs = 'TABULAR', by_interval = 'EQUALLY SPACED'

contains

  subroutine describe_amplitude(spec)
    type(keyword), intent(out) :: spec
    spec%name = 'AMPLITUDE'
    spec%family = 'load'
    spec%place = 'model'
    spec%meaning = 'A history that scales loads, supports or the motion of the base. Linear '// &
                   'between its points, constant outside them. From data lines or '// &
                   'from a file (INPUT, relative to the deck). VALUES and AT2 begin at time 0.'
    spec%example = '*AMPLITUDE, NAME=RAMP'//nl//'0., 0., 1., 1.'//nl// &
                   '*AMPLITUDE, NAME=QUAKE, INPUT=record.AT2, FORMAT=AT2, UNIT=G'
    allocate (spec%parameters, source=[ &
              field('NAME', kind_word, 'name of the history', is_required=.true.), &
              field('TIME', kind_choice, 'clock of the history', default='STEP TIME', &
                    choices='STEP TIME | TOTAL TIME'), &
              field('INPUT', kind_text, 'file with the numbers, in place of data lines'), &
              field('FORMAT', kind_choice, 'time, value pairs; values every DT; a PEER record', &
                    default='PAIRS', choices='PAIRS | VALUES | AT2'), &
              field('DT', kind_real, 'time between VALUES', 's', lowest=0.0_rk, &
                    excludes_lowest=.true.), &
              field('UNIT', kind_choice, 'unit of a record of acceleration, which is turned '// &
                    'into m/s2; without UNIT values stay as they are, but an AT2 file is '// &
                    'turned by the unit that its header names', choices=choices_of_units), &
              field('SCALE', kind_real, 'factor of all values', '', '1'), &
              field('DEFINITION', kind_choice, 'of Abaqus: pairs, or values every FIXED '// &
                    'INTERVAL', default='TABULAR', choices=by_pairs//' | '//by_interval, &
                    rules_lines=.true.), &
              field('FIXED INTERVAL', kind_real, 'time between values that are EQUALLY SPACED', &
                    's', lowest=0.0_rk, excludes_lowest=.true.), &
              field('BEGIN', kind_real, 'time of the first of them', 's', '0'), &
              field('VALUE', kind_choice, 'of Abaqus: factors of the loads', default='RELATIVE', &
                    choices='RELATIVE')])
    spec%parameters(8)%instead = 'for any other history, such as PERIODIC or SMOOTH STEP, '// &
                                 'its points as a table'
    call add_idle_parameters(spec, ['SMOOTH'])
    call add_refused_parameter(spec, 'SHIFTX', 'the shift added to the times of the table')
    call add_refused_parameter(spec, 'SHIFTY', 'the shift added to the values of the table')
    allocate (spec%columns, source=[ &
              field('time', kind_real, 'time (or, with VALUES, a value)', 's'), &
              field('value', kind_real, 'value at that time')])
    spec%repeats_columns = .true.
  end subroutine describe_amplitude

  subroutine read_amplitude(this, model, faults)
    type(card), intent(in) :: this
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(amplitude) :: new
    type(number_file) :: numbers
    real(rk) :: own_factor
    integer :: earlier, num_before
    num_before = faults%num_errors
    new%name = this%word('NAME')
    new%uses_total_time = this%word('TIME') == 'TOTAL TIME'
    earlier = model%amplitude_of_name%find(new%name)
    if (earlier > 0) then
      call this%fault_parameter(faults, 'NAME', "amplitude '"//this%text('NAME')// &
                                "' is defined twice", 'a name that is used once')
    end if
    call collect_numbers(this, faults, numbers)
    own_factor = 1.0_rk
    if (faults%num_errors == num_before) then
      call shape_history(this, numbers, faults, new, own_factor)
      if (allocated(new%value)) then
        new%value = new%value*factor_beside_scale(this, this%word('UNIT'), faults)*own_factor
      end if
    end if
    if (.not. allocated(new%time)) new%time = [0.0_rk] ! the name exists, its faults are reported
    if (.not. allocated(new%value)) new%value = [0.0_rk]
    if (earlier > 0) return
    call model%amplitude_of_name%find_or_add(new%name, model%num_amplitudes)
    model%problem%amplitudes(model%num_amplitudes) = new
    model%record_factor(model%num_amplitudes) = own_factor
    model%record_unit(model%num_amplitudes) = this%word('UNIT')
  end subroutine read_amplitude

  !> The numbers of the card or of its file.
  subroutine collect_numbers(this, faults, numbers)
    type(card), intent(in) :: this
    type(diagnostic_list), intent(inout) :: faults
    type(number_file), intent(out) :: numbers
    type(place) :: spot
    integer :: line, i, used, num_headers
    if (this%has('INPUT')) then
      spot = this%place_of('INPUT')
      if (this%num_lines > 0) then
        call this%fault_parameter(faults, 'INPUT', 'a file together with data lines', 'one of them')
        return
      end if
      num_headers = merge(num_at2_headers, 0, this%word('FORMAT') == 'AT2')
      call read_numbers(path_of_named(spot%file, this%text('INPUT')), num_headers, spot, faults, &
                        numbers)
      return
    end if
    allocate (numbers%values(sum([(this%num_fields(line), line=1, this%num_lines)])))
    allocate (numbers%line(size(numbers%values)))
    used = 0
    do line = 1, this%num_lines
      do i = 1, this%num_fields(line)
        if (this%is_empty_at(line, i)) then
          call this%fault_at(faults, line, i, 'found an empty field', 'a number')
          return
        end if
        used = used + 1
        numbers%values(used) = this%real_at(line, i)
        numbers%line(used) = line
      end do
      if (mod(this%num_fields(line), 2) == 1 .and. numbers%open_line == 0) then
        if (this%ends_in_comma(line)) numbers%open_line = line
      end if
    end do
  end subroutine collect_numbers

  !> Turns the numbers into times and values by FORMAT.
  subroutine shape_history(this, numbers, faults, new, own_factor)
    type(card), intent(in) :: this
    type(number_file), intent(in) :: numbers
    type(diagnostic_list), intent(inout) :: faults
    type(amplitude), intent(inout) :: new
    real(rk), intent(inout) :: own_factor !< of the unit that only the file names
    type(record_header) :: header
    character(:), allocatable :: format
    real(rk) :: dt
    integer :: i, num_points
    if (size(numbers%values) == 0 .and. this%has('INPUT')) then
      call this%fault_parameter(faults, 'INPUT', 'the file has no numbers', 'a file of numbers')
      return
    else if (size(numbers%values) == 0) then
      call this%fault(faults, 'the amplitude is empty', 'data lines or a file with numbers')
      return
    end if
    call choose_format(this, faults, format, dt)
    if (this%has('DT') .and. this%word('FORMAT') /= 'VALUES') then
      call this%fault_parameter(faults, 'DT', 'DT has no effect with '//this%word('FORMAT'), &
                                'DT only with FORMAT=VALUES')
    end if
    select case (format)
    case ('PAIRS')
      call shape_pairs(this, numbers, faults, new)
      return
    case ('VALUES') ! dt is known
    case default
      if (.not. this%has('INPUT')) then
        call this%fault_parameter(faults, 'FORMAT', 'AT2 without a file', 'INPUT=<file>')
        return
      end if
      call read_at2_header(numbers%path, this%place_of('INPUT'), faults, num_points, dt, header)
      if (num_points > 0) call settle_unit(this, header, faults, own_factor)
      if (num_points > 0 .and. num_points /= size(numbers%values)) then
        call this%fault_parameter(faults, 'INPUT', 'the file holds '// &
                                  as_text(size(numbers%values))//' values', &
                                  as_text(num_points)//' by its header (NPTS)')
      end if
    end select
    new%value = numbers%values*this%real('SCALE')
    new%time = [(this%real('BEGIN') + (i - 1)*dt, i=1, size(new%value))]
  end subroutine shape_history

  !> FORMAT, or what DEFINITION of Abaqus means by it, and the time between values.
  subroutine choose_format(this, faults, format, dt)
    type(card), intent(in) :: this
    type(diagnostic_list), intent(inout) :: faults
    character(:), allocatable, intent(out) :: format
    real(rk), intent(out) :: dt !< [s]
    format = this%word('FORMAT')
    dt = this%real('DT')
    if (this%word('DEFINITION') == by_interval) then
      format = 'VALUES'
      dt = this%real('FIXED INTERVAL')
      if (.not. this%has('FIXED INTERVAL')) then
        call this%fault(faults, by_interval//' without FIXED INTERVAL', &
                        'FIXED INTERVAL, the time between values [s]')
      else if (this%has('FORMAT')) then
        call this%fault_parameter(faults, 'FORMAT', 'FORMAT beside '//by_interval, 'one of them')
      end if
    else if (this%has('FIXED INTERVAL') .or. this%has('BEGIN')) then
      call this%fault(faults, 'FIXED INTERVAL and BEGIN have no effect', &
                      'DEFINITION='//by_interval//' with them')
    else if (format == 'VALUES' .and. .not. this%has('DT')) then
      call this%fault(faults, 'VALUES without DT', 'DT, the time between values [s]')
    end if
  end subroutine choose_format

  !> time, value, time, value, ...
  subroutine shape_pairs(this, numbers, faults, new)
    type(card), intent(in) :: this
    type(number_file), intent(in) :: numbers
    type(diagnostic_list), intent(inout) :: faults
    type(amplitude), intent(inout) :: new
    integer :: i
    if (numbers%open_line > 0) then
      call fault_number(this, numbers, findloc(numbers%line, numbers%open_line, 1, back=.true.), &
                        'a time without a value', 'pairs of time and value', faults)
      return
    else if (mod(size(numbers%values), 2) == 1) then
      call this%fault(faults, 'an odd number of values', 'pairs of time and value')
      return
    end if
    new%time = numbers%values(1::2)
    new%value = numbers%values(2::2)*this%real('SCALE')
    do i = 2, size(new%time)
      if (new%time(i) > new%time(i - 1)) cycle
      call fault_number(this, numbers, 2*i - 1, 'time '//as_text(new%time(i))//' after '// &
                        as_text(new%time(i - 1)), 'times that ascend', faults)
      return
    end do
  end subroutine shape_pairs

  !> Fault of a number of the card or of its file; `number` is its position among the numbers.
  subroutine fault_number(this, numbers, number, problem, expected, faults)
    type(card), intent(in) :: this
    type(number_file), intent(in) :: numbers
    integer, intent(in) :: number
    character(*), intent(in) :: problem, expected
    type(diagnostic_list), intent(inout) :: faults
    type(place) :: spot
    integer :: line
    line = numbers%line(number)
    if (this%has('INPUT')) then
      spot%file = numbers%path
      spot%line = line
      spot%keyword = this%keyword
      call faults%add(severity_error, spot, problem, expected)
    else
      call this%fault_at(faults, line, number - count(numbers%line < line), problem, expected)
    end if
  end subroutine fault_number
end module keywords_amplitude
