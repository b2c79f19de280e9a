!> The stress on the nodes as a linear operator on the displacements. For elastic laws this sparse
!> product equals the recovery through points and corners.
module stress_operator
  use kinds, only: rk
  use node_dofs, only: num_directions
  use shape_hex8, only: corners_from_points, hex8_dofs
  use problem_definition, only: problem
  use recovery_plans, only: fewest_for_threads, max_points, recovery_plan
  use stress_recovery, only: operators_of_block
  implicit none
  private
  public :: nodal_operator, make_nodal_operator, apply_operator

  !> Smaller parts of the strain besides the gradient are round-off.
  real(rk), parameter :: smallest_rest = 1.0e-13_rk

  !> Rows of gradients: in most elements the strain on a node follows from a gradient, three numbers
  !> for every node of the element. Other parts of the strain (mean volume, incompatible modes) are
  !> kept as blocks, in models with such elements.
  type :: nodal_operator
    integer, allocatable :: row_start(:) !< (nodes + 1)
    integer, allocatable :: column(:) !< node of each entry
    real(rk), allocatable :: gradient(:, :) !< (3, entries) [1/m]
    real(rk), allocatable :: rest(:, :, :) !< (6, 3, entries) strain per displacement, or (6, 3, 0)
    integer, allocatable :: material(:) !< (nodes) material of the node, 0 without a solid
    real(rk), allocatable :: elastic(:, :, :) !< (6, 6, materials) [Pa]
  end type nodal_operator

contains

  !> Builds the operator from the corners of all elements.
  subroutine make_nodal_operator(model, plan, operator)
    type(problem), intent(in) :: model
    type(recovery_plan), intent(in) :: plan
    type(nodal_operator), intent(out) :: operator
    real(rk), allocatable :: b(:, :, :, :)
    real(rk) :: d(6, 6), to_corner(8, max_points)
    integer :: i, k
    call find_columns(model, plan, operator)
    allocate (operator%gradient(3, size(operator%column)), source=0.0_rk)
    allocate (operator%rest(6, 3, 0))
    allocate (operator%material(model%mesh%num_nodes), source=0)
    allocate (operator%elastic(6, 6, size(model%materials)), source=0.0_rk)
    to_corner = corners_from_points()
    do i = 1, size(plan%blocks)
      call operators_of_block(model, plan, plan%blocks(i), b, d)
      operator%elastic(:, :, plan%blocks(i)%material) = d
      do k = 1, size(plan%blocks(i)%solids)
        call add_element(model, plan, plan%blocks(i)%solids(k), b(:, :, :, k), to_corner, operator)
      end do
    end do
  end subroutine make_nodal_operator

  !> The nodes that the stress on a node depends on: those of the elements in its mean.
  subroutine find_columns(model, plan, operator)
    type(problem), intent(in) :: model
    type(recovery_plan), intent(in) :: plan
    type(nodal_operator), intent(inout) :: operator
    integer, parameter :: nodes_of_corner = 8
    integer, allocatable :: found(:), seen(:)
    integer :: node, i, a, e, neighbour, last
    allocate (operator%row_start(model%mesh%num_nodes + 1))
    allocate (found(nodes_of_corner*size(plan%corner)), seen(model%mesh%num_nodes), source=0)
    last = 0
    do node = 1, model%mesh%num_nodes
      operator%row_start(node) = last + 1
      do i = plan%node_start(node), plan%node_start(node + 1) - 1
        e = plan%element_of_solid((plan%corner(i) - 1)/8 + 1)
        do a = 1, 8
          neighbour = model%mesh%nodes(a, e)
          if (seen(neighbour) == node) cycle
          seen(neighbour) = node
          last = last + 1
          found(last) = neighbour
        end do
      end do
    end do
    operator%row_start(model%mesh%num_nodes + 1) = last + 1
    operator%column = found(:last)
  end subroutine find_columns

  !> Adds one element to the rows of the nodes whose mean includes the element.
  subroutine add_element(model, plan, solid, b, to_corner, operator)
    type(problem), intent(in) :: model
    type(recovery_plan), intent(in) :: plan
    integer, intent(in) :: solid
    real(rk), intent(in) :: b(:, :, :) !< (6, 24, points)
    real(rk), intent(in) :: to_corner(8, max_points)
    type(nodal_operator), intent(inout) :: operator
    real(rk) :: at_corner(6, hex8_dofs), share
    integer :: a, q, node, c, i, nodes(8)
    nodes = model%mesh%nodes(:, plan%element_of_solid(solid))
    do a = 1, 8
      node = nodes(a)
      if (.not. any(plan%corner(plan%node_start(node):plan%node_start(node + 1) - 1) == &
                    8*(solid - 1) + a)) cycle
      operator%material(node) = model%mesh%material_of_element(plan%element_of_solid(solid))
      share = 1.0_rk/(plan%node_start(node + 1) - plan%node_start(node))
      at_corner = b(:, :, 1)
      if (size(b, 3) == max_points) then
        at_corner = 0.0_rk
        do q = 1, max_points
          at_corner = at_corner + to_corner(a, q)*b(:, :, q)
        end do
      end if
      do c = 1, 8
        i = operator%row_start(node) - 1 + &
            findloc(operator%column(operator%row_start(node):operator%row_start(node + 1) - 1), &
                    nodes(c), dim=1)
        call add_entry(share*at_corner(:, num_directions*(c - 1) + 1:num_directions*c), i, operator)
      end do
    end do
  end subroutine add_element

  !> Adds the strain of the displacement of a node: the gradient, taken from the shears, and the
  !> remainder.
  subroutine add_entry(block, i, operator)
    real(rk), intent(in) :: block(6, 3) !< [1/m]
    integer, intent(in) :: i !< the entry
    type(nodal_operator), intent(inout) :: operator
    real(rk) :: g(3), rest(6, 3)
    integer :: j
    g = [block(4, 2), block(4, 1), block(5, 1)]
    operator%gradient(:, i) = operator%gradient(:, i) + g
    do j = 1, 3
      rest(:, j) = block(:, j) - strain_of_gradient(outer(unit(j), g))
    end do
    if (.not. maxval(abs(rest)) > smallest_rest*maxval(abs(block))) return
    if (size(operator%rest) == 0) then
      deallocate (operator%rest)
      allocate (operator%rest(6, 3, size(operator%column)), source=0.0_rk)
    end if
    operator%rest(:, :, i) = operator%rest(:, :, i) + rest
  end subroutine add_entry

  !> e11 e22 e33 g12 g13 g23 of du_i/dx_j.
  pure function strain_of_gradient(h) result(strain)
    real(rk), intent(in) :: h(3, 3) !< (i, j)
    real(rk) :: strain(6)
    strain = [h(1, 1), h(2, 2), h(3, 3), h(1, 2) + h(2, 1), h(1, 3) + h(3, 1), h(2, 3) + h(3, 2)]
  end function strain_of_gradient

  !> u_i g_j.
  pure function outer(u, g) result(h)
    real(rk), intent(in) :: u(3), g(3)
    real(rk) :: h(3, 3)
    h(:, 1) = u*g(1)
    h(:, 2) = u*g(2)
    h(:, 3) = u*g(3)
  end function outer

  !> The j-th unit vector.
  pure function unit(j)
    integer, intent(in) :: j
    real(rk) :: unit(3)
    unit = 0.0_rk
    unit(j) = 1.0_rk
  end function unit

  !> Stress on the nodes; zero at nodes without a solid.
  subroutine apply_operator(operator, u, stress)
    type(nodal_operator), intent(in) :: operator
    real(rk), intent(in) :: u(:, :) !< (3, nodes) [m]
    real(rk), intent(out) :: stress(:, :) !< (6, nodes) [Pa]
    integer :: node
    !$omp parallel do default(none) schedule(static) shared(operator, u, stress) &
    !$omp if (size(stress, 2) > fewest_for_threads)
    do node = 1, size(stress, 2)
      stress(:, node) = 0.0_rk
      if (operator%material(node) == 0) cycle
      stress(:, node) = matmul(operator%elastic(:, :, operator%material(node)), &
                               strain_at(operator, node, u))
    end do
    !$omp end parallel do
  end subroutine apply_operator

  !> Strain on a node.
  pure function strain_at(operator, node, u) result(strain)
    type(nodal_operator), intent(in) :: operator
    integer, intent(in) :: node
    real(rk), intent(in) :: u(:, :) !< (3, nodes) [m]
    real(rk) :: strain(6)
    real(rk) :: h(3, 3)
    integer :: i
    h = 0.0_rk
    do i = operator%row_start(node), operator%row_start(node + 1) - 1
      associate (g => operator%gradient(:, i), moved => u(:, operator%column(i)))
        h(:, 1) = h(:, 1) + moved*g(1)
        h(:, 2) = h(:, 2) + moved*g(2)
        h(:, 3) = h(:, 3) + moved*g(3)
      end associate
    end do
    strain = strain_of_gradient(h)
    if (size(operator%rest) == 0) return
    do i = operator%row_start(node), operator%row_start(node + 1) - 1
      strain = strain + matmul(operator%rest(:, :, i), u(:, operator%column(i)))
    end do
  end function strain_at
end module stress_operator
