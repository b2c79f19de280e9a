!> Builds a shared library from the sources of a UMAT.
module umat_build
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
                             '-Wl,--wrap=_gfortran_runtime_error_at'
  !> The include file of UMATs: implicit typing and precision of the interface.
  character(*), parameter :: include_file = &
                             '      IMPLICIT REAL*8(A-H,O-Z)'//nl// &
                             '      PARAMETER (NPRECD=2)'//nl
  integer, parameter :: most_letters = 4000 !< of the compiler's output in a message
  integer, parameter :: command_not_found = 127 !< status of the shell

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
      object = quoted(files(i)%path)
      if (.not. is_object(files(i)%path)) then
        object = quoted(folder//'/umat_'//as_text(i)//'.o')
        call compile(files(i)%path, user_flags, folder, object, error)
      end if
      objects = objects//' '//object
    end do
    if (allocated(error)) return
    call run(flags_of_linker//objects//' '//user_flags//' -o '//quoted(library), folder, &
             'cannot link the UMAT', error)
  end subroutine build_library

  !> Compiles one source.
  subroutine compile(path, user_flags, folder, object, error)
    character(*), intent(in) :: path, user_flags, folder
    character(*), intent(in) :: object !< path, quoted
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
    call run('-c '//flags//' -I'//quoted(folder_of(path))//' -I'//quoted(folder)//' -J'// &
             quoted(folder)//' '//user_flags//' -o '//object//' '//quoted(path), folder, &
             "cannot compile the UMAT '"//path//"', taken for "// &
             trim(merge('free ', 'fixed', form%is_free))//' form', error)
  end subroutine compile

  !> Runs the compiler; on failure the message is its output.
  subroutine run(arguments, folder, what_fails, error)
    character(*), intent(in) :: arguments, folder, what_fails
    type(error_type), allocatable, intent(out) :: error
    character(:), allocatable :: command, words, reason
    integer :: status, launched
    command = compiler()
    status = 0
    launched = 0
    call execute_command_line(command//' '//arguments//' >'//quoted(folder//'/words')//' 2>&1', &
                              exitstat=status, cmdstat=launched)
    if (status == 0 .and. launched == 0) return
    if (status == command_not_found .or. launched /= 0) then
      call raise(error, 'keyway: '//what_fails//': '//command//' was not found', system_failed)
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
    if (exists) command = quoted(compiler_path)
  end function compiler

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

  !> A text as one word of the shell.
  pure function quoted(word) result(text)
    character(*), intent(in) :: word
    character(:), allocatable :: text
    integer :: i
    text = ''''
    do i = 1, len(word)
      if (word(i:i) == '''') text = text//'''\''' ! close, quoted quote, open
      text = text//word(i:i)
    end do
    text = text//''''
  end function quoted

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
