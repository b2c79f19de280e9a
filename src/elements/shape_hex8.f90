!> The trilinear 8-node hexahedron: shape functions, gradients, and a check of its corners.
module shape_hex8
  use kinds, only: rk
  use node_dofs, only: num_directions
  use gauss_rules, only: hex_point
  use small_matrix, only: determinant3, invert3
  implicit none
  private
  public :: hex8_dofs, corner, point_shape, point_derivative
  public :: shape_at, derivative_at, edges_at, gradient_at, mean_gradient, strain_rows
  public :: corner_fault, corner_of_point, corners_from_points, edge_end

  integer, parameter :: num_corners = 8
  !> Number of displacements of an element, the only unknowns of its matrices.
  integer, parameter :: hex8_dofs = num_directions*num_corners

  !> Natural coordinates of the corners.
  real(rk), parameter :: corner(3, 8) = reshape(real([-1, -1, -1, 1, -1, -1, 1, 1, -1, &
                                                      -1, 1, -1, -1, -1, 1, 1, -1, 1, &
                                                      1, 1, 1, -1, 1, 1], rk), [3, 8])

  !> The corner next to each integration point.
  integer, parameter :: corner_of_point(8) = [1, 2, 4, 3, 5, 6, 8, 7]

  !> 1 + (coordinate of the corner)*(coordinate of the point); (corner, point).
  real(rk), parameter :: s1(8, 8) = &
                         1.0_rk + spread(corner(1, :), 2, 8)*spread(hex_point(1, :), 1, 8)
  real(rk), parameter :: s2(8, 8) = &
                         1.0_rk + spread(corner(2, :), 2, 8)*spread(hex_point(2, :), 1, 8)
  real(rk), parameter :: s3(8, 8) = &
                         1.0_rk + spread(corner(3, :), 2, 8)*spread(hex_point(3, :), 1, 8)

  !> Shape functions at the integration points; (corner, point).
  real(rk), parameter :: point_shape(8, 8) = 0.125_rk*s1*s2*s3

  !> Their derivatives in the natural coordinates; (corner, point, direction).
  real(rk), parameter :: point_derivative(8, 8, 3) = &
                         reshape([0.125_rk*spread(corner(1, :), 2, 8)*s2*s3, &
                                  0.125_rk*spread(corner(2, :), 2, 8)*s1*s3, &
                                  0.125_rk*spread(corner(3, :), 2, 8)*s1*s2], [8, 8, 3])

  !> The ends of the three edges of each corner, in right-handed order.
  integer, parameter :: edge_end(3, 8) = reshape([2, 4, 5, 3, 1, 6, 4, 2, 7, 1, 3, 8, &
                                                  8, 6, 1, 5, 7, 2, 6, 8, 3, 7, 5, 4], [3, 8])

  !> A Jacobian below this fraction of the product of the edges counts as zero.
  real(rk), parameter :: flat_corner = 1.0e-10_rk

contains

  !> Shape functions at a point.
  pure function shape_at(xi) result(n)
    real(rk), intent(in) :: xi(3) !< natural coordinates
    real(rk) :: n(8)
    n = 0.125_rk*(1.0_rk + corner(1, :)*xi(1))*(1.0_rk + corner(2, :)*xi(2)) &
        *(1.0_rk + corner(3, :)*xi(3))
  end function shape_at

  !> Their derivatives in the natural coordinates.
  pure function derivative_at(xi) result(dn)
    real(rk), intent(in) :: xi(3) !< natural coordinates
    real(rk) :: dn(8, 3)
    real(rk) :: s(8, 3)
    integer :: i
    do i = 1, 3
      s(:, i) = 1.0_rk + corner(i, :)*xi(i)
    end do
    dn(:, 1) = 0.125_rk*corner(1, :)*s(:, 2)*s(:, 3)
    dn(:, 2) = 0.125_rk*corner(2, :)*s(:, 1)*s(:, 3)
    dn(:, 3) = 0.125_rk*corner(3, :)*s(:, 1)*s(:, 2)
  end function derivative_at

  !> The edge vectors of a brick at one of its points: columns 2 dx/dxi_i; the edges themselves for
  !> a parallelepiped.
  pure function edges_at(x, xi) result(edges)
    real(rk), intent(in) :: x(3, 8) !< corners [m]
    real(rk), intent(in) :: xi(3) !< natural coordinates
    real(rk) :: edges(3, 3)
    edges = 2.0_rk*matmul(x, derivative_at(xi))
  end function edges_at

  !> Gradients of the shape functions in space, and the determinant of the Jacobian.
  pure subroutine gradient_at(x, dn, gradient, determinant)
    real(rk), intent(in) :: x(3, 8) !< corners [m]
    real(rk), intent(in) :: dn(8, 3) !< derivatives in the natural coordinates
    real(rk), intent(out) :: gradient(3, 8) !< [1/m]
    real(rk), intent(out) :: determinant !< [m3]
    real(rk) :: jacobian(3, 3), inverse(3, 3)
    integer :: a, i, j
    do j = 1, 3
      do i = 1, 3
        jacobian(i, j) = sum(dn(:, i)*x(j, :))
      end do
    end do
    call invert3(jacobian, inverse, determinant)
    do a = 1, 8
      gradient(:, a) = inverse(:, 1)*dn(a, 1) + inverse(:, 2)*dn(a, 2) + inverse(:, 3)*dn(a, 3)
    end do
  end subroutine gradient_at

  !> Gradients averaged over the volume (exact), and the volume.
  pure subroutine mean_gradient(gradient, weight, mean, volume)
    real(rk), intent(in) :: gradient(3, 8, 8) !< at the 2 x 2 x 2 points [1/m]
    real(rk), intent(in) :: weight(8) !< volume of each point [m3]
    real(rk), intent(out) :: mean(3, 8) !< [1/m]
    real(rk), intent(out) :: volume !< [m3]
    integer :: q
    mean = 0.0_rk
    do q = 1, 8
      mean = mean + weight(q)*gradient(:, :, q)
    end do
    volume = sum(weight)
    mean = mean/volume
  end subroutine mean_gradient

  !> Strain-displacement rows (order 11 22 33 12 13 23) of shape functions with these gradients.
  pure subroutine strain_rows(gradient, b)
    real(rk), contiguous, intent(in) :: gradient(:, :) !< (3, functions) [1/m]
    real(rk), contiguous, intent(out) :: b(:, :) !< (6, directions*functions) [1/m]
    integer :: a, i
    b = 0.0_rk
    do a = 1, size(gradient, 2)
      i = num_directions*(a - 1) + 1
      b(1, i) = gradient(1, a)
      b(4, i) = gradient(2, a)
      b(5, i) = gradient(3, a)
      b(2, i + 1) = gradient(2, a)
      b(4, i + 1) = gradient(1, a)
      b(6, i + 1) = gradient(3, a)
      b(3, i + 2) = gradient(3, a)
      b(5, i + 2) = gradient(1, a)
      b(6, i + 2) = gradient(2, a)
    end do
  end subroutine strain_rows

  !> The corner with the lowest Jacobian if that is zero or negative, else 0.
  !>
  !> An element can be integrated as long as the Jacobian is positive at its points (the patch of
  !> MacNeal & Harder has a negative corner); such a corner gives a warning. Corners on collapsed
  !> edges (wedges made by repeated nodes) have no Jacobian and are left out.
  pure integer function corner_fault(x) result(fault)
    real(rk), intent(in) :: x(3, 8) !< [m]
    real(rk) :: edge(3, 3), jacobian, lowest, lengths
    integer :: a, i
    fault = 0
    lowest = flat_corner
    do a = 1, 8
      do i = 1, 3
        edge(:, i) = x(:, edge_end(i, a)) - x(:, a)
      end do
      lengths = norm2(edge(:, 1))*norm2(edge(:, 2))*norm2(edge(:, 3))
      if (lengths <= 0.0_rk) cycle
      jacobian = determinant3(edge)
      if (jacobian/lengths >= lowest) cycle
      lowest = jacobian/lengths
      fault = a
    end do
  end function corner_fault

  !> Matrix that extrapolates values from the 2 x 2 x 2 points to the corners, exact for trilinear
  !> fields.
  pure function corners_from_points() result(matrix)
    real(rk) :: matrix(8, 8) !< (corner, point)
    integer :: a
    do a = 1, 8
      matrix(a, :) = 0.125_rk*(1.0_rk + 3.0_rk*corner(1, a)*hex_point(1, :)) &
                     *(1.0_rk + 3.0_rk*corner(2, a)*hex_point(2, :)) &
                     *(1.0_rk + 3.0_rk*corner(3, a)*hex_point(3, :))
    end do
  end function corners_from_points
end module shape_hex8
