!> Integrals over one segment: int f dA = sum_q area(q) f(q) (different_meshes.md, 13.1).
!>
!> The polygon is cut into triangles, each with a collapsed product of Gauss's rules (Duffy 1982;
!> n x n points are exact to degree 2 n - 2). In parallelograms and triangles all shape functions
!> are polynomials of the place and 4 x 4 points integrate N_s N_m N_s exactly. In other facets they
!> hold a square root with a branch point where the Jacobian J of the bilinear map vanishes; the
!> error of Gauss's rule falls as rho^(-2 n), rho = (J_max + J_min) / (J_max - J_min) over the
!> segment. With k the n for which rho^(-2 n) is round-off, 3 + 0.6 k points are used: enough for
!> 1500 pairs of random facets.
module segment_quadrature
  use facet_plane, only: area_element, facet_pair, find_plane, flat_facet, natural_at, &
                         project_facet, shape_at, stretch_at
  use kinds, only: rk
  use surface_segments, only: facet_set, segment_set
  implicit none
  private
  public :: segment_points, integrate_segment, find_pair, integrate_polygon

  !> The points of one segment: places on the slave face, and values of both facets there.
  type :: segment_points
    integer :: num_points = 0 !< all arrays have this size
    real(rk), allocatable :: slave_shape(:, :), master_shape(:, :) !< (4, points)
    real(rk), allocatable :: area(:) !< (points) on the slave face [m2]
    real(rk), allocatable :: normal(:, :) !< (3, points) unit, out of the slave's solid
    real(rk), allocatable :: gap(:) !< (points) from slave to master along the normal [m]
    real(rk), allocatable :: x(:, :) !< (3, points) on the slave face [m]
    real(rk), allocatable, private :: line(:), weight(:) !< Gauss's rule of the last segment
  end type segment_points

  integer, parameter :: fewest = 4 !< points a direction
  integer, parameter :: most = 24 !< points a direction; enough while J changes by a factor of 5

  !> Error that is allowed in an integral.
  real(rk), parameter :: error_left = 1.0e-14_rk

contains

  !> The integration points of segment s.
  pure subroutine integrate_segment(x, slave, master, segments, s, points)
    real(rk), intent(in) :: x(:, :) !< (3, nodes) [m]
    type(facet_set), intent(in) :: slave, master
    type(segment_set), intent(in) :: segments !< of these two faces
    integer, intent(in) :: s
    type(segment_points), intent(inout) :: points !< memory is reused
    type(facet_pair) :: pair
    call find_pair(x, slave, master, segments, s, pair)
    call integrate_polygon(pair, segments%vertex(:, segments%first_vertex(s): &
                                                 segments%first_vertex(s + 1) - 1), points)
  end subroutine integrate_segment

  !> The facets of segment s on the plane of the slave facet.
  pure subroutine find_pair(x, slave, master, segments, s, pair)
    real(rk), intent(in) :: x(:, :) !< (3, nodes) [m]
    type(facet_set), intent(in) :: slave, master
    type(segment_set), intent(in) :: segments
    integer, intent(in) :: s
    type(facet_pair), intent(out) :: pair
    pair%slave = x(:, slave%node(:, segments%slave(s)))
    pair%master = x(:, master%node(:, segments%master(s)))
    call find_plane(pair%slave, pair%ground)
    call project_facet(pair%ground, pair%slave, pair%own)
    call project_facet(pair%ground, pair%master, pair%other)
    if (slave%element(segments%slave(s)) == 0 .and. .not. pair%other%is_turned) pair%turn = -1.0_rk
  end subroutine find_pair

  !> The integration points of a polygon, a segment of the pair or a part of one.
  pure subroutine integrate_polygon(pair, polygon, points)
    type(facet_pair), intent(in) :: pair
    real(rk), intent(in) :: polygon(:, :) !< (2, corners) convex, anticlockwise [m]
    type(segment_points), intent(inout) :: points !< memory is reused
    integer :: i
    call choose_rule(pair%own, pair%other, polygon, points)
    points%num_points = 0
    do i = 2, size(polygon, 2) - 1
      call add_triangle(pair, polygon(:, [1, i, i + 1]), points)
    end do
  end subroutine integrate_polygon

  !> Chooses the rule for a polygon and allocates its points.
  pure subroutine choose_rule(own, other, polygon, points)
    type(flat_facet), intent(in) :: own, other
    real(rk), intent(in) :: polygon(:, :) !< (2, corners)
    type(segment_points), intent(inout) :: points
    integer :: n, num
    n = max(points_for(own, polygon), points_for(other, polygon))
    if (allocated(points%line)) then
      if (size(points%line) /= n) deallocate (points%line, points%weight)
    end if
    if (.not. allocated(points%line)) then
      allocate (points%line(n), points%weight(n))
      call make_rule(points%line, points%weight)
    end if
    num = (size(polygon, 2) - 2)*n**2
    if (allocated(points%area)) then
      if (size(points%area) == num) return
      deallocate (points%slave_shape, points%master_shape, points%area, points%normal)
      deallocate (points%gap, points%x)
    end if
    allocate (points%slave_shape(4, num), points%master_shape(4, num), points%area(num))
    allocate (points%normal(3, num), points%gap(num), points%x(3, num))
  end subroutine choose_rule

  !> Number of points per direction that a facet's shape functions need over a polygon.
  pure integer function points_for(flat, polygon) result(n)
    type(flat_facet), intent(in) :: flat
    real(rk), intent(in) :: polygon(:, :)
    real(rk) :: least, largest, stretch, k
    integer :: i
    n = fewest
    if (flat%is_affine) return
    least = huge(least)
    largest = 0.0_rk
    do i = 1, size(polygon, 2)
      stretch = stretch_at(flat, natural_at(flat, polygon(:, i)))
      least = min(least, stretch)
      largest = max(largest, stretch)
    end do
    if (largest - least <= epsilon(1.0_rk)*largest) return
    n = most
    if (least <= 0.0_rk) return
    k = -log(error_left)/(2.0_rk*log((largest + least)/(largest - least)))
    n = min(max(fewest, 3 + ceiling(0.6_rk*k)), most)
  end function points_for

  !> Adds the points of a triangle; u = 0 is its first corner.
  pure subroutine add_triangle(pair, corner, points)
    type(facet_pair), intent(in) :: pair
    real(rk), intent(in) :: corner(2, 3)
    type(segment_points), intent(inout) :: points
    real(rk) :: a(2), b(2), u, xi(2), p(2), vector(3), area
    integer :: i, j, q
    a = corner(:, 2) - corner(:, 1)
    b = corner(:, 3) - corner(:, 2)
    area = a(1)*b(2) - a(2)*b(1)
    do i = 1, size(points%line)
      u = points%line(i)
      do j = 1, size(points%line)
        p = corner(:, 1) + u*(a + points%line(j)*b)
        q = points%num_points + 1
        points%num_points = q
        xi = natural_at(pair%own, p)
        vector = area_element(pair%ground, pair%own, pair%slave, xi)
        points%area(q) = area*u*points%weight(i)*points%weight(j)*norm2(vector)
        points%normal(:, q) = pair%turn*vector/norm2(vector)
        points%slave_shape(:, q) = shape_at(pair%own, xi)
        points%master_shape(:, q) = shape_at(pair%other, natural_at(pair%other, p))
        points%x(:, q) = matmul(pair%slave, points%slave_shape(:, q))
        points%gap(q) = dot_product(matmul(pair%master, points%master_shape(:, q)) &
                                    - points%x(:, q), points%normal(:, q))
      end do
    end do
  end subroutine add_triangle

  !> Gauss points and weights on 0..1: zeros of the Legendre polynomial by Newton's method.
  pure subroutine make_rule(point, weight)
    real(rk), intent(out) :: point(:), weight(:)
    real(rk), parameter :: pi = acos(-1.0_rk)
    real(rk) :: z, step, value, slope
    integer :: i, n, iteration
    n = size(point)
    do i = 1, n
      z = cos(pi*(i - 0.25_rk)/(n + 0.5_rk))
      do iteration = 1, 20
        call legendre(n, z, value, slope)
        step = value/slope
        z = z - step
        if (abs(step) <= epsilon(z)) exit
      end do
      call legendre(n, z, value, slope)
      point(i) = 0.5_rk*(1.0_rk - z)
      weight(i) = 1.0_rk/((1.0_rk - z**2)*slope**2)
    end do
  end subroutine make_rule

  !> The Legendre polynomial of degree n and its slope, by the three-term recursion.
  pure subroutine legendre(n, z, value, slope)
    integer, intent(in) :: n !< at least 2
    real(rk), intent(in) :: z
    real(rk), intent(out) :: value, slope
    real(rk) :: before, next
    integer :: k
    before = 1.0_rk
    value = z
    do k = 2, n
      next = ((2*k - 1)*z*value - (k - 1)*before)/k
      before = value
      value = next
    end do
    slope = n*(z*value - before)/(z**2 - 1.0_rk)
  end subroutine legendre
end module segment_quadrature
