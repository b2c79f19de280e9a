!> Runs and writes the tests of materials. A test that stops does not stop the others.
module run_material
  use cli, only: command_line
  use diagnostic_text, only: remarks_for_log
  use diagnostics, only: diagnostic_list
  use errors, only: error_type, keep_first, raise, system_failed
  use file_system, only: base_name, make_folder, safe_name
  use kinds, only: rk
  use logging, only: run_log
  use material_path, only: path_record, follow_path
  use material_summary, only: test_summary, summarise_test, table_of_tests, write_test_summary
  use material_tests, only: material_test
  use problem_definition, only: problem
  use timer, only: wall_clock
  use user_routines, only: end_user_routines
  use write_material, only: write_curve
  use write_text, only: as_text
  implicit none
  private
  public :: run_tests

contains

  !> Runs all tests of the deck. After an error the rows computed so far are in the files.
  subroutine run_tests(model, given, remarks, echo, started_at, error)
    type(problem), intent(in) :: model
    type(command_line), intent(in) :: given
    type(diagnostic_list), intent(in) :: remarks !< warnings of the deck
    character(*), intent(in) :: echo !< the deck with its defaults, for the log
    real(rk), intent(in) :: started_at !< wall clock [s]
    type(error_type), allocatable, intent(out) :: error
    type(test_summary), allocatable :: summaries(:)
    type(error_type), allocatable :: failure
    type(run_log) :: log
    character(:), allocatable :: stem
    integer :: i
    call make_folder(given%folder, error)
    if (allocated(error)) return
    stem = given%folder//'/'//base_name(model%deck_file)//'_material'
    call log%open(given%is_quiet, error, stem//'.log')
    if (allocated(error)) return
    call log%note(echo//remarks_for_log(remarks))
    allocate (summaries(size(model%tests)))
    do i = 1, size(model%tests)
      call run_test(model, model%tests(i), stem, log, summaries(i), failure)
      if (.not. allocated(failure)) cycle
      if (allocated(error)) failure%message = error%message//new_line('a')//failure%message
      call move_alloc(failure, error)
      if (error%exit_code == system_failed) return
    end do
    call end_user_routines(model, maxval(summaries%time), log, failure)
    call keep_first(error, failure)
    call write_test_summary(stem//'.json', model%deck_file, summaries, failure)
    call log%say(table_of_tests(summaries))
    if (.not. allocated(error)) then
      call log%say('finished in '//as_text(wall_clock() - started_at)//' s')
    end if
    call log%close()
    call keep_first(error, failure)
    if (allocated(error) .or. .not. log%has_failed) return
    call raise(error, "cannot write '"//stem//".log' (disk full?)", system_failed)
  end subroutine run_tests

  !> One test and its file.
  subroutine run_test(model, test, stem, log, summary, error)
    type(problem), intent(in) :: model
    type(material_test), intent(in) :: test
    character(*), intent(in) :: stem !< folder and name of the job
    type(run_log), intent(inout) :: log
    type(test_summary), intent(out) :: summary
    type(error_type), allocatable, intent(out) :: error
    type(path_record) :: record
    type(error_type), allocatable :: failure
    associate (material => model%materials(test%material))
      call follow_path(material%law, test, record, error, model%umat)
      call summarise_test(test, material%name, record, summary)
      summary%has_finished = .not. allocated(error)
      if (allocated(error)) summary%message = error%message
      if (allocated(error)) call log%note(error%message)
      summary%file = base_name(stem//'.csv')//'_'//safe_name(test%name)//'.csv'
      call write_curve(stem//'_'//safe_name(test%name)//'.csv', material%law, record, failure)
      if (allocated(failure)) call move_alloc(failure, error)
    end associate
  end subroutine run_test
end module run_material
