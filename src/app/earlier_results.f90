!> The summary of an earlier run in the folder, when the deck of a new run has errors: a script that
!> reads it must not take the earlier results for those of the new deck.
module earlier_results
  use cli, only: command_line
  use earlier_files, only: mark_summary
  use errors, only: deck_is_wrong, error_type
  use file_identity, only: is_same_file
  use file_system, only: base_name
  use problem_definition, only: problem
  use run_lock, only: job_lock
  implicit none
  private
  public :: mark_earlier_results

contains

  !> Marks the summary of the earlier run, unless it was read as input or a run is writing it.
  subroutine mark_earlier_results(given, model, lock, reason)
    type(command_line), intent(in) :: given
    type(problem), allocatable, intent(in) :: model !< as far as it was read
    type(job_lock), intent(inout) :: lock !< taken by this procedure unless it is taken already
    type(error_type), intent(in) :: reason !< why the deck was not loaded
    type(error_type), allocatable :: error
    character(:), allocatable :: stem
    logical :: is_there
    integer :: i
    if (reason%exit_code /= deck_is_wrong) return
    if (given%is_check .or. given%is_material) return
    stem = given%folder//'/'//base_name(given%deck)
    inquire (file=stem//'.json', exist=is_there)
    if (.not. is_there) return
    if (is_same_file(stem//'.json', given%deck)) return
    if (allocated(model)) then
      do i = 1, size(model%inputs)
        if (is_same_file(stem//'.json', model%inputs(i)%path)) return
      end do
    end if
    call lock%take(stem//'.lock', error)
    if (allocated(error)) return
    call mark_summary(stem//'.json', 'the deck has errors; these results are of an earlier '// &
                      'deck, whose sha256 stands below')
  end subroutine mark_earlier_results
end module earlier_results
