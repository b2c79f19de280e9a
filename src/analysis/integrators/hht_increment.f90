!> One increment of HHT in the unknown x = u1 - u0 (theory.md, 7.1-7.2):
!>
!>   K_eff x + w B^T (area t1) = (1 + alpha)(f1 - C v^ - K u0) - alpha (f0 - C v0 - f_int0) - w0 J0
!>                               + (M/(beta dt^2) + (1 + alpha) gamma/(beta dt) C) (u^ - u0)
!>   K_eff = M/(beta dt^2) + (1 + alpha) (gamma/(beta dt) C + K)
!>
!> Inelastic solids add (1 + alpha) s on the right, s their initial-stress force (12.2).
!>
!> Products per increment: M a1, C a1 and K u1. They give all forces at the end and the residual;
!> C v and M v follow from the forces of the increment before. K u1 is a product of its own in every
!> increment: a sum of K v and K a over increments keeps their round-off, which does not decay
!> without damping and reaches the weight of a stiff block that slides for a second.
submodule(hht_integrator) hht_increment
  use global_vectors, only: length
  use dynamic_step, only: largest_force
  use joint_forces, only: gather_jumps
  use increment_balance, only: increment_task
  use next_acceleration, only: find_trend, expected_acceleration
  use step_equilibrium, only: add_moving_supports
  use support_rates, only: find_support_rates, has_moving_supports
  implicit none

  !> Floor of the reference force, as a fraction of norm(diag(K) q): far above the round-off of K q.
  real(rk), parameter :: roundoff_share = 1.0e-9_rk

contains

  !> Goes from `before` to `after`. Without convergence `after` is invalid.
  module subroutine take_increment(self, model, when, before, after, outcome, error)
    class(hht_method), intent(inout) :: self
    type(problem), intent(in) :: model
    type(step_time), intent(in) :: when
    type(state), intent(in) :: before
    type(state), intent(inout) :: after
    type(balance_outcome), intent(out) :: outcome
    type(error_type), allocatable, intent(out) :: error
    type(increment_task) :: task
    real(rk) :: residual(self%system%matrix%num_free)
    associate (system => self%system, scheme => self%scheme, solids => self%solids, &
               n => self%system%matrix%num_free, old => before%motion, new => after%motion)
      call pose_task(self, model, when, before, after, task)
      do
        call solids%solve_increment(model, system, task, before, after, outcome, error)
        if (allocated(error) .or. .not. outcome%has_converged) return
        call correct(system, scheme, solids, task, before, after)
        ! With reactions: displaced supports may be the only load of the dam.
        associate (part => system%matrix%part)
          after%largest_force = max(task%balance%reference_force, task%reference_force, &
                                    length(part, new%internal), &
                                    roundoff_share*length(part, system%diagonal*new%q), &
                                    largest_force(new, system%matrix, scheme%joint_weight, &
                                                  scheme%dt))
        end associate
        residual = new%balanced(:n) - new%inertia(:n)
        if (allocated(old%residual)) residual = residual + old%residual
        call task%check_balance(system%matrix%part, residual, after%largest_force, outcome)
        if (.not. task%is_refined) exit
      end do
      if (solids%has_inelastic() .or. solids%solver%controls%precision /= 'DOUBLE') then
        new%residual = residual
      else if (allocated(new%residual)) then
        deallocate (new%residual) ! of a step before
      end if
    end associate
  end subroutine take_increment

  !> The problem of the increment in the unknown x = u1 - u0; prescribed unknowns are in place.
  subroutine pose_task(self, model, when, before, after, task)
    class(hht_method), intent(in) :: self
    type(problem), intent(in) :: model
    type(step_time), intent(in) :: when !< the end of the increment
    type(state), intent(in) :: before
    type(state), intent(inout) :: after
    type(increment_task), intent(out) :: task
    real(rk), dimension(self%system%matrix%num_total) :: moved, rhs
    associate (system => self%system, scheme => self%scheme, &
               n => self%system%matrix%num_free, old => before%motion, new => after%motion)
      call external_force(system%groups, model%amplitudes, when, new%external)
      moved = old%q
      call prescribed_values(system%supports, model%amplitudes, when, moved)
      task%start = moved
      moved = moved - old%q
      call sum_known_forces(system, scheme, old, new%external, rhs)
      task%balance%rhs = rhs(:n)
      if (allocated(old%residual)) task%balance%rhs = task%balance%rhs + old%residual
      call add_moving_supports(system, self%solids%values, moved, task%balance%rhs)
      if (has_moving_supports(system)) then
        call set_support_rates(model, system, scheme, when, old, moved, task)
      end if
      call task%balance%set_jumps(system%operator, task%start, before%joints)
      task%balance%guess = task%balance%guess + scheme%dt*old%jump_rate
      task%balance%reference_force = largest_force(old, system%matrix, scheme%joint_weight, &
                                                   scheme%dt)
      allocate (task%x(system%matrix%num_total))
      if (self%solids%has_inelastic()) then
        task%reference_force = max(task%balance%reference_force, before%largest_force, &
                                   length(system%matrix%part, new%external(:n)))
        ! v1 by (7.2) with u1 = task%start + x
        task%velocity_of_x = scheme%velocity_of_x
        task%velocity = old%v + (1.0_rk - scheme%gamma)*scheme%dt*old%a + scheme%velocity_of_x &
                        *(moved - scheme%dt*old%v - scheme%dt**2*(0.5_rk - scheme%beta)*old%a)
        if (allocated(task%support_v)) task%velocity(n + 1:) = task%support_v(n + 1:)
        task%predicted = predict(scheme, old, system%matrix)
      end if
    end associate
  end subroutine pose_task

  !> Newmark's displacements (7.1) of an increment that ends with the expected acceleration.
  function predict(scheme, old, matrix) result(x)
    type(hht), intent(in) :: scheme
    type(motion), intent(in) :: old
    type(pattern), intent(in) :: matrix
    real(rk) :: x(matrix%num_free) !< [m]
    associate (n => matrix%num_free)
      x = scheme%dt*old%v(:n) + scheme%dt**2*((0.5_rk - scheme%beta)*old%a(:n) &
                                              + scheme%beta*expected_acceleration(old, matrix))
    end associate
  end function predict

  !> Rates of the supports at the end, and forces by what Newmark's formulas make of them beyond.
  subroutine set_support_rates(model, system, scheme, when, old, moved, task)
    type(problem), intent(in) :: model
    type(dam_system), intent(in) :: system
    type(hht), intent(in) :: scheme
    type(step_time), intent(in) :: when !< the end of the increment
    type(motion), intent(in) :: old
    real(rk), intent(in) :: moved(:) !< (num_total) in the increment [m]
    type(increment_task), intent(inout) :: task
    real(rk), dimension(size(moved)) :: v, a, force
    associate (n => system%matrix%num_free)
      allocate (task%support_v(size(moved)), task%support_a(size(moved)), source=0.0_rk)
      call find_support_rates(model, system, when, scheme%dt, task%support_v, task%support_a)
      call newmark_rates(scheme, old, moved, v, a)
      v = task%support_v - v
      a = task%support_a + scheme%alpha*(task%support_a - old%a) - a
      v(:n) = 0.0_rk
      a(:n) = 0.0_rk
      call multiply(system%mass_pattern, system%mass_entries, a, force)
      task%balance%rhs = task%balance%rhs - force(:n)
      call system%find_damping_force(v, force)
      ! K_eff, of which `moved` has taken its part, holds no modal damping.
      call system%add_modal_force(scheme%velocity_of_x*moved, force)
      task%balance%rhs = task%balance%rhs - (1.0_rk + scheme%alpha)*force(:n)
    end associate
  end subroutine set_support_rates

  !> Rates at the end of an increment by Newmark's formulas.
  pure subroutine newmark_rates(scheme, old, moved, v, a)
    type(hht), intent(in) :: scheme
    type(motion), intent(in) :: old
    real(rk), intent(in) :: moved(:) !< (num_total) in the increment [m]
    real(rk), intent(out) :: v(:), a(:) !< (num_total)
    associate (dt => scheme%dt)
      a = scheme%acceleration_of_x*(moved - dt*old%v - dt**2*(0.5_rk - scheme%beta)*old%a)
      v = old%v + (1.0_rk - scheme%gamma)*dt*old%a + scheme%gamma*dt*a
    end associate
  end subroutine newmark_rates

  !> The right-hand side, all rows; prescribed ones are not used. With u1 = u0 the acceleration is
  !> -p/(beta dt^2), p = dt v0 + dt^2 (1/2 - beta) a0.
  subroutine sum_known_forces(system, scheme, before, external, rhs)
    type(dam_system), intent(in) :: system
    type(hht), intent(in) :: scheme
    type(motion), intent(in) :: before
    real(rk), intent(in) :: external(:) !< at the end [N]
    real(rk), intent(out) :: rhs(:)
    associate (dt => scheme%dt, bulk => 1.0_rk + scheme%alpha, &
               half => scheme%dt**2*(0.5_rk - scheme%beta))
      rhs = bulk*(external - before%elastic) &
            - scheme%alpha*(before%external - before%viscous - before%internal) &
            + scheme%acceleration_of_x*(dt*before%momentum + half*before%inertia) &
            - bulk*(before%viscous + (1.0_rk - scheme%gamma)*dt*before%viscous_rate) &
            + bulk*scheme%velocity_of_x*(dt*before%viscous + half*before%viscous_rate)
      call system%add_warming(before, bulk, rhs)
      if (allocated(before%carried_correction)) then
        rhs = rhs + (1.0_rk - scheme%gamma)/scheme%gamma*before%carried_correction
      end if
      if (scheme%carries_impulse) then
        call system%operator%add_forces(-scheme%old_joint_weight*before%carried, rhs)
      else
        rhs = rhs - scheme%old_joint_weight*before%contact
      end if
    end associate
  end subroutine sum_known_forces

  !> Motion and forces at the end.
  subroutine correct(system, scheme, solids, task, before, after)
    type(dam_system), intent(in) :: system
    type(hht), intent(in) :: scheme
    type(solid_solver), intent(in) :: solids
    type(increment_task), intent(in) :: task !< solved
    type(state), intent(in) :: before
    type(state), intent(inout) :: after
    associate (old => before%motion, new => after%motion, dt => scheme%dt, &
               rest => (1.0_rk - scheme%gamma)*scheme%dt, bulk => 1.0_rk + scheme%alpha, &
               n => system%matrix%num_free)
      new%q = task%start + task%x
      call newmark_rates(scheme, old, new%q - old%q, new%v, new%a)
      if (solids%has_inelastic()) call find_trend(old, new, system%matrix)
      if (allocated(task%support_a)) new%a(n + 1:) = task%support_a(n + 1:)
      call multiply(system%mass_pattern, system%mass_entries, new%a, new%inertia)
      new%momentum = old%momentum + rest*old%inertia + scheme%gamma*dt*new%inertia
      call system%find_rate_forces(new%q, new%a, new%inertia, new%elastic, new%viscous_rate)
      new%viscous = old%viscous + rest*old%viscous_rate + scheme%gamma*dt*new%viscous_rate
      if (allocated(task%support_v)) call move_supports(system, scheme, task%support_v, old, new)
      call solids%set_internal(new)
      new%balanced = bulk*(new%external - new%viscous - new%internal) &
                     - scheme%alpha*(old%external - old%viscous - old%internal)
    end associate
    if (allocated(task%support_a)) call weigh_supports(system, scheme, before, after)
    call carry_correction(scheme, before%motion, after%motion)
    call add_joints(system, scheme, before, after)
  end subroutine correct

  !> Velocities of supports, momentum and damping by what they are beyond the sum of accelerations.
  subroutine move_supports(system, scheme, v, old, new)
    type(dam_system), intent(in) :: system
    type(hht), intent(in) :: scheme
    real(rk), intent(in) :: v(:) !< (num_total) of prescribed unknowns at the end [m/s]
    type(motion), intent(in) :: old
    type(motion), intent(inout) :: new
    real(rk), dimension(size(v)) :: more, force
    associate (n => system%matrix%num_free, dt => scheme%dt)
      more = v - old%v - dt*((1.0_rk - scheme%gamma)*old%a + scheme%gamma*new%a)
      more(:n) = 0.0_rk
      new%v(n + 1:) = v(n + 1:)
      call multiply(system%mass_pattern, system%mass_entries, more, force)
      new%momentum = new%momentum + force
      call system%find_damping_force(more, force)
      new%viscous = new%viscous + force
    end associate
  end subroutine move_supports

  !> The inertia forces of supports on the free unknowns are weighted as other forces are.
  subroutine weigh_supports(system, scheme, before, after)
    type(dam_system), intent(in) :: system
    type(hht), intent(in) :: scheme
    type(state), intent(in) :: before
    type(state), intent(inout) :: after
    real(rk), dimension(size(after%motion%a)) :: change, force
    associate (old => before%motion, new => after%motion, n => system%matrix%num_free)
      change = new%a - old%a
      change(:n) = 0.0_rk
      call multiply(system%mass_pattern, system%mass_entries, change, force)
      new%balanced(:n) = new%balanced(:n) - scheme%alpha*force(:n)
    end associate
  end subroutine weigh_supports

  !> The force that corrects the work in the balance: with the implicit impulse of joints, (7.3).
  subroutine carry_correction(scheme, old, new)
    type(hht), intent(in) :: scheme
    type(motion), intent(in) :: old
    type(motion), intent(inout) :: new
    if (.not. allocated(new%correction)) return
    new%carried_correction = new%correction/scheme%gamma
    if (allocated(old%carried_correction)) then
      new%carried_correction = new%carried_correction &
                               - (1.0_rk - scheme%gamma)/scheme%gamma*old%carried_correction
    end if
    new%balanced = new%balanced - new%carried_correction(:size(new%balanced))
  end subroutine carry_correction

  !> The forces of the joints in the balance.
  subroutine add_joints(system, scheme, before, after)
    type(dam_system), intent(in) :: system
    type(hht), intent(in) :: scheme
    type(state), intent(in) :: before
    type(state), intent(inout) :: after
    real(rk) :: joint_force(system%matrix%num_total)
    call sum_contact(system%operator, after)
    call carry_joints(system, scheme, before, after)
    associate (old => before%motion, new => after%motion)
      joint_force = scheme%joint_weight*new%contact
      if (scheme%carries_impulse) then
        call system%operator%add_forces(scheme%old_joint_weight*old%carried, joint_force)
      else
        joint_force = joint_force + scheme%old_joint_weight*old%contact
      end if
      new%balanced = new%balanced - joint_force
    end associate
  end subroutine add_joints

  !> Joint data for the next increment: the rate of their jumps, and the traction t1* = (t1 - (1 -
  !> gamma) t0*)/gamma of the implicit impulse (7.3).
  subroutine carry_joints(system, scheme, before, after)
    type(dam_system), intent(in) :: system
    type(hht), intent(in) :: scheme
    type(state), intent(in) :: before
    type(state), intent(inout) :: after
    real(rk), dimension(3, system%operator%num_points) :: last_jump, traction
    associate (old => before%motion, new => after%motion)
      call gather_jumps(system%operator, before%joints, last_jump)
      call gather_jumps(system%operator, after%joints, new%jump_rate)
      new%jump_rate = (new%jump_rate - last_jump)/scheme%dt
      call gather_tractions(system%operator, after%joints, traction)
      new%carried = traction
      if (scheme%carries_impulse) then
        new%carried = scheme%joint_weight*traction + scheme%old_joint_weight*old%carried
      end if
    end associate
  end subroutine carry_joints
end submodule hht_increment
