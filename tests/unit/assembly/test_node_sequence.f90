!> Order of the nodes for an incomplete factor: by hand.
program test_node_sequence
  use kinds, only: rk
  use node_sequence, only: order_nodes
  use problem_definition, only: problem
  use row_model, only: make_row
  use testing, only: check, test_log
  implicit none
  type(test_log) :: log

  log%suite = 'node_sequence'
  call planes_follow_each_other()
  call parts_follow_each_other()
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> Twelve boxes in a row, their nodes numbered at random: plane after plane, from one end.
  subroutine planes_follow_each_other()
    integer, parameter :: num_boxes = 12, num_nodes = 4*(num_boxes + 1)
    type(problem) :: model
    integer :: place(num_nodes), sequence(num_nodes), plane(num_nodes), k
    call make_boxes(num_boxes, model)
    place = [(1 + modulo(23*k, num_nodes), k=1, num_nodes)]
    model%mesh%nodes = reshape(place(reshape(model%mesh%nodes, [8*num_boxes])), [8, num_boxes])
    call order_nodes(model%mesh, sequence)
    plane(place) = [([k, k, k, k], k=1, num_boxes + 1)]
    plane = plane(sequence)
    call check(log, all(abs(plane(2:) - plane(:num_nodes - 1)) <= 1), 'neighbours follow')
    call check(log, abs(plane(1) - plane(num_nodes)) == num_boxes, 'from one end to the other')
    call check(log, all([(count(plane == k) == 4, k=1, num_boxes + 1)]), 'each node once')
  end subroutine planes_follow_each_other

  !> Two elements without a common node.
  subroutine parts_follow_each_other()
    type(problem) :: model
    integer :: sequence(13), k
    logical :: is_of_first(13)
    call make_boxes(2, model)
    model%mesh%num_nodes = 13
    model%mesh%nodes(:, 1) = [1, 2, 3, 4, 5, 5, 5, 5]
    model%mesh%nodes(:, 2) = [8, 9, 10, 11, 12, 13, 6, 7]
    call order_nodes(model%mesh, sequence)
    call check(log, all([(any(sequence == k), k=1, 13)]), 'each node of two parts')
    is_of_first = sequence <= 5
    call check(log, all(is_of_first(9:)) .and. .not. any(is_of_first(:8)), 'part after part')
  end subroutine parts_follow_each_other

  subroutine make_boxes(count, model)
    integer, intent(in) :: count
    type(problem), intent(out) :: model
    integer :: k
    call make_row([(real(k, rk), k=0, count)], 1.0_rk, 1.0_rk, [(1.0_rk, k=1, count)], &
                  [(1.0_rk, k=1, count)], model)
  end subroutine make_boxes
end program test_node_sequence
