!> All kinds of messages, and the name of the kind that a message is of.
!>
!> A message is recognised by its words, without those in quotes, which come from the deck. The
!> first page whose signs fit gives the name; what a message expects counts after what it found.
module message_catalogue
  use message_pages, only: message_page, page_list
  use pages_of_decks, only: add_pages_of_decks
  use pages_of_models, only: add_pages_of_models
  use pages_of_runs, only: add_page_of_umat, add_pages_of_runs
  use pages_of_values, only: add_pages_of_values
  implicit none
  private
  public :: label_of_fault, label_of_run, list_pages

  character(*), parameter :: last_resort = 'wrong-value' !< fits all that is expected

contains

  !> Every page: decks and models, then runs.
  subroutine list_pages(list)
    type(page_list), intent(out) :: list
    call add_pages_of_decks(list)
    call add_pages_of_models(list)
    call add_pages_of_values(list)
    call add_pages_of_runs(list)
  end subroutine list_pages

  !> ' [no-support]' for a fault of a deck; '' where no page fits.
  function label_of_fault(problem, expected) result(label)
    character(*), intent(in) :: problem !< what is wrong
    character(*), intent(in) :: expected !< '' for none
    character(:), allocatable :: label
    type(page_list) :: list
    call add_pages_of_decks(list)
    call add_page_of_umat(list)
    call add_pages_of_models(list)
    call add_pages_of_values(list)
    label = label_in(list, problem, expected)
  end function label_of_fault

  !> ' [disk-full]' for the first line of a message of a run; '' where no page fits, and where the
  !> line has a label.
  function label_of_run(message) result(label)
    character(*), intent(in) :: message
    character(:), allocatable :: label
    type(page_list) :: list
    label = ''
    if (len(message) == 0) return
    if (message(len(message):) == ']') return
    call add_pages_of_runs(list)
    label = label_in(list, message, '')
    if (len(label) == 0) label = label_of_fault(message, '')
  end function label_of_run

  !> The label by the first page that fits what was found, else what was expected.
  pure function label_in(list, problem, expected) result(label)
    type(page_list), intent(in) :: list
    character(*), intent(in) :: problem, expected
    character(:), allocatable :: label
    character(:), allocatable :: found, whole
    logical :: is_value !< what was found is a value
    integer :: i
    found = without_quoted(problem)
    whole = found
    if (len(expected) > 0) whole = found//'; expected '//without_quoted(expected)
    label = ''
    is_value = .false.
    do i = 1, list%num_pages
      if (list%pages(i)%name == last_resort) then
        is_value = list%pages(i)%fits(found) .and. .not. has_bare_value(found)
      end if
      if (list%pages(i)%name == last_resort) cycle
      if (list%pages(i)%fits(found)) label = name_in_brackets(list%pages(i))
      if (len(label) > 0) return
    end do
    do i = 1, list%num_pages
      if (is_value .and. list%pages(i)%name /= last_resort) cycle
      if (list%pages(i)%fits(whole)) label = name_in_brackets(list%pages(i))
      if (len(label) > 0) return
    end do
  end function label_in

  !> Whether a message begins with what was found, without quotes: 'found 4 nodes'. Words of what
  !> is expected then say more of the kind.
  pure logical function has_bare_value(found)
    character(*), intent(in) :: found !< what was found, '' for what stands in quotes
    has_bare_value = index(found, 'found ') == 1 .and. index(found, "found '") == 0
  end function has_bare_value

  !> ' [no-support]'.
  pure function name_in_brackets(page) result(label)
    type(message_page), intent(in) :: page
    character(:), allocatable :: label
    label = ' ['//page%name//']'
  end function name_in_brackets

  !> The text with '' in place of what stands in quotes; an apostrophe alone stays.
  pure function without_quoted(text) result(plain)
    character(*), intent(in) :: text
    character(:), allocatable :: plain
    integer :: i, length
    plain = ''
    i = 1
    do while (i <= len(text))
      plain = plain//text(i:i)
      if (text(i:i) == "'") then
        length = index(text(i + 1:), "'")
        if (length > 0) plain = plain//"'"
        i = i + length
      end if
      i = i + 1
    end do
  end function without_quoted
end module message_catalogue
