!> The UMAT of the command line: loaded before the deck is read, called at the end of the run.
module user_routines
  use cli, only: command_line
  use disk_advice, only: explain_failed_write
  use errors, only: error_type
  use file_system, only: base_name, make_folder
  use kinds, only: rk
  use logging, only: run_log
  use problem_definition, only: problem
  use ranks, only: is_first_rank
  use run_lock, only: job_lock
  use umat_loader, only: at_end, open_library, umat_request, user_library
  implicit none
  private
  public :: load_user_routines, end_user_routines, close_user_routines

contains

  !> Builds and loads the UMAT that --umat names; null without --umat. The lock of the run is taken
  !> before the first file is touched and stays taken: of several runs that start at the same time
  !> one goes on. Only the first rank has a lock and keeps what the UMAT writes.
  subroutine load_user_routines(given, lock, umat, error)
    type(command_line), intent(in) :: given
    type(job_lock), intent(inout) :: lock
    type(user_library), pointer, intent(out) :: umat !< lives as long as the program
    type(error_type), allocatable, intent(out) :: error
    nullify (umat)
    if (size(given%umat%files) == 0) return
    allocate (umat)
    if (.not. is_first_rank()) then
      call open_silently(given, umat, error)
      return
    end if
    call make_folder(given%folder, error)
    call explain_failed_write(error, given%folder, .false.)
    if (allocated(error)) return
    ! The UMAT's messages go to job.msg, which another run may be writing.
    call lock%take(given%folder//'/'//base_name(given%deck)//'.lock', error)
    call explain_failed_write(error, given%folder, .false.)
    if (allocated(error)) return
    call open_library(given%umat, base_name(given%deck), given%folder, umat, error)
  end subroutine load_user_routines

  !> Builds and loads the UMAT of another rank than the first.
  subroutine open_silently(given, umat, error)
    type(command_line), intent(in) :: given
    type(user_library), intent(inout) :: umat
    type(error_type), allocatable, intent(out) :: error
    type(umat_request) :: request
    request = given%umat
    request%target = ''
    request%is_silent = .true.
    call open_library(request, base_name(given%deck), given%folder, umat, error)
  end subroutine open_silently

  !> Closes the library of a run that does not start.
  subroutine close_user_routines(model)
    type(problem), intent(in) :: model
    character(:), allocatable :: ignored
    if (associated(model%umat)) call model%umat%close(ignored)
  end subroutine close_user_routines

  !> Calls UEXTERNALDB at the end of the run, and writes the checks of the UMAT to the log.
  subroutine end_user_routines(model, time, log, error)
    type(problem), intent(in) :: model
    real(rk), intent(in) :: time !< total [s]
    type(run_log), intent(inout) :: log
    type(error_type), allocatable, intent(out) :: error
    character(:), allocatable :: note
    if (.not. associated(model%umat)) return
    call model%umat%call_external(at_end, [0.0_rk, time], 0.0_rk, size(model%steps), 0, error)
    note = model%umat%new_notes()
    if (len(note) > 0) call log%say(note)
    note = model%umat%check_text()
    if (len(note) > 0) call log%say(note)
    call model%umat%close(note)
    if (len(note) > 0) call log%say(note)
  end subroutine end_user_routines
end module user_routines
