!> Dissipation at a point of plastic-damage concrete in an increment (theory.md, (11.19)).
module damage_energy
  use damage_curves, only: curve_value, value_of_curve
  use damage_increment, only: plastic_state
  use damage_model, only: concrete_model, placed_curves
  use damage_split, only: energy_split, nominal_stress, split_stress, stiffness_left, tension_at
  use damage_yield, only: damage_gradient, tension_share, total_damage, yield_at, yield_value
  use kinds, only: rk
  use tensor6, only: principal_axes, principal_values, second_invariant, trace
  implicit none
  private
  public :: flow_path, onset_of_flow, dissipated_work, dissipated_by_split, created_work
  public :: crushing_share, fraction_of_crushing, stored_work

  !> Crushing starts at this fraction of the strength in compression, and is full at the strength.
  real(rk), parameter :: start_of_crushing = 0.95_rk
  integer, parameter :: num_parts = 4 !< of a path, for the mean of energies on it
  !> The square of a change of strain counts this fraction of the energies more, as in (12.6): their
  !> difference is round-off where it is smaller.
  real(rk), parameter :: smallest_square = 1.0e-10_rk

  !> Plastic flow and damage of an increment.
  type :: flow_path
    !> Effective stresses: at the start, at first yield, at the end [Pa]
    real(rk) :: start(6) = 0.0_rk, onset(6) = 0.0_rk, finish(6) = 0.0_rk
    real(rk) :: flow(6) = 0.0_rk !< increment of plastic strain, engineering shear
    real(rk) :: growth(2) = 0.0_rk !< of d_t, d_c
    real(rk) :: damages(2) = 0.0_rk !< d at start and end, both with the final weight r
  end type flow_path

contains

  !> Effective stress at first yield on the straight path from the start of an increment to its
  !> trial state, with F linear on the path.
  pure function onset_of_flow(model, placed, start, old, trial, trial_excess) result(onset)
    type(concrete_model), intent(in) :: model
    type(placed_curves), intent(in) :: placed
    real(rk), intent(in) :: start(6) !< effective stress [Pa]
    type(plastic_state), intent(in) :: old
    real(rk), intent(in) :: trial(6), trial_excess !< effective stress and its F [Pa]
    real(rk) :: onset(6)
    type(curve_value) :: tension, compression
    type(yield_value) :: f
    real(rk) :: principal(3)
    integer :: rows(2)
    rows = 1
    call tension_at(model, placed, old%measures(1), rows(1), tension)
    call value_of_curve(model%compression, placed%compression, 1.0_rk, old%measures(2), rows(2), &
                        compression)
    principal = principal_values(start)
    f = yield_at(model, sqrt(3.0_rk*second_invariant(start)), -trace(start)/3.0_rk, principal(1), &
                 tension%strength, compression%strength)
    onset = start
    if (f%value < 0.0_rk) then
      onset = start - f%value/(trial_excess - f%value)*(trial - start)
    end if
  end function onset_of_flow

  !> Work of the plastic strain, and energy released by damage at constant weight of recovery. The
  !> stress of the increment is the mean of onset and end. If its work is negative (reversal within
  !> a large increment), the stress at the end is taken, whose work is not negative (see
  !> largest_safe_dilation). With viscosity the plastic strain lags, and its work is what it is.
  pure function dissipated_work(model, path) result(work)
    type(concrete_model), intent(in) :: model
    type(flow_path), intent(in) :: path
    real(rk) :: work(2) !< by flow, by damage [J/m3]
    real(rk) :: intact
    associate (damages => path%damages)
      intact = 1.0_rk - 0.5_rk*(damages(1) + damages(2))
      work(1) = intact*0.5_rk*dot_product(path%onset + path%finish, path%flow)
      if (work(1) < 0.0_rk .and. model%viscosity <= 0.0_rk) then
        work(1) = (1.0_rk - damages(2))*dot_product(path%finish, path%flow)
      end if
      work(2) = 0.5_rk*(damages(2) - damages(1)) &
                *(undamaged_energy(model, path%onset) + undamaged_energy(model, path%finish))
    end associate
  end function dissipated_work

  !> The same with RECOVERY=ENERGY: each part of the effective stress has its own stiffness and its
  !> own energy. Without viscosity the work of flow is not negative; with viscosity the plastic
  !> strain lags, and its work is what it is.
  pure subroutine dissipated_by_split(model, path, old, new, work, losses)
    type(concrete_model), intent(in) :: model
    type(flow_path), intent(in) :: path
    type(stiffness_left), intent(in) :: old, new !< at both ends of the increment
    real(rk), intent(out) :: work(2) !< by flow, by damage [J/m3]
    real(rk), intent(out) :: losses(2) !< of the work of damage, those by d_t and d_c [J/m3]
    real(rk) :: left(2), energy(2), nominal(6, 2), parts(2, 2), mean(6)
    left = 0.5_rk*(old%value + new%value)
    call split_at(model, path%onset, left, nominal(:, 1), parts(:, 1))
    call split_at(model, path%finish, left, nominal(:, 2), parts(:, 2))
    energy = 0.5_rk*(parts(:, 1) + parts(:, 2))
    mean = 0.5_rk*(nominal(:, 1) + nominal(:, 2))
    if (model%viscosity > 0.0_rk) then
      mean = mean_of_path(model, path, mean, dot_product(left, parts(:, 2) - parts(:, 1)), &
                          dot_product(left, parts(:, 2) + parts(:, 1)))
    end if
    work(1) = dot_product(mean, path%flow)
    if (model%viscosity <= 0.0_rk) work(1) = max(work(1), 0.0_rk)
    work(2) = dot_product(energy, old%value - new%value)
    losses = -matmul(energy, new%by_damage)*path%growth
  end subroutine dissipated_by_split

  !> The mean stress whose work in the change of elastic strain is the change of free energy, like
  !> that of the path: the mean of both ends with the correction of (12.6). Plastic strain that lags
  !> moves also where the strain stays; what it dissipates is then what the free energy loses.
  pure function mean_of_path(model, path, mean, change, both) result(stress)
    type(concrete_model), intent(in) :: model
    type(flow_path), intent(in) :: path
    real(rk), intent(in) :: mean(6) !< of both ends [Pa]
    real(rk), intent(in) :: change, both !< difference and sum of the free energies [J/m3]
    real(rk) :: stress(6)
    real(rk) :: moved(6), strain(6), square
    moved = path%finish - path%onset
    strain(1:3) = ((1.0_rk + model%poisson)*moved(1:3) - model%poisson*trace(moved))/model%young
    strain(4:6) = moved(4:6)/model%shear
    square = dot_product(moved, strain) + smallest_square*both
    stress = mean
    if (square > 0.0_rk) stress = mean + (change - dot_product(mean, strain))/square*moved
  end function mean_of_path

  !> Nominal stress and both energies of an effective stress.
  pure subroutine split_at(model, stress, left, nominal, energy)
    type(concrete_model), intent(in) :: model
    real(rk), intent(in) :: stress(6) !< [Pa]
    real(rk), intent(in) :: left(2) !< of the stiffness of both parts
    real(rk), intent(out) :: nominal(6) !< [Pa]
    real(rk), intent(out) :: energy(2) !< without damage [J/m3]
    type(energy_split) :: split
    real(rk) :: s(3), axes(3, 3)
    call principal_axes(stress, s, axes)
    call split_stress(model, s, split)
    nominal = nominal_stress(stress, axes, split, left)
    energy = split%energy
  end subroutine split_at

  !> Energy that the weight of recovery creates on a straight path of effective stress at constant
  !> damage: the integral of -W_0 dd(r), because a part of the stiffness comes and goes under load.
  !> It is zero where r is 1, or 0, at both ends: such stresses are a convex set.
  pure real(rk) function created_work(model, from, to, damage) result(work)
    type(concrete_model), intent(in) :: model
    real(rk), intent(in) :: from(6), to(6) !< [Pa]
    real(rk), intent(in) :: damage(2) !< d_t, d_c
    type(damage_gradient) :: d(2)
    real(rk) :: stress(6), energy(2), share(0:num_parts)
    integer :: i
    work = 0.0_rk
    if (.not. any(abs(to - from) > 0.0_rk)) return
    share(0) = weight_of(model, from)
    share(num_parts) = weight_of(model, to)
    if (all(share([0, num_parts]) >= 1.0_rk) .or. all(share([0, num_parts]) <= 0.0_rk)) return
    do i = 0, num_parts
      stress = from + (to - from)*i/num_parts
      if (i > 0 .and. i < num_parts) share(i) = weight_of(model, stress)
      energy(2) = undamaged_energy(model, stress)
      d(2) = total_damage(model, damage(1), damage(2), share(i))
      if (i > 0) work = work - 0.5_rk*sum(energy)*(d(2)%value - d(1)%value)
      energy(1) = energy(2)
      d(1) = d(2)
    end do
  end function created_work

  !> Energy of an effective stress with the weight r of this stress [J/m3].
  pure real(rk) function stored_work(model, stress, damage) result(work)
    type(concrete_model), intent(in) :: model
    real(rk), intent(in) :: stress(6) !< [Pa]
    real(rk), intent(in) :: damage(2) !< d_t, d_c
    type(damage_gradient) :: d
    d = total_damage(model, damage(1), damage(2), weight_of(model, stress))
    work = (1.0_rk - d%value)*undamaged_energy(model, stress)
  end function stored_work

  !> r of Eq. 17 or of paper_notes.md, 8.
  pure real(rk) function weight_of(model, stress) result(share)
    type(concrete_model), intent(in) :: model
    real(rk), intent(in) :: stress(6) !< effective [Pa]
    real(rk) :: gradient(3)
    if (model%recovers_by_sign) then
      share = merge(1.0_rk, 0.0_rk, trace(stress) > 0.0_rk)
    else
      call tension_share(principal_values(stress), share, gradient)
    end if
  end function weight_of

  !> Share of crushing in the work of flow: the work in principal directions under pressure, where
  !> the largest pressure is the strength in compression. Below the strength a crack that slides or
  !> opens under pressure along its faces does this work.
  pure real(rk) function crushing_share(s, flow, strength) result(share)
    real(rk), intent(in) :: s(3) !< principal effective stresses [Pa]
    real(rk), intent(in) :: flow(3) !< in their directions, of any size
    real(rk), intent(in) :: strength !< effective, in compression [Pa]
    real(rk) :: whole
    whole = dot_product(s, flow)
    share = merge(0.0_rk, 1.0_rk, s(1) > 0.0_rk)
    if (whole > 0.0_rk) share = min(1.0_rk, max(0.0_rk, sum(s*flow, s < 0.0_rk)/whole))
    share = share*fraction_of_crushing(s(3), strength)
  end function crushing_share

  !> 0 up to a pressure just below the strength in compression, 1 from the strength on.
  pure real(rk) function fraction_of_crushing(smallest, strength) result(fraction)
    real(rk), intent(in) :: smallest !< principal effective stress [Pa]
    real(rk), intent(in) :: strength !< effective, in compression [Pa]
    fraction = (-smallest/strength - start_of_crushing)/(1.0_rk - start_of_crushing)
    fraction = min(1.0_rk, max(0.0_rk, fraction))
  end function fraction_of_crushing

  !> Elastic energy of an effective stress without damage [J/m3].
  pure real(rk) function undamaged_energy(model, stress) result(energy)
    type(concrete_model), intent(in) :: model
    real(rk), intent(in) :: stress(6)
    energy = second_invariant(stress)/(2.0_rk*model%shear) + trace(stress)**2/(18.0_rk*model%bulk)
  end function undamaged_energy
end module damage_energy
