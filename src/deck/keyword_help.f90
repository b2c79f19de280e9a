!> The keyword reference, made from the specifications with which decks are checked.
module keyword_help
  use card_check, only: is_refused
  use field_text, only: kind_in_words, text_or_nothing
  use keyword_spec, only: field, find_spec, keyword, kind_flag, later, refused, without_effect
  use nearest_words, only: nearest_word
  use parse_text, only: single_blanks, upper_case, without_blanks
  use wrap_text, only: hanging, wrapped
  use write_text, only: as_text
  implicit none
  private
  public :: list_keywords, describe_keyword

  integer, parameter :: name_width = 34 !< room for the name of a keyword in the list
  integer, parameter :: field_width = 20 !< room for the name of a field
  character, parameter :: nl = new_line('a')

contains

  !> The list of all keywords by family, one line each.
  pure function list_keywords(specs) result(text)
    type(keyword), intent(in) :: specs(:)
    character(:), allocatable :: text !< lines with new_line between them
    integer :: i, j
    text = ''
    do i = 1, size(specs)
      if (any([(same_family(specs(j), specs(i)), j=1, i - 1)])) cycle
      if (len(text) > 0) text = text//nl
      text = text//upper_case(text_or_nothing(specs(i)%family))//nl
      do j = i, size(specs)
        if (.not. same_family(specs(j), specs(i))) cycle
        text = text//padded('  *'//specs(j)%name, name_width)//' '// &
               first_sentence(text_or_nothing(specs(j)%meaning))//remark(specs(j))//nl
      end do
    end do
    text = text//nl//'keyway --keywords NAME describes one keyword.'
  end function list_keywords

  !> The page of a keyword; a name with several places has several pages.
  pure subroutine describe_keyword(specs, name, text, is_known)
    type(keyword), intent(in) :: specs(:)
    character(*), intent(in) :: name !< with or without its star, in any case
    character(:), allocatable, intent(out) :: text !< lines with new_line between them
    logical, intent(out) :: is_known !< false: the text is a message
    character(80) :: names(size(specs))
    character(:), allocatable :: wanted, nearest
    integer :: i
    wanted = single_blanks(upper_case(name))
    if (index(wanted, '*') == 1) wanted = single_blanks(wanted(2:))
    is_known = find_spec(specs, wanted) > 0
    text = ''
    do i = 1, size(specs)
      names(i) = specs(i)%name
      if (without_blanks(specs(i)%name) /= without_blanks(wanted)) cycle
      if (len(text) > 0) text = text//nl//nl
      text = text//page(specs(i))
    end do
    if (is_known) return
    text = "unknown keyword '*"//wanted//"'; expected a name of keyway --keywords"
    nearest = nearest_word(wanted, names)
    if (len(nearest) > 0) text = text//"; did you mean '*"//nearest//"'?"
  end subroutine describe_keyword

  !> The page of one keyword.
  pure function page(spec) result(text)
    type(keyword), intent(in) :: spec
    character(:), allocatable :: text
    text = '*'//spec%name//remark(spec)
    if (len(text_or_nothing(spec%place)) > 0) text = text//'  ('//place_in_words(spec%place)//')'
    if (allocated(spec%meaning)) text = text//nl//wrapped(spec%meaning, 2)
    if (allocated(spec%parameters)) then
      if (size(spec%parameters) > 0) text = text//nl//nl//'Parameters'//rows(spec%parameters)
    end if
    if (allocated(spec%variants)) text = text//variants(spec)
    if (allocated(spec%columns)) then
      if (size(spec%columns) > 0) text = text//nl//nl//data_title(spec)//rows(spec%columns)
    end if
    if (spec%most_lines == 0) text = text//nl//nl//'No data lines'
    if (len(text_or_nothing(spec%example)) > 0) then
      text = text//nl//nl//'Example'//nl//indented(spec%example)
    end if
  end function page

  !> A paragraph and the further parameters for each variant.
  pure function variants(spec) result(text)
    type(keyword), intent(in) :: spec
    character(:), allocatable :: text
    integer :: i
    text = ''
    do i = 1, size(spec%variants)
      associate (one => spec%variants(i))
        text = text//nl//nl//'With '//spec%chooser//'='//one%name//nl// &
               wrapped(text_or_nothing(one%meaning), 2)//nl//rows(one%parameters)
      end associate
    end do
  end function variants

  !> 'Data lines: at least 1'.
  pure function data_title(spec) result(text)
    type(keyword), intent(in) :: spec
    character(:), allocatable :: text
    text = 'Data lines'
    if (spec%most_lines == spec%fewest_lines) then
      text = text//': '//as_text(spec%fewest_lines)
    else if (spec%most_lines < huge(1)) then
      text = text//': '//as_text(spec%fewest_lines)//' to '//as_text(spec%most_lines)
    else if (spec%fewest_lines > 0) then
      text = text//': '//as_text(spec%fewest_lines)//' or more'
    end if
    if (spec%new_clears) text = text//'; none to clear with OP=NEW'
    if (spec%repeats_columns) text = text//'; the columns may repeat in a line'
  end function data_title

  !> One or more lines for each field.
  pure function rows(fields) result(text)
    type(field), intent(in) :: fields(:)
    character(:), allocatable :: text
    integer :: i
    text = ''
    do i = 1, size(fields)
      text = text//nl//padded('  '//fields(i)%name, field_width)//' '// &
             hanging(sentence(fields(i)), field_width + 1)
    end do
  end function rows

  !> Meaning, kind, range, unit and default of a field.
  pure function sentence(described) result(text)
    type(field), intent(in) :: described
    character(:), allocatable :: text
    text = text_or_nothing(described%meaning)
    if (described%has_no_effect .or. is_refused(described)) return
    if (described%kind == kind_flag) then
      text = text//' (flag)'
    else
      text = text//'; '//kind_in_words(described)
    end if
    if (len(text_or_nothing(described%unit)) > 0) text = text//' ['//described%unit//']'
    if (described%is_required) text = text//'; required'
    if (len(text_or_nothing(described%default)) > 0) then
      text = text//'; default '//described%default
    end if
  end function sentence

  !> Where a keyword may stand.
  pure function place_in_words(where_it_stands) result(text)
    character(*), intent(in) :: where_it_stands !< place of the specification
    character(:), allocatable :: text
    select case (where_it_stands)
    case ('step')
      text = 'in a step'
    case ('model')
      text = 'in the model'
    case ('material')
      text = 'in a material'
    case default
      text = where_it_stands
    end select
  end function place_in_words

  !> A remark on a keyword that is not available or has no effect.
  pure function remark(spec) result(text)
    type(keyword), intent(in) :: spec
    character(:), allocatable :: text
    select case (spec%status)
    case (later)
      text = ' (not available yet)'
    case (refused)
      text = ' (not available)'
    case (without_effect)
      text = ' (no effect here)'
    case default
      text = ''
    end select
  end function remark

  !> Whether both keywords belong to one family.
  pure logical function same_family(a, b)
    type(keyword), intent(in) :: a, b
    same_family = text_or_nothing(a%family) == text_or_nothing(b%family)
  end function same_family

  !> The text up to its first full stop. One before a figure ends no sentence: 'Eq. 15'.
  pure function first_sentence(text) result(sentence)
    character(*), intent(in) :: text
    character(:), allocatable :: sentence
    integer :: i
    sentence = text
    do i = 1, len(text) - 2
      if (text(i:i + 1) /= '. ' .or. scan(text(i + 2:i + 2), '0123456789') > 0) cycle
      sentence = text(:i - 1)
      return
    end do
    if (len(sentence) == 0) return
    if (sentence(len(sentence):) == '.') sentence = sentence(:len(sentence) - 1)
  end function first_sentence

  !> The text, filled with blanks up to a width.
  pure function padded(text, width) result(wide)
    character(*), intent(in) :: text
    integer, intent(in) :: width
    character(:), allocatable :: wide
    wide = text//repeat(' ', max(width - len(text), 0))
  end function padded

  !> Lines, each indented by two blanks.
  pure function indented(text) result(lines)
    character(*), intent(in) :: text
    character(:), allocatable :: lines
    integer :: i
    lines = '  '
    do i = 1, len(text)
      lines = lines//text(i:i)
      if (text(i:i) == nl) lines = lines//'  '
    end do
  end function indented
end module keyword_help
