!> The joints as a VTK series of surfaces: job_vtk/job_joints_NNNN.vtu with job_joints.pvd.
module write_joint_vtk
  use kinds, only: rk
  use errors, only: error_type
  use problem_definition, only: problem
  use analysis_state, only: state
  use run_records, only: run_record
  use result_writer, only: writer
  use requested_fields, only: list_due_fields
  use joint_surface, only: drawn_joints, find_drawn_joints, values_on_corners, &
                           states_on_corners, nodes_to_corners, num_values
  use vtk_order, only: cell_of_polygon
  use vtu_files, only: vtu_file
  use pvd_files, only: pvd_file, frame_name
  use file_system, only: make_folder
  implicit none
  private
  public :: joint_series, open_joint_vtk

  type, extends(writer) :: joint_series
    private
    character(:), allocatable :: folder !< '.../job_vtk/'
    character(:), allocatable :: stem !< 'job_joints'
    logical :: is_ready = .false. !< the folder and the cells are there
    integer :: num_frames = 0 !< of the solids' series, whose numbers the files share
    type(drawn_joints) :: drawn
    type(pvd_file) :: frames
  contains
    procedure :: write_increment => write_frame
    procedure, private :: prepare
    procedure, private :: fill
  end type joint_series

contains

  !> Nothing is written before something is due. `results` is the folder with a slash at its end.
  subroutine open_joint_vtk(results, job, series)
    character(*), intent(in) :: results, job
    type(joint_series), intent(out) :: series
    series%folder = results//job//'_vtk/'
    series%stem = job//'_joints'
    call series%frames%open(results//series%stem//'.pvd', job//'_vtk/')
  end subroutine open_joint_vtk

  !> One file of the series, when OPENING is due.
  subroutine write_frame(self, scene, now, record, error)
    class(joint_series), intent(inout) :: self
    type(problem), intent(in) :: scene
    type(state), intent(in) :: now
    type(run_record), intent(inout) :: record
    type(error_type), allocatable, intent(out) :: error
    character(8), allocatable :: fields(:)
    type(vtu_file) :: file
    call list_due_fields(scene, now, record, fields)
    if (size(fields) == 0) return
    self%num_frames = self%num_frames + 1
    if (.not. any(fields == 'OPENING')) return
    call self%prepare(scene, error)
    if (allocated(error) .or. self%drawn%num_cells == 0) return
    call self%fill(scene, now, file)
    call file%save(self%folder//frame_name(self%stem, self%num_frames), error)
    if (allocated(error)) return
    call self%frames%add(now%total_time, frame_name(self%stem, self%num_frames), error)
    call record%list_file(self%stem//'.pvd')
  end subroutine write_frame

  !> Makes the folder and finds the cells, once.
  subroutine prepare(self, scene, error)
    class(joint_series), intent(inout) :: self
    type(problem), intent(in) :: scene
    type(error_type), allocatable, intent(out) :: error
    if (self%is_ready) return
    call make_folder(self%folder(:len(self%folder) - 1), error)
    if (allocated(error)) return
    call find_drawn_joints(scene, self%drawn)
    self%is_ready = .true.
  end subroutine prepare

  !> Polygons and fields.
  subroutine fill(self, scene, now, file)
    class(joint_series), intent(in) :: self
    type(problem), intent(in) :: scene
    type(state), intent(in) :: now
    type(vtu_file), intent(inout) :: file
    real(rk) :: values(num_values, self%drawn%num_corners)
    associate (drawn => self%drawn, ends => self%drawn%first(2:) - 1)
      call file%start(nodes_to_corners(drawn, scene%mesh%x), drawn%corner - 1, ends, &
                      cell_of_polygon(drawn%first(2:) - drawn%first(:drawn%num_cells)))
      call values_on_corners(scene, now, drawn, values)
      call file%put_point_integers('NODE_ID', node_numbers(scene, drawn))
      call file%put_point_reals('U', nodes_to_corners(drawn, now%u), 'U1,U2,U3')
      call file%put_point_reals('OPENING', values(1:1, :), '')
      call file%put_point_reals('SLIP', values(2:3, :), 'SLIP1,SLIP2')
      call file%put_point_reals('TRACTION', values(4:6, :), 'TN,T1,T2')
      call file%put_point_integers('STATE', states_on_corners(now, drawn))
      call file%put_point_reals('REACH_USED', values(7:7, :), '')
      if (any_water(now)) call file%put_point_reals('WATER', values(8:8, :), '')
      call file%put_cell_integers('JOINT', drawn%joint)
      call file%put_cell_integers('ELEMENT_ID', scene%mesh%element_id(drawn%element))
    end associate
  end subroutine fill

  !> Is there water in a joint?
  pure logical function any_water(now)
    type(state), intent(in) :: now
    integer :: j
    any_water = .false.
    do j = 1, size(now%joints)
      any_water = any_water .or. allocated(now%joints(j)%water)
    end do
  end function any_water

  !> The deck's number of the slave node that a corner lies on; 0 between nodes.
  pure function node_numbers(scene, drawn) result(number)
    type(problem), intent(in) :: scene
    type(drawn_joints), intent(in) :: drawn
    integer :: number(drawn%num_corners)
    integer :: c
    do c = 1, drawn%num_corners
      number(c) = 0
      if (drawn%first_node(c + 1) - drawn%first_node(c) /= 1) cycle
      number(c) = scene%mesh%node_id(drawn%node(drawn%first_node(c)))
    end do
  end function node_numbers
end module write_joint_vtk
