!> Descriptions of the valid values of a field, for messages and the keyword reference.
module field_text
  use keyword_spec, only: field, keyword, kind_choice, kind_flag, kind_integer, kind_real, &
                          kind_reference, kind_text, kind_word
  use kinds, only: rk
  use write_text, only: as_text
  implicit none
  private
  public :: expected_in, kind_in_words, names_of_columns, text_or_nothing, with_commas

contains

  !> "Young's modulus, a number > 0 [Pa]"; 'one of NODES, GAUSS': the choices are the expected
  !> values, without the meaning.
  pure function expected_in(described) result(text)
    type(field), intent(in) :: described
    character(:), allocatable :: text
    text = text_or_nothing(described%meaning)
    if (index(text, ';') > 0) text = text(:index(text, ';') - 1)
    if (index(text, 'of Abaqus') == 1 .or. index(text, 'of CalculiX') == 1) text = ''
    if (described%kind == kind_choice) text = ''
    if (len(text) > 0) text = text//', '
    text = text//kind_in_words(described)
    if (len(text_or_nothing(described%unit)) > 0) text = text//' ['//described%unit//']'
    if (len(text_or_nothing(described%instead)) > 0) text = text//'; '//described%instead
  end function expected_in

  !> 'a number > 0', 'an integer from 1 to 3', 'one of A, B'.
  pure function kind_in_words(described) result(text)
    type(field), intent(in) :: described
    character(:), allocatable :: text
    select case (described%kind)
    case (kind_real)
      text = 'a number'//range_in_words(described)
    case (kind_integer)
      text = 'an integer'//range_in_words(described)
    case (kind_choice)
      text = 'one of '//with_commas(text_or_nothing(described%choices))
      if (index(text, ',') == 0) text = text(len('one of ') + 1:)
    case (kind_reference)
      text = 'an id or the name of a set'
    case (kind_word)
      text = 'a name'
    case (kind_text)
      text = 'a text'
    case (kind_flag)
      text = 'a flag without value'
    case default
      text = 'a word'
    end select
  end function kind_in_words

  !> ' > 0', ' >= -1 and < 0.5', ' from 1 to 3', or ''.
  pure function range_in_words(described) result(text)
    type(field), intent(in) :: described
    character(:), allocatable :: text
    logical :: has_lowest, has_highest
    has_lowest = described%lowest > -huge(1.0_rk)
    has_highest = described%highest < huge(1.0_rk)
    text = ''
    if (has_lowest .and. has_highest .and. &
        .not. (described%excludes_lowest .or. described%excludes_highest)) then
      text = ' from '//as_text(described%lowest)//' to '//as_text(described%highest)
      return
    end if
    if (has_lowest) then
      text = trim(merge(' > ', ' >=', described%excludes_lowest))//' '//as_text(described%lowest)
    end if
    if (has_lowest .and. has_highest) text = text//' and'
    if (has_highest) then
      text = text//trim(merge(' < ', ' <=', described%excludes_highest))//' '// &
             as_text(described%highest)
    end if
  end function range_in_words

  !> 'A | B' as 'A, B'.
  pure function with_commas(choices) result(text)
    character(*), intent(in) :: choices
    character(:), allocatable :: text
    integer :: i
    text = ''
    do i = 1, len(choices)
      if (choices(i:i) == '|') then
        text = trim(text)//','
      else
        text = text//choices(i:i)
      end if
    end do
  end function with_commas

  !> 'id, x, y, z'.
  pure function names_of_columns(spec) result(text)
    type(keyword), intent(in) :: spec
    character(:), allocatable :: text
    integer :: i
    text = ''
    if (.not. allocated(spec%columns)) return
    do i = 1, size(spec%columns)
      if (i > 1) text = text//', '
      text = text//spec%columns(i)%name
    end do
    if (spec%repeats_columns) text = text//', ..'
  end function names_of_columns

  !> The text, '' if it is not allocated.
  pure function text_or_nothing(text) result(given)
    character(:), allocatable, intent(in) :: text
    character(:), allocatable :: given
    given = ''
    if (allocated(text)) given = text
  end function text_or_nothing
end module field_text
