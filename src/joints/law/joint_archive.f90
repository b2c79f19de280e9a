!> Saves and loads the history of a joint. Every component of `joint_state` has a line in each of
!> the two procedures; tests/tools/test_archives.py compares them with the type.
module joint_archive
  use archive_type, only: archive
  use joint_law, only: joint_state
  implicit none
  private
  public :: save_joint, load_joint

contains

  !> Writes the history of one joint into the present group.
  subroutine save_joint(history, file)
    type(joint_state), intent(in) :: history
    class(archive), intent(inout) :: file
    call file%put('gap', history%gap)
    call file%put('shift', history%shift)
    call file%put('jump', history%jump)
    call file%put('traction', history%traction)
    call file%put('slip', history%slip)
    call file%put('is_broken', history%is_broken)
    call file%put('status', history%status)
    call file%put('num_openings', history%num_openings)
    call file%put('friction_work', history%friction_work)
    call file%put('fracture_work', history%fracture_work)
    call file%put('internal', history%internal)
    call file%put('water', history%water)
  end subroutine save_joint

  !> Reads the history of one joint from the present group. The history must be in its initial
  !> state, which fixes the sizes.
  subroutine load_joint(history, file)
    type(joint_state), intent(inout) :: history
    class(archive), intent(inout) :: file
    call file%get('gap', history%gap)
    call file%get('shift', history%shift)
    call file%get('jump', history%jump)
    call file%get('traction', history%traction)
    call file%get('slip', history%slip)
    call file%get('is_broken', history%is_broken)
    call file%get('status', history%status)
    call file%get('num_openings', history%num_openings)
    call file%get('friction_work', history%friction_work)
    call file%get('fracture_work', history%fracture_work)
    call file%get('internal', history%internal)
    if (allocated(history%gap)) call file%get('water', history%water, shape(history%gap))
  end subroutine load_joint
end module joint_archive
