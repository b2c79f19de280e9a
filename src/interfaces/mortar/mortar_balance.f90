!> Lets a constant stress pass through a curved face: a small change of the weights of a mortar
!> projection (different_meshes.md, 13.2).
!>
!> The stress s puts s c_a on node a of the slave face, c_a = int N_a n dA, and s c_m on node m of
!> the master face. The rows hand on sum_a w_am s c_a. On a plane face that is s c_m; on a curved
!> one it is off by what the dual functions leave of a normal that turns within a facet, where one
!> mesh is not nested in the other. The weights are changed by the least dw, sum of squares, with
!>   sum_a dw_am c_a = c_m - sum_a w_am c_a,   sum_m dw_am = 0,   sum_m dw_am x_m = 0,
!> so that each row keeps to linear fields. With P, for each row, the projection on what leaves
!> 1 and x alone, dw = P C^T y and (C P C^T) y = r by conjugate gradients; the three conditions of a
!> node are combined beforehand so that their block of the matrix is the identity.
module mortar_balance
  use kinds, only: rk
  use mortar_table, only: mortar_rows
  implicit none
  private
  public :: balance_weights

  !> Nothing to do below this part of the largest nodal force: round-off.
  real(rk), parameter :: balanced = 1.0e-12_rk

  !> The search ends at this residual of the combined conditions, after so many steps, or so many
  !> without a smaller residual. The steps that it takes grow with the facets along a side squared
  !> (480 for 24); what is left of the error then falls with the third power of their size.
  real(rk), parameter :: solved = 1.0e-13_rk
  integer, parameter :: most_steps = 1000, patience = 200
  real(rk), parameter :: most_work = 1.0e8_rk !< steps times weights, a few seconds

  !> No weight changes by more; where that would be needed the weights stay as they are.
  real(rk), parameter :: largest_change = 0.25_rk

  !> A field of a row that the others imply but for this part is none.
  real(rk), parameter :: dependent = 1.0e-9_rk

  !> Normals that turn by less than this are round-off, and by less than so many times the digits of
  !> the nodes: a plane face whose nodes are rounded keeps its weights.
  real(rk), parameter :: least_turn = 1.0e-7_rk, digits_of_turn = 100.0_rk

  !> The conditions on dw.
  type :: conditions
    integer, allocatable :: column(:) !< (weights) number of their node among those that count
    integer, allocatable :: node(:) !< (columns)
    real(rk), allocatable :: basis(:, :) !< (4, weights) of 1 and x over each row, orthonormal
    real(rk), allocatable :: force(:, :) !< (3, weights) c_a, as combined for each column
    real(rk), allocatable :: combine(:, :, :) !< (3, 3, columns)
  end type conditions

contains

  !> Changes the weights where the forces of a constant stress ask for it.
  pure subroutine balance_weights(x, target_force, noise, rows)
    real(rk), intent(in) :: x(:, :) !< (3, nodes) [m]
    real(rk), intent(in) :: target_force(:, :) !< (3, nodes) c_m; -c_b at bound slave nodes [m2]
    real(rk), intent(in) :: noise !< how far the faces are from coinciding, part of a facet
    type(mortar_rows), intent(inout) :: rows
    type(conditions) :: system
    real(rk), allocatable :: missing(:, :), change(:)
    integer :: a, k
    if (rows%num_rows == 0) return
    call list_columns(rows, size(x, 2), system)
    allocate (system%force(3, size(rows%weight)))
    do a = 1, rows%num_rows
      do k = rows%first(a), rows%first(a + 1) - 1
        system%force(:, k) = rows%pressed(:, a)
      end do
    end do
    missing = target_force(:, system%node) - handed_on(system, rows%weight)
    if (maxval(abs(missing)) <= max(balanced, 10.0_rk*noise)*maxval(abs(target_force))) return
    call lay_conditions(x, max(least_turn, digits_of_turn*noise), rows, system)
    do k = 1, size(missing, 2)
      missing(:, k) = matmul(system%combine(:, :, k), missing(:, k))
    end do
    call solve(rows, system, missing, change)
    if (maxval(abs(change)) <= largest_change) rows%weight = rows%weight + change
  end subroutine balance_weights

  !> Numbers the nodes that rows see.
  pure subroutine list_columns(rows, num_nodes, system)
    type(mortar_rows), intent(in) :: rows
    integer, intent(in) :: num_nodes
    type(conditions), intent(inout) :: system
    integer, allocatable :: number(:)
    integer :: k, used
    allocate (number(num_nodes), source=0)
    allocate (system%column(size(rows%master)), system%node(size(rows%master)))
    used = 0
    do k = 1, size(rows%master)
      if (number(rows%master(k)) == 0) then
        used = used + 1
        number(rows%master(k)) = used
        system%node(used) = rows%master(k)
      end if
      system%column(k) = number(rows%master(k))
    end do
    system%node = system%node(:used)
  end subroutine list_columns

  !> C w: sum_a w_am c_a of each column.
  pure function handed_on(system, weight) result(force)
    type(conditions), intent(in) :: system
    real(rk), intent(in) :: weight(:)
    real(rk) :: force(3, size(system%node))
    integer :: k
    force = 0.0_rk
    do k = 1, size(weight)
      force(:, system%column(k)) = force(:, system%column(k)) + weight(k)*system%force(:, k)
    end do
  end function handed_on

  !> The bases of the rows, and the conditions of each column combined by the inverse of Cholesky's
  !> factor of their block of C P C^T.
  pure subroutine lay_conditions(x, turn, rows, system)
    real(rk), intent(in) :: x(:, :)
    real(rk), intent(in) :: turn !< normals that turn by less are equal
    type(mortar_rows), intent(in) :: rows
    type(conditions), intent(inout) :: system
    real(rk) :: part
    integer :: a, k, i, c
    allocate (system%basis(4, size(rows%master)), source=0.0_rk)
    allocate (system%combine(3, 3, size(system%node)), source=0.0_rk)
    do a = 1, rows%num_rows
      associate (first => rows%first(a), last => rows%first(a + 1) - 1)
        call lay_basis(x(:, rows%master(first:last)), system%basis(:, first:last))
      end associate
    end do
    do k = 1, size(rows%master)
      c = system%column(k)
      part = max(0.0_rk, 1.0_rk - sum(system%basis(:, k)**2))
      do i = 1, 3
        system%combine(:, i, c) = system%combine(:, i, c) &
                                  + part*system%force(i, k)*system%force(:, k)
      end do
    end do
    do c = 1, size(system%node)
      call factor_block(turn**2, system%combine(:, :, c))
    end do
    do k = 1, size(rows%master)
      system%force(:, k) = matmul(system%combine(:, :, system%column(k)), system%force(:, k))
    end do
  end subroutine lay_conditions

  !> An orthonormal basis of 1 and x over the nodes of a row, by Gram and Schmidt, twice; zero in
  !> place of fields that depend on those before.
  pure subroutine lay_basis(x, basis)
    real(rk), intent(in) :: x(:, :) !< (3, nodes)
    real(rk), intent(inout) :: basis(:, :) !< (4, nodes)
    real(rk) :: field(size(x, 2)), centred(3, size(x, 2))
    integer :: i, j, again
    centred = x - spread(sum(x, dim=2)/size(x, 2), 2, size(x, 2))
    do i = 1, 4
      field = 1.0_rk
      if (i > 1) field = centred(i - 1, :)
      do again = 1, 2
        do j = 1, i - 1
          field = field - dot_product(basis(j, :), field)*basis(j, :)
        end do
      end do
      if (i == 1 .or. norm2(field) > dependent*norm2(centred)) basis(i, :) = field/norm2(field)
    end do
  end subroutine lay_basis

  !> Replaces a block by the inverse of its Cholesky factor; rows of dependent conditions become 0.
  pure subroutine factor_block(least, block)
    real(rk), intent(in) :: least !< part of the largest diagonal that a pivot must exceed
    real(rk), intent(inout) :: block(3, 3)
    real(rk) :: lower(3, 3), pivot, largest
    integer :: i, j
    largest = max(block(1, 1), block(2, 2), block(3, 3))
    lower = 0.0_rk
    do j = 1, 3
      pivot = block(j, j) - sum(lower(j, :j - 1)**2)
      if (pivot <= least*largest .or. largest <= 0.0_rk) cycle
      lower(j, j) = sqrt(pivot)
      do i = j + 1, 3
        lower(i, j) = (block(i, j) - dot_product(lower(i, :j - 1), lower(j, :j - 1)))/lower(j, j)
      end do
    end do
    block = 0.0_rk
    do j = 1, 3
      if (lower(j, j) <= 0.0_rk) cycle
      block(j, j) = 1.0_rk/lower(j, j)
      do i = j + 1, 3
        if (lower(i, i) <= 0.0_rk) cycle
        block(i, j) = -dot_product(lower(i, j:i - 1), block(j:i - 1, j))/lower(i, i)
      end do
    end do
  end subroutine factor_block

  !> dw by conjugate gradients; the best on the way, for round-off has them part in the end.
  pure subroutine solve(rows, system, missing, change)
    type(mortar_rows), intent(in) :: rows
    type(conditions), intent(in) :: system
    real(rk), intent(in) :: missing(:, :) !< (3, columns) r, as combined
    real(rk), allocatable, intent(out) :: change(:) !< (weights)
    real(rk), dimension(3, size(missing, 2)) :: residual, direction
    real(rk) :: step(size(rows%weight)), sum_of_steps(size(rows%weight))
    real(rk) :: product, before, length, curvature, least
    integer :: i, best
    sum_of_steps = 0.0_rk
    change = sum_of_steps
    residual = missing
    direction = 0.0_rk
    product = sum(residual**2)
    before = product
    least = product
    best = 0
    do i = 1, min(most_steps, int(most_work/size(step)))
      direction = residual + merge(0.0_rk, product/before, i == 1)*direction
      call change_along(rows, system, direction, step)
      curvature = sum(step**2)
      if (.not. curvature > 0.0_rk) return
      length = product/curvature
      sum_of_steps = sum_of_steps + length*step
      residual = residual - length*handed_on(system, step)
      before = product
      product = sum(residual**2)
      if (product < least) then
        least = product
        change = sum_of_steps
        best = i
      end if
      if (maxval(abs(residual)) <= solved .or. i > best + patience) return
    end do
  end subroutine solve

  !> P C^T y.
  pure subroutine change_along(rows, system, y, step)
    type(mortar_rows), intent(in) :: rows
    type(conditions), intent(in) :: system
    real(rk), intent(in) :: y(:, :) !< (3, columns)
    real(rk), intent(out) :: step(:) !< (weights)
    integer :: a, k, i, last
    do a = 1, rows%num_rows
      last = rows%first(a + 1) - 1
      do k = rows%first(a), last
        step(k) = dot_product(system%force(:, k), y(:, system%column(k)))
      end do
      do i = 1, 4
        associate (field => system%basis(i, rows%first(a):last), own => step(rows%first(a):last))
          own = own - dot_product(field, own)*field
        end associate
      end do
    end do
  end subroutine change_along
end module mortar_balance
