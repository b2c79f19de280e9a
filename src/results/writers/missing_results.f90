!> Files of results from before a checkpoint that a run which goes on does not find.
module missing_results
  use earlier_files, only: missing_files
  use file_system, only: file_name
  use run_records, only: run_record
  use write_text, only: as_text
  use writer_catalogue, only: writer_item
  implicit none
  private
  public :: warn_of_missing

contains

  !> Warns of missing files, which no later increment writes. The writers have opened their own.
  subroutine warn_of_missing(stem, writers, record)
    character(*), intent(in) :: stem !< folder and name of the job
    type(writer_item), intent(in) :: writers(:)
    type(run_record), intent(inout) :: record !< of the checkpoint
    type(missing_files) :: missing
    character(:), allocatable :: folder
    integer :: i
    do i = 1, size(writers)
      if (.not. writers(i)%item%is_idle) call writers(i)%item%note_missing(missing)
    end do
    folder = stem(:len(stem) - len(file_name(stem)))
    do i = 1, size(record%files)
      call missing%look_for(folder//record%files(i)%text)
    end do
    if (missing%num_files == 0) return
    call record%warn_once('files of the results from before the checkpoint are missing ('// &
                          as_text(missing%num_files)//", the first is '"//missing%first// &
                          "'): --continue does not write them again; put them back, or start "// &
                          'the analysis anew')
  end subroutine warn_of_missing
end module missing_results
