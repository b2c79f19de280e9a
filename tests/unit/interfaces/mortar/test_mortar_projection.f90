!> Rows of the mortar projection: what they reproduce, what they carry over, edges, kinks, bound
!> nodes. Two faces of different meshes on one geometry, the master's facets turned the other way.
program test_mortar_projection
  use face_pairs, only: add_sheet, bent, field_error, join, parts, two_faces
  use facet_segments, only: find_segments
  use gauss_rules, only: line5_point, line5_weight
  use kinds, only: rk
  use mortar_projection, only: project
  use mortar_balance, only: mortar_rows
  use shape_quad4, only: facet_derivative, facet_shape
  use small_matrix, only: cross_product
  use surface_segments, only: facet_set
  use testing, only: check, check_close, test_log
  implicit none

  !> Round-off: of sums of some hundred products, and of the inverse of M, whose condition is 9 on
  !> a whole facet. The quadrature leaves 1e-14.
  real(rk), parameter :: round_off = 1.0e-12_rk
  type(test_log) :: log

  log%suite = 'mortar_projection'
  call twins_see_each_other(log)
  call geometries_are_kept(log)
  call part_of_a_face(log)
  call slivers_are_bare(log)
  call bound_nodes_give_their_share(log)
  call planes_have_rows(log)
  call triangles(log)
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> int N_m dA of the nodes of a face, by 5 x 5 points a facet.
  pure function nodal_areas(x, facets) result(area)
    real(rk), intent(in) :: x(:, :)
    type(facet_set), intent(in) :: facets
    real(rk) :: area(size(x, 2))
    real(rk) :: along(3, 2), xi(2), da
    integer :: f, i, j
    area = 0.0_rk
    do f = 1, size(facets%node, 2)
      do i = 1, 5
        do j = 1, 5
          xi = 2.0_rk*[line5_point(i), line5_point(j)] - 1.0_rk
          along = matmul(x(:, facets%node(:, f)), facet_derivative(xi))
          da = 4.0_rk*line5_weight(i)*line5_weight(j)*norm2(cross_product(along(:, 1), along(:, 2)))
          area(facets%node(:, f)) = area(facets%node(:, f)) + da*facet_shape(xi)
        end do
      end do
    end do
  end function nodal_areas

  !> sum_a A_a w_am: what a constant traction of size 1 puts on the nodes of the master face; bound
  !> slave nodes have theirs, against it.
  pure function carried(rows, num_nodes) result(force)
    type(mortar_rows), intent(in) :: rows
    integer, intent(in) :: num_nodes
    real(rk) :: force(num_nodes)
    integer :: a, k
    force = 0.0_rk
    do a = 1, rows%num_rows()
      do k = rows%first(a), rows%first(a + 1) - 1
        force(rows%item(k)) = force(rows%item(k)) + rows%area(a)*rows%weight(k)
      end do
    end do
  end function carried

  !> Equal meshes: each node sees its twin alone, with weight 1; that is biorthogonality.
  subroutine twins_see_each_other(log)
    type(test_log), intent(inout) :: log
    type(two_faces) :: pair
    integer :: a
    allocate (pair%x(3, 0))
    call add_sheet(parts(3, 10.0_rk), parts(4, 1.0_rk), .false., pair%x, pair%slave)
    call add_sheet(parts(3, 10.0_rk), parts(4, 1.0_rk), .true., pair%x, pair%master)
    pair%x = bent(pair%x, 'skew')
    call join(pair)
    call check(log, pair%rows%num_rows() == 20, 'one row a node')
    call check(log, all(pair%rows%first == [(a, a=1, 21)]), 'one master a row')
    call check(log, all(pair%rows%item == pair%rows%node + 20), 'the twin')
    call check_close(log, maxval(abs(pair%rows%weight - 1.0_rk)), 0.0_rk, round_off, 'weight 1')
    call check_close(log, maxval(abs(pair%rows%gap)), 0.0_rk, round_off, 'no gap')
    call check(log, all(abs(pair%rows%normal(3, :) - 1.0_rk) < round_off), 'out of the slave')
  end subroutine twins_see_each_other

  !> On faces that coincide: linear fields, sums, areas, and constant tractions.
  subroutine geometries_are_kept(log)
    type(test_log), intent(inout) :: log
    call keeps(log, 'flat', 2, 3, 1.0_rk, 1.0_rk)
    call keeps(log, 'rotated', 5, 3, 10.0_rk, 0.1_rk)
    call keeps(log, 'rotated', 3, 7, 0.1_rk, 10.0_rk)
    call keeps(log, 'skew', 4, 7, 1.0_rk, 3.0_rk)
    call keeps(log, 'hypar', 3, 5, 1.0_rk, 1.0_rk)
    call keeps(log, 'hypar', 7, 4, 0.1_rk, 2.0_rk)
  end subroutine geometries_are_kept

  !> Slave with n x (n + 1), master with m x (m - 1) facets; sizes grow by the ratios along s.
  subroutine keeps(log, geometry, n, m, slave_ratio, master_ratio)
    type(test_log), intent(inout) :: log
    character(*), intent(in) :: geometry
    integer, intent(in) :: n, m
    real(rk), intent(in) :: slave_ratio, master_ratio
    type(two_faces) :: pair
    real(rk), allocatable :: f(:, :), area(:)
    real(rk) :: size_of
    integer :: num
    character(40) :: name
    write (name, '(a,2(a,i0))') geometry, ' ', n, ':', m
    allocate (pair%x(3, 0))
    call add_sheet(parts(n, slave_ratio), parts(n + 1, 1.0_rk), .false., pair%x, pair%slave)
    num = size(pair%x, 2)
    call add_sheet(parts(m, master_ratio), parts(m - 1, 1.0_rk), .true., pair%x, pair%master)
    pair%x = bent(pair%x, geometry)
    size_of = maxval(abs(pair%x))
    call join(pair)
    call check(log, pair%rows%num_rows() == num, trim(name)//': one row a node')
    allocate (f(4, size(pair%x, 2)))
    f(:3, :) = pair%x/size_of
    f(4, :) = 1.0_rk
    call check_close(log, field_error(pair%rows, f), 0.0_rk, round_off, trim(name)//': linear')
    area = nodal_areas(pair%x, pair%slave)
    call check_close(log, maxval(abs(pair%rows%area - area(pair%rows%node)))/sum(area), 0.0_rk, &
                     round_off, trim(name)//': areas of the slave nodes')
    call check_close(log, maxval(abs(pair%rows%gap))/size_of, 0.0_rk, round_off, &
                     trim(name)//': no gap')
    if (geometry == 'hypar') return
    area = nodal_areas(pair%x, pair%master)
    call check_close(log, maxval(abs(carried(pair%rows, size(area)) - area))/sum(area), 0.0_rk, &
                     round_off, trim(name)//': constant traction on the master')
  end subroutine keeps

  !> The master covers a part of the slave face that ends inside facets.
  subroutine part_of_a_face(log)
    type(test_log), intent(inout) :: log
    type(two_faces) :: pair
    real(rk), allocatable :: f(:, :), area(:)
    allocate (pair%x(3, 0))
    call add_sheet(parts(4, 1.0_rk), parts(4, 1.0_rk), .false., pair%x, pair%slave)
    call add_sheet(0.1_rk + 0.5_rk*parts(3, 1.0_rk), 0.31_rk + 0.22_rk*parts(2, 1.0_rk), .true., &
                   pair%x, pair%master)
    call join(pair)
    call check(log, pair%rows%num_rows() == 12, 'nodes of the facets that are touched')
    allocate (f(4, size(pair%x, 2)))
    f(:3, :) = pair%x
    f(4, :) = 1.0_rk
    ! The narrowest part is 0.03 of a facet's side of 0.25: M has a condition of some (1/0.12)^2.
    call check_close(log, field_error(pair%rows, f), 0.0_rk, 1.0e3_rk*round_off, 'linear fields')
    call check_close(log, sum(pair%rows%area), pair%cover%covered_area, round_off, 'covered area')
    call check_close(log, sum(pair%rows%area), 0.11_rk, round_off, 'all of it')
    area = nodal_areas(pair%x, pair%master)
    call check_close(log, maxval(abs(carried(pair%rows, size(area)) - area)), 0.0_rk, round_off, &
                     'constant traction on the master')
    ! The bilinear field of a facet, seen from a part of it.
    f(1, :) = pair%x(1, :)*pair%x(2, :)
    call check_close(log, field_error(pair%rows, f(1:1, :)), 0.0_rk, 1.0e3_rk*round_off, &
                     'bilinear field')
  end subroutine part_of_a_face

  !> A facet of which the master covers 1 % has no part, and its far nodes no row.
  subroutine slivers_are_bare(log)
    type(test_log), intent(inout) :: log
    type(two_faces) :: pair
    allocate (pair%x(3, 0))
    call add_sheet(parts(2, 1.0_rk), parts(1, 1.0_rk), .false., pair%x, pair%slave)
    call add_sheet(0.505_rk*parts(1, 1.0_rk), parts(1, 1.0_rk), .true., pair%x, pair%master)
    call join(pair)
    call check(log, pair%rows%num_rows() == 4, 'nodes of the first facet only')
    call check(log, all(pair%rows%is_bare .eqv. [.false., .true.]), 'the second is bare')
    call check_close(log, sum(pair%rows%area), 0.5_rk, round_off, 'area of the first')
  end subroutine slivers_are_bare

  subroutine bound_nodes_give_their_share(log)
    type(test_log), intent(inout) :: log
    type(two_faces) :: pair
    logical, allocatable :: is_bound(:)
    real(rk), allocatable :: f(:, :), area(:), force(:)
    integer :: i
    allocate (pair%x(3, 0))
    call add_sheet(parts(3, 1.0_rk), parts(3, 1.0_rk), .false., pair%x, pair%slave)
    call add_sheet(parts(5, 1.0_rk), parts(4, 1.0_rk), .true., pair%x, pair%master)
    pair%x = bent(pair%x, 'rotated')
    call find_segments(pair%x, pair%slave, pair%master, pair%segments, pair%cover)
    ! Two edges, and a node inside opposite the corner that they leave: a facet with three bound
    ! corners is among them.
    allocate (is_bound(size(pair%x, 2)), source=.false.)
    is_bound([1, 2, 3, 4, 5, 9, 13, 11]) = .true.
    call project(pair%x, pair%slave, pair%master, pair%segments, is_bound, pair%rows)
    call check(log, pair%rows%num_rows() == 8, 'rows of the free nodes')
    call check(log, count(is_bound(pair%rows%node)) == 0, 'none of a bound node')
    allocate (f(4, size(pair%x, 2)))
    f(:3, :) = pair%x/maxval(abs(pair%x))
    f(4, :) = 1.0_rk
    call check_close(log, field_error(pair%rows, f), 0.0_rk, round_off, 'linear fields')
    area = nodal_areas(pair%x, pair%master)
    force = carried(pair%rows, size(area))
    call check_close(log, maxval(abs(force(17:) - area(17:)))/sum(area), 0.0_rk, round_off, &
                     'constant traction on the master')
    ! What a bound node would have taken is on it, with the sign of the slave face.
    area = nodal_areas(pair%x, pair%slave)
    force(pair%rows%node) = force(pair%rows%node) - pair%rows%area
    call check_close(log, maxval(abs(force(:16) + area(:16)))/sum(area), 0.0_rk, round_off, &
                     'constant traction on the slave')
    is_bound([(i, i=1, 16)]) = .true.
    call project(pair%x, pair%slave, pair%master, pair%segments, is_bound, pair%rows)
    call check(log, pair%rows%num_rows() == 0, 'no row where all are bound')
  end subroutine bound_nodes_give_their_share

  !> A right-angled bend: two rows on its edge, or one on request.
  subroutine planes_have_rows(log)
    type(test_log), intent(inout) :: log
    type(two_faces) :: pair
    integer :: i
    allocate (pair%x(3, 0))
    call add_sheet(parts(4, 1.0_rk), parts(2, 1.0_rk), .false., pair%x, pair%slave)
    call add_sheet(parts(6, 1.0_rk), parts(3, 1.0_rk), .true., pair%x, pair%master)
    do i = 1, size(pair%x, 2)
      if (pair%x(1, i) <= 0.5_rk) cycle
      pair%x(3, i) = pair%x(1, i) - 0.5_rk
      pair%x(1, i) = 0.5_rk
    end do
    call join(pair)
    call check(log, pair%rows%num_rows() == 18, 'three nodes have two rows')
    call check_close(log, field_error(pair%rows, pair%x), 0.0_rk, round_off, 'linear fields')
    call check(log, all(abs(maxval(abs(pair%rows%normal), dim=1) - 1.0_rk) < round_off), &
               'normals of the two planes')
    call check_close(log, sum(pair%rows%area), 1.0_rk, round_off, 'whole area')
    call join(pair, merges_planes=.true.)
    call check(log, pair%rows%num_rows() == 15, 'one row a node')
    call check_close(log, field_error(pair%rows, pair%x), 0.0_rk, round_off, 'linear fields')
    call check_close(log, sum(pair%rows%area), 1.0_rk, round_off, 'whole area')
  end subroutine planes_have_rows

  !> Facets with a repeated node, on either side.
  subroutine triangles(log)
    type(test_log), intent(inout) :: log
    type(two_faces) :: pair
    real(rk), allocatable :: force(:)
    allocate (pair%x(3, 0))
    call add_sheet(parts(1, 1.0_rk), parts(1, 1.0_rk), .false., pair%x, pair%slave)
    pair%slave%node = reshape([1, 2, 4, 4, 1, 4, 3, 3], [4, 2])
    pair%slave%element = [1, 1]
    call add_sheet(parts(1, 1.0_rk), parts(1, 1.0_rk), .true., pair%x, pair%master)
    pair%master%node = reshape([5, 7, 6, 6, 7, 8, 6, 6], [4, 2])
    pair%master%element = [1, 1]
    call join(pair)
    call check(log, pair%rows%num_rows() == 4, 'one row a node')
    call check_close(log, field_error(pair%rows, pair%x), 0.0_rk, round_off, 'linear fields')
    call check_close(log, sum(pair%rows%area), 1.0_rk, round_off, 'whole area')
    force = carried(pair%rows, 8)
    call check_close(log, maxval(abs(force(5:) - [1, 2, 2, 1]/6.0_rk)), 0.0_rk, round_off, &
                     'thirds of the triangles')
  end subroutine triangles
end program test_mortar_projection
