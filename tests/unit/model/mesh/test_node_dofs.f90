!> The layout of dofs: positions, their inverse, names, and vectors of elements.
program test_node_dofs
  use kinds, only: rk
  use testing, only: test_log, check, check_close, check_text
  use node_dofs, only: dof_map, dof_component, number_dofs, displacement_dofs, displacements, &
                       num_directions, zero_vectors, gather_vectors, add_vectors
  implicit none
  type(test_log) :: log
  log%suite = 'node_dofs'
  call displacements_only()
  call pressure_at_some_nodes()
  call vectors()
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1
contains

  subroutine displacements_only()
    type(dof_map) :: dofs
    dofs = displacement_dofs(4)
    call check(log, dofs%num_dofs == 12, 'three dofs a node')
    call check(log, all(dofs%dof_of([1, 2, 4], 3) == [3, 6, 12]), 'dofs along z')
    call check(log, all(dofs%displacements_of([4, 2]) == [10, 11, 12, 4, 5, 6]), &
               'dofs of an element')
    call check_text(log, dofs%components(2)%name, 'displacement along y', 'a name')
    call check_text(log, dofs%components(2)%unit, 'm', 'a unit')
  end subroutine displacements_only

  subroutine pressure_at_some_nodes()
    type(dof_map) :: dofs
    integer :: k
    dofs = number_dofs([displacements, dof_component('pressure', 'Pa')], [3, 4, 3, 4])
    call check(log, dofs%num_dofs == 14, 'two nodes have a dof more')
    call check(log, all(dofs%first == [1, 4, 8, 11, 15]), 'components of nodes')
    call check(log, all(dofs%displacements_of([3]) == [8, 9, 10]), 'displacements of node 3')
    call check(log, all(dofs%dof_of([2, 4], 4) == [7, 14]), 'pressures')
    call check(log, all(dofs%dof_of(dofs%node, dofs%component_of([(k, k=1, 14)])) == &
                        [(k, k=1, 14)]), 'node and component lead back to the dof')
    call check_text(log, dofs%components(dofs%component_of(7))%name, 'pressure', 'what dof 7 means')
  end subroutine pressure_at_some_nodes

  subroutine vectors()
    real(rk), allocatable :: field(:, :)
    real(rk) :: values(6)
    field = zero_vectors(3)
    call check(log, all(shape(field) == [num_directions, 3]), 'one vector a node')
    values = [1.0_rk, 2.0_rk, 3.0_rk, 4.0_rk, 5.0_rk, 6.0_rk]
    call add_vectors(values, [3, 1], field)
    call check_close(log, maxval(abs(gather_vectors(field, [3, 1]) - values)), 0.0_rk, 0.0_rk, &
                     'gathered as added')
    call add_vectors(values, [2, 2], field)
    call check_close(log, maxval(abs(field(:, 2) - [5.0_rk, 7.0_rk, 9.0_rk])), 0.0_rk, 0.0_rk, &
                     'a node that comes twice gets both vectors')
  end subroutine vectors
end program test_node_dofs
