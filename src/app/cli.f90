!> The command line: options, and output that needs no deck.
module cli
  use build_info, only: compiler, compiler_flags, libraries, program_version
  use deck_options, only: reading_options
  use errors, only: deck_is_wrong, error_type, raise
  use field_help, only: field_lines, field_page
  use keyword_catalogue, only: list_all => list_keywords
  use keyword_handler, only: keyword_list
  use keyword_help, only: describe_keyword, list_keywords
  use message_help, only: explain_message, message_lines
  use nearest_words, only: nearest_choice
  use option_table, only: find_option, needs_value, option, option_words, options_of_umat, usage
  use parse_text, only: parse_integer, upper_case
  use petsc_equations, only: has_petsc
  use process_limits, only: print_text
  use umat_build, only: umat_file
  use umat_loader, only: umat_request
  use unknown_layout, only: choose_solver, compressed_solver, direct_solver, iterative_solver
  use write_text, only: as_text
  implicit none
  private
  public :: command_line, parse_command_line, print_answer

  character, parameter :: nl = new_line('a')
  integer, parameter :: most_threads = 256 !< each needs memory of its own

  !> The options that the user gave.
  type :: command_line
    character(:), allocatable :: deck !< path, '' for none
    character(:), allocatable :: folder !< folder of the results
    character(:), allocatable :: keyword !< argument of --keywords, '' for all
    character(:), allocatable :: field !< argument of --fields, '' for all
    character(:), allocatable :: message !< argument of --explain, '' for all
    type(reading_options) :: reading !< what the deck means
    type(umat_request) :: umat !< --umat and the options that go with it
    integer :: num_threads = 0 !< 0: as many as the system has
    integer :: solver = choose_solver !< --solver: of the equations with several processes
    integer :: most_unsaved = huge(1) !< iterations on joints; --save-joint-problems
    logical :: is_check = .false. !< read and verify only
    logical :: is_material = .false. !< run the tests of materials, not the analysis
    logical :: is_quiet = .false.
    logical :: is_continued = .false. !< go on from the last checkpoint
    logical :: wants_keywords = .false., wants_fields = .false., wants_explanation = .false.
    logical :: wants_version = .false., wants_help = .false.
    logical :: is_empty = .false. !< no argument at all
  end type command_line

contains

  !> Reads the arguments of the program.
  subroutine parse_command_line(given, error)
    type(command_line), intent(out) :: given
    type(error_type), allocatable, intent(out) :: error
    integer :: i
    given%deck = ''
    given%folder = '.'
    given%keyword = ''
    given%field = ''
    given%message = ''
    given%umat%flags = ''
    given%umat%target = ''
    allocate (given%umat%files(0))
    given%is_empty = command_argument_count() == 0
    i = 1
    do while (i <= command_argument_count())
      call read_argument(i, given, error)
      if (allocated(error)) return
    end do
    if (given%is_empty .or. given%wants_help .or. given%wants_version) return
    call check_umat_options(given, error)
    if (allocated(error)) return
    if (given%is_continued .and. (given%is_check .or. given%is_material)) then
      call raise(error, 'keyway: --continue goes with an analysis, not with --check or '// &
                 '--material'//nl//usage(), deck_is_wrong)
      return
    end if
    if (given%wants_keywords .or. given%wants_fields .or. given%wants_explanation) return
    if (len(given%deck) > 0) return
    if (size(given%umat%files) > 0 .and. len(given%umat%target) > 0) return
    call raise(error, 'keyway: no deck is named'//nl//usage(), deck_is_wrong)
  end subroutine parse_command_line

  !> Reads argument `i` with its value and steps over them.
  subroutine read_argument(i, given, error)
    integer, intent(inout) :: i
    type(command_line), intent(inout) :: given
    type(error_type), allocatable, intent(out) :: error
    type(option) :: found
    character(:), allocatable :: word
    logical :: is_known
    word = argument(i)
    i = i + 1
    call find_option(word, found, is_known)
    if (.not. is_known) then
      call read_deck_name(word, given, error)
    else if (needs_value(found)) then
      call read_value(word, i, given, error)
    else
      call read_option(found, word, i, given)
    end if
  end subroutine read_argument

  !> Reads an option that has no value, has it in the same word, or may have a name behind it.
  subroutine read_option(found, word, i, given)
    type(option), intent(in) :: found
    character(*), intent(in) :: word !< that the user gave
    integer, intent(inout) :: i !< argument behind the option; steps over a name
    type(command_line), intent(inout) :: given
    select case (found%name)
    case ('--check')
      given%is_check = .true.
    case ('--material')
      given%is_material = .true.
      given%reading%is_for_tests = .true.
    case ('--c3d8=')
      given%reading%c3d8 = upper_case(word(len_trim(found%name) + 1:))
    case ('--small-strain')
      given%reading%takes_small_strain = .true.
    case ('-q')
      given%is_quiet = .true.
    case ('--version')
      given%wants_version = .true.
    case ('--help')
      given%wants_help = .true.
    case ('--keywords')
      given%wants_keywords = .true.
      call read_keyword_name(i, given%keyword)
    case ('--fields')
      given%wants_fields = .true.
      call read_name(i, given%field)
    case ('--explain')
      given%wants_explanation = .true.
      call read_name(i, given%message)
    case ('--umat-threadsafe')
      given%umat%is_threadsafe = .true.
    case ('--umat-check')
      given%umat%checks_tangent = .true.
    case ('--continue')
      given%is_continued = .true.
      given%umat%is_continued = .true.
    case default
      error stop 'an option of the table is not read'
    end select
  end subroutine read_option

  !> The name of a keyword, which may be several words, up to the next option; steps over it.
  subroutine read_keyword_name(i, name)
    integer, intent(inout) :: i
    character(:), allocatable, intent(inout) :: name
    do while (i <= command_argument_count())
      if (index(argument(i), '-') == 1) return
      name = trim(name//' '//argument(i))
      i = i + 1
    end do
  end subroutine read_keyword_name

  !> A name that may follow an option; steps over it.
  subroutine read_name(i, name)
    integer, intent(inout) :: i
    character(:), allocatable, intent(inout) :: name !< unchanged where none follows
    if (i > command_argument_count()) return
    if (index(argument(i), '-') == 1) return
    name = argument(i)
    i = i + 1
  end subroutine read_name

  !> Reads argument `i`, the value of an option, and steps over it.
  subroutine read_value(word, i, given, error)
    character(*), intent(in) :: word
    integer, intent(inout) :: i
    type(command_line), intent(inout) :: given
    type(error_type), allocatable, intent(out) :: error
    if (i > command_argument_count() .or. (argument(i) == '' .and. word /= '--umat-flags')) then
      call raise(error, 'keyway: '//word//' needs a value'//nl//usage(), deck_is_wrong)
      return
    end if
    select case (word)
    case ('-o')
      given%folder = argument(i)
    case ('-j')
      call read_threads(argument(i), given, error)
    case ('--save-joint-problems')
      call read_iterations(argument(i), given, error)
    case ('--solver')
      call read_solver(argument(i), given, error)
    case ('--umat-flags')
      given%umat%flags = given%umat%flags//' '//argument(i)
    case ('--umat-library')
      given%umat%target = argument(i)
    case ('--umat')
      call read_umat_files(i, given)
    case default
      error stop 'an option of the table is not read'
    end select
    i = i + 1
  end subroutine read_value

  !> The options for UMATs need --umat.
  subroutine check_umat_options(given, error)
    type(command_line), intent(in) :: given
    type(error_type), allocatable, intent(out) :: error
    associate (umat => given%umat)
      if (size(umat%files) > 0) return
      if (len(umat%flags) + len(umat%target) == 0 .and. .not. umat%is_threadsafe .and. &
          .not. umat%checks_tangent) return
    end associate
    call raise(error, 'keyway: '//options_of_umat()//' go with --umat'//nl//usage(), deck_is_wrong)
  end subroutine check_umat_options

  !> The argument after --umat, and the following ones that end like code; `i` is the last of them.
  subroutine read_umat_files(i, given)
    integer, intent(inout) :: i
    type(command_line), intent(inout) :: given
    type(umat_file) :: new
    do
      new%path = argument(i)
      given%umat%files = [given%umat%files, new]
      if (i == command_argument_count()) return
      if (.not. is_code(argument(i + 1))) return
      i = i + 1
    end do
  end subroutine read_umat_files

  !> The name ends as Fortran sources, objects and libraries do.
  pure logical function is_code(name)
    character(*), intent(in) :: name
    character(:), allocatable :: ending
    ending = upper_case(name(index(name, '.', back=.true.) + 1:))
    is_code = index(name, '.') > 0 .and. &
              any(ending == [character(4) :: 'F', 'FOR', 'FTN', 'F77', 'F90', 'F95', 'F03', &
                             'F08', 'FPP', 'O', 'A', 'SO'])
  end function is_code

  !> Reads the value of -j.
  subroutine read_threads(word, given, error)
    character(*), intent(in) :: word
    type(command_line), intent(inout) :: given
    type(error_type), allocatable, intent(out) :: error
    logical :: is_integer
    call parse_integer(word, given%num_threads, is_integer)
    if (is_integer .and. given%num_threads > 0 .and. given%num_threads <= most_threads) return
    call raise(error, "keyway: found '-j "//word//"'; expected a number of threads from 1 to "// &
               as_text(most_threads), deck_is_wrong)
  end subroutine read_threads

  !> Reads the value of --solver.
  subroutine read_solver(word, given, error)
    character(*), intent(in) :: word
    type(command_line), intent(inout) :: given
    type(error_type), allocatable, intent(out) :: error
    select case (upper_case(word))
    case ('AUTO')
      given%solver = choose_solver
    case ('DIRECT')
      given%solver = direct_solver
    case ('ITERATIVE')
      given%solver = iterative_solver
    case ('BLR')
      given%solver = compressed_solver
    case default
      call raise(error, "keyway: found '--solver "//word//"'; expected AUTO, DIRECT, BLR or "// &
                 'ITERATIVE', deck_is_wrong)
      return
    end select
    if (given%solver == choose_solver) return
    if (has_petsc() /= 0) return
    call raise(error, 'keyway: --solver '//upper_case(word)//' needs a program that is built '// &
               'with PETSc (cmake --preset petsc; docs/large_models.md)', deck_is_wrong)
  end subroutine read_solver

  !> Reads the value of --save-joint-problems.
  subroutine read_iterations(word, given, error)
    character(*), intent(in) :: word
    type(command_line), intent(inout) :: given
    type(error_type), allocatable, intent(out) :: error
    logical :: is_integer
    call parse_integer(word, given%most_unsaved, is_integer)
    if (is_integer .and. given%most_unsaved >= 0) return
    call raise(error, "keyway: found '--save-joint-problems "//word//"'; expected the most "// &
               'iterations of an increment that is not saved, 0 or more', deck_is_wrong)
  end subroutine read_iterations

  !> Reads a word that is no option: the path of the deck.
  subroutine read_deck_name(word, given, error)
    character(*), intent(in) :: word
    type(command_line), intent(inout) :: given
    type(error_type), allocatable, intent(out) :: error
    character(:), allocatable :: nearest
    if (index(word, '-') == 1) then
      nearest = nearest_choice(word, option_words())
      if (len(nearest) > 0) nearest = "; did you mean '"//nearest//"'?"
      call raise(error, "keyway: unknown option '"//word//"'"//nearest//nl//usage(), deck_is_wrong)
    else if (len(given%deck) > 0) then
      call raise(error, "keyway: one deck at a time; found '"//given%deck//"' and '"//word//"'", &
                 deck_is_wrong)
    else
      given%deck = word
    end if
  end subroutine read_deck_name

  !> An argument of the program.
  function argument(number) result(text)
    integer, intent(in) :: number
    character(:), allocatable :: text
    integer :: length
    call get_command_argument(number, length=length)
    allocate (character(length) :: text)
    call get_command_argument(number, text)
  end function argument

  !> Prints what needs no deck: usage, help, version, keywords, fields, messages.
  subroutine print_answer(given, is_answered, error)
    type(command_line), intent(in) :: given
    logical, intent(out) :: is_answered
    type(error_type), allocatable, intent(out) :: error
    is_answered = .true.
    if (given%is_empty) then
      call print_text('Keyway '//program_version//': finite-element analysis of concrete dams'// &
                      nl//'Start it with a deck:'//nl//nl//usage(), error)
    else if (given%wants_help) then
      call print_text(usage(), error)
    else if (given%wants_version) then
      call print_text('keyway '//program_version//nl//'compiler:  '//compiler//nl//'flags:     '// &
                      compiler_flags//nl//'libraries: '//libraries, error)
    else if (given%wants_keywords) then
      call print_keywords(given%keyword, error)
    else if (given%wants_fields) then
      call print_fields(given%field, error)
    else if (given%wants_explanation) then
      call print_explanation(given%message, error)
    else
      is_answered = .false.
    end if
  end subroutine print_answer

  !> Prints the reference of a keyword, or the list of all.
  subroutine print_keywords(name, error)
    character(*), intent(in) :: name !< '' for all
    type(error_type), allocatable, intent(out) :: error
    type(keyword_list) :: list
    character(:), allocatable :: text
    logical :: is_known
    call list_all(list)
    if (name == '') then
      call print_text(list_keywords(list%specs), error)
      return
    end if
    call describe_keyword(list%specs, name, text, is_known)
    if (is_known) call print_text(text, error)
    if (.not. is_known) call raise(error, 'keyway: '//text, deck_is_wrong)
  end subroutine print_keywords

  !> Prints the page of a field of results, or the list of all.
  subroutine print_fields(name, error)
    character(*), intent(in) :: name !< '' for all
    type(error_type), allocatable, intent(out) :: error
    character(:), allocatable :: text
    logical :: is_known
    if (name == '') then
      call print_text(field_lines(), error)
      return
    end if
    call field_page(name, text, is_known)
    if (is_known) call print_text(text, error)
    if (.not. is_known) call raise(error, 'keyway: '//text, deck_is_wrong)
  end subroutine print_fields

  !> Prints the page of a kind of messages, or the list of all.
  subroutine print_explanation(name, error)
    character(*), intent(in) :: name !< '' for all
    type(error_type), allocatable, intent(out) :: error
    character(:), allocatable :: text
    logical :: is_known
    if (name == '') then
      call print_text(message_lines(), error)
      return
    end if
    call explain_message(name, text, is_known)
    if (is_known) call print_text(text, error)
    if (.not. is_known) call raise(error, 'keyway: '//text, deck_is_wrong)
  end subroutine print_explanation
end module cli
