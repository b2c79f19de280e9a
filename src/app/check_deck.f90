!> Reads a deck, reports its faults, and prints a summary of the model.
module check_deck
  use, intrinsic :: iso_fortran_env, only: error_unit
  use cli, only: command_line
  use diagnostic_text, only: text_of_errors, text_of_warnings
  use diagnostics, only: diagnostic_list
  use file_system, only: base_name
  use errors, only: deck_is_wrong, error_type, raise
  use model_summary, only: summary_of, summary_of_tests
  use problem_definition, only: problem
  use process_limits, only: print_text
  use read_deck, only: read_problem
  use run_forecast, only: forecast_of
  use run_ledger, only: ledger
  use run_lock, only: job_lock
  use umat_loader, only: user_library
  use user_routines, only: load_user_routines
  implicit none
  private
  public :: load_deck, report_model

contains

  !> Reads and verifies the deck; faults become an error, warnings go to stderr.
  subroutine load_deck(given, lock, model, faults, echo, error)
    type(command_line), intent(in) :: given
    type(job_lock), intent(inout) :: lock !< taken where there is a UMAT
    type(problem), allocatable, intent(out) :: model
    type(diagnostic_list), intent(out) :: faults !< warnings, for the summary of the run
    character(:), allocatable, intent(out) :: echo !< the deck with its defaults
    type(error_type), allocatable, intent(out) :: error
    type(user_library), pointer :: umat
    character(:), allocatable :: note
    integer :: i
    call load_user_routines(given, lock, umat, error)
    if (allocated(error)) return
    call read_problem(given%deck, model, faults, echo, given%reading, umat)
    if (faults%num_warnings > 0 .and. .not. given%is_quiet) then
      write (error_unit, '(a)') text_of_warnings(faults, is_named=.true.)
    end if
    if (associated(umat) .and. (given%is_check .or. faults%has_errors())) call umat%close(note)
    if (faults%has_errors()) then
      call raise(error, text_of_errors(faults, is_named=.true.), deck_is_wrong)
    end if
    if (allocated(error)) return
    do i = 1, size(model%steps)
      model%steps(i)%controls%most_unsaved = given%most_unsaved
      model%steps(i)%controls%stem_of_problems = given%folder//'/'//base_name(given%deck)
    end do
  end subroutine load_deck

  !> Prints the deck with its defaults and a summary of the model.
  subroutine report_model(given, model, echo, costs, error)
    type(command_line), intent(in) :: given
    type(problem), intent(in) :: model
    character(*), intent(in) :: echo
    type(ledger), intent(in) :: costs
    type(error_type), allocatable, intent(out) :: error
    character, parameter :: nl = new_line('a')
    character(:), allocatable :: summary
    if (given%is_material) then
      summary = summary_of_tests(model)
    else
      summary = summary_of(model)//nl//forecast_of(model, costs)
    end if
    call print_text('The deck with its defaults'//nl//echo//nl//nl//summary, error)
  end subroutine report_model
end module check_deck
