!> The table of fields as text: `keyway --fields` and `keyway --fields NAME`.
module field_help
  use field_table, only: find_field, list_fields
  use field_type, only: at_joints, counted, place_names, result_field
  use nearest_words, only: nearest_word
  use parse_text, only: single_blanks, upper_case
  use print_kinds, only: file_pattern, kinds_of_prints
  use wrap_text, only: hanging
  implicit none
  private
  public :: field_lines, field_page

  character, parameter :: nl = new_line('a')
  integer, parameter :: longest_name = 16

contains

  !> All fields, a line each.
  function field_lines() result(text)
    character(:), allocatable :: text !< lines with new_line between them
    type(result_field), allocatable :: table(:)
    integer :: i
    call list_fields(table)
    text = line_of('FIELD', 'WHERE', 'UNIT', 'MEANING')
    do i = 1, size(table)
      text = text//line_of(table(i)%name, trim(place_names(table(i)%place)), table(i)%unit, &
                           table(i)%meaning)
    end do
    text = text//nl//'keyway --fields NAME prints all about a field.'
  end function field_lines

  !> One line of the list.
  pure function line_of(name, where_it_is, unit, meaning) result(line)
    character(*), intent(in) :: name, where_it_is, unit, meaning
    character(:), allocatable :: line
    character(longest_name) :: first, second
    character(8) :: third
    first = name
    second = where_it_is
    third = unit
    line = first//second//third//meaning//nl
  end function line_of

  !> Description of a field.
  subroutine field_page(name, text, is_known)
    character(*), intent(in) :: name !< in any case
    character(:), allocatable, intent(out) :: text !< lines with new_line between them
    logical, intent(out) :: is_known !< false: the text is an error message
    type(result_field), allocatable :: table(:)
    character(longest_name), allocatable :: names(:)
    character(:), allocatable :: wanted, nearest
    integer :: i
    call list_fields(table)
    wanted = single_blanks(upper_case(name))
    i = find_field(table, wanted)
    is_known = i > 0
    if (is_known) then
      text = page(table(i))
      return
    end if
    text = "there is no field '"//wanted//"'; expected a name of keyway --fields"
    names = [character(longest_name) ::]
    do i = 1, size(table)
      names = [character(longest_name) :: names, table(i)%name]
    end do
    nearest = nearest_word(wanted, names)
    if (len(nearest) > 0) text = text//"; did you mean '"//nearest//"'?"
  end subroutine field_page

  !> Name and value in each line.
  pure function page(item) result(text)
    type(result_field), intent(in) :: item
    character(:), allocatable :: text
    text = entry_of('field', item%name)//entry_of('meaning', item%meaning)// &
           entry_of('components', component_names(item))// &
           entry_of('where', trim(place_names(item%place)))//entry_of('unit', item%unit)// &
           entry_of('computed by', item%provider)//entry_of('requested by', keywords(item))// &
           entry_of('written to', files_of(item))
    if (len(item%remark) > 0) text = text//entry_of('remark', item%remark)
    text = text(:len(text) - 1)
  end function page

  !> Name and value, the value wrapped.
  pure function entry_of(name, value) result(line)
    character(*), intent(in) :: name, value
    character(:), allocatable :: line
    character(longest_name) :: wide
    wide = name
    line = wide//hanging(value, longest_name)//nl
  end function entry_of

  !> Names of the components.
  pure function component_names(item) result(text)
    type(result_field), intent(in) :: item
    character(:), allocatable :: text
    if (item%endings == counted) then
      text = item%columns(2)//',..'
    else
      text = item%columns(item%num_endings())
    end if
  end function component_names

  !> Keywords that may name the field, synonyms included.
  pure function keywords(item) result(text)
    type(result_field), intent(in) :: item
    character(:), allocatable :: text
    character(14), parameter :: names(5) = ['NODE FILE     ', 'NODE OUTPUT   ', 'EL FILE       ', &
                                            'ELEMENT OUTPUT', 'ENVELOPE      ']
    character(14), parameter :: as(5) = ['NODE FILE     ', 'NODE FILE     ', 'EL FILE       ', &
                                         'EL FILE       ', 'ENVELOPE      ']
    character(11) :: print_keyword
    integer :: i
    text = ''
    do i = 1, size(kinds_of_prints)
      print_keyword = kinds_of_prints(i)%keyword
      if (item%is_allowed_in(trim(print_keyword))) text = text//', *'//trim(print_keyword)
    end do
    do i = 1, size(names)
      if (item%is_allowed_in(trim(as(i)))) text = text//', *'//trim(names(i))
    end do
    if (len(text) == 0) text = ', written with the other fields of joints'
    text = text(3:)
  end function keywords

  !> Files that hold the field.
  pure function files_of(item) result(text)
    type(result_field), intent(in) :: item
    character(:), allocatable :: text
    integer :: i
    text = ''
    do i = 1, size(kinds_of_prints)
      if (item%is_allowed_in(trim(kinds_of_prints(i)%keyword))) then
        text = text//', '//file_pattern(kinds_of_prints(i))
      end if
    end do
    if (is_in_series(item)) text = text//', job.pvd'
    if (associated(item%of_joint)) text = text//', job_joints.pvd'
    if (is_in_series(item) .or. item%place == at_joints) text = text//', job.h5'
    if (item%is_allowed_in('ENVELOPE')) text = text//', envelopes'
    text = text(3:)
  end function files_of

  !> May a deck request the field in the VTK series?
  pure logical function is_in_series(item)
    type(result_field), intent(in) :: item
    is_in_series = item%is_allowed_in('NODE FILE') .or. item%is_allowed_in('EL FILE')
  end function is_in_series
end module field_help
