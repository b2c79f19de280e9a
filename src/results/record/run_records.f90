!> What a run knows of itself beyond one increment: faces of the dam, maxima, warnings; and the
!> stresses of the present increment. All writers read it.
module run_records
  use kinds, only: rk
  use problem_definition, only: problem
  use analysis_state, only: state
  use dam_faces, only: dam_skin, find_dam_faces
  use envelopes, only: envelope, open_envelope, note_envelope, note_means
  use extremes, only: note_values
  use joint_readings, only: joint_record, open_joint_record, note_joint
  use damage_readings, only: damage_record, open_damage_record, note_damage
  use law_fields, only: mean_of_elements
  use stress_fields, only: recovered_fields
  use field_table, only: list_fields, find_field
  use field_type, only: result_field, at_points, at_joints
  implicit none
  private
  public :: run_record, text_item

  !> Energy that the stepping may feed in a dynamic step, over the largest of the balance. Of the
  !> schemes compared in docs/theory.md, 7.2, sound ones feed 2 %, others 100 %.
  real(rk), parameter :: largest_gain = 0.1_rk

  !> Part of the energy stored at most that solids may lose within one static increment. A crack
  !> that is followed takes a few percent; one that snaps back takes most of it.
  real(rk), parameter :: largest_release = 0.3_rk

  type :: text_item
    character(:), allocatable :: text
  end type text_item

  !> What changes in time is saved and loaded by record_archive; a new component goes there too.
  type :: run_record
    type(result_field), allocatable :: fields(:) !< the table of fields
    type(recovered_fields) :: stresses
    type(dam_skin) :: skin
    type(joint_record), allocatable :: joints(:)
    type(damage_record) :: damage
    type(envelope), allocatable :: envelopes(:) !< all ever asked for
    integer, allocatable :: active(:) !< those of the present step
    type(text_item), allocatable :: warnings(:)
    type(text_item), allocatable :: files(:) !< names of what was written, beside job.json
    integer :: step = 0 !< the present step
    real(rk) :: most_taken = 0.0_rk !< by the stepping in this step so far [J]
    real(rk) :: last_strain = 0.0_rk, last_fracture = 0.0_rk !< energies before [J]
  contains
    procedure :: open => open_record
    procedure :: begin_step
    procedure :: note
    procedure :: warn_once
    procedure :: list_file
    procedure, private :: watch_stepping, watch_release
    procedure, private :: note_one, note_nodes, note_points, note_joints
  end type run_record

contains

  !> Finds the faces of the dam and starts empty.
  subroutine open_record(self, model)
    class(run_record), intent(inout) :: self
    type(problem), intent(in) :: model
    integer :: j
    call list_fields(self%fields)
    call find_dam_faces(model, self%skin)
    allocate (self%joints(size(model%joints)), self%envelopes(0), self%active(0))
    allocate (self%warnings(0), self%files(0))
    do j = 1, size(model%joints)
      call open_joint_record(model%joints(j), self%skin, self%joints(j))
    end do
    call open_damage_record(model, self%skin, self%damage)
  end subroutine open_record

  !> Opens the envelopes of a step, but those that the analysis does not have.
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
        if (self%fields(f)%width(model) == 0) cycle
        k = findloc(self%envelopes%row, f, dim=1)
        if (k == 0) self%envelopes = [self%envelopes, fresh]
        if (k == 0) k = size(self%envelopes)
        call open_envelope(self%envelopes(k), name, f, self%fields(f)%wants_smallest, &
                           model%mesh%num_nodes)
        self%active = [self%active, k]
      end associate
    end do
  end subroutine begin_step

  !> Takes note of an increment: maxima of joints always, envelopes where the step asks.
  subroutine note(self, model, now)
    class(run_record), intent(inout) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    integer :: j, i
    call self%stresses%forget()
    if (model%steps(now%step)%procedure%has_inertia) then
      call self%watch_stepping(now, model%steps(now%step)%procedure%uses_alpha)
    end if
    if (self%damage%is_present) call self%watch_release(model, now)
    if (now%has_held_switches) then
      call self%warn_once('step '//model%steps(now%step)%name//': where the jump of '// &
                          'RECOVERY=SIGN let no balance be found its switch was kept for the '// &
                          'increment as it had been before')
    end if
    do j = 1, size(model%joints)
      call note_joint(self%joints(j), model%joints(j), now%joints(j), now%total_time)
    end do
    if (self%damage%is_present) call note_damage(model, now, self%damage)
    do i = 1, size(self%active)
      call self%note_one(model, now, self%envelopes(self%active(i)))
    end do
  end subroutine note

  !> Warns of a motion that the time stepping drives: the balance of energy closes all the same.
  subroutine watch_stepping(self, now, uses_alpha)
    class(run_record), intent(inout) :: self
    type(state), intent(in) :: now
    logical, intent(in) :: uses_alpha !< the scheme has numerical damping to choose
    character(:), allocatable :: advice
    self%most_taken = max(self%most_taken, now%energy%numerical)
    if (self%most_taken - now%energy%numerical <= largest_gain*now%energy%largest) return
    advice = 'smaller increments'
    if (uses_alpha) advice = advice//', or an ALPHA further below 0'
    call self%warn_once('the time stepping has fed more than a tenth of the energy '// &
                        '("numerical" in the energy balance): do not trust this motion; try '// &
                        advice)
  end subroutine watch_stepping

  !> Warns of a static increment in which cracks took much of the energy that was stored: it has
  !> jumped from one equilibrium to another.
  subroutine watch_release(self, model, now)
    class(run_record), intent(inout) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    real(rk) :: released
    released = min(self%last_strain - now%energy%strain, now%energy%fracture - self%last_fracture)
    self%last_strain = now%energy%strain
    self%last_fracture = now%energy%fracture
    if (.not. model%steps(now%step)%procedure%is_static()) return
    if (released <= largest_release*now%energy%largest) return
    call self%warn_once('a static increment has given much of the stored energy to cracks at '// &
                        'once: the structure has jumped from one equilibrium to another; take '// &
                        'smaller increments, or a *DYNAMIC step where it still jumps')
  end subroutine watch_release

  !> One envelope, by the place where its field lives.
  subroutine note_one(self, model, now, item)
    class(run_record), intent(inout) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(envelope), intent(inout) :: item
    real(rk), allocatable :: values(:, :), size_of(:)
    call self%fields(item%row)%on_nodes(model, now, self%stresses, values)
    size_of = values(1, :)
    if (size(values, 1) > 1) size_of = norm2(values, dim=1)
    select case (self%fields(item%row)%place)
    case (at_joints)
      call self%note_joints(model, now, max(0.0_rk, size_of), item)
    case (at_points)
      call self%note_points(model, now, size_of, item)
    case default
      call self%note_nodes(model, now, size_of, item)
    end select
  end subroutine note_one

  !> A field on nodes: its extremes are those of the nodes of solids.
  subroutine note_nodes(self, model, now, values, item)
    class(run_record), intent(inout) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    real(rk), intent(in) :: values(:) !< (nodes)
    type(envelope), intent(inout) :: item
    integer, allocatable :: solid_nodes(:)
    integer :: n
    call self%stresses%need_plan(model)
    associate (start => self%stresses%plan%node_start)
      solid_nodes = pack([(n, n=1, size(values))], start(2:) > start(:size(start) - 1))
    end associate
    call note_envelope(item, values, now%total_time)
    call note_values(item%largest, values(solid_nodes), model%mesh%x(:, solid_nodes), &
                     self%skin%is_upstream(solid_nodes), self%skin%is_downstream(solid_nodes), &
                     now%total_time, item%wants_smallest)
  end subroutine note_nodes

  !> A field of joints: its extremes are those of their points; closed points count as 0.
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

  !> A field of inelastic solids: its extremes are those of their integration points.
  subroutine note_points(self, model, now, on_nodes, item)
    class(run_record), intent(inout) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    real(rk), intent(in) :: on_nodes(:) !< (nodes)
    type(envelope), intent(inout) :: item
    real(rk), allocatable :: values(:, :), mean(:)
    integer :: i
    call note_envelope(item, on_nodes, now%total_time)
    if (self%fields(item%row)%has_means) then
      call mean_of_elements(model, now, item%name, mean)
      call note_means(item, mean)
    end if
    do i = 1, size(model%inelastic)
      associate (points => model%inelastic(i)%points, faces => self%damage%faces(i))
        call self%fields(item%row)%of_block(model, now, i, values)
        if (.not. allocated(values)) allocate (values(1, points%num_points), source=0.0_rk)
        call note_values(item%largest, values(1, :), points%x, faces%is_upstream, &
                         faces%is_downstream, now%total_time, item%wants_smallest)
      end associate
    end do
  end subroutine note_points

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

  !> Adds a text that is not there yet.
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
