!> Divides the elements among the ranks by METIS: about the same work, borders that couple little.
!>
!> An incomplete factor of a rank leaves out what couples it to others. Where a border runs through
!> thin bricks side by side, conjugate gradients take several times as many iterations.
module element_parts
  use, intrinsic :: iso_c_binding, only: c_double, c_int
  use dam_mesh, only: fe_mesh
  use errors, only: error_type, raise, system_failed
  use kinds, only: rk
  use ranks, only: add_over_ranks, is_first_rank, num_ranks, share_error
  implicit none
  private
  public :: divide_elements

  interface
    function keyway_divide_mesh(num_elements, num_nodes, first, node, x, num_parts, part) &
      result(status) bind(c)
      import :: c_double, c_int
      implicit none
      integer(c_int), value :: num_elements, num_nodes, num_parts
      integer(c_int), intent(in) :: first(num_elements + 1), node(first(num_elements + 1))
      real(c_double), intent(in) :: x(3, num_elements)
      integer(c_int), intent(out) :: part(num_elements)
      integer(c_int) :: status
    end function keyway_divide_mesh
  end interface

contains

  !> Gives each element with a material to a rank; the other elements to the first one. Rank 0
  !> divides the mesh, because METIS takes more memory than the mesh.
  subroutine divide_elements(mesh, error)
    type(fe_mesh), intent(inout) :: mesh
    type(error_type), allocatable, intent(out) :: error
    integer, allocatable :: solid(:), part(:)
    real(rk), allocatable :: shared(:)
    integer :: k
    solid = pack([(k, k=1, mesh%num_elements)], mesh%material_of_element > 0)
    allocate (mesh%rank_of_element(mesh%num_elements), source=0)
    if (num_ranks() == 1) return
    if (size(solid) < num_ranks()) return
    allocate (shared(size(solid)), source=0.0_rk)
    if (is_first_rank()) then
      call divide_solids(mesh, solid, part, error)
      if (.not. allocated(error)) shared(:) = part
    end if
    call share_error(error)
    if (allocated(error)) return
    call add_over_ranks(shared)
    mesh%rank_of_element(solid) = nint(shared)
  end subroutine divide_elements

  !> The part of each solid.
  subroutine divide_solids(mesh, solid, part, error)
    type(fe_mesh), intent(in) :: mesh
    integer, intent(in) :: solid(:) !< elements
    integer, allocatable, intent(out) :: part(:) !< (solids) from 0
    type(error_type), allocatable, intent(out) :: error
    integer(c_int), allocatable :: first(:), node(:), found(:)
    real(c_double), allocatable :: x(:, :) !< (3, solids) centres
    integer :: k, a, last
    allocate (first(size(solid) + 1), node(8*size(solid)), found(size(solid)), x(3, size(solid)))
    first(1) = 0
    last = 0
    do k = 1, size(solid)
      do a = 1, 8
        if (mesh%nodes(a, solid(k)) == 0) cycle
        last = last + 1
        node(last) = int(mesh%nodes(a, solid(k)) - 1, c_int)
      end do
      first(k + 1) = int(last, c_int)
      x(:, k) = real(centre(mesh%x(:, node(first(k) + 1:last) + 1)), c_double)
    end do
    if (keyway_divide_mesh(int(size(solid), c_int), int(mesh%num_nodes, c_int), first, &
                           node(:last), x, int(num_ranks(), c_int), found) /= 0) then
      call raise(error, 'METIS could not divide the elements among the processes', system_failed)
      return
    end if
    part = int(found)
  end subroutine divide_solids

  !> The mean of some places.
  pure function centre(x)
    real(rk), intent(in) :: x(:, :) !< (3, places)
    real(rk) :: centre(3)
    centre = sum(x, dim=2)/size(x, 2)
  end function centre
end module element_parts
