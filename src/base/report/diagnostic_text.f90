!> The text of diagnostics: messages on faults of the deck.
!>
!>     dam.inp:12: *ELASTIC: found '31 GPa'; expected Poisson's ratio, a number < 0.5 [wrong-value]
!>        12 | 31e9, 31 GPa
!>           |       ^^^^^^
module diagnostic_text
  use diagnostics, only: diagnostic, diagnostic_list, place, severity_error, severity_ignored, &
                         severity_warning
  use fault_kinds, only: fault_kind
  use invisible_letters, only: name_of_invisible
  use message_catalogue, only: label_of_fault
  use text_buffers, only: text_buffer
  use utf8_text, only: utf8_width
  use write_text, only: as_text
  implicit none
  private
  public :: text_of_errors, text_of_warnings, remarks_for_log, headline

  integer, parameter :: widest_line = 100 !< letters of a deck line that are shown
  integer, parameter :: margin = 30 !< letters shown before the word when a line is cut
  character(*), parameter :: cut_mark = '...' !< where letters of a line are left out
  integer, parameter :: number_width = 5 !< room for the line number
  character, parameter :: tab = achar(9)

contains

  !> The errors kept, and how many more there are of each kind. Things that do not exist come after
  !> the other errors, of which they may be consequences; many of one kind are one error.
  function text_of_errors(list, is_named) result(text)
    type(diagnostic_list), intent(in) :: list
    logical, intent(in), optional :: is_named !< each message ends with the name of its kind
    character(:), allocatable :: text !< lines separated by new_line; '' without errors
    integer :: order(list%num_kept), i
    integer :: num_shown(list%kinds%num_kinds)
    text = ''
    order = order_by_place(list)
    num_shown = 0
    do i = 1, list%num_kept
      associate (fault => list%errors(order(i)))
        if (is_many(list, fault%kind) .and. num_shown(fault%kind) == 1) cycle
        num_shown(fault%kind) = num_shown(fault%kind) + 1
        text = text//new_line('a')//text_of_diagnostic(fault, is_named)
      end associate
    end do
    do i = 1, size(num_shown)
      associate (kind => list%kinds%kinds(i))
        if (kind%num > num_shown(i)) then
          text = text//new_line('a')//further_errors(kind, kind%num - num_shown(i))
        end if
      end associate
    end do
    text = text(min(2, len(text) + 1):)
  end function text_of_errors

  !> Whether errors of a kind are shown as one.
  pure logical function is_many(list, kind)
    type(diagnostic_list), intent(in) :: list
    integer, intent(in) :: kind
    is_many = list%kinds%kinds(kind)%num > list%kinds%kinds(kind)%most_shown
  end function is_many

  !> 'and 96 more in lines 14 to 107: *ELSET: element .. does not exist'.
  pure function further_errors(kind, num) result(text)
    type(fault_kind), intent(in) :: kind
    integer, intent(in) :: num !< errors that are not shown
    character(:), allocatable :: text
    text = 'and '//as_text(num)//' more'
    if (kind%file /= '' .and. kind%last_line > kind%first_line) then
      text = text//' in lines '//as_text(kind%first_line)//' to '//as_text(kind%last_line)
    else if (kind%file /= '' .and. kind%last_line > 0) then
      text = text//' in line '//as_text(kind%last_line)
    end if
    text = text//': '//printable(kind%name)
  end function further_errors

  !> Positions of the errors by file and line: first files that cannot be read, then the errors that
  !> stand alone, then names that do not exist, then what other cards lack; errors of one line stay
  !> in the order found.
  pure function order_by_place(list) result(order)
    type(diagnostic_list), intent(in) :: list
    integer :: order(list%num_kept)
    integer :: file(list%num_kept), i, j
    do i = 1, list%num_kept
      do j = 1, i ! files count in the order in which they are first named
        if (list%errors(j)%spot%file == list%errors(i)%spot%file) exit
      end do
      file(i) = j
      associate (kind => list%kinds%kinds(list%errors(i)%kind))
        if (kind%is_lost_file) file(i) = j - list%num_kept
        if (kind%is_reference) file(i) = j + list%num_kept
        if (kind%is_absence) file(i) = j + 2*list%num_kept
      end associate
      do j = i - 1, 1, -1
        if (file(order(j)) < file(i) .or. file(order(j)) == file(i) .and. &
            list%errors(order(j))%spot%line <= list%errors(i)%spot%line) exit
        order(j + 1) = order(j)
      end do
      order(j + 1) = i
    end do
  end function order_by_place

  !> All warnings and notes on ignored input, without the deck lines; '' without any.
  function text_of_warnings(list, is_named, severity) result(text)
    type(diagnostic_list), intent(in) :: list
    logical, intent(in), optional :: is_named !< each message ends with the name of its kind
    integer, intent(in), optional :: severity !< those of one severity alone
    character(:), allocatable :: text !< lines with new_line between them, none at the end
    type(text_buffer) :: lines
    integer :: i
    do i = 1, list%num_warnings
      if (present(severity)) then
        if (list%warnings(i)%severity /= severity) cycle
      end if
      if (lines%length > 0) call lines%add(new_line('a'))
      call lines%add(named_headline(list%warnings(i), is_named))
    end do
    text = lines%contents()
  end function text_of_warnings

  !> The warnings and the ignored cards as they are printed, each kind below its heading.
  function remarks_for_log(list) result(text)
    type(diagnostic_list), intent(in) :: list
    character(:), allocatable :: text !< lines with new_line before each; '' without any
    character, parameter :: nl = new_line('a')
    character(:), allocatable :: warnings, ignored
    warnings = text_of_warnings(list, .true., severity_warning)
    ignored = text_of_warnings(list, .true., severity_ignored)
    text = ''
    if (warnings /= '') text = nl//'warnings of the deck'//nl//warnings
    if (ignored /= '') text = text//nl//'ignored input'//nl//ignored
  end function remarks_for_log

  !> One fault: the headline, the line of the deck, carets, and the place of an earlier definition.
  function text_of_diagnostic(fault, is_named) result(text)
    type(diagnostic), intent(in) :: fault
    logical, intent(in), optional :: is_named
    character(:), allocatable :: text
    text = named_headline(fault, is_named)//excerpt(fault%spot)
    if (allocated(fault%first%file)) then
      text = text//new_line('a')//'  first defined here: '//fault%first%file//':'// &
             as_text(fault%first%line)//excerpt(fault%first)
    end if
  end function text_of_diagnostic

  !> The headline and, if `is_named`, the short name of its kind, as [wrong-value].
  function named_headline(fault, is_named) result(text)
    type(diagnostic), intent(in) :: fault
    logical, intent(in), optional :: is_named
    character(:), allocatable :: text
    text = headline(fault)
    if (.not. present(is_named)) return
    if (is_named) text = text//label_of_fault(fault%problem, fault%expected)
  end function named_headline

  !> file:line: *KEYWORD: what is wrong; what was expected.
  pure function headline(fault) result(text)
    type(diagnostic), intent(in) :: fault
    character(:), allocatable :: text, hidden
    text = printable(fault%spot%file)//':'
    if (fault%spot%line > 0) text = text//as_text(fault%spot%line)//':'
    text = text//' '
    if (allocated(fault%spot%keyword)) then
      if (len(fault%spot%keyword) > 0) text = text//'*'//printable(fault%spot%keyword)//': '
    end if
    if (fault%severity /= severity_error) text = text//'warning: '
    text = text//printable(fault%problem)
    hidden = hidden_in(fault%spot)
    if (len(hidden) > 0) text = text//'; the word has '//hidden
    if (len(fault%expected) > 0) text = text//'; expected '//printable(fault%expected)
    if (len(fault%nearest) > 0) text = text//"; did you mean '"//printable(fault%nearest)//"'?"
  end function headline

  !> The name of an invisible letter in the word that is meant; '' without one.
  pure function hidden_in(spot) result(name)
    type(place), intent(in) :: spot
    character(:), allocatable :: name
    integer :: last
    name = ''
    if (.not. allocated(spot%source) .or. spot%column == 0) return
    last = min(spot%column + spot%length - 1, len(spot%source))
    name = name_of_invisible(spot%source(spot%column:last))
  end function hidden_in

  !> The line of the deck and carets below the word; '' where no line is known.
  pure function excerpt(spot) result(text)
    type(place), intent(in) :: spot
    character(:), allocatable :: text
    integer :: first, last
    text = ''
    if (.not. allocated(spot%source) .or. spot%line == 0) return
    first = 1
    last = len_trim(spot%source)
    if (last > widest_line) then
      first = max(1, min(spot%column - margin, last - widest_line + 1))
      last = min(last, first + widest_line - 1)
      do while (first > 1 .and. continues_letter(spot%source(first:first)))
        first = first - 1
      end do
      do while (last < len(spot%source))
        if (.not. continues_letter(spot%source(last + 1:last + 1))) exit
        last = last + 1
      end do
    end if
    text = printable(spot%source(first:last))
    if (first > 1) text = cut_mark//text
    if (last < len_trim(spot%source)) text = text//cut_mark
    text = new_line('a')//line_label(as_text(spot%line))//text
    if (spot%column == 0 .or. spot%length == 0) return
    text = text//new_line('a')//line_label('')
    if (first > 1) text = text//repeat(' ', len(cut_mark))
    text = text//blank_like(spot, first)//carets(spot, last)
  end function excerpt

  !> '   12 | '
  pure function line_label(number) result(text)
    character(*), intent(in) :: number !< of the line, or ''
    character(:), allocatable :: text
    text = repeat(' ', max(number_width - len(number), 0))//number//' | '
  end function line_label

  !> Blanks as wide as the text before the word: tabs stay, letters of several bytes count once.
  pure function blank_like(spot, first) result(text)
    type(place), intent(in) :: spot
    integer, intent(in) :: first !< first byte of the line that is shown
    character(:), allocatable :: text
    integer :: i
    text = ''
    do i = first, spot%column - 1
      if (i > len(spot%source)) then
        text = text//' '
      else if (spot%source(i:i) == tab) then
        text = text//tab
      else if (.not. continues_letter(spot%source(i:i))) then
        text = text//' '
      end if
    end do
  end function blank_like

  !> A caret below each letter of the word.
  pure function carets(spot, last) result(text)
    type(place), intent(in) :: spot
    integer, intent(in) :: last !< last byte of the line that is shown
    character(:), allocatable :: text
    integer :: i
    text = '^'
    do i = spot%column + 1, min(spot%column + spot%length - 1, last)
      if (.not. continues_letter(spot%source(i:i))) text = text//'^'
    end do
  end function carets

  !> Whether the byte continues a letter in UTF-8.
  pure logical function continues_letter(byte)
    character, intent(in) :: byte
    continues_letter = iand(ichar(byte), 192) == 128
  end function continues_letter

  !> The text with control characters turned to '?', since terminals obey them; tabs stay.
  pure function printable(text) result(clean)
    character(*), intent(in) :: text
    character(:), allocatable :: clean
    integer :: i, width, used
    clean = text
    i = 1
    used = 0
    do while (i <= len(text))
      width = max(1, utf8_width(text(i:)))
      if (is_control(text(i:i + width - 1))) then
        clean(used + 1:used + 1) = '?'
        used = used + 1
      else
        clean(used + 1:used + width) = text(i:i + width - 1)
        used = used + width
      end if
      i = i + width
    end do
    clean = clean(:used)
  end function printable

  !> Whether a letter is a control character: below 32, or from 127 to U+009F; no tab.
  pure logical function is_control(letter)
    character(*), intent(in) :: letter !< in UTF-8
    if (len(letter) == 1) then
      is_control = ichar(letter) < 32 .and. letter /= tab .or. ichar(letter) == 127
    else
      is_control = ichar(letter(1:1)) == 194 .and. ichar(letter(2:2)) < 160
    end if
  end function is_control
end module diagnostic_text
