!> Lists of facets: of surfaces of solids, and of interface quads.
module surface_facets
  use dam_mesh, only: fe_mesh, surface
  use mesh_faces, only: count_corners, face_nodes
  use surface_segments, only: facet_set
  implicit none
  private
  public :: list_surface_facets, list_interface_facets, mark_corners

contains

  !> The facets of a surface of solids; faces collapsed to an edge are left out.
  pure subroutine list_surface_facets(mesh, faces, facets)
    type(fe_mesh), intent(in) :: mesh
    type(surface), intent(in) :: faces
    type(facet_set), intent(out) :: facets
    integer :: i, used
    allocate (facets%node(4, size(faces%element)), facets%element(size(faces%element)))
    used = 0
    do i = 1, size(faces%element)
      facets%node(:, used + 1) = face_nodes(mesh, faces%element(i), faces%face(i))
      if (count_corners(facets%node(:, used + 1)) < 3) cycle
      used = used + 1
      facets%element(used) = faces%element(i)
    end do
    facets%node = facets%node(:, :used)
    facets%element = facets%element(:used)
  end subroutine list_surface_facets

  !> The facets of IFACE4 elements. They have no solid, so their normals have no outward side.
  pure subroutine list_interface_facets(mesh, elements, facets)
    type(fe_mesh), intent(in) :: mesh
    integer, intent(in) :: elements(:) !< positions
    type(facet_set), intent(out) :: facets
    integer :: i
    allocate (facets%node(4, size(elements)))
    do i = 1, size(elements)
      facets%node(:, i) = mesh%nodes(1:4, elements(i))
    end do
    allocate (facets%element(size(elements)), source=0)
  end subroutine list_interface_facets

  !> Marks the nodes that are corners of these facets.
  pure function mark_corners(num_nodes, facets) result(is_corner)
    integer, intent(in) :: num_nodes !< of the mesh
    type(facet_set), intent(in) :: facets
    logical :: is_corner(num_nodes)
    integer :: f
    is_corner = .false.
    do f = 1, size(facets%node, 2)
      is_corner(facets%node(:, f)) = .true.
    end do
  end function mark_corners
end module surface_facets
