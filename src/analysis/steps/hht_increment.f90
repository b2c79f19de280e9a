!> One increment of HHT in the unknown x = u1 - u^ (theory.md, (7.1)-(7.2)):
!>
!>   K_eff x + w B^T (area t1) = (1 + alpha)(f1 - C v^ - K u^) - alpha (f0 - C v0 - K u0) - w0 J0
!>   K_eff = M/(beta dt^2) + (1 + alpha) (gamma/(beta dt) C + K)
!>
!> Inelastic solids add (1 + alpha) R1 - alpha R0 on the right, R their released forces (12.2).
!>
!> Products per increment: M a1, C a1 and K u1. They give all forces at the end and show the true
!> balance; K u^, C v and M v follow from what is known of the increment before.
module hht_increment
  use kinds, only: rk
  use errors, only: error_type
  use matrix_pattern, only: multiply
  use problem_definition, only: problem
  use joint_forces, only: gather_tractions, gather_jumps
  use equilibrium, only: force_balance, balance_outcome
  use solid_iteration, only: solid_solver, increment_task
  use step_equilibrium, only: add_moving_supports, check_bulk
  use step_system, only: dam_system
  use step_loads, only: step_time, external_force, prescribed_values
  use motion_state, only: motion, sum_contact, solid_force
  use hht_scheme, only: hht
  implicit none
  private
  public :: stepper, effective_values, take_increment

  !> What serves an increment size.
  type :: stepper
    type(hht) :: scheme
    type(solid_solver) :: solids !< with the values of K_eff
  end type stepper

  !> A body in free flight knows no force but round-off: out of balance is then measured against
  !> this part of the force that would stop it within the increment.
  real(rk), parameter :: stopping_share = 1.0e-3_rk

contains

  !> Values of K_eff, joints apart.
  subroutine effective_values(system, scheme, values)
    type(dam_system), intent(in) :: system
    type(hht), intent(in) :: scheme
    real(rk), allocatable, intent(out) :: values(:)
    values = (1.0_rk + scheme%alpha)*system%stiffness + scheme%acceleration_of_x*system%mass
    if (size(system%damping) > 0) then
      values = values + (1.0_rk + scheme%alpha)*scheme%velocity_of_x*system%damping
    end if
  end subroutine effective_values

  !> Goes from `before` to `after`. Without convergence `after` is of no use.
  subroutine take_increment(scene, system, tool, when, before, after, outcome, error)
    type(problem), intent(in) :: scene
    type(dam_system), intent(in) :: system
    type(stepper), intent(inout) :: tool
    type(step_time), intent(in) :: when !< the end of the increment
    type(motion), intent(in) :: before
    type(motion), intent(inout) :: after
    type(balance_outcome), intent(out) :: outcome
    type(error_type), allocatable, intent(out) :: error
    type(increment_task) :: task
    real(rk), dimension(size(before%q)) :: x, moved, rhs
    call predict(system, tool%scheme, before, after)
    call external_force(system%groups, scene%amplitudes, when, after%external)
    moved = after%q
    call prescribed_values(system%supports, scene%amplitudes, when, moved)
    moved = moved - after%q
    call sum_known_forces(system, tool%scheme, before, after, rhs)
    task%balance%rhs = rhs(:system%matrix%num_free)
    call add_moving_supports(system, tool%solids%values, moved, task%balance%rhs)
    task%start = after%q + moved
    call set_jumps(system, tool%scheme, before, task%start, task%balance)
    task%balance%reference = largest_force(tool%scheme, before, system%matrix%num_free)
    allocate (task%x(size(x)))
    if (size(before%points) > 0) then
      task%reference = max(task%balance%reference, before%largest_force, &
                           length(after%external(:system%matrix%num_free)))
    end if
    call tool%solids%solve(scene, system, task, before, after, outcome, error)
    if (allocated(error) .or. .not. outcome%has_converged) return
    x = task%x + moved
    call correct(system, tool%scheme, x, before, after, rhs)
    associate (n => system%matrix%num_free)
      ! The reactions count: displaced supports alone may be what strains the body.
      after%largest_force = max(largest_force(tool%scheme, before, n), solid_force(after), &
                                largest_force(tool%scheme, after, n))
      if (size(after%points) > 0) after%largest_force = max(after%largest_force, task%reference)
      call check_bulk(rhs(:n), after%largest_force, &
                      tool%solids%solver%controls%residual_tolerance, outcome)
    end associate
  end subroutine take_increment

  !> u^, v^, a = 0 and the forces that go with them.
  subroutine predict(system, scheme, before, after)
    type(dam_system), intent(in) :: system
    type(hht), intent(in) :: scheme
    type(motion), intent(in) :: before
    type(motion), intent(inout) :: after
    associate (dt => scheme%dt, rest => (1.0_rk - scheme%gamma)*scheme%dt)
      after%q = before%q + dt*before%v + dt**2*(0.5_rk - scheme%beta)*before%a
      after%v = before%v + rest*before%a
      after%momentum = before%momentum + rest*before%inertia
      if (size(system%damping) > 0) after%viscous = before%viscous + rest*before%viscous_rate
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
          - scheme%alpha*(before%external - before%viscous - before%elastic)
    if (size(before%released) > 0) rhs = rhs - scheme%alpha*before%released
    if (system%operator%num_points == 0) return
    if (scheme%carries_impulse) then
      call system%operator%add_forces(-scheme%old_joint_weight*before%carried, rhs)
    else
      rhs = rhs - scheme%old_joint_weight*before%contact
    end if
  end subroutine sum_known_forces

  !> Jumps at x = 0 with the supports in place, and a guess: jumps go on as in the last increment.
  subroutine set_jumps(system, scheme, before, q, balance)
    type(dam_system), intent(in) :: system
    type(hht), intent(in) :: scheme
    type(motion), intent(in) :: before
    real(rk), intent(in) :: q(:) !< predicted, supports in place
    type(force_balance), intent(inout) :: balance
    allocate (balance%offset(3, system%operator%num_points), &
              balance%guess(3, system%operator%num_points))
    if (system%operator%num_points == 0) return
    call system%operator%jumps(q, balance%offset)
    call gather_jumps(system%operator, before%joints, balance%guess)
    balance%guess = balance%guess + scheme%dt*before%jump_rate
  end subroutine set_jumps

  !> Motion and forces at the end; `rhs` returns what is out of balance.
  subroutine correct(system, scheme, x, before, after, rhs)
    type(dam_system), intent(in) :: system
    type(hht), intent(in) :: scheme
    real(rk), intent(in) :: x(:)
    type(motion), intent(in) :: before
    type(motion), intent(inout) :: after
    real(rk), intent(inout) :: rhs(:)
    real(rk) :: product(size(x)), joint_force(size(x)), weight
    after%a = scheme%acceleration_of_x*x
    after%q = after%q + x
    after%v = after%v + scheme%velocity_of_x*x
    weight = scheme%gamma*scheme%dt
    call multiply(system%mass_pattern, system%mass_entries, after%a, after%inertia)
    after%momentum = after%momentum + weight*after%inertia
    call multiply(system%matrix, system%stiffness, after%q, product)
    after%elastic_jerk = scheme%acceleration_of_x*(product - after%elastic)
    after%elastic_rate = after%elastic_rate + weight*after%elastic_jerk
    rhs = rhs - after%inertia - (1.0_rk + scheme%alpha)*(product - after%elastic)
    after%elastic = product
    if (size(system%damping) > 0) then
      call multiply(system%matrix, system%damping, after%a, after%viscous_rate)
      after%viscous = after%viscous + weight*after%viscous_rate
      rhs = rhs - (1.0_rk + scheme%alpha)*weight*after%viscous_rate
    end if
    after%balanced = (1.0_rk + scheme%alpha)*(after%external - after%viscous - after%elastic) &
                     - scheme%alpha*(before%external - before%viscous - before%elastic)
    if (size(after%released) > 0) then
      rhs = rhs + (1.0_rk + scheme%alpha)*after%released
      after%balanced = after%balanced + (1.0_rk + scheme%alpha)*after%released &
                       - scheme%alpha*before%released
    end if
    if (system%operator%num_points == 0) return
    call sum_contact(system%operator, after)
    call carry_joints(system, scheme, before, after)
    rhs = rhs - scheme%joint_weight*after%contact
    joint_force = scheme%joint_weight*after%contact
    if (scheme%carries_impulse) then
      call system%operator%add_forces(scheme%old_joint_weight*before%carried, joint_force)
    else
      joint_force = joint_force + scheme%old_joint_weight*before%contact
    end if
    after%balanced = after%balanced - joint_force
  end subroutine correct

  !> What the joints hand on to the next increment: the rate of their jumps, and the traction
  !> t1* = (t1 - (1 - gamma) t0*)/gamma of the implicit impulse (7.3).
  subroutine carry_joints(system, scheme, before, after)
    type(dam_system), intent(in) :: system
    type(hht), intent(in) :: scheme
    type(motion), intent(in) :: before
    type(motion), intent(inout) :: after
    real(rk) :: traction(3, system%operator%num_points)
    call gather_jumps(system%operator, before%joints, traction)
    call gather_jumps(system%operator, after%joints, after%jump_rate)
    after%jump_rate = (after%jump_rate - traction)/scheme%dt
    if (.not. scheme%carries_impulse) return
    call gather_tractions(system%operator, after%joints, traction)
    after%carried = scheme%joint_weight*traction + scheme%old_joint_weight*before%carried
  end subroutine carry_joints

  !> The largest of the forces in the balance.
  pure real(rk) function largest_force(scheme, moving, num_free) result(force)
    type(hht), intent(in) :: scheme
    type(motion), intent(in) :: moving
    integer, intent(in) :: num_free
    real(rk) :: solid
    if (size(moving%released) > 0) then
      solid = length(moving%elastic(:num_free) - moving%released(:num_free))
    else
      solid = length(moving%elastic(:num_free))
    end if
    force = max(length(moving%external(:num_free)), solid, &
                length(moving%inertia(:num_free)), length(moving%viscous(:num_free)), &
                scheme%joint_weight*length(moving%contact(:num_free)), &
                stopping_share*length(moving%momentum(:num_free))/scheme%dt)
  end function largest_force

  !> The Euclidean norm, without the care for overflow that makes `norm2` slow.
  pure real(rk) function length(force)
    real(rk), intent(in), contiguous :: force(:)
    length = sqrt(dot_product(force, force))
  end function length
end module hht_increment
