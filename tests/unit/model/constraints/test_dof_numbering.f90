!> T of chains of joints, loops and supports; expand and reduce are transposed to each other; nodes
!> with an unknown more.
program test_dof_numbering
  use dam_mesh, only: node_tie
  use kinds, only: rk
  use errors, only: error_type
  use testing, only: test_log, check, check_close, check_text
  use node_dofs, only: dof_map, displacement_dofs, displacements, dof_component, number_dofs
  use dof_numbering, only: numbering, linear_links, number_unknowns
  use jump_links, only: nodal_points, link_nodes, pairs_of_nodes
  implicit none
  type(test_log) :: log
  log%suite = 'dof_numbering'
  call chain_of_joints()
  call loop_and_supports()
  call transposed()
  call node_with_pressure()
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1
contains

  !> Rotation about e3 by an angle whose cosine and sine are 0.6 and 0.8.
  pure function turned() result(r)
    real(rk) :: r(3, 3)
    r = reshape([0.6_rk, -0.8_rk, 0.0_rk, 0.8_rk, 0.6_rk, 0.0_rk, 0.0_rk, 0.0_rk, 1.0_rk], [3, 3])
  end function turned

  !> Numbers five nodes, of which the last is used by no element.
  subroutine number_five(slave, master, is_fixed, numbers)
    integer, intent(in) :: slave(:), master(:)
    logical, intent(in) :: is_fixed(3, 5)
    type(numbering), intent(out) :: numbers
    type(linear_links) :: links
    type(nodal_points) :: points
    type(node_tie) :: ties(0)
    type(error_type), allocatable :: error
    logical :: is_used(5)
    is_used = [.true., .true., .true., .true., .false.]
    call pairs_of_nodes(slave, master, spread(turned(), 3, size(slave)), points)
    call link_nodes(displacement_dofs(5), points, ties, is_used, is_fixed, links, error)
    call number_unknowns(displacement_dofs(5), is_used, is_fixed, links, numbers, error)
    call check(log, allocated(error) .eqv. .false., 'numbering succeeds')
  end subroutine number_five

  subroutine chain_of_joints()
    type(numbering) :: numbers
    logical :: is_fixed(3, 5)
    real(rk), allocatable :: q(:)
    real(rk) :: u(3, 5), d(3)
    integer :: k
    is_fixed = .false.
    is_fixed(3, 4) = .true.
    ! Node 1 is the root of 2, and 2 of 3, though the pairs come the other way round.
    call number_five([3, 2], [2, 1], is_fixed, numbers)
    call check(log, numbers%num_free == 11 .and. numbers%num_total == 12, '3 + 2 + 6 free, 1 fixed')
    call check(log, all(numbers%first_jump == [6, 9]), 'jumps stand last among the free')
    q = [(real(k, rk), k=1, 12)]
    call numbers%expand(q, u)
    d = matmul(turned(), u(:, 3) - u(:, 2)) - q(6:8)
    call check_close(log, norm2(d), 0.0_rk, 1.0e-14_rk, 'the jump of pair 1 is its unknown')
    d = matmul(turned(), u(:, 2) - u(:, 1)) - q(9:11)
    call check_close(log, norm2(d), 0.0_rk, 1.0e-14_rk, 'the jump of pair 2 is its unknown')
    call check_close(log, norm2(u(:, 5)), 0.0_rk, 0.0_rk, 'a node without elements rests')
    call check_text(log, numbers%describe(12, [10, 20, 30, 40, 50]), &
                    'node 40, displacement along z', 'a prescribed unknown')
    call check_text(log, numbers%describe(7, [10, 20, 30, 40, 50]), 'joint slip 1 at node 30', &
                    'a jump')
  end subroutine chain_of_joints

  subroutine loop_and_supports()
    type(numbering) :: numbers
    logical :: is_fixed(3, 5)
    is_fixed = .false.
    call number_five([2, 3, 1, 4, 5], [1, 2, 3, 4, 1], is_fixed, numbers)
    call check(log, all(numbers%first_jump(:2) > 0) .and. all(numbers%first_jump(3:) == 0), &
               'no jump closes a loop, none within a node, none to an unused node')
    is_fixed(1, 1) = .true.
    is_fixed(2, 2) = .true.
    call number_five([2, 3], [1, 2], is_fixed, numbers)
    call check(log, numbers%first_jump(1) == 0 .and. numbers%first_jump(2) > 0, &
               'no jump between two supports')
    call number_five([2], [4], is_fixed, numbers)
    call check(log, numbers%first_jump(1) > 0, 'a held slave becomes the root')
  end subroutine loop_and_supports

  subroutine transposed()
    type(numbering) :: numbers
    logical :: is_fixed(3, 5)
    real(rk) :: u(3, 5), f(3, 5)
    real(rk), allocatable :: q(:), r(:)
    integer :: k
    is_fixed = .false.
    is_fixed(:, 2) = .true.
    call number_five([2, 3, 4], [1, 2, 3], is_fixed, numbers)
    f = reshape([(sin(real(k, rk)), k=1, 15)], [3, 5])
    allocate (r(numbers%num_total))
    q = [(cos(real(k, rk)), k=1, numbers%num_total)]
    call numbers%expand(q, u)
    call numbers%reduce(f, r)
    call check_close(log, dot_product(q, r), sum(u*f), 1.0e-14_rk, 'q.(T^T f) = (T q).f')
  end subroutine transposed

  !> Five nodes, of which 2 and 4 have a pressure. Node 2 follows node 1 by a joint, the pressure of
  !> node 4 and the foot of node 3 are prescribed.
  subroutine node_with_pressure()
    integer, parameter :: pressure = 4
    type(numbering) :: numbers
    type(dof_map) :: dofs
    type(linear_links) :: links
    type(nodal_points) :: points
    type(node_tie) :: ties(0)
    type(error_type), allocatable :: error
    logical :: is_fixed(pressure, 5)
    real(rk) :: field(pressure, 5), again(pressure, 5), f(pressure, 5), u(3, 5), d(3)
    real(rk), allocatable :: q(:), r(:)
    integer :: k
    is_fixed = .false.
    is_fixed(pressure, 4) = .true.
    is_fixed(3, 3) = .true.
    call pairs_of_nodes([2], [1], spread(turned(), 3, 1), points)
    dofs = number_dofs([displacements, dof_component('pressure', 'Pa')], [3, 4, 3, 4, 3])
    call link_nodes(dofs, points, ties, spread(.true., 1, 5), is_fixed, links, error)
    call number_unknowns(dofs, spread(.true., 1, 5), is_fixed, links, numbers, error)
    call check(log, allocated(error) .eqv. .false., 'numbering with pressures succeeds')
    call check(log, numbers%num_free == 15 .and. numbers%num_total == 17, &
               '17 dofs, 3 of them written through 3 jumps, 2 prescribed')
    call check(log, numbers%unknown_of(4, pressure) == 17, 'a prescribed pressure comes last')
    call check(log, numbers%unknown_of(2, 1) == 0, 'a dependent displacement is no unknown')
    call check_text(log, numbers%describe(numbers%unknown_of(2, pressure), [10, 20, 30, 40, 50]), &
                    'node 20, pressure', 'the name of the unknown')
    q = [(cos(real(k, rk)), k=1, 17)]
    call numbers%expand(q, field)
    call numbers%expand(q, u)
    call check_close(log, maxval(abs(u - field(:3, :))), 0.0_rk, 0.0_rk, 'displacements alone')
    d = matmul(turned(), u(:, 2) - u(:, 1)) - q(numbers%first_jump(1):numbers%first_jump(1) + 2)
    call check_close(log, norm2(d), 0.0_rk, 1.0e-14_rk, 'the joint separates displacements')
    call check_close(log, field(pressure, 2), q(numbers%unknown_of(2, pressure)), 0.0_rk, &
                     'pressure of a node whose displacements follow others')
    call check_close(log, sum(abs(field(pressure, [1, 3, 5]))), 0.0_rk, 0.0_rk, &
                     'nodes without a pressure')
    allocate (r(17))
    call numbers%restrict(field, r)
    r(numbers%first_jump(1):numbers%first_jump(1) + 2) = &
      q(numbers%first_jump(1):numbers%first_jump(1) + 2)
    call check_close(log, maxval(abs(r - q)), 0.0_rk, 0.0_rk, 'compressed as expanded')
    call numbers%expand(r, again)
    call check_close(log, maxval(abs(again - field)), 0.0_rk, 0.0_rk, 'expanded again')
    call numbers%expand_prescribed(q(16:), again)
    call check_close(log, sum(abs(again)), abs(q(16)) + abs(q(17)), 0.0_rk, 'two entries')
    call check_close(log, again(pressure, 4), q(17), 0.0_rk, 'at the prescribed pressure')
    call numbers%expand_prescribed(q(16:), u)
    call check_close(log, sum(abs(u)), abs(q(16)), 0.0_rk, 'a reaction without the pressure')
    f = reshape([(sin(real(k, rk)), k=1, size(f))], shape(f))
    call numbers%reduce(f, r)
    ! 20 products of numbers below 2.
    call check_close(log, dot_product(q, r), sum(field*f), 1.0e-14_rk, 'q.(T^T f) = (T q).f')
  end subroutine node_with_pressure
end program test_dof_numbering
