!> Finds the segments of two faces: box-tree search, projection on the slave facets' mean planes and
!> clipping (different_meshes.md, 13.1).
module facet_segments
  use facet_clip, only: clip_polygon, most_corners
  use facet_plane, only: facet_pair, find_plane, natural_at, plane, plane_area, project_facet, &
                         shape_at
  use facet_search, only: box_tree, build_tree, find_boxes
  use growing_lists, only: make_room
  use kinds, only: rk
  use mesh_faces, only: face_vector
  use shape_quad4, only: facet_point
  use surface_segments, only: facet_set, segment_set, surface_cover
  implicit none
  private
  public :: find_segments, facet_area, leave_bare

  !> Facets are partners when their mean normals are within 60 degrees of opposite.
  real(rk), parameter :: least_cosine = 0.5_rk

  !> A segment below this fraction of its slave facet is round-off of the clipping; it is left out
  !> and counts as bare.
  real(rk), parameter :: smallest_part = 1.0e-14_rk

  !> Boxes are enlarged by this fraction of a diagonal, so that the boxes of touching faces overlap.
  real(rk), parameter :: touching = 1.0e-6_rk

contains

  !> The segments of two faces and how well they cover each other. Areas without a partner are
  !> listed in `cover`.
  pure subroutine find_segments(x, slave, master, segments, cover, farthest)
    real(rk), intent(in) :: x(:, :) !< (3, nodes) [m]
    type(facet_set), intent(in) :: slave, master
    type(segment_set), intent(out) :: segments
    type(surface_cover), intent(out) :: cover
    real(rk), intent(in), optional :: farthest !< largest distance, in diagonals
    type(box_tree) :: tree
    integer, allocatable :: near(:)
    real(rk) :: low(3), high(3), covered, area, largest, largest_bare
    integer :: f, num
    call open_segments(size(slave%element), segments)
    if (present(farthest)) segments%farthest = farthest
    allocate (cover%bare(size(slave%element)), source=1.0_rk)
    cover%element = slave%element
    do f = 1, size(master%element)
      cover%master_area = cover%master_area + facet_area(x(:, master%node(:, f)))
    end do
    call build_master_tree(x, master, tree, largest)
    largest_bare = 0.0_rk
    do f = 1, size(slave%element)
      call search_box(x(:, slave%node(:, f)), segments%farthest &
                      *max(largest, diameter(x(:, slave%node(:, f)))), low, high)
      num = 0
      if (size(master%element) > 0) call find_boxes(tree, low, high, num, near)
      covered = 0.0_rk
      if (num > 0) call cut_facet(x, slave, master, f, near(:num), segments, cover, covered)
      area = facet_area(x(:, slave%node(:, f)))
      cover%bare(f) = 1.0_rk - covered
      cover%slave_area = cover%slave_area + area
      cover%covered_area = cover%covered_area + min(covered, 1.0_rk)*area
      cover%excess_area = cover%excess_area + max(covered - 1.0_rk, 0.0_rk)*area
      if (cover%bare(f)*area <= largest_bare) cycle
      largest_bare = cover%bare(f)*area
      cover%bare_place = 0.25_rk*sum(x(:, slave%node(:, f)), dim=2)
    end do
    call close_segments(segments)
  end subroutine find_segments

  !> Marks facets that transmit no force as bare in the cover.
  pure subroutine leave_bare(x, slave, is_bare, cover)
    real(rk), intent(in) :: x(:, :) !< (3, nodes) [m]
    type(facet_set), intent(in) :: slave
    logical, intent(in) :: is_bare(:) !< (slave facets)
    type(surface_cover), intent(inout) :: cover
    real(rk) :: covered, area
    integer :: f
    do f = 1, size(is_bare)
      if (.not. is_bare(f) .or. cover%bare(f) >= 1.0_rk) cycle
      covered = 1.0_rk - cover%bare(f)
      area = facet_area(x(:, slave%node(:, f)))
      cover%covered_area = cover%covered_area - min(covered, 1.0_rk)*area
      cover%excess_area = cover%excess_area - max(covered - 1.0_rk, 0.0_rk)*area
      cover%bare(f) = 1.0_rk
    end do
  end subroutine leave_bare

  !> Area of a facet: exact when it is plane, by 2 x 2 points when it is warped [m2].
  pure real(rk) function facet_area(x) result(total)
    real(rk), intent(in) :: x(3, 4) !< corners [m]
    real(rk) :: n(4), vector(3)
    integer :: q
    total = 0.0_rk
    do q = 1, 4
      call facet_point(x, q, n, vector)
      total = total + norm2(vector)
    end do
  end function facet_area

  !> A tree over the boxes of the master facets.
  pure subroutine build_master_tree(x, master, tree, largest)
    real(rk), intent(in) :: x(:, :)
    type(facet_set), intent(in) :: master
    type(box_tree), intent(out) :: tree
    real(rk), intent(out) :: largest !< diameter of a facet [m]
    real(rk), allocatable :: low(:, :), high(:, :)
    integer :: f
    allocate (low(3, size(master%element)), high(3, size(master%element)))
    largest = 0.0_rk
    do f = 1, size(master%element)
      low(:, f) = minval(x(:, master%node(:, f)), dim=2)
      high(:, f) = maxval(x(:, master%node(:, f)), dim=2)
      largest = max(largest, diameter(x(:, master%node(:, f))))
    end do
    call build_tree(low, high, tree)
  end subroutine build_master_tree

  !> The box in which a slave facet searches for partners.
  pure subroutine search_box(x, distance, low, high)
    real(rk), intent(in) :: x(3, 4)
    real(rk), intent(in) :: distance !< beyond the facet [m]
    real(rk), intent(out) :: low(3), high(3)
    type(plane) :: ground
    real(rk) :: along(3)
    call find_plane(x, ground)
    along = distance*abs(ground%normal) + touching*diameter(x)
    low = minval(x, dim=2) - along
    high = maxval(x, dim=2) + along
  end subroutine search_box

  !> The longer diagonal of a facet [m].
  pure real(rk) function diameter(x)
    real(rk), intent(in) :: x(3, 4)
    diameter = max(norm2(x(:, 3) - x(:, 1)), norm2(x(:, 4) - x(:, 2)))
  end function diameter

  !> Finds the segments of one slave facet.
  pure subroutine cut_facet(x, slave, master, f, near, segments, cover, covered)
    real(rk), intent(in) :: x(:, :)
    type(facet_set), intent(in) :: slave, master
    integer, intent(in) :: f !< slave facet
    integer, intent(in) :: near(:) !< master facets
    type(segment_set), intent(inout) :: segments
    type(surface_cover), intent(inout) :: cover
    real(rk), intent(out) :: covered !< fraction of the facet
    type(facet_pair) :: pair
    real(rk) :: polygon(2, most_corners), area, whole
    integer :: k, num
    covered = 0.0_rk
    pair%slave = x(:, slave%node(:, f))
    call find_plane(pair%slave, pair%ground)
    call project_facet(pair%ground, pair%slave, pair%own)
    if (pair%own%num_corners == 0) return
    whole = plane_area(pair%own%corner(:, :pair%own%num_corners))
    do k = 1, size(near)
      pair%master = x(:, master%node(:, near(k)))
      if (lies_beside(pair)) cycle
      if (.not. are_opposed(pair, slave%element(f), master%element(near(k)))) cycle
      call project_facet(pair%ground, pair%master, pair%other)
      if (pair%other%num_corners == 0) cycle
      num = pair%own%num_corners
      polygon(:, :num) = pair%own%corner(:, :num)
      call clip_polygon(pair%other%corner(:, :pair%other%num_corners), num, polygon)
      area = plane_area(polygon(:, :num))
      if (area <= smallest_part*whole) cycle
      call add_segment(pair, polygon(:, :num), segments, cover, num)
      if (num == 0) cycle
      segments%slave(segments%num_segments) = f
      segments%master(segments%num_segments) = near(k)
      covered = covered + area/whole
    end do
  end subroutine cut_facet

  !> Whether circles around the two facets, projected along the slave facet's normal, are disjoint.
  pure logical function lies_beside(pair)
    type(facet_pair), intent(in) :: pair
    real(rk) :: centre(3), away(3), radii
    centre = 0.25_rk*sum(pair%master, dim=2)
    radii = sqrt(maxval(sum((pair%master - spread(centre, 2, 4))**2, dim=1))) &
            + sqrt(maxval(sum((pair%slave - spread(pair%ground%origin, 2, 4))**2, dim=1)))
    away = centre - pair%ground%origin
    away = away - dot_product(away, pair%ground%normal)*pair%ground%normal
    lies_beside = sum(away**2) > radii**2
  end function lies_beside

  !> Whether the normals of two facets are opposite; a facet without a solid has no side.
  pure logical function are_opposed(pair, slave_solid, master_solid)
    type(facet_pair), intent(in) :: pair
    integer, intent(in) :: slave_solid, master_solid !< 0 for none
    real(rk) :: vector(3), cosine
    vector = face_vector(pair%master)
    are_opposed = .false.
    if (norm2(vector) <= tiny(1.0_rk)) return
    cosine = dot_product(vector, pair%ground%normal)/norm2(vector)
    if (slave_solid == 0 .or. master_solid == 0) cosine = -abs(cosine)
    are_opposed = cosine <= -least_cosine
  end function are_opposed

  !> Adds a polygon to the segments, unless the facets are too far apart there.
  pure subroutine add_segment(pair, polygon, segments, cover, num)
    type(facet_pair), intent(in) :: pair
    real(rk), intent(in) :: polygon(:, :) !< (2, corners)
    type(segment_set), intent(inout) :: segments
    type(surface_cover), intent(inout) :: cover
    integer, intent(out) :: num !< corners; 0: no segment
    real(rk) :: shape(4, most_corners), opposite(4), gap(most_corners), place(3, most_corners)
    integer :: i, last
    num = size(polygon, 2)
    do i = 1, num
      shape(:, i) = shape_at(pair%own, natural_at(pair%own, polygon(:, i)))
      opposite = shape_at(pair%other, natural_at(pair%other, polygon(:, i)))
      place(:, i) = matmul(pair%slave, shape(:, i))
      gap(i) = dot_product(matmul(pair%master, opposite) - place(:, i), pair%ground%normal)
    end do
    if (.not. pair%other%is_turned) gap(:num) = -gap(:num)
    if (abs(sum(gap(:num)))/num > segments%farthest &
        *max(diameter(pair%slave), diameter(pair%master))) then
      num = 0
      return
    end if
    call note_gaps(gap(:num), place(:, :num), cover)
    last = segments%first_vertex(segments%num_segments + 1) + num
    call make_room(segments%slave, segments%num_segments, 1)
    call make_room(segments%master, segments%num_segments, 1)
    call make_room(segments%first_vertex, segments%num_segments + 1, 1)
    call make_room(segments%vertex, last - num - 1, num)
    call make_room(segments%vertex_shape, last - num - 1, num)
    segments%num_segments = segments%num_segments + 1
    segments%first_vertex(segments%num_segments + 1) = last
    segments%vertex(:, last - num:last - 1) = polygon
    segments%vertex_shape(:, last - num:last - 1) = shape(:, :num)
  end subroutine add_segment

  !> Stores the largest gap and the largest overlap with their places.
  pure subroutine note_gaps(gap, place, cover)
    real(rk), intent(in) :: gap(:), place(:, :) !< (corners), (3, corners) [m]
    type(surface_cover), intent(inout) :: cover
    integer :: i
    do i = 1, size(gap)
      if (gap(i) > cover%largest_gap) then
        cover%largest_gap = gap(i)
        cover%gap_place = place(:, i)
      end if
      if (-gap(i) > cover%largest_overlap) then
        cover%largest_overlap = -gap(i)
        cover%overlap_place = place(:, i)
      end if
    end do
  end subroutine note_gaps

  pure subroutine open_segments(num_facets, segments)
    integer, intent(in) :: num_facets
    type(segment_set), intent(out) :: segments
    allocate (segments%slave(2*num_facets), segments%master(2*num_facets))
    allocate (segments%first_vertex(2*num_facets + 1), source=1)
    allocate (segments%vertex(2, 8*num_facets), segments%vertex_shape(4, 8*num_facets))
  end subroutine open_segments

  !> Cuts the lists to size.
  pure subroutine close_segments(segments)
    type(segment_set), intent(inout) :: segments
    integer :: num, used
    num = segments%num_segments
    used = segments%first_vertex(num + 1) - 1
    segments%slave = segments%slave(:num)
    segments%master = segments%master(:num)
    segments%first_vertex = segments%first_vertex(:num + 1)
    segments%vertex = segments%vertex(:, :used)
    segments%vertex_shape = segments%vertex_shape(:, :used)
  end subroutine close_segments
end module facet_segments
