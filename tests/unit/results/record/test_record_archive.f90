!> The record of a run through an archive and back.
program test_record_archive
  use kinds, only: rk
  use errors, only: error_type
  use problem_definition, only: problem
  use hdf5_archive, only: hdf5_store
  use joint_contraction, only: contraction_law
  use extremes, only: extremes_by_face
  use damage_readings, only: damage_extreme
  use run_records, only: run_record
  use record_archive, only: save_record, load_record
  use row_model, only: make_row, put_at_wall, new_step
  use same_values, only: compare
  use testing, only: test_log, check, check_text
  implicit none

  character(*), parameter :: path = 'test_record_archive.h5'
  type(test_log) :: log

  log%suite = 'record_archive'
  call record_comes_back(log)
  call other_model_fails(log)
  call delete_file()
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> A row of boxes with `num_joints` joints at its wall; its step asks for two envelopes.
  subroutine make_model(num_joints, model)
    integer, intent(in) :: num_joints
    type(problem), intent(out) :: model
    integer :: i
    call make_row([0.0_rk, 1.0_rk, 2.0_rk], 1.0_rk, 1.0_rk, [1.0e9_rk, 1.0e9_rk], &
                  [2400.0_rk, 2400.0_rk], model)
    do i = 1, num_joints
      call put_at_wall(contraction_law(normal_stiffness=1.0e9_rk, tangent_stiffness=1.0e9_rk, &
                                       friction=0.5_rk), model)
    end do
    call new_step('STATIC', 1.0_rk, 1.0_rk, model)
    model%steps(1)%envelope = [character(8) :: 'U', 'OPENING']
    allocate (model%inelastic(0))
  end subroutine make_model

  !> A record with values of its own in all components that change in time.
  subroutine make_record(model, record)
    type(problem), intent(in) :: model
    type(run_record), intent(out) :: record
    integer :: i
    call record%open(model)
    call record%begin_step(model, 1)
    call record%warn_once('a warning')
    call record%warn_once('another one ')
    call record%list_file('a_file.csv')
    record%most_taken = 1.1_rk
    record%last_strain = 2.2_rk
    record%last_fracture = 3.3_rk
    record%space%stress = 4.4_rk
    record%space%error = 5.5_rk
    record%space%time = 6.6_rk
    record%space%sampled = 7.7_rk
    record%space%elastic = 0.77_rk
    record%goals(2)%at_time = 7.9_rk
    record%goals(2)%time = 8.8_rk
    record%goals(2)%history = 9.9_rk
    record%goals(2)%mesh = 10.1_rk
    record%goals(2)%at_dual = 11.1_rk
    record%goals(2)%joints = 12.1_rk
    record%goals(2)%iteration = 13.1_rk
    record%goals(2)%at_stray = 14.1_rk
    do i = 1, size(record%joints)
      associate (joint => record%joints(i))
        call fill_extremes(10.0_rk*i, joint%opening)
        call fill_extremes(10.0_rk*i + 1.0_rk, joint%slip)
        call fill_extremes(10.0_rk*i + 2.0_rk, joint%pressure)
        call fill_extremes(10.0_rk*i + 3.0_rk, joint%water)
        joint%penetration = 10.0_rk*i + 4.0_rk
        joint%largest_now = 10.0_rk*i + [5.0_rk, 6.0_rk, 7.0_rk]
      end associate
    end do
    call fill_extremes(80.0_rk, record%displacement)
    associate (damage => record%damage)
      call fill_damage(50.1_rk, damage%tension)
      call fill_damage(60.1_rk, damage%compression)
      damage%volume = [1.5_rk, 2.5_rk, 3.5_rk]
      damage%elements = [7, 8, 9]
      damage%inelastic_volume = 4.5_rk
      damage%inelastic_elements = 10
      damage%cracking = 5.5_rk
      damage%crushing = 6.5_rk
      damage%created = 7.5_rk
    end associate
    record%envelopes(1)%wants_smallest = .true.
    record%envelopes(2)%is_empty = .false.
    record%envelopes(2)%mean = [0.5_rk, 0.75_rk]
    do i = 1, size(record%envelopes)
      record%envelopes(i)%value = record%envelopes(i)%value + 0.1_rk*i
      record%envelopes(i)%time = record%envelopes(i)%time + 0.2_rk*i
      call fill_extremes(70.0_rk + i, record%envelopes(i)%largest)
      record%envelopes(i)%error = 79.0_rk + i
      record%envelopes(i)%found_at = 89.0_rk + i
      record%envelopes(i)%cause = 1 + i
    end do
  end subroutine make_record

  !> Extremes upstream and downstream.
  subroutine fill_extremes(value, found)
    real(rk), intent(in) :: value
    type(extremes_by_face), intent(inout) :: found
    integer :: i
    found%at(2:)%is_found = .true.
    do i = 2, 3
      found%at(i)%value = value + 0.1_rk*i
      found%at(i)%time = value + 0.01_rk*i
      found%at(i)%x = value + [1.0_rk, 2.0_rk, 3.0_rk]*i
    end do
  end subroutine fill_extremes

  !> The largest damage.
  subroutine fill_damage(value, found)
    real(rk), intent(in) :: value
    type(damage_extreme), intent(inout) :: found
    found%at%is_found = .true.
    found%at%value = value
    found%at%time = value + 1.0_rk
    found%at%x = value + [2.0_rk, 3.0_rk, 4.0_rk]
    found%element = nint(value)
    found%point = 5
  end subroutine fill_damage

  !> Everything that changes in time.
  subroutine compare_records(log, a, b)
    type(test_log), intent(inout) :: log
    type(run_record), intent(in) :: a, b
    integer :: i, k
    call compare(log, 'step', a%step, b%step)
    call compare(log, 'active', a%active, b%active)
    call compare(log, 'most_taken', a%most_taken, b%most_taken)
    call compare(log, 'last_strain', a%last_strain, b%last_strain)
    call compare(log, 'last_fracture', a%last_fracture, b%last_fracture)
    call compare_extremes(log, 'displacement', a%displacement, b%displacement)
    call compare(log, 'space stress', a%space%stress, b%space%stress)
    call compare(log, 'space error', a%space%error, b%space%error)
    call compare(log, 'space time', a%space%time, b%space%time)
    call compare(log, 'space sampled', a%space%sampled, b%space%sampled)
    call compare(log, 'space elastic', a%space%elastic, b%space%elastic)
    call compare(log, 'goal at_time', a%goals(2)%at_time, b%goals(2)%at_time)
    call compare(log, 'goal time', a%goals(2)%time, b%goals(2)%time)
    call compare(log, 'goal history', a%goals(2)%history, b%goals(2)%history)
    call compare(log, 'goal mesh', a%goals(2)%mesh, b%goals(2)%mesh)
    call compare(log, 'goal at_dual', a%goals(2)%at_dual, b%goals(2)%at_dual)
    call compare(log, 'goal joints', a%goals(2)%joints, b%goals(2)%joints)
    call compare(log, 'goal iteration', a%goals(2)%iteration, b%goals(2)%iteration)
    call compare(log, 'goal at_stray', a%goals(2)%at_stray, b%goals(2)%at_stray)
    do i = 1, size(a%joints)
      call compare_extremes(log, 'opening', a%joints(i)%opening, b%joints(i)%opening)
      call compare_extremes(log, 'slip', a%joints(i)%slip, b%joints(i)%slip)
      call compare_extremes(log, 'pressure', a%joints(i)%pressure, b%joints(i)%pressure)
      call compare_extremes(log, 'water', a%joints(i)%water, b%joints(i)%water)
      call compare(log, 'penetration', a%joints(i)%penetration, b%joints(i)%penetration)
      do k = 1, 3
        call compare(log, 'largest_now', a%joints(i)%largest_now(k), b%joints(i)%largest_now(k))
      end do
    end do
    call compare_damage(log, 'tension', a%damage%tension, b%damage%tension)
    call compare_damage(log, 'compression', a%damage%compression, b%damage%compression)
    do i = 1, 3
      call compare(log, 'volume', a%damage%volume(i), b%damage%volume(i))
      call compare(log, 'elements', a%damage%elements(i), b%damage%elements(i))
    end do
    call compare(log, 'inelastic_volume', a%damage%inelastic_volume, b%damage%inelastic_volume)
    call compare(log, 'inelastic_elements', a%damage%inelastic_elements, &
                 b%damage%inelastic_elements)
    call compare(log, 'cracking', a%damage%cracking, b%damage%cracking)
    call compare(log, 'crushing', a%damage%crushing, b%damage%crushing)
    call compare(log, 'created', a%damage%created, b%damage%created)
    call compare_lists(log, a, b)
  end subroutine compare_records

  !> Envelopes, warnings, files.
  subroutine compare_lists(log, a, b)
    type(test_log), intent(inout) :: log
    type(run_record), intent(in) :: a, b
    integer :: i
    call compare(log, 'number of envelopes', size(a%envelopes), size(b%envelopes))
    do i = 1, min(size(a%envelopes), size(b%envelopes))
      associate (x => a%envelopes(i), y => b%envelopes(i))
        call check_text(log, y%name, x%name, 'name')
        call compare(log, 'wants_smallest', x%wants_smallest, y%wants_smallest)
        call compare(log, 'row', x%row, y%row)
        call compare(log, 'is_empty', x%is_empty, y%is_empty)
        call compare(log, 'value', x%value, y%value)
        call compare(log, 'time', x%time, y%time)
        call compare(log, 'mean', x%mean, y%mean)
        call compare_extremes(log, 'largest', x%largest, y%largest)
        call compare(log, 'error', x%error, y%error)
        call compare(log, 'found_at', x%found_at, y%found_at)
        call compare(log, 'cause', x%cause, y%cause)
      end associate
    end do
    call compare(log, 'number of warnings', size(a%warnings), size(b%warnings))
    do i = 1, min(size(a%warnings), size(b%warnings))
      call check_text(log, b%warnings(i)%text, a%warnings(i)%text, 'warnings')
      call compare(log, 'length of a warning', len(b%warnings(i)%text), len(a%warnings(i)%text))
    end do
    call compare(log, 'number of files', size(a%files), size(b%files))
    do i = 1, min(size(a%files), size(b%files))
      call check_text(log, b%files(i)%text, a%files(i)%text, 'files')
    end do
  end subroutine compare_lists

  !> Extremes of all faces.
  subroutine compare_extremes(log, what, a, b)
    type(test_log), intent(inout) :: log
    character(*), intent(in) :: what
    type(extremes_by_face), intent(in) :: a, b
    integer :: i, k
    do i = 1, 3
      call compare(log, what//' is_found', a%at(i)%is_found, b%at(i)%is_found)
      call compare(log, what//' value', a%at(i)%value, b%at(i)%value)
      call compare(log, what//' time', a%at(i)%time, b%at(i)%time)
      do k = 1, 3
        call compare(log, what//' x', a%at(i)%x(k), b%at(i)%x(k))
      end do
    end do
  end subroutine compare_extremes

  !> The largest damage and its point.
  subroutine compare_damage(log, what, a, b)
    type(test_log), intent(inout) :: log
    character(*), intent(in) :: what
    type(damage_extreme), intent(in) :: a, b
    integer :: k
    call compare(log, what//' is_found', a%at%is_found, b%at%is_found)
    call compare(log, what//' value', a%at%value, b%at%value)
    call compare(log, what//' time', a%at%time, b%at%time)
    do k = 1, 3
      call compare(log, what//' x', a%at%x(k), b%at%x(k))
    end do
    call compare(log, what//' element', a%element, b%element)
    call compare(log, what//' point', a%point, b%point)
  end subroutine compare_damage

  !> Saves a record and loads it into one that was opened for the model.
  subroutine pass_through(record, other, log, error)
    type(run_record), intent(in) :: record
    type(run_record), intent(inout) :: other
    type(test_log), intent(inout) :: log
    type(error_type), allocatable, intent(out) :: error
    type(error_type), allocatable :: failure
    type(hdf5_store) :: file
    call file%create(path)
    call save_record(record, file, error)
    call check(log,.not. allocated(error), 'the record is saved')
    call file%close(error)
    call check(log,.not. allocated(error), 'the file is complete')
    call file%open(path)
    call load_record(other, file, error)
    call file%close(failure)
  end subroutine pass_through

  !> All components come back.
  subroutine record_comes_back(log)
    type(test_log), intent(inout) :: log
    type(problem) :: model
    type(run_record) :: record, other
    type(error_type), allocatable :: error
    call make_model(2, model)
    call make_record(model, record)
    call other%open(model)
    call pass_through(record, other, log, error)
    call check(log,.not. allocated(error), 'the record is loaded')
    if (.not. allocated(error)) call compare_records(log, record, other)
  end subroutine record_comes_back

  !> A model with another number of joints.
  subroutine other_model_fails(log)
    type(test_log), intent(inout) :: log
    type(problem) :: model, changed
    type(run_record) :: record, other
    type(error_type), allocatable :: error
    call make_model(2, model)
    call make_record(model, record)
    call make_model(1, changed)
    call other%open(changed)
    call pass_through(record, other, log, error)
    call check(log, allocated(error), 'a model with other joints is an error')
    if (.not. allocated(error)) return
    call check_text(log, error%message, "'test_record_archive.h5': /record/num_joints is 2, "// &
                    'but 1 in this model: the archive belongs to another model', 'other joints')
  end subroutine other_model_fails

  !> Takes the file of the test away.
  subroutine delete_file()
    integer :: unit
    open (newunit=unit, file=path, status='old')
    close (unit, status='delete')
  end subroutine delete_file
end program test_record_archive
