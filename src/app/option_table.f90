!> The single list of options of the command line. The help, the search for misspelt options and
!> the checks of values are made from it. `cli` stores what the user gave, and checks by itself
!> which options of a UMAT were given without one.
module option_table
  implicit none
  private
  public :: option, find_option, needs_value, option_words, options_of_umat, usage

  character, parameter :: nl = new_line('a')
  integer, parameter :: num_options = 20
  integer, parameter :: width = 19 !< of the column of options in the help; longer ones stand out

  !> One option.
  type :: option
    character(21) :: name !< one that ends with '=' has its value in the same word: a|b
    character(9) :: value !< as the help shows it, '' for none, in brackets if it may be left out
    character(80) :: meaning
    logical :: needs_umat = .false. !< has no effect without --umat
  end type option

contains

  !> All options in the order of the help.
  pure function all_options() result(options)
    type(option) :: options(num_options)
    options = [option('-o', 'DIR', 'folder of the results (default: .)'), &
               option('-j', 'N', 'threads'), &
               option('--continue', '', 'go on from the last checkpoint of this job in DIR'), &
               option('--check', '', 'read and verify only, print a summary of the model'), &
               option('--material', '', &
                      'run the tests of materials (*MATERIAL TEST), no analysis'), &
               option('--umat', 'FILE ..', &
                      'the user''s own materials: UMAT as Fortran source or shared library'), &
               option('--umat-flags', 'TEXT', &
                      'compiler flags for these sources', needs_umat=.true.), &
               option('--umat-library', 'LIB', &
                      'keep the library; without a deck only build it', needs_umat=.true.), &
               option('--umat-threadsafe', '', &
                      'several threads may call the UMAT at once', needs_umat=.true.), &
               option('--umat-check', '', &
                      'compare DDSDDE of the UMAT with differences of STRESS', needs_umat=.true.), &
               option('--save-joint-problems', 'N', &
                      'save increments with more than N iterations on joints, '// &
                      'one HDF5 file each'), &
               option('--solver', 'NAME', &
                      'of several processes: AUTO, DIRECT, BLR or ITERATIVE'), &
               option('--c3d8=', 'full|bbar', &
                      'meaning of C3D8: 2 x 2 x 2 points (CalculiX) or B-bar (Abaqus)'), &
               option('--small-strain', '', 'analyse steps with NLGEOM=YES with small strains'), &
               option('--keywords', '[NAME]', 'the reference of all keywords, or of one'), &
               option('--fields', '[NAME]', &
                      'the fields of results: components, place, unit, meaning'), &
               option('--explain', '[NAME]', &
                      'the kinds of messages, or what one means and what to do'), &
               option('-q', '', 'print errors only'), &
               option('--version', '', 'compiler, flags, libraries'), &
               option('--help', '', 'this page')]
  end function all_options

  !> Finds the option that a word of the command line is; '-h' is '--help'.
  pure subroutine find_option(word, given, is_known)
    character(*), intent(in) :: word
    type(option), intent(out) :: given
    logical, intent(out) :: is_known
    type(option) :: options(num_options)
    integer :: i
    options = all_options()
    is_known = index(word, '|') == 0
    if (.not. is_known) return
    do i = 1, size(options)
      given = options(i)
      if (given%name == '--help' .and. word == '-h') return
      if (index('|'//spellings(given)//'|', '|'//word//'|') > 0) return
    end do
    is_known = .false.
  end subroutine find_option

  !> Words that an option may be, with | between them.
  pure function spellings(given) result(words)
    type(option), intent(in) :: given
    character(:), allocatable :: words
    character(:), allocatable :: name, choices
    integer :: bar
    name = trim(given%name)
    words = name
    if (index(name, '=') == 0) return
    choices = trim(given%value)
    bar = index(choices, '|')
    words = name//choices(:bar)//name//choices(bar + 1:)
  end function spellings

  !> Words of all options, with | between them.
  pure function option_words() result(words)
    character(:), allocatable :: words
    type(option) :: options(num_options)
    integer :: i
    options = all_options()
    words = ''
    do i = 1, size(options)
      words = words//spellings(options(i))//'|'
    end do
    words = words//'-h'
  end function option_words

  !> Whether the next word of the command line is the value of an option.
  pure logical function needs_value(given)
    type(option), intent(in) :: given
    needs_value = given%value /= '' .and. given%value(:1) /= '[' .and. index(given%name, '=') == 0
  end function needs_value

  !> The options that need --umat: 'a, b and c'.
  pure function options_of_umat() result(text)
    character(:), allocatable :: text
    type(option) :: options(num_options)
    integer :: i, last
    options = all_options()
    last = findloc(options%needs_umat, .true., 1, back=.true.)
    text = ''
    do i = 1, last
      if (.not. options(i)%needs_umat) cycle
      if (len(text) > 0) text = text//trim(merge(' and', ',   ', i == last))//' '
      text = text//trim(options(i)%name)
    end do
  end function options_of_umat

  !> How the program is called.
  pure function usage() result(text)
    character(:), allocatable :: text !< lines with new_line between them
    character(width) :: left
    character(:), allocatable :: name
    type(option) :: options(num_options)
    integer :: i
    options = all_options()
    text = 'usage: keyway [options] job.inp'
    do i = 1, size(options)
      name = trim(options(i)%name)
      if (index(name, '=') == 0) name = name//' '
      name = trim(name//options(i)%value)
      left = name
      text = text//nl//'  '
      if (len(name) < width) text = text//left
      if (len(name) >= width) text = text//name//'  '
      text = text//trim(options(i)%meaning)
    end do
    text = text//nl//'exit code: 0 finished, 1 the analysis stopped, 2 bad deck or usage, '// &
           '3 the system failed'
  end function usage
end module option_table
