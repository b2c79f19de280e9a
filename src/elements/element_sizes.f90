!> Lengths of solid elements: the depth behind a face, and the widths of crack bands.
module element_sizes
  use crack_band, only: extreme_widths
  use dam_mesh, only: fe_mesh
  use element_catalogue, only: make_solid
  use element_formulation, only: solid_element
  use gauss_rules, only: hex_point
  use kinds, only: rk
  use mesh_faces, only: face_vector
  use shape_hex8, only: edges_at
  use small_matrix, only: determinant3
  implicit none
  private
  public :: depth_behind, measure_widths

contains

  !> Depth of a solid element behind one of its faces: volume over area [m]; exact for a
  !> parallelepiped, huge for a face without area.
  pure real(rk) function depth_behind(mesh, element, facet) result(depth)
    type(fe_mesh), intent(in) :: mesh
    integer, intent(in) :: element !< position of the solid
    integer, intent(in) :: facet(4) !< its nodes
    real(rk) :: volume, area
    volume = determinant3(edges_at(mesh%x(:, mesh%nodes(:, element)), [0.0_rk, 0.0_rk, 0.0_rk]))
    area = norm2(face_vector(mesh%x(:, facet)))
    depth = huge(1.0_rk)
    if (area > 0.0_rk) depth = abs(volume)/area
  end function depth_behind

  !> Smallest and largest width of a crack band at the integration points of solid elements, over
  !> all directions of the crack.
  subroutine measure_widths(mesh, elements, smallest, largest)
    type(fe_mesh), intent(in) :: mesh
    integer, intent(in) :: elements(:) !< positions
    real(rk), intent(out) :: smallest(:), largest(:) !< (elements) [m]
    class(solid_element), allocatable :: formulation
    real(rk) :: x(3, 8), least, most
    integer :: i, q
    do i = 1, size(elements)
      call choose_formulation(mesh%element_type(elements(i)), formulation)
      x = mesh%x(:, mesh%nodes(:, elements(i)))
      smallest(i) = huge(1.0_rk)
      largest(i) = 0.0_rk
      do q = 1, formulation%num_points
        if (formulation%num_points == 1) then
          call extreme_widths(edges_at(x, [0.0_rk, 0.0_rk, 0.0_rk]), least, most)
        else
          call extreme_widths(edges_at(x, hex_point(:, q)), least, most)
        end if
        smallest(i) = min(smallest(i), least)
        largest(i) = max(largest(i), most)
      end do
    end do
  end subroutine measure_widths

  !> Makes the formulation of a kind, unless the formulation has this kind already.
  subroutine choose_formulation(kind, formulation)
    character(*), intent(in) :: kind
    class(solid_element), allocatable, intent(inout) :: formulation
    if (allocated(formulation)) then
      if (formulation%name == kind) return
    end if
    call make_solid(kind, formulation)
  end subroutine choose_formulation
end module element_sizes
