!> The library of a user: opened once for a run, with its routines and the findings about them.
module umat_loader
  use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_double, c_funptr, c_int
  use, intrinsic :: iso_c_binding, only: c_null_char, c_null_funptr, c_null_ptr, c_ptr, c_size_t
  use, intrinsic :: iso_fortran_env, only: output_unit
  use errors, only: analysis_failed, deck_is_wrong, error_type, raise, system_failed
  use kinds, only: rk
  use umat_build, only: build_library, is_library, umat_file
  use umat_findings, only: findings, text_of_check
  use umat_interface, only: keyway_make_temporary, keyway_remove_temporary, keyway_umat_counts, &
                            keyway_umat_external, keyway_umat_find, keyway_umat_disable_traps, &
                            keyway_umat_open, keyway_umat_restore_folder, &
                            keyway_umat_restore_traps, keyway_umat_set_job, &
                            failure_reason, text_from_c
  use umat_services, only: message_unit
  use write_text, only: as_text
  implicit none
  private
  public :: user_library, umat_request, open_library, keep_library
  public :: at_increment_start, at_increment_end, at_end

  !> When UEXTERNALDB is called: its argument LOP.
  integer, parameter :: at_start = 0, at_increment_start = 1, at_increment_end = 2, at_end = 3
  integer, parameter :: at_restart = 4 !< in place of `at_start` after a restart

  integer, parameter :: longest_message = 2000, longest_path = 4000

  !> Options of the command line for UMATs.
  type :: umat_request
    type(umat_file), allocatable :: files(:) !< sources, or one library; unallocated: not given
    character(:), allocatable :: flags !< of the compiler
    character(:), allocatable :: target !< path to keep the library, '' for none
    logical :: is_threadsafe = .false. !< may be called by several threads at once
    logical :: checks_tangent = .false. !< compare DDSDDE with differences of STRESS
    logical :: is_continued = .false. !< the run goes on from a checkpoint
    logical :: is_silent = .false. !< what the UMAT writes is lost
  end type umat_request

  type :: user_library
    type(c_ptr) :: handle = c_null_ptr
    type(c_funptr) :: umat = c_null_funptr
    type(c_funptr) :: sdvini = c_null_funptr, uexternaldb = c_null_funptr !< null: missing
    type(umat_file), allocatable :: files(:) !< sources of the library
    logical :: is_threadsafe = .false., checks_tangent = .false.
    type(findings) :: found
  contains
    procedure :: call_external
    procedure :: new_notes
    procedure :: check_text
    procedure :: close => close_library
  end type user_library

contains

  !> Builds and loads the library, opens unit 7 and calls UEXTERNALDB for the start.
  subroutine open_library(request, job, folder, library, error)
    type(umat_request), intent(in) :: request
    character(*), intent(in) :: job !< name of the job
    character(*), intent(in) :: folder !< of the results, exists
    type(user_library), intent(out) :: library
    type(error_type), allocatable, intent(out) :: error
    character(:), allocatable :: path, temporary
    library%files = request%files
    library%is_threadsafe = request%is_threadsafe
    library%checks_tangent = request%checks_tangent
    call keyway_umat_set_job(job//c_null_char, folder//c_null_char)
    if (size(request%files) == 1 .and. is_library(request%files(1)%path)) then
      path = request%files(1)%path
      if (index(path, '/') == 0) path = './'//path
      call load(path, library, error)
    else
      call open_temporary(temporary, error)
      if (allocated(error)) return
      path = temporary//'/umat.so'
      if (request%target /= '') path = request%target
      if (index(path, '/') == 0) path = './'//path
      call build_library(request%files, request%flags, temporary, path, error)
      if (.not. allocated(error)) call load(path, library, error)
      call keyway_remove_temporary(temporary//c_null_char)
    end if
    if (allocated(error)) return
    if (request%is_silent) then
      call open_nowhere(error)
    else
      call open_message_file(folder//'/'//job//'.msg', request%is_continued, error)
    end if
    if (allocated(error)) return
    call library%call_external(merge(at_restart, at_start, request%is_continued), &
                               [0.0_rk, 0.0_rk], 0.0_rk, 0, 0, error)
  end subroutine open_library

  !> Builds the library of the request and keeps it for later runs.
  subroutine keep_library(request, error)
    type(umat_request), intent(in) :: request
    type(error_type), allocatable, intent(out) :: error
    character(:), allocatable :: temporary
    call open_temporary(temporary, error)
    if (allocated(error)) return
    call build_library(request%files, request%flags, temporary, request%target, error)
    call keyway_remove_temporary(temporary//c_null_char)
  end subroutine keep_library

  subroutine open_temporary(path, error)
    character(:), allocatable, intent(out) :: path
    type(error_type), allocatable, intent(out) :: error
    character(kind=c_char) :: room(longest_path)
    call keyway_make_temporary(room, size(room, kind=c_size_t))
    path = text_from_c(room)
    if (path /= '') return
    call raise(error, 'keyway: no folder for temporary files; set TMPDIR', system_failed)
  end subroutine open_temporary

  !> Loads a library and finds its routines.
  subroutine load(path, library, error)
    character(*), intent(in) :: path
    type(user_library), intent(inout) :: library
    type(error_type), allocatable, intent(out) :: error
    character(kind=c_char) :: room(longest_message)
    character(:), allocatable :: hint
    library%handle = keyway_umat_open(path//c_null_char, room, size(room, kind=c_size_t))
    if (.not. c_associated(library%handle)) then
      call raise(error, 'keyway: cannot load the UMAT: '//text_from_c(room), deck_is_wrong)
      return
    end if
    library%umat = keyway_umat_find(library%handle, 'umat_'//c_null_char)
    library%sdvini = keyway_umat_find(library%handle, 'sdvini_'//c_null_char)
    library%uexternaldb = keyway_umat_find(library%handle, 'uexternaldb_'//c_null_char)
    if (any([has_routine('umatht_'), has_routine('hetval_')])) then
      call raise(error, 'keyway: the library has UMATHT or HETVAL; analyses coupled with '// &
                 'temperature are not supported', deck_is_wrong)
    else if (.not. c_associated(library%umat)) then
      hint = ''
      if (has_routine('vumat_')) hint = ' (VUMAT is the interface of an explicit program)'
      call raise(error, 'keyway: the files of --umat have no SUBROUTINE UMAT'//hint, &
                 deck_is_wrong)
    end if

  contains

    logical function has_routine(name)
      character(*), intent(in) :: name
      type(c_funptr) :: routine
      routine = keyway_umat_find(library%handle, name//c_null_char)
      has_routine = c_associated(routine)
    end function has_routine
  end subroutine load

  !> Opens unit 7 for output and messages of the UMAT. Unit 6 is the standard output.
  subroutine open_message_file(path, is_continued, error)
    character(*), intent(in) :: path
    logical, intent(in) :: is_continued !< append to the file
    type(error_type), allocatable, intent(out) :: error
    integer :: status
    if (is_continued) then
      open (unit=message_unit, file=path, position='append', action='readwrite', iostat=status)
    else
      open (unit=message_unit, file=path, status='replace', action='readwrite', iostat=status)
    end if
    if (status /= 0) call raise(error, "keyway: cannot write '"//path//"'", system_failed)
  end subroutine open_message_file

  !> Opens units 6 and 7 where nothing is kept.
  subroutine open_nowhere(error)
    type(error_type), allocatable, intent(out) :: error
    integer :: status
    open (unit=message_unit, status='scratch', action='readwrite', iostat=status)
    if (status == 0) open (unit=output_unit, file='/dev/null', action='write', iostat=status)
    if (status /= 0) call raise(error, 'keyway: cannot open a scratch file for the UMAT', &
                                system_failed)
  end subroutine open_nowhere

  !> Calls UEXTERNALDB, if present, at a moment of the analysis.
  subroutine call_external(self, moment, time, size, step, increment, error)
    class(user_library), intent(in) :: self
    integer, intent(in) :: moment !< one of the constants above
    real(rk), intent(in) :: time(2) !< of the step, of the analysis [s]
    real(rk), intent(in) :: size !< of the increment [s]
    integer, intent(in) :: step, increment !< from 1; 0 before the first
    type(error_type), allocatable, intent(out) :: error
    integer(c_int) :: status
    if (.not. c_associated(self%uexternaldb)) return
    call keyway_umat_disable_traps()
    status = keyway_umat_external(self%uexternaldb, int(moment, c_int), &
                                  merge(1_c_int, 0_c_int, moment == at_restart), &
                                  real(time, c_double), real(size, c_double), int(step, c_int), &
                                  int(increment, c_int))
    call keyway_umat_restore_traps()
    if (keyway_umat_restore_folder() /= 0 .and. status == 0) then
      call raise(error, 'UEXTERNALDB of the UMAT changes the working folder', analysis_failed)
      return
    end if
    if (status == 0) return
    call raise(error, 'UEXTERNALDB of the UMAT stopped (LOP '//as_text(moment)//', step '// &
               as_text(step)//', increment '//as_text(increment)//'): '//failure_reason(), &
               analysis_failed)
  end subroutine call_external

  !> Findings that have not been reported yet; '' for none.
  function new_notes(self) result(text)
    class(user_library), intent(inout) :: self
    character(:), allocatable :: text
    text = ''
    if (.not. allocated(self%found%asymmetry) .or. self%found%is_asymmetry_reported) return
    text = self%found%asymmetry
    self%found%is_asymmetry_reported = .true.
  end function new_notes

  !> Result of the check of the tangents; '' without a check.
  function check_text(self) result(text)
    class(user_library), intent(in) :: self
    character(:), allocatable :: text
    text = ''
    if (.not. self%checks_tangent) return
    text = text_of_check(self%found%check)
  end function check_text

  !> Closes unit 7 and removes an empty file. The library remains loaded, because its units and
  !> threads may still be in use. Reports the numbers of warnings and errors of the UMAT.
  subroutine close_library(self, note)
    class(user_library), intent(in) :: self
    character(:), allocatable, intent(out) :: note !< '' for none
    integer(c_int) :: num_warnings, num_errors
    integer :: num_bytes, status
    logical :: is_open
    note = ''
    inquire (unit=message_unit, opened=is_open, size=num_bytes)
    if (.not. is_open .or. .not. c_associated(self%handle)) return
    flush (message_unit)
    inquire (unit=message_unit, size=num_bytes)
    if (num_bytes > 0) then
      close (message_unit)
    else
      ! Somebody may have removed the file already.
      close (message_unit, status='delete', iostat=status)
      if (status /= 0) close (message_unit)
    end if
    call keyway_umat_counts(num_warnings, num_errors)
    if (num_warnings + num_errors == 0) return
    note = 'the UMAT wrote '//as_text(int(num_warnings))//' warnings and '// &
           as_text(int(num_errors))//' errors to the .msg file'
  end subroutine close_library
end module umat_loader
