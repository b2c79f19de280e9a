!> *NODE PRINT, *EL PRINT, *JOINT PRINT: one CSV file for each set or joint, over all steps.
module write_history
  use kinds, only: rk
  use errors, only: error_type
  use problem_definition, only: problem
  use analysis_state, only: state
  use step_plan, only: print_request
  use run_records, only: run_record
  use result_writer, only: writer, is_due
  use requested_fields, only: is_of_law
  use field_table, only: find_field
  use history_rows, only: history_file, header_of, add_rows
  use print_kinds, only: kinds_of_prints, prints_of_joints
  use archive_type, only: archive
  use file_identity, only: add_path, file_path
  use file_system, only: safe_name, file_name
  use write_text, only: as_text
  implicit none
  private
  public :: history_files

  !> Points whose distances from a node differ by less than this part of the least are equally far.
  !> Their distances differ by round-off, 1e-16 times coordinates: less than 1e-9 while coordinates
  !> are below 1e6 distances.
  real(rk), parameter :: equal_part = 1.0e-9_rk

  type, extends(writer) :: history_files
    private
    type(history_file), allocatable :: files(:)
    type(history_file), allocatable :: kept(:) !< of a checkpoint: names and lengths
  contains
    procedure :: open => open_histories
    procedure :: go_on => go_on_with_histories
    procedure :: list_paths => list_histories
    procedure :: save_position => save_histories
    procedure :: load_position => load_histories
    procedure :: write_increment => write_rows
    procedure :: finish => close_files
  end type history_files

contains

  !> Opens a file for each printed set and joint.
  subroutine open_histories(self, model, stem, record, error)
    class(history_files), intent(inout) :: self
    type(problem), intent(in) :: model
    character(*), intent(in) :: stem
    type(run_record), intent(inout) :: record
    type(error_type), allocatable, intent(out) :: error
    integer :: f
    call list_files(model, record, self%files)
    do f = 1, size(self%files)
      associate (file => self%files(f))
        call file%open(path_of(stem, self%files, f), header_of_file(model, record, file), error)
        if (allocated(error)) return
        call record%list_file(file_name(file%path))
      end associate
    end do
  end subroutine open_histories

  !> Goes on with the files of the checkpoint, and opens those that are new.
  subroutine go_on_with_histories(self, model, stem, record, error)
    class(history_files), intent(inout) :: self
    type(problem), intent(in) :: model
    character(*), intent(in) :: stem
    type(run_record), intent(inout) :: record
    type(error_type), allocatable, intent(out) :: error
    integer :: f, k
    call list_files(model, record, self%files)
    do f = 1, size(self%files)
      associate (file => self%files(f))
        do k = 1, size(self%kept)
          if (self%kept(k)%name /= file%name .or. self%kept(k)%kind /= file%kind) cycle
          file%csv_file = self%kept(k)%csv_file
        end do
        call file%go_on(path_of(stem, self%files, f), header_of_file(model, record, file), error)
        if (allocated(error)) return
        call record%list_file(file_name(file%path))
      end associate
    end do
  end subroutine go_on_with_histories

  !> The paths of all files.
  subroutine list_histories(self, model, stem, record, paths)
    class(history_files), intent(inout) :: self
    type(problem), intent(in) :: model
    character(*), intent(in) :: stem
    type(run_record), intent(inout) :: record
    type(file_path), allocatable, intent(inout) :: paths(:)
    type(history_file), allocatable :: files(:)
    integer :: f
    call list_files(model, record, files)
    do f = 1, size(files)
      call add_path(paths, path_of(stem, files, f))
    end do
  end subroutine list_histories

  !> Stores names and lengths of the files.
  subroutine save_histories(self, file, error)
    class(history_files), intent(inout) :: self
    class(archive), intent(inout) :: file
    type(error_type), allocatable, intent(out) :: error
    integer :: f
    call file%put('num_files', size(self%files))
    do f = 1, size(self%files)
      call file%put('kind_'//as_text(f), self%files(f)%kind)
      call file%put_long_text('name_'//as_text(f), self%files(f)%name)
      call self%files(f)%save_position('num_bytes_'//as_text(f), file)
    end do
  end subroutine save_histories

  !> Reads names and lengths of the files.
  subroutine load_histories(self, file)
    class(history_files), intent(inout) :: self
    class(archive), intent(inout) :: file
    integer :: f, num_files
    num_files = 0
    call file%get('num_files', num_files)
    if (allocated(self%kept)) deallocate (self%kept)
    allocate (self%kept(num_files))
    do f = 1, num_files
      call file%get('kind_'//as_text(f), self%kept(f)%kind)
      call file%get_long_text('name_'//as_text(f), self%kept(f)%name)
      call self%kept(f)%load_position('num_bytes_'//as_text(f), file)
    end do
  end subroutine load_histories

  !> The files of all steps, not open yet.
  subroutine list_files(model, record, files)
    type(problem), intent(in) :: model
    type(run_record), intent(inout) :: record
    type(history_file), allocatable, intent(out) :: files(:)
    integer :: s, r
    allocate (files(0))
    do s = 1, size(model%steps)
      if (.not. allocated(model%steps(s)%prints)) cycle
      do r = 1, size(model%steps(s)%prints)
        call add_request(model, model%steps(s)%prints(r), record, files)
      end do
    end do
  end subroutine list_files

  !> The path of a file.
  pure function path_of(stem, files, f) result(path)
    character(*), intent(in) :: stem
    type(history_file), intent(in) :: files(:)
    integer, intent(in) :: f !< position of the file
    character(:), allocatable :: path
    associate (kind => kinds_of_prints(files(f)%kind))
      path = stem//'_'//trim(kind%part)//'_'//unique_name(files, f)//'.csv'
    end associate
  end function path_of

  !> The header line of a file.
  function header_of_file(model, record, file) result(header)
    type(problem), intent(in) :: model
    type(run_record), intent(in) :: record
    type(history_file), intent(in) :: file
    character(:), allocatable :: header
    header = header_of(model, record%fields, kinds_of_prints(file%kind), file%fields)
  end function header_of_file

  !> The name of a set or joint in the path of its file. Where a file before has this name (sets
  !> 'A B' and 'A_B'), the position of the file is appended until no set or joint has this name.
  pure function unique_name(files, f) result(name)
    type(history_file), intent(in) :: files(:)
    integer, intent(in) :: f !< position of the file
    character(:), allocatable :: name
    name = safe_name(files(f)%name)
    if (.not. is_taken(files(:f - 1), files(f)%kind, name)) return
    do while (is_taken(files, files(f)%kind, name))
      name = name//'_'//as_text(f)
    end do
  end function unique_name

  !> Has a file of this kind this name without a number?
  pure logical function is_taken(files, kind, name)
    type(history_file), intent(in) :: files(:)
    integer, intent(in) :: kind !< position in `kinds_of_prints`
    character(*), intent(in) :: name
    integer :: f
    is_taken = .false.
    do f = 1, size(files)
      if (files(f)%kind /= kind) cycle
      if (safe_name(files(f)%name) == name) is_taken = .true.
    end do
  end function is_taken

  !> Adds the fields of a request to its file; adds the file when it is new.
  subroutine add_request(model, request, record, files)
    type(problem), intent(in) :: model
    type(print_request), intent(in) :: request
    type(run_record), intent(inout) :: record
    type(history_file), allocatable, intent(inout) :: files(:)
    type(history_file), allocatable :: more(:)
    integer :: f, i, k
    f = find_file(files, request)
    if (f == 0) then
      f = size(files) + 1
      allocate (more(f))
      more(:f - 1) = files
      more(f)%kind = request%kind
      more(f)%name = request%name
      if (request%kind == prints_of_joints) more(f)%joint = request%members(1)
      allocate (more(f)%fields(0))
      call move_alloc(more, files)
    end if
    do i = 1, size(request%fields)
      k = find_field(record%fields, trim(request%fields(i)))
      if (any(files(f)%fields == k)) cycle
      if (is_printed(model, record, kinds_of_prints(request%kind)%keyword, k)) then
        files(f)%fields = [files(f)%fields, k]
      else if (request%kind /= prints_of_joints .and. .not. is_of_law(record, k)) then
        call record%warn_once(trim(request%fields(i))//' of '//request%name// &
                              ' is not printed: the model does not have this field')
      end if
    end do
  end subroutine add_request

  !> Does this model have the field for such a table?
  logical function is_printed(model, record, keyword, f)
    type(problem), intent(in) :: model
    type(run_record), intent(in) :: record
    character(*), intent(in) :: keyword !< of the request
    integer, intent(in) :: f !< row of the record's table, 0: an unknown field
    is_printed = .false.
    if (f == 0) return
    if (.not. record%fields(f)%is_allowed_in(trim(keyword))) return
    is_printed = record%fields(f)%width(model) > 0
  end function is_printed

  !> Position of the file of a request, 0 when there is none yet.
  pure integer function find_file(files, request) result(found)
    type(history_file), intent(in) :: files(:)
    type(print_request), intent(in) :: request
    integer :: f
    found = 0
    do f = 1, size(files)
      if (files(f)%kind == request%kind .and. files(f)%name == request%name) found = f
    end do
  end function find_file

  !> Writes the rows of all files with output now.
  subroutine write_rows(self, model, now, record, error)
    class(history_files), intent(inout) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(run_record), intent(inout) :: record
    type(error_type), allocatable, intent(out) :: error
    integer, allocatable :: chosen(:)
    integer :: f
    do f = 1, size(self%files)
      associate (file => self%files(f))
        call choose_members(model, now, file, chosen)
        if (size(chosen) == 0) cycle
        call add_rows(file, model, now, record, chosen)
        call file%save(error)
        if (allocated(error)) return
      end associate
    end do
  end subroutine write_rows

  !> Members that the requests of this step print now: nodes, elements or points of a joint.
  subroutine choose_members(model, now, file, chosen)
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(history_file), intent(in) :: file
    integer, allocatable, intent(out) :: chosen(:)
    integer :: r
    chosen = [integer ::]
    if (.not. allocated(model%steps(now%step)%prints)) return
    do r = 1, size(model%steps(now%step)%prints)
      associate (request => model%steps(now%step)%prints(r))
        if (request%kind /= file%kind .or. request%name /= file%name) cycle
        if (.not. is_due(now, request%frequency)) cycle
        if (file%kind == prints_of_joints) then
          chosen = united(chosen, points_of(model, request, file%joint))
        else
          chosen = united(chosen, request%members)
        end if
      end associate
    end do
  end subroutine choose_members

  !> Points of a joint: the nearest to each named node (of equally near points the first), or all
  !> without named nodes.
  pure function points_of(model, request, joint) result(points)
    type(problem), intent(in) :: model
    type(print_request), intent(in) :: request
    integer, intent(in) :: joint
    integer, allocatable :: points(:)
    integer :: p, i
    logical :: is_near(model%joints(joint)%num_points)
    real(rk) :: here(3), distance(model%joints(joint)%num_points)
    is_near = .true.
    if (allocated(request%near_nodes)) is_near = size(request%near_nodes) == 0
    if (.not. all(is_near)) then
      do i = 1, size(request%near_nodes)
        here = model%mesh%x(:, request%near_nodes(i))
        distance = norm2(model%joints(joint)%x - spread(here, 2, size(is_near)), dim=1)
        p = findloc(distance <= (1.0_rk + equal_part)*minval(distance), .true., dim=1)
        is_near(p) = .true.
      end do
    end if
    points = pack([(p, p=1, size(is_near))], is_near)
  end function points_of

  !> Union of two lists: in the order of a single list, ascending when both have members.
  pure function united(first, second) result(both)
    integer, intent(in) :: first(:), second(:)
    integer, allocatable :: both(:)
    logical, allocatable :: is_in(:)
    integer :: i
    both = first
    if (size(first) == 0) both = second
    if (size(first) == 0 .or. size(second) == 0) return
    allocate (is_in(max(maxval(first), maxval(second))), source=.false.)
    is_in(first) = .true.
    is_in(second) = .true.
    both = pack([(i, i=1, size(is_in))], is_in)
  end function united

  !> Closes the files.
  subroutine close_files(self, error)
    class(history_files), intent(inout) :: self
    type(error_type), allocatable, intent(out) :: error
    type(error_type), allocatable :: failure
    integer :: f
    do f = 1, size(self%files)
      call self%files(f)%close(failure)
      if (allocated(failure)) call move_alloc(failure, error)
    end do
  end subroutine close_files
end module write_history
