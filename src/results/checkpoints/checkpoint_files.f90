!> The files of checkpoints: job.ckpt.h5 and the one before, job.ckpt_old.h5, each with the journal
!> that sets job.h5 back to it, job.undo and job.undo_old.
!>
!> Order of a new checkpoint, so that a kill between any two of these leaves one that is complete:
!> the file is written under another name, the last checkpoint becomes the old one, the file takes
!> its name, the journal of the last checkpoint becomes the old one, the new journal starts.
module checkpoint_files
  use errors, only: error_type, raise, raise_unwritten, system_failed
  use file_identity, only: add_path, file_path
  use undo_journal, only: number_of_journal, restore_file
  use whole_files, only: move_file, remove_file
  implicit none
  private
  public :: checkpoint_path, new_checkpoint_path, journal_path, keep_checkpoint, keep_journal, &
            return_to_old, restore_results, has_checkpoint, remove_checkpoints, &
            list_checkpoint_files

contains

  !> The last checkpoint, or the one before.
  pure function checkpoint_path(stem, is_old) result(path)
    character(*), intent(in) :: stem !< folder and name of the job
    logical, intent(in) :: is_old
    character(:), allocatable :: path
    path = stem//'.ckpt.h5'
    if (is_old) path = stem//'.ckpt_old.h5'
  end function checkpoint_path

  !> The checkpoint that is being written.
  pure function new_checkpoint_path(stem) result(path)
    character(*), intent(in) :: stem
    character(:), allocatable :: path
    path = stem//'.ckpt_new.h5'
  end function new_checkpoint_path

  !> The journal of the last checkpoint, or of the one before.
  pure function journal_path(stem, is_old) result(path)
    character(*), intent(in) :: stem
    logical, intent(in) :: is_old
    character(:), allocatable :: path
    path = stem//'.undo'
    if (is_old) path = stem//'.undo_old'
  end function journal_path

  !> The new checkpoint becomes the last one.
  subroutine keep_checkpoint(stem, error)
    character(*), intent(in) :: stem
    type(error_type), allocatable, intent(out) :: error
    logical :: is_moved
    call move_file(checkpoint_path(stem, .false.), checkpoint_path(stem, .true.), is_moved)
    call move_file(new_checkpoint_path(stem), checkpoint_path(stem, .false.), is_moved)
    if (.not. is_moved) call raise_unwritten(error, checkpoint_path(stem, .false.))
  end subroutine keep_checkpoint

  !> The journal of the last checkpoint becomes the old one.
  subroutine keep_journal(stem)
    character(*), intent(in) :: stem
    logical :: ignored
    call move_file(journal_path(stem, .false.), journal_path(stem, .true.), ignored)
  end subroutine keep_journal

  !> The old checkpoint becomes the last one, which is damaged.
  subroutine return_to_old(stem)
    character(*), intent(in) :: stem
    logical :: ignored
    call move_file(checkpoint_path(stem, .true.), checkpoint_path(stem, .false.), ignored)
    call remove_file(journal_path(stem, .true.))
  end subroutine return_to_old

  !> Sets job.h5 back to a checkpoint, journal by journal from the last one. Without a journal of
  !> the checkpoint nothing was written after it.
  subroutine restore_results(stem, number, error)
    character(*), intent(in) :: stem
    integer, intent(in) :: number !< of the checkpoint
    type(error_type), allocatable, intent(out) :: error
    character(:), allocatable :: journal
    logical :: is_good
    integer :: i
    do i = 1, 2
      journal = journal_path(stem, i == 2)
      if (number_of_journal(journal) < number) cycle
      call restore_file(stem//'.h5', journal, is_good)
      if (is_good) cycle
      call raise(error, "keyway: --continue: cannot set '"//stem//".h5' back to the checkpoint", &
                 system_failed)
      return
    end do
  end subroutine restore_results

  !> Whether a run can go on from a checkpoint.
  logical function has_checkpoint(stem)
    character(*), intent(in) :: stem
    logical :: is_there(2)
    inquire (file=checkpoint_path(stem, .false.), exist=is_there(1))
    inquire (file=checkpoint_path(stem, .true.), exist=is_there(2))
    has_checkpoint = any(is_there)
  end function has_checkpoint

  !> Removes the checkpoints of an earlier run.
  subroutine remove_checkpoints(stem)
    character(*), intent(in) :: stem
    type(file_path), allocatable :: paths(:)
    integer :: i
    allocate (paths(0))
    call list_checkpoint_files(stem, paths)
    do i = 1, size(paths)
      call remove_file(paths(i)%path)
    end do
  end subroutine remove_checkpoints

  !> The paths of all files of checkpoints.
  subroutine list_checkpoint_files(stem, paths)
    character(*), intent(in) :: stem
    type(file_path), allocatable, intent(inout) :: paths(:)
    call add_path(paths, new_checkpoint_path(stem)//'.part')
    call add_path(paths, new_checkpoint_path(stem))
    call add_path(paths, checkpoint_path(stem, .false.))
    call add_path(paths, checkpoint_path(stem, .true.))
    call add_path(paths, journal_path(stem, .false.))
    call add_path(paths, journal_path(stem, .true.))
  end subroutine list_checkpoint_files
end module checkpoint_files
