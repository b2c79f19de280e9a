!> Free or fixed form of a Fortran source, from its content: the extension is not reliable.
module umat_source_form
  use parse_text, only: upper_case
  implicit none
  private
  public :: source_form, form_of_source

  !> Properties of a source for the compiler.
  type :: source_form
    logical :: is_free = .false.
    logical :: has_directives = .false. !< of the preprocessor: #include, #define, ..
  end type source_form

  character, parameter :: tab = achar(9), return = achar(13)
  integer, parameter :: continuation_column = 6 !< of the fixed form

contains

  !> Tests in this order: a directive FREEFORM or FIXEDFORM; a trailing '&'; a comment or
  !> continuation of the fixed form; a statement in columns 1-5. Else both forms are valid, and
  !> fixed is taken.
  pure function form_of_source(text) result(form)
    character(*), intent(in) :: text !< the whole file, lines ended by LF or CRLF
    type(source_form) :: form
    character(:), allocatable :: line
    integer :: first, last
    logical :: is_told, goes_on, is_fixed, is_left
    is_told = .false.
    goes_on = .false.
    is_fixed = .false.
    is_left = .false.
    first = 1
    do while (first <= len(text))
      last = first + index(text(first:)//new_line('a'), new_line('a')) - 2
      line = without_return(text(first:last))
      first = last + 2
      form%has_directives = form%has_directives .or. is_for_preprocessor(line)
      is_fixed = is_fixed .or. is_of_fixed_form(line)
      if (names_form(line)) then
        is_told = .true.
        form%is_free = index(upper_case(line), 'NOFREEFORM') == 0 .and. &
                       index(upper_case(line), 'FREEFORM') > 0
      else if (.not. is_comment(line)) then
        goes_on = goes_on .or. ends_in_ampersand(line)
        is_left = is_left .or. starts_at_left(line)
      end if
    end do
    if (is_told) return
    form%is_free = goes_on .or. (is_left .and. .not. is_fixed)
  end function form_of_source

  pure function without_return(line) result(clean)
    character(*), intent(in) :: line
    character(:), allocatable :: clean
    clean = line
    if (len(line) == 0) return
    if (line(len(line):) == return) clean = line(:len(line) - 1)
  end function without_return

  !> '#include' or similar, in column 1 or after blanks.
  pure logical function is_for_preprocessor(line)
    character(*), intent(in) :: line
    is_for_preprocessor = index(adjustl(line), '#') == 1
  end function is_for_preprocessor

  !> '!DIR$ FREEFORM', '!DEC$ FIXEDFORMLINESIZE:132', 'CDIR$ NOFREEFORM'
  pure logical function names_form(line)
    character(*), intent(in) :: line
    character(len(line)) :: upper
    upper = upper_case(line)
    names_form = scan(upper(:min(1, len(upper))), '!C*') == 1 .and. &
                 (index(upper, 'DIR$') == 2 .or. index(upper, 'DEC$') == 2) .and. &
                 (index(upper, 'FREEFORM') > 0 .or. index(upper, 'FIXEDFORM') > 0)
  end function names_form

  !> Whether a line is a comment in either form. A statement of the free form with C in column 1
  !> counts as a comment too; other lines then decide.
  pure logical function is_comment(line)
    character(*), intent(in) :: line
    is_comment = scan(line(:min(1, len(line))), 'Cc*!#dD') == 1 .or. index(adjustl(line), '!') == 1
  end function is_comment

  !> '*' in column 1, or a continuation mark in column 6 after five blanks.
  pure logical function is_of_fixed_form(line)
    character(*), intent(in) :: line
    is_of_fixed_form = index(line, '*') == 1
    if (is_of_fixed_form .or. len(line) < continuation_column) return
    if (line(:continuation_column - 1) /= ' ') return
    is_of_fixed_form = scan(line(continuation_column:continuation_column), '&$+*123456789>.:@|-') &
                       == 1 .and. index(line, tab) == 0
  end function is_of_fixed_form

  !> Whether a statement starts in columns 1 to 5, where the fixed form has labels only.
  pure logical function starts_at_left(line)
    character(*), intent(in) :: line
    integer :: first
    starts_at_left = .false.
    first = verify(line, ' 0123456789')
    if (first == 0 .or. first >= continuation_column) return
    starts_at_left = line(first:first) /= tab
  end function starts_at_left

  !> Whether '&' precedes the comment or the end. A '!' in a text does not start a comment.
  pure logical function ends_in_ampersand(line)
    character(*), intent(in) :: line
    character :: quote
    integer :: i, last
    quote = ' '
    last = 0
    do i = 1, len(line)
      if (quote /= ' ') then
        if (line(i:i) == quote) quote = ' '
      else if (line(i:i) == '!') then
        exit
      else if (scan(line(i:i), '''"') == 1) then
        quote = line(i:i)
      end if
      if (line(i:i) /= ' ' .and. line(i:i) /= tab) last = i
    end do
    ends_in_ampersand = .false.
    if (last == 0) return
    ends_in_ampersand = line(last:last) == '&' .and. verify(line(:last), ' &') > 0
  end function ends_in_ampersand
end module umat_source_form
