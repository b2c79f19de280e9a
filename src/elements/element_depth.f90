!> How deep a solid element is behind one of its faces.
module element_depth
  use dam_mesh, only: mesh
  use kinds, only: rk
  use mesh_faces, only: face_vector
  use shape_hex8, only: edges_at
  implicit none
  private
  public :: depth_behind

contains

  !> Volume over area [m]; exact for a parallelepiped. Huge for a face without area.
  pure real(rk) function depth_behind(body, element, facet) result(depth)
    type(mesh), intent(in) :: body
    integer, intent(in) :: element !< position of the solid
    integer, intent(in) :: facet(4) !< its nodes
    real(rk) :: e(3, 3), volume, area
    e = edges_at(body%x(:, body%nodes(:, element)), [0.0_rk, 0.0_rk, 0.0_rk])
    volume = e(1, 1)*(e(2, 2)*e(3, 3) - e(3, 2)*e(2, 3)) &
             - e(1, 2)*(e(2, 1)*e(3, 3) - e(3, 1)*e(2, 3)) &
             + e(1, 3)*(e(2, 1)*e(3, 2) - e(3, 1)*e(2, 2))
    area = norm2(face_vector(body%x(:, facet)))
    depth = huge(1.0_rk)
    if (area > 0.0_rk) depth = abs(volume)/area
  end function depth_behind
end module element_depth
