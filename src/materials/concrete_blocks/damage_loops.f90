!> Loops over points of concrete in the copy for this processor (cmake/WideCopies.cmake). Both
!> copies give the same numbers to round-off.
module damage_loops
  use damage_model, only: concrete_model, placed_curves
  use damage_stress, only: find_stresses, has_plain_stress
  use damage_stress_wide, only: find_stresses_wide => find_stresses
  use damage_trials, only: screen_points
  use damage_trials_wide, only: screen_points_wide => screen_points
  use kinds, only: rk
  use material_points, only: point_set, point_state
  use processor_features, only: has_wide_registers
  implicit none
  private
  public :: screen_adjacent, find_plain_stresses, has_plain_stress

contains

  !> Elastic stress and energy of virgin points, and whether they are certainly elastic; see
  !> screen_points.
  pure subroutine screen_adjacent(model, factor, strain, stress, energy, is_within)
    type(concrete_model), intent(in) :: model
    real(rk), intent(in) :: factor(:) !< (points)
    real(rk), intent(in), contiguous :: strain(:, :) !< (6, points)
    real(rk), intent(inout), contiguous :: stress(:, :) !< (6, points) [Pa]
    real(rk), intent(out) :: energy(:) !< (points) [J/m3]
    logical, intent(out) :: is_within(:) !< (points)
    if (has_wide_registers()) then
      call screen_points_wide(model, factor, strain, stress, energy, is_within)
    else
      call screen_points(model, factor, strain, stress, energy, is_within)
    end if
  end subroutine screen_adjacent

  !> Stresses and histories of the points without an answer; see find_stresses.
  pure subroutine find_plain_stresses(model, points, old, placed, new, has_answer)
    type(concrete_model), intent(in) :: model
    type(point_set), intent(in) :: points
    type(point_state), intent(in) :: old
    type(placed_curves), intent(inout) :: placed !< curves, kept by the caller
    type(point_state), intent(inout) :: new !< with strains
    logical, intent(inout) :: has_answer(:) !< (points)
    if (has_wide_registers()) then
      call find_stresses_wide(model, points, old, placed, new, has_answer)
    else
      call find_stresses(model, points, old, placed, new, has_answer)
    end if
  end subroutine find_plain_stresses
end module damage_loops
