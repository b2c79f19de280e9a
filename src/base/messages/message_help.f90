!> The pages on messages as text: `keyway --explain` and `keyway --explain NAME`.
module message_help
  use message_catalogue, only: label_of_run, list_pages
  use message_pages, only: message_page, page_list
  use nearest_words, only: nearest_word
  use wrap_text, only: hanging
  implicit none
  private
  public :: explain_message, message_lines, named_message

  character, parameter :: nl = new_line('a')
  integer, parameter :: name_width = 22, indent = 2

contains

  !> The message with the short name of its kind at the end of its first line.
  function named_message(message) result(text)
    character(*), intent(in) :: message !< lines with new_line between them
    character(:), allocatable :: text
    integer :: last
    last = index(message//nl, nl) - 1
    text = message(:last)//label_of_run(message(:last))//message(last + 1:)
  end function named_message

  !> All names, a line each.
  function message_lines() result(text)
    character(:), allocatable :: text !< lines with new_line between them
    type(page_list) :: list
    character(name_width) :: name
    integer :: i
    call list_pages(list)
    text = ''
    do i = 1, list%num_pages
      name = list%pages(i)%name
      text = text//name//hanging(list%pages(i)%cause, name_width)//nl
    end do
    text = text//nl//'keyway --explain NAME prints the page of a message; its name stands in '// &
           'brackets at its end.'
  end function message_lines

  !> The page of a message.
  subroutine explain_message(name, text, is_known)
    character(*), intent(in) :: name !< with or without its brackets
    character(:), allocatable, intent(out) :: text !< lines with new_line between them
    logical, intent(out) :: is_known !< false: the text is an error message
    type(page_list) :: list
    character(name_width), allocatable :: names(:)
    character(:), allocatable :: wanted
    integer :: i
    wanted = name
    if (index(wanted, '[') == 1) wanted = wanted(2:scan(wanted//']', ']') - 1)
    call list_pages(list)
    allocate (names(list%num_pages))
    is_known = .true.
    do i = 1, list%num_pages
      names(i) = list%pages(i)%name
      if (list%pages(i)%name == wanted) then
        text = page_of(list%pages(i))
        return
      end if
    end do
    is_known = .false.
    text = "there is no message '"//wanted//"'; expected a name of keyway --explain"
    wanted = nearest_word(wanted, names)
    if (len(wanted) > 0) text = text//"; did you mean '"//wanted//"'?"
  end subroutine explain_message

  !> Name, cause, remedy and example.
  function page_of(page) result(text)
    type(message_page), intent(in) :: page
    character(:), allocatable :: text
    text = page%name//nl//'  '//hanging(page%cause, indent)//nl//nl// &
           'What to do'//nl//'  '//hanging(page%remedy, indent)
    if (len(page%wrong) == 0) return
    text = text//nl//nl//'Example'//nl//'  in place of  '//page%wrong//nl// &
           '  take         '//page%right
  end function page_of
end module message_help
