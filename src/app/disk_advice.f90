!> What to do when a file of the results could not be written.
module disk_advice
  use checkpoint_files, only: has_checkpoint
  use errors, only: analysis_failed, error_type
  use stop_signals, only: has_met_file_limit
  implicit none
  private
  public :: explain_failed_write

contains

  !> Adds the remedy to the message. At the limit of file sizes the exit code is that of an analysis
  !> that stopped: the user has set the limit, the system has not failed.
  subroutine explain_failed_write(error, stem, is_open)
    type(error_type), allocatable, intent(inout) :: error
    character(*), intent(in) :: stem !< folder and name of the job
    logical, intent(in) :: is_open !< checkpoints in the folder are of this run
    character(:), allocatable :: remedy
    if (.not. allocated(error)) return
    if (.not. error%is_of_disk) return
    remedy = 'remove the cause'
    if (index(error%message, 'disk full?') > 0 .or. index(error%message, 'No space') > 0 &
        .or. index(error%message, 'quota') > 0) remedy = 'make room on the disk'
    if (index(error%message, 'Permission denied') > 0) remedy = 'allow writing'
    if (index(error%message, 'Read-only') > 0) remedy = 'allow writing'
    if (has_met_file_limit()) then
      remedy = 'raise the limit'
      error%exit_code = analysis_failed
      error%message = 'stopped by the limit of file sizes (ulimit -f): '//error%message
    end if
    if (.not. is_open) then
      error%message = error%message//'; '//remedy//' and run again'
    else if (has_checkpoint(stem)) then
      error%message = error%message//'; '//remedy//': keyway --continue goes on from the last '// &
                      'checkpoint'
    else
      error%message = error%message//'; '//remedy//' and run again (*RESTART, WRITE in the '// &
                      'deck writes checkpoints to go on from)'
    end if
  end subroutine explain_failed_write
end module disk_advice
