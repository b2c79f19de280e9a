!> The error that the mesh leaves in the stresses, taken where it costs little: at the end of static
!> steps, and whenever the strain energy has grown much since the last time (theory.md, 14.1).
module space_errors
  use kinds, only: rk
  use problem_definition, only: problem
  use analysis_state, only: state
  use stress_error, only: hides_error
  use stress_fields, only: recovered_fields
  implicit none
  private
  public :: space_error, note_space_error

  !> Of the strain energy, from one sample to the next. A static step has a sample at its end. Loads
  !> that grow in equal parts have energies of 1, 4, 9 ...: a growth by 4 would depend on round-off.
  real(rk), parameter :: growth_in_motion = 1.5_rk, growth_in_static = 4.1_rk
  !> Strain energy of a free heated body over that of the held one: round-off, with a margin of 1e3.
  real(rk), parameter :: round_off = 1.0e-12_rk

  !> Energy norms at the sample with the largest stresses.
  type :: space_error
    real(rk) :: stress = 0.0_rk !< root of twice the strain energy of the stresses [J^0.5]
    real(rk) :: error = 0.0_rk !< of their error [J^0.5]
    real(rk) :: time = 0.0_rk !< total time [s]
    real(rk) :: sampled = 0.0_rk !< largest strain energy at a sample [J]
    real(rk) :: elastic = 1.0_rk !< part of the volume that is elastic: the others are left out
  contains
    procedure :: relative, is_unknown
  end type space_error

contains

  !> The error over the norm of the true stresses, as far as it is known.
  pure real(rk) function relative(self)
    class(space_error), intent(in) :: self
    relative = self%error/max(tiny(1.0_rk), hypot(self%stress, self%error))
  end function relative

  !> Whether samples were due and the error of none of them is known.
  pure logical function is_unknown(self)
    class(space_error), intent(in) :: self
    is_unknown = self%sampled > 0.0_rk .and. self%stress <= 0.0_rk
  end function is_unknown

  !> Takes a sample where one is due.
  subroutine note_space_error(model, now, stresses, record)
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(recovered_fields), intent(inout) :: stresses !< of this increment
    type(space_error), intent(inout) :: record
    real(rk) :: norm, growth
    logical :: is_due
    is_due = model%steps(now%step)%procedure%is_static()
    growth = merge(growth_in_static, growth_in_motion, is_due)
    is_due = is_due .and. now%is_last_of_step
    ! A reduced model has stresses at the end of its step.
    if (now%reduction%num_modes == 0) then
      is_due = is_due .or. now%energy%strain > growth*record%sampled
    else
      is_due = is_due .or. now%is_last_of_step
    end if
    if (.not. is_due) return
    if (now%energy%strain <= round_off*abs(now%motion%thermal_energy)) return
    record%sampled = max(record%sampled, now%energy%strain)
    call stresses%need_error(model, now)
    associate (energy => stresses%stress_energy)
      if (hides_error(stresses%smoothing, energy, energy)) return
    end associate
    norm = sqrt(sum(stresses%stress_energy, mask=.not. stresses%is_inelastic))
    if (norm <= record%stress) return
    record%stress = norm
    record%error = sqrt(sum(stresses%error_energy, mask=.not. stresses%is_inelastic))
    record%time = now%total_time
    record%elastic = 1.0_rk
    if (.not. any(stresses%is_inelastic)) return
    associate (volume => stresses%smoothing%volume)
      record%elastic = sum(sum(volume, dim=1), mask=.not. stresses%is_inelastic)/sum(volume)
    end associate
  end subroutine note_space_error
end module space_errors
