!> Builds a shared library from the sources of a UMAT.
module umat_build
  use, intrinsic :: iso_c_binding, only: c_char, c_int, c_null_char, c_size_t
  use build_info, only: compiler_path
  use deck_file, only: load_file
  use errors, only: deck_is_wrong, error_type, raise, system_failed
  use umat_source_form, only: form_of_source, source_form
  use write_text, only: as_text
  implicit none
  private
  public :: umat_file, build_library, is_library

  !> A source, an object file or a library, as named on the command line.
  type :: umat_file
    character(:), allocatable :: path
  end type umat_file

  character, parameter :: nl = new_line('a')
  !> Old code relies on arguments of other types, tabs, D lines and local variables that are zero at
  !> the start.
  character(*), parameter :: flags_of_old_code = '-fPIC -O2 -std=legacy -fdec '// &
                             '-fallow-argument-mismatch -finit-local-zero'
  character(*), parameter :: flags_of_free_form = '-x f95 -ffree-form -ffree-line-length-none'
  character(*), parameter :: flags_of_fixed_form = '-x f77 -ffixed-form '// &
                             '-ffixed-line-length-none'
  !> Calls that would end the process return a status instead (umat_bridge.c).
  character(*), parameter :: flags_of_linker = '-shared '// &
                             '-Wl,--wrap=_gfortran_stop_string '// &
                             '-Wl,--wrap=_gfortran_stop_numeric '// &
                             '-Wl,--wrap=_gfortran_error_stop_string '// &
                             '-Wl,--wrap=_gfortran_error_stop_numeric '// &
                             '-Wl,--wrap=_gfortran_exit_i4 '// &
                             '-Wl,--wrap=_gfortran_runtime_error_at '// &
                             '-Wl,--wrap=_gfortran_os_error_at '// &
                             '-Wl,--wrap=_gfortran_os_error '// &
                             '-Wl,--wrap=_gfortran_abort'
  !> The include file of UMATs: implicit typing and precision of the interface.
  character(*), parameter :: include_file = &
                             '      IMPLICIT REAL*8(A-H,O-Z)'//nl// &
                             '      PARAMETER (NPRECD=2)'//nl
  integer, parameter :: most_letters = 4000 !< of the compiler's output in a message
  integer, parameter :: command_not_found = 127 !< status, umat_command.c

  interface
    !> Runs a command without a shell; its output goes to a file.
    function keyway_umat_run(words, length, output) result(status) bind(c)
      import :: c_char, c_int, c_size_t
      implicit none
      ! allow(assumed-size)
      character(kind=c_char), intent(in) :: words(*), output(*)
      integer(c_size_t), value :: length
      integer(c_int) :: status
    end function keyway_umat_run
  end interface

contains

  !> Whether a file is a library, which needs no build.
  pure logical function is_library(path)
    character(*), intent(in) :: path
    is_library = index(path, '.so', back=.true.) > 0 .and. &
                 index(path, '.so', back=.true.) == len(path) - 2
  end function is_library

  !> Compiles and links; on failure the message is the output of the compiler.
  subroutine build_library(files, user_flags, folder, library, error)
    type(umat_file), intent(in) :: files(:)
    character(*), intent(in) :: user_flags !< of the compiler, for all sources
    character(*), intent(in) :: folder !< for intermediate files
    character(*), intent(in) :: library !< path of the result
    type(error_type), allocatable, intent(out) :: error
    character(:), allocatable :: objects, object
    integer :: i
    call write_text_file(folder//'/ABA_PARAM.INC', include_file, error)
    if (.not. allocated(error)) then
      call write_text_file(folder//'/aba_param.inc', include_file, error)
    end if
    objects = ''
    do i = 1, size(files)
      if (allocated(error)) return
      object = files(i)%path
      if (.not. is_object(files(i)%path)) then
        object = folder//'/umat_'//as_text(i)//'.o'
        call compile(files(i)%path, user_flags, folder, object, error)
      end if
      objects = objects//word(object)
    end do
    if (allocated(error)) return
    call run(words_of(flags_of_linker)//objects//words_of(user_flags)//word('-o')// &
             word(library), folder, 'cannot link the UMAT', error)
  end subroutine build_library

  !> Compiles one source.
  subroutine compile(path, user_flags, folder, object, error)
    character(*), intent(in) :: path, user_flags, folder
    character(*), intent(in) :: object !< path
    type(error_type), allocatable, intent(out) :: error
    type(source_form) :: form
    character(:), allocatable :: text, reason, flags
    call load_file(path, text, reason)
    if (len(reason) > 0) then
      call raise(error, "keyway: cannot read the UMAT '"//path//"': "//reason, deck_is_wrong)
      return
    end if
    form = form_of_source(text)
    flags = flags_of_fixed_form
    if (form%is_free) flags = flags_of_free_form
    flags = flags_of_old_code//' '//flags
    if (form%has_directives) flags = flags//' -cpp'
    call run(words_of('-c '//flags)//word('-I'//folder_of(path))//word('-I'//folder)// &
             word('-J'//folder)//words_of(user_flags)//word('-o')//word(object)// &
             word(path), folder, &
             "cannot compile the UMAT '"//path//"', taken for "// &
             trim(merge('free ', 'fixed', form%is_free))//' form', error)
  end subroutine compile

  !> Runs the compiler without a shell; on failure the message is its output.
  subroutine run(arguments, folder, what_fails, error)
    character(*), intent(in) :: arguments !< words, each with a null at its end
    character(*), intent(in) :: folder, what_fails
    type(error_type), allocatable, intent(out) :: error
    character(:), allocatable :: command, words, reason
    integer :: status
    command = word(compiler())//arguments
    status = int(keyway_umat_run(command, len(command, c_size_t), folder//'/words'//c_null_char))
    if (status == 0) return
    if (status == command_not_found) then
      call raise(error, 'keyway: '//what_fails//': '//compiler()//' was not found', system_failed)
      return
    end if
    call load_file(folder//'/words', words, reason)
    if (len(reason) > 0) words = reason
    if (len(words) > most_letters) words = words(:most_letters)//nl//'..'
    call raise(error, 'keyway: '//what_fails//nl//words, deck_is_wrong)
  end subroutine run

  !> The compiler of this program if it exists, else the one of PATH.
  function compiler() result(command)
    character(:), allocatable :: command
    logical :: exists
    inquire (file=compiler_path, exist=exists)
    command = 'gfortran'
    if (exists) command = compiler_path
  end function compiler

  !> A word of a command.
  pure function word(text)
    character(*), intent(in) :: text
    character(:), allocatable :: word
    word = text//c_null_char
  end function word

  !> The words of a text: blanks separate words, quotes protect blanks. Nothing else has a meaning.
  pure function words_of(text) result(words)
    character(*), intent(in) :: text
    character(:), allocatable :: words !< each with a null at its end
    character :: quote
    integer :: i
    logical :: is_open
    words = ''
    quote = ' '
    is_open = .false.
    do i = 1, len(text)
      if (quote /= ' ') then
        if (text(i:i) /= quote) words = words//text(i:i)
        if (text(i:i) == quote) quote = ' '
      else if (text(i:i) == '"' .or. text(i:i) == '''') then
        quote = text(i:i)
        is_open = .true.
      else if (text(i:i) == ' ') then
        if (is_open) words = words//c_null_char
        is_open = .false.
      else
        words = words//text(i:i)
        is_open = .true.
      end if
    end do
    if (is_open) words = words//c_null_char
  end function words_of

  !> Whether a file goes to the linker without compilation.
  pure logical function is_object(path)
    character(*), intent(in) :: path
    character(:), allocatable :: ending
    ending = path(index(path, '.', back=.true.) + 1:)
    is_object = ending == 'o' .or. ending == 'a' .or. ending == 'so'
  end function is_object

  pure function folder_of(path) result(folder)
    character(*), intent(in) :: path
    character(:), allocatable :: folder
    folder = path(:index(path, '/', back=.true.))
    if (folder == '') folder = '.'
  end function folder_of

  subroutine write_text_file(path, text, error)
    character(*), intent(in) :: path, text
    type(error_type), allocatable, intent(out) :: error
    integer :: unit, status
    open (newunit=unit, file=path, status='replace', action='write', access='stream', &
          form='unformatted', iostat=status)
    if (status == 0) write (unit, iostat=status) text
    if (status == 0) close (unit, iostat=status)
    if (status /= 0) call raise(error, "keyway: cannot write '"//path//"'", system_failed)
  end subroutine write_text_file
end module umat_build
