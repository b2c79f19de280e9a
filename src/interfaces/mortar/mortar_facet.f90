!> One slave facet of a mortar projection: integrals over its covered part, and dual functions.
!>
!> With M_ab = int N_a N_b and D_a = int N_a over the part of the facet that the other face covers,
!> the dual functions phi = D M^-1 N satisfy int phi_a N_b = delta_ab D_a and sum_a phi_a = 1
!> (different_meshes.md, 13.2; Wohlmuth 2000, Popp et al. 2010). Integrals over the covered part
!> keep both properties on partly covered facets (Cichosz & Bischoff 2011).
module mortar_facet
  use facet_segments, only: facet_area
  use kinds, only: rk
  use segment_quadrature, only: integrate_segment, segment_points
  use small_matrix, only: solve_dense
  use surface_segments, only: facet_set, segment_set
  implicit none
  private
  public :: facet_part, integrate_facet, share_bound, facet_extent

  !> A facet of which less than this fraction is covered counts as bare. The weights grow with the
  !> inverse of the fraction (here to 50) and the condition of M with the inverse squared (here to
  !> 1e4). At most 2 % of one row of facets is lost.
  real(rk), parameter :: least_part = 0.02_rk

  !> A facet of n corners (3 or 4 different nodes).
  type :: facet_part
    integer :: num_corners = 0
    integer :: node(4) = 0 !< positions in the mesh
    logical :: is_bare = .true. !< too little of it is covered
    real(rk) :: area = 0.0_rk !< covered [m2]
    real(rk) :: diagonal(4) = 0.0_rk !< D_a [m2]
    real(rk) :: normal(3, 4) = 0.0_rk !< int N_a n dA, out of the slave's solid [m2]
    real(rk) :: gap(4) = 0.0_rk !< int phi_a gap dA [m3]
    real(rk), allocatable :: coupling(:, :, :) !< (4, 4, segments) int phi_a N_m dA [m2]
    real(rk), allocatable :: pressed(:, :, :) !< (3, 4, segments) int N_m n dA [m2]
  end type facet_part

contains

  !> Integrates over the segments of one slave facet.
  subroutine integrate_facet(x, slave, master, segments, own, points, part)
    real(rk), intent(in) :: x(:, :) !< (3, nodes) [m]
    type(facet_set), intent(in) :: slave, master
    type(segment_set), intent(in) :: segments
    integer, intent(in) :: own(:) !< its segments, at least one
    type(segment_points), intent(inout) :: points !< room
    type(facet_part), intent(out) :: part
    real(rk) :: mass(4, 4), fold(4, 4), n(4)
    integer :: s, q, a
    call fold_corners(slave%node(:, segments%slave(own(1))), part, fold)
    allocate (part%coupling(4, 4, size(own)), part%pressed(3, 4, size(own)), source=0.0_rk)
    mass = 0.0_rk
    do s = 1, size(own)
      call integrate_segment(x, slave, master, segments, own(s), points)
      do q = 1, points%num_points
        n = matmul(fold, points%slave_shape(:, q))
        part%area = part%area + points%area(q)
        do a = 1, 4
          mass(:, a) = mass(:, a) + points%area(q)*n(a)*n
          part%coupling(:, a, s) = part%coupling(:, a, s) &
                                   + points%area(q)*points%master_shape(a, q)*n
          part%normal(:, a) = part%normal(:, a) + points%area(q)*n(a)*points%normal(:, q)
          part%pressed(:, a, s) = part%pressed(:, a, s) &
                                  + points%area(q)*points%master_shape(a, q)*points%normal(:, q)
        end do
        part%gap = part%gap + points%area(q)*points%gap(q)*n
      end do
    end do
    part%diagonal = sum(mass, dim=2)
    part%is_bare = part%area < least_part*facet_area(x(:, slave%node(:, segments%slave(own(1)))))
    if (.not. part%is_bare) call make_dual(mass, part)
  end subroutine integrate_facet

  !> The different corners of a facet, and the matrix that adds up the shape functions of one node.
  pure subroutine fold_corners(nodes, part, fold)
    integer, intent(in) :: nodes(4)
    type(facet_part), intent(inout) :: part
    real(rk), intent(out) :: fold(4, 4)
    integer :: a, k
    fold = 0.0_rk
    do a = 1, 4
      do k = 1, part%num_corners
        if (part%node(k) == nodes(a)) exit
      end do
      part%num_corners = max(part%num_corners, k)
      part%node(k) = nodes(a)
      fold(k, a) = 1.0_rk
    end do
  end subroutine fold_corners

  !> Computes integrals of phi_a from those of N_a. M is scaled to a unit diagonal first, so that a
  !> covered strip along one side of the facet does not spoil its inverse.
  subroutine make_dual(mass, part)
    real(rk), intent(in) :: mass(4, 4)
    type(facet_part), intent(inout) :: part
    real(rk), allocatable :: scaled(:, :), right(:, :), dual(:, :)
    integer :: n, a, s
    logical :: is_singular
    n = part%num_corners
    allocate (scaled(n, n), right(n, n), dual(n, n))
    right = 0.0_rk
    do a = 1, n
      right(a, a) = 1.0_rk/sqrt(mass(a, a))
    end do
    scaled = matmul(right, matmul(mass(:n, :n), right))
    call solve_dense(scaled, right, dual, is_singular)
    part%is_bare = is_singular
    if (is_singular) return
    dual = matmul(right, dual)
    do a = 1, n
      dual(a, :) = part%diagonal(a)*dual(a, :)
    end do
    do s = 1, size(part%coupling, 3)
      part%coupling(:n, :, s) = matmul(dual, part%coupling(:n, :, s))
    end do
    part%gap(:n) = matmul(dual, part%gap(:n))
  end subroutine make_dual

  !> Shares of the dual functions of bound corners: phi_a + sum_b share(a, b) phi_b. A bound corner
  !> gives its function to its free neighbours on the facet, else to the opposite corner.
  pure subroutine share_bound(part, is_bound, share)
    type(facet_part), intent(in) :: part
    logical, intent(in) :: is_bound(4) !< (corners)
    real(rk), intent(out) :: share(4, 4) !< row: takes, column: gives; zero where none is bound
    logical :: takes(4)
    integer :: b, n
    n = part%num_corners
    share = 0.0_rk
    do b = 1, n
      if (.not. is_bound(b)) cycle
      takes = .false.
      takes([1 + mod(b, n), 1 + mod(b + n - 2, n)]) = .true.
      takes = takes .and. .not. is_bound
      if (.not. any(takes)) then
        takes(1 + mod(b + 1, n)) = .true.
        takes = takes .and. .not. is_bound
      end if
      if (any(takes)) share(:, b) = merge(1.0_rk/count(takes), 0.0_rk, takes)
    end do
  end subroutine share_bound

  !> The shorter of the two lengths of a facet, from middle to middle of opposite sides [m].
  pure real(rk) function facet_extent(x) result(extent)
    real(rk), intent(in) :: x(3, 4) !< corners [m]
    extent = 0.5_rk*min(norm2(x(:, 1) + x(:, 2) - x(:, 3) - x(:, 4)), &
                        norm2(x(:, 2) + x(:, 3) - x(:, 4) - x(:, 1)))
  end function facet_extent
end module mortar_facet
