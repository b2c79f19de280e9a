!> The effective deck: every card with its default values.
module deck_echo
  use deck_card, only: card
  use field_text, only: text_or_nothing
  use keyword_spec, only: field, kind_flag, kind_integer, kind_real, kind_word
  use kinds, only: rk
  use parse_text, only: parse_real
  use text_buffers, only: text_buffer
  use write_text, only: as_text
  implicit none
  private
  public :: echo_of_cards

  character, parameter :: nl = new_line('a')
  integer, parameter :: widest = 96 !< letters of a line
  integer, parameter :: most_lines = 8 !< data lines that are repeated

contains

  !> The deck with defaults. Long data are counted, not repeated.
  function echo_of_cards(cards) result(text)
    type(card), intent(in) :: cards(:)
    character(:), allocatable :: text !< lines with new_line between them
    type(text_buffer) :: lines
    integer :: i, line
    do i = 1, size(cards)
      if (i > 1) call lines%add(nl)
      call lines%add(head_of_card(cards(i)))
      if (cards(i)%num_lines > most_lines) then
        call lines%add(nl//'** '//as_text(cards(i)%num_lines)//' data lines')
        cycle
      end if
      do line = 1, cards(i)%num_lines
        call lines%add(nl//data_line(cards(i), line))
      end do
    end do
    text = lines%contents()
  end function echo_of_cards

  !> The keyword line with every parameter that is given or has a default.
  function head_of_card(this) result(text)
    type(card), intent(in) :: this
    character(:), allocatable :: text
    character(:), allocatable :: line, word
    integer :: i
    text = ''
    line = '*'//this%keyword
    if (allocated(this%spec%parameters)) then
      do i = 1, size(this%spec%parameters)
        word = parameter_text(this, i)
        if (word == '') cycle
        if (len(line) + len(word) + 3 > widest) then
          text = text//line//','//nl
          line = '  '//word
        else
          line = line//', '//word
        end if
      end do
    end if
    text = text//line
  end function head_of_card

  !> KEY=VALUE of a parameter, '' when it is not given and has no default.
  function parameter_text(this, number) result(text)
    type(card), intent(in) :: this
    integer, intent(in) :: number
    character(:), allocatable :: text
    associate (described => this%spec%parameters(number))
      text = ''
      if (.not. this%has(described%name) .and. .not. is_value(described)) return
      text = described%name
      if (described%kind /= kind_flag) text = text//'='//this%text(described%name)
    end associate
  end function parameter_text

  !> Whether the default of a field is a value, not an explanation.
  pure logical function is_value(described)
    type(field), intent(in) :: described
    character(:), allocatable :: default
    real(rk) :: number
    default = text_or_nothing(described%default)
    is_value = len(default) > 0
    if (described%kind == kind_real .or. described%kind == kind_integer) then
      call parse_real(default, number, is_value)
    else if (described%kind == kind_word) then
      is_value = .false.
    end if
  end function is_value

  !> A data line, with the defaults of its empty fields.
  function data_line(this, line) result(text)
    type(card), intent(in) :: this
    integer, intent(in) :: line
    character(:), allocatable :: text
    type(text_buffer) :: fields
    integer :: i, num
    num = this%num_fields(line)
    do i = 1, num
      if (i > 1) call fields%add(', ')
      call fields%add(this%text_at(line, i))
    end do
    text = fields%contents()
    if (.not. allocated(this%spec%columns) .or. this%spec%repeats_columns) return
    if (this%spec%checks_own_data) return
    do i = num + 1, size(this%spec%columns)
      if (.not. is_value(this%spec%columns(i))) exit
      text = text//', '//this%text_at(line, i)
    end do
  end function data_line
end module deck_echo
