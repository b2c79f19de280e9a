!> The stress on the nodes as one linear operator of the displacements: what the recovery through
!> points and corners amounts to where all laws are elastic, at the price of one sparse product.
module stress_operator
  use kinds, only: rk
  use shape_hex8, only: corners_from_points
  use problem_definition, only: problem
  use stress_recovery, only: recovery_plan, operators_of_block, max_points, few_nodes
  implicit none
  private
  public :: nodal_operator, make_nodal_operator, apply_operator

  !> Rows of 6 x 3 blocks.
  type :: nodal_operator
    integer, allocatable :: row_start(:) !< (nodes + 1)
    integer, allocatable :: column(:) !< node of each block
    real(rk), allocatable :: block(:, :, :) !< (6, 3, blocks) stress per displacement [Pa/m]
  end type nodal_operator

contains

  !> Builds the operator by running over the corners of all elements.
  subroutine make_nodal_operator(scene, plan, operator)
    type(problem), intent(in) :: scene
    type(recovery_plan), intent(in) :: plan
    type(nodal_operator), intent(out) :: operator
    real(rk), allocatable :: b(:, :, :, :)
    real(rk) :: d(6, 6), to_corner(8, max_points)
    integer :: i, k
    call find_columns(scene, plan, operator)
    allocate (operator%block(6, 3, size(operator%column)), source=0.0_rk)
    to_corner = corners_from_points()
    do i = 1, size(plan%blocks)
      call operators_of_block(scene, plan, plan%blocks(i), b, d)
      do k = 1, size(plan%blocks(i)%solids)
        call add_element(scene, plan, plan%blocks(i)%solids(k), b(:, :, :, k), d, to_corner, &
                         operator)
      end do
    end do
  end subroutine make_nodal_operator

  !> The nodes that a node's stress depends on: those of the elements whose corners count.
  subroutine find_columns(scene, plan, operator)
    type(problem), intent(in) :: scene
    type(recovery_plan), intent(in) :: plan
    type(nodal_operator), intent(inout) :: operator
    integer, parameter :: nodes_of_corner = 8
    integer, allocatable :: found(:), seen(:)
    integer :: node, i, a, e, neighbour, last
    allocate (operator%row_start(scene%mesh%num_nodes + 1))
    allocate (found(nodes_of_corner*size(plan%corner)), seen(scene%mesh%num_nodes), source=0)
    last = 0
    do node = 1, scene%mesh%num_nodes
      operator%row_start(node) = last + 1
      do i = plan%node_start(node), plan%node_start(node + 1) - 1
        e = plan%element_of_solid((plan%corner(i) - 1)/8 + 1)
        do a = 1, 8
          neighbour = scene%mesh%nodes(a, e)
          if (seen(neighbour) == node) cycle
          seen(neighbour) = node
          last = last + 1
          found(last) = neighbour
        end do
      end do
    end do
    operator%row_start(scene%mesh%num_nodes + 1) = last + 1
    operator%column = found(:last)
  end subroutine find_columns

  !> Adds what one element gives to the nodes whose stress it has a part in.
  subroutine add_element(scene, plan, solid, b, d, to_corner, operator)
    type(problem), intent(in) :: scene
    type(recovery_plan), intent(in) :: plan
    integer, intent(in) :: solid
    real(rk), intent(in) :: b(:, :, :) !< (6, 24, points)
    real(rk), intent(in) :: d(6, 6), to_corner(8, max_points)
    type(nodal_operator), intent(inout) :: operator
    real(rk) :: at_corner(6, 24), share
    integer :: a, q, node, c, i, nodes(8)
    nodes = scene%mesh%nodes(:, plan%element_of_solid(solid))
    do a = 1, 8
      node = nodes(a)
      if (.not. any(plan%corner(plan%node_start(node):plan%node_start(node + 1) - 1) == &
                    8*(solid - 1) + a)) cycle
      share = 1.0_rk/(plan%node_start(node + 1) - plan%node_start(node))
      at_corner = b(:, :, 1)
      if (size(b, 3) == max_points) then
        at_corner = 0.0_rk
        do q = 1, max_points
          at_corner = at_corner + to_corner(a, q)*b(:, :, q)
        end do
      end if
      at_corner = share*matmul(d, at_corner)
      do c = 1, 8
        i = operator%row_start(node) - 1 + &
            findloc(operator%column(operator%row_start(node):operator%row_start(node + 1) - 1), &
                    nodes(c), dim=1)
        operator%block(:, :, i) = operator%block(:, :, i) + at_corner(:, 3*c - 2:3*c)
      end do
    end do
  end subroutine add_element

  !> Stress on the nodes; those without a solid get zero.
  subroutine apply_operator(operator, u, stress)
    type(nodal_operator), intent(in) :: operator
    real(rk), intent(in) :: u(:, :) !< (3, nodes) [m]
    real(rk), intent(out) :: stress(:, :) !< (6, nodes) [Pa]
    real(rk) :: sum(6)
    integer :: node, i
    !$omp parallel do default(none) schedule(static) shared(operator, u, stress) private(i, sum) &
    !$omp if (size(stress, 2) > few_nodes)
    do node = 1, size(stress, 2)
      sum = 0.0_rk
      do i = operator%row_start(node), operator%row_start(node + 1) - 1
        associate (moved => u(:, operator%column(i)))
          sum = sum + operator%block(:, 1, i)*moved(1) + operator%block(:, 2, i)*moved(2) &
                + operator%block(:, 3, i)*moved(3)
        end associate
      end do
      stress(:, node) = sum
    end do
    !$omp end parallel do
  end subroutine apply_operator
end module stress_operator
