!> Stresses on the nodes: exact for a linear field, and alike through the points and the operator.
program test_stress_operator
  use kinds, only: rk
  use problem_definition, only: problem
  use analysis_state, only: state
  use step_plan, only: step_fixity
  use recovery_plans, only: make_recovery_plan, max_points, recovery_plan
  use stress_recovery, only: recover_points
  use node_means, only: average_at_nodes
  use stress_operator, only: nodal_operator, make_nodal_operator, apply_operator
  use arch_model, only: make_arch
  use testing, only: check_close, repeat_chance, test_log
  implicit none
  type(test_log) :: log
  type(problem) :: model
  type(step_fixity), allocatable :: fixities(:)
  type(recovery_plan) :: plan
  type(nodal_operator) :: operator
  type(state) :: now
  logical, allocatable :: is_bounded(:)
  real(rk), allocatable :: strain(:, :, :), stress(:, :, :), nodal(:, :), again(:, :)
  character(8), parameter :: kinds_of_solids(4) = ['C3D8    ', 'C3D8B   ', 'C3D8I   ', 'C3D8R   ']
  integer :: e
  log%suite = 'stress_operator'
  call repeat_chance(1)
  call make_arch(2, 3, 4, 2, model, fixities)
  do e = 1, model%mesh%num_elements
    model%mesh%element_type(e) = kinds_of_solids(1 + mod(e, 4))
  end do
  if (.not. allocated(model%mesh%section_of_element)) then
    allocate (model%mesh%section_of_element(model%mesh%num_elements), source=1)
  end if
  model%mesh%section_of_element(::5) = 2
  call make_recovery_plan(model, plan)
  allocate (is_bounded(plan%num_solids), source=.false.)
  allocate (strain(6, max_points, plan%num_solids), stress(6, max_points, plan%num_solids))
  allocate (now%u(3, model%mesh%num_nodes))
  allocate (nodal(6, model%mesh%num_nodes), again(6, model%mesh%num_nodes))
  call test_linear_field(log)
  call test_operator(log)
  print '(i0,a,i0,a)', log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> e11 = 1, g23 = 2: recovered without error wherever the elements are bent.
  subroutine test_linear_field(log)
    type(test_log), intent(inout) :: log
    now%u = 0.0_rk
    now%u(1, :) = model%mesh%x(1, :)
    now%u(2, :) = 2.0_rk*model%mesh%x(3, :)
    call recover_points(model, plan, now, strain, stress)
    call average_at_nodes(plan, strain, is_bounded, nodal)
    call check_close(log, maxval(abs(nodal(1, :) - 1.0_rk)), 0.0_rk, 1.0e-11_rk, 'e11')
    call check_close(log, maxval(abs(nodal(6, :) - 2.0_rk)), 0.0_rk, 1.0e-11_rk, 'g23')
    call check_close(log, maxval(abs(nodal(2:5, :))), 0.0_rk, 1.0e-11_rk, 'other strains')
  end subroutine test_linear_field

  !> Any field.
  subroutine test_operator(log)
    type(test_log), intent(inout) :: log
    call random_number(now%u)
    call recover_points(model, plan, now, strain, stress)
    call average_at_nodes(plan, stress, is_bounded, nodal)
    call make_nodal_operator(model, plan, operator)
    call apply_operator(operator, now%u, again)
    call check_close(log, maxval(abs(again - nodal))/maxval(abs(nodal)), 0.0_rk, 1.0e-13_rk, &
                     'operator against points')
  end subroutine test_operator
end program test_stress_operator
