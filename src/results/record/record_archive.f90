!> Saves and loads the record of a run: extremes, envelopes, warnings. Faces of the dam come from
!> the model, stresses from the state. tests/tools/test_archives.py compares the procedures with the
!> types.
module record_archive
  use errors, only: error_type
  use kinds, only: rk
  use archive_type, only: archive
  use write_text, only: as_text
  use extremes, only: extremes_by_face
  use envelopes, only: envelope
  use joint_readings, only: joint_record
  use damage_readings, only: damage_record, damage_extreme
  use run_records, only: run_record, text_item
  use goal_errors, only: goal_error
  use space_errors, only: space_error
  implicit none
  private
  public :: save_record, load_record

contains

  !> Writes the record into the group `record`.
  subroutine save_record(record, file, error)
    type(run_record), intent(in) :: record
    class(archive), intent(inout) :: file !< open for writing
    type(error_type), allocatable, intent(out) :: error
    integer :: i
    call file%open_group('record')
    call file%put('step', record%step)
    call file%put('active', record%active)
    call file%put('most_taken', record%most_taken)
    call file%put('last_strain', record%last_strain)
    call file%put('last_fracture', record%last_fracture)
    call file%open_group('space')
    call save_space_error(record%space, file)
    call file%close_group()
    do i = 1, size(record%goals)
      call file%open_group('goal_'//as_text(i))
      call save_goal_error(record%goals(i), file)
      call file%close_group()
    end do
    ! Stresses by the operator and through the points differ by round-off.
    call file%put('num_recoveries', record%stresses%num_recoveries)
    call file%put('has_operator', record%stresses%has_operator .or. record%stresses%had_operator)
    call file%put('num_joints', size(record%joints))
    do i = 1, size(record%joints)
      call file%open_group('joint_'//as_text(i))
      call save_joint_record(record%joints(i), file)
      call file%close_group()
    end do
    call file%open_group('damage')
    call save_damage_record(record%damage, file)
    call file%close_group()
    call save_extremes('displacement', record%displacement, file)
    call file%put('num_envelopes', size(record%envelopes))
    do i = 1, size(record%envelopes)
      call file%open_group('envelope_'//as_text(i))
      call save_envelope(record%envelopes(i), file)
      call file%close_group()
    end do
    call save_texts('warnings', record%warnings, file)
    call save_texts('files', record%files, file)
    call file%close_group()
    call file%report(error)
  end subroutine save_record

  !> Reads a record that is open for this model. After an error the record is invalid.
  subroutine load_record(record, file, error)
    type(run_record), intent(inout) :: record
    class(archive), intent(inout) :: file !< open for reading
    type(error_type), allocatable, intent(out) :: error
    integer :: i, num_envelopes
    call file%open_group('record')
    call file%get('step', record%step)
    if (allocated(record%active)) deallocate (record%active)
    call file%get('active', record%active)
    call file%get('most_taken', record%most_taken)
    call file%get('last_strain', record%last_strain)
    call file%get('last_fracture', record%last_fracture)
    call file%open_group('space')
    call load_space_error(record%space, file)
    call file%close_group()
    do i = 1, size(record%goals)
      call file%open_group('goal_'//as_text(i))
      call load_goal_error(record%goals(i), file)
      call file%close_group()
    end do
    call file%get('num_recoveries', record%stresses%num_recoveries)
    call file%get('has_operator', record%stresses%had_operator)
    call file%confirm('num_joints', size(record%joints))
    do i = 1, size(record%joints)
      call file%open_group('joint_'//as_text(i))
      call load_joint_record(record%joints(i), file)
      call file%close_group()
    end do
    call file%open_group('damage')
    call load_damage_record(record%damage, file)
    call file%close_group()
    call load_extremes('displacement', record%displacement, file)
    num_envelopes = 0
    call file%get('num_envelopes', num_envelopes)
    if (allocated(record%envelopes)) deallocate (record%envelopes)
    allocate (record%envelopes(num_envelopes))
    do i = 1, num_envelopes
      call file%open_group('envelope_'//as_text(i))
      call load_envelope(record%envelopes(i), file)
      call file%close_group()
    end do
    call load_texts('warnings', record%warnings, file)
    call load_texts('files', record%files, file)
    call file%close_group()
    call record%stresses%invalidate()
    call file%report(error)
  end subroutine load_record

  !> Writes the error of the mesh.
  subroutine save_space_error(record, file)
    type(space_error), intent(in) :: record
    class(archive), intent(inout) :: file
    call file%put('stress', record%stress)
    call file%put('error', record%error)
    call file%put('time', record%time)
    call file%put('sampled', record%sampled)
    call file%put('elastic', record%elastic)
  end subroutine save_space_error

  !> Reads the error of the mesh.
  subroutine load_space_error(record, file)
    type(space_error), intent(inout) :: record
    class(archive), intent(inout) :: file
    call file%get('stress', record%stress)
    call file%get('error', record%error)
    call file%get('time', record%time)
    call file%get('sampled', record%sampled)
    call file%get('elastic', record%elastic)
  end subroutine load_space_error

  !> Writes the errors of a result.
  subroutine save_goal_error(record, file)
    type(goal_error), intent(in) :: record
    class(archive), intent(inout) :: file
    call file%put('at_time', record%at_time)
    call file%put('time', record%time)
    call file%put('history', record%history)
    call file%put('mesh', record%mesh)
    call file%put('at_dual', record%at_dual)
    call file%put('joints', record%joints)
    call file%put('iteration', record%iteration)
    call file%put('at_stray', record%at_stray)
  end subroutine save_goal_error

  !> Reads the errors of a result.
  subroutine load_goal_error(record, file)
    type(goal_error), intent(inout) :: record
    class(archive), intent(inout) :: file
    call file%get('at_time', record%at_time)
    call file%get('time', record%time)
    call file%get('history', record%history)
    call file%get('mesh', record%mesh)
    call file%get('at_dual', record%at_dual)
    call file%get('joints', record%joints)
    call file%get('iteration', record%iteration)
    call file%get('at_stray', record%at_stray)
  end subroutine load_goal_error

  !> Writes the maxima of one joint.
  subroutine save_joint_record(record, file)
    type(joint_record), intent(in) :: record
    class(archive), intent(inout) :: file
    real(rk), allocatable :: largest_now(:)
    largest_now = record%largest_now
    call save_extremes('opening', record%opening, file)
    call save_extremes('slip', record%slip, file)
    call save_extremes('pressure', record%pressure, file)
    call file%put('penetration', record%penetration)
    call file%put('largest_now', largest_now)
    call save_extremes('water', record%water, file)
  end subroutine save_joint_record

  !> Reads the maxima of one joint.
  subroutine load_joint_record(record, file)
    type(joint_record), intent(inout) :: record
    class(archive), intent(inout) :: file
    real(rk), allocatable :: largest_now(:)
    call load_extremes('opening', record%opening, file)
    call load_extremes('slip', record%slip, file)
    call load_extremes('pressure', record%pressure, file)
    call file%get('penetration', record%penetration)
    call file%get('largest_now', largest_now)
    if (allocated(largest_now)) record%largest_now = largest_now
    call load_extremes('water', record%water, file)
  end subroutine load_joint_record

  !> Writes the damage of solids.
  subroutine save_damage_record(record, file)
    type(damage_record), intent(in) :: record
    class(archive), intent(inout) :: file
    real(rk), allocatable :: volume(:)
    integer, allocatable :: elements(:)
    volume = record%volume
    elements = record%elements
    call save_damage_extreme('tension', record%tension, file)
    call save_damage_extreme('compression', record%compression, file)
    call file%put('volume', volume)
    call file%put('elements', elements)
    call file%put('inelastic_volume', record%inelastic_volume)
    call file%put('inelastic_elements', record%inelastic_elements)
    call file%put('cracking', record%cracking)
    call file%put('crushing', record%crushing)
    call file%put('created', record%created)
  end subroutine save_damage_record

  !> Reads the damage of solids.
  subroutine load_damage_record(record, file)
    type(damage_record), intent(inout) :: record
    class(archive), intent(inout) :: file
    real(rk), allocatable :: volume(:)
    integer, allocatable :: elements(:)
    volume = record%volume
    elements = record%elements
    call load_damage_extreme('tension', record%tension, file)
    call load_damage_extreme('compression', record%compression, file)
    call file%get('volume', volume)
    call file%get('elements', elements)
    call file%get('inelastic_volume', record%inelastic_volume)
    call file%get('inelastic_elements', record%inelastic_elements)
    call file%get('cracking', record%cracking)
    call file%get('crushing', record%crushing)
    call file%get('created', record%created)
    if (file%has_failed()) return
    record%volume = volume
    record%elements = elements
  end subroutine load_damage_record

  !> Writes the largest damage and its point.
  subroutine save_damage_extreme(name, largest, file)
    character(*), intent(in) :: name
    type(damage_extreme), intent(in) :: largest
    class(archive), intent(inout) :: file
    real(rk), allocatable :: x(:)
    x = largest%at%x
    call file%open_group(name)
    call file%put('is_found', largest%at%is_found)
    call file%put('value', largest%at%value)
    call file%put('time', largest%at%time)
    call file%put('x', x)
    call file%put('element', largest%element)
    call file%put('point', largest%point)
    call file%close_group()
  end subroutine save_damage_extreme

  !> Reads the largest damage and its point.
  subroutine load_damage_extreme(name, largest, file)
    character(*), intent(in) :: name
    type(damage_extreme), intent(inout) :: largest
    class(archive), intent(inout) :: file
    real(rk), allocatable :: x(:)
    x = largest%at%x
    call file%open_group(name)
    call file%get('is_found', largest%at%is_found)
    call file%get('value', largest%at%value)
    call file%get('time', largest%at%time)
    call file%get('x', x)
    call file%get('element', largest%element)
    call file%get('point', largest%point)
    call file%close_group()
    if (.not. file%has_failed()) largest%at%x = x
  end subroutine load_damage_extreme

  !> Writes one envelope.
  subroutine save_envelope(item, file)
    type(envelope), intent(in) :: item
    class(archive), intent(inout) :: file
    call file%put('name', item%name)
    call file%put('row', item%row)
    call file%put('wants_smallest', item%wants_smallest)
    call file%put('is_empty', item%is_empty)
    call file%put('value', item%value)
    call file%put('time', item%time)
    call file%put('mean', item%mean)
    call save_extremes('largest', item%largest, file)
    call file%put('error', item%error)
    call file%put('found_at', item%found_at)
    call file%put('cause', item%cause)
  end subroutine save_envelope

  !> Reads one envelope.
  subroutine load_envelope(item, file)
    type(envelope), intent(inout) :: item
    class(archive), intent(inout) :: file
    character(:), allocatable :: name
    call file%get('name', name)
    if (allocated(name)) item%name = name
    call file%get('row', item%row)
    call file%get('wants_smallest', item%wants_smallest)
    call file%get('is_empty', item%is_empty)
    call file%get('value', item%value)
    call file%get('time', item%time)
    call file%get('mean', item%mean)
    call load_extremes('largest', item%largest, file)
    call file%get('error', item%error)
    call file%get('found_at', item%found_at)
    call file%get('cause', item%cause)
  end subroutine load_envelope

  !> Writes the extremes anywhere, upstream and downstream.
  subroutine save_extremes(name, record, file)
    character(*), intent(in) :: name
    type(extremes_by_face), intent(in) :: record
    class(archive), intent(inout) :: file
    logical, allocatable :: is_found(:)
    real(rk), allocatable :: value(:), time(:), x(:, :)
    integer :: i
    is_found = record%at%is_found
    value = record%at%value
    time = record%at%time
    x = reshape([(record%at(i)%x, i=1, size(record%at))], [3, size(record%at)])
    call file%open_group(name)
    call file%put('is_found', is_found)
    call file%put('value', value)
    call file%put('time', time)
    call file%put('x', x)
    call file%close_group()
  end subroutine save_extremes

  !> Reads the extremes anywhere, upstream and downstream.
  subroutine load_extremes(name, record, file)
    character(*), intent(in) :: name
    type(extremes_by_face), intent(inout) :: record
    class(archive), intent(inout) :: file
    logical, allocatable :: is_found(:)
    real(rk), allocatable :: value(:), time(:), x(:, :)
    integer :: i, n(1)
    n = size(record%at)
    call file%open_group(name)
    call file%get('is_found', is_found, n)
    call file%get('value', value, n)
    call file%get('time', time, n)
    call file%get('x', x, [3, n])
    call file%close_group()
    if (file%has_failed()) return
    record%at%is_found = is_found
    record%at%value = value
    record%at%time = time
    do i = 1, size(record%at)
      record%at(i)%x = x(:, i)
    end do
  end subroutine load_extremes

  !> Writes a list of texts.
  subroutine save_texts(name, list, file)
    character(*), intent(in) :: name
    type(text_item), intent(in) :: list(:)
    class(archive), intent(inout) :: file
    integer :: i
    call file%open_group(name)
    call file%put('count', size(list))
    do i = 1, size(list)
      call file%put('text_'//as_text(i), list(i)%text)
    end do
    call file%close_group()
  end subroutine save_texts

  !> Reads a list of texts.
  subroutine load_texts(name, list, file)
    character(*), intent(in) :: name
    type(text_item), allocatable, intent(inout) :: list(:)
    class(archive), intent(inout) :: file
    integer :: i, num_texts
    num_texts = 0
    call file%open_group(name)
    call file%get('count', num_texts)
    if (allocated(list)) deallocate (list)
    allocate (list(num_texts))
    do i = 1, num_texts
      call file%get('text_'//as_text(i), list(i)%text)
    end do
    call file%close_group()
  end subroutine load_texts
end module record_archive
