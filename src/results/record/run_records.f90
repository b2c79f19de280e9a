!> The record of a run: faces of the dam, maxima and warnings of all increments, stresses of the
!> present increment. All writers read the record.
module run_records
  use kinds, only: rk
  use problem_definition, only: problem
  use run_ledger, only: ledger
  use analysis_state, only: state
  use dam_faces, only: dam_skin, find_dam_faces
  use dam_mesh, only: element_is_there
  use inelastic_blocks, only: fewest_blocks
  use envelopes, only: envelope, open_envelope, note_envelope, note_means
  use extremes, only: extreme, extremes_by_face, may_exceed, note_values
  use joint_readings, only: joint_record, open_joint_record, note_joint
  use damage_readings, only: damage_record, open_damage_record, note_damage
  use law_fields, only: mean_of_elements, take_block
  use goal_errors, only: goal_error
  use opening_error, only: count_broken
  use path_errors, only: path_error
  use extreme_errors, only: forget_error, update_error
  use singular_places, only: singular_nodes
  use write_text, only: as_short_text, as_text
  use space_errors, only: space_error, note_space_error
  use stress_fields, only: recovered_fields
  use field_table, only: list_fields, find_field
  use guest_fields, only: add_guest_fields
  use field_type, only: result_field, at_points, at_joints
  implicit none
  private
  public :: run_record, text_item

  !> One text of a list.
  type :: text_item
    character(:), allocatable :: text
  end type text_item

  !> record_archive saves and loads what changes in time; add a new component there too.
  type :: run_record
    type(result_field), allocatable :: fields(:) !< the table of fields
    type(recovered_fields) :: stresses
    type(singular_nodes) :: singular !< found again where a run goes on
    type(dam_skin) :: skin
    type(joint_record), allocatable :: joints(:)
    type(damage_record) :: damage
    type(extremes_by_face) :: displacement !< length of the vector, relative to the base [m]
    type(space_error) :: space !< error that the mesh leaves
    type(path_error) :: path !< of the laws of solids within increments, as the state has it
    real(rk) :: extent = 0.0_rk !< diagonal of the box around the mesh [m]
    type(goal_error) :: goals(2) !< errors of the largest displacement and of the largest opening
    type(envelope), allocatable :: envelopes(:) !< of all steps so far
    integer, allocatable :: active(:) !< envelopes of the present step
    type(text_item), allocatable :: warnings(:)
    type(text_item), allocatable :: files(:) !< names of the files beside job.json
    integer :: step = 0 !< the present step
    !> Largest dissipation by the time stepping in this step so far [J]
    real(rk) :: most_taken = 0.0_rk
    real(rk) :: last_strain = 0.0_rk, last_fracture = 0.0_rk !< energies, previous increment [J]
  contains
    procedure :: open => open_record
    procedure :: begin_step
    procedure :: note
    procedure :: warn_once
    procedure :: list_file
    procedure :: has_envelope_of_nodes
    procedure :: list_solid_nodes
    procedure :: largest_opening
    procedure, private :: warn_of_increment
    procedure, private :: update_envelope, note_nodes, note_points, note_joints, note_error
  end type run_record

  interface
    !> Warns of what an increment shows of the run.
    module subroutine warn_of_increment(self, model, now)
      implicit none
      class(run_record), intent(inout) :: self
      type(problem), intent(in) :: model
      type(state), intent(in) :: now
    end subroutine warn_of_increment
  end interface

contains

  !> Finds the faces of the dam and starts an empty record.
  subroutine open_record(self, model)
    class(run_record), intent(inout) :: self
    type(problem), intent(in) :: model
    integer :: j
    call list_fields(self%fields)
    call add_guest_fields(model, self%fields)
    call find_dam_faces(model, self%skin)
    allocate (self%joints(size(model%joints)), self%envelopes(0), self%active(0))
    allocate (self%warnings(0), self%files(0))
    self%extent = norm2(maxval(model%mesh%x, dim=2) - minval(model%mesh%x, dim=2))
    do j = 1, size(model%joints)
      call open_joint_record(model%joints(j), self%skin, self%joints(j))
    end do
    call open_damage_record(model, self%skin, self%damage)
  end subroutine open_record

  !> Opens the envelopes of a step, except those that the model does not have.
  subroutine begin_step(self, model, step)
    class(run_record), intent(inout) :: self
    type(problem), intent(in) :: model
    integer, intent(in) :: step
    type(envelope) :: fresh
    integer :: i, k, f
    self%step = step
    self%most_taken = -huge(1.0_rk)
    self%active = [integer ::]
    if (.not. allocated(model%steps(step)%envelope)) return
    do i = 1, size(model%steps(step)%envelope)
      associate (name => model%steps(step)%envelope(i))
        f = find_field(self%fields, trim(name))
        if (.not. self%fields(f)%is_in(model)) cycle
        k = findloc(self%envelopes%row, f, dim=1)
        if (k == 0) self%envelopes = [self%envelopes, fresh]
        if (k == 0) k = size(self%envelopes)
        call open_envelope(self%envelopes(k), name, f, self%fields(f)%wants_smallest, &
                           model%mesh%num_nodes)
        self%active = [self%active, k]
      end associate
    end do
  end subroutine begin_step

  !> Records an increment: maxima of joints always, envelopes where the step requests them.
  subroutine note(self, model, now, costs)
    class(run_record), intent(inout) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(ledger), intent(in) :: costs
    integer :: j, i
    call self%stresses%invalidate()
    self%path = now%path
    if (self%damage%is_present) call note_damage(model, now, self%damage)
    ! norm2, which guards against overflow, takes ten times as long.
    associate (u => now%u)
      call note_values(self%displacement, sqrt(u(1, :)**2 + u(2, :)**2 + u(3, :)**2), &
                       model%mesh%x, self%skin%is_upstream, self%skin%is_downstream, &
                       now%total_time, wants_smallest=.false.)
    end associate
    call self%warn_of_increment(model, now)
    do j = 1, size(model%joints)
      call note_joint(self%joints(j), model%joints(j), now%joints(j), now%total_time)
    end do
    if (size(self%active) > 0) then
      call costs%start('recover', 'envelopes', 'output')
      do i = 1, size(self%active)
        call self%update_envelope(model, now, costs, self%envelopes(self%active(i)))
      end do
      call costs%stop()
    end if
    ! Last, from the stresses that the envelopes have recovered.
    if (.not. model%steps(now%step)%controls%estimates_errors) return
    call costs%start('estimate', 'mesh', 'output')
    call note_space_error(model, now, self%stresses, self%space)
    call costs%stop()
  end subroutine note

  !> Updates one envelope, by the place of its field.
  subroutine update_envelope(self, model, now, costs, item)
    class(run_record), intent(inout) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(ledger), intent(in) :: costs
    type(envelope), intent(inout) :: item
    real(rk), allocatable :: values(:, :), magnitude(:)
    call self%fields(item%row)%on_nodes(model, now, self%stresses, values)
    magnitude = values(1, :)
    if (size(values, 1) > 1) magnitude = norm2(values, dim=1)
    select case (self%fields(item%row)%place)
    case (at_joints)
      call self%note_joints(model, now, max(0.0_rk, magnitude), item)
    case (at_points)
      call self%note_points(model, now, magnitude, item)
    case default
      call self%note_nodes(model, now, costs, magnitude, item)
    end select
  end subroutine update_envelope

  !> A field on nodes: the extremes are those of the nodes of solids.
  subroutine note_nodes(self, model, now, costs, values, item)
    class(run_record), intent(inout) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(ledger), intent(in) :: costs
    real(rk), intent(in) :: values(:) !< (nodes)
    type(envelope), intent(inout) :: item
    integer, allocatable :: solid_nodes(:)
    type(extreme) :: before
    integer :: n
    call note_envelope(item, values, now%total_time)
    before = item%largest%at(1)
    call self%list_solid_nodes(model, solid_nodes)
    if (.not. may_exceed(item%largest, values(solid_nodes), item%wants_smallest)) return
    call note_values(item%largest, values(solid_nodes), model%mesh%x(:, solid_nodes), &
                     self%skin%is_upstream(solid_nodes), self%skin%is_downstream(solid_nodes), &
                     now%total_time, item%wants_smallest)
    if (.not. (item%name == 'S1' .or. item%name == 'S3')) return
    if (before%is_found .and. abs(item%largest%at(1)%value - before%value) <= 0.0_rk) return
    n = maxloc(merge(-values(solid_nodes), values(solid_nodes), item%wants_smallest), dim=1)
    call self%note_error(model, now, costs, solid_nodes(n), before, item)
  end subroutine note_nodes

  !> The nodes of the solids that are there.
  subroutine list_solid_nodes(self, model, nodes)
    class(run_record), intent(inout) :: self
    type(problem), intent(in) :: model
    integer, allocatable, intent(out) :: nodes(:)
    integer :: n
    call self%stresses%need_plan(model)
    associate (start => self%stresses%plan%node_start)
      nodes = pack([(n, n=1, size(start) - 1)], start(2:) > start(:size(start) - 1))
    end associate
  end subroutine list_solid_nodes

  !> The error of an extreme that has grown.
  subroutine note_error(self, model, now, costs, node, before, item)
    class(run_record), intent(inout) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(ledger), intent(in) :: costs
    integer, intent(in) :: node !< of the extreme
    type(extreme), intent(in) :: before !< the extreme that has been exceeded
    type(envelope), intent(inout) :: item
    if (.not. model%steps(now%step)%controls%estimates_errors) then
      call forget_error(item)
      return
    end if
    call costs%start('estimate', 'mesh', 'output')
    call update_error(model, now, self%stresses, self%singular, node, before, item)
    call costs%stop()
  end subroutine note_error

  !> A field of joints: the extremes are those of the points; closed points count as 0.
  subroutine note_joints(self, model, now, on_nodes, item)
    class(run_record), intent(inout) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    real(rk), intent(in) :: on_nodes(:) !< (nodes)
    type(envelope), intent(inout) :: item
    real(rk), allocatable :: values(:, :)
    integer :: j
    call note_envelope(item, on_nodes, now%total_time)
    do j = 1, size(model%joints)
      call self%fields(item%row)%of_joint(model, now, j, values)
      call note_values(item%largest, max(0.0_rk, values(1, :)), model%joints(j)%x, &
                       self%joints(j)%is_upstream, self%joints(j)%is_downstream, &
                       now%total_time, item%wants_smallest)
    end do
  end subroutine note_joints

  !> A field of inelastic solids: the extremes are those of the integration points of elements that
  !> are there.
  subroutine note_points(self, model, now, on_nodes, item)
    class(run_record), intent(inout) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    real(rk), intent(in) :: on_nodes(:) !< (nodes)
    type(envelope), intent(inout) :: item
    real(rk), allocatable :: values(:, :), mean(:)
    logical :: may_grow(size(model%inelastic))
    integer :: i
    call note_envelope(item, on_nodes, now%total_time)
    if (self%fields(item%row)%has_means) then
      call mean_of_elements(model, now, item%name, mean)
      call note_means(item, mean)
    end if
    !$omp parallel do default(none) shared(self, model, now, item, may_grow) private(values) &
    !$omp schedule(dynamic, 8) if (size(may_grow) > fewest_blocks)
    do i = 1, size(may_grow)
      ! The elements of a block come and go together.
      may_grow(i) = element_is_there(model%mesh, model%inelastic(i)%elements(1))
      if (.not. may_grow(i)) cycle
      call find_at_points(self, model, now, item, i, values)
      may_grow(i) = may_exceed(item%largest, values(1, :), item%wants_smallest)
    end do
    !$omp end parallel do
    do i = 1, size(may_grow)
      if (.not. may_grow(i)) cycle
      call find_at_points(self, model, now, item, i, values)
      associate (points => model%inelastic(i)%points, faces => self%damage%faces(i))
        call note_values(item%largest, values(1, :), points%x, faces%is_upstream, &
                         faces%is_downstream, now%total_time, item%wants_smallest)
      end associate
    end do
  end subroutine note_points

  !> A field at the points of an inelastic block.
  subroutine find_at_points(self, model, now, item, block, values)
    class(run_record), intent(in) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(envelope), intent(in) :: item !< of the field
    integer, intent(in) :: block !< its position
    real(rk), allocatable, intent(out) :: values(:, :) !< (1, points)
    select case (item%name)
    case ('S1_POINT', 'S3_POINT') ! the values on the nodes come from those at the points
      call take_block(model, self%stresses%plan, block, &
                      self%stresses%point_principal(merge(3, 1, item%wants_smallest), :, :), &
                      values)
    case default
      call self%fields(item%row)%of_block(model, now, block, values)
      if (allocated(values)) return
      allocate (values(1, model%inelastic(block)%points%num_points), source=0.0_rk)
    end select
  end subroutine find_at_points

  !> Whether an envelope of the present step needs the motion of the nodes.
  pure logical function has_envelope_of_nodes(self)
    class(run_record), intent(in) :: self
    has_envelope_of_nodes = any(self%fields(self%envelopes(self%active)%row)%place /= at_joints)
  end function has_envelope_of_nodes

  !> The joint with the largest opening; 0 where none has opened.
  pure integer function largest_opening(self) result(joint)
    class(run_record), intent(in) :: self
    joint = 0
    if (size(self%joints) == 0) return
    joint = maxloc(self%joints%opening%at(1)%value, dim=1)
    if (self%joints(joint)%opening%at(1)%value <= 0.0_rk) joint = 0
  end function largest_opening

  !> Keeps a warning, each text once.
  subroutine warn_once(self, text)
    class(run_record), intent(inout) :: self
    character(*), intent(in) :: text
    call add_once(self%warnings, text)
  end subroutine warn_once

  !> Lists a file among the results.
  subroutine list_file(self, path)
    class(run_record), intent(inout) :: self
    character(*), intent(in) :: path !< relative to the folder of the results
    call add_once(self%files, path)
  end subroutine list_file

  !> Adds a text unless the list has it.
  subroutine add_once(list, text)
    type(text_item), allocatable, intent(inout) :: list(:)
    character(*), intent(in) :: text
    type(text_item), allocatable :: longer(:)
    integer :: i
    do i = 1, size(list)
      if (list(i)%text == text) return
    end do
    allocate (longer(size(list) + 1))
    longer(:size(list)) = list
    longer(size(longer))%text = text
    call move_alloc(longer, list)
  end subroutine add_once
end module run_records
