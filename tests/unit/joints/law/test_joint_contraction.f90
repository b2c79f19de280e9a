!> Paths of one joint point against closed forms; the augmented form against finite differences.
program test_joint_contraction
  use joint_catalogue, only: make_joint_law
  use joint_contraction, only: contraction_law
  use joint_law, only: joint_state, solid_behind, state_bonded, state_open, state_slip, &
                       state_stick, traction_law
  use kinds, only: rk
  use testing, only: check, check_close, test_log
  implicit none

  real(rk), parameter :: kn = 1.0e12_rk, kt = 4.0e11_rk
  type(test_log) :: log

  log%suite = 'joint_contraction'
  call bonded_opens_once(log)
  call contact_is_unilateral(log)
  call gap_closes_first(log)
  call shifted_contact(log)
  call friction_cycle(log)
  call slip_restarts_after_opening(log)
  call parted_point_has_no_cohesion(log)
  call breaking_frees_energy(log)
  call friction_work_is_that_of_the_path(log)
  call iteration_ends_at_the_return_map(log)
  call tangent_is_the_derivative(log)
  call multiplier_decides_the_contact(log)
  call defaults_follow_the_solid(log)
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  function joint_of(strength, friction, cohesion, gap) result(law)
    real(rk), intent(in) :: strength, friction, cohesion, gap
    type(contraction_law) :: law
    law = contraction_law(gap=gap, normal_stiffness=kn, tangent_stiffness=kt, strength=strength, &
                          friction=friction, cohesion=cohesion)
  end function joint_of

  !> Goes to a jump and accepts it.
  subroutine go(law, jump, state)
    type(contraction_law), intent(in) :: law
    real(rk), intent(in) :: jump(3)
    type(joint_state), intent(inout) :: state
    type(joint_state) :: new
    real(rk) :: tangent(3, 3, 1), place(3, 1)
    new = state
    place(:, 1) = jump
    call law%update(place, state, new, tangent)
    state = new
  end subroutine go

  !> Linear to the strength, then never any tension again.
  subroutine bonded_opens_once(log)
    type(test_log), intent(inout) :: log
    type(contraction_law) :: law
    type(joint_state) :: state
    law = joint_of(1.0e6_rk, 0.6_rk, 0.0_rk, 0.0_rk)
    call law%start_state([0.0_rk], state)
    call go(law, [0.9e-6_rk, 1.0e-6_rk, 0.0_rk], state)
    call check_close(log, state%traction(1, 1), 0.9e6_rk, 1.0e-6_rk, 'bonded tension')
    call check_close(log, state%traction(2, 1), 0.4e6_rk, 1.0e-6_rk, 'bonded shear has no limit')
    call check(log, state%status(1) == state_bonded, 'bonded')
    call go(law, [1.1e-6_rk, 0.0_rk, 0.0_rk], state)
    call check(log, state%status(1) == state_open .and. state%is_broken(1), 'broken')
    call go(law, [0.5e-6_rk, 0.0_rk, 0.0_rk], state)
    call check_close(log, state%traction(1, 1), 0.0_rk, 0.0_rk, 'no strength any more')
    call go(law, [-0.5e-6_rk, 0.0_rk, 0.0_rk], state)
    call check_close(log, state%traction(1, 1), -0.5e6_rk, 1.0e-6_rk, 'contact')
  end subroutine bonded_opens_once

  subroutine contact_is_unilateral(log)
    type(test_log), intent(inout) :: log
    type(contraction_law) :: law
    type(joint_state) :: state
    real(rk) :: energy(1)
    law = joint_of(0.0_rk, 0.6_rk, 0.0_rk, 0.0_rk)
    call law%start_state([0.0_rk], state)
    call check(log, state%status(1) == state_stick, 'starts closed')
    call go(law, [1.0e-9_rk, 0.0_rk, 0.0_rk], state)
    call check_close(log, state%traction(1, 1), 0.0_rk, 0.0_rk, 'no tension')
    call go(law, [-2.0e-6_rk, 1.0e-6_rk, 0.0_rk], state)
    call check_close(log, state%traction(1, 1), -2.0e6_rk, 1.0e-6_rk, 'pressure')
    call law%stored_energy(state, energy)
    call check_close(log, energy(1), 2.0_rk + 0.2_rk, 1.0e-12_rk, 'stored energy')
  end subroutine contact_is_unilateral

  subroutine gap_closes_first(log)
    type(test_log), intent(inout) :: log
    type(contraction_law) :: law
    type(joint_state) :: state
    law = joint_of(0.0_rk, 0.6_rk, 0.0_rk, 1.0e-3_rk)
    call law%start_state([0.0_rk], state)
    call check(log, state%status(1) == state_open, 'starts open')
    call go(law, [-0.9e-3_rk, 0.0_rk, 0.0_rk], state)
    call check_close(log, state%traction(1, 1), 0.0_rk, 0.0_rk, 'still open')
    call go(law, [-1.001e-3_rk, 0.0_rk, 0.0_rk], state)
    call check_close(log, state%traction(1, 1), -1.0e6_rk, 1.0e-3_rk, 'closed after the gap')
  end subroutine gap_closes_first

  !> A multiplier of 1 MPa, shift 1 um: contact pressure starts before the faces touch, friction has
  !> this pressure, and the springs store half the pressure times the penetration.
  subroutine shifted_contact(log)
    type(test_log), intent(inout) :: log
    type(contraction_law) :: law
    type(joint_state) :: state
    real(rk) :: energy(1)
    law = joint_of(0.0_rk, 0.6_rk, 0.0_rk, 1.0e-3_rk)
    call law%start_state([0.0_rk], state)
    state%shift = -1.0e-6_rk
    call go(law, [-1.0e-3_rk + 0.2e-6_rk, 0.0_rk, 0.0_rk], state)
    call check_close(log, state%traction(1, 1), -0.8e6_rk, 1.0e-3_rk, 'pressure at open faces')
    call go(law, [-1.0e-3_rk - 0.1e-6_rk, 0.0_rk, 0.0_rk], state)
    call check_close(log, state%traction(1, 1), -1.1e6_rk, 1.0e-3_rk, 'multiplier and spring')
    call law%stored_energy(state, energy)
    call check_close(log, energy(1), 0.5_rk*1.1e6_rk*0.1e-6_rk, 1.0e-9_rk, 'stored energy')
    call go(law, [-1.0e-3_rk - 0.1e-6_rk, 1.0_rk, 0.0_rk], state)
    call check_close(log, state%traction(2, 1), 0.6_rk*1.1e6_rk, 1.0e-3_rk, 'friction of it')
    call go(law, [-1.0e-3_rk + 1.1e-6_rk, 1.0_rk, 0.0_rk], state)
    call check(log, state%status(1) == state_open, 'opens beyond the shift')
  end subroutine shifted_contact

  !> Pressure 1 MPa, limit 0.7 MPa: stick, slip, back, slip the other way.
  subroutine friction_cycle(log)
    type(test_log), intent(inout) :: log
    type(contraction_law) :: law
    type(joint_state) :: state
    real(rk), parameter :: limit = 0.7e6_rk
    law = joint_of(0.0_rk, 0.6_rk, 0.1e6_rk, 0.0_rk)
    call law%start_state([0.0_rk], state)
    call go(law, [-1.0e-6_rk, 0.0_rk, 1.0e-6_rk], state)
    call check_close(log, state%traction(3, 1), 0.4e6_rk, 1.0e-6_rk, 'sticks')
    call go(law, [-1.0e-6_rk, 0.0_rk, 5.0e-6_rk], state)
    call check_close(log, state%traction(3, 1), limit, 1.0e-6_rk, 'slips at the limit')
    call check(log, state%status(1) == state_slip, 'slip')
    call check_close(log, state%slip(2, 1), 5.0e-6_rk - limit/kt, 1.0e-15_rk, 'slip itself')
    call check_close(log, state%friction_work(1), limit*(5.0e-6_rk - limit/kt), 1.0e-9_rk, &
                     'work of the slip')
    call go(law, [-1.0e-6_rk, 0.0_rk, 3.0e-6_rk], state)
    call check_close(log, state%traction(3, 1), limit - kt*2.0e-6_rk, 1.0e-6_rk, 'sticks back')
    call go(law, [-1.0e-6_rk, 0.0_rk, -5.0e-6_rk], state)
    call check_close(log, state%traction(3, 1), -limit, 1.0e-6_rk, 'slips the other way')
    call check_close(log, state%friction_work(1), limit*(15.0e-6_rk - 3.0_rk*limit/kt), 1.0e-9_rk, &
                     'work of the cycle')
  end subroutine friction_cycle

  !> While open the slip follows the motion; closing starts with no friction.
  subroutine slip_restarts_after_opening(log)
    type(test_log), intent(inout) :: log
    type(contraction_law) :: law
    type(joint_state) :: state
    law = joint_of(0.0_rk, 0.6_rk, 0.0_rk, 0.0_rk)
    call law%start_state([0.0_rk], state)
    call go(law, [-1.0e-6_rk, 1.0e-6_rk, 0.0_rk], state)
    call go(law, [1.0e-6_rk, 8.0e-6_rk, -2.0e-6_rk], state)
    call check_close(log, state%slip(1, 1), 8.0e-6_rk, 0.0_rk, 'slip follows')
    call go(law, [-1.0e-6_rk, 8.0e-6_rk, -2.0e-6_rk], state)
    call check_close(log, norm2(state%traction(2:3, 1)), 0.0_rk, 1.0e-9_rk, 'closes without shear')
  end subroutine slip_restarts_after_opening

  !> A point that separates in the increment slides at mu p; in the next increment it has c again.
  subroutine parted_point_has_no_cohesion(log)
    type(test_log), intent(inout) :: log
    type(contraction_law) :: law
    type(joint_state) :: state
    law = joint_of(0.0_rk, 0.5_rk, 1.0e5_rk, 0.0_rk)
    call law%start_state([0.0_rk], state)
    state%num_openings = 2
    call go(law, [-1.0e-6_rk, 8.0e-6_rk, 0.0_rk], state)
    call check_close(log, state%traction(2, 1), 5.0e5_rk, 1.0e-6_rk, 'separated: mu p')
    state%num_openings = 0
    call go(law, [-1.0e-6_rk, 16.0e-6_rk, 0.0_rk], state)
    call check_close(log, state%traction(2, 1), 6.0e5_rk, 1.0e-6_rk, 'whole: mu p + c')
    law = joint_of(1.0e6_rk, 0.5_rk, 0.0_rk, 0.0_rk)
    call law%start_state([0.0_rk], state)
    state%num_openings = 2
    call go(law, [0.5e-6_rk, 0.0_rk, 0.0_rk], state)
    call check(log, state%status(1) == state_open .and. state%is_broken(1), 'separated: broken')
    call check_close(log, state%traction(1, 1), 0.0_rk, 0.0_rk, 'separated: no tension')
    call check_close(log, state%fracture_work(1), 0.0_rk, 0.0_rk, 'nothing was stored')
  end subroutine parted_point_has_no_cohesion

  !> Breaking frees q_on**2/(2 k_n), in however large a step.
  subroutine breaking_frees_energy(log)
    type(test_log), intent(inout) :: log
    type(contraction_law) :: law
    type(joint_state) :: state
    law = joint_of(1.0e6_rk, 0.6_rk, 0.0_rk, 0.0_rk)
    call law%start_state([0.0_rk], state)
    call go(law, [1.0e-3_rk, 0.0_rk, 0.0_rk], state)
    call check_close(log, state%fracture_work(1), 0.5_rk, 1.0e-12_rk, 'energy of breaking')
    call check_close(log, state%friction_work(1), 0.0_rk, 0.0_rk, 'no friction')
  end subroutine breaking_frees_energy

  !> One large increment dissipates what many small ones do, while the pressure changes and ends.
  subroutine friction_work_is_that_of_the_path(log)
    type(test_log), intent(inout) :: log
    type(contraction_law) :: law
    type(joint_state) :: coarse, fine
    real(rk) :: from(3), to(3)
    integer :: i, leg
    real(rk), parameter :: corner(3, 4) = reshape([-1.0e-6_rk, 1.0e-6_rk, 0.0_rk, &
                                                   -2.0e-6_rk, 9.0e-6_rk, 0.0_rk, &
                                                   -1.5e-6_rk, 2.0e-6_rk, 0.0_rk, &
                                                   1.0e-6_rk, 1.0e-6_rk, 0.0_rk], [3, 4])
    law = joint_of(0.0_rk, 0.6_rk, 0.0_rk, 0.0_rk)
    call law%start_state([0.0_rk], coarse)
    call law%start_state([0.0_rk], fine)
    from = 0.0_rk
    do leg = 1, 4
      to = corner(:, leg)
      call go(law, to, coarse)
      do i = 1, 2000
        call go(law, from + (to - from)*i/2000.0_rk, fine)
      end do
      from = to
      call check_close(log, coarse%friction_work(1), fine%friction_work(1), &
                       1.0e-5_rk*fine%friction_work(1) + 1.0e-12_rk, 'work of a leg')
    end do
    call check(log, coarse%friction_work(1) > 1.0_rk, 'work is done')
  end subroutine friction_work_is_that_of_the_path

  !> At a constant jump the multiplier converges to the traction of the law; the tangent then is the
  !> derivative of the return map.
  subroutine iteration_ends_at_the_return_map(log)
    type(test_log), intent(inout) :: log
    type(contraction_law) :: law
    type(joint_state) :: old, new, moved
    real(rk) :: jump(3, 1), iterate(3, 1), tangent(3, 3, 1), multiplier(3, 1), scale(2, 1)
    real(rk) :: shifted(3, 1), dummy(3, 3, 1), column(3), unused(3, 1)
    real(rk), parameter :: h = 1.0e-12_rk
    integer :: i
    law = joint_of(0.0_rk, 0.6_rk, 0.1e6_rk, 0.0_rk)
    call law%start_state([0.0_rk], old)
    call go(law, [-1.0e-6_rk, 0.5e-6_rk, 0.3e-6_rk], old)
    jump(:, 1) = [-1.3e-6_rk, 4.0e-6_rk, -3.0e-6_rk]
    new = old
    moved = old
    scale(:, 1) = 0.05_rk*[kn, kt]
    multiplier = old%traction
    do i = 1, 60
      call law%linearise(jump, old, multiplier, scale, new, iterate, tangent)
      multiplier = iterate
    end do
    call check_close(log, norm2(iterate - new%traction), 0.0_rk, 1.0e-6_rk, 'fixed point')
    call law%update(jump, old, moved, dummy)
    call check_close(log, norm2(dummy - tangent), 0.0_rk, 1.0e-9_rk*kn, 'tangent of the law alone')
    do i = 1, 3
      shifted = jump
      shifted(i, 1) = jump(i, 1) + h
      call law%linearise(shifted, old, multiplier, scale, moved, unused, dummy)
      column = moved%traction(:, 1)
      shifted(i, 1) = jump(i, 1) - h
      call law%linearise(shifted, old, multiplier, scale, moved, unused, dummy)
      column = (column - moved%traction(:, 1))/(2.0_rk*h)
      call check_close(log, norm2(column - tangent(:, i, 1)), 0.0_rk, 1.0e-6_rk*kn, &
                       'tangent of the return map')
    end do
  end subroutine iteration_ends_at_the_return_map

  !> Away from the solution: iterate and tangent solve the linearised equation
  !> F + dF/dlambda (iterate + tangent dv - lambda) + dF/dv dv = 0.
  subroutine tangent_is_the_derivative(log)
    type(test_log), intent(inout) :: log
    type(contraction_law) :: law
    type(joint_state) :: old, new
    real(rk) :: jump(3, 1), iterate(3, 1), tangent(3, 3, 1), multiplier(3, 1), scale(2, 1)
    real(rk) :: f_of_multiplier(3, 3), f_of_jump(3, 3), f(3), residual(3), step(3), up(3)
    real(rk), parameter :: h = 1.0_rk
    integer :: i
    law = joint_of(0.0_rk, 0.6_rk, 0.1e6_rk, 0.0_rk)
    call law%start_state([0.0_rk], old)
    new = old
    jump(:, 1) = [-1.3e-6_rk, 12.0e-6_rk, -9.0e-6_rk]
    multiplier(:, 1) = [-0.9e6_rk, -0.2e6_rk, 0.4e6_rk]
    scale(:, 1) = [0.2_rk*kn, 0.3_rk*kt]
    call law%linearise(jump, old, multiplier, scale, new, iterate, tangent)
    f = equation(jump(:, 1), multiplier(:, 1), scale(:, 1))
    do i = 1, 3
      up = 0.0_rk
      up(i) = h
      f_of_multiplier(:, i) = (equation(jump(:, 1), multiplier(:, 1) + up, scale(:, 1)) &
                               - equation(jump(:, 1), multiplier(:, 1) - up, scale(:, 1)))/(2*h)
      up(i) = h/kn
      f_of_jump(:, i) = (equation(jump(:, 1) + up, multiplier(:, 1), scale(:, 1)) &
                         - equation(jump(:, 1) - up, multiplier(:, 1), scale(:, 1)))/(2*up(i))
    end do
    step = [2.0e-7_rk, -1.0e-7_rk, 3.0e-7_rk]
    residual = f + matmul(f_of_multiplier, iterate(:, 1) + matmul(tangent(:, :, 1), step) &
                          - multiplier(:, 1)) + matmul(f_of_jump, step)
    call check_close(log, norm2(residual), 0.0_rk, 1.0e-6_rk*norm2(f), 'one Newton step')
  end subroutine tangent_is_the_derivative

  !> lambda - min(0, z_n) and lambda - limit z/|z| of the law above, without slip before.
  function equation(jump, multiplier, scale) result(f)
    real(rk), intent(in) :: jump(3), multiplier(3), scale(2)
    real(rk) :: f(3)
    real(rk) :: z(2)
    f(1) = multiplier(1) - min(0.0_rk, multiplier(1) + scale(1)*(jump(1) - multiplier(1)/kn))
    z = multiplier(2:3) + scale(2)*(jump(2:3) - multiplier(2:3)/kt)
    f(2:3) = multiplier(2:3) - (0.1e6_rk - 0.6_rk*multiplier(1))*z/norm2(z)
  end function equation

  !> The status follows the traction of the last iterate: a pressed point stays closed while its
  !> opening is below p/r, an open one closes at any penetration.
  subroutine multiplier_decides_the_contact(log)
    type(test_log), intent(inout) :: log
    type(contraction_law) :: law
    type(joint_state) :: old, new
    real(rk) :: jump(3, 1), iterate(3, 1), tangent(3, 3, 1), multiplier(3, 1), scale(2, 1)
    law = joint_of(0.0_rk, 0.6_rk, 0.0_rk, 0.0_rk)
    call law%start_state([0.0_rk], old)
    new = old
    jump = 0.0_rk
    scale(:, 1) = 0.01_rk*[kn, kt]
    multiplier(:, 1) = [-1.0e6_rk, 0.0_rk, 0.0_rk]
    jump(1, 1) = 0.9_rk*0.99e6_rk/scale(1, 1) ! opens where r v + 0.99 lambda > 0
    call law%linearise(jump, old, multiplier, scale, new, iterate, tangent)
    call check(log, new%status(1) == state_open, 'the law itself is open')
    call check_close(log, tangent(1, 1, 1), kn, 0.0_rk, 'closed for the next iterate')
    call check_close(log, iterate(1, 1), kn*jump(1, 1), 0.0_rk, 'no pressure at no opening')
    jump(1, 1) = 1.1_rk*0.99e6_rk/scale(1, 1)
    call law%linearise(jump, old, multiplier, scale, new, iterate, tangent)
    call check_close(log, maxval(abs(tangent)) + maxval(abs(iterate)), 0.0_rk, 0.0_rk, 'opens')
    multiplier = 0.0_rk
    jump(1, 1) = -1.0e-9_rk
    call law%linearise(jump, old, multiplier, scale, new, iterate, tangent)
    call check_close(log, tangent(1, 1, 1), kn, 0.0_rk, 'closes')
  end subroutine multiplier_decides_the_contact

  !> paper_notes.md, 3: 22 GPa over 2 cm.
  subroutine defaults_follow_the_solid(log)
    type(test_log), intent(inout) :: log
    class(traction_law), allocatable :: law
    real(rk) :: k(3)
    call make_joint_law('CONTRACTION', law)
    call check(log, law%needs_solid(), 'stiffnesses are to come')
    call law%complete(solid_behind(young=22.0e9_rk, poisson=0.167_rk))
    call check(log,.not. law%needs_solid(), 'stiffnesses are there')
    call law%reference_stiffness(k)
    call check_close(log, k(1), 1.1e12_rk, 1.0_rk, 'k_n')
    call check_close(log, k(2), 1.1e12_rk/2.334_rk, 1.0_rk, 'k_t')
  end subroutine defaults_follow_the_solid
end program test_joint_contraction
