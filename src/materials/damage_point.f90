!> A point of plastic-damage concrete: all that one increment does to it. The kernel of the material
!> of the deck and of the user subroutine for other programs.
module damage_point
  use damage_energy, only: dissipated_work, end_of_increment, onset_of_flow
  use damage_increment, only: elastic_stress, increment_result, integrate_increment, plastic_state
  use damage_model, only: concrete_model, placed_curves, stiffness_of
  use damage_yield, only: damage_gradient, tension_share, total_damage
  use kinds, only: rk
  use tensor6, only: principal_values, trace
  implicit none
  private
  public :: point_history, point_motion, point_answer, update_point

  !> What a point remembers.
  type :: point_history
    type(plastic_state) :: backbone !< plastic strain as without viscosity, kappa_t, kappa_c, width
    real(rk) :: plastic_strain(6) = 0.0_rk !< that of the stress; the backbone's without viscosity
    real(rk) :: damage(2) = 0.0_rk !< d_t, d_c of the stress
  end type point_history

  !> What happens to it.
  type :: point_motion
    real(rk) :: before(6) = 0.0_rk, strain(6) = 0.0_rk !< strains at both ends, engineering shear
    real(rk) :: edges(3, 3) = 0.0_rk !< columns: edges of its element [m]; an isotropic length l as
    !! l times the unit matrix
    real(rk) :: time = 0.0_rk !< the increment takes [s]; for viscosity
    logical :: wants_tangent = .true.
    logical :: is_secant = .false. !< the symmetric (1 - d) D instead of the consistent tangent
  end type point_motion

  !> What it answers.
  type :: point_answer
    real(rk) :: stress(6) = 0.0_rk !< [Pa]
    real(rk) :: tangent(6, 6) = 0.0_rk !< d stress/d strain [Pa]
    real(rk) :: stored = 0.0_rk !< stress : elastic strain/2 [J/m3]
    real(rk) :: fracture = 0.0_rk, crushing = 0.0_rk !< dissipated in the increment [J/m3]
    logical :: is_elastic = .true. !< never yielded
    logical :: has_converged = .true.
  end type point_answer

contains

  !> Stress, history, energies and tangent at the end of an increment.
  !>
  !> Where the increment had to be cut into parts the tangent is the secant one.
  pure subroutine update_point(model, motion, old, placed, new, answer)
    type(concrete_model), intent(in) :: model
    type(point_motion), intent(in) :: motion
    type(point_history), intent(in) :: old
    type(placed_curves), intent(inout) :: placed !< room for curves, kept by the caller
    type(point_history), intent(out) :: new
    type(point_answer), intent(out) :: answer
    type(increment_result) :: backbone
    type(damage_gradient) :: d, d_before
    type(end_of_increment) :: finish
    real(rk) :: effective(6), share, lag, work
    call integrate_increment(model, motion%before, motion%strain, motion%edges, old%backbone, &
                             placed, backbone)
    answer%has_converged = backbone%has_converged
    new%backbone = backbone%state
    new%plastic_strain = backbone%state%strain
    new%damage = [backbone%flow%tension%damage, backbone%flow%compression%damage]
    effective = backbone%stress
    if (model%viscosity > 0.0_rk) then
      lag = model%viscosity/(model%viscosity + motion%time)
      new%plastic_strain = new%plastic_strain + lag*(old%plastic_strain - new%plastic_strain)
      new%damage = new%damage + lag*(old%damage - new%damage)
      effective = elastic_stress(model, motion%strain - new%plastic_strain)
    end if
    share = recovery_share(model, effective)
    d = total_damage(model, new%damage(1), new%damage(2), share)
    d_before = total_damage(model, old%damage(1), old%damage(2), share)
    answer%stress = (1.0_rk - d%value)*effective
    answer%is_elastic = .not. backbone%has_yielded .and. all(old%backbone%measures <= 0.0_rk)
    answer%stored = 0.5_rk*dot_product(answer%stress, motion%strain - new%plastic_strain)
    if (backbone%has_yielded .or. model%viscosity > 0.0_rk) then
      finish%stress = effective
      finish%flow = new%plastic_strain - old%plastic_strain
      finish%damages = [d_before%value, d%value]
      work = work_of(model, motion, old, placed, backbone, finish)
      answer%fracture = backbone%flow%share*work
      answer%crushing = (1.0_rk - backbone%flow%share)*work
    end if
    if (motion%wants_tangent) then
      call stiffness_of(model, answer%tangent)
      answer%tangent = (1.0_rk - d%value)*answer%tangent
    end if
  end subroutine update_point

  !> What the increment dissipates.
  pure real(rk) function work_of(model, motion, old, placed, backbone, finish) result(work)
    type(concrete_model), intent(in) :: model
    type(point_motion), intent(in) :: motion
    type(point_history), intent(in) :: old
    type(placed_curves), intent(in) :: placed
    type(increment_result), intent(in) :: backbone
    type(end_of_increment), intent(in) :: finish
    real(rk) :: onset(6), trial(6)
    onset = elastic_stress(model, motion%before - old%plastic_strain)
    if (model%viscosity <= 0.0_rk) then
      trial = elastic_stress(model, motion%strain - old%plastic_strain)
      onset = onset_of_flow(model, placed, onset, old%backbone, trial, backbone%trial_excess)
    end if
    work = dissipated_work(model, onset, finish)
  end function work_of

  !> r of the stiffness, Eq 17 or NOTES 8.
  pure real(rk) function recovery_share(model, stress) result(share)
    type(concrete_model), intent(in) :: model
    real(rk), intent(in) :: stress(6) !< effective [Pa]
    real(rk) :: gradient(3)
    if (model%recovers_by_sign) then
      share = merge(1.0_rk, 0.0_rk, trace(stress) > 0.0_rk)
    else
      call tension_share(principal_values(stress), share, gradient)
    end if
  end function recovery_share
end module damage_point
