!> Files of numbers that *AMPLITUDE names: plain numbers, or the records of PEER (AT2).
module history_file
  use, intrinsic :: iso_fortran_env, only: iostat_end
  use deck_file, only: first_letter, why_no_text
  use diagnostics, only: diagnostic_list, place, severity_error
  use growing_lists, only: make_room
  use kinds, only: rk
  use parse_text, only: largest_number, parse_integer, parse_real, upper_case
  use process_limits, only: why_no_file
  use record_units, only: record_header
  use text_buffers, only: text_buffer
  use utf8_text, only: make_utf8
  implicit none
  private
  public :: number_file, read_numbers, read_at2_header

  character(*), parameter :: separators = ' ,;'//achar(9)//achar(13)
  integer, parameter :: num_at2_headers = 4 !< lines above the values of a PEER file
  integer, parameter :: num_looked_at = 2 !< lines: in UTF-16 an empty first one has no zero byte
  character(*), parameter :: words_of_at2 = ' NPTS DT ' !< in the fourth line, beside numbers
  character(*), parameter :: words_of_seconds = ' S S. SEC SEC. SECS SECOND SECONDS '
  character(*), parameter :: expected_numbers = "'NPTS= <points>, DT= <seconds>' in the fourth line"

  !> Numbers of a file in their order.
  type :: number_file
    character(:), allocatable :: path
    real(rk), allocatable :: values(:)
    integer, allocatable :: line(:) !< line of each value
    integer :: open_line = 0 !< first line with an odd number of values and a comma at its end
  end type number_file

contains

  !> Reads all numbers below `num_headers` lines. Lines that begin with * or # are comments.
  subroutine read_numbers(path, num_headers, spot, faults, numbers)
    character(*), intent(in) :: path
    integer, intent(in) :: num_headers
    type(place), intent(in) :: spot !< place of the file name in the deck
    type(diagnostic_list), intent(inout) :: faults
    type(number_file), intent(out) :: numbers
    character(:), allocatable :: line, reason
    integer :: unit, status, number, used
    numbers%path = path
    reason = why_no_file(path)
    if (len(reason) > 0) then
      call faults%add(severity_error, spot, "cannot read '"//path//"': "//reason)
      allocate (numbers%values(0), numbers%line(0))
      return
    end if
    allocate (numbers%values(1024), numbers%line(1024))
    used = 0
    open (newunit=unit, file=path, status='old', action='read', iostat=status)
    if (status /= 0) then
      call faults%add(severity_error, spot, "cannot open the file '"//path//"'", &
                      wanted_file(path), file_in_other_case(path))
    else
      number = 0
      do
        call read_line(unit, line, status)
        if (status /= 0 .and. len(line) == 0) exit
        number = number + 1
        if (number == 1) line = line(first_letter(line):)
        if (number <= num_looked_at .and. index(line, achar(0)) > 0) reason = why_no_text(line)
        if (reason /= '') exit
        if (number > num_headers) call add_line(line, number, spot, faults, numbers, used)
        if (status /= 0) exit
      end do
      close (unit)
      if (reason /= '') call faults%add(severity_error, spot, "cannot read '"//path//"': "//reason)
    end if
    numbers%values = numbers%values(:used)
    numbers%line = numbers%line(:used)
  end subroutine read_numbers

  !> One line of any length, in UTF-8.
  subroutine read_line(unit, line, status)
    integer, intent(in) :: unit
    character(:), allocatable, intent(out) :: line
    integer, intent(out) :: status !< not zero at the end of the file
    type(text_buffer) :: longer
    character(256) :: piece
    integer :: length
    read (unit, '(a)', advance='no', iostat=status, size=length) piece
    line = piece(:length)
    if (status == 0) then
      call longer%add(line)
      do while (status == 0)
        read (unit, '(a)', advance='no', iostat=status, size=length) piece
        call longer%add(piece(:length))
      end do
      line = longer%contents()
    end if
    call make_utf8(line, first_letter(line))
    if (is_iostat_eor(status)) status = 0
    if (status /= 0) status = iostat_end
  end subroutine read_line

  subroutine add_line(line, number, spot, faults, numbers, used)
    character(*), intent(in) :: line
    integer, intent(in) :: number !< of the line
    type(place), intent(in) :: spot
    type(diagnostic_list), intent(inout) :: faults
    type(number_file), intent(inout) :: numbers
    integer, intent(inout) :: used !< entries in use
    integer :: first, last, num_before, most
    logical :: is_number
    num_before = used
    first = verify(line, ' '//achar(9))
    if (first > 0) then
      if (index('*#', line(first:first)) > 0) return
    end if
    last = 0
    do
      first = verify(line(last + 1:), separators) + last
      if (first == last) exit
      most = merge(0, 1, used == num_before)
      if (num_commas(line(last + 1:first - 1)) > most) then
        call faults%add(severity_error, spot_in_file(numbers%path, number, first, first, line, &
                                                     spot), &
                        'an empty field before this number', 'a number between two commas')
        return
      end if
      last = scan(line(first:), separators) + first - 2
      if (last < first) last = len(line)
      call make_room(numbers%values, used, 1)
      call make_room(numbers%line, used, 1)
      call parse_real(line(first:last), numbers%values(used + 1), is_number)
      is_number = is_number .and. abs(numbers%values(used + 1)) <= largest_number &
                  .and. .not. is_fraction(line, first, last)
      if (.not. is_number) then
        call faults%add(severity_error, spot_in_file(numbers%path, number, first, last, line, &
                                                     spot), &
                        "found '"//line(first:last)//"'", &
                        expected_word(numbers%path, number, is_fraction(line, first, last)))
        return
      end if
      used = used + 1
      numbers%line(used) = number
    end do
    if (num_commas(line(last + 1:)) == 0 .or. mod(used - num_before, 2) == 0) return
    if (numbers%open_line == 0) numbers%open_line = number
  end subroutine add_line

  !> Commas and semicolons between two numbers, or at the end of a line.
  pure integer function num_commas(text)
    character(*), intent(in) :: text
    integer :: i
    num_commas = count([(scan(text(i:i), ',;') > 0, i=1, len(text))])
  end function num_commas

  !> Whether a word is what follows a decimal comma, as in 0,012: no number of its own begins so.
  pure logical function is_fraction(line, first, last)
    character(*), intent(in) :: line
    integer, intent(in) :: first, last !< of the word
    is_fraction = .false.
    if (first == 1 .or. first == last) return
    is_fraction = line(first - 1:first) == ',0' .and. verify(line(first:last), '0123456789') == 0
  end function is_fraction

  !> What a word should be. Above the values of a PEER file words are read without FORMAT=AT2 alone.
  pure function expected_word(path, number, is_decimal) result(text)
    character(*), intent(in) :: path
    integer, intent(in) :: number !< of the line
    logical, intent(in) :: is_decimal !< it follows a decimal comma
    character(:), allocatable :: text
    text = 'a number'
    if (is_decimal) text = 'a number, with a point for its decimals: commas separate numbers'
    if (number > num_at2_headers .or. len(path) < 4) return
    if (upper_case(path(len(path) - 3:)) /= '.AT2') return
    text = 'FORMAT=AT2 for a PEER record, or a number'
  end function expected_word

  !> What the name of a file should be: paths of Windows have another separator.
  pure function wanted_file(path) result(text)
    character(*), intent(in) :: path
    character(:), allocatable :: text
    text = 'a file that exists, relative to the deck'
    if (index(path, '\') > 0) text = text//'; / separates folders here, not \'
  end function wanted_file

  !> The name of a file that exists, all of its letters small or large; '' for none.
  function file_in_other_case(path) result(name)
    character(*), intent(in) :: path
    character(:), allocatable :: name
    character(len(path)) :: small
    logical :: is_there
    integer :: i, first
    first = index(path, '/', back=.true.) + 1
    small = path
    do i = first, len(path)
      if (path(i:i) >= 'A' .and. path(i:i) <= 'Z') small(i:i) = achar(iachar(path(i:i)) + 32)
    end do
    name = small(first:)
    inquire (file=small, exist=is_there)
    if (is_there) return
    name = upper_case(path(first:))
    inquire (file=path(:first - 1)//name, exist=is_there)
    if (.not. is_there) name = ''
  end function file_in_other_case

  !> Place of a word in the file.
  pure function spot_in_file(path, number, first, last, line, named_at) result(spot)
    character(*), intent(in) :: path
    integer, intent(in) :: number !< of the line
    integer, intent(in) :: first, last !< letters
    character(*), intent(in) :: line
    type(place), intent(in) :: named_at !< place of the file name in the deck
    type(place) :: spot
    spot%file = path
    spot%line = number
    spot%column = first
    spot%length = last - first + 1
    spot%keyword = named_at%keyword
    spot%source = line
  end function spot_in_file

  !> Number of points and time step from the fourth line of a PEER file, unit from all of them:
  !> 'NPTS= 1559, DT= .02000 SEC' or the older '1559 .0200 NPTS, DT'.
  subroutine read_at2_header(path, spot, faults, num_points, dt, header)
    character(*), intent(in) :: path
    type(place), intent(in) :: spot !< place of the file name in the deck
    type(diagnostic_list), intent(inout) :: faults
    integer, intent(out) :: num_points
    real(rk), intent(out) :: dt !< [s]
    type(record_header), intent(out) :: header
    character(:), allocatable :: line
    integer :: unit, status, i, odd(2)
    num_points = 0
    dt = 0.0_rk
    header = record_header('', '', '', '')
    open (newunit=unit, file=path, status='old', action='read', iostat=status)
    if (status /= 0) return ! reported before
    do i = 1, num_at2_headers
      call read_line(unit, line, status)
      call header%note_line(line)
    end do
    close (unit)
    call take_numbers(upper_case(line), num_points, dt, odd)
    if (num_points > 0 .and. odd(1) > 0) then
      call faults%add(severity_error, &
                      spot_in_file(path, num_at2_headers, odd(1), odd(2), line, spot), &
                      "found '"//line(odd(1):odd(2))//"' beside the number of points and the "// &
                      'time between them', expected_numbers//', with no unit or SEC')
    else if (.not. (num_points > 0 .and. dt > 0.0_rk)) then
      call faults%add(severity_error, &
                      spot_in_file(path, num_at2_headers, 1, len(line), line, spot), &
                      'the file is not a PEER record', expected_numbers)
    end if
  end subroutine read_at2_header

  !> The first integer and the number after it, in a line that names DT. Words stand beside the
  !> numbers up to SEC; one that is none of those known may be another unit.
  pure subroutine take_numbers(line, num_points, dt, odd)
    character(*), intent(in) :: line !< in upper case
    integer, intent(inout) :: num_points
    real(rk), intent(inout) :: dt !< [s]
    integer, intent(out) :: odd(2) !< first and last letter of a word that is not known; 0 for none
    integer :: first, last, number
    real(rk) :: value, found
    logical :: is_number, names_dt
    last = 0
    odd = 0
    found = 0.0_rk
    names_dt = .false.
    do
      first = verify(line(last + 1:), separators//'=():') + last
      if (first == last) exit
      last = scan(line(first:), separators//'=():') + first - 2
      if (last < first) last = len(line)
      call parse_real(line(first:last), value, is_number)
      if (is_number .and. num_points == 0) then
        call parse_integer(line(first:last), number, is_number)
        if (is_number) num_points = number
      else if (is_number .and. abs(found) <= 0.0_rk) then
        found = value
      end if
      if (is_number) cycle
      names_dt = names_dt .or. line(first:last) == 'DT'
      if (index(words_of_at2, ' '//line(first:last)//' ') > 0) cycle
      if (index(words_of_seconds, ' '//line(first:last)//' ') == 0) odd = [first, last]
      if (odd(1) > 0 .or. (found > 0.0_rk .and. names_dt)) exit
    end do
    if (names_dt) dt = found
  end subroutine take_numbers
end module history_file
