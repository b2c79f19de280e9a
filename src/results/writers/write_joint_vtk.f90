!> The joints as a VTK series of surfaces: job_vtk/job_joints_NNNN.vtu with job_joints.pvd.
module write_joint_vtk
  use kinds, only: rk
  use errors, only: error_type
  use problem_definition, only: problem
  use analysis_state, only: state
  use run_records, only: run_record
  use result_writer, only: writer
  use requested_fields, only: list_due_fields, asks_for_joints
  use field_table, only: find_field
  use field_type, only: result_field
  use joint_surface, only: drawn_joints, joint_values, find_drawn_joints, means_on_corners, &
                           heaviest_on_corners, nodes_to_corners
  use vtk_order, only: cell_of_polygon
  use joint_law, only: absent_points
  use archive_type, only: archive
  use earlier_files, only: missing_files, remove_series
  use file_identity, only: add_path, file_path
  use vtu_files, only: vtu_file
  use pvd_files, only: pvd_file, frame_name
  use file_system, only: file_name, make_folder
  implicit none
  private
  public :: joint_series

  type, extends(writer) :: joint_series
    private
    character(:), allocatable :: folder !< '.../job_vtk/'
    character(:), allocatable :: stem !< 'job_joints'
    logical :: is_ready = .false. !< the folder and the cells exist
    integer :: num_frames = 0 !< of the series of solids; both series have the same numbers
    type(drawn_joints) :: drawn
    type(pvd_file) :: frames
  contains
    procedure :: open => open_joint_vtk
    procedure :: go_on => go_on_with_joint_vtk
    procedure :: note_missing => note_missing_joint_vtk
    procedure :: list_paths => list_joint_vtk
    procedure :: save_position => save_joint_vtk
    procedure :: load_position => load_joint_vtk
    procedure :: write_increment => write_frame
    procedure, private :: prepare
    procedure, private :: fill
  end type joint_series

contains

  !> Sets names; the first frame makes the files.
  subroutine open_joint_vtk(self, model, stem, record, error)
    class(joint_series), intent(inout) :: self
    type(problem), intent(in) :: model
    character(*), intent(in) :: stem
    type(run_record), intent(inout) :: record
    type(error_type), allocatable, intent(out) :: error
    self%is_idle = size(model%joints) == 0
    self%folder = stem//'_vtk/'
    self%stem = file_name(stem)//'_joints'
    call self%frames%open(stem//'_joints.pvd', file_name(stem)//'_vtk/')
  end subroutine open_joint_vtk

  !> Removes what was written after the checkpoint.
  subroutine go_on_with_joint_vtk(self, model, stem, record, error)
    class(joint_series), intent(inout) :: self
    type(problem), intent(in) :: model
    character(*), intent(in) :: stem
    type(run_record), intent(inout) :: record
    type(error_type), allocatable, intent(out) :: error
    call self%open(model, stem, record, error)
    if (self%is_idle) return
    call remove_series(self%folder//self%stem//'_', self%num_frames + 1)
    call self%frames%open_again(error)
  end subroutine go_on_with_joint_vtk

  !> Notes the files of the series that do not exist.
  subroutine note_missing_joint_vtk(self, missing)
    class(joint_series), intent(in) :: self
    type(missing_files), intent(inout) :: missing
    call self%frames%note_missing(self%folder//self%stem//'_', missing)
  end subroutine note_missing_joint_vtk

  !> The list of the series.
  subroutine list_joint_vtk(self, model, stem, record, paths)
    class(joint_series), intent(inout) :: self
    type(problem), intent(in) :: model
    character(*), intent(in) :: stem
    type(run_record), intent(inout) :: record
    type(file_path), allocatable, intent(inout) :: paths(:)
    if (size(model%joints) > 0) call add_path(paths, stem//'_joints.pvd')
  end subroutine list_joint_vtk

  !> Stores the frames so far.
  subroutine save_joint_vtk(self, file, error)
    class(joint_series), intent(inout) :: self
    class(archive), intent(inout) :: file
    type(error_type), allocatable, intent(out) :: error
    call file%put('num_frames', self%num_frames)
    call self%frames%save_position(file)
  end subroutine save_joint_vtk

  !> Reads the frames so far.
  subroutine load_joint_vtk(self, file)
    class(joint_series), intent(inout) :: self
    class(archive), intent(inout) :: file
    call file%get('num_frames', self%num_frames)
    call self%frames%load_position(file)
  end subroutine load_joint_vtk

  !> Writes a file of the series when fields of joints are requested now.
  subroutine write_frame(self, model, now, record, error)
    class(joint_series), intent(inout) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(run_record), intent(inout) :: record
    type(error_type), allocatable, intent(out) :: error
    integer, allocatable :: fields(:)
    type(vtu_file) :: file
    call list_due_fields(model, now, record, fields)
    if (size(fields) == 0) return
    self%num_frames = self%num_frames + 1
    if (.not. asks_for_joints(record, fields)) return
    call self%prepare(model, error)
    if (allocated(error) .or. self%drawn%num_cells == 0) return
    call self%fill(model, now, record, file)
    call file%save(self%folder//frame_name(self%stem, self%num_frames), error)
    if (allocated(error)) return
    call self%frames%add(now%total_time, frame_name(self%stem, self%num_frames), error)
    call record%list_file(self%stem//'.pvd')
  end subroutine write_frame

  !> Makes the folder and the cells, once.
  subroutine prepare(self, model, error)
    class(joint_series), intent(inout) :: self
    type(problem), intent(in) :: model
    type(error_type), allocatable, intent(out) :: error
    if (self%is_ready) return
    call make_folder(self%folder(:len(self%folder) - 1), error)
    if (allocated(error)) return
    call find_drawn_joints(model, self%drawn)
    self%is_ready = .true.
  end subroutine prepare

  !> Polygons and fields.
  subroutine fill(self, model, now, record, file)
    class(joint_series), intent(in) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(run_record), intent(in) :: record
    type(vtu_file), intent(inout) :: file
    integer :: i
    associate (drawn => self%drawn, ends => self%drawn%first(2:) - 1)
      call file%start(nodes_to_corners(drawn, model%mesh%x), drawn%corner - 1, ends, &
                      cell_of_polygon(drawn%first(2:) - drawn%first(:drawn%num_cells)))
      call file%put_point_integers('NODE_ID', node_numbers(model, drawn))
      associate (moved => record%fields(find_field(record%fields, 'U')))
        call file%put_point_reals(moved%name, nodes_to_corners(drawn, now%u), moved%components(3))
      end associate
      do i = 1, size(record%fields)
        if (associated(record%fields(i)%of_joint)) then
          call put_field(file, model, now, drawn, record%fields(i))
        end if
      end do
      call file%put_cell_integers('JOINT', drawn%joint)
      call file%put_cell_integers('ELEMENT_ID', model%mesh%element_id(drawn%element))
    end associate
  end subroutine fill

  !> One field at the corners of all joints; no array where no joint has the field.
  subroutine put_field(file, model, now, drawn, item)
    type(vtu_file), intent(inout) :: file
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(drawn_joints), intent(in) :: drawn
    type(result_field), intent(in) :: item
    type(joint_values) :: of_joints(size(model%joints))
    real(rk), allocatable :: means(:, :)
    logical :: is_there
    integer :: j
    is_there = .false.
    do j = 1, size(model%joints)
      call item%of_joint(model, now, j, of_joints(j)%at)
      is_there = is_there .or. allocated(of_joints(j)%at)
      of_joints(j)%is_absent = absent_points(now%joints(j))
    end do
    if (.not. is_there) return
    if (item%is_integer) then
      call file%put_point_integers(item%name, heaviest_on_corners(drawn, of_joints))
    else
      allocate (means(item%width(model), drawn%num_corners))
      call means_on_corners(drawn, of_joints, means)
      call file%put_point_reals(item%name, means, item%components(size(means, 1)))
    end if
  end subroutine put_field

  !> The number in the deck of the slave node at a corner; 0 between nodes.
  pure function node_numbers(model, drawn) result(number)
    type(problem), intent(in) :: model
    type(drawn_joints), intent(in) :: drawn
    integer :: number(drawn%num_corners)
    integer :: c
    do c = 1, drawn%num_corners
      number(c) = 0
      if (drawn%first_node(c + 1) - drawn%first_node(c) /= 1) cycle
      number(c) = model%mesh%node_id(drawn%node(drawn%first_node(c)))
    end do
  end function node_numbers
end module write_joint_vtk
