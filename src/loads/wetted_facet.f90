!> The part of a facet under water: integrals of the depth with the shape functions.
!>
!> A facet is cut at the water level and at the bed. Forces and moments of the linear pressure are
!> exact on planar facets for any cut. The substitution s = sqrt(depth) turns the square root of the
!> depth (Westergaard) into a polynomial: triangles are cut into pieces with one horizontal edge,
!> with Gauss points in s along their height.
module wetted_facet
  use gauss_rules, only: line2_point, line2_weight, line5_point, line5_weight
  use kinds, only: rk
  use shape_quad4, only: facet_derivative, facet_point, facet_shape
  use small_matrix, only: cross_product, solve2
  implicit none
  private
  public :: wet_facet, water_body, integrate_wet_part

  !> Water at rest between a level and a bed.
  type :: water_body
    real(rk) :: level = 0.0_rk !< of the surface, along the axis `up` [m]
    real(rk) :: bed = -huge(1.0_rk) !< of the ground [m]; nothing below is wet
    integer :: up = 3 !< axis 1..3
  end type water_body

  !> Integrals over the wetted part of a facet; y the depth, n the normal by the right-hand rule.
  type :: wet_facet
    real(rk) :: area(3, 4) = 0.0_rk !< N_a n dA [m2]
    real(rk) :: head(3, 4) = 0.0_rk !< y N_a n dA [m3]
    real(rk) :: root(4) = 0.0_rk !< sqrt(y) N_a dA [m2.5]
  end type wet_facet

  integer, parameter :: most_corners = 6 !< of a triangle cut twice, plus one
  !> Twice the area of a triangle over the square of the facet's size: below, as in a facet that has
  !> collapsed to a line, it is round-off.
  real(rk), parameter :: round_off = 1.0e-14_rk

contains

  !> Integrals over the part of a facet under water.
  pure subroutine integrate_wet_part(x, water, wet, needs_root)
    real(rk), intent(in) :: x(3, 4) !< corners [m]; two may be equal
    type(water_body), intent(in) :: water
    type(wet_facet), intent(out) :: wet
    logical, intent(in), optional :: needs_root !< .false. saves time: `wet%root` may be zero
    real(rk) :: depth(4), centre(3), polygon(3, most_corners)
    integer :: a, i, num
    logical :: is_submerged
    depth = water%level - x(water%up, :)
    if (all(depth <= 0.0_rk) .or. all(x(water%up, :) < water%bed)) return
    is_submerged = all(depth >= 0.0_rk) .and. all(x(water%up, :) >= water%bed)
    if (is_submerged .and. present(needs_root)) then
      if (.not. needs_root) then
        call submerge(x, water, wet)
        return
      end if
    end if
    centre = sum(x, dim=2)/4.0_rk
    do a = 1, 4
      polygon(:, 1) = centre
      polygon(:, 2) = x(:, a)
      polygon(:, 3) = x(:, mod(a, 4) + 1)
      num = 3
      call cut_polygon(water%up, -1.0_rk, -water%level, num, polygon)
      call cut_polygon(water%up, 1.0_rk, water%bed, num, polygon)
      do i = 3, num
        call add_triangle(x, water, polygon(:, [1, i - 1, i]), wet)
      end do
    end do
    if (is_submerged) call submerge(x, water, wet)
  end subroutine integrate_wet_part

  !> A facet completely under water: the bilinear surface by 2 x 2 points, exact.
  pure subroutine submerge(x, water, wet)
    real(rk), intent(in) :: x(3, 4)
    type(water_body), intent(in) :: water
    type(wet_facet), intent(inout) :: wet
    real(rk) :: n(4), area(3), depth
    integer :: q, a
    wet%area = 0.0_rk
    wet%head = 0.0_rk
    do q = 1, 4
      call facet_point(x, q, n, area)
      depth = water%level - dot_product(n, x(water%up, :))
      do a = 1, 4
        wet%area(:, a) = wet%area(:, a) + n(a)*area
        wet%head(:, a) = wet%head(:, a) + depth*n(a)*area
      end do
    end do
  end subroutine submerge

  !> Keeps the part of a convex polygon where sign*x(up) >= limit.
  pure subroutine cut_polygon(up, sign_of_side, limit, num, polygon)
    integer, intent(in) :: up
    real(rk), intent(in) :: sign_of_side, limit
    integer, intent(inout) :: num !< corners
    real(rk), intent(inout) :: polygon(3, most_corners)
    real(rk) :: kept(3, most_corners), here, there
    integer :: i, next, count
    count = 0
    do i = 1, num
      next = mod(i, num) + 1
      here = sign_of_side*polygon(up, i) - limit
      there = sign_of_side*polygon(up, next) - limit
      if (here >= 0.0_rk) then
        count = count + 1
        kept(:, count) = polygon(:, i)
      end if
      if ((here > 0.0_rk .and. there < 0.0_rk) .or. (here < 0.0_rk .and. there > 0.0_rk)) then
        count = count + 1
        kept(:, count) = polygon(:, i) + here/(here - there)*(polygon(:, next) - polygon(:, i))
      end if
    end do
    num = count
    polygon(:, :count) = kept(:, :count)
  end subroutine cut_polygon

  !> Adds a triangle under water, in two pieces with a horizontal edge at its middle corner.
  pure subroutine add_triangle(x, water, corner, wet)
    real(rk), intent(in) :: x(3, 4) !< corners of the facet
    type(water_body), intent(in) :: water
    real(rk), intent(in) :: corner(3, 3) !< of the triangle
    type(wet_facet), intent(inout) :: wet
    real(rk) :: depth(3), area(3), share, cut(3)
    integer :: low, high, middle
    area = cross_product(corner(:, 2) - corner(:, 1), corner(:, 3) - corner(:, 1))
    if (norm2(area) <= round_off*maxval(norm2(x - spread(x(:, 1), 2, 4), 1))**2) return
    depth = water%level - corner(water%up, :)
    low = minloc(depth, 1)
    high = maxloc(depth, 1)
    if (low == high) high = mod(low, 3) + 1
    middle = 6 - low - high
    share = 1.0_rk
    if (depth(high) > depth(low)) share = (depth(middle) - depth(low))/(depth(high) - depth(low))
    cut = corner(:, low) + share*(corner(:, high) - corner(:, low))
    call add_piece(x, water, corner(:, low), corner(:, middle), cut, share*area, wet)
    call add_piece(x, water, corner(:, high), corner(:, middle), cut, (1.0_rk - share)*area, wet)
  end subroutine add_triangle

  !> Adds a triangle whose edge from `left` to `right` is horizontal.
  pure subroutine add_piece(x, water, apex, left, right, area, wet)
    real(rk), intent(in) :: x(3, 4)
    type(water_body), intent(in) :: water
    real(rk), intent(in) :: apex(3), left(3), right(3)
    real(rk), intent(in) :: area(3) !< twice the area vector
    type(wet_facet), intent(inout) :: wet
    real(rk) :: first, last, s, height, weight, place(3), n(4), part(3)
    integer :: i, j, a
    if (norm2(area) <= tiny(s)) return
    first = sqrt(max(0.0_rk, water%level - apex(water%up)))
    last = sqrt(max(0.0_rk, water%level - left(water%up)))
    do i = 1, 5
      s = first + line5_point(i)*(last - first)
      height = line5_point(i)
      weight = line5_weight(i)
      if (first + last > 0.0_rk) then
        height = height*(s + first)/(first + last)
        weight = weight*2.0_rk*s/(first + last)
      end if
      do j = 1, 2
        place = apex + height*(left + line2_point(j)*(right - left) - apex)
        n = shape_in_facet(x, place)
        part = height*weight*line2_weight(j)*area
        do a = 1, 4
          wet%area(:, a) = wet%area(:, a) + n(a)*part
          wet%head(:, a) = wet%head(:, a) + s**2*n(a)*part
        end do
        wet%root = wet%root + s*norm2(part)*n
      end do
    end do
  end subroutine add_piece

  !> Shape functions of the facet at one of its places: barycentric in a triangle, else by Newton's
  !> method, which finds the nearest point of a warped facet.
  pure function shape_in_facet(x, place) result(n)
    real(rk), intent(in) :: x(3, 4), place(3)
    real(rk) :: n(4)
    real(rk) :: xi(2), along(3, 2), miss(3), step(2)
    integer :: a, iteration
    do a = 1, 4
      if (norm2(x(:, a) - x(:, mod(a, 4) + 1)) <= 0.0_rk) then
        n = shape_in_triangle(x, a, place)
        return
      end if
    end do
    xi = 0.0_rk
    do iteration = 1, 30
      along = matmul(x, facet_derivative(xi))
      miss = place - matmul(x, facet_shape(xi))
      step = solve2(matmul(transpose(along), along), matmul(miss, along))
      xi = xi + step
      if (maxval(abs(step)) <= 1.0e-14_rk) exit
    end do
    n = facet_shape(xi)
  end function shape_in_facet

  !> Barycentric coordinates in a facet whose corner after `double` repeats corner `double`.
  pure function shape_in_triangle(x, double, place) result(n)
    real(rk), intent(in) :: x(3, 4), place(3)
    integer, intent(in) :: double
    real(rk) :: n(4)
    real(rk) :: area(3)
    integer :: p, q
    p = mod(double + 1, 4) + 1
    q = mod(double + 2, 4) + 1
    area = cross_product(x(:, p) - x(:, double), x(:, q) - x(:, double))
    n = 0.0_rk
    n(p) = dot_product(cross_product(x(:, q) - place, x(:, double) - place), area)/sum(area**2)
    n(q) = dot_product(cross_product(x(:, double) - place, x(:, p) - place), area)/sum(area**2)
    n(double) = 1.0_rk - n(p) - n(q)
  end function shape_in_triangle
end module wetted_facet
