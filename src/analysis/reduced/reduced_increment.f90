!> One increment of HHT with a reduced model (theory.md, 7.4), for the modes y and for the forces w
!> of the ports that the rest follows:
!>
!>   y''   + [(1 + alpha)(Lambda y + C y')_1 - alpha (..)_0] = (P Phi)^T p
!>   mu w'' + [(1 + alpha)(w + beta w')_1    - alpha (..)_0] = p
!>
!> p are the forces of the ports: loads weighted as the bulk, joints as in the full model. Where
!> solids have no mass the rest has two parts, each with its w, mu and beta.
module reduced_increment
  use analysis_state, only: modal_motion, motion, state
  use amplitudes, only: amplitude
  use dense_products, only: times_vector
  use equilibrium, only: balance_outcome, force_balance
  use hht_scheme, only: hht
  use joint_forces, only: gather_jumps, gather_tractions, take_origins
  use joint_operator, only: jump_operator
  use kinds, only: rk
  use mixed_products, only: mixed_times, mixed_transposed_times
  use problem_definition, only: problem
  use reduced_basis, only: reduced_model
  use reduced_scheme, only: force_of, reduced_matrices
  use step_loads, only: factor_at, load_group, step_time
  use step_plan, only: step_controls
  implicit none
  private
  public :: load_factors, port_forces, to_parts, modal_forces, take_reduced_increment, find_rates

contains

  !> Factors of the loads beyond those at the start of the step. Two more loads follow: the forces
  !> that were not balanced at the start, and one without force whose work is that of the stress at
  !> the start.
  function load_factors(groups, amplitudes, when, start) result(factor)
    type(load_group), intent(in) :: groups(:)
    type(amplitude), intent(in) :: amplitudes(:)
    type(step_time), intent(in) :: when
    real(rk), intent(in) :: start(:) !< (groups)
    real(rk) :: factor(size(groups) + 2)
    integer :: k
    do k = 1, size(groups)
      associate (rule => groups(k)%rule)
        factor(k) = factor_at(rule%start_factor, rule%end_factor, rule%amplitude, amplitudes, when)
      end associate
    end do
    factor(:size(groups)) = factor(:size(groups)) - start
    factor(size(groups) + 1:) = [1.0_rk, 0.0_rk]
  end function load_factors

  !> Forces on the modes at one time without those of the ports and of inertia.
  function modal_forces(basis, modal) result(force)
    type(reduced_model), intent(in) :: basis
    type(modal_motion), intent(in) :: modal
    real(rk) :: force(basis%num_modes)
    force = -basis%lambda*modal%y - matmul(basis%damping, modal%rate)
  end function modal_forces

  !> Forces of the ports in the balance of an increment.
  function port_forces(operator, scheme, factors, old, traction) result(force)
    type(jump_operator), intent(in) :: operator
    type(hht), intent(in) :: scheme
    real(rk), intent(in) :: factors(:, :) !< (loads, 2) at both ends
    type(motion), intent(in) :: old !< at the start
    real(rk), intent(in) :: traction(:, :) !< (3, points) at the end [Pa]
    real(rk) :: force(size(traction) + size(factors, 1))
    associate (first => old%modal%start_traction)
      force(:size(traction)) = -force_of(operator, scheme%joint_weight*(traction - first) &
                                         + scheme%old_joint_weight*(old%carried - first))
    end associate
    force(size(traction) + 1:) = (1.0_rk + scheme%alpha)*factors(:, 2) - scheme%alpha*factors(:, 1)
  end function port_forces

  !> The forces of the ports for each part of the rest.
  pure function to_parts(basis, force) result(parts)
    type(reduced_model), intent(in) :: basis
    real(rk), intent(in) :: force(:) !< (ports)
    real(rk) :: parts(size(basis%residual, 2))
    parts = reshape(force, [size(parts)], pad=force)
  end function to_parts

  !> Goes from `before` to `after`: modes, ports and joints. Without convergence, or with a motion
  !> that is not finite, `after` is invalid.
  subroutine take_reduced_increment(basis, matrices, model, controls, factors, before, after, &
                                    outcome)
    type(reduced_model), intent(in) :: basis
    type(reduced_matrices), intent(inout) :: matrices
    type(problem), intent(in) :: model
    type(step_controls), intent(in) :: controls
    real(rk), intent(in) :: factors(:, :) !< (loads, 2) at both ends
    type(state), intent(in) :: before
    type(state), intent(inout) :: after
    type(balance_outcome), intent(out) :: outcome
    real(rk), dimension(3, matrices%operator%num_points) :: traction, jump
    real(rk) :: known(basis%num_modes), rest(size(basis%residual, 2)), moved(size(basis%path, 1))
    call sum_known_forces(basis, matrices, before%motion%modal, known, rest)
    associate (start => before%motion%modal%start_traction, new => after%motion%modal, &
               operator => matrices%operator)
      traction = start
      call solve_modes()
      if (operator%num_points == 0) then
        outcome%iterations = 1
      else
        call operator%jumps(before%motion%modal%start, jump)
        call take_origins(operator, before%joints, jump)
        moved = mixed_times(basis%path_read, new%y) &
                + mixed_times(basis%residual_read, new%port)
        jump = jump + reshape(moved(:size(jump)) + matrices%held_jump, shape(jump))
        call solve_with_joints(matrices, model, controls, jump, before, after, traction, outcome)
        if (.not. outcome%has_converged) return
        call solve_modes()
      end if
      outcome%has_converged = all(abs(new%y) <= huge(1.0_rk))
      if (.not. outcome%has_converged) return
    end associate
    call correct(matrices, matrices%operator, before, after)
  contains
    !> Modes and ports for given tractions at the end.
    subroutine solve_modes()
      real(rk) :: force(size(basis%path, 1))
      force = port_forces(matrices%operator, matrices%scheme, factors, before%motion, traction)
      after%motion%modal%y = times_vector(matrices%inverse, known &
                                          + mixed_transposed_times(basis%path_read, force))
      after%motion%modal%port = (rest + to_parts(basis, force))/matrices%rest
    end subroutine solve_modes
  end subroutine take_reduced_increment

  !> The right-hand sides without the forces of the ports.
  subroutine sum_known_forces(basis, matrices, old, known, rest)
    type(reduced_model), intent(in) :: basis
    type(reduced_matrices), intent(in) :: matrices
    type(modal_motion), intent(in) :: old
    real(rk), intent(out) :: known(:) !< (modes)
    real(rk), intent(out) :: rest(:) !< (columns of P R P^T)
    real(rk) :: predicted(size(known)), rate(size(known))
    real(rk), dimension(size(rest)) :: port, port_rate
    associate (scheme => matrices%scheme, bulk => 1.0_rk + matrices%scheme%alpha)
      call predict(scheme, old%y, old%rate, old%acceleration, predicted, rate)
      known = scheme%acceleration_of_x*predicted + scheme%alpha*basis%lambda*old%y &
              - times_vector(basis%damping, bulk*rate - scheme%alpha*old%rate)
      call predict(scheme, old%port, old%port_rate, old%port_acceleration, port, port_rate)
      rest = basis%rest_mass*scheme%acceleration_of_x*port &
             - bulk*basis%rest_damping*port_rate &
             + scheme%alpha*(basis%rest_stiffness*old%port + basis%rest_damping*old%port_rate)
    end associate
  end subroutine sum_known_forces

  !> Displacement without an acceleration at the end, and the rate at the end if x1 were zero.
  pure subroutine predict(scheme, x, rate, acceleration, predicted, rate_at_zero)
    type(hht), intent(in) :: scheme
    real(rk), intent(in) :: x(:), rate(:), acceleration(:)
    real(rk), intent(out) :: predicted(:), rate_at_zero(:)
    predicted = x + scheme%dt*rate + scheme%dt**2*(0.5_rk - scheme%beta)*acceleration
    rate_at_zero = rate + (1.0_rk - scheme%gamma)*scheme%dt*acceleration &
                   - scheme%velocity_of_x*predicted
  end subroutine predict

  !> The iteration on the joints, from jumps that go on as in the last increment.
  subroutine solve_with_joints(matrices, model, controls, open_jump, before, after, traction, &
                               outcome)
    type(reduced_matrices), intent(inout) :: matrices
    type(problem), intent(in) :: model
    type(step_controls), intent(in) :: controls
    real(rk), intent(in) :: open_jump(:, :) !< (3, points) [m]
    type(state), intent(in) :: before
    type(state), intent(inout) :: after
    real(rk), intent(out) :: traction(:, :) !< (3, points) of the equilibrium [Pa]
    type(balance_outcome), intent(out) :: outcome
    type(force_balance) :: balance
    balance%offset = open_jump
    balance%guess = 0.0_rk*open_jump
    call gather_jumps(matrices%operator, before%joints, balance%guess)
    balance%guess = balance%guess + matrices%scheme%dt*before%motion%jump_rate
    balance%reference_force = before%largest_force
    call matrices%solve_joints(controls, balance, model%joints, before%joints, after%joints, &
                               traction, outcome)
  end subroutine solve_with_joints

  !> Rates of modes and ports, and joint data for the next increment, as in hht_increment.
  subroutine correct(matrices, operator, before, after)
    type(reduced_matrices), intent(in) :: matrices
    type(jump_operator), intent(in) :: operator
    type(state), intent(in) :: before
    type(state), intent(inout) :: after
    real(rk), dimension(3, operator%num_points) :: last_jump, traction
    associate (scheme => matrices%scheme, old => before%motion%modal, new => after%motion%modal)
      new%is_expanded = .false.
      call find_rates(scheme, old%y, old%rate, old%acceleration, new%y, new%rate, &
                      new%acceleration)
      call find_rates(scheme, old%port, old%port_rate, old%port_acceleration, new%port, &
                      new%port_rate, new%port_acceleration)
      call gather_jumps(operator, before%joints, last_jump)
      call gather_jumps(operator, after%joints, after%motion%jump_rate)
      after%motion%jump_rate = (after%motion%jump_rate - last_jump)/scheme%dt
      call gather_tractions(operator, after%joints, traction)
      after%motion%carried = traction
      if (scheme%carries_impulse) then
        after%motion%carried = scheme%joint_weight*traction &
                               + scheme%old_joint_weight*before%motion%carried
      end if
    end associate
  end subroutine correct

  !> Rate and acceleration at the end by Newmark's formulas.
  pure subroutine find_rates(scheme, x, rate, acceleration, new_x, new_rate, new_acceleration)
    type(hht), intent(in) :: scheme
    real(rk), intent(in) :: x(:), rate(:), acceleration(:), new_x(:)
    real(rk), intent(inout) :: new_rate(:), new_acceleration(:)
    new_acceleration = scheme%acceleration_of_x &
                       *(new_x - x - scheme%dt*rate &
                         - scheme%dt**2*(0.5_rk - scheme%beta)*acceleration)
    new_rate = rate + scheme%dt*((1.0_rk - scheme%gamma)*acceleration &
                                 + scheme%gamma*new_acceleration)
  end subroutine find_rates
end module reduced_increment
