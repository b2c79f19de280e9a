!> One increment at a point of plastic-damage concrete: kernel of the material of the deck and of
!> the user subroutine for other programs.
module damage_point
  use damage_increment, only: elastic_stress, increment_result, integrate_increment
  use damage_model, only: concrete_model, placed_curves, stiffness_of
  use damage_split, only: left_after, nominal_stress, split_stress, stiffness_of_split
  use damage_states, only: end_state, point_answer, point_history, point_motion
  use damage_tangent, only: effective_tangent, has_regular_flow, share_row
  use damage_work, only: find_energies
  use damage_yield, only: tension_share, total_damage
  use kinds, only: rk
  use tensor6, only: principal_axes
  implicit none
  private
  public :: update_point

contains

  !> Stress, history, energies and tangent at the end of an increment.
  pure subroutine update_point(model, motion, old, placed, new, answer)
    type(concrete_model), intent(in) :: model
    type(point_motion), intent(in) :: motion
    type(point_history), intent(in) :: old
    type(placed_curves), intent(inout) :: placed !< curves, kept by the caller
    type(point_history), intent(out) :: new
    type(point_answer), intent(out) :: answer
    type(increment_result) :: backbone
    type(end_state) :: finish
    call integrate_increment(model, motion%before, motion%strain, motion%edges, old%backbone, &
                             placed, backbone)
    answer%has_converged = backbone%has_converged
    answer%is_elastic = .not. backbone%has_yielded .and. all(old%backbone%measures <= 0.0_rk)
    new%backbone = backbone%state
    new%plastic_strain = backbone%state%strain
    ! A crack whose width is revised would lose damage where the band becomes narrower.
    new%damage = max([backbone%flow%tension%damage, backbone%flow%compression%damage], old%damage)
    finish%stress = backbone%stress
    finish%axes = backbone%axes
    finish%principal = backbone%flow%s
    if (model%viscosity > 0.0_rk) call relax(model, motion, old, new, finish)
    if (model%splits_energy) then
      call split_stress(model, finish%principal, finish%split)
      call left_after(model, new%damage(1), new%damage(2), finish%left)
      answer%stress = nominal_stress(finish%stress, finish%axes, finish%split, finish%left%value)
    else
      call recover(model, motion, old, new%damage, finish)
      answer%stress = (1.0_rk - finish%d%value)*finish%stress
    end if
    if (motion%wants_energy) then
      call find_energies(model, motion, old, placed, backbone, finish, new, answer)
    end if
    if (.not. motion%wants_tangent) return
    if (motion%is_secant .or. .not. has_regular_flow(model, backbone)) then
      call find_secant(model, finish, answer%tangent)
    else
      call differentiate_stress(model, backbone, finish, answer%tangent)
    end if
  end subroutine update_point

  !> Relaxes plastic strain and damage (Duvaut and Lions; theory.md, (11.17)) by the implicit rule.
  !> The weight of recovery is not relaxed: cracks close at once.
  pure subroutine relax(model, motion, old, new, finish)
    type(concrete_model), intent(in) :: model
    type(point_motion), intent(in) :: motion
    type(point_history), intent(in) :: old
    type(point_history), intent(inout) :: new !< on entry without viscosity
    type(end_state), intent(inout) :: finish
    finish%lag = model%viscosity/(model%viscosity + motion%time)
    new%plastic_strain = new%plastic_strain + finish%lag*(old%plastic_strain - new%plastic_strain)
    new%damage = new%damage + finish%lag*(old%damage - new%damage)
    finish%stress = elastic_stress(model, motion%strain - new%plastic_strain)
    call principal_axes(finish%stress, finish%principal, finish%axes)
  end subroutine relax

  !> r of the stiffness, Eq. 17 or paper_notes.md, 8, and d. A held switch keeps its initial value,
  !> unless the point was undamaged.
  pure subroutine recover(model, motion, old, damage, finish)
    type(concrete_model), intent(in) :: model
    type(point_motion), intent(in) :: motion
    type(point_history), intent(in) :: old
    real(rk), intent(in) :: damage(2) !< d_t, d_c
    type(end_state), intent(inout) :: finish
    real(rk) :: stretch
    if (model%recovers_by_sign) then
      stretch = sum(finish%principal)
      if (motion%holds_switch .and. any(old%damage > 0.0_rk)) then
        stretch = sum(motion%before(1:3) - old%plastic_strain(1:3))
      end if
      finish%share = merge(1.0_rk, 0.0_rk, stretch > 0.0_rk)
      finish%share_by = 0.0_rk
    else
      call tension_share(finish%principal, finish%share, finish%share_by)
    end if
    finish%d = total_damage(model, damage(1), damage(2), finish%share)
  end subroutine recover

  !> Derivative of the stress by the elastic strain at constant damage and weight r.
  pure subroutine find_secant(model, finish, secant)
    type(concrete_model), intent(in) :: model
    type(end_state), intent(in) :: finish
    real(rk), intent(out) :: secant(6, 6)
    if (model%splits_energy) then
      call stiffness_of_split(model, finish%axes, finish%split, finish%left%value, secant)
    else
      call stiffness_of(model, secant)
      secant = (1.0_rk - finish%d%value)*secant
    end if
  end subroutine find_secant

  !> d stress/d strain = (1 - d) ds/d strain - s (dd/d strain)^T, theory.md, (11.16).
  pure subroutine differentiate_stress(model, backbone, finish, tangent)
    type(concrete_model), intent(in) :: model
    type(increment_result), intent(in) :: backbone
    type(end_state), intent(in) :: finish
    real(rk), intent(out) :: tangent(6, 6)
    real(rk) :: measures(6, 2), damage(6), elastic(6, 6), slopes(2)
    integer :: i
    call effective_tangent(model, backbone, tangent, measures)
    if (model%viscosity > 0.0_rk) then
      call stiffness_of(model, elastic)
      tangent = tangent + finish%lag*(elastic - tangent)
    end if
    slopes = (1.0_rk - finish%lag)*[backbone%flow%tension%damage_slope, &
                                    backbone%flow%compression%damage_slope]
    if (model%splits_energy) then
      measures = measures*spread(slopes, 1, 6)
      call differentiate_split(model, finish, measures, tangent)
      return
    end if
    damage = matmul(measures, slopes*[finish%d%by_tension, finish%d%by_compression])
    if (abs(finish%d%by_share) > 0.0_rk .and. any(abs(finish%share_by) > 0.0_rk)) then
      damage = damage + finish%d%by_share*share_row(finish%share_by, finish%axes, tangent)
    end if
    do i = 1, 6
      tangent(:, i) = (1.0_rk - finish%d%value)*tangent(:, i) - finish%stress*damage(i)
    end do
  end subroutine differentiate_stress

  !> The same with RECOVERY=ENERGY, theory.md, (11.16a).
  pure subroutine differentiate_split(model, finish, damages, tangent)
    type(concrete_model), intent(in) :: model
    type(end_state), intent(in) :: finish
    real(rk), intent(in) :: damages(6, 2) !< derivatives of d_t, d_c by the strain
    real(rk), intent(inout) :: tangent(6, 6) !< on entry that of the effective stress [Pa]
    real(rk) :: frozen(6, 6), strain(6), parts(6, 2), by_damage(6, 2)
    integer :: i
    call stiffness_of_split(model, finish%axes, finish%split, finish%left%value, frozen)
    parts(:, 1) = nominal_stress(finish%stress, finish%axes, finish%split, [1.0_rk, 0.0_rk])
    parts(:, 2) = finish%stress - parts(:, 1)
    by_damage = matmul(parts, finish%left%by_damage)
    do i = 1, 6
      associate (column => tangent(:, i))
        strain(1:3) = ((1.0_rk + model%poisson)*column(1:3) - model%poisson*sum(column(1:3))) &
                      /model%young
        strain(4:6) = column(4:6)/model%shear
      end associate
      tangent(:, i) = matmul(frozen, strain) + matmul(by_damage, damages(i, :))
    end do
  end subroutine differentiate_split
end module damage_point
