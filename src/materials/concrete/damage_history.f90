!> Internal variables of a point of plastic-damage concrete as a list of numbers.
!>
!> Internal variables of a point:
!>
!> | number | meaning |
!> |---|---|
!> | 1-6 | plastic strain 11 22 33 12 13 23, engineering shear |
!> | 7, 8 | kappa_t, kappa_c: measures of cracking and crushing |
!> | 9, 10 | d_t, d_c |
!> | 11 | width of the crack band [m], 0 before the first crack |
!> | 12-17 | with viscosity only: plastic strain without viscosity |
module damage_history
  use damage_states, only: point_history
  use kinds, only: rk
  implicit none
  private
  public :: last_strain, last_measure, last_damage, width_row, last_backbone
  public :: unpack_history, pack_history

  !> Positions in the list.
  integer, parameter :: last_strain = 6, last_measure = 8, last_damage = 10, width_row = 11
  integer, parameter :: last_backbone = 17

contains

  !> Reads the history of a point from its internal variables.
  pure subroutine unpack_history(internal, history)
    real(rk), intent(in) :: internal(:)
    type(point_history), intent(out) :: history
    history%plastic_strain = internal(:last_strain)
    history%backbone%measures = internal(last_strain + 1:last_measure)
    history%damage = internal(last_measure + 1:last_damage)
    history%backbone%width = internal(width_row)
    history%backbone%strain = history%plastic_strain
    if (size(internal) == last_backbone) history%backbone%strain = internal(width_row + 1:)
  end subroutine unpack_history

  !> Writes the history of a point to its internal variables.
  pure subroutine pack_history(history, internal)
    type(point_history), intent(in) :: history
    real(rk), intent(inout) :: internal(:)
    internal(:last_strain) = history%plastic_strain
    internal(last_strain + 1:last_measure) = history%backbone%measures
    internal(last_measure + 1:last_damage) = history%damage
    internal(width_row) = history%backbone%width
    if (size(internal) == last_backbone) internal(width_row + 1:) = history%backbone%strain
  end subroutine pack_history
end module damage_history
