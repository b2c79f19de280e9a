!> The files of checkpoints: job.ckpt.h5 and the one before, job.ckpt_old.h5, each with the journal
!> that sets job.h5 back to it, job.undo and job.undo_old.
!>
!> Order of a new checkpoint, so that a kill between any two of these leaves one that is complete:
!> the file is written under another name, its journal starts under another name, the last
!> checkpoint becomes the old one, the file takes its name, the journal of the last checkpoint
!> becomes the old one, the new journal takes its name. A checkpoint always has its journal.
module checkpoint_files
  use errors, only: error_type, raise, raise_unwritten, system_failed
  use file_identity, only: add_path, file_path
  use undo_journal, only: bad_journal, bad_old_journal, is_restored, no_file, no_journal, &
                          no_old_journal, number_of_journal, other_file, restore_file, short_file
  use whole_files, only: move_file, remove_file
  implicit none
  private
  public :: checkpoint_path, new_checkpoint_path, new_journal_path, keep_checkpoint, &
            keep_journal, take_journal, return_to_old, restore_results, has_checkpoint, &
            remove_checkpoints, list_checkpoint_files

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

  !> The journal of the checkpoint that is being written.
  pure function new_journal_path(stem) result(path)
    character(*), intent(in) :: stem
    character(:), allocatable :: path
    path = stem//'.undo_new'
  end function new_journal_path

  !> The new checkpoint becomes the last one.
  subroutine keep_checkpoint(stem, error)
    character(*), intent(in) :: stem
    type(error_type), allocatable, intent(out) :: error
    logical :: is_moved
    call move_file(checkpoint_path(stem, .false.), checkpoint_path(stem, .true.), is_moved)
    call move_file(new_checkpoint_path(stem), checkpoint_path(stem, .false.), is_moved)
    if (.not. is_moved) call raise_unwritten(error, checkpoint_path(stem, .false.))
  end subroutine keep_checkpoint

  !> The journal of the last checkpoint becomes the old one, and the new one becomes the last.
  subroutine keep_journal(stem, error)
    character(*), intent(in) :: stem
    type(error_type), allocatable, intent(out) :: error
    logical :: ignored
    call move_file(journal_path(stem, .false.), journal_path(stem, .true.), ignored)
    call take_journal(stem, error)
  end subroutine keep_journal

  !> The new journal takes the place of the last one.
  subroutine take_journal(stem, error)
    character(*), intent(in) :: stem
    type(error_type), allocatable, intent(out) :: error
    logical :: is_moved
    call move_file(new_journal_path(stem), journal_path(stem, .false.), is_moved)
    if (.not. is_moved) call raise_unwritten(error, journal_path(stem, .false.))
  end subroutine take_journal

  !> The old checkpoint becomes the last one, which is damaged.
  subroutine return_to_old(stem)
    character(*), intent(in) :: stem
    logical :: ignored
    call move_file(checkpoint_path(stem, .true.), checkpoint_path(stem, .false.), ignored)
    call remove_file(journal_path(stem, .true.))
  end subroutine return_to_old

  !> Sets job.h5 back to a checkpoint by its journal and those of later checkpoints.
  subroutine restore_results(stem, number, error)
    character(*), intent(in) :: stem
    integer, intent(in) :: number !< of the checkpoint
    type(error_type), allocatable, intent(out) :: error
    integer :: found
    found = restore_file(stem//'.h5', new_journal_path(stem), journal_path(stem, .false.), &
                         journal_path(stem, .true.), number)
    select case (found)
    case (is_restored)
      call settle_journals(stem, number, error)
    case (no_journal:other_file)
      call raise(error, "cannot continue '"//stem//".h5': "//reason_of(stem, found)// &
                 '; put back the files that the run has left, or start the analysis anew '// &
                 'without --continue', system_failed)
    case default
      call raise_unwritten(error, stem//'.h5')
    end select
  end subroutine restore_results

  !> Why job.h5 cannot be set back.
  pure function reason_of(stem, found) result(reason)
    character(*), intent(in) :: stem
    integer, intent(in) :: found !< by undo_journal
    character(:), allocatable :: reason, journal
    journal = "'"//journal_path(stem, any(found == [no_old_journal, bad_old_journal]))//"'"
    select case (found)
    case (no_journal, no_old_journal)
      reason = 'its journal '//journal//' is missing, or it does not belong to the checkpoint'
    case (bad_journal, bad_old_journal)
      reason = 'its journal '//journal//' is damaged'
    case (no_file)
      reason = 'the file is missing, or it may not be written'
    case (short_file)
      reason = 'the file is shorter than at the checkpoint'
    case default
      reason = 'the file is not as it was at the checkpoint: it or its journal '//journal// &
               ' was changed or damaged'
    end select
  end function reason_of

  !> The journal of the checkpoint to which job.h5 was set back becomes the last one, if it is not.
  !> A kill in between changes nothing: job.h5 can be set back again.
  subroutine settle_journals(stem, number, error)
    character(*), intent(in) :: stem
    integer, intent(in) :: number !< of the checkpoint
    type(error_type), allocatable, intent(out) :: error
    logical :: ignored
    if (number_of_journal(new_journal_path(stem)) == number) then
      if (number_of_journal(journal_path(stem, .false.)) == number) then
        call take_journal(stem, error)
      else
        call keep_journal(stem, error)
      end if
    else if (number_of_journal(journal_path(stem, .true.)) == number) then
      call move_file(journal_path(stem, .true.), journal_path(stem, .false.), ignored)
    end if
    call remove_file(new_journal_path(stem))
  end subroutine settle_journals

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
    call add_path(paths, new_journal_path(stem))
    call add_path(paths, journal_path(stem, .false.))
    call add_path(paths, journal_path(stem, .true.))
  end subroutine list_checkpoint_files
end module checkpoint_files
