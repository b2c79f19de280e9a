!> Saves and loads the state of an analysis. Every component of the types has a line in each
!> procedure of a pair; tests/tools/test_archives.py compares them with the types.
module state_archive
  use errors, only: error_type
  use archive_type, only: archive
  use guest_histories, only: history_reference, list_histories
  use step_control, only: increment_control
  use analysis_state, only: motion, state, increment_status, last_matrix, reduction_status, &
                            time_accuracy
  use energy_archive, only: load_energy, save_energy
  use modal_errors, only: load_timing, save_timing
  use path_errors, only: load_path, save_path
  use path_twins, only: load_twins, save_twins
  use motion_archive, only: save_motion, load_motion
  use thermal_strains, only: heat_field
  use write_text, only: as_text
  implicit none
  private
  public :: save_state, load_state, save_reduction, load_reduction, save_accuracy, load_accuracy

contains

  !> Writes the state into the group `state`.
  subroutine save_state(now, file, error, whole)
    type(state), intent(in) :: now
    class(archive), intent(inout) :: file !< open for writing
    type(error_type), allocatable, intent(out) :: error
    type(motion), intent(in), optional :: whole !< in place of the part that this rank has
    call file%open_group('state')
    call file%open_group('status')
    call save_status(now%increment_status, file)
    call file%close_group()
    call file%put('u', now%u)
    call file%put('v', now%v)
    call file%put('a', now%a)
    call file%put('reaction', now%reaction)
    call file%put('support_start', now%support_start)
    call file%put('origin', now%origin)
    call file%open_group('heat')
    call save_heat(now%heat, file)
    call file%close_group()
    call file%open_group('matrix')
    call save_matrix(now%matrix, file)
    call file%close_group()
    call file%open_group('motion')
    if (present(whole)) then
      call save_motion(whole, file)
    else
      call save_motion(now%motion, file)
    end if
    call file%close_group()
    call save_histories(now, file)
    call save_twins(now%twins, file)
    call file%close_group()
    call file%report(error)
  end subroutine save_state

  !> Reads the state. The state must be the one of `start_analysis` for this model, which fixes the
  !> sizes. After an error the state is invalid.
  subroutine load_state(now, file, error)
    type(state), intent(inout) :: now
    class(archive), intent(inout) :: file !< open for reading
    type(error_type), allocatable, intent(out) :: error
    call file%open_group('state')
    call file%open_group('status')
    call load_status(now%increment_status, file)
    call file%close_group()
    call load_fields(now, file)
    call file%open_group('heat')
    call load_heat(now%heat, file)
    call file%close_group()
    call file%open_group('matrix')
    call load_matrix(now%matrix, file)
    call file%close_group()
    call file%open_group('motion')
    call load_motion(now%motion, file)
    call file%close_group()
    call load_histories(now, file)
    call load_twins(now%twins, file)
    call file%close_group()
    call file%report(error)
  end subroutine load_state

  !> Writes the histories of joints, inelastic solids and other guests.
  subroutine save_histories(now, file)
    type(state), intent(in) :: now
    class(archive), intent(inout) :: file
    type(history_reference), allocatable :: list(:)
    integer :: i
    call file%put('num_joints', size(now%joints))
    call file%put('num_blocks', size(now%points))
    call file%put('num_guests', size(now%guests))
    call list_histories(now, list)
    do i = 1, size(list)
      if (.not. associated(list(i)%own)) cycle
      call file%open_group(key_of(list(i)))
      call list(i)%own%save(file)
      call file%close_group()
    end do
  end subroutine save_histories

  !> Reads them; the model fixes which there are.
  subroutine load_histories(now, file)
    type(state), intent(inout) :: now
    class(archive), intent(inout) :: file
    type(history_reference), allocatable :: list(:)
    integer :: i
    call file%confirm('num_joints', size(now%joints))
    call file%confirm('num_blocks', size(now%points))
    call file%confirm('num_guests', size(now%guests))
    call list_histories(now, list)
    do i = 1, size(list)
      if (.not. associated(list(i)%own)) cycle
      call file%open_group(key_of(list(i)))
      call list(i)%own%load(file)
      call file%close_group()
    end do
  end subroutine load_histories

  !> Name of the group of a history: 'joint_1', 'points_3', 'guest_2'.
  function key_of(item) result(key)
    type(history_reference), intent(in) :: item
    character(:), allocatable :: key
    key = trim(item%kind)//'_'//as_text(item%number)
  end function key_of

  !> Reads the fields at nodes. A step without inertia has no velocities and accelerations.
  subroutine load_fields(now, file)
    type(state), intent(inout) :: now
    class(archive), intent(inout) :: file
    integer :: extent(2)
    extent = shape(now%u)
    call file%get('u', now%u)
    call file%get('v', now%v, extent)
    call file%get('a', now%a, extent)
    call file%get('reaction', now%reaction)
    if (allocated(now%support_start)) deallocate (now%support_start)
    call file%get('support_start', now%support_start)
    if (allocated(now%origin)) deallocate (now%origin)
    call file%get('origin', now%origin)
  end subroutine load_fields

  !> Writes the temperatures, where there are any.
  subroutine save_heat(heat, file)
    type(heat_field), intent(in) :: heat
    class(archive), intent(inout) :: file
    call file%put('temperature', heat%temperature)
    call file%put('reference', heat%reference)
  end subroutine save_heat

  !> Reads the temperatures; those of the start fix the sizes.
  subroutine load_heat(heat, file)
    type(heat_field), intent(inout) :: heat
    class(archive), intent(inout) :: file
    call file%get('temperature', heat%temperature)
    call file%get('reference', heat%reference)
  end subroutine load_heat

  !> Writes the last matrix.
  subroutine save_matrix(matrix, file)
    type(last_matrix), intent(in) :: matrix
    class(archive), intent(inout) :: file
    call file%put('number', matrix%number)
    call file%put('is_elastic', matrix%is_elastic)
    call file%put('is_symmetric', matrix%is_symmetric)
    call file%put('increment_size', matrix%increment_size)
    call file%put('lost', matrix%lost)
    call file%put('has_all_blocks', matrix%has_all_blocks)
  end subroutine save_matrix

  !> Reads the last matrix.
  subroutine load_matrix(matrix, file)
    type(last_matrix), intent(inout) :: matrix
    class(archive), intent(inout) :: file
    call file%get('number', matrix%number)
    call file%get('is_elastic', matrix%is_elastic)
    call file%get('is_symmetric', matrix%is_symmetric)
    call file%get('increment_size', matrix%increment_size)
    if (allocated(matrix%lost)) deallocate (matrix%lost)
    call file%get('lost', matrix%lost)
    call file%get('has_all_blocks', matrix%has_all_blocks)
  end subroutine load_matrix

  !> Writes the status of the analysis.
  subroutine save_status(status, file)
    type(increment_status), intent(in) :: status
    class(archive), intent(inout) :: file
    call file%put('step', status%step)
    call file%put('increment', status%increment)
    call file%put('iterations', status%iterations)
    call file%put('augmentations', status%augmentations)
    call file%put('cutbacks', status%cutbacks)
    call file%put('num_unknowns', status%num_unknowns)
    call file%put('has_held_switches', status%has_held_switches)
    call file%put('has_opened_step', status%has_opened_step)
    call file%put('is_last_of_step', status%is_last_of_step)
    call file%put('is_stop', status%is_stop)
    call file%put('step_time', status%step_time)
    call file%put('total_time', status%total_time)
    call file%put('increment_size', status%increment_size)
    call file%put('step_start', status%step_start)
    call file%put('joint_condition', status%joint_condition)
    call file%put('residual', status%residual)
    call file%put('largest_force', status%largest_force)
    call file%open_group('energy')
    call save_energy(status%energy, file)
    call file%close_group()
    call file%open_group('control')
    call save_control(status%control, file)
    call file%close_group()
    call file%open_group('reduction')
    call save_reduction(status%reduction, file)
    call file%close_group()
    call file%open_group('accuracy')
    call save_accuracy(status%accuracy, file)
    call file%close_group()
    call file%open_group('timing')
    call save_timing(status%timing, file)
    call file%close_group()
    call file%open_group('path')
    call save_path(status%path, file)
    call file%close_group()
  end subroutine save_status

  !> Reads where the analysis is.
  subroutine load_status(status, file)
    type(increment_status), intent(inout) :: status
    class(archive), intent(inout) :: file
    call file%get('step', status%step)
    call file%get('increment', status%increment)
    call file%get('iterations', status%iterations)
    call file%get('augmentations', status%augmentations)
    call file%get('cutbacks', status%cutbacks)
    call file%get('num_unknowns', status%num_unknowns)
    call file%get('has_held_switches', status%has_held_switches)
    call file%get('has_opened_step', status%has_opened_step)
    call file%get('is_last_of_step', status%is_last_of_step)
    call file%get('is_stop', status%is_stop)
    call file%get('step_time', status%step_time)
    call file%get('total_time', status%total_time)
    call file%get('increment_size', status%increment_size)
    call file%get('step_start', status%step_start)
    call file%get('joint_condition', status%joint_condition)
    call file%get('residual', status%residual)
    call file%get('largest_force', status%largest_force)
    call file%open_group('energy')
    call load_energy(status%energy, file)
    call file%close_group()
    call file%open_group('control')
    call load_control(status%control, file)
    call file%close_group()
    call file%open_group('reduction')
    call load_reduction(status%reduction, file)
    call file%close_group()
    call file%open_group('accuracy')
    call load_accuracy(status%accuracy, file)
    call file%close_group()
    call file%open_group('timing')
    call load_timing(status%timing, file)
    call file%close_group()
    call file%open_group('path')
    call load_path(status%path, file)
    call file%close_group()
  end subroutine load_status

  !> Writes what is known of the reduced model.
  subroutine save_reduction(reduction, file)
    type(reduction_status), intent(in) :: reduction
    class(archive), intent(inout) :: file
    call file%put('num_shapes', reduction%num_shapes)
    call file%put('num_modes', reduction%num_modes)
    call file%put('highest', reduction%highest)
    call file%put('estimate', reduction%estimate)
    call file%put('num_broken', reduction%num_broken)
  end subroutine save_reduction

  !> Reads what is known of the reduced model.
  subroutine load_reduction(reduction, file)
    type(reduction_status), intent(inout) :: reduction
    class(archive), intent(inout) :: file
    call file%get('num_shapes', reduction%num_shapes)
    call file%get('num_modes', reduction%num_modes)
    call file%get('highest', reduction%highest)
    call file%get('estimate', reduction%estimate)
    call file%get('num_broken', reduction%num_broken)
  end subroutine load_reduction

  !> Writes the error in time.
  subroutine save_accuracy(accuracy, file)
    type(time_accuracy), intent(in) :: accuracy
    class(archive), intent(inout) :: file
    call file%put('num_known', accuracy%num_known)
    call file%put('size', accuracy%size)
    call file%put('size_before', accuracy%size_before)
    call file%put('largest', accuracy%largest)
    call file%put('mean_rate', accuracy%mean_rate)
    call file%put('held_rate', accuracy%held_rate)
    call file%put('velocity_square', accuracy%velocity_square)
    call file%put('acceleration_square', accuracy%acceleration_square)
    call file%put('third_square', accuracy%third_square)
    call file%put('error', accuracy%error)
    call file%put('largest_error', accuracy%largest_error)
    call file%put('damped', accuracy%damped)
    call file%put('kinetic', accuracy%kinetic)
  end subroutine save_accuracy

  !> Reads the error in time.
  subroutine load_accuracy(accuracy, file)
    type(time_accuracy), intent(inout) :: accuracy
    class(archive), intent(inout) :: file
    call file%get('num_known', accuracy%num_known)
    call file%get('size', accuracy%size)
    call file%get('size_before', accuracy%size_before)
    call file%get('largest', accuracy%largest)
    call file%get('mean_rate', accuracy%mean_rate)
    call file%get('held_rate', accuracy%held_rate)
    call file%get('velocity_square', accuracy%velocity_square)
    call file%get('acceleration_square', accuracy%acceleration_square)
    call file%get('third_square', accuracy%third_square)
    call file%get('error', accuracy%error)
    call file%get('largest_error', accuracy%largest_error)
    call file%get('damped', accuracy%damped)
    call file%get('kinetic', accuracy%kinetic)
  end subroutine load_accuracy

  !> Writes the size of increments.
  subroutine save_control(control, file)
    type(increment_control), intent(in) :: control
    class(archive), intent(inout) :: file
    call file%put('size', control%size)
    call file%put('last_size', control%last_size)
    call file%put('smallest', control%smallest)
    call file%put('largest', control%largest)
    call file%put('first', control%first)
    call file%put('finest', control%finest)
    call file%put('duration', control%duration)
    call file%put('growth', control%growth)
    call file%put('easy_needed', control%easy_needed)
    call file%put('is_direct', control%is_direct)
    call file%put('easy_so_far', control%easy_so_far)
    call file%put('cuts_in_a_row', control%cuts_in_a_row)
    call file%put('cutbacks', control%cutbacks)
    call file%put('steady_so_far', control%steady_so_far)
    call file%put('steady_needed', control%steady_needed)
    call file%put('has_tried', control%has_tried)
  end subroutine save_control

  !> Reads the size of increments.
  subroutine load_control(control, file)
    type(increment_control), intent(inout) :: control
    class(archive), intent(inout) :: file
    call file%get('size', control%size)
    call file%get('last_size', control%last_size)
    call file%get('smallest', control%smallest)
    call file%get('largest', control%largest)
    call file%get('first', control%first)
    call file%get('finest', control%finest)
    call file%get('duration', control%duration)
    call file%get('growth', control%growth)
    call file%get('easy_needed', control%easy_needed)
    call file%get('is_direct', control%is_direct)
    call file%get('easy_so_far', control%easy_so_far)
    call file%get('cuts_in_a_row', control%cuts_in_a_row)
    call file%get('cutbacks', control%cutbacks)
    call file%get('steady_so_far', control%steady_so_far)
    call file%get('steady_needed', control%steady_needed)
    call file%get('has_tried', control%has_tried)
  end subroutine load_control
end module state_archive
