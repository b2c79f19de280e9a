!> Stresses of points alone, without energies and tangents: what the iterations of a structure need.
!> They are those of damage_point for RECOVERY=LEE-FENVES and ENERGY without viscosity, to
!> round-off, found for many points side by side, without principal directions and copies of
!> histories.
module damage_stress
  use crack_band, only: band_width
  use damage_flows, only: find_kinematics, find_parts, find_residuals, flow_block, keep_flows, &
                          most_points
  use damage_history, only: last_damage, last_measure, last_strain, width_row
  use damage_increment, only: yield_tolerance
  use damage_model, only: concrete_model, place_curves, placed_curves
  use damage_split, only: fractions_left => stiffness_left, left_after
  use damage_trials, only: find_trials, trial_block
  use flow_search, only: find_flows, flow_ends
  use kinds, only: rk
  use material_points, only: point_set, point_state
  use tensor6, only: principal_axes
  implicit none
  private
  public :: has_plain_stress, find_stresses

contains

  !> Whether `find_stresses` can be used.
  pure logical function has_plain_stress(model)
    type(concrete_model), intent(in) :: model
    has_plain_stress = .not. (model%recovers_by_sign .or. model%viscosity > 0.0_rk)
  end function has_plain_stress

  !> Stresses and histories of the points without an answer.
  pure subroutine find_stresses(model, points, old, placed, new, has_answer)
    type(concrete_model), intent(in) :: model
    type(point_set), intent(in) :: points
    type(point_state), intent(in) :: old
    type(placed_curves), intent(inout) :: placed !< curves, kept by the caller
    type(point_state), intent(inout) :: new !< with strains
    logical, intent(inout) :: has_answer(:) !< (points) on return false where the return map failed
    integer :: pending(most_points), n, i
    n = 0
    do i = 1, points%num_points
      if (.not. has_answer(i)) then
        n = n + 1
        pending(n) = i
      end if
      if (n == most_points .or. (n > 0 .and. i == points%num_points)) then
        call find_block(model, points, pending(:n), old, placed, new, has_answer)
        n = 0
      end if
    end do
  end subroutine find_stresses

  !> Stresses and histories of the points of a list, in one part of the increment; see
  !> integrate_part. Without convergence more parts are needed.
  pure subroutine find_block(model, points, list, old, placed, new, has_answer)
    type(concrete_model), intent(in) :: model
    type(point_set), intent(in) :: points
    integer, intent(in) :: list(:) !< at most most_points
    type(point_state), intent(in) :: old
    type(placed_curves), intent(inout) :: placed
    type(point_state), intent(inout) :: new
    logical, intent(inout) :: has_answer(:)
    type(trial_block) :: trials
    type(flow_block) :: b
    type(flow_ends) :: ends
    integer :: k, n, yielding(most_points)
    real(rk) :: size_of_f
    call find_trials(model, list, new%strain, old%internal, trials)
    call open_block(model, points, list, old, trials, placed, b)
    call revise_widths(model, points, list, trials, placed, b)
    n = 0
    do k = 1, size(list)
      size_of_f = abs(b%f(k))
      ends%has_converged(k) = .false.
      if (.not. size_of_f < huge(1.0_rk)) cycle ! NaN
      if (b%f(k) > yield_tolerance*b%compression%strength(k)) then
        n = n + 1
        yielding(n) = k
        if (b%width(k) <= 0.0_rk) then
          b%width(k) = width_at(points%edges(:, :, list(k)), trials%deviator(:, k))
        end if
      else
        call take_trial(b, k, old%internal(:, list(k)), ends)
      end if
    end do
    if (n > 0) then
      ends%width(yielding(:n)) = b%width(yielding(:n))
      call keep_flows(yielding(:n), b)
      call find_flows(model, placed, b, ends)
    end if
    do k = 1, size(list)
      has_answer(list(k)) = ends%has_converged(k)
      if (ends%has_converged(k)) call take_end(model, trials, k, ends, list(k), new)
    end do
  end subroutine find_block

  !> F of the trial states.
  pure subroutine open_block(model, points, list, old, trials, placed, b)
    type(concrete_model), intent(in) :: model
    type(point_set), intent(in) :: points
    integer, intent(in) :: list(:)
    type(point_state), intent(in) :: old
    type(trial_block), intent(in) :: trials
    type(placed_curves), intent(inout) :: placed
    type(flow_block), intent(out) :: b
    integer :: k, i
    b%num_points = size(list)
    do k = 1, size(list)
      i = list(k)
      b%place(k) = k
      b%q_trial(k) = trials%q(k)
      b%p_trial(k) = trials%p(k)
      b%shape1(k) = trials%shape(1, k)
      b%shape2(k) = trials%shape(2, k)
      b%shape3(k) = trials%shape(3, k)
      b%cracking(k) = old%internal(last_strain + 1, i)
      b%crushing(k) = old%internal(last_measure, i)
      b%tension%measure(k) = b%cracking(k)
      b%compression%measure(k) = b%crushing(k)
      b%tension%row(k) = 0
      b%compression%row(k) = 0
      b%y(k) = 0.0_rk
      b%width(k) = old%internal(width_row, i)
      if (model%by_opening .and. b%width(k) <= 0.0_rk) then
        b%width(k) = width_at(points%edges(:, :, i), trials%deviator(:, k))
      end if
    end do
    call find_parts(model, placed, b)
    call find_kinematics(model, b)
    call find_residuals(model, b)
  end subroutine open_block

  !> Takes the present width, and F with it, where a point yields whose crack is not noticeable yet;
  !> see revises_width. Points that do not yield with it keep their history.
  pure subroutine revise_widths(model, points, list, trials, placed, b)
    type(concrete_model), intent(in) :: model
    type(point_set), intent(in) :: points
    integer, intent(in) :: list(:)
    type(trial_block), intent(in) :: trials
    type(placed_curves), intent(inout) :: placed
    type(flow_block), intent(inout) :: b
    logical :: has_revised
    integer :: k
    if (.not. model%by_opening) return
    has_revised = .false.
    do k = 1, b%num_points
      if (.not. b%f(k) > yield_tolerance*b%compression%strength(k)) cycle
      if (b%tension%row(k) > model%tension%noticeable_row .or. b%cracking(k) <= 0.0_rk) cycle
      call place_curves(model, b%width(k), placed)
      if (b%cracking(k) >= placed%noticeable) cycle
      b%width(k) = width_at(points%edges(:, :, list(k)), trials%deviator(:, k))
      b%tension%row(k) = 0
      has_revised = .true.
    end do
    if (.not. has_revised) return
    call find_parts(model, placed, b)
    call find_kinematics(model, b)
    call find_residuals(model, b)
  end subroutine revise_widths

  !> Width of a crack band normal to the largest principal stress [m].
  pure real(rk) function width_at(edges, deviator) result(width)
    real(rk), intent(in) :: edges(3, 3), deviator(6)
    real(rk) :: principal(3), axes(3, 3)
    call principal_axes(deviator, principal, axes)
    width = band_width(edges, axes(:, 1))
  end function width_at

  !> The trial state is the end of the increment.
  pure subroutine take_trial(b, k, internal, ends)
    type(flow_block), intent(in) :: b
    integer, intent(in) :: k
    real(rk), intent(in) :: internal(:) !< at the start of the increment
    type(flow_ends), intent(inout) :: ends
    ends%has_converged(k) = .true.
    ends%x(k) = 0.0_rk
    ends%q(k) = b%q(k)
    ends%p(k) = b%p(k)
    ends%radius(k) = b%radius(k)
    ends%share(k) = b%share(k)
    ends%kappa_t(k) = b%cracking(k)
    ends%kappa_c(k) = b%crushing(k)
    ends%d_t(k) = internal(last_measure + 1)
    ends%d_c(k) = internal(last_damage)
    ends%width(k) = internal(width_row)
  end subroutine take_trial

  !> Writes the end of an increment to the state of a point.
  pure subroutine take_end(model, trials, k, ends, i, new)
    type(concrete_model), intent(in) :: model
    type(trial_block), intent(in) :: trials
    integer, intent(in) :: k, i !< place in the list, point
    type(flow_ends), intent(in) :: ends
    type(point_state), intent(inout) :: new !< with the old history
    real(rk) :: slip, swelling
    slip = 1.5_rk*ends%x(k)*ends%q(k)/ends%radius(k)
    swelling = ends%x(k)*model%tan_dilation/3.0_rk
    associate (shape => trials%deviator(:, k), internal => new%internal(:, i), &
               stress => new%stress(:, i))
      if (ends%x(k) > 0.0_rk) then
        internal(1:3) = internal(1:3) + slip*shape(1:3) + swelling
        internal(4:last_strain) = internal(4:last_strain) + 2.0_rk*slip*shape(4:6)
        internal(last_strain + 1) = ends%kappa_t(k)
        internal(last_measure) = ends%kappa_c(k)
        internal(last_measure + 1) = max(internal(last_measure + 1), ends%d_t(k)) ! as update_point
        internal(last_damage) = max(internal(last_damage), ends%d_c(k))
        if (ends%kappa_t(k) > 0.0_rk) internal(width_row) = ends%width(k)
      end if
      stress = ends%q(k)*shape
      stress(1:3) = stress(1:3) - ends%p(k)
      if (model%splits_energy) then
        call take_left(model, internal(last_measure + 1), internal(last_damage), &
                       ends%q(k)*trials%shape(:, k) - ends%p(k), stress)
      else
        stress = stiffness_left(model, ends%d_t(k), ends%d_c(k), ends%share(k))*stress
      end if
    end associate
    new%is_elastic(i) = .not. (ends%x(k) > 0.0_rk .or. ends%kappa_t(k) > 0.0_rk &
                               .or. ends%kappa_c(k) > 0.0_rk)
  end subroutine take_end

  !> left_t sigma_t + left_c sigma_c of RECOVERY=ENERGY (see damage_split), sigma_c by the
  !> projection P_i = (S - s_j)(S - s_k)/((s_i - s_j)(s_i - s_k)) on one principal direction. Where
  !> the first one alone opens, sigma_c is S - k s_1 - (1 - k) s_1 P_1, k = nu/(1 - nu), and
  !> s_1 - s_2 is at least (1 - k) s_1. Where the third one alone does not, it is E e_3 P_3, and
  !> s_2 - s_3 is at least -E e_3. Values that are near to each other therefore cost no digits.
  pure subroutine take_left(model, tension, compression, s, stress)
    type(concrete_model), intent(in) :: model
    real(rk), intent(in) :: tension, compression !< d_t, d_c
    real(rk), intent(in) :: s(3) !< principal effective stresses, the largest first [Pa]
    real(rk), intent(inout) :: stress(6) !< effective on entry, nominal on return [Pa]
    type(fractions_left) :: left
    real(rk) :: k, pressed(6), third
    call left_after(model, tension, compression, left)
    k = model%poisson/(1.0_rk - model%poisson)
    third = s(3) - model%poisson*(s(1) + s(2)) ! E e_3
    if (s(1) <= 0.0_rk) then
      stress = left%value(2)*stress
    else if (s(2) <= k*s(1)) then
      pressed = stress - (1.0_rk - k)*s(1)*projection(stress, s(1), s(2), s(3))
      pressed(1:3) = pressed(1:3) - k*s(1)
      stress = left%value(1)*stress + (left%value(2) - left%value(1))*pressed
    else if (third < 0.0_rk) then
      stress = left%value(1)*stress + (left%value(2) - left%value(1))*third &
               *projection(stress, s(3), s(1), s(2))
    else
      stress = left%value(1)*stress
    end if
  end subroutine take_left

  !> Projection on the direction of one principal value of a tensor.
  pure function projection(t, own, second, third) result(on_own)
    real(rk), intent(in) :: t(6), own, second, third !< tensor and its principal values
    real(rk) :: on_own(6)
    real(rk) :: a(3), b(3)
    a = t(1:3) - second
    b = t(1:3) - third
    on_own = [a(1)*b(1) + t(4)**2 + t(5)**2, t(4)**2 + a(2)*b(2) + t(6)**2, &
              t(5)**2 + t(6)**2 + a(3)*b(3), t(4)*(b(2) + a(1)) + t(5)*t(6), &
              t(5)*(b(3) + a(1)) + t(4)*t(6), t(6)*(b(3) + a(2)) + t(4)*t(5)] &
             /((own - second)*(own - third))
  end function projection

  !> 1 - d of Eqs. 15-16 (see total_damage).
  pure real(rk) function stiffness_left(model, tension, compression, share) result(left)
    type(concrete_model), intent(in) :: model
    real(rk), intent(in) :: tension, compression, share !< d_t, d_c, r
    left = (1.0_rk - (1.0_rk - model%tension_recovery*share)*compression) &
           *(1.0_rk - (1.0_rk - model%compression_recovery*(1.0_rk - share))*tension)
  end function stiffness_left
end module damage_stress
