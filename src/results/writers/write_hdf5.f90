!> job.h5: the model, requested fields, histories, modes and envelopes (layout: docs/results.md).
module write_hdf5
  use kinds, only: rk
  use errors, only: error_type, raise, raise_unwritten, system_failed
  use run_ledger, only: ledger
  use timer, only: wall_clock
  use build_info, only: program_version
  use node_dofs, only: num_directions
  use problem_definition, only: problem
  use analysis_state, only: state, vibration_mode
  use run_records, only: run_record
  use damage_readings, only: damage_columns, damage_row
  use energy_readings, only: energy_columns, energy_row
  use joint_readings, only: reading_names
  use result_writer, only: writer, is_due
  use requested_fields, only: list_due_fields, asks_for_joints
  use envelopes, only: name_of_field
  use archive_type, only: archive
  use file_identity, only: add_path, file_path
  use hdf5_files, only: hdf5_file
  use hdf5_tables, only: growing_table
  use hdf5_ledger, only: write_ledger
  use hdf5_model, only: renew_model, write_model
  use hdf5_fields, only: put_field, put_joints
  use hdf5_points, only: write_points, add_points
  use file_system, only: link_name, file_name
  use whole_files, only: remove_file
  implicit none
  private
  public :: hdf5_results

  integer, parameter :: layout_version = 1
  character(*), parameter :: increment_columns = 'step,increment,time,size,iterations,residual'
  real(rk), parameter :: seconds_between_flushes = 2.0_rk

  type, extends(writer) :: hdf5_results
    private
    type(hdf5_file) :: file
    character(:), allocatable :: path
    integer :: step = 0 !< the last step with a group
    real(rk) :: flushed_at = 0.0_rk !< wall clock [s]
    type(growing_table) :: increments, energies, damages
    type(growing_table), allocatable :: joints(:)
    integer :: num_rows = 0 !< of each table at the checkpoint
  contains
    procedure :: open => open_hdf5
    procedure :: go_on => go_on_with_hdf5
    procedure :: list_paths => list_hdf5
    procedure :: save_position => save_hdf5
    procedure :: load_position => load_hdf5
    procedure :: start_undo
    procedure :: renew => renew_hdf5
    procedure :: write_increment => write_data
    procedure :: write_modes => write_mode_data
    procedure :: write_envelopes => write_envelope_data
    procedure :: write_costs
    procedure :: finish => close_data
    procedure, private :: make_step_group
    procedure, private :: add_history
    procedure, private :: add_fields
    procedure, private :: flush_rows
  end type hdf5_results

contains

  !> Starts the file with the model.
  subroutine open_hdf5(self, model, stem, record, error)
    class(hdf5_results), intent(inout) :: self
    type(problem), intent(in) :: model
    character(*), intent(in) :: stem
    type(run_record), intent(inout) :: record
    type(error_type), allocatable, intent(out) :: error
    integer :: j
    self%path = stem//'.h5'
    call record%list_file(file_name(self%path))
    associate (file => self%file)
      call file%create(self%path)
      call file%set('/', 'program', 'Keyway '//program_version)
      call file%set('/', 'deck', model%deck_file)
      call file%set('/', 'layout', layout_version)
      call write_model(file, model, record)
      call write_points(file, model)
      call file%make_group('/steps')
      call file%make_group('/history')
      call file%make_group('/history/joints')
      call self%increments%start(file, '/history/increments', &
                                 increment_columns)
      call self%energies%start(file, '/history/energy', &
                               'step,increment,time,'//energy_columns(model))
      if (record%damage%is_present) then
        call self%damages%start(file, '/history/damage', 'step,increment,time,'//damage_columns)
      end if
      allocate (self%joints(size(model%joints)))
      do j = 1, size(model%joints)
        call self%joints(j)%start(file, '/history/joints/'//link_name(model%joints(j)%name), &
                                  'step,increment,time,'//reading_names)
      end do
    end associate
    call self%flush_rows(error)
    ! A file that was made and not flushed holds nothing that can be read.
    if (allocated(error) .and. self%file%id > 0) call remove_file(self%path)
  end subroutine open_hdf5

  !> Goes on with the file, which a journal has set back to the checkpoint.
  subroutine go_on_with_hdf5(self, model, stem, record, error)
    class(hdf5_results), intent(inout) :: self
    type(problem), intent(in) :: model
    character(*), intent(in) :: stem
    type(run_record), intent(inout) :: record
    type(error_type), allocatable, intent(out) :: error
    integer :: j
    self%path = stem//'.h5'
    call self%file%open_again(self%path)
    if (self%file%has_failed) then
      call raise(error, "cannot continue '"//self%path//"': the file is missing or damaged", &
                 system_failed)
      return
    end if
    associate (rows => self%num_rows)
      call self%increments%go_on('/history/increments', increment_columns, rows)
      call self%energies%go_on('/history/energy', &
                               'step,increment,time,'//energy_columns(model), rows)
      if (record%damage%is_present) then
        call self%damages%go_on('/history/damage', 'step,increment,time,'//damage_columns, rows)
      end if
      allocate (self%joints(size(model%joints)))
      do j = 1, size(model%joints)
        call self%joints(j)%go_on('/history/joints/'//link_name(model%joints(j)%name), &
                                  'step,increment,time,'//reading_names, rows)
      end do
    end associate
  end subroutine go_on_with_hdf5

  !> The path of the file.
  subroutine list_hdf5(self, model, stem, record, paths)
    class(hdf5_results), intent(inout) :: self
    type(problem), intent(in) :: model
    character(*), intent(in) :: stem
    type(run_record), intent(inout) :: record
    type(file_path), allocatable, intent(inout) :: paths(:)
    call add_path(paths, stem//'.h5')
  end subroutine list_hdf5

  !> Flushes the file and stores what it holds.
  subroutine save_hdf5(self, file, error)
    class(hdf5_results), intent(inout) :: self
    class(archive), intent(inout) :: file
    type(error_type), allocatable, intent(out) :: error
    call self%flush_rows(error)
    call file%put('step', self%step)
    call file%put('num_rows', self%increments%num_rows())
  end subroutine save_hdf5

  !> Reads what the file holds.
  subroutine load_hdf5(self, file)
    class(hdf5_results), intent(inout) :: self
    class(archive), intent(inout) :: file
    call file%get('step', self%step)
    call file%get('num_rows', self%num_rows)
  end subroutine load_hdf5

  !> Starts the journal of a checkpoint.
  subroutine start_undo(self, journal, number, error)
    class(hdf5_results), intent(inout) :: self
    character(*), intent(in) :: journal !< path
    integer, intent(in) :: number !< of the checkpoint
    type(error_type), allocatable, intent(out) :: error
    call self%file%start_undo(journal, number)
    if (self%file%has_failed) call raise_unwritten(error, journal)
  end subroutine start_undo

  !> Writes what has changed in the model.
  subroutine renew_hdf5(self, model, record, error)
    class(hdf5_results), intent(inout) :: self
    type(problem), intent(in) :: model
    type(run_record), intent(in) :: record
    type(error_type), allocatable, intent(out) :: error
    call renew_model(self%file, model, record)
    call self%flush_rows(error)
  end subroutine renew_hdf5

  !> Writes the histories of every increment, and the fields requested now.
  subroutine write_data(self, model, now, record, error)
    class(hdf5_results), intent(inout) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(run_record), intent(inout) :: record
    type(error_type), allocatable, intent(out) :: error
    integer, allocatable :: fields(:)
    logical :: is_flush_due
    call self%make_step_group(model, now%step)
    if (is_due(now, 1)) call self%add_history(model, now, record)
    call list_due_fields(model, now, record, fields)
    if (size(fields) > 0) call self%add_fields(model, now, record, fields)
    is_flush_due = wall_clock() - self%flushed_at > seconds_between_flushes
    if (size(fields) > 0 .or. is_flush_due) call self%flush_rows(error)
  end subroutine write_data

  !> Rows of the histories.
  subroutine add_history(self, model, now, record)
    class(hdf5_results), intent(inout) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(run_record), intent(in) :: record
    real(rk) :: time(3)
    integer :: j
    time = [real(now%step, rk), real(now%increment, rk), now%total_time]
    call self%increments%add(self%file, [time, now%increment_size, real(now%iterations, rk), &
                                         now%residual])
    call self%energies%add(self%file, [time, energy_row(model, now%energy)])
    if (record%damage%is_present) then
      call self%damages%add(self%file, [time, damage_row(record%damage)])
    end if
    do j = 1, size(model%joints)
      call self%joints(j)%add(self%file, [time, record%joints(j)%largest_now])
    end do
  end subroutine add_history

  !> The group of one increment.
  subroutine add_fields(self, model, now, record, fields)
    class(hdf5_results), intent(inout) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(run_record), intent(inout) :: record
    integer, intent(in) :: fields(:) !< rows of the record's table
    character(:), allocatable :: group
    real(rk), allocatable :: values(:, :)
    integer :: i
    group = step_group(now%step)//'/increments/'//padded(now%increment, 6)
    call self%file%make_group(group)
    call self%file%set(group, 'step', now%step)
    call self%file%set(group, 'increment', now%increment)
    call self%file%set(group, 'time', now%total_time)
    call self%file%set(group, 'step_time', now%step_time)
    do i = 1, size(fields)
      associate (item => record%fields(fields(i)))
        call item%on_nodes(model, now, record%stresses, values)
        call put_field(self%file, group//'/'//item%name, values, item%components(size(values, 1)))
      end associate
    end do
    call add_elements(self%file, model, now, record, fields, group)
    call add_points(self%file, model, now, record%fields(fields), group)
    if (asks_for_joints(record, fields)) then
      call put_joints(self%file, model, now, record%fields, group//'/joints')
    end if
  end subroutine add_fields

  !> The group `elements` of an increment: fields with one value for each element.
  subroutine add_elements(file, model, now, record, fields, group)
    type(hdf5_file), intent(inout) :: file
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(run_record), intent(inout) :: record
    integer, intent(in) :: fields(:) !< rows of the record's table
    character(*), intent(in) :: group !< of the increment
    real(rk), allocatable :: values(:)
    logical :: has_group
    integer :: i
    has_group = .false.
    do i = 1, size(fields)
      associate (item => record%fields(fields(i)))
        if (.not. associated(item%of_elements)) cycle
        if (.not. has_group) call file%make_group(group//'/elements')
        has_group = .true.
        call item%of_elements(model, now, record%stresses, values)
        call file%put(group//'/elements/'//item%name, values)
      end associate
    end do
  end subroutine add_elements

  !> Frequencies, effective masses and shapes of a *FREQUENCY step.
  subroutine write_mode_data(self, model, step, modes, record, error)
    class(hdf5_results), intent(inout) :: self
    type(problem), intent(in) :: model
    integer, intent(in) :: step
    type(vibration_mode), intent(in) :: modes(:)
    type(run_record), intent(inout) :: record
    type(error_type), allocatable, intent(out) :: error
    real(rk), allocatable :: mass(:, :), shapes(:, :, :)
    integer :: i
    call self%make_step_group(model, step)
    allocate (mass(num_directions, size(modes)))
    allocate (shapes(num_directions, model%mesh%num_nodes, size(modes)))
    do i = 1, size(modes)
      mass(:, i) = modes(i)%effective_mass
      shapes(:, :, i) = modes(i)%shape
    end do
    associate (group => step_group(step)//'/modes')
      call self%file%make_group(group)
      call self%file%put(group//'/hz', modes%hz)
      call self%file%put(group//'/effective_mass', mass)
      call self%file%put(group//'/shape', shapes)
    end associate
    call self%flush_rows(error)
    call record%list_file(file_name(self%path))
  end subroutine write_mode_data

  !> The envelopes of the step that has ended.
  subroutine write_envelope_data(self, model, record, error)
    class(hdf5_results), intent(inout) :: self
    type(problem), intent(in) :: model
    type(run_record), intent(inout) :: record
    type(error_type), allocatable, intent(out) :: error
    character(:), allocatable :: group
    integer :: i
    if (size(record%active) == 0) return
    if (any(record%envelopes(record%active)%is_empty)) return
    group = step_group(record%step)//'/envelopes'
    call self%file%make_group(group)
    do i = 1, size(record%active)
      associate (item => record%envelopes(record%active(i)))
        call self%file%put(group//'/'//name_of_field(item), item%value)
        call self%file%put(group//'/'//name_of_field(item)//'_TIME', item%time)
        if (allocated(item%mean)) then
          call self%file%put(group//'/'//trim(item%name)//'_MEAN_MAX', item%mean)
        end if
      end associate
    end do
    call self%flush_rows(error)
  end subroutine write_envelope_data

  !> The ledger of the run, at its end.
  subroutine write_costs(self, costs)
    class(hdf5_results), intent(inout) :: self
    type(ledger), intent(in) :: costs
    if (self%file%id /= 0) call write_ledger(self%file, costs)
  end subroutine write_costs

  !> Closes the file.
  subroutine close_data(self, error)
    class(hdf5_results), intent(inout) :: self
    type(error_type), allocatable, intent(out) :: error
    if (self%file%id == 0) return
    call self%flush_rows(error)
    call self%file%close()
  end subroutine close_data

  !> Makes the group of a step unless it exists.
  subroutine make_step_group(self, model, step)
    class(hdf5_results), intent(inout) :: self
    type(problem), intent(in) :: model
    integer, intent(in) :: step
    if (self%step == step) return
    self%step = step
    call self%file%make_group(step_group(step))
    call self%file%set(step_group(step), 'name', model%steps(step)%name)
    call self%file%set(step_group(step), 'procedure', &
                       trim(model%steps(step)%procedure%name))
    call self%file%make_group(step_group(step)//'/increments')
    if (allocated(model%stages%is_absent)) then
      call self%file%put(step_group(step)//'/stage', model%stages%step_of_elements(step))
    end if
  end subroutine make_step_group

  !> Writes all rows and flushes the file.
  subroutine flush_rows(self, error)
    class(hdf5_results), intent(inout) :: self
    type(error_type), allocatable, intent(out) :: error
    integer :: j
    call self%increments%write_rows(self%file)
    call self%energies%write_rows(self%file)
    call self%damages%write_rows(self%file)
    do j = 1, size(self%joints)
      call self%joints(j)%write_rows(self%file)
    end do
    call self%file%flush()
    self%flushed_at = wall_clock()
    if (self%file%has_failed) call raise_unwritten(error, self%path)
  end subroutine flush_rows

  !> '/steps/0001'
  pure function step_group(step) result(path)
    integer, intent(in) :: step
    character(:), allocatable :: path
    path = '/steps/'//padded(step, 4)
  end function step_group

  !> A number with leading zeros.
  pure function padded(number, width) result(digits)
    integer, intent(in) :: number, width
    character(width) :: digits
    character(20) :: format
    write (format, '(a,i0,a,i0,a)') '(i', width, '.', width, ')'
    write (digits, format) number
  end function padded
end module write_hdf5
