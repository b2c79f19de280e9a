!> Springs between two faces of different meshes: Eqs. 1-8 on the segments of the faces.
!>
!> At a point of a segment the faces differ by delta u = N u (Eqs. 1-5: N_s of the slave facet's
!> four nodes, -N_m of the master facet's). Springs of `stiffness` per area resist it in x, y and z
!> alike (Eq. 6), which gives each segment the matrix (Eq. 8; different_meshes.md, 13.4)
!>   K = k int N^T N dA.
module surface_coupling
  use facet_segments, only: find_segments
  use kinds, only: rk
  use segment_quadrature, only: integrate_segment, segment_points
  use surface_segments, only: facet_set, segment_set, surface_cover
  implicit none
  private
  public :: coupling, build_coupling

  type :: coupling
    character(:), allocatable :: name !< upper case
    character(:), allocatable :: kind !< its keyword: 'INTERFACE' or 'TIE'
    real(rk) :: stiffness = 0.0_rk !< k_x = k_y = k_z [Pa/m]
    integer, allocatable :: node(:, :) !< (8, segments) positions: the slave facet's, the master's
    real(rk), allocatable :: product(:, :, :) !< (8, 8, segments) int N^T N dA [m2]
  end type coupling

contains

  !> Finds the segments of two faces and integrates over them.
  pure subroutine build_coupling(x, slave, master, stiffness, name, kind, built, cover)
    real(rk), intent(in) :: x(:, :) !< (3, nodes) [m]
    type(facet_set), intent(in) :: slave, master
    real(rk), intent(in) :: stiffness !< [Pa/m]
    character(*), intent(in) :: name !< upper case
    character(*), intent(in) :: kind !< 'INTERFACE' or 'TIE'
    type(coupling), intent(out) :: built
    type(surface_cover), intent(out) :: cover
    type(segment_set) :: segments
    type(segment_points) :: points
    integer :: s
    built%name = name
    built%kind = kind
    built%stiffness = stiffness
    call find_segments(x, slave, master, segments, cover)
    allocate (built%node(8, segments%num_segments), built%product(8, 8, segments%num_segments))
    do s = 1, segments%num_segments
      built%node(1:4, s) = slave%node(:, segments%slave(s))
      built%node(5:8, s) = master%node(:, segments%master(s))
      call integrate_segment(x, slave, master, segments, s, points)
      call sum_products(points, built%product(:, :, s))
    end do
  end subroutine build_coupling

  !> int N^T N dA of a segment.
  pure subroutine sum_products(points, product)
    type(segment_points), intent(in) :: points
    real(rk), intent(out) :: product(8, 8) !< [m2]
    real(rk) :: n(8)
    integer :: q, j
    product = 0.0_rk
    do q = 1, points%num_points
      n = [points%slave_shape(:, q), -points%master_shape(:, q)]
      do j = 1, 8
        product(:, j) = product(:, j) + points%area(q)*n(j)*n
      end do
    end do
  end subroutine sum_products
end module surface_coupling
