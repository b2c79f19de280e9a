!> The rim of a joint's face: the edge at a reservoir, and the opposite edge.
!>
!> Upstream are the outer edges of the face that lie in the reservoir's surface. Downstream are the
!> edges whose outward direction is opposite to that of the nearest upstream edge
!> (different_meshes.md, 13.6). The sides between are neither: the crest and the foot of a
!> contraction joint, the ends of a base.
module joint_rim
  use kinds, only: rk
  use mesh_faces, only: face_vector
  use small_matrix, only: cross_product
  implicit none
  private
  public :: face_rim, find_rim, distance_to_edges, area_of_facets

  !> An outer edge is downstream if the cosine between its outward direction, in the plane of the
  !> face, and that of the nearest upstream edge is less (as for faces of a dam in the results).
  real(rk), parameter :: largest_cosine = -0.3_rk

  type :: face_rim
    integer, allocatable :: upstream(:, :) !< (2, edges) nodes
    integer, allocatable :: downstream(:, :) !< (2, edges) nodes
  end type face_rim

  !> Outer edges of a face.
  type :: edge_list
    integer, allocatable :: node(:, :) !< (2, edges)
    real(rk), allocatable :: outward(:, :) !< (3, edges) unit, in the plane of their facet
    real(rk), allocatable :: middle(:, :) !< (3, edges) [m]
  end type edge_list

contains

  !> Finds both edges; a missing one is empty.
  subroutine find_rim(x, facets, is_wet, rim)
    real(rk), intent(in) :: x(:, :) !< (3, nodes) [m]
    integer, intent(in) :: facets(:, :) !< (4, facets) nodes, all turning the same way
    logical, intent(in) :: is_wet(:) !< (nodes) in the reservoir's surface
    type(face_rim), intent(out) :: rim
    type(edge_list) :: edges
    logical, allocatable :: is_upstream(:), is_downstream(:)
    integer, allocatable :: upstream(:)
    integer :: e, nearest
    call list_outer_edges(x, facets, edges)
    is_upstream = is_wet(edges%node(1, :)) .and. is_wet(edges%node(2, :))
    upstream = pack([(e, e=1, size(is_upstream))], is_upstream)
    allocate (is_downstream(size(is_upstream)), source=.false.)
    do e = 1, size(is_upstream)
      if (is_upstream(e) .or. size(upstream) == 0) cycle
      nearest = upstream(nearest_place(edges%middle(:, upstream), edges%middle(:, e)))
      is_downstream(e) = dot_product(edges%outward(:, e), edges%outward(:, nearest)) &
                         < largest_cosine
    end do
    rim%upstream = edges%node(:, upstream)
    rim%downstream = edges%node(:, pack([(e, e=1, size(is_upstream))], is_downstream))
  end subroutine find_rim

  !> The edges of one facet only.
  subroutine list_outer_edges(x, facets, edges)
    real(rk), intent(in) :: x(:, :) !< (3, nodes) [m]
    integer, intent(in) :: facets(:, :) !< (4, facets)
    type(edge_list), intent(out) :: edges
    integer, allocatable :: newest(:), next(:), node(:, :), facet(:)
    logical, allocatable :: is_outer(:)
    integer :: f, a, edge, num, low, twin
    allocate (newest(size(x, 2)), next(4*size(facets, 2)), source=0)
    allocate (node(2, 4*size(facets, 2)), facet(4*size(facets, 2)))
    allocate (is_outer(4*size(facets, 2)), source=.false.)
    num = 0
    do f = 1, size(facets, 2)
      do a = 1, 4
        associate (pair => facets([a, mod(a, 4) + 1], f))
          if (pair(1) == pair(2)) cycle ! a triangle
          low = minval(pair)
          twin = newest(low)
          do while (twin > 0)
            if (maxval(node(:, twin)) == maxval(pair)) exit
            twin = next(twin)
          end do
          num = num + 1
          node(:, num) = pair
        end associate
        facet(num) = f
        is_outer(num) = twin == 0
        if (twin > 0) is_outer(twin) = .false.
        next(num) = newest(low)
        newest(low) = num
      end do
    end do
    edges%node = node(:, pack([(edge, edge=1, num)], is_outer(:num)))
    call set_directions(x, facets(:, pack(facet(:num), is_outer(:num))), edges)
  end subroutine list_outer_edges

  !> Middles and outward directions.
  subroutine set_directions(x, facets, edges)
    real(rk), intent(in) :: x(:, :) !< (3, nodes) [m]
    integer, intent(in) :: facets(:, :) !< (4, edges) the facet of each
    type(edge_list), intent(inout) :: edges
    real(rk) :: way(3)
    integer :: e
    allocate (edges%outward(3, size(facets, 2)), edges%middle(3, size(facets, 2)))
    do e = 1, size(facets, 2)
      associate (a => x(:, edges%node(1, e)), b => x(:, edges%node(2, e)))
        edges%middle(:, e) = 0.5_rk*(a + b)
        way = cross_product(b - a, face_vector(x(:, facets(:, e))))
      end associate
      edges%outward(:, e) = way/max(norm2(way), tiny(1.0_rk))
    end do
  end subroutine set_directions

  !> Index of the nearest place; the first of equal ones.
  pure integer function nearest_place(places, here) result(nearest)
    real(rk), intent(in) :: places(:, :) !< (3, places) [m]
    real(rk), intent(in) :: here(3) !< [m]
    nearest = minloc(sum((places - spread(here, 2, size(places, 2)))**2, dim=1), dim=1)
  end function nearest_place

  !> Distance of a point to the nearest of some edges [m].
  pure real(rk) function distance_to_edges(x, edges, here) result(distance)
    real(rk), intent(in) :: x(:, :) !< (3, nodes) [m]
    integer, intent(in) :: edges(:, :) !< (2, edges)
    real(rk), intent(in) :: here(3) !< [m]
    real(rk) :: along(3), from(3), share
    integer :: e
    distance = huge(1.0_rk)
    do e = 1, size(edges, 2)
      along = x(:, edges(2, e)) - x(:, edges(1, e))
      from = here - x(:, edges(1, e))
      share = dot_product(from, along)/max(dot_product(along, along), tiny(1.0_rk))
      from = from - min(max(share, 0.0_rk), 1.0_rk)*along
      distance = min(distance, norm2(from))
    end do
  end function distance_to_edges

  !> Size of a face [m2].
  pure real(rk) function area_of_facets(x, facets) result(area)
    real(rk), intent(in) :: x(:, :) !< (3, nodes) [m]
    integer, intent(in) :: facets(:, :) !< (4, facets)
    integer :: f
    area = 0.0_rk
    do f = 1, size(facets, 2)
      area = area + norm2(face_vector(x(:, facets(:, f))))
    end do
  end function area_of_facets
end module joint_rim
