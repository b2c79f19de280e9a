!> The energy balance of an increment (theory.md, 7.3).
!>
!> External work and damping are the work of the mean of their forces at the two ends of the
!> increment; kinetic and stored energies are those of the end. `numerical` is what the formula of
!> the stepping says that it takes: the damping of the time stepping, and the work of joints and
!> inelastic solids along the increment beyond what they store and dissipate. What then is missing,
!> `error`, shows a solution that does not satisfy the equations.
module energy_account
  use kinds, only: rk
  use problem_definition, only: problem
  use inelastic_energy, only: solid_work, sum_solid_work
  use joint_forces, only: joint_work, sum_joint_work
  use analysis_state, only: energy_balance
  use motion_state, only: motion
  use hht_scheme, only: hht
  implicit none
  private
  public :: open_account, add_static_work, add_dynamic_work

  !> Of the energy that would hold all unknowns but one: what the last digits of the motion make of
  !> it is no imbalance.
  real(rk), parameter :: idle_share = 1.0e-11_rk

contains

  !> Kinetic and strain energy of the motion as it is; on the first call of an analysis they are
  !> the energy it begins with, and so is what initial displacements have dissipated.
  subroutine open_account(scene, moving, is_first, energy)
    type(problem), intent(in) :: scene
    type(motion), intent(in) :: moving
    logical, intent(in) :: is_first
    type(energy_balance), intent(inout) :: energy
    real(rk) :: kinetic_before
    kinetic_before = energy%kinetic
    call set_stored(scene, moving, energy)
    if (is_first) then
      energy%initial = energy%kinetic + energy%strain + energy%friction + energy%fracture
    end if
    ! Velocities that a step does not take over are taken by the stepping.
    if (.not. is_first) energy%numerical = energy%numerical + kinetic_before - energy%kinetic
    call find_error(energy)
  end subroutine open_account

  !> Adds the work of a static increment. Forces that had no balance at the start of the step did
  !> work that nothing keeps.
  subroutine add_static_work(scene, num_free, before, after, energy)
    type(problem), intent(in) :: scene
    integer, intent(in) :: num_free
    type(motion), intent(in) :: before, after
    type(energy_balance), intent(inout) :: energy
    real(rk), allocatable :: du(:)
    du = after%q - before%q
    call add_external(du, num_free, before, after, energy)
    energy%numerical = energy%numerical + work(du, before%contact, after%contact) &
                       + work(du(:num_free), before%balanced, after%balanced) &
                       - joint_change(scene, before, after)
    if (size(after%released) > 0) then
      energy%numerical = energy%numerical - work(du, before%released, after%released) &
                         - solid_change(scene, before, after)
    end if
    call set_stored(scene, after, energy)
  end subroutine add_static_work

  !> Adds the work of a dynamic increment.
  subroutine add_dynamic_work(scheme, scene, num_free, before, after, energy)
    type(hht), intent(in) :: scheme
    type(problem), intent(in) :: scene
    integer, intent(in) :: num_free
    type(motion), intent(in) :: before, after
    type(energy_balance), intent(inout) :: energy
    real(rk), allocatable :: du(:)
    real(rk) :: taken
    du = after%q - before%q
    call add_external(du, num_free, before, after, energy)
    energy%damping = energy%damping + work(du, before%viscous, after%viscous)
    associate (free => du(:num_free), held => du(num_free + 1:), n => num_free)
      taken = work(free, before%external(:n), after%external(:n)) &
              - work(free, before%viscous(:n), after%viscous(:n)) &
              - work(free, before%elastic(:n), after%elastic(:n)) &
              - work(free, before%balanced(:n), after%balanced(:n)) &
              + work(held, before%contact(n + 1:), after%contact(n + 1:)) &
              - joint_change(scene, before, after) &
              - newmark_excess(scheme, du, before, after)
      if (size(after%released) > 0) then
        taken = taken - work(held, before%released(n + 1:), after%released(n + 1:)) &
                - solid_change(scene, before, after)
      end if
    end associate
    energy%numerical = energy%numerical + taken
    call set_stored(scene, after, energy)
  end subroutine add_dynamic_work

  !> Work of the loads, and of the supports that move.
  subroutine add_external(du, num_free, before, after, energy)
    real(rk), intent(in) :: du(:)
    integer, intent(in) :: num_free
    type(motion), intent(in) :: before, after
    type(energy_balance), intent(inout) :: energy
    associate (n => num_free)
      energy%external = energy%external + work(du, before%external, after%external) &
                        + work(du(n + 1:), before%inertia(n + 1:), after%inertia(n + 1:)) &
                        + work(du(n + 1:), before%viscous(n + 1:), after%viscous(n + 1:)) &
                        + work(du(n + 1:), before%elastic(n + 1:), after%elastic(n + 1:)) &
                        + work(du(n + 1:), before%contact(n + 1:), after%contact(n + 1:)) &
                        - work(du(n + 1:), before%external(n + 1:), after%external(n + 1:))
      if (size(after%released) == 0) return
      energy%external = energy%external &
                        - work(du(n + 1:), before%released(n + 1:), after%released(n + 1:))
    end associate
  end subroutine add_external

  !> Change of the kinetic energy beyond du . M a_mean (7.4).
  pure real(rk) function newmark_excess(scheme, du, before, after) result(excess)
    type(hht), intent(in) :: scheme
    real(rk), intent(in) :: du(:)
    type(motion), intent(in) :: before, after
    real(rk) :: du_dma, da_ma, da_dma
    du_dma = dot_product(du, after%inertia - before%inertia)
    da_ma = work(after%a - before%a, before%inertia, after%inertia)
    da_dma = dot_product(after%a - before%a, after%inertia - before%inertia)
    associate (g => scheme%gamma - 0.5_rk, b => scheme%beta - 0.5_rk*scheme%gamma)
      excess = g*du_dma - b*scheme%dt**2*(da_ma + g*da_dma)
    end associate
  end function newmark_excess

  !> du . (f0 + f1)/2.
  pure real(rk) function work(du, f0, f1)
    real(rk), intent(in) :: du(:), f0(:), f1(:)
    integer :: i
    work = 0.0_rk
    do i = 1, size(du)
      work = work + du(i)*(f0(i) + f1(i))
    end do
    work = 0.5_rk*work
  end function work

  !> Change of what the joints store and dissipate.
  real(rk) function joint_change(scene, before, after) result(change)
    type(problem), intent(in) :: scene
    type(motion), intent(in) :: before, after
    type(joint_work) :: first, last
    call sum_joint_work(scene%joints, before%joints, first)
    call sum_joint_work(scene%joints, after%joints, last)
    change = last%stored - first%stored + last%friction - first%friction &
             + last%fracture - first%fracture
  end function joint_change

  !> Change of what inelastic solids store beyond 1/2 q K q, and of what they have dissipated.
  real(rk) function solid_change(scene, before, after) result(change)
    type(problem), intent(in) :: scene
    type(motion), intent(in) :: before, after
    type(solid_work) :: first, last
    call sum_solid_work(scene, before%points, first)
    call sum_solid_work(scene, after%points, last)
    change = last%stored - first%stored + last%fracture - first%fracture
  end function solid_change

  !> Energies of the state itself.
  subroutine set_stored(scene, moving, energy)
    type(problem), intent(in) :: scene
    type(motion), intent(in) :: moving
    type(energy_balance), intent(inout) :: energy
    type(joint_work) :: total
    type(solid_work) :: own
    call sum_joint_work(scene%joints, moving%joints, total)
    energy%kinetic = 0.5_rk*dot_product(moving%v, moving%momentum)
    energy%strain = 0.5_rk*dot_product(moving%q, moving%elastic) + total%stored
    energy%friction = total%friction
    energy%fracture = total%fracture
    if (size(moving%points) > 0) then
      call sum_solid_work(scene, moving%points, own)
      energy%strain = energy%strain + own%stored
      energy%fracture = energy%fracture + own%fracture
      energy%crushing = own%crushing
    end if
    energy%largest = max(energy%largest, idle_share*sum(moving%stiffness*moving%q**2))
    call find_error(energy)
  end subroutine set_stored

  !> The imbalance over the largest energy so far.
  pure subroutine find_error(energy)
    type(energy_balance), intent(inout) :: energy
    real(rk) :: imbalance
    imbalance = energy%external + energy%initial - energy%kinetic - energy%strain - energy%damping &
                - energy%friction - energy%fracture - energy%numerical
    energy%largest = max(energy%largest, abs(energy%external), energy%kinetic, energy%strain, &
                         abs(energy%damping), energy%friction, energy%fracture, energy%initial)
    energy%error = abs(imbalance)/max(energy%largest, tiny(1.0_rk))
  end subroutine find_error
end module energy_account
