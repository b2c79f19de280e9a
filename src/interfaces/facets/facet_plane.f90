!> The mean plane of a facet, the projection of facets on it, and natural coordinates of its points.
!>
!> The projection is linear, so a bilinear facet stays bilinear: its shape functions at a point of
!> the plane are those at the point of the facet above or below (different_meshes.md, 13.1).
module facet_plane
  use kinds, only: rk
  use mesh_faces, only: face_vector
  use shape_quad4, only: facet_derivative, facet_shape
  use small_matrix, only: cross_product, solve2
  implicit none
  private
  public :: plane, flat_facet, find_plane, project_facet, shape_at, natural_at, plane_area
  public :: stretch_at, area_element, facet_pair

  type :: plane
    real(rk) :: origin(3) = 0.0_rk !< mean of the corners [m]
    real(rk) :: normal(3) = 0.0_rk !< unit, right-hand rule; 0 for a facet without area
    real(rk) :: axis(3, 2) = 0.0_rk !< unit, in the plane; axis 1 x axis 2 = normal
  end type plane

  !> A facet projected on a plane: p = centre + along xi + twist xi_1 xi_2.
  type :: flat_facet
    integer :: num_corners = 0 !< 4, 3 when two neighbours are equal, else 0: no facet
    integer :: double = 0 !< triangle: the corner that the next one repeats
    real(rk) :: corner(2, 4) = 0.0_rk !< the different ones, anticlockwise
    logical :: is_turned = .false. !< its normal is opposite to the plane's normal
    real(rk) :: centre(2) = 0.0_rk, along(2, 2) = 0.0_rk, twist(2) = 0.0_rk
    logical :: is_affine = .true. !< no twist beyond round-off: parallelogram or triangle
  end type flat_facet

  !> A slave and a master facet on the slave facet's plane.
  type :: facet_pair
    real(rk) :: slave(3, 4), master(3, 4) !< corners [m]
    type(plane) :: ground !< of the slave facet
    type(flat_facet) :: own, other !< the slave and the master facet on it
    real(rk) :: turn = 1.0_rk !< -1: the slave facet's normal points into the master
  end type facet_pair

  !> A twist below this fraction of the sides is round-off of the projection.
  real(rk), parameter :: no_twist = 64.0_rk*epsilon(1.0_rk)

contains

  !> The mean plane of a facet.
  pure subroutine find_plane(x, found)
    real(rk), intent(in) :: x(3, 4) !< corners [m]
    type(plane), intent(out) :: found
    real(rk) :: vector(3), along(3)
    found%origin = sum(x, dim=2)/4.0_rk
    vector = face_vector(x)
    if (norm2(vector) <= tiny(1.0_rk)) return
    found%normal = vector/norm2(vector)
    along = x(:, 3) - x(:, 1)
    along = along - dot_product(along, found%normal)*found%normal
    found%axis(:, 1) = along/norm2(along)
    found%axis(:, 2) = cross_product(found%normal, found%axis(:, 1))
  end subroutine find_plane

  !> Projects a facet along the plane's normal.
  pure subroutine project_facet(on, x, flat)
    type(plane), intent(in) :: on
    real(rk), intent(in) :: x(3, 4) !< corners [m]
    type(flat_facet), intent(out) :: flat
    real(rk) :: p(2, 4)
    integer :: a, next
    do a = 1, 4
      p(:, a) = matmul(x(:, a) - on%origin, on%axis)
    end do
    do a = 1, 4
      next = mod(a, 4) + 1
      if (norm2(x(:, a) - x(:, next)) <= 0.0_rk) then
        if (flat%double == 0) flat%double = a
      else
        flat%num_corners = flat%num_corners + 1
        flat%corner(:, flat%num_corners) = p(:, a)
      end if
    end do
    if (flat%num_corners < 3) flat%num_corners = 0
    if (flat%num_corners == 0) return
    flat%is_turned = plane_area(flat%corner(:, :flat%num_corners)) < 0.0_rk
    if (flat%is_turned) flat%corner(:, :flat%num_corners) = flat%corner(:, flat%num_corners:1:-1)
    if (flat%num_corners == 4) then
      flat%centre = 0.25_rk*sum(p, dim=2)
      flat%along(:, 1) = 0.25_rk*(p(:, 2) + p(:, 3) - p(:, 1) - p(:, 4))
      flat%along(:, 2) = 0.25_rk*(p(:, 3) + p(:, 4) - p(:, 1) - p(:, 2))
      flat%twist = 0.25_rk*(p(:, 1) + p(:, 3) - p(:, 2) - p(:, 4))
      flat%is_affine = norm2(flat%twist) <= no_twist*minval(norm2(flat%along, dim=1))
    else
      ! Barycentric coordinates of the two corners after the double one.
      flat%centre = p(:, flat%double)
      flat%along(:, 1) = p(:, mod(flat%double + 1, 4) + 1) - flat%centre
      flat%along(:, 2) = p(:, mod(flat%double + 2, 4) + 1) - flat%centre
    end if
  end subroutine project_facet

  !> Area of a polygon, positive anticlockwise [m2].
  pure real(rk) function plane_area(corner)
    real(rk), intent(in) :: corner(:, :) !< (2, corners)
    real(rk) :: p(2), q(2)
    integer :: i
    plane_area = 0.0_rk
    do i = 3, size(corner, 2)
      p = corner(:, i - 1) - corner(:, 1)
      q = corner(:, i) - corner(:, 1)
      plane_area = plane_area + 0.5_rk*(p(1)*q(2) - p(2)*q(1))
    end do
  end function plane_area

  !> Natural coordinates of a point of the plane in a facet: closed form, or Newton's method on the
  !> bilinear map. In a triangle: barycentric coordinates of the corners after the double one.
  pure function natural_at(flat, p) result(xi)
    type(flat_facet), intent(in) :: flat
    real(rk), intent(in) :: p(2) !< [m]
    real(rk) :: xi(2)
    real(rk) :: along(2, 2), step(2)
    integer :: iteration
    integer, parameter :: most_iterations = 30
    step = solve2(flat%along, p - flat%centre)
    xi = step
    if (flat%is_affine) return
    do iteration = 1, most_iterations
      along(:, 1) = flat%along(:, 1) + flat%twist*xi(2)
      along(:, 2) = flat%along(:, 2) + flat%twist*xi(1)
      step = solve2(along, p - flat%centre - matmul(flat%along, xi) - flat%twist*xi(1)*xi(2))
      xi = xi + step
      if (maxval(abs(step)) <= 1.0e-15_rk) exit
    end do
  end function natural_at

  !> Shape functions of the facet's four corners at natural coordinates.
  pure function shape_at(flat, xi) result(n)
    type(flat_facet), intent(in) :: flat
    real(rk), intent(in) :: xi(2) !< from natural_at
    real(rk) :: n(4)
    if (flat%num_corners == 4) then
      n = facet_shape(xi)
    else
      n = 0.0_rk
      n(flat%double) = 1.0_rk - xi(1) - xi(2)
      n(mod(flat%double + 1, 4) + 1) = xi(1)
      n(mod(flat%double + 2, 4) + 1) = xi(2)
    end if
  end function shape_at

  !> Area of the plane per area of the natural coordinates, without sign [m2].
  pure real(rk) function stretch_at(flat, xi) result(stretch)
    type(flat_facet), intent(in) :: flat
    real(rk), intent(in) :: xi(2)
    real(rk) :: along(2, 2)
    along(:, 1) = flat%along(:, 1)
    along(:, 2) = flat%along(:, 2)
    if (flat%num_corners == 4) then
      along(:, 1) = along(:, 1) + flat%twist*xi(2)
      along(:, 2) = along(:, 2) + flat%twist*xi(1)
    end if
    stretch = abs(along(1, 1)*along(2, 2) - along(1, 2)*along(2, 1))
  end function stretch_at

  !> Area vector of the facet itself per area of its plane: n / (n . n0), n its normal
  !> (different_meshes.md, 13.1).
  pure function area_element(on, flat, x, xi) result(vector)
    type(plane), intent(in) :: on !< of this facet
    type(flat_facet), intent(in) :: flat
    real(rk), intent(in) :: x(3, 4) !< corners [m]
    real(rk), intent(in) :: xi(2)
    real(rk) :: vector(3)
    real(rk) :: along(3, 2)
    vector = on%normal
    if (flat%num_corners < 4) return
    along = matmul(x, facet_derivative(xi))
    vector = cross_product(along(:, 1), along(:, 2))
    vector = vector/dot_product(vector, on%normal)
  end function area_element
end module facet_plane
