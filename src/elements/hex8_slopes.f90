!> Slopes of the shape functions of a hexahedron at its 2 x 2 x 2 points, and what follows from them
!> for elements whose strain is the symmetric gradient at each point: stiffness and strains.
!>
!> Arrays have the points first, so that loops over the points are vector instructions.
module hex8_slopes
  use kinds, only: rk
  use shape_hex8, only: corner_fault, corner_of_point, hex8_dofs, point_derivative
  implicit none
  private
  public :: slopes_at_points, stiffness_of_slopes, strains_of_slopes, add_forces_of_slopes

  integer, parameter :: num_points = 8

  !> Derivatives of the shape functions in the natural coordinates; (point, direction, corner).
  real(rk), parameter :: natural_slope(8, 3, 8) = reshape(point_derivative, [8, 3, 8], &
                                                          order=[3, 1, 2])

  !> Position of the strain ij in the order 11 22 33 12 13 23.
  integer, parameter :: strain_of(3, 3) = reshape([1, 4, 5, 4, 2, 6, 5, 6, 3], [3, 3])

contains

  !> Slopes of the shape functions in space, and volumes of the points.
  pure subroutine slopes_at_points(x, slope, weight, status)
    real(rk), intent(in) :: x(3, 8) !< corners [m]
    real(rk), intent(out) :: slope(8, 3, 8) !< (point, direction, node) [1/m]
    real(rk), intent(out) :: weight(8) !< [m3]
    integer, intent(out) :: status !< 0, or the worst corner when a point's Jacobian is <= 0
    real(rk) :: jacobian(8, 3, 3), inverse(8, 3, 3), scale(8)
    integer :: a, i, j
    jacobian = 0.0_rk
    do a = 1, 8
      do j = 1, 3
        do i = 1, 3
          jacobian(:, i, j) = jacobian(:, i, j) + natural_slope(:, i, a)*x(j, a)
        end do
      end do
    end do
    call find_cofactors(jacobian, inverse)
    weight = jacobian(:, 1, 1)*inverse(:, 1, 1) + jacobian(:, 1, 2)*inverse(:, 2, 1) &
             + jacobian(:, 1, 3)*inverse(:, 3, 1)
    scale = 0.0_rk
    where (abs(weight) > tiny(scale)) scale = 1.0_rk/weight
    do j = 1, 3
      do i = 1, 3
        inverse(:, i, j) = inverse(:, i, j)*scale
      end do
    end do
    do a = 1, 8
      do i = 1, 3
        slope(:, i, a) = inverse(:, i, 1)*natural_slope(:, 1, a) &
                         + inverse(:, i, 2)*natural_slope(:, 2, a) &
                         + inverse(:, i, 3)*natural_slope(:, 3, a)
      end do
    end do
    status = 0
    if (minval(weight) > 0.0_rk) return
    status = corner_fault(x)
    if (status == 0) status = corner_of_point(minloc(weight, 1))
  end subroutine slopes_at_points

  !> Transposed cofactors of 3 x 3 matrices: their inverses times their determinants.
  pure subroutine find_cofactors(matrix, cofactor)
    real(rk), intent(in) :: matrix(8, 3, 3) !< (point, row, column)
    real(rk), intent(out) :: cofactor(8, 3, 3)
    integer, parameter :: next(3) = [2, 3, 1], after(3) = [3, 1, 2]
    integer :: i, j
    do j = 1, 3
      do i = 1, 3
        cofactor(:, i, j) = matrix(:, next(j), next(i))*matrix(:, after(j), after(i)) &
                            - matrix(:, next(j), after(i))*matrix(:, after(j), next(i))
      end do
    end do
  end subroutine find_cofactors

  !> K = sum w B^T D B of one element. With P_kl(a, b) = sum w g_k(a) g_l(b), g the slopes, the
  !> stiffness of the directions i and j is the sum of D(ik, jl) P_kl.
  pure subroutine stiffness_of_slopes(slope, weight, d, stiffness)
    real(rk), intent(in) :: slope(8, 3, 8) !< (point, direction, node) [1/m]
    real(rk), intent(in) :: weight(8) !< positive [m3]
    real(rk), intent(in) :: d(6, 6) !< elastic stiffness [Pa]
    real(rk), intent(out) :: stiffness(hex8_dofs, hex8_dofs) !< symmetric [N/m]
    real(rk) :: product(8, 8, 3, 3), block(8, 8), factor
    integer :: a, i, j, k, l
    call multiply_slopes(slope, weight, product)
    do j = 1, 3
      do i = j, 3
        block = 0.0_rk
        do l = 1, 3
          do k = 1, 3
            factor = d(strain_of(i, k), strain_of(j, l))
            if (abs(factor) > 0.0_rk) block = block + factor*product(:, :, k, l)
          end do
        end do
        if (i == j) then
          do a = 2, 8
            block(:a - 1, a) = block(a, :a - 1)
          end do
        end if
        do a = 1, 8
          stiffness(i::3, 3*(a - 1) + j) = block(:, a)
          stiffness(j::3, 3*(a - 1) + i) = block(a, :)
        end do
      end do
    end do
  end subroutine stiffness_of_slopes

  !> P_kl(a, b) = sum w g_k(a) g_l(b) over the points.
  pure subroutine multiply_slopes(slope, weight, product)
    real(rk), intent(in) :: slope(8, 3, 8)
    real(rk), intent(in) :: weight(8)
    real(rk), intent(out) :: product(8, 8, 3, 3) !< (a, b, k, l)
    real(rk) :: of_node(8, 8, 3) ! (node, point, direction)
    integer :: q, k, l
    do q = 1, num_points
      do k = 1, 3
        of_node(:, q, k) = sqrt(max(0.0_rk, weight(q)))*slope(q, k, :)
      end do
    end do
    do l = 1, 3
      do k = l, 3
        call multiply_nodes(of_node(:, :, k), of_node(:, :, l), product(:, :, k, l))
        if (k > l) product(:, :, l, k) = transpose(product(:, :, k, l))
      end do
    end do
  end subroutine multiply_slopes

  !> A B^T, in columns of four that stay in registers.
  pure subroutine multiply_nodes(a, b, product)
    real(rk), intent(in) :: a(8, 8), b(8, 8) !< (node, point)
    real(rk), intent(out) :: product(8, 8)
    real(rk) :: sums(8, 4)
    integer :: first, q, c
    do first = 1, 8, 4
      sums = 0.0_rk
      do q = 1, num_points
        do c = 1, 4
          sums(:, c) = sums(:, c) + a(:, q)*b(first + c - 1, q)
        end do
      end do
      product(:, first:first + 3) = sums
    end do
  end subroutine multiply_nodes

  !> The symmetric gradient of displacements at the points.
  pure subroutine strains_of_slopes(slope, u, strain)
    real(rk), intent(in) :: slope(8, 3, 8) !< (point, direction, node) [1/m]
    real(rk), intent(in) :: u(hex8_dofs) !< [m]
    real(rk), intent(out) :: strain(6, 8)
    real(rk) :: sums(8, 6)
    integer :: a, n
    sums = 0.0_rk
    do a = 1, 8
      n = 3*a - 2
      sums(:, 1) = sums(:, 1) + slope(:, 1, a)*u(n)
      sums(:, 2) = sums(:, 2) + slope(:, 2, a)*u(n + 1)
      sums(:, 3) = sums(:, 3) + slope(:, 3, a)*u(n + 2)
      sums(:, 4) = sums(:, 4) + slope(:, 2, a)*u(n) + slope(:, 1, a)*u(n + 1)
      sums(:, 5) = sums(:, 5) + slope(:, 3, a)*u(n) + slope(:, 1, a)*u(n + 2)
      sums(:, 6) = sums(:, 6) + slope(:, 3, a)*u(n + 1) + slope(:, 2, a)*u(n + 2)
    end do
    strain = transpose(sums)
  end subroutine strains_of_slopes

  !> Adds the forces of stresses at the points: the transpose of strains_of_slopes.
  pure subroutine add_forces_of_slopes(slope, stress, force)
    real(rk), intent(in) :: slope(8, 3, 8) !< (point, direction, node) [1/m]
    real(rk), intent(in) :: stress(8, 6) !< (point, component) times volumes of points [N m]
    real(rk), intent(inout) :: force(hex8_dofs) !< [N]
    real(rk) :: sums(8, 3)
    integer :: a, q
    do a = 1, 8
      sums(:, 1) = slope(:, 1, a)*stress(:, 1) + slope(:, 2, a)*stress(:, 4) &
                   + slope(:, 3, a)*stress(:, 5)
      sums(:, 2) = slope(:, 2, a)*stress(:, 2) + slope(:, 1, a)*stress(:, 4) &
                   + slope(:, 3, a)*stress(:, 6)
      sums(:, 3) = slope(:, 3, a)*stress(:, 3) + slope(:, 1, a)*stress(:, 5) &
                   + slope(:, 2, a)*stress(:, 6)
      do q = 1, num_points
        force(3*a - 2:3*a) = force(3*a - 2:3*a) + sums(q, :)
      end do
    end do
  end subroutine add_forces_of_slopes
end module hex8_slopes
