!> The unknowns of two ranks that have three boxes in a row.
program test_part_borders
  use constraint_elimination, only: number_step
  use dof_numbering, only: numbering
  use errors, only: error_type
  use kinds, only: rk
  use node_parts, only: find_owners
  use part_borders, only: find_part
  use problem_definition, only: problem
  use row_model, only: make_row
  use step_plan, only: step_fixity
  use testing, only: check, test_log
  use unknown_parts, only: unknown_part
  implicit none
  type(test_log) :: log
  type(problem) :: model
  type(numbering) :: numbers(0:1)
  type(unknown_part) :: part(0:1)
  integer :: rank

  log%suite = 'part_borders'
  call make_row([0.0_rk, 1.0_rk, 2.0_rk, 3.0_rk], 1.0_rk, 1.0_rk, [(1.0e10_rk, rank=1, 3)], &
                [(2400.0_rk, rank=1, 3)], model)
  model%mesh%rank_of_element = [0, 0, 1]
  model%mesh%rank_of_law = [0, 1, 1]
  do rank = 0, 1
    call divide(rank)
  end do
  call ranks_have_their_unknowns()
  call both_list_the_border_alike()
  call each_unknown_has_one_owner()
  call common_unknowns_are_alike()
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> The unknowns of a rank. Node 12 is on both ranks whatever its elements are; nodes 9 and 16 are
  !> held in one direction each. Rank 1 calls the law of the second box.
  subroutine divide(rank)
    integer, intent(in) :: rank
    type(error_type), allocatable :: error
    integer :: owner(16), node
    associate (mesh => model%mesh)
      mesh%is_node_common = [(node == 12, node=1, 16)]
      mesh%is_node_here = [(merge(node <= 12, node >= 5, rank == 0), node=1, 16)]
      call number_step(mesh, model%joints, model%guests, &
                       [step_fixity(9, 2, 0.0_rk, 0), step_fixity(16, 1, 0.0_rk, 0)], &
                       numbers(rank), error)
      call find_owners(mesh, owner)
      call find_part(mesh, numbers(rank), owner, rank, 2, part(rank))
    end associate
    call check(log,.not. allocated(error), 'unknowns')
  end subroutine divide

  !> Three at each node of the rank.
  subroutine ranks_have_their_unknowns()
    call check(log, numbers(0)%num_total == 36 .and. numbers(1)%num_total == 36, 'in all')
    call check(log, numbers(0)%num_free == 35 .and. numbers(1)%num_free == 34, 'free ones')
  end subroutine ranks_have_their_unknowns

  !> The same unknowns in the same order on both ranks: those of nodes 5 to 11, for the law of the
  !> second box has its nodes on rank 1, too.
  subroutine both_list_the_border_alike()
    call check(log, size(part(0)%border) == 21 .and. size(part(1)%border) == 21, 'seven nodes')
    call check(log, all(part(0)%neighbour == [1]) .and. all(part(1)%neighbour == [0]), 'ranks')
    associate (a => numbers(0), b => numbers(1), i => part(0)%border, j => part(1)%border)
      call check(log, all(a%node(i) == b%node(j) .and. a%direction(i) == b%direction(j)), 'order')
    end associate
  end subroutine both_list_the_border_alike

  !> The owner is the lowest rank with an element at the node.
  subroutine each_unknown_has_one_owner()
    call check(log, count(part(0)%owns(36)) == 36, 'rank 0')
    call check(log, count(part(1)%owns(36)) == 12, 'rank 1')
    call check(log, all(part(1)%owns(36) .eqv. numbers(1)%node > 12), 'where')
  end subroutine each_unknown_has_one_owner

  !> Node 12 is no border.
  subroutine common_unknowns_are_alike()
    call check(log, size(part(0)%common) == 3 .and. size(part(1)%common) == 3, 'one node')
    call check(log, all(numbers(1)%node(part(1)%common) == 12), 'node 12')
    call check(log, all(numbers(0)%direction(part(0)%common) == &
                        numbers(1)%direction(part(1)%common)), 'order of common ones')
  end subroutine common_unknowns_are_alike
end program test_part_borders
