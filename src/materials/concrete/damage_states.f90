!> Histories, motions and answers of points of plastic-damage concrete.
module damage_states
  use damage_increment, only: plastic_state
  use damage_split, only: energy_split, stiffness_left
  use damage_yield, only: damage_gradient
  use kinds, only: rk
  implicit none
  private
  public :: point_history, point_motion, point_answer, end_state

  !> History of a point.
  type :: point_history
    type(plastic_state) :: backbone !< without viscosity: plastic strain, kappa_t, kappa_c, width
    real(rk) :: plastic_strain(6) = 0.0_rk !< with viscosity
    real(rk) :: damage(2) = 0.0_rk !< d_t, d_c of the stress
  end type point_history

  !> Strains, element and time of an increment.
  type :: point_motion
    real(rk) :: before(6) = 0.0_rk, strain(6) = 0.0_rk !< strains at both ends, engineering shear
    real(rk) :: edges(3, 3) = 0.0_rk !< columns: edges of its element [m]; an isotropic length l as
    !! l times the unit matrix
    real(rk) :: time = 0.0_rk !< of the increment, for viscosity [s]
    real(rk) :: stored = 0.0_rk !< energy at its start [J/m3]
    logical :: wants_tangent = .true.
    logical :: wants_energy = .true. !< stored, dissipated and created energy
    !> The symmetric (1 - d) D instead of the consistent tangent. It also replaces a consistent
    !> tangent that does not exist: see has_regular_flow.
    logical :: is_secant = .false.
    logical :: holds_switch = .false. !< r of Eq. 17 keeps its value from the start of the increment
  end type point_motion

  !> Result of an increment.
  type :: point_answer
    real(rk) :: stress(6) = 0.0_rk !< [Pa]
    real(rk) :: tangent(6, 6) = 0.0_rk !< d stress/d strain [Pa]
    real(rk) :: stored = 0.0_rk !< stress : elastic strain/2 [J/m3]
    real(rk) :: fracture = 0.0_rk, crushing = 0.0_rk !< dissipated in the increment [J/m3]
    real(rk) :: created = 0.0_rk !< by recovery of stiffness in the increment [J/m3]
    logical :: is_elastic = .true. !< never yielded
    logical :: has_converged = .true.
  end type point_answer

  !> Stress and damage at the end of an increment.
  type :: end_state
    real(rk) :: stress(6) = 0.0_rk !< effective [Pa]
    real(rk) :: principal(3) = 0.0_rk, axes(3, 3) = 0.0_rk !< of the stress
    real(rk) :: lag = 0.0_rk !< share of the previous history after relaxation
    real(rk) :: share = 0.0_rk, share_by(3) = 0.0_rk !< r of the stiffness, dr/ds_i
    type(damage_gradient) :: d
    type(energy_split) :: split !< RECOVERY=ENERGY; else d counts
    type(stiffness_left) :: left
  end type end_state
end module damage_states
