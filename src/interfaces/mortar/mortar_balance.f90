!> Changes the weights of a mortar projection slightly, so that a curved face transmits a constant
!> stress (different_meshes.md, 13.2).
!>
!> The stress s gives the forces s c_a at node a of the slave face, c_a = int N_a n dA, and s c_m at
!> node m of the master face. The rows transmit sum_a w_am s c_a. On a plane face this equals s c_m.
!> On a curved face with meshes that are not nested it differs, because the normal varies within a
!> facet. The weights are changed by the dw of least squares with
!>   sum_a dw_am c_a = c_m - sum_a w_am c_a,   sum_m dw_am = 0,   sum_m dw_am x_m = 0,
!> so that each row stays exact for linear fields. P is, for each row, the projection orthogonal to
!> 1 and x. Then dw = P C^T y, and (C P C^T) y = r is solved by conjugate gradients. The three
!> conditions of a node are combined beforehand so that their block of the matrix is the identity.
module mortar_balance
  use kinds, only: rk
  use row_tables, only: weighted_rows
  implicit none
  private
  public :: balance_weights, mortar_rows

  !> The rows of a mortar projection (different_meshes.md, 13.2). Row a gives the displacement of
  !> the master face opposite a node of the slave face, from nodes of the master face and bound ones
  !> of the slave face; the weights add up to 1.
  type, extends(weighted_rows) :: mortar_rows
    integer, allocatable :: node(:) !< (rows) node of the slave face
    real(rk), allocatable :: area(:) !< (rows) A_a = int N_a dA [m2]
    real(rk), allocatable :: pressed(:, :) !< (3, rows) int N_a n dA: force of a unit pressure [m2]
    real(rk), allocatable :: normal(:, :) !< (3, rows) unit, out of the slave's solid
    real(rk), allocatable :: gap(:) !< (rows) (1/A_a) int phi_a gap dA, from slave to master [m]
    real(rk), allocatable :: facet_size(:) !< (rows) shortest side of the facets that meet there [m]
    logical, allocatable :: is_bare(:) !< (slave facets) too little covered to be used
  end type mortar_rows

  !> Differences below this fraction of the largest nodal force are round-off.
  real(rk), parameter :: balanced = 1.0e-12_rk

  !> The search ends at this residual of the combined conditions, after so many steps, or after so
  !> many without a smaller residual. The number of steps grows with the square of the number of
  !> facets along a side (480 for 24); the error left falls with the third power of the facet size.
  real(rk), parameter :: solved = 1.0e-13_rk
  integer, parameter :: most_steps = 1000, patience = 200
  real(rk), parameter :: most_work = 1.0e8_rk !< steps times weights: seconds

  !> Largest change of a weight; if more is needed, all weights stay unchanged.
  real(rk), parameter :: largest_change = 0.25_rk

  !> A field of a row that depends on the others to this fraction is left out.
  real(rk), parameter :: dependent = 1.0e-9_rk

  !> Normals that differ by less are equal: this for round-off, and so many times the rounding of
  !> the nodes, so that a plane face with rounded nodes keeps its weights.
  real(rk), parameter :: least_turn = 1.0e-7_rk, digits_of_turn = 100.0_rk

  !> The conditions on dw.
  type :: conditions
    integer, allocatable :: column(:) !< (weights) number of their node among the columns
    integer, allocatable :: node(:) !< (columns)
    real(rk), allocatable :: basis(:, :) !< (4, weights) of 1 and x over each row, orthonormal
    real(rk), allocatable :: force(:, :) !< (3, weights) c_a, as combined for each column
    real(rk), allocatable :: combine(:, :, :) !< (3, 3, columns)
  end type conditions

contains

  !> Changes the weights if the transmitted forces of a constant stress differ from the target.
  pure subroutine balance_weights(x, target_force, noise, rows)
    real(rk), intent(in) :: x(:, :) !< (3, nodes) [m]
    real(rk), intent(in) :: target_force(:, :) !< (3, nodes) c_m; -c_b at bound slave nodes [m2]
    real(rk), intent(in) :: noise !< distance of the faces over a facet's size
    type(mortar_rows), intent(inout) :: rows
    type(conditions) :: system
    real(rk), allocatable :: missing(:, :), change(:)
    integer :: a, k
    if (rows%num_rows() == 0) return
    call list_columns(rows, size(x, 2), system)
    allocate (system%force(3, size(rows%weight)))
    do a = 1, rows%num_rows()
      do k = rows%first(a), rows%first(a + 1) - 1
        system%force(:, k) = rows%pressed(:, a)
      end do
    end do
    missing = target_force(:, system%node) - transmitted_force(system, rows%weight)
    if (maxval(abs(missing)) <= max(balanced, 10.0_rk*noise)*maxval(abs(target_force))) return
    call build_conditions(x, max(least_turn, digits_of_turn*noise), rows, system)
    do k = 1, size(missing, 2)
      missing(:, k) = matmul(system%combine(:, :, k), missing(:, k))
    end do
    call solve_balance(rows, system, missing, change)
    if (maxval(abs(change)) <= largest_change) rows%weight = rows%weight + change
  end subroutine balance_weights

  !> Numbers the nodes of the rows.
  pure subroutine list_columns(rows, num_nodes, system)
    type(mortar_rows), intent(in) :: rows
    integer, intent(in) :: num_nodes
    type(conditions), intent(inout) :: system
    integer, allocatable :: number(:)
    integer :: k, used
    allocate (number(num_nodes), source=0)
    allocate (system%column(size(rows%item)), system%node(size(rows%item)))
    used = 0
    do k = 1, size(rows%item)
      if (number(rows%item(k)) == 0) then
        used = used + 1
        number(rows%item(k)) = used
        system%node(used) = rows%item(k)
      end if
      system%column(k) = number(rows%item(k))
    end do
    system%node = system%node(:used)
  end subroutine list_columns

  !> C w: sum_a w_am c_a of each column.
  pure function transmitted_force(system, weight) result(force)
    type(conditions), intent(in) :: system
    real(rk), intent(in) :: weight(:)
    real(rk) :: force(3, size(system%node))
    integer :: k
    force = 0.0_rk
    do k = 1, size(weight)
      force(:, system%column(k)) = force(:, system%column(k)) + weight(k)*system%force(:, k)
    end do
  end function transmitted_force

  !> The bases of the rows, and the conditions of each column combined by the inverse of Cholesky's
  !> factor of their block of C P C^T.
  pure subroutine build_conditions(x, turn, rows, system)
    real(rk), intent(in) :: x(:, :)
    real(rk), intent(in) :: turn !< normals that differ by less are equal
    type(mortar_rows), intent(in) :: rows
    type(conditions), intent(inout) :: system
    real(rk) :: part
    integer :: a, k, i, c
    allocate (system%basis(4, size(rows%item)), source=0.0_rk)
    allocate (system%combine(3, 3, size(system%node)), source=0.0_rk)
    do a = 1, rows%num_rows()
      associate (first => rows%first(a), last => rows%first(a + 1) - 1)
        call build_basis(x(:, rows%item(first:last)), system%basis(:, first:last))
      end associate
    end do
    do k = 1, size(rows%item)
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
    do k = 1, size(rows%item)
      system%force(:, k) = matmul(system%combine(:, :, system%column(k)), system%force(:, k))
    end do
  end subroutine build_conditions

  !> An orthonormal basis of 1 and x over the nodes of a row, by Gram-Schmidt applied twice; zero
  !> for fields that depend on earlier ones.
  pure subroutine build_basis(x, basis)
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
  end subroutine build_basis

  !> Replaces a block by the inverse of its Cholesky factor; rows of dependent conditions become 0.
  pure subroutine factor_block(least, block)
    real(rk), intent(in) :: least !< fraction of the largest diagonal that a pivot must exceed
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

  !> dw by conjugate gradients: the iterate of least residual, since round-off makes them diverge in
  !> the end.
  pure subroutine solve_balance(rows, system, missing, change)
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
      residual = residual - length*transmitted_force(system, step)
      before = product
      product = sum(residual**2)
      if (product < least) then
        least = product
        change = sum_of_steps
        best = i
      end if
      if (maxval(abs(residual)) <= solved .or. i > best + patience) return
    end do
  end subroutine solve_balance

  !> P C^T y.
  pure subroutine change_along(rows, system, y, step)
    type(mortar_rows), intent(in) :: rows
    type(conditions), intent(in) :: system
    real(rk), intent(in) :: y(:, :) !< (3, columns)
    real(rk), intent(out) :: step(:) !< (weights)
    integer :: a, k, i, last
    do a = 1, rows%num_rows()
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
