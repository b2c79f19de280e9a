!> The VTK series: job_vtk/job_NNNN.vtu with job.pvd, envelopes and modes.
module write_vtk
  use dam_mesh, only: element_is_there
  use kinds, only: rk
  use errors, only: error_type
  use problem_definition, only: problem
  use analysis_state, only: state, vibration_mode
  use element_catalogue, only: is_solid
  use run_records, only: run_record
  use result_writer, only: writer
  use requested_fields, only: list_due_fields
  use field_table, only: find_field
  use law_fields, only: mean_of_elements
  use envelopes, only: name_of_field
  use vtk_order, only: tensor_in_vtk_order, tensor_names_in_vtk_order, cell_of_solid
  use archive_type, only: archive
  use earlier_files, only: missing_files, remove_series
  use file_identity, only: add_path, file_path
  use vtu_files, only: vtu_file
  use whole_files, only: remove_file
  use pvd_files, only: pvd_file, frame_name
  use text_buffers, only: text_of
  use file_system, only: file_name, make_folder
  implicit none
  private
  public :: vtk_series

  type, extends(writer) :: vtk_series
    private
    character(:), allocatable :: folder !< '.../job_vtk/'
    character(:), allocatable :: job
    logical :: has_grid = .false. !< the arrays below and the folder exist
    integer :: stage = 0 !< that the grid is made for
    integer :: num_frames = 0
    integer, allocatable :: connectivity(:), ends(:), kinds(:), elements(:) !< of solids
    type(pvd_file) :: frames
  contains
    procedure :: open => open_vtk
    procedure :: go_on => go_on_with_vtk
    procedure :: note_missing => note_missing_vtk
    procedure :: list_paths => list_vtk
    procedure :: save_position => save_vtk
    procedure :: load_position => load_vtk
    procedure :: write_increment => write_frame
    procedure :: write_modes => write_mode_shapes
    procedure :: write_envelopes
    procedure, private :: prepare
    procedure, private :: start_grid
  end type vtk_series

contains

  !> Sets names; the first frame makes the files.
  subroutine open_vtk(self, model, stem, record, error)
    class(vtk_series), intent(inout) :: self
    type(problem), intent(in) :: model
    character(*), intent(in) :: stem
    type(run_record), intent(inout) :: record
    type(error_type), allocatable, intent(out) :: error
    self%folder = stem//'_vtk/'
    self%job = file_name(stem)
    call self%frames%open(stem//'.pvd', self%job//'_vtk/')
  end subroutine open_vtk

  !> Removes what was written after the checkpoint.
  subroutine go_on_with_vtk(self, model, stem, record, error)
    class(vtk_series), intent(inout) :: self
    type(problem), intent(in) :: model
    character(*), intent(in) :: stem
    type(run_record), intent(inout) :: record
    type(error_type), allocatable, intent(out) :: error
    integer, parameter :: most_steps = 1000 !< that a deck before its change is taken to have
    integer :: s
    call self%open(model, stem, record, error)
    call remove_series(self%folder//self%job//'_', self%num_frames + 1)
    do s = max(1, record%step), max(most_steps, size(model%steps))
      call remove_unlisted(self, '_envelope_step'//text_of(s)//'.vtu', record)
      call remove_unlisted(self, '_modes_step'//text_of(s)//'.vtu', record)
    end do
    call self%frames%open_again(error)
  end subroutine go_on_with_vtk

  !> Notes the files of the series that do not exist.
  subroutine note_missing_vtk(self, missing)
    class(vtk_series), intent(in) :: self
    type(missing_files), intent(inout) :: missing
    call self%frames%note_missing(self%folder//self%job//'_', missing)
  end subroutine note_missing_vtk

  !> Removes a file outside the series unless the checkpoint lists it.
  subroutine remove_unlisted(self, ending, record)
    class(vtk_series), intent(in) :: self
    character(*), intent(in) :: ending !< of the name
    type(run_record), intent(in) :: record
    integer :: i
    do i = 1, size(record%files)
      if (record%files(i)%text == self%job//'_vtk/'//self%job//ending) return
    end do
    call remove_file(self%folder//self%job//ending)
  end subroutine remove_unlisted

  !> The list of the series; its folder holds nothing but results.
  subroutine list_vtk(self, model, stem, record, paths)
    class(vtk_series), intent(inout) :: self
    type(problem), intent(in) :: model
    character(*), intent(in) :: stem
    type(run_record), intent(inout) :: record
    type(file_path), allocatable, intent(inout) :: paths(:)
    call add_path(paths, stem//'.pvd')
  end subroutine list_vtk

  !> Stores the frames so far.
  subroutine save_vtk(self, file, error)
    class(vtk_series), intent(inout) :: self
    class(archive), intent(inout) :: file
    type(error_type), allocatable, intent(out) :: error
    call file%put('num_frames', self%num_frames)
    call self%frames%save_position(file)
  end subroutine save_vtk

  !> Reads the frames so far.
  subroutine load_vtk(self, file)
    class(vtk_series), intent(inout) :: self
    class(archive), intent(inout) :: file
    call file%get('num_frames', self%num_frames)
    call self%frames%load_position(file)
  end subroutine load_vtk

  !> Writes a file of the series when a field is requested now.
  subroutine write_frame(self, model, now, record, error)
    class(vtk_series), intent(inout) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(run_record), intent(inout) :: record
    type(error_type), allocatable, intent(out) :: error
    integer, allocatable :: fields(:)
    real(rk), allocatable :: mean(:)
    type(vtu_file) :: file
    integer :: i
    call list_due_fields(model, now, record, fields)
    if (size(fields) == 0) return
    call self%prepare(model, error)
    if (allocated(error)) return
    self%num_frames = self%num_frames + 1
    call self%start_grid(model, file)
    do i = 1, size(fields)
      call put_field(file, model, now, record, fields(i))
      associate (item => record%fields(fields(i)))
        if (associated(item%of_elements)) then
          call item%of_elements(model, now, record%stresses, mean)
          call file%put_cell_reals(item%name//'_ELEMENT', mean(self%elements))
        end if
        if (.not. item%has_means) cycle
        call mean_of_elements(model, now, item%name, mean)
        call file%put_cell_reals(item%name//'_MEAN', mean(self%elements))
      end associate
    end do
    call file%save(self%folder//frame_name(self%job, self%num_frames), error)
    if (allocated(error)) return
    call self%frames%add(now%total_time, frame_name(self%job, self%num_frames), error)
    call record%list_file(self%job//'.pvd')
  end subroutine write_frame

  !> One field on the nodes.
  subroutine put_field(file, model, now, record, f)
    type(vtu_file), intent(inout) :: file
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(run_record), intent(inout) :: record
    integer, intent(in) :: f !< row of the record's table
    real(rk), allocatable :: values(:, :)
    associate (item => record%fields(f))
      call item%on_nodes(model, now, record%stresses, values)
      if (item%is_tensor()) then
        call file%put_point_reals(item%name, tensor_in_vtk_order(values), &
                                  tensor_names_in_vtk_order(item%name))
      else
        call file%put_point_reals(item%name, values, item%components(size(values, 1)))
      end if
    end associate
  end subroutine put_field

  !> Writes the envelopes of a step in one file; no file without envelopes.
  subroutine write_envelopes(self, model, record, error)
    class(vtk_series), intent(inout) :: self
    type(problem), intent(in) :: model
    type(run_record), intent(inout) :: record
    type(error_type), allocatable, intent(out) :: error
    type(vtu_file) :: file
    integer :: i
    if (size(record%active) == 0) return
    if (any(record%envelopes(record%active)%is_empty)) return
    call self%prepare(model, error)
    if (allocated(error)) return
    call self%start_grid(model, file)
    do i = 1, size(record%active)
      associate (item => record%envelopes(record%active(i)))
        call file%put_point_reals(name_of_field(item), as_row(item%value), '')
        call file%put_point_reals(name_of_field(item)//'_TIME', as_row(item%time), '')
        if (allocated(item%mean)) then
          call file%put_cell_reals(trim(item%name)//'_MEAN_MAX', item%mean(self%elements))
        end if
      end associate
    end do
    call save_listed(self, file, '_envelope_step'//text_of(record%step)//'.vtu', record, error)
  end subroutine write_envelopes

  !> A list as a table of one row.
  pure function as_row(list) result(row)
    real(rk), intent(in) :: list(:)
    real(rk) :: row(1, size(list))
    row(1, :) = list
  end function as_row

  !> Saves a file outside the series and lists it among the results.
  subroutine save_listed(self, file, ending, record, error)
    class(vtk_series), intent(in) :: self
    type(vtu_file), intent(inout) :: file
    character(*), intent(in) :: ending !< of the name
    type(run_record), intent(inout) :: record
    type(error_type), allocatable, intent(out) :: error
    call file%save(self%folder//self%job//ending, error)
    call record%list_file(self%job//'_vtk/'//self%job//ending)
  end subroutine save_listed

  !> Writes all mode shapes of a *FREQUENCY step in one file.
  subroutine write_mode_shapes(self, model, step, modes, record, error)
    class(vtk_series), intent(inout) :: self
    type(problem), intent(in) :: model
    integer, intent(in) :: step
    type(vibration_mode), intent(in) :: modes(:)
    type(run_record), intent(inout) :: record
    type(error_type), allocatable, intent(out) :: error
    type(vtu_file) :: file
    character(:), allocatable :: names
    character(5) :: number
    integer :: i
    names = record%fields(find_field(record%fields, 'U'))%components(3)
    call self%prepare(model, error)
    if (allocated(error)) return
    call self%start_grid(model, file)
    do i = 1, size(modes)
      write (number, '(i5.2)') i
      call file%put_point_reals('MODE_'//trim(adjustl(number)), modes(i)%shape, names)
    end do
    call save_listed(self, file, '_modes_step'//text_of(step)//'.vtu', record, error)
  end subroutine write_mode_shapes

  !> Makes the folder and the cells, once for each stage.
  subroutine prepare(self, model, error)
    class(vtk_series), intent(inout) :: self
    type(problem), intent(in) :: model
    type(error_type), allocatable, intent(out) :: error
    integer :: e, c, last, corners(8), num_corners
    if (self%has_grid .and. self%stage == model%mesh%stage) return
    call make_folder(self%folder(:len(self%folder) - 1), error)
    if (allocated(error)) return
    if (self%has_grid) deallocate (self%connectivity, self%ends, self%kinds)
    self%stage = model%mesh%stage
    self%elements = pack([(e, e=1, model%mesh%num_elements)], &
                         is_solid(model%mesh%element_type) .and. &
                         [(element_is_there(model%mesh, e), e=1, model%mesh%num_elements)])
    allocate (self%connectivity(8*size(self%elements)))
    allocate (self%ends(size(self%elements)), self%kinds(size(self%elements)))
    last = 0
    do c = 1, size(self%elements)
      call cell_of_solid(model%mesh%nodes(:, self%elements(c)), self%kinds(c), corners, num_corners)
      self%connectivity(last + 1:last + num_corners) = corners(:num_corners) - 1
      last = last + num_corners
      self%ends(c) = last
    end do
    self%connectivity = self%connectivity(:last)
    self%has_grid = .true.
  end subroutine prepare

  !> Starts a file with the solids, their materials and the numbers of the deck.
  subroutine start_grid(self, model, file)
    class(vtk_series), intent(in) :: self
    type(problem), intent(in) :: model
    type(vtu_file), intent(inout) :: file
    call file%start(model%mesh%x, self%connectivity, self%ends, self%kinds)
    call file%put_point_integers('NODE_ID', model%mesh%node_id)
    call file%put_cell_integers('MATERIAL', model%mesh%material_of_element(self%elements))
    call file%put_cell_integers('ELEMENT_ID', model%mesh%element_id(self%elements))
  end subroutine start_grid
end module write_vtk
