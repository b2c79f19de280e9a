!> Stresses of the present increment, computed when somebody asks and then kept until the next one.
module stress_fields
  use kinds, only: rk
  use problem_definition, only: problem
  use analysis_state, only: state
  use tensor6, only: principal_values
  use stress_recovery, only: recovery_plan, make_recovery_plan, recover_points, average_at_nodes, &
                             max_points, few_nodes
  use stress_operator, only: nodal_operator, make_nodal_operator, apply_operator
  implicit none
  private
  public :: recovered_fields, principals

  integer, parameter :: recoveries_before_operator = 3

  !> `point_...` (6, max_points, solids), `node_...` (6 or 3, nodes); order 11 22 33 12 13 23.
  type :: recovered_fields
    type(recovery_plan) :: plan
    logical :: has_plan = .false., has_operator = .false. !< made once
    logical :: has_points = .false., has_node_strain = .false. !< of this increment
    logical :: has_node_stress = .false., has_principals = .false.
    integer :: num_recoveries = 0 !< how often stresses on the nodes were asked for
    type(nodal_operator) :: operator
    real(rk), allocatable :: point_strain(:, :, :), point_stress(:, :, :)
    real(rk), allocatable :: node_strain(:, :), node_stress(:, :)
    real(rk), allocatable :: node_principal(:, :) !< (3, nodes), the largest first [Pa]
  contains
    procedure :: forget
    procedure :: need_plan
    procedure :: need_points
    procedure :: need_node_strain
    procedure :: need_node_stress
    procedure :: need_principals
  end type recovered_fields

contains

  !> A new increment has come.
  subroutine forget(self)
    class(recovered_fields), intent(inout) :: self
    self%has_points = .false.
    self%has_node_strain = .false.
    self%has_node_stress = .false.
    self%has_principals = .false.
  end subroutine forget

  !> Makes sure that the plan is there.
  subroutine need_plan(self, scene)
    class(recovered_fields), intent(inout) :: self
    type(problem), intent(in) :: scene
    if (self%has_plan) return
    call make_recovery_plan(scene, self%plan)
    self%has_plan = .true.
  end subroutine need_plan

  !> Makes sure that strains and stresses at the points are there.
  subroutine need_points(self, scene, now)
    class(recovered_fields), intent(inout) :: self
    type(problem), intent(in) :: scene
    type(state), intent(in) :: now
    if (self%has_points) return
    call self%need_plan(scene)
    if (.not. allocated(self%point_strain)) then
      allocate (self%point_strain(6, max_points, self%plan%num_solids), source=0.0_rk)
      allocate (self%point_stress(6, max_points, self%plan%num_solids), source=0.0_rk)
    end if
    call recover_points(scene, self%plan, now%u, self%point_strain, self%point_stress)
    self%has_points = .true.
  end subroutine need_points

  !> Makes sure that strains on the nodes are there.
  subroutine need_node_strain(self, scene, now)
    class(recovered_fields), intent(inout) :: self
    type(problem), intent(in) :: scene
    type(state), intent(in) :: now
    if (self%has_node_strain) return
    call self%need_points(scene, now)
    if (.not. allocated(self%node_strain)) allocate (self%node_strain(6, scene%mesh%num_nodes))
    call average_at_nodes(self%plan, self%point_strain, self%node_strain)
    self%has_node_strain = .true.
  end subroutine need_node_strain

  !> Makes sure that stresses on the nodes are there. Whoever asks again and again is served by the
  !> operator, which costs as much to make as a few recoveries through the points.
  subroutine need_node_stress(self, scene, now)
    class(recovered_fields), intent(inout) :: self
    type(problem), intent(in) :: scene
    type(state), intent(in) :: now
    if (self%has_node_stress) return
    self%has_node_stress = .true.
    self%num_recoveries = self%num_recoveries + 1
    if (.not. allocated(self%node_stress)) allocate (self%node_stress(6, scene%mesh%num_nodes))
    if (self%has_operator) then
      call apply_operator(self%operator, now%u, self%node_stress)
      return
    end if
    call self%need_points(scene, now)
    call average_at_nodes(self%plan, self%point_stress, self%node_stress)
    if (self%num_recoveries < recoveries_before_operator) return
    if (.not. is_elastic(scene)) return
    call make_nodal_operator(scene, self%plan, self%operator)
    self%has_operator = .true.
  end subroutine need_node_stress

  !> Is the stress a linear function of the displacements?
  pure logical function is_elastic(scene)
    type(problem), intent(in) :: scene
    integer :: m
    is_elastic = .true.
    do m = 1, size(scene%materials)
      if (allocated(scene%materials(m)%law)) then
        is_elastic = is_elastic .and. scene%materials(m)%law%num_state == 0
      end if
    end do
  end function is_elastic

  !> Makes sure that the principal stresses on the nodes are there: of the averaged tensor.
  subroutine need_principals(self, scene, now)
    class(recovered_fields), intent(inout) :: self
    type(problem), intent(in) :: scene
    type(state), intent(in) :: now
    if (self%has_principals) return
    call self%need_node_stress(scene, now)
    self%node_principal = principals(self%node_stress)
    self%has_principals = .true.
  end subroutine need_principals

  !> Principal values of many tensors.
  function principals(tensor) result(values)
    real(rk), intent(in) :: tensor(:, :) !< (6, n)
    real(rk) :: values(3, size(tensor, 2))
    integer :: i
    !$omp parallel do default(none) shared(tensor, values) schedule(static) &
    !$omp if (size(tensor, 2) > few_nodes)
    do i = 1, size(tensor, 2)
      values(:, i) = principal_values(tensor(:, i))
    end do
    !$omp end parallel do
  end function principals
end module stress_fields
