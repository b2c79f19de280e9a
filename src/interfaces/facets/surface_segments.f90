!> Where two faces of different meshes lie on each other, in segments: pieces of a slave facet under
!> one master facet (different_meshes.md, 13.1).
!>
!> A segment is a convex polygon in the mean plane of its slave facet. Only the polygons are kept;
!> `segment_quadrature` lays points into one segment when they are wanted.
module surface_segments
  use kinds, only: rk
  implicit none
  private
  public :: facet_set, segment_set, surface_cover, named_cover

  !> Facets of one side of an interface. A triangle repeats a node; the second of two equal corners
  !> then has the shape function 0 everywhere, the first that of the triangle's corner.
  type :: facet_set
    integer, allocatable :: node(:, :) !< (4, facets) positions; right-hand rule out of their solid
    integer, allocatable :: element(:) !< (facets) the solid behind (position), 0 for none
  end type facet_set

  !> The segments of two faces, slave facet by slave facet in ascending order.
  type :: segment_set
    real(rk) :: farthest = 0.5_rk !< facets farther apart than this part of the longer one's
    !< diagonal are no partners
    integer :: num_segments = 0
    integer, allocatable :: slave(:), master(:) !< (segments) facets of the two sets
    integer, allocatable :: first_vertex(:) !< (segments + 1)
    real(rk), allocatable :: vertex(:, :) !< (2, vertices) in the slave facet's plane [m], see
    !< facet_plane; anticlockwise about the slave facet's normal
    real(rk), allocatable :: vertex_shape(:, :) !< (4, vertices) shape functions of the slave facet
  end type segment_set

  !> How well two faces cover each other; told to the user.
  type :: surface_cover
    real(rk) :: slave_area = 0.0_rk, master_area = 0.0_rk !< of the faces [m2]
    real(rk) :: covered_area = 0.0_rk !< of the slave face, no facet more than once [m2]
    real(rk) :: excess_area = 0.0_rk !< what covers slave facets beyond the whole of each [m2]
    real(rk), allocatable :: bare(:) !< (slave facets) part of each that has no partner, 0..1;
    !< below 0 by more than round-off where master facets lie upon each other
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
