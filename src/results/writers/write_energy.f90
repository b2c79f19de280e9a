!> job_energy.csv: the energy balance of every increment.
module write_energy
  use errors, only: error_type
  use problem_definition, only: problem
  use analysis_state, only: state
  use energy_readings, only: energy_columns, energy_row
  use run_records, only: run_record
  use result_writer, only: writer, is_due
  use archive_type, only: archive
  use csv_files, only: csv_file
  use file_identity, only: add_path, file_path
  use file_system, only: file_name
  implicit none
  private
  public :: energy_file

  type, extends(writer) :: energy_file
    private
    type(csv_file) :: file
  contains
    procedure :: open => open_energy
    procedure :: go_on => go_on_with_energy
    procedure :: list_paths => list_energy
    procedure :: save_position => save_energy
    procedure :: load_position => load_energy
    procedure :: write_increment => write_energies
    procedure :: finish => close_energy
  end type energy_file

  character(*), parameter :: header = 'step,increment,time,'

contains

  !> Starts the file.
  subroutine open_energy(self, model, stem, record, error)
    class(energy_file), intent(inout) :: self
    type(problem), intent(in) :: model
    character(*), intent(in) :: stem
    type(run_record), intent(inout) :: record
    type(error_type), allocatable, intent(out) :: error
    call record%list_file(file_name(stem)//'_energy.csv')
    call self%file%open(stem//'_energy.csv', header//energy_columns(model), error)
  end subroutine open_energy

  !> Goes on with the file.
  subroutine go_on_with_energy(self, model, stem, record, error)
    class(energy_file), intent(inout) :: self
    type(problem), intent(in) :: model
    character(*), intent(in) :: stem
    type(run_record), intent(inout) :: record
    type(error_type), allocatable, intent(out) :: error
    call self%file%go_on(stem//'_energy.csv', header//energy_columns(model), error)
  end subroutine go_on_with_energy

  !> The path of the file.
  subroutine list_energy(self, model, stem, record, paths)
    class(energy_file), intent(inout) :: self
    type(problem), intent(in) :: model
    character(*), intent(in) :: stem
    type(run_record), intent(inout) :: record
    type(file_path), allocatable, intent(inout) :: paths(:)
    call add_path(paths, stem//'_energy.csv')
  end subroutine list_energy

  !> Stores the length of the file.
  subroutine save_energy(self, file, error)
    class(energy_file), intent(inout) :: self
    class(archive), intent(inout) :: file
    type(error_type), allocatable, intent(out) :: error
    call self%file%save_position('num_bytes', file)
  end subroutine save_energy

  !> Reads the length of the file.
  subroutine load_energy(self, file)
    class(energy_file), intent(inout) :: self
    class(archive), intent(inout) :: file
    call self%file%load_position('num_bytes', file)
  end subroutine load_energy

  !> Writes one row.
  subroutine write_energies(self, model, now, record, error)
    class(energy_file), intent(inout) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(run_record), intent(inout) :: record
    type(error_type), allocatable, intent(out) :: error
    if (.not. is_due(now, 1)) return
    call self%file%add_row(now%step, now%increment, [now%total_time, &
                                                     energy_row(model, now%energy)])
    call self%file%save(error)
  end subroutine write_energies

  !> Closes the file.
  subroutine close_energy(self, error)
    class(energy_file), intent(inout) :: self
    type(error_type), allocatable, intent(out) :: error
    call self%file%close(error)
  end subroutine close_energy
end module write_energy
