!> Stresses of the present increment, computed on demand and kept until the next increment.
module stress_fields
  use kinds, only: rk
  use problem_definition, only: problem
  use analysis_state, only: state
  use principal_loops, only: fill_principals, principals
  use recovery_plans, only: fewest_for_threads, make_recovery_plan, max_points, recovery_plan
  use stress_recovery, only: copy_states, recover_expansions, recover_points, recover_principals, &
                             recover_some
  use node_means, only: average_at_nodes, average_at
  use law_fields, only: field_at_points, find_inelastic_solids, nodes_of_solids, &
                        is_zero_while_elastic
  use stress_operator, only: nodal_operator, make_nodal_operator, apply_operator
  use stress_error, only: smoothing_plan, make_smoothing_plan, average_patches, &
                          energy_of_stresses, repeat_single_points, add_hourglass_energy
  implicit none
  private
  public :: recovered_fields

  integer, parameter :: recoveries_before_operator = 3

  !> `point_...` (6, max_points, solids), `node_...` (6 or 3, nodes); order 11 22 33 12 13 23.
  type :: recovered_fields
    type(recovery_plan) :: plan
    logical :: has_plan = .false., has_operator = .false. !< made once for each stage
    integer :: stage = 0 !< that the plan is made for
    logical :: has_inelastic = .false. !< valid for this increment
    logical :: has_points = .false. !< stresses at the points, valid for this increment
    logical :: has_point_strain = .false., has_node_strain = .false. !< likewise
    logical :: has_node_stress = .false., has_principals = .false.
    logical :: has_point_principals = .false. !< valid for this increment
    logical :: uses_points = .false. !< in this increment
    logical :: used_points = .false. !< in the increment before
    integer :: num_recoveries = 0 !< number of requests for stresses on the nodes
    logical :: had_operator = .false. !< at the checkpoint that the run goes on from
    type(nodal_operator) :: operator
    logical, allocatable :: is_inelastic(:) !< (solids) a point has left elasticity
    integer, allocatable :: inelastic_nodes(:) !< nodes whose means include such solids
    real(rk), allocatable :: point_strain(:, :, :), point_stress(:, :, :)
    real(rk), allocatable :: node_strain(:, :), node_stress(:, :)
    real(rk), allocatable :: node_principal(:, :) !< (3, nodes), the largest first [Pa]
    real(rk), allocatable :: point_principal(:, :, :) !< (3, max_points, solids), likewise [Pa]
    logical :: has_smoothing = .false. !< made once for each stage
    logical :: has_error = .false. !< valid for this increment
    type(smoothing_plan) :: smoothing
    !> (solids) squares of the energy norms of the error and of the stress [J]
    real(rk), allocatable :: error_energy(:), stress_energy(:)
  contains
    procedure :: invalidate
    procedure :: free_points
    procedure :: need_plan
    procedure :: need_inelastic
    procedure :: need_points
    procedure :: need_point_strain
    procedure :: need_points_of
    procedure :: need_node_strain
    procedure :: need_node_stress
    procedure :: need_principals
    procedure :: need_point_principals
    procedure :: need_smoothing
    procedure :: need_error
    procedure :: field_on_nodes
    procedure :: points_on_nodes
    procedure :: find_expansions
    procedure :: expansion_on_nodes
    procedure, private :: correct_inelastic
  end type recovered_fields

contains

  !> Marks all fields as outdated, for a new increment.
  subroutine invalidate(self)
    class(recovered_fields), intent(inout) :: self
    self%has_inelastic = .false.
    self%has_points = .false.
    self%has_point_strain = .false.
    self%has_node_strain = .false.
    self%has_node_stress = .false.
    self%has_principals = .false.
    self%has_point_principals = .false.
    self%has_error = .false.
    self%used_points = self%uses_points
    self%uses_points = .false.
  end subroutine invalidate

  !> Frees the values at points at the end of an increment, unless this increment and the one before
  !> have used them: the next one then needs them, too. In most runs that are few increments.
  subroutine free_points(self)
    class(recovered_fields), intent(inout) :: self
    if (self%uses_points .and. self%used_points) return
    self%has_points = .false.
    self%has_point_strain = .false.
    self%has_point_principals = .false.
    if (allocated(self%point_strain)) deallocate (self%point_strain)
    if (allocated(self%point_stress)) deallocate (self%point_stress)
    if (allocated(self%point_principal)) deallocate (self%point_principal)
  end subroutine free_points

  !> Makes the plan unless it exists.
  subroutine need_plan(self, model)
    class(recovered_fields), intent(inout) :: self
    type(problem), intent(in) :: model
    if (self%has_plan .and. self%stage == model%mesh%stage) return
    if (self%has_plan) call forget_plan(self)
    call make_recovery_plan(model, self%plan)
    self%has_plan = .true.
    self%stage = model%mesh%stage
  end subroutine need_plan

  !> Forgets what belongs to the elements of an earlier stage.
  subroutine forget_plan(self)
    type(recovered_fields), intent(inout) :: self
    self%has_operator = .false.
    self%has_smoothing = .false.
    self%uses_points = .false.
    call self%free_points()
  end subroutine forget_plan

  !> Finds the solids and nodes that have left elasticity, once an increment.
  subroutine need_inelastic(self, model, now)
    class(recovered_fields), intent(inout) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    if (self%has_inelastic) return
    call self%need_plan(model)
    call find_inelastic_solids(model, self%plan, now, self%is_inelastic)
    self%inelastic_nodes = [integer ::]
    if (any(self%is_inelastic)) then
      self%inelastic_nodes = nodes_of_solids(self%plan, self%is_inelastic)
    end if
    self%has_inelastic = .true.
  end subroutine need_inelastic

  !> Computes stresses at the points, once an increment.
  subroutine need_points(self, model, now)
    class(recovered_fields), intent(inout) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    if (self%has_points) return
    call self%need_inelastic(model, now)
    call open_points(self%plan%num_solids, self%point_stress)
    self%uses_points = .true.
    call recover_points(model, self%plan, now, stress=self%point_stress)
    self%has_points = .true.
  end subroutine need_points

  !> Computes strains at the points, once an increment.
  subroutine need_point_strain(self, model, now)
    class(recovered_fields), intent(inout) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    if (self%has_point_strain) return
    call self%need_inelastic(model, now)
    call open_points(self%plan%num_solids, self%point_strain)
    self%uses_points = .true.
    call recover_points(model, self%plan, now, strain=self%point_strain)
    self%has_point_strain = .true.
  end subroutine need_point_strain

  !> Computes stresses at the points of some solids; those of others stay outdated.
  subroutine need_points_of(self, model, now, is_wanted)
    class(recovered_fields), intent(inout) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    logical, intent(in) :: is_wanted(:) !< (solids)
    if (self%has_points) return
    call self%need_inelastic(model, now)
    call open_points(self%plan%num_solids, self%point_stress)
    self%uses_points = .true.
    call recover_some(model, self%plan, now, is_wanted, self%point_stress)
  end subroutine need_points_of

  !> Allocates strains or stresses at the points, unless the increment before has left its own.
  subroutine open_points(num_solids, values)
    integer, intent(in) :: num_solids
    real(rk), allocatable, intent(inout) :: values(:, :, :)
    if (allocated(values)) return
    allocate (values(6, max_points, num_solids), source=0.0_rk)
  end subroutine open_points

  !> Computes strains on the nodes, once an increment.
  subroutine need_node_strain(self, model, now)
    class(recovered_fields), intent(inout) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    if (self%has_node_strain) return
    call self%need_point_strain(model, now)
    if (.not. allocated(self%node_strain)) allocate (self%node_strain(6, model%mesh%num_nodes))
    call average_at_nodes(self%plan, self%point_strain, self%is_inelastic, self%node_strain)
    self%has_node_strain = .true.
  end subroutine need_node_strain

  !> Computes stresses on the nodes, once an increment. The operator serves repeated requests;
  !> setting the operator up costs as much as a few recoveries through the points. It is valid at
  !> nodes whose solids are elastic, and not worth its memory where most solids are inelastic.
  subroutine need_node_stress(self, model, now)
    class(recovered_fields), intent(inout) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    if (self%has_node_stress) return
    self%has_node_stress = .true.
    self%num_recoveries = self%num_recoveries + 1
    if (.not. allocated(self%node_stress)) allocate (self%node_stress(6, model%mesh%num_nodes))
    call self%need_inelastic(model, now)
    if (self%had_operator .and. .not. self%has_operator .and. is_linear(now)) then
      call make_nodal_operator(model, self%plan, self%operator)
      self%has_operator = .true.
    end if
    if (self%has_operator) then
      call apply_operator(self%operator, now%u, self%node_stress)
      call self%correct_inelastic(now)
      return
    end if
    call self%need_points(model, now)
    call average_at_nodes(self%plan, self%point_stress, self%is_inelastic, self%node_stress)
    if (self%num_recoveries < recoveries_before_operator .or. .not. is_linear(now)) return
    if (2*size(self%inelastic_nodes) > model%mesh%num_nodes) return
    call make_nodal_operator(model, self%plan, self%operator)
    self%has_operator = .true.
  end subroutine need_node_stress

  !> Whether elastic stresses are linear in the displacements: no strains without stress.
  pure logical function is_linear(now)
    type(state), intent(in) :: now
    is_linear = .not. (allocated(now%origin) .or. allocated(now%heat%reference))
  end function is_linear

  !> Replaces the stress on the nodes where a solid has left elasticity. All solids in such a mean
  !> belong to one section, so all have states.
  subroutine correct_inelastic(self, now)
    class(recovered_fields), intent(inout) :: self
    type(state), intent(in) :: now
    logical, allocatable :: is_wanted(:)
    integer :: k, i, s
    if (size(self%inelastic_nodes) == 0) return
    call open_points(self%plan%num_solids, self%point_stress)
    self%uses_points = .true.
    allocate (is_wanted(self%plan%num_solids), source=.false.)
    do k = 1, size(self%inelastic_nodes)
      associate (start => self%plan%node_start, node => self%inelastic_nodes(k))
        do i = start(node), start(node + 1) - 1
          is_wanted((self%plan%corner(i) - 1)/8 + 1) = .true.
        end do
      end associate
    end do
    !$omp parallel do default(none) shared(self, now, is_wanted) schedule(static) &
    !$omp if (self%plan%num_solids > fewest_for_threads)
    do s = 1, self%plan%num_solids
      if (is_wanted(s)) call copy_states(self%plan, now, [s], stress=self%point_stress)
    end do
    !$omp end parallel do
    call average_at(self%plan, self%point_stress, self%is_inelastic, self%inelastic_nodes, &
                    self%node_stress)
  end subroutine correct_inelastic

  !> A field of laws (PE, DAMAGET, ...) on the nodes, within the range of the values at the points.
  subroutine field_on_nodes(self, model, now, name, values)
    class(recovered_fields), intent(inout) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    character(*), intent(in) :: name
    real(rk), allocatable, intent(out) :: values(:, :) !< (components, nodes)
    real(rk), allocatable :: at_points(:, :, :)
    logical, allocatable :: is_bounded(:)
    call self%need_inelastic(model, now)
    call field_at_points(model, self%plan, now, name, at_points)
    allocate (values(size(at_points, 1), model%mesh%num_nodes), source=0.0_rk)
    allocate (is_bounded(self%plan%num_solids), source=.true.)
    if (is_zero_while_elastic(name)) then
      call average_at(self%plan, at_points, is_bounded, self%inelastic_nodes, values)
    else
      call average_at_nodes(self%plan, at_points, is_bounded, values)
    end if
  end subroutine field_on_nodes

  !> A principal stress of the points on the nodes: the mean of the points next to a node, within
  !> the range of their values.
  subroutine points_on_nodes(self, model, now, number, values)
    class(recovered_fields), intent(inout) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    integer, intent(in) :: number !< 1: the largest, 3: the smallest
    real(rk), allocatable, intent(out) :: values(:, :) !< (1, nodes) [Pa]
    logical, allocatable :: is_bounded(:)
    call self%need_point_principals(model, now)
    allocate (values(1, model%mesh%num_nodes))
    allocate (is_bounded(self%plan%num_solids), source=.true.)
    call average_at_nodes(self%plan, self%point_principal(number:number, :, :), is_bounded, values)
  end subroutine points_on_nodes

  !> The thermal strains at the points of all solids.
  subroutine find_expansions(self, model, now, values)
    class(recovered_fields), intent(inout) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    real(rk), allocatable, intent(out) :: values(:, :, :) !< (6, max_points, solids)
    call self%need_plan(model)
    allocate (values(6, max_points, self%plan%num_solids))
    call recover_expansions(model, self%plan, now, values)
  end subroutine find_expansions

  !> The thermal strains on the nodes, by the rule of strains and stresses: those without stress are
  !> the strains.
  subroutine expansion_on_nodes(self, model, now, values)
    class(recovered_fields), intent(inout) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    real(rk), allocatable, intent(out) :: values(:, :) !< (6, nodes)
    real(rk), allocatable :: at_points(:, :, :)
    call self%need_inelastic(model, now)
    call self%find_expansions(model, now, at_points)
    allocate (values(6, model%mesh%num_nodes), source=0.0_rk)
    call average_at_nodes(self%plan, at_points, self%is_inelastic, values)
  end subroutine expansion_on_nodes

  !> Computes the principal stresses on the nodes from the mean tensor, once an increment.
  subroutine need_principals(self, model, now)
    class(recovered_fields), intent(inout) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    if (self%has_principals) return
    call self%need_node_stress(model, now)
    self%node_principal = principals(self%node_stress)
    self%has_principals = .true.
  end subroutine need_principals

  !> Computes the principal stresses at the points, once an increment. Values at points that an
  !> element does not have are not used.
  subroutine need_point_principals(self, model, now)
    class(recovered_fields), intent(inout) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    if (self%has_point_principals) return
    call self%need_inelastic(model, now)
    self%uses_points = .true.
    if (.not. allocated(self%point_principal)) then
      allocate (self%point_principal(3, max_points, self%plan%num_solids), source=0.0_rk)
    end if
    if (self%has_points) then
      call fill_principals(max_points*self%plan%num_solids, self%point_stress, &
                           self%point_principal)
    else
      call recover_principals(model, self%plan, now, self%point_principal)
    end if
    self%has_point_principals = .true.
  end subroutine need_point_principals

  !> Makes the plan of smooth stresses unless it exists.
  subroutine need_smoothing(self, model)
    class(recovered_fields), intent(inout) :: self
    type(problem), intent(in) :: model
    call self%need_plan(model)
    if (self%has_smoothing) return
    call make_smoothing_plan(model, self%plan, self%smoothing)
    self%has_smoothing = .true.
  end subroutine need_smoothing

  !> Computes the error of the stresses of each solid, once an increment (theory.md, 14.1).
  subroutine need_error(self, model, now)
    class(recovered_fields), intent(inout) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    real(rk), allocatable :: smooth(:, :)
    if (self%has_error) return
    call self%need_points(model, now)
    call self%need_smoothing(model)
    if (.not. allocated(self%error_energy)) then
      allocate (self%error_energy(self%plan%num_solids), self%stress_energy(self%plan%num_solids))
    end if
    call repeat_single_points(self%plan, self%point_stress)
    call average_patches(self%plan, self%smoothing, self%point_stress, self%is_inelastic, smooth)
    call energy_of_stresses(model, self%plan, self%smoothing, self%point_stress, &
                            self%error_energy, smooth)
    call add_hourglass_energy(model, self%plan, now, self%error_energy)
    call energy_of_stresses(model, self%plan, self%smoothing, self%point_stress, &
                            self%stress_energy)
    self%has_error = .true.
  end subroutine need_error
end module stress_fields
