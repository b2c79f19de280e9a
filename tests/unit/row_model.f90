!> A row of boxes along x that share their faces, on joints that rest on fixed ground; and a
!> listener that records a run.
module row_model
  use integrator_catalogue, only: procedure_named
  use kinds, only: rk
  use errors, only: error_type
  use problem_definition, only: problem
  use analysis_state, only: state, vibration_mode
  use increment_listener, only: listener
  use run_ledger, only: ledger_part
  use amplitudes, only: amplitude
  use applied_load, only: load_slot
  use material_elastic, only: elastic_law
  use joint_contraction, only: contraction_law
  use joint_points, only: dam_joint, list_faces
  use load_gravity, only: gravity_load
  use load_base_motion, only: base_motion
  use step_plan, only: step, step_fixity, step_load, initial_value
  implicit none
  private
  public :: make_row, put_on_ground, put_at_wall, add_gravity, shake_base, new_step, fix, kick
  public :: recorder, calls_of

  !> Remembers states.
  type, extends(listener) :: recorder
    integer :: num_increments = 0, most_iterations = 0, sum_iterations = 0
    real(rk) :: worst_error = 0.0_rk
    integer :: watched_node = 1, watched_dof = 1
    real(rk), allocatable :: time(:), u(:), v(:), a(:), friction(:), pressure(:), total(:)
    type(vibration_mode), allocatable :: modes(:)
  contains
    procedure :: increment_done, modes_found
  end type recorder

contains

  !> Boxes between the planes x(i) and x(i + 1), y in 0..width, z in 0..height, Poisson's ratio 0.
  !> Nodes 4*i - 3 .. 4*i lie in plane i: (0, 0), (width, 0), (width, height), (0, height).
  subroutine make_row(x, width, height, young, density, model)
    real(rk), intent(in) :: x(:), width, height
    real(rk), intent(in) :: young(:), density(:) !< (boxes)
    type(problem), intent(out) :: model
    integer :: i, n
    n = size(young)
    model%mesh%num_nodes = 4*(n + 1)
    model%mesh%num_elements = n
    allocate (model%mesh%x(3, 4*(n + 1)), model%mesh%nodes(8, n), model%mesh%element_type(n))
    model%mesh%element_type = 'C3D8'
    do i = 1, n + 1
      model%mesh%x(:, 4*i - 3:4*i) = reshape([x(i), 0.0_rk, 0.0_rk, x(i), width, 0.0_rk, &
                                              x(i), width, height, x(i), 0.0_rk, height], [3, 4])
    end do
    allocate (model%materials(n), model%joints(0), model%loads(0), model%amplitudes(0), &
              model%guests(0), &
              model%initial_values(0), model%steps(0))
    do i = 1, n
      model%mesh%nodes(:, i) = [4*i - 3, 4*i - 2, 4*i - 1, 4*i, 4*i + 1, 4*i + 2, 4*i + 3, 4*i + 4]
      model%materials(i)%density = density(i)
      allocate (model%materials(i)%law, source=elastic_law(young=young(i), poisson=0.0_rk))
    end do
    model%mesh%material_of_element = [(i, i=1, n)]
    model%mesh%section_of_element = [(i, i=1, n)]
    model%mesh%element_id = [(i, i=1, n)]
    model%mesh%node_id = [(i, i=1, 4*(n + 1))]
  end subroutine make_row

  !> A joint below box `box`.
  subroutine put_on_ground(box, law, model)
    integer, intent(in) :: box
    type(contraction_law), intent(in) :: law
    type(problem), intent(inout) :: model
    real(rk) :: area
    integer :: slave(4)
    slave = 4*box + [-3, -2, 1, 2]
    area = (model%mesh%x(1, slave(3)) - model%mesh%x(1, slave(1))) &
           *model%mesh%x(2, slave(2))/4.0_rk
    call add_joint(slave, area, reshape([0, 1, 0, 0, 0, 1, 1, 0, 0], [3, 3]), law, model)
  end subroutine put_on_ground

  !> A joint in front of the first face.
  subroutine put_at_wall(law, model)
    type(contraction_law), intent(in) :: law
    type(problem), intent(inout) :: model
    real(rk) :: area
    area = model%mesh%x(2, 3)*model%mesh%x(3, 3)/4.0_rk
    call add_joint([1, 2, 3, 4], area, reshape([1, 0, 0, 0, 1, 0, 0, 0, 1], [3, 3]), law, model)
  end subroutine put_at_wall

  !> Pairs of nodes of the row (slave) and nodes of the ground, which no element uses.
  subroutine add_joint(slave, area, rotation, law, model)
    integer, intent(in) :: slave(:), rotation(3, 3)
    real(rk), intent(in) :: area
    type(contraction_law), intent(in) :: law
    type(problem), intent(inout) :: model
    type(dam_joint) :: joint
    integer :: n, p
    n = size(slave)
    joint%name = 'GROUND'
    joint%kind = 'joint'
    allocate (joint%law, source=law)
    call list_faces(reshape(slave, [1, n]), &
                    reshape([(model%mesh%num_nodes + p, p=1, n)], [1, n]), &
                    reshape([1.0_rk], [1, n], pad=[1.0_rk]), joint)
    joint%x = model%mesh%x(:, slave)
    joint%rotation = spread(real(rotation, rk), 3, n)
    joint%area = spread(area, 1, n)
    model%mesh%x = reshape([model%mesh%x, joint%x], [3, model%mesh%num_nodes + n])
    model%mesh%num_nodes = model%mesh%num_nodes + n
    model%mesh%node_id = [(p, p=1, model%mesh%num_nodes)]
    model%joints = [model%joints, joint]
  end subroutine add_joint

  !> Weight along -z.
  subroutine add_gravity(g, model)
    real(rk), intent(in) :: g
    type(problem), intent(inout) :: model
    type(load_slot) :: slot
    type(gravity_load) :: weight
    integer :: e
    weight%name = 'GRAVITY'
    weight%kind = 'gravity'
    weight%elements = [(e, e=1, model%mesh%num_elements)]
    weight%acceleration = [0.0_rk, 0.0_rk, -g]
    allocate (slot%item, source=weight)
    model%loads = [model%loads, slot]
  end subroutine add_gravity

  !> Base motion along x, a0 sin(2 pi t) or another history.
  subroutine shake_base(history, model)
    type(amplitude), intent(in) :: history
    type(problem), intent(inout) :: model
    type(load_slot) :: slot
    type(base_motion) :: motion
    motion%name = 'BASE'
    motion%kind = 'base motion'
    motion%dof = 1
    allocate (slot%item, source=motion)
    model%loads = [model%loads, slot]
    model%amplitudes = [model%amplitudes, history]
  end subroutine shake_base

  !> A step with all loads of the model: the second one follows the first amplitude.
  subroutine new_step(procedure_name, increment, duration, model)
    character(*), intent(in) :: procedure_name
    real(rk), intent(in) :: increment, duration
    type(problem), intent(inout) :: model
    type(step) :: plan
    type(step_load) :: rule
    integer :: i
    plan%name = 'Step'
    plan%procedure = procedure_named(procedure_name)
    plan%first_increment = increment
    plan%duration = duration
    allocate (plan%loads(0), plan%fixities(0))
    if (size(model%steps) > 0) plan%fixities = model%steps(size(model%steps))%fixities
    do i = 1, size(model%loads)
      rule%load = i
      rule%amplitude = 0
      if (allocated(model%loads(i)%item%name)) then
        if (model%loads(i)%item%name == 'BASE') rule%amplitude = 1
      end if
      plan%loads = [plan%loads, rule]
    end do
    model%steps = [model%steps, plan]
  end subroutine new_step

  !> Fixes a direction of nodes in all steps.
  subroutine fix(nodes, dof, model)
    integer, intent(in) :: nodes(:), dof
    type(problem), intent(inout) :: model
    type(step_fixity) :: fixity
    integer :: s, i
    do s = 1, size(model%steps)
      do i = 1, size(nodes)
        fixity%node = nodes(i)
        fixity%dof = dof
        model%steps(s)%fixities = [model%steps(s)%fixities, fixity]
      end do
    end do
  end subroutine fix

  !> Initial velocity or displacement of nodes.
  subroutine kick(nodes, dof, value, is_velocity, model)
    integer, intent(in) :: nodes(:), dof
    real(rk), intent(in) :: value
    logical, intent(in) :: is_velocity
    type(problem), intent(inout) :: model
    integer :: i
    do i = 1, size(nodes)
      model%initial_values = [model%initial_values, &
                              initial_value(is_velocity, nodes(i), dof, value)]
    end do
  end subroutine kick

  !> Records the results for the tests.
  subroutine increment_done(self, model, now, error)
    class(recorder), intent(inout) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(error_type), allocatable, intent(out) :: error
    real(rk) :: pressure
    if (.not. allocated(self%time)) then
      allocate (self%time(0), self%u(0), self%v(0), self%a(0), self%friction(0), self%pressure(0), &
                self%total(0))
    end if
    if (now%increment > 0) self%num_increments = self%num_increments + 1
    self%most_iterations = max(self%most_iterations, now%iterations)
    self%sum_iterations = self%sum_iterations + now%iterations
    self%worst_error = max(self%worst_error, now%energy%error)
    pressure = 0.0_rk
    if (size(model%joints) > 0) pressure = -now%joints(1)%traction(1, 1)
    self%time = [self%time, now%total_time]
    self%u = [self%u, now%u(self%watched_dof, self%watched_node)]
    if (allocated(now%v)) self%v = [self%v, now%v(self%watched_dof, self%watched_node)]
    if (allocated(now%a)) self%a = [self%a, now%a(self%watched_dof, self%watched_node)]
    self%friction = [self%friction, now%energy%friction]
    self%pressure = [self%pressure, pressure]
    self%total = [self%total, now%energy%kinetic + now%energy%strain]
  end subroutine increment_done

  !> Keeps the modes.
  subroutine modes_found(self, model, step, modes, error)
    class(recorder), intent(inout) :: self
    type(problem), intent(in) :: model
    integer, intent(in) :: step
    type(vibration_mode), intent(in) :: modes(:)
    type(error_type), allocatable, intent(out) :: error
    self%modes = modes
  end subroutine modes_found

  !> Calls of a part of the ledger; the ledger must have been opened before the run.
  integer function calls_of(results, name)
    type(recorder), intent(in) :: results
    character(*), intent(in) :: name !< 'factor structure'
    type(ledger_part), allocatable :: parts(:)
    real(rk) :: wall_time
    integer :: i
    calls_of = 0
    call results%costs%read_parts(parts, wall_time)
    do i = 1, size(parts)
      if (parts(i)%name() == name) calls_of = parts(i)%num_calls
    end do
  end function calls_of
end module row_model
