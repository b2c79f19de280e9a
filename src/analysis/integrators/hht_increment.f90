!> One increment of HHT in the unknown x = u1 - u^ (theory.md, 7.1-7.2):
!>
!>   K_eff x + w B^T (area t1) = (1 + alpha)(f1 - C v^ - K u^) - alpha (f0 - C v0 - f_int0) - w0 J0
!>   K_eff = M/(beta dt^2) + (1 + alpha) (gamma/(beta dt) C + K)
!>
!> Inelastic solids add (1 + alpha) s on the right, s their initial-stress force (12.2).
!>
!> Products per increment: M a1, C a1 and K u1. They give all forces at the end and the residual;
!> K u^, C v and M v follow from the forces of the increment before.
submodule(hht_integrator) hht_increment
  use global_vectors, only: length
  use dynamic_step, only: largest_force
  use joint_forces, only: gather_jumps
  use equilibrium, only: force_balance
  use solid_iteration, only: increment_task
  use step_equilibrium, only: add_moving_supports, check_bulk
  implicit none

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
    real(rk), dimension(self%system%matrix%num_total) :: moved, rhs
    associate (system => self%system, scheme => self%scheme, solids => self%solids, &
               n => self%system%matrix%num_free, old => before%motion, new => after%motion)
      call predict(scheme, old, new)
      call external_force(system%groups, model%amplitudes, when, new%external)
      moved = new%q
      call prescribed_values(system%supports, model%amplitudes, when, moved)
      moved = moved - new%q
      call sum_known_forces(system, scheme, old, new, rhs)
      task%balance%rhs = rhs(:n)
      call add_moving_supports(system, solids%values, moved, task%balance%rhs)
      task%start = new%q + moved
      call set_jumps(system, scheme, before, task%start, task%balance)
      task%balance%reference_force = largest_force(old, n, scheme%joint_weight, scheme%dt)
      allocate (task%x(system%matrix%num_total))
      if (solids%has_inelastic()) then
        task%reference_force = max(task%balance%reference_force, before%largest_force, &
                                   length(new%external(:n)))
      end if
      call solids%solve_increment(model, system, task, before, after, outcome, error)
      if (allocated(error) .or. .not. outcome%has_converged) return
      call correct(system, scheme, solids, task%x + moved, before, after, rhs)
      ! With reactions: displaced supports may be the only load of the dam.
      after%largest_force = max(task%balance%reference_force, length(new%internal), &
                                task%reference_force, &
                                largest_force(new, n, scheme%joint_weight, scheme%dt))
      call check_bulk(rhs(:n), after%largest_force, solids%solver%controls%residual_tolerance, &
                      outcome)
    end associate
  end subroutine take_increment

  !> u^, v^, a = 0 and the forces that go with them.
  subroutine predict(scheme, before, after)
    type(hht), intent(in) :: scheme
    type(motion), intent(in) :: before
    type(motion), intent(inout) :: after
    associate (dt => scheme%dt, rest => (1.0_rk - scheme%gamma)*scheme%dt)
      after%q = before%q + dt*before%v + dt**2*(0.5_rk - scheme%beta)*before%a
      after%v = before%v + rest*before%a
      after%momentum = before%momentum + rest*before%inertia
      after%viscous = before%viscous + rest*before%viscous_rate
      after%elastic = before%elastic + dt*before%elastic_rate &
                      + dt**2*(0.5_rk - scheme%beta)*before%elastic_jerk
      after%elastic_rate = before%elastic_rate + rest*before%elastic_jerk
    end associate
  end subroutine predict

  !> The right-hand side, all rows; prescribed ones are not used.
  subroutine sum_known_forces(system, scheme, before, after, rhs)
    type(dam_system), intent(in) :: system
    type(hht), intent(in) :: scheme
    type(motion), intent(in) :: before, after !< after: predicted
    real(rk), intent(out) :: rhs(:)
    rhs = (1.0_rk + scheme%alpha)*(after%external - after%viscous - after%elastic) &
          - scheme%alpha*(before%external - before%viscous - before%internal)
    if (scheme%carries_impulse) then
      call system%operator%add_forces(-scheme%old_joint_weight*before%carried, rhs)
    else
      rhs = rhs - scheme%old_joint_weight*before%contact
    end if
  end subroutine sum_known_forces

  !> Jumps at x = 0 with the supports in place, and a first guess: jumps extrapolated from the last
  !> increment.
  subroutine set_jumps(system, scheme, before, q, balance)
    type(dam_system), intent(in) :: system
    type(hht), intent(in) :: scheme
    type(state), intent(in) :: before
    real(rk), intent(in) :: q(:) !< predicted, supports in place
    type(force_balance), intent(inout) :: balance
    allocate (balance%offset(3, system%operator%num_points), &
              balance%guess(3, system%operator%num_points))
    call system%operator%jumps(q, balance%offset)
    call gather_jumps(system%operator, before%joints, balance%guess)
    balance%guess = balance%guess + scheme%dt*before%motion%jump_rate
  end subroutine set_jumps

  !> Motion and forces at the end; `rhs` returns the residual.
  subroutine correct(system, scheme, solids, x, before, after, rhs)
    type(dam_system), intent(in) :: system
    type(hht), intent(in) :: scheme
    type(solid_solver), intent(in) :: solids
    real(rk), intent(in) :: x(:) !< (num_total) [m]
    type(state), intent(in) :: before
    type(state), intent(inout) :: after
    real(rk), intent(inout) :: rhs(:)
    real(rk) :: predicted(size(x)), weight
    associate (old => before%motion, new => after%motion, bulk => 1.0_rk + scheme%alpha)
      new%a = scheme%acceleration_of_x*x
      new%q = new%q + x
      new%v = new%v + scheme%velocity_of_x*x
      weight = scheme%gamma*scheme%dt
      call multiply(system%mass_pattern, system%mass_entries, new%a, new%inertia)
      new%momentum = new%momentum + weight*new%inertia
      predicted = new%elastic
      call multiply(system%matrix, system%stiffness, new%q, new%elastic)
      new%elastic_jerk = scheme%acceleration_of_x*(new%elastic - predicted)
      new%elastic_rate = new%elastic_rate + weight*new%elastic_jerk
      call solids%set_internal(new)
      rhs = rhs - new%inertia - bulk*(new%internal - predicted)
      call system%find_damping_force(new%a, new%viscous_rate)
      new%viscous = new%viscous + weight*new%viscous_rate
      rhs = rhs - bulk*weight*new%viscous_rate
      new%balanced = bulk*(new%external - new%viscous - new%internal) &
                     - scheme%alpha*(old%external - old%viscous - old%internal)
    end associate
    call add_joints(system, scheme, before, after, rhs)
  end subroutine correct

  !> The forces of the joints in the residual and in the balance.
  subroutine add_joints(system, scheme, before, after, rhs)
    type(dam_system), intent(in) :: system
    type(hht), intent(in) :: scheme
    type(state), intent(in) :: before
    type(state), intent(inout) :: after
    real(rk), intent(inout) :: rhs(:)
    real(rk) :: joint_force(size(rhs))
    call sum_contact(system%operator, after)
    call carry_joints(system, scheme, before, after)
    associate (old => before%motion, new => after%motion)
      rhs = rhs - scheme%joint_weight*new%contact
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
      if (.not. scheme%carries_impulse) return
      call gather_tractions(system%operator, after%joints, traction)
      new%carried = scheme%joint_weight*traction + scheme%old_joint_weight*old%carried
    end associate
  end subroutine carry_joints
end submodule hht_increment
