!> The specification of a keyword: source of the parser's checks, the messages and
!> `keyway --keywords`.
module keyword_spec
  use kinds, only: rk
  use parse_text, only: without_blanks
  implicit none
  private
  public :: keyword, keyword_variant, field
  public :: parameter_default, column_default, column_of_field, find_spec
  public :: choices_of, spec_of_variant
  public :: kind_real, kind_integer, kind_word, kind_flag, kind_choice, kind_text, kind_reference
  public :: available, later, without_effect, refused

  !> Kinds of values of a field.
  integer, parameter :: kind_real = 1, kind_integer = 2, kind_word = 3, kind_flag = 4
  integer, parameter :: kind_choice = 5 !< one word of `choices`
  integer, parameter :: kind_text = 6 !< any text, kept unchanged (file names)
  integer, parameter :: kind_reference = 7 !< a number, or the name of a set

  !> Availability of a keyword.
  integer, parameter :: available = 1
  integer, parameter :: later = 2 !< known, an error: 'not available yet'
  integer, parameter :: without_effect = 3 !< understood, a warning
  integer, parameter :: refused = 4 !< known, an error; `way_out` says what to take instead

  !> A parameter of the keyword line, or a column of its data lines.
  type :: field
    character(:), allocatable :: name !< upper case for parameters
    integer :: kind = kind_real
    character(:), allocatable :: meaning !< a short sentence
    character(:), allocatable :: unit !< '' where there is none
    character(:), allocatable :: default !< '' where there is none
    character(:), allocatable :: choices !< words separated by ' | '
    logical :: is_required = .false.
    real(rk) :: lowest = -huge(1.0_rk), highest = huge(1.0_rk) !< allowed range
    logical :: excludes_lowest = .false., excludes_highest = .false. !< open range
    logical :: may_be_bare = .false. !< a parameter that may stand without a value
    logical :: is_checked_later = .false. !< the handler checks the value
    logical :: rules_lines = .false. !< an unknown choice leaves open what the data lines hold
    logical :: has_no_effect = .false. !< of other programs, with any value; noted as ignored input
    character(:), allocatable :: instead !< of other programs: what to take in place of a parameter
    !< that is refused, or of a value beside `choices`
  end type field

  !> What a keyword takes besides where one of its parameters has a certain value: the constants of
  !> one law, say.
  type :: keyword_variant
    character(:), allocatable :: name !< upper case: the value of the parameter
    character(:), allocatable :: meaning !< a sentence or more
    type(field), allocatable :: parameters(:)
  end type keyword_variant

  !> A keyword of the deck.
  type :: keyword
    character(:), allocatable :: name !< upper case, without the star
    character(:), allocatable :: meaning !< one or two sentences
    character(:), allocatable :: family !< 'mesh', 'material', 'joint', 'step', 'load', 'output', ..
    character(:), allocatable :: example !< lines of a deck, separated by new_line
    character(:), allocatable :: place !< 'model', 'step', 'anywhere', 'material'
    integer :: status = available
    character(:), allocatable :: way_out !< of a refused keyword
    type(field), allocatable :: parameters(:)
    character(:), allocatable :: chooser !< parameter that selects the variant
    type(keyword_variant), allocatable :: variants(:)
    type(field), allocatable :: columns(:) !< of one data line
    logical :: repeats_columns = .false. !< a line may hold the columns several times
    character(:), allocatable :: no_further !< why further columns of other programs are refused
    integer :: temperature_column = 0 !< of Abaqus, beyond the columns; one temperature is accepted
    logical :: checks_own_data = .false. !< the handler checks the data lines
    integer :: fewest_lines = 0, most_lines = huge(1) !< of data
    logical :: new_clears = .false. !< OP=NEW without data clears earlier data
    logical :: asks_for_output = .false. !< of other programs: parameters may be short,
    !< unknown ones are noted as ignored input
  end type keyword

contains

  !> The names of variants, as the choices of a parameter.
  pure function choices_of(variants) result(choices)
    type(keyword_variant), intent(in) :: variants(:)
    character(:), allocatable :: choices !< 'A | B'
    integer :: i
    choices = ''
    do i = 1, size(variants)
      if (i > 1) choices = choices//' | '
      choices = choices//variants(i)%name
    end do
  end function choices_of

  !> The specification that holds for one variant: its parameters follow the one that selects it.
  !> For a name that no variant has, it holds the parameters of all.
  pure function spec_of_variant(spec, name) result(whole)
    type(keyword), intent(in) :: spec !< with variants
    character(*), intent(in) :: name !< of the variant, upper case
    type(keyword) :: whole
    logical :: is_known
    integer :: i, j
    is_known = any([(spec%variants(i)%name == name, i=1, size(spec%variants))])
    whole = spec
    deallocate (whole%parameters)
    allocate (whole%parameters(0))
    do i = 1, size(spec%parameters)
      call append_field(whole%parameters, spec%parameters(i))
      if (spec%parameters(i)%name /= spec%chooser) cycle
      do j = 1, size(spec%variants)
        if (is_known .and. spec%variants(j)%name /= name) cycle
        call append_fields(whole%parameters, spec%variants(j)%parameters)
      end do
    end do
  end function spec_of_variant

  !> Puts the fields at the end of a list that does not hold their names.
  pure subroutine append_fields(list, new)
    type(field), allocatable, intent(inout) :: list(:)
    type(field), intent(in) :: new(:)
    integer :: i, j
    do i = 1, size(new)
      if (any([(list(j)%name == new(i)%name, j=1, size(list))])) cycle
      call append_field(list, new(i))
    end do
  end subroutine append_fields

  pure subroutine append_field(list, new)
    type(field), allocatable, intent(inout) :: list(:)
    type(field), intent(in) :: new
    type(field), allocatable :: longer(:)
    integer :: i
    allocate (longer(size(list) + 1))
    do i = 1, size(list)
      longer(i) = list(i)
    end do
    longer(size(longer)) = new
    call move_alloc(longer, list)
  end subroutine append_field

  !> Position of the specification of a card; blanks in names are ignored.
  !>
  !> If two keywords share a name (*DAMPING of a material and of a step), the result is the keyword
  !> of the given place, else the first.
  pure integer function find_spec(specs, name, where_it_stands) result(found)
    type(keyword), intent(in) :: specs(:)
    character(*), intent(in) :: name !< upper case, without the star
    character(*), intent(in), optional :: where_it_stands !< 'model', 'step', 'material', ..
    character(:), allocatable :: wanted
    integer :: i
    found = 0
    wanted = without_blanks(name)
    do i = size(specs), 1, -1
      if (without_blanks(specs(i)%name) /= wanted) cycle
      found = i
      if (.not. present(where_it_stands) .or. .not. allocated(specs(i)%place)) cycle
      if (specs(i)%place == where_it_stands) return
    end do
  end function find_spec

  !> Default of a parameter, '' without one.
  pure function parameter_default(spec, name) result(default)
    type(keyword), intent(in) :: spec
    character(*), intent(in) :: name !< upper case
    character(:), allocatable :: default
    integer :: i
    default = ''
    if (.not. allocated(spec%parameters)) return
    do i = 1, size(spec%parameters)
      if (spec%parameters(i)%name /= name) cycle
      if (allocated(spec%parameters(i)%default)) default = spec%parameters(i)%default
    end do
  end function parameter_default

  !> Default of the column of a field in a data line, '' without one.
  pure function column_default(spec, number) result(default)
    type(keyword), intent(in) :: spec
    integer, intent(in) :: number !< of the field, from 1
    character(:), allocatable :: default
    integer :: column
    default = ''
    column = column_of_field(spec, number)
    if (column == 0) return
    if (allocated(spec%columns(column)%default)) default = spec%columns(column)%default
  end function column_default

  !> Column of a field in a data line, 0 for a field beyond the columns.
  pure integer function column_of_field(spec, number) result(column)
    type(keyword), intent(in) :: spec
    integer, intent(in) :: number !< of the field, from 1
    column = 0
    if (.not. allocated(spec%columns)) return
    if (size(spec%columns) == 0) return
    column = number
    if (spec%repeats_columns) column = 1 + mod(number - 1, size(spec%columns))
    if (column > size(spec%columns)) column = 0
  end function column_of_field
end module keyword_spec
