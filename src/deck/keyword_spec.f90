!> The specification of a keyword: the one place from which the parser's checks, the messages and
!> `keyway --keywords` are made.
module keyword_spec
  use kinds, only: rk
  use parse_text, only: without_blanks
  implicit none
  private
  public :: keyword, field
  public :: parameter_default, column_default, column_of_field, find_spec
  public :: kind_real, kind_integer, kind_word, kind_flag, kind_choice, kind_text, kind_reference
  public :: available, later, without_effect

  !> What a field may hold.
  integer, parameter :: kind_real = 1, kind_integer = 2, kind_word = 3, kind_flag = 4
  integer, parameter :: kind_choice = 5 !< one word of `choices`
  integer, parameter :: kind_text = 6 !< anything, kept as it is (file names)
  integer, parameter :: kind_reference = 7 !< a number, or the name of a set

  !> What the program does with a keyword.
  integer, parameter :: available = 1
  integer, parameter :: later = 2 !< known, an error: 'not available yet'
  integer, parameter :: without_effect = 3 !< understood, a warning

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
    logical :: excludes_lowest = .false., excludes_highest = .false. !< range is open there
  end type field

  !> A keyword of the deck.
  type :: keyword
    character(:), allocatable :: name !< upper case, without the star
    character(:), allocatable :: meaning !< one or two sentences
    character(:), allocatable :: family !< 'mesh', 'material', 'joint', 'step', 'load', 'output', ..
    character(:), allocatable :: example !< lines of a deck, separated by new_line
    character(:), allocatable :: place !< 'model', 'step', 'anywhere', 'material'
    integer :: status = available
    type(field), allocatable :: parameters(:)
    type(field), allocatable :: columns(:) !< of one data line
    logical :: repeats_columns = .false. !< a line may hold the columns several times
    character(:), allocatable :: no_further !< why further columns of other programs are refused
    logical :: checks_own_data = .false. !< the handler reads the data lines itself
    integer :: fewest_lines = 0, most_lines = huge(1) !< of data
    logical :: new_clears = .false. !< OP=NEW without data clears what there was
  end type keyword
contains

  !> Position of the specification a card belongs to; names compare with blanks removed.
  !>
  !> Where two keywords share a name (*DAMPING of a material and of a step), the one whose `place`
  !> is the given one is found, else the first.
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

  !> Default of a parameter, '' where there is none.
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

  !> Default of the column a field of a data line belongs to, '' where there is none.
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

  !> Column a field of a data line belongs to, 0 where it has none.
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
