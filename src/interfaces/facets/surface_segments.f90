!> Segments of two faces of different meshes: pieces of a slave facet opposite one master facet
!> (different_meshes.md, 13.1).
!>
!> A segment is a convex polygon in the mean plane of its slave facet. Only the polygons are stored;
!> `segment_quadrature` makes the points of one segment at a time.
module surface_segments
  use kinds, only: rk
  implicit none
  private
  public :: facet_set, segment_set, surface_cover, named_cover

  !> Facets of one side of an interface. A triangle repeats a node: the first of the equal corners
  !> has the shape function of the triangle's corner, the second has the shape function 0.
  type :: facet_set
    integer, allocatable :: node(:, :) !< (4, facets) positions; right-hand rule out of their solid
    integer, allocatable :: element(:) !< (facets) the solid behind (position), 0 for none
  end type facet_set

  !> The segments of two faces, slave facet by slave facet in ascending order.
  type :: segment_set
    real(rk) :: farthest = 0.5_rk !< facets at a larger distance, in diagonals of the longer
    !< one, are no partners
    integer :: num_segments = 0
    integer, allocatable :: slave(:), master(:) !< (segments) facets of the two sets
    integer, allocatable :: first_vertex(:) !< (segments + 1)
    real(rk), allocatable :: vertex(:, :) !< (2, vertices) in the slave facet's plane [m], see
    !< facet_plane; anticlockwise about the slave facet's normal
    real(rk), allocatable :: vertex_shape(:, :) !< (4, vertices) shape functions of the slave facet
  end type segment_set

  !> How well two faces cover each other; reported to the user.
  type :: surface_cover
    real(rk) :: slave_area = 0.0_rk, master_area = 0.0_rk !< of the faces [m2]
    real(rk) :: covered_area = 0.0_rk !< of the slave face, no facet more than once [m2]
    real(rk) :: excess_area = 0.0_rk !< area covered more than once [m2]
    real(rk), allocatable :: bare(:) !< (slave facets) fraction without a partner, 0..1;
    !< below 0 by more than round-off if master facets overlap
    integer, allocatable :: element(:) !< (slave facets) the solid behind or the IFACE4, positions
    real(rk) :: largest_gap = 0.0_rk, largest_overlap = 0.0_rk !< [m]
    real(rk) :: gap_place(3) = 0.0_rk, overlap_place(3) = 0.0_rk !< [m]
    real(rk) :: bare_place(3) = 0.0_rk !< centre of the slave facet with the largest bare area [m]
  end type surface_cover

  !> The cover of one interface of the model.
  type :: named_cover
    character(:), allocatable :: name !< upper case
    character(:), allocatable :: kind !< its keyword: 'JOINT', 'TIE' or 'INTERFACE'
    type(surface_cover) :: cover
  end type named_cover
end module surface_segments
