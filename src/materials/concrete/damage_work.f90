!> Energies of an increment at a point of plastic-damage concrete, stored, dissipated and created,
!> from the states at its start and at its end (theory.md, (11.19)).
module damage_work
  use crack_band, only: band_width
  use damage_curves, only: value_of_curve
  use damage_energy, only: created_work, crushing_share, dissipated_by_split, dissipated_work, &
                           flow_path, fraction_of_crushing, onset_of_flow, stored_work
  use damage_increment, only: deviator_of, elastic_stress, increment_result
  use damage_model, only: concrete_model, place_curves, placed_curves
  use damage_return, only: flow_by
  use damage_split, only: left_after, stiffness_left
  use damage_states, only: end_state, point_answer, point_history, point_motion
  use damage_yield, only: damage_gradient, tension_share, total_damage
  use kinds, only: rk
  use tensor6, only: principal_axes, principal_values, second_invariant, trace
  implicit none
  private
  public :: find_energies, complete_energies

contains

  !> Energies of an increment whose end is known, without viscosity, for RECOVERY=LEE-FENVES and
  !> ENERGY: those of `find_energies` to round-off, without a return map.
  pure subroutine complete_energies(model, motion, old, new, placed, answer)
    type(concrete_model), intent(in) :: model
    type(point_motion), intent(in) :: motion
    type(point_history), intent(in) :: old, new
    type(placed_curves), intent(inout) :: placed !< curves, kept by the caller
    type(point_answer), intent(inout) :: answer !< with the stress
    type(increment_result) :: backbone
    type(end_state) :: finish
    finish%stress = elastic_stress(model, motion%strain - new%plastic_strain)
    backbone%has_yielded = any(abs(new%plastic_strain - old%plastic_strain) > 0.0_rk)
    if (backbone%has_yielded) call recall_flow(model, motion, old, new, placed, finish, backbone)
    call find_energies(model, motion, old, placed, backbone, finish, new, answer)
  end subroutine complete_energies

  !> Trial state, flow and damage of an increment whose end is known. The flow is coaxial: principal
  !> directions of the deviator are those of the trial state.
  pure subroutine recall_flow(model, motion, old, new, placed, finish, backbone)
    type(concrete_model), intent(in) :: model
    type(point_motion), intent(in) :: motion
    type(point_history), intent(in) :: old, new
    type(placed_curves), intent(inout) :: placed
    type(end_state), intent(inout) :: finish !< with the effective stress
    type(increment_result), intent(inout) :: backbone
    real(rk) :: stress(6), deviator(6)
    associate (trial => backbone%trial, flow => backbone%flow)
      stress = elastic_stress(model, motion%strain - old%plastic_strain)
      deviator = deviator_of(stress)
      trial%p = -trace(stress)/3.0_rk
      trial%q = sqrt(3.0_rk*second_invariant(deviator))
      if (trial%q > 0.0_rk) trial%shape = principal_values(deviator)/trial%q
      trial%measures = old%backbone%measures
      call place_curves(model, width_of(model, motion, new, deviator), placed)
      call flow_by(model, placed, trial, 0.0_rk, flow)
      backbone%trial_excess = flow%f%value
      flow%q = sqrt(3.0_rk*second_invariant(finish%stress))
      flow%radius = sqrt(placed%rounding**2 + flow%q**2)
      flow%s = flow%q*trial%shape + trace(finish%stress)/3.0_rk
      call value_of_curve(model%compression, placed%compression, 1.0_rk, &
                          new%backbone%measures(2), flow%rows(2), flow%compression)
      if (model%splits_energy) then
        call left_after(model, new%damage(1), new%damage(2), finish%left)
      else
        call tension_share(flow%s, finish%share, finish%share_by)
        finish%d = total_damage(model, new%damage(1), new%damage(2), finish%share)
      end if
    end associate
  end subroutine recall_flow

  !> Width of the crack band [m]. A point that has crushed without cracking has kept none: it is
  !> that of the direction of the trial state.
  pure real(rk) function width_of(model, motion, new, deviator) result(width)
    type(concrete_model), intent(in) :: model
    type(point_motion), intent(in) :: motion
    type(point_history), intent(in) :: new
    real(rk), intent(in) :: deviator(6) !< of the trial state [Pa]
    real(rk) :: principal(3), axes(3, 3)
    width = new%backbone%width
    if (width > 0.0_rk) return
    width = 1.0_rk
    if (.not. model%by_opening) return
    call principal_axes(deviator, principal, axes)
    width = band_width(motion%edges, axes(:, 1))
  end function width_of

  !> Stored, dissipated and created energy.
  pure subroutine find_energies(model, motion, old, placed, backbone, finish, new, answer)
    type(concrete_model), intent(in) :: model
    type(point_motion), intent(in) :: motion
    type(point_history), intent(in) :: old
    type(placed_curves), intent(in) :: placed
    type(increment_result), intent(in) :: backbone
    type(end_state), intent(in) :: finish
    type(point_history), intent(in) :: new
    type(point_answer), intent(inout) :: answer !< with the stress
    type(flow_path) :: path
    answer%stored = 0.5_rk*dot_product(answer%stress, motion%strain - new%plastic_strain)
    call find_path(model, motion, old, placed, backbone, finish, new, path)
    if (backbone%has_yielded .or. model%viscosity > 0.0_rk) then
      call dissipate(model, old, backbone, finish, path, answer)
    end if
    call count_created(model, motion, old, path, answer)
  end subroutine find_energies

  !> The path of the effective stress in the increment.
  pure subroutine find_path(model, motion, old, placed, backbone, finish, new, path)
    type(concrete_model), intent(in) :: model
    type(point_motion), intent(in) :: motion
    type(point_history), intent(in) :: old
    type(placed_curves), intent(in) :: placed
    type(increment_result), intent(in) :: backbone
    type(end_state), intent(in) :: finish
    type(point_history), intent(in) :: new
    type(flow_path), intent(out) :: path
    real(rk) :: trial(6)
    path%start = elastic_stress(model, motion%before - old%plastic_strain)
    path%onset = path%start
    path%finish = finish%stress
    path%flow = new%plastic_strain - old%plastic_strain
    path%growth = new%damage - old%damage
    if (model%viscosity > 0.0_rk) return
    path%onset = path%finish
    if (.not. backbone%has_yielded) return
    trial = elastic_stress(model, motion%strain - old%plastic_strain)
    path%onset = onset_of_flow(model, placed, path%start, old%backbone, trial, &
                               backbone%trial_excess)
  end subroutine find_path

  !> Energy created by the recovery of stiffness in the increment. A switch that is held creates
  !> none; what it holds back is created when it is free again.
  pure subroutine count_created(model, motion, old, path, answer)
    type(concrete_model), intent(in) :: model
    type(point_motion), intent(in) :: motion
    type(point_history), intent(in) :: old
    type(flow_path), intent(in) :: path
    type(point_answer), intent(inout) :: answer !< its created energy is set
    if (model%splits_energy .or. all(old%damage + path%growth <= 0.0_rk)) return
    if (model%recovers_by_sign) then
      if (motion%holds_switch .and. any(old%damage > 0.0_rk)) return
      answer%created = stored_work(model, path%start, old%damage) - motion%stored
    end if
    answer%created = answer%created + created_work(model, path%start, path%onset, old%damage) &
                     + created_work(model, path%onset, path%finish, old%damage + 0.5_rk*path%growth)
  end subroutine count_created

  !> Dissipation of the increment. Work of flow under pressures that have the strength in
  !> compression is crushing, other work of flow cracking; work of damage likewise, by d_c and d_t.
  pure subroutine dissipate(model, old, backbone, finish, path, answer)
    type(concrete_model), intent(in) :: model
    type(point_history), intent(in) :: old
    type(increment_result), intent(in) :: backbone
    type(end_state), intent(in) :: finish
    type(flow_path), intent(inout) :: path
    type(point_answer), intent(inout) :: answer !< its fracture and crushing are set
    type(stiffness_left) :: left
    type(damage_gradient) :: before
    real(rk) :: work(2), share(2), losses(2)
    if (model%splits_energy) then
      call left_after(model, old%damage(1), old%damage(2), left)
      call dissipated_by_split(model, path, left, finish%left, work, losses)
    else
      before = total_damage(model, old%damage(1), old%damage(2), finish%share)
      path%damages = [before%value, finish%d%value]
      work = dissipated_work(model, path)
      losses = [finish%d%by_tension, finish%d%by_compression]*path%growth
    end if
    associate (flow => backbone%flow)
      share(1) = crushing_share(flow%s, 1.5_rk*flow%q/flow%radius*backbone%trial%shape &
                                + model%tan_dilation/3.0_rk, flow%compression%strength)
      share(2) = 0.0_rk
      if (losses(2) > 0.0_rk) then
        share(2) = losses(2)/sum(losses)*fraction_of_crushing(flow%s(3), flow%compression%strength)
      end if
    end associate
    answer%fracture = dot_product(1.0_rk - share, work)
    answer%crushing = dot_product(share, work)
  end subroutine dissipate
end module damage_work
