!> Faces of different meshes for tests: grids of facets on the unit square and what becomes of them.
module two_faces
  use kinds, only: rk
  use surface_segments, only: facet_set
  implicit none
  private
  public :: grid_face, even_lines, graded_lines, shake, turn, rotation_about

contains

  !> Adds a grid of facets to the nodes x: lines at s along x and t along y, at the height z.
  subroutine grid_face(s, t, z, looks_up, x, facets)
    real(rk), intent(in) :: s(:), t(:), z !< [m]
    logical, intent(in) :: looks_up !< normal along +z, else -z
    real(rk), allocatable, intent(inout) :: x(:, :) !< (3, nodes)
    type(facet_set), intent(out) :: facets
    integer :: i, j, before, f
    before = 0
    if (allocated(x)) before = size(x, 2)
    if (.not. allocated(x)) allocate (x(3, 0))
    x = reshape([x, [([([s(i), t(j), z], i=1, size(s))], j=1, size(t))]], &
                [3, before + size(s)*size(t)])
    allocate (facets%node(4, (size(s) - 1)*(size(t) - 1)))
    allocate (facets%element((size(s) - 1)*(size(t) - 1)), source=1)
    f = 0
    do j = 1, size(t) - 1
      do i = 1, size(s) - 1
        f = f + 1
        facets%node(:, f) = before + i + (j - 1)*size(s) + [0, 1, size(s) + 1, size(s)]
        if (.not. looks_up) facets%node(:, f) = facets%node(4:1:-1, f)
      end do
    end do
  end subroutine grid_face

  !> n intervals of equal length from a to b.
  pure function even_lines(n, a, b) result(s)
    integer, intent(in) :: n
    real(rk), intent(in) :: a, b
    real(rk) :: s(n + 1)
    integer :: i
    s = [(a + (b - a)*i/n, i=0, n)]
  end function even_lines

  !> n intervals from 0 to 1, the last `ratio` times as long as the first.
  pure function graded_lines(n, ratio) result(s)
    integer, intent(in) :: n
    real(rk), intent(in) :: ratio
    real(rk) :: s(n + 1)
    integer :: i
    s(1) = 0.0_rk
    do i = 1, n
      s(i + 1) = s(i) + ratio**(real(i - 1, rk)/real(n - 1, rk))
    end do
    s = s/s(n + 1)
    s(n + 1) = 1.0_rk
  end function graded_lines

  !> Moves the inner nodes of a grid in its plane by up to `size` of an interval, not at random but
  !> without a pattern.
  subroutine shake(first, nx, ny, part, x)
    integer, intent(in) :: first !< the grid's first node
    integer, intent(in) :: nx, ny !< intervals
    real(rk), intent(in) :: part !< of an interval
    real(rk), intent(inout) :: x(:, :)
    integer :: i, j, node
    do j = 1, ny - 1
      do i = 1, nx - 1
        node = first + i + j*(nx + 1)
        x(1, node) = x(1, node) + part/nx*sin(12.9898_rk*i + 78.233_rk*j)
        x(2, node) = x(2, node) + part/ny*sin(39.425_rk*i + 23.14_rk*j)
      end do
    end do
  end subroutine shake

  !> Turns nodes about a place: x = centre + rotation (x - centre).
  pure subroutine turn(rotation, centre, x)
    real(rk), intent(in) :: rotation(3, 3), centre(3)
    real(rk), intent(inout) :: x(:, :)
    integer :: i
    do i = 1, size(x, 2)
      x(:, i) = centre + matmul(rotation, x(:, i) - centre)
    end do
  end subroutine turn

  !> Rotation about an axis, by Rodrigues's formula.
  pure function rotation_about(axis, angle) result(rotation)
    real(rk), intent(in) :: axis(3), angle !< [rad]
    real(rk) :: rotation(3, 3)
    real(rk) :: a(3), spin(3, 3)
    integer :: i
    a = axis/norm2(axis)
    spin = reshape([0.0_rk, a(3), -a(2), -a(3), 0.0_rk, a(1), a(2), -a(1), 0.0_rk], [3, 3])
    rotation = sin(angle)*spin + (1.0_rk - cos(angle))*matmul(spin, spin)
    do i = 1, 3
      rotation(i, i) = rotation(i, i) + 1.0_rk
    end do
  end function rotation_about
end module two_faces
