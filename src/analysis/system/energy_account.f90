!> The energy balance of an increment (theory.md, 7.3).
!>
!> External work and damping are the work of their mean forces over the increment; kinetic and
!> stored energies are those at its end. `numerical` is the dissipation of the time stepping by its
!> formula: numerical damping, and work of joints and inelastic solids beyond their stored and
!> dissipated energies. The remainder, `error`, measures the residual of the equations.
module energy_account
  use kinds, only: rk
  use global_vectors, only: dot, total, work
  use problem_definition, only: problem
  use guest_history, only: stored_work
  use guest_histories, only: sum_work
  use analysis_state, only: energy_balance, motion, state
  use step_system, only: dam_system
  use matrix_pattern, only: pattern
  use thermal_work, only: add_thermal_work
  use unknown_parts, only: unknown_part
  implicit none
  private
  public :: open_account, add_static_work, add_dynamic_work, find_error

  !> Floor of the largest energy, as a fraction of the sum of K_ii q_i^2: energies below it are
  !> round-off of the motion.
  real(rk), parameter :: idle_share = 1.0e-11_rk

contains

  !> Kinetic and strain energy at the start of a step. At the start of the analysis they are the
  !> initial energy, together with the dissipation by initial displacements.
  subroutine open_account(model, system, now, is_first, changes_stage)
    type(problem), intent(in) :: model
    type(dam_system), intent(in) :: system
    type(state), intent(inout) :: now
    logical, intent(in) :: is_first !< step of the analysis
    logical, intent(in) :: changes_stage !< elements have come or gone, or joints were grouted
    type(stored_work) :: guests
    real(rk) :: kinetic_before, others_before
    call sum_work(model, now, guests)
    associate (energy => now%energy)
      kinetic_before = energy%kinetic
      others_before = energy%strain + energy%friction + energy%fracture
      call set_stored(guests, system, now)
      if (is_first) then
        energy%initial = energy%kinetic + energy%strain + energy%friction + energy%fracture
      else ! kinetic energy is lost where velocities are set to zero
        energy%numerical = energy%numerical + kinetic_before - energy%kinetic
        if (changes_stage) energy%stages = energy%stages - others_before + energy%strain &
                                           + energy%friction + energy%fracture
      end if
      call find_error(energy)
    end associate
  end subroutine open_account

  !> Adds the work of a static increment. Residual forces at the start of the step do work that is
  !> not stored.
  subroutine add_static_work(model, system, before, after)
    type(problem), intent(in) :: model
    type(dam_system), intent(in) :: system
    type(state), intent(in) :: before
    type(state), intent(inout) :: after
    type(stored_work) :: guests
    real(rk), allocatable :: du(:)
    real(rk) :: released
    call sum_work(model, after, guests)
    associate (old => before%motion, new => after%motion, n => system%matrix%num_free, &
               part => system%matrix%part)
      du = new%q - old%q
      call add_external(system%matrix, du, old, new, after%energy)
      if (allocated(new%release) .and. model%steps(after%step)%changes_stage) then
        released = work(part, du, old%release, new%release)
        after%energy%stages = after%energy%stages + released
        after%energy%external = after%energy%external - released
      end if
      after%energy%numerical = after%energy%numerical + work(part, du, old%contact, new%contact) &
                               + work(part, du(:n), old%balanced, new%balanced) &
                               + inelastic_work(part, du, old, new) &
                               - change_of_stores(model, before, guests)
    end associate
    call add_thermal_work(model, system%matrix%part, before, after)
    call set_stored(guests, system, after)
  end subroutine add_static_work

  !> Adds the work of a dynamic increment, or of a part of it.
  subroutine add_dynamic_work(model, system, before, after, excess)
    type(problem), intent(in) :: model
    type(dam_system), intent(in) :: system
    type(state), intent(in) :: before
    type(state), intent(inout) :: after
    !> Change of the kinetic energy beyond du . M a_mean, from the formulas of the scheme [J]
    real(rk), intent(in) :: excess
    type(stored_work) :: guests
    real(rk), allocatable :: du(:)
    real(rk) :: taken, lost, of_correction
    call sum_work(model, after, guests)
    associate (old => before%motion, new => after%motion, n => system%matrix%num_free, &
               part => system%matrix%part)
      du = new%q - old%q
      call add_external(system%matrix, du, old, new, after%energy)
      lost = 0.0_rk
      if (allocated(new%lost_damping)) lost = work(part, du, old%lost_damping, new%lost_damping)
      after%energy%damping = after%energy%damping + work(part, du, old%viscous, new%viscous) - lost
      of_correction = 0.0_rk
      if (allocated(new%correction)) then
        of_correction = dot(part, du(n + 1:), new%correction(n + 1:), n)
        after%energy%external = after%energy%external + of_correction
      end if
      taken = work(part, du(:n), old%external(:n), new%external(:n)) &
              - work(part, du(:n), old%viscous(:n), new%viscous(:n)) &
              - work(part, du(:n), old%elastic(:n), new%elastic(:n)) &
              - work(part, du(:n), old%balanced(:n), new%balanced(:n)) &
              + work(part, du(n + 1:), old%contact(n + 1:), new%contact(n + 1:), n) &
              + inelastic_work(part, du(n + 1:), old, new, n) + of_correction &
              - change_of_stores(model, before, guests) - excess + lost
    end associate
    after%energy%numerical = after%energy%numerical + taken
    call add_thermal_work(model, system%matrix%part, before, after)
    call set_stored(guests, system, after)
  end subroutine add_dynamic_work

  !> Work of the loads and of moving supports.
  subroutine add_external(matrix, du, old, new, energy)
    type(pattern), intent(in) :: matrix
    real(rk), intent(in) :: du(:)
    type(motion), intent(in) :: old, new
    type(energy_balance), intent(inout) :: energy
    associate (n => matrix%num_free, part => matrix%part)
      energy%external = energy%external + work(part, du, old%external, new%external) &
                        + work(part, du(n + 1:), old%internal(n + 1:), new%internal(n + 1:), n) &
                        + work(part, du(n + 1:), old%contact(n + 1:), new%contact(n + 1:), n) &
                        - work(part, du(n + 1:), old%external(n + 1:), new%external(n + 1:), n)
      if (.not. allocated(new%inertia)) return
      energy%external = energy%external &
                        + work(part, du(n + 1:), old%inertia(n + 1:), new%inertia(n + 1:), n) &
                        + work(part, du(n + 1:), old%viscous(n + 1:), new%viscous(n + 1:), n)
    end associate
  end subroutine add_external

  !> Work of the internal forces beyond that of K q.
  real(rk) function inelastic_work(part, du, old, new, skipped) result(taken)
    type(unknown_part), intent(in) :: part
    real(rk), intent(in) :: du(:)
    type(motion), intent(in) :: old, new
    integer, intent(in), optional :: skipped !< unknowns before the first of `du`
    integer :: first
    first = 1
    if (present(skipped)) first = skipped + 1
    taken = work(part, du, old%internal(first:) - old%elastic(first:), &
                 new%internal(first:) - new%elastic(first:), skipped)
  end function inelastic_work

  !> Change of stored and dissipated energy of guests with a history, beyond 1/2 q K q.
  real(rk) function change_of_stores(model, before, new) result(change)
    type(problem), intent(in) :: model
    type(state), intent(in) :: before
    type(stored_work), intent(in) :: new !< after the increment
    type(stored_work) :: old
    call sum_work(model, before, old)
    change = new%stored - old%stored + new%friction - old%friction + new%fracture - old%fracture
  end function change_of_stores

  !> Energies of the state.
  subroutine set_stored(guests, system, now)
    type(stored_work), intent(in) :: guests !< of the histories of `now`
    type(dam_system), intent(in) :: system
    type(state), intent(inout) :: now
    associate (own => now%motion, energy => now%energy, part => system%matrix%part)
      energy%kinetic = 0.0_rk
      if (allocated(own%momentum)) energy%kinetic = 0.5_rk*dot(part, own%v, own%momentum)
      energy%strain = system%stored_energy(own%q, own%elastic) + guests%stored
      energy%friction = guests%friction
      energy%fracture = guests%fracture + energy%left_cracking + energy%left_crushing
      energy%crushing = guests%crushing + energy%left_crushing
      energy%largest = max(energy%largest, idle_share*total(part, system%diagonal*own%q**2))
      call find_error(energy)
    end associate
  end subroutine set_stored

  !> The error over the largest energy so far.
  pure subroutine find_error(energy)
    type(energy_balance), intent(inout) :: energy
    real(rk) :: imbalance
    imbalance = energy%external + energy%initial + energy%stages + energy%temperature &
                - energy%kinetic - energy%strain - energy%damping - energy%friction &
                - energy%fracture - energy%numerical
    energy%largest = max(energy%largest, abs(energy%external), energy%kinetic, energy%strain, &
                         abs(energy%damping), energy%friction, energy%fracture, energy%initial, &
                         abs(energy%stages), abs(energy%temperature))
    energy%error = abs(imbalance)/max(energy%largest, tiny(1.0_rk))
  end subroutine find_error
end module energy_account
