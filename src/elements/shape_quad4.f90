!> The bilinear 4-node facet in space; a repeated node makes a triangle.
module shape_quad4
  use kinds, only: rk
  use gauss_rules, only: quad_point
  use small_matrix, only: cross_product
  implicit none
  private
  public :: facet_shape, facet_derivative, facet_point

  !> Natural coordinates of the corners.
  real(rk), parameter :: corner(2, 4) = reshape(real([-1, -1, 1, -1, 1, 1, -1, 1], rk), [2, 4])

contains

  !> Shape functions at a point.
  pure function facet_shape(xi) result(n)
    real(rk), intent(in) :: xi(2) !< natural coordinates
    real(rk) :: n(4)
    n = 0.25_rk*(1.0_rk + corner(1, :)*xi(1))*(1.0_rk + corner(2, :)*xi(2))
  end function facet_shape

  !> Their derivatives in the natural coordinates.
  pure function facet_derivative(xi) result(dn)
    real(rk), intent(in) :: xi(2) !< natural coordinates
    real(rk) :: dn(4, 2)
    dn(:, 1) = 0.25_rk*corner(1, :)*(1.0_rk + corner(2, :)*xi(2))
    dn(:, 2) = 0.25_rk*corner(2, :)*(1.0_rk + corner(1, :)*xi(1))
  end function facet_derivative

  !> One of the 2 x 2 Gauss points: shape functions and area vector (area times normal) [m2].
  pure subroutine facet_point(x, q, n, area)
    real(rk), intent(in) :: x(3, 4) !< corners [m]
    integer, intent(in) :: q !< 1..4
    real(rk), intent(out) :: n(4)
    real(rk), intent(out) :: area(3) !< by the right-hand rule
    n = facet_shape(quad_point(:, q))
    area = facet_area_vector(x, quad_point(:, q))
  end subroutine facet_point

  !> Area vector per unit of the natural coordinates [m2].
  pure function facet_area_vector(x, xi) result(area)
    real(rk), intent(in) :: x(3, 4) !< corners [m]
    real(rk), intent(in) :: xi(2)
    real(rk) :: area(3)
    real(rk) :: along(3, 2)
    along = matmul(x, facet_derivative(xi))
    area = cross_product(along(:, 1), along(:, 2))
  end function facet_area_vector
end module shape_quad4
