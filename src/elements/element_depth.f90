!> How deep a solid element is behind one of its faces.
module element_depth
  use dam_mesh, only: mesh
  use kinds, only: rk
  use mesh_faces, only: face_vector
  use shape_hex8, only: edges_at
  use small_matrix, only: determinant3
  implicit none
  private
  public :: depth_behind

contains

  !> Volume over area [m]; exact for a parallelepiped. Huge for a face without area.
  pure real(rk) function depth_behind(body, element, facet) result(depth)
    type(mesh), intent(in) :: body
    integer, intent(in) :: element !< position of the solid
    integer, intent(in) :: facet(4) !< its nodes
    real(rk) :: volume, area
    volume = determinant3(edges_at(body%x(:, body%nodes(:, element)), [0.0_rk, 0.0_rk, 0.0_rk]))
    area = norm2(face_vector(body%x(:, facet)))
    depth = huge(1.0_rk)
    if (area > 0.0_rk) depth = abs(volume)/area
  end function depth_behind
end module element_depth
