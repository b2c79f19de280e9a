!> Names of nodes in decks with instances.
program test_instance_list
  use instance_list, only: mesh_instance, own_name_of_node
  use testing, only: check_text, test_log
  implicit none
  type(test_log) :: log
  type(mesh_instance) :: outside
  type(mesh_instance), allocatable :: instances(:)
  log%suite = 'instance_list'
  call check_text(log, own_name_of_node(outside, instances, 7), '', 'no list of instances')
  allocate (instances(0))
  call check_text(log, own_name_of_node(outside, instances, 7), '', 'a deck without instances')
  outside = mesh_instance('', '', 1, 2, .true., 200, 0)
  instances = [mesh_instance('P-1', 'P', 1, 12, .true., 0, 0), &
               mesh_instance('P-2', 'P', 1, 12, .true., 100, 10)]
  call check_text(log, own_name_of_node(outside, instances, 12), ' (node 12 of P-1)', 'first')
  call check_text(log, own_name_of_node(outside, instances, 101), ' (node 1 of P-2)', 'second')
  call check_text(log, own_name_of_node(outside, instances, 202), ' (node 2 of the assembly)', &
                  'outside')
  call check_text(log, own_name_of_node(outside, instances, 50), '', 'no node of them')
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1
end program test_instance_list
