!> The stress of a point alone, without energies and tangent: what the iterations of a structure
!> need. It is that of damage_point for RECOVERY=LEE-FENVES without viscosity, to round-off, without
!> principal directions and copies of histories.
module damage_stress
  use crack_band, only: band_width
  use damage_history, only: last_damage, last_measure, last_strain, width_row
  use damage_increment, only: yield_tolerance
  use damage_model, only: concrete_model, place_curves, placed_curves
  use damage_point, only: point_answer
  use damage_return, only: find_flow, flow_by, flow_state, trial_state
  use damage_yield, only: damage_gradient, total_damage
  use kinds, only: rk
  use tensor6, only: principal_axes
  implicit none
  private
  public :: has_plain_stress, find_stress

contains

  !> Whether `find_stress` can be used.
  pure logical function has_plain_stress(model)
    type(concrete_model), intent(in) :: model
    has_plain_stress = .not. (model%splits_energy .or. model%recovers_by_sign &
                              .or. model%viscosity > 0.0_rk)
  end function has_plain_stress

  !> Stress and history at the end of an increment, in one part; see integrate_part.
  !> Without convergence more parts are needed.
  pure subroutine find_stress(model, trial, deviator, edges, old, placed, new, answer)
    type(concrete_model), intent(in) :: model
    type(trial_state), intent(in) :: trial
    real(rk), intent(in) :: deviator(6) !< S_tr/q_tr
    real(rk), intent(in) :: edges(3, 3) !< of the element at the point, columns [m]
    real(rk), intent(in) :: old(:) !< internal variables
    type(placed_curves), intent(inout) :: placed !< curves, kept by the caller
    real(rk), intent(inout) :: new(:) !< internal variables
    type(point_answer), intent(inout) :: answer !< its stress and its logicals are set
    type(flow_state) :: flow
    real(rk) :: width
    logical :: has_yielded
    width = old(width_row)
    if (model%by_opening .and. width <= 0.0_rk) width = width_at(edges, deviator)
    call place_curves(model, width, placed)
    call flow_by(model, placed, trial, 0.0_rk, flow)
    answer%has_converged = abs(flow%f%value) < huge(width) ! not for NaN
    if (.not. answer%has_converged) return
    new = old
    has_yielded = flow%f%value > yield_tolerance*flow%compression%strength
    if (has_yielded) then
      if (width <= 0.0_rk) width = width_at(edges, deviator)
      call find_flow(model, placed, trial, flow, answer%has_converged)
      call take_flow(model, flow, deviator, width, new)
    end if
    call take_stress(model, flow, deviator, new(last_measure + 1:last_damage), answer%stress)
    answer%is_elastic = .not. has_yielded .and. all(trial%measures <= 0.0_rk)
  end subroutine find_stress

  !> Width of a crack band normal to the largest principal stress [m].
  pure real(rk) function width_at(edges, deviator) result(width)
    real(rk), intent(in) :: edges(3, 3), deviator(6)
    real(rk) :: principal(3), axes(3, 3)
    call principal_axes(deviator, principal, axes)
    width = band_width(edges, axes(:, 1))
  end function width_at

  !> History after flow.
  pure subroutine take_flow(model, flow, shape, width, internal)
    type(concrete_model), intent(in) :: model
    type(flow_state), intent(in) :: flow
    real(rk), intent(in) :: shape(6) !< S_tr/q_tr
    real(rk), intent(in) :: width !< [m]
    real(rk), intent(inout) :: internal(:)
    real(rk) :: size
    size = 1.5_rk*flow%x*flow%q/flow%radius
    internal(1:3) = internal(1:3) + size*shape(1:3) + flow%x*model%tan_dilation/3.0_rk
    internal(4:last_strain) = internal(4:last_strain) + 2.0_rk*size*shape(4:6)
    internal(last_strain + 1:last_measure) = flow%measures
    internal(last_measure + 1:last_damage) = [flow%tension%damage, flow%compression%damage]
    if (flow%measures(1) > 0.0_rk) internal(width_row) = width
  end subroutine take_flow

  !> (1 - d) times the effective stress.
  pure subroutine take_stress(model, flow, shape, damage, stress)
    type(concrete_model), intent(in) :: model
    type(flow_state), intent(in) :: flow
    real(rk), intent(in) :: shape(6) !< S_tr/q_tr
    real(rk), intent(in) :: damage(2) !< d_t, d_c
    real(rk), intent(out) :: stress(6) !< [Pa]
    type(damage_gradient) :: d
    stress = flow%q*shape
    stress(1:3) = stress(1:3) - flow%p
    if (any(damage > 0.0_rk)) then
      d = total_damage(model, damage(1), damage(2), flow%share)
      stress = (1.0_rk - d%value)*stress
    end if
  end subroutine take_stress
end module damage_stress
