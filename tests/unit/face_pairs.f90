!> Two faces of different meshes on one geometry, the master's facets turned the other way.
module face_pairs
  use facet_segments, only: find_segments
  use kinds, only: rk
  use mortar_projection, only: project
  use mortar_balance, only: mortar_rows
  use surface_segments, only: facet_set, segment_set, surface_cover
  implicit none
  private
  public :: two_faces, add_sheet, parts, bent, join, lay_bent, field_error

  type :: two_faces
    real(rk), allocatable :: x(:, :)
    type(facet_set) :: slave, master
    type(segment_set) :: segments
    type(surface_cover) :: cover
    type(mortar_rows) :: rows
  end type two_faces

contains

  !> A sheet of facets over the lines s x t of a unit square, in its own nodes behind those that are
  !> there; normal along e3, or against it when turned.
  subroutine add_sheet(s, t, is_turned, x, facets)
    real(rk), intent(in) :: s(:), t(:)
    logical, intent(in) :: is_turned
    real(rk), allocatable, intent(inout) :: x(:, :)
    type(facet_set), intent(out) :: facets
    integer :: i, j, before, f, n
    real(rk), allocatable :: longer(:, :)
    before = size(x, 2)
    n = size(s)
    allocate (longer(3, before + n*size(t)), source=0.0_rk)
    longer(:, :before) = x
    f = (n - 1)*(size(t) - 1)
    allocate (facets%node(4, f), facets%element(f), source=1)
    f = 0
    do j = 1, size(t)
      do i = 1, n
        longer(1:2, before + i + n*(j - 1)) = [s(i), t(j)]
        if (i == n .or. j == size(t)) cycle
        f = f + 1
        facets%node(:, f) = before + i + n*(j - 1) + [0, 1, n + 1, n]
        if (is_turned) facets%node(:, f) = facets%node([1, 4, 3, 2], f)
      end do
    end do
    call move_alloc(longer, x)
  end subroutine add_sheet

  !> n equal parts of 0..1, or parts that grow by `ratio` from the first to the last.
  pure function parts(n, ratio) result(s)
    integer, intent(in) :: n
    real(rk), intent(in) :: ratio
    real(rk) :: s(n + 1)
    integer :: i
    s(1) = 0.0_rk
    do i = 1, n
      s(i + 1) = s(i) + ratio**(real(i - 1, rk)/max(1, n - 1))
    end do
    s = s/s(n + 1)
  end function parts

  !> Bends the plane sheets into the geometry of that name.
  pure function bent(x, geometry) result(y)
    real(rk), intent(in) :: x(:, :)
    character(*), intent(in) :: geometry
    real(rk) :: y(3, size(x, 2))
    real(rk) :: rotation(3, 3), first(size(x, 2))
    y = x
    select case (geometry)
    case ('rotated')
      rotation = reshape([2.0_rk, 3.0_rk, 6.0_rk, 6.0_rk, 2.0_rk, -3.0_rk, &
                          -3.0_rk, 6.0_rk, -2.0_rk], [3, 3])/7.0_rk
      y = 12.0_rk*matmul(rotation, x)
      y(3, :) = y(3, :) + 40.0_rk
    case ('hypar') ! its rulings are the lines of the sheets, whatever their number
      y(3, :) = 0.4_rk*x(1, :)*x(2, :) + 0.1_rk*x(1, :)
    case ('shallow')
      y(3, :) = 1.0e-4_rk*x(1, :)*x(2, :)
    case ('chords')
      first = 0.25_rk*floor(4.0_rk*x(1, :)) ! of each chord of 0.4 s (1 - s)
      y(3, :) = 0.4_rk*first*(1.0_rk - first) &
                + 0.4_rk*(x(1, :) - first)*(0.75_rk - 2.0_rk*first)
    case ('skew')
      y(1, :) = x(1, :) + 0.3_rk*x(2, :) + 0.2_rk*x(1, :)*x(2, :)
    case default ! flat
      return
    end select
  end function bent

  subroutine join(pair, merges_planes)
    type(two_faces), intent(inout) :: pair
    logical, intent(in), optional :: merges_planes
    call find_segments(pair%x, pair%slave, pair%master, pair%segments, pair%cover)
    call project(pair%x, pair%slave, pair%master, pair%segments, &
                 spread(.false., 1, size(pair%x, 2)), pair%rows, merges_planes)
  end subroutine join

  !> The largest of |sum w f - f(slave node)| over the rows, for the fields in the rows of f.
  pure real(rk) function field_error(rows, f) result(error)
    type(mortar_rows), intent(in) :: rows
    real(rk), intent(in) :: f(:, :) !< (fields, nodes)
    integer :: a, k
    real(rk) :: sum_of(size(f, 1))
    error = 0.0_rk
    do a = 1, rows%num_rows()
      sum_of = -f(:, rows%node(a))
      do k = rows%first(a), rows%first(a + 1) - 1
        sum_of = sum_of + rows%weight(k)*f(:, rows%item(k))
      end do
      error = max(error, maxval(abs(sum_of)))
    end do
  end function field_error

  !> A slave of n x n and a master of m x m facets, bent.
  subroutine lay_bent(geometry, n, m, pair)
    character(*), intent(in) :: geometry
    integer, intent(in) :: n, m
    type(two_faces), intent(out) :: pair
    allocate (pair%x(3, 0))
    call add_sheet(parts(n, 1.0_rk), parts(n, 1.0_rk), .false., pair%x, pair%slave)
    call add_sheet(parts(m, 1.0_rk), parts(m, 1.0_rk), .true., pair%x, pair%master)
    pair%x = bent(pair%x, geometry)
    call join(pair)
  end subroutine lay_bent
end module face_pairs
