!> Paragraphs in lines that a terminal shows whole.
module wrap_text
  implicit none
  private
  public :: hanging, wrapped

  integer, parameter :: page_width = 96 !< letters of a line
  character, parameter :: nl = new_line('a')

contains

  !> Paragraphs, every line indented.
  pure function wrapped(text, indent) result(lines)
    character(*), intent(in) :: text !< new_line between paragraphs
    integer, intent(in) :: indent
    character(:), allocatable :: lines
    integer :: first, last
    lines = ''
    first = 1
    do while (first <= len(text))
      last = index(text(first:)//nl, nl) + first - 2
      if (first > 1) lines = lines//nl
      lines = lines//repeat(' ', indent)//hanging(text(first:last), indent)
      first = last + 2
    end do
  end function wrapped

  !> A paragraph whose later lines are indented.
  pure function hanging(text, indent) result(lines)
    character(*), intent(in) :: text
    integer, intent(in) :: indent
    character(:), allocatable :: lines
    integer :: first, last
    lines = ''
    first = 1
    do while (len(text) - first + 1 > page_width - indent)
      last = index(text(first:first + page_width - indent), ' ', back=.true.)
      if (last <= 1) exit
      lines = lines//text(first:first + last - 2)//nl//repeat(' ', indent)
      first = first + last
    end do
    lines = lines//text(first:)
  end function hanging
end module wrap_text
