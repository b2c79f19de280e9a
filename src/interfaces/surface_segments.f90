!> Where two faces of different meshes lie on each other, in segments: pieces of a slave facet under
!> one master facet, with points that integrate over them.
!>
!> Integrals over the contact area are sums over the points: int f dA = sum_q area(q) f(q). A point
!> is one place on the slave face; slave_shape and master_shape are the bilinear shape functions of
!> both facets there, so that both faces' fields meet in it whatever their meshes.
module surface_segments
  use kinds, only: rk
  implicit none
  private
  public :: facet_set, segment_set, surface_cover

  !> Facets of one side of an interface.
  type :: facet_set
    integer, allocatable :: node(:, :) !< (4, facets) positions; right-hand rule out of their solid
    integer, allocatable :: element(:) !< (facets) the solid behind (position), 0 for none
  end type facet_set

  !> The segments of two faces and their points.
  type :: segment_set
    integer :: num_segments = 0
    integer, allocatable :: slave(:), master(:) !< (segments) facets of the two sets
    integer, allocatable :: first_vertex(:) !< (segments + 1)
    real(rk), allocatable :: vertex_shape(:, :) !< (4, vertices) of the slave facet, at the corners
    integer, allocatable :: first_point(:) !< (segments + 1)
    real(rk), allocatable :: slave_shape(:, :), master_shape(:, :) !< (4, points)
    real(rk), allocatable :: area(:) !< (points) on the slave face [m2]
    real(rk), allocatable :: normal(:, :) !< (3, points) unit, out of the slave's solid
    real(rk), allocatable :: gap(:) !< (points) from slave to master along the normal [m]
  end type segment_set

  !> How well two faces cover each other; told to the user.
  type :: surface_cover
    real(rk) :: slave_area = 0.0_rk, master_area = 0.0_rk !< of the faces [m2]
    real(rk) :: covered_area = 0.0_rk !< of the slave face [m2]
    real(rk), allocatable :: bare(:) !< (slave facets) part of each that has no partner, 0..1
    real(rk) :: largest_gap = 0.0_rk, largest_overlap = 0.0_rk !< [m]
    real(rk) :: gap_place(3) = 0.0_rk, overlap_place(3) = 0.0_rk !< [m]
  end type surface_cover
end module surface_segments
