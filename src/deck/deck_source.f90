!> The lines of a deck with all included files, without blank lines and comments.
module deck_source
  use deck_file, only: first_letter, load_text, path_of_named
  use deck_words, only: is_blank, next_word, split_parameter
  use diagnostics, only: diagnostic_list, place, severity_error, severity_ignored
  use file_identity, only: is_same_file
  use parse_text, only: upper_case, without_blanks
  use write_text, only: as_text
  implicit none
  private
  public :: source_text, source_line, read_source, spot_in_source
  public :: names_abaqus

  character, parameter :: line_feed = achar(10), return = achar(13)
  integer, parameter :: letters_of_head = 2000 !< of a file, where programs name themselves
  integer, parameter :: deepest = 100 !< levels of *INCLUDE

  !> One file.
  type :: source_file
    character(:), allocatable :: path !< as the user named it
    character(:), allocatable :: text !< in UTF-8
  end type source_file

  !> One line that is neither blank nor a comment.
  type :: source_line
    integer :: file = 0 !< index into `files`
    integer :: number = 0 !< line in the file, from 1
    integer :: first = 1, last = 0 !< its bytes in the file, without trailing blanks
    logical :: is_keyword = .false. !< begins with a star
  end type source_line

  !> All lines of a deck in the order in which they are read.
  type :: source_text
    type(source_file), allocatable :: files(:)
    type(source_line), allocatable :: lines(:) !< the first `num_lines` are in use
    integer :: num_lines = 0
  end type source_text

contains

  !> Reads a deck and all included files. Missing files are faults.
  subroutine read_source(path, source, faults)
    character(*), intent(in) :: path !< of the deck
    type(source_text), intent(out) :: source
    type(diagnostic_list), intent(inout) :: faults
    type(place) :: nowhere
    integer :: parents(0)
    allocate (source%files(0), source%lines(1024))
    nowhere%file = path
    call read_file(path, nowhere, parents, source, faults)
  end subroutine read_source

  !> Whether Abaqus/CAE names itself at the beginning of a file.
  pure logical function names_abaqus(source)
    type(source_text), intent(in) :: source
    integer :: i
    names_abaqus = .false.
    do i = 1, size(source%files)
      associate (text => source%files(i)%text)
        names_abaqus = names_abaqus .or. &
                       index(upper_case(text(:min(len(text), letters_of_head))), 'ABAQUS/CAE') > 0
      end associate
    end do
  end function names_abaqus

  !> Adds the lines of one file, with the lines of included files in their places.
  recursive subroutine read_file(path, named_at, parents, source, faults)
    character(*), intent(in) :: path
    type(place), intent(in) :: named_at !< place of the file's name in the deck
    integer, intent(in) :: parents(:) !< files that are being read
    type(source_text), intent(inout) :: source
    type(diagnostic_list), intent(inout) :: faults
    type(source_line), allocatable :: lines(:)
    type(place) :: spot
    character(:), allocatable :: name
    integer :: file, i, num_heads
    call find_or_load(path, named_at, source, faults, file)
    if (file == 0) return
    if (size(parents) > deepest) then
      call faults%add(severity_error, named_at, 'the file is below more than '// &
                      as_text(deepest)//' levels of *INCLUDE', &
                      'at most '//as_text(deepest)//' levels')
      return
    end if
    if (any(parents == file)) then
      call faults%add(severity_error, named_at, 'the file includes itself', &
                      'files that do not include each other')
      return
    end if
    call find_lines(source%files(file)%text, file, lines)
    i = 1
    do while (i <= size(lines))
      if (is_include(source, lines(i))) then
        call read_include(source, lines(i:), faults, name, spot, num_heads)
        if (len(name) > 0) then
          call read_file(path_of_named(path, name), spot, [parents, file], source, faults)
        end if
        i = i + num_heads
      else if (is_stray(source, lines(i))) then
        call faults%add(severity_ignored, spot_in_source(source, lines(i), 1, 0, ''), &
                        'a line of control characters alone (Ctrl-Z or form feed) has no effect')
        i = i + 1
      else
        call append_line(source, lines(i))
        i = i + 1
      end if
    end do
  end subroutine read_file

  !> Position of a file in the list; a new file is read. 0: the file cannot be read.
  subroutine find_or_load(path, named_at, source, faults, file)
    character(*), intent(in) :: path
    type(place), intent(in) :: named_at !< place of the file's name in the deck
    type(source_text), intent(inout) :: source
    type(diagnostic_list), intent(inout) :: faults
    integer, intent(out) :: file
    type(source_file), allocatable :: longer(:)
    type(source_file) :: new
    character(:), allocatable :: reason
    integer :: i
    do file = 1, size(source%files)
      if (source%files(file)%path == path) return
      if (is_same_file(source%files(file)%path, path)) return
    end do
    file = 0
    call load_text(path, new%text, reason)
    if (len(reason) > 0) then
      call faults%add(severity_error, named_at, "cannot read '"//path//"': "//reason)
      return
    end if
    new%path = path
    file = size(source%files) + 1
    allocate (longer(file))
    do i = 1, file - 1
      longer(i)%path = source%files(i)%path
      call move_alloc(source%files(i)%text, longer(i)%text)
    end do
    longer(file)%path = path
    call move_alloc(new%text, longer(file)%text)
    call move_alloc(longer, source%files)
  end subroutine find_or_load

  !> The lines of a file without blank lines and comments.
  pure subroutine find_lines(text, file, lines)
    character(*), intent(in) :: text !< of the file
    integer, intent(in) :: file !< its number
    type(source_line), allocatable, intent(out) :: lines(:)
    integer :: first, last, number, num_used, begin
    allocate (lines(count_lines(text)))
    first = first_letter(text)
    num_used = 0
    number = 0
    do while (first <= len(text))
      number = number + 1
      last = index(text(first:), line_feed)
      last = merge(first + last - 2, len(text), last > 0)
      call trim_line(text, first, last, begin, lines(num_used + 1)%last)
      if (counts(text(begin:lines(num_used + 1)%last))) then
        num_used = num_used + 1
        lines(num_used)%file = file
        lines(num_used)%number = number
        lines(num_used)%first = first
        lines(num_used)%is_keyword = text(begin:begin) == '*'
      end if
      first = last + 2
    end do
    lines = lines(:num_used)
  end subroutine find_lines

  !> Number of line feeds in a text, plus one.
  pure integer function count_lines(text)
    character(*), intent(in) :: text
    integer :: i
    count_lines = 1
    do i = 1, len(text)
      if (text(i:i) == line_feed) count_lines = count_lines + 1
    end do
  end function count_lines

  !> First and last letter of a line, without blanks around them.
  pure subroutine trim_line(text, first, last, begin, end)
    character(*), intent(in) :: text
    integer, intent(in) :: first, last !< the line, without its line feed
    integer, intent(out) :: begin, end !< begin > end where the line is blank
    end = last
    do while (end >= first)
      if (.not. is_blank(text(end:end)) .and. text(end:end) /= return) exit
      end = end - 1
    end do
    begin = first
    do while (begin <= end)
      if (.not. is_blank(text(begin:begin))) exit
      begin = begin + 1
    end do
  end subroutine trim_line

  !> Whether the line is neither a comment nor blank.
  pure logical function counts(line)
    character(*), intent(in) :: line !< without blanks around it
    counts = len(line) > 0
    if (len(line) > 1) counts = line(1:2) /= '**'
  end function counts

  !> Whether the line has nothing but marks of old systems: Ctrl-Z for the end of a file, form feed
  !> for a new page.
  pure logical function is_stray(source, line)
    type(source_text), intent(in) :: source
    type(source_line), intent(in) :: line
    is_stray = verify(source%files(line%file)%text(line%first:line%last), &
                      achar(26)//achar(12)//' '//achar(9)//return) == 0
  end function is_stray

  !> Whether the line is *INCLUDE.
  pure logical function is_include(source, line)
    type(source_text), intent(in) :: source
    type(source_line), intent(in) :: line
    integer :: star, comma
    is_include = .false.
    if (.not. line%is_keyword) return
    associate (text => source%files(line%file)%text(line%first:line%last))
      star = index(text, '*')
      comma = index(text, ',')
      if (comma == 0) comma = len(text) + 1
      is_include = without_blanks(upper_case(text(star + 1:comma - 1))) == 'INCLUDE'
    end associate
  end function is_include

  !> Reads *INCLUDE, INPUT=name, which may continue in the next line.
  subroutine read_include(source, lines, faults, name, spot, num_heads)
    type(source_text), intent(in) :: source
    type(source_line), intent(in) :: lines(:) !< the line of *INCLUDE and the following ones
    type(diagnostic_list), intent(inout) :: faults
    character(:), allocatable, intent(out) :: name !< '' if none is given
    type(place), intent(out) :: spot !< of the name
    integer, intent(out) :: num_heads !< lines of *INCLUDE
    integer :: i
    name = ''
    num_heads = 1
    spot = spot_in_source(source, lines(1), 1, lines(1)%last - lines(1)%first + 1, 'INCLUDE')
    if (size(lines) > 1) then
      associate (text => source%files(lines(2)%file)%text)
        if (text(lines(1)%last:lines(1)%last) == ',' .and. .not. lines(2)%is_keyword .and. &
            index(text(lines(2)%first:lines(2)%last), '=') > 0) num_heads = 2
      end associate
    end if
    do i = 1, num_heads
      call read_include_words(source, lines(i), i == 1, faults, name, spot)
    end do
    if (len(name) > 0) return
    call faults%add(severity_error, spot, 'no file is named', 'INPUT=file')
  end subroutine read_include

  !> Reads the parameters in one line of *INCLUDE.
  subroutine read_include_words(source, line, is_first, faults, name, spot)
    type(source_text), intent(in) :: source
    type(source_line), intent(in) :: line
    logical, intent(in) :: is_first !< the line begins with the keyword
    type(diagnostic_list), intent(inout) :: faults
    character(:), allocatable, intent(inout) :: name !< unchanged if not in this line
    type(place), intent(inout) :: spot !< of the name
    integer :: position, first, last, equals, key_last, value_first, value_last
    associate (text => source%files(line%file)%text(line%first:line%last))
      position = 1
      if (is_first) call next_word(text, position, first, last)
      do while (position <= len(text))
        call next_word(text, position, first, last)
        if (first > last) cycle
        call split_parameter(text, first, last, equals, key_last, value_first, value_last)
        if (upper_case(text(first:key_last)) == 'INPUT') then
          name = text(value_first:value_last)
          spot = spot_in_source(source, line, value_first, value_last, 'INCLUDE')
        else
          call faults%add(severity_error, &
                          spot_in_source(source, line, first, key_last, 'INCLUDE'), &
                          "unknown parameter '"//text(first:key_last)//"'", 'INPUT=file')
        end if
      end do
    end associate
  end subroutine read_include_words

  !> Place of some bytes of a line.
  pure function spot_in_source(source, line, first, last, keyword) result(spot)
    type(source_text), intent(in) :: source
    type(source_line), intent(in) :: line
    integer, intent(in) :: first, last !< bytes, counted from the start of the line
    character(*), intent(in) :: keyword !< '' where there is none
    type(place) :: spot
    spot%file = source%files(line%file)%path
    spot%line = line%number
    spot%column = first
    spot%length = last - first + 1
    spot%keyword = keyword
    spot%source = source%files(line%file)%text(line%first:line%last)
  end function spot_in_source

  !> Adds a line at the end.
  pure subroutine append_line(source, line)
    type(source_text), intent(inout) :: source
    type(source_line), intent(in) :: line
    type(source_line), allocatable :: longer(:)
    if (source%num_lines == size(source%lines)) then
      allocate (longer(2*source%num_lines))
      longer(:source%num_lines) = source%lines
      call move_alloc(longer, source%lines)
    end if
    source%num_lines = source%num_lines + 1
    source%lines(source%num_lines) = line
  end subroutine append_line
end module deck_source
