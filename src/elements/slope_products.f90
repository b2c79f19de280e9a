!> Products with slopes of the shape functions of a hexahedron, in the copy for this processor
!> (cmake/WideCopies.cmake). Both copies give the same numbers to round-off.
module slope_products
  use hex8_slopes, only: add_forces_of_slopes, slopes_at_points, strains_of_slopes
  use hex8_slopes_wide, only: add_forces_wide => add_forces_of_slopes, &
                              slopes_wide => slopes_at_points, strains_wide => strains_of_slopes
  use kinds, only: rk
  use processor_features, only: has_wide_registers
  use shape_hex8, only: hex8_dofs
  implicit none
  private
  public :: find_slopes, find_symmetric_gradient, add_forces_of_stress

contains

  !> Slopes and volumes at the points; see slopes_at_points.
  pure subroutine find_slopes(x, slope, weight, status)
    real(rk), intent(in) :: x(3, 8) !< corners [m]
    real(rk), intent(out) :: slope(8, 3, 8) !< (point, direction, node) [1/m]
    real(rk), intent(out) :: weight(8) !< [m3]
    integer, intent(out) :: status !< 0, or the worst corner
    if (has_wide_registers()) then
      call slopes_wide(x, slope, weight, status)
    else
      call slopes_at_points(x, slope, weight, status)
    end if
  end subroutine find_slopes

  !> The symmetric gradient of displacements at the points; see strains_of_slopes.
  pure subroutine find_symmetric_gradient(slope, u, strain)
    real(rk), intent(in) :: slope(8, 3, 8) !< (point, direction, node) [1/m]
    real(rk), intent(in) :: u(hex8_dofs) !< [m]
    real(rk), intent(out) :: strain(6, 8)
    if (has_wide_registers()) then
      call strains_wide(slope, u, strain)
    else
      call strains_of_slopes(slope, u, strain)
    end if
  end subroutine find_symmetric_gradient

  !> Adds the forces of stresses at the points; see add_forces_of_slopes.
  pure subroutine add_forces_of_stress(slope, stress, force)
    real(rk), intent(in) :: slope(8, 3, 8) !< (point, direction, node) [1/m]
    real(rk), intent(in) :: stress(8, 6) !< (point, component) times volumes of points [N m]
    real(rk), intent(inout) :: force(hex8_dofs) !< [N]
    if (has_wide_registers()) then
      call add_forces_wide(slope, stress, force)
    else
      call add_forces_of_slopes(slope, stress, force)
    end if
  end subroutine add_forces_of_stress
end module slope_products
