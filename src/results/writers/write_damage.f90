!> job_damage.csv: the damage in every increment, for models with damage.
module write_damage
  use errors, only: error_type
  use problem_definition, only: problem
  use analysis_state, only: state
  use damage_readings, only: damage_columns, damage_row
  use run_records, only: run_record
  use result_writer, only: writer, is_due
  use archive_type, only: archive
  use csv_files, only: csv_file
  use file_identity, only: add_path, file_path
  use file_system, only: file_name
  implicit none
  private
  public :: damage_file

  type, extends(writer) :: damage_file
    private
    type(csv_file) :: file
  contains
    procedure :: open => open_damage
    procedure :: go_on => go_on_with_damage
    procedure :: list_paths => list_damage
    procedure :: save_position => save_damage
    procedure :: load_position => load_damage
    procedure :: write_increment => write_row
    procedure :: finish => close_damage
  end type damage_file

  character(*), parameter :: header = 'step,increment,time,'//damage_columns

contains

  !> Starts the file.
  subroutine open_damage(self, model, stem, record, error)
    class(damage_file), intent(inout) :: self
    type(problem), intent(in) :: model
    character(*), intent(in) :: stem
    type(run_record), intent(inout) :: record
    type(error_type), allocatable, intent(out) :: error
    self%is_idle = .not. record%damage%is_present
    if (self%is_idle) return
    call record%list_file(file_name(stem)//'_damage.csv')
    call self%file%open(stem//'_damage.csv', header, error)
  end subroutine open_damage

  !> Goes on with the file.
  subroutine go_on_with_damage(self, model, stem, record, error)
    class(damage_file), intent(inout) :: self
    type(problem), intent(in) :: model
    character(*), intent(in) :: stem
    type(run_record), intent(inout) :: record
    type(error_type), allocatable, intent(out) :: error
    self%is_idle = .not. record%damage%is_present
    if (self%is_idle) return
    call self%file%go_on(stem//'_damage.csv', header, error)
  end subroutine go_on_with_damage

  !> The path of the file.
  subroutine list_damage(self, model, stem, record, paths)
    class(damage_file), intent(inout) :: self
    type(problem), intent(in) :: model
    character(*), intent(in) :: stem
    type(run_record), intent(inout) :: record
    type(file_path), allocatable, intent(inout) :: paths(:)
    call add_path(paths, stem//'_damage.csv')
  end subroutine list_damage

  !> Stores the length of the file.
  subroutine save_damage(self, file, error)
    class(damage_file), intent(inout) :: self
    class(archive), intent(inout) :: file
    type(error_type), allocatable, intent(out) :: error
    call self%file%save_position('num_bytes', file)
  end subroutine save_damage

  !> Reads the length of the file.
  subroutine load_damage(self, file)
    class(damage_file), intent(inout) :: self
    class(archive), intent(inout) :: file
    call self%file%load_position('num_bytes', file)
  end subroutine load_damage

  !> Writes one row.
  subroutine write_row(self, model, now, record, error)
    class(damage_file), intent(inout) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(run_record), intent(inout) :: record
    type(error_type), allocatable, intent(out) :: error
    if (self%is_idle .or. .not. is_due(now, 1)) return
    call self%file%add_row(now%step, now%increment, [now%total_time, damage_row(record%damage)])
    call self%file%save(error)
  end subroutine write_row

  !> Closes the file.
  subroutine close_damage(self, error)
    class(damage_file), intent(inout) :: self
    type(error_type), allocatable, intent(out) :: error
    if (.not. self%is_idle) call self%file%close(error)
  end subroutine close_damage
end module write_damage
