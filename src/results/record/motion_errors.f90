!> The error of the largest displacement, as far as it is known (theory.md, 14.2-14.3).
module motion_errors
  use kinds, only: rk
  use analysis_state, only: state
  use extremes, only: extreme
  use problem_definition, only: problem
  use run_ledger, only: ledger
  use stress_error, only: energy_of_stresses
  use stress_fields, only: recovered_fields
  use stress_recovery, only: recovery_plan
  implicit none
  private
  public :: motion_error, note_time_error, note_dual

  type :: motion_error
    real(rk) :: at_time = 0.0_rk !< displacement whose error in time is known [m]
    real(rk) :: time = 0.0_rk !< error of the time integration [m]
    real(rk) :: history = -1.0_rk !< of histories, over the largest displacement; -1: not known
    real(rk) :: at_dual = 0.0_rk !< displacement whose error of the mesh is known [m]
    real(rk) :: mesh = 0.0_rk !< error of the mesh [m]
  contains
    procedure :: has_time, has_mesh
  end type motion_error

  real(rk), parameter :: roundoff = 1.0e-9_rk !< of a displacement that is computed twice

contains

  !> Whether the error in time of this displacement is known.
  pure logical function has_time(self, largest)
    class(motion_error), intent(in) :: self
    type(extreme), intent(in) :: largest !< displacement of the run
    has_time = self%at_time > 0.0_rk &
               .and. abs(self%at_time - largest%value) <= roundoff*largest%value
  end function has_time

  !> Whether the error of the mesh in this displacement is known.
  pure logical function has_mesh(self, largest)
    class(motion_error), intent(in) :: self
    type(extreme), intent(in) :: largest !< displacement of the run
    has_mesh = self%at_dual > 0.0_rk &
               .and. abs(self%at_dual - largest%value) <= roundoff*largest%value
  end function has_mesh

  !> Takes over the estimate of the present step, unless an earlier displacement was larger.
  subroutine note_time_error(found, record)
    real(rk), intent(in) :: found(3) !< displacement [m], its error [m], relative error of histories
    type(motion_error), intent(inout) :: record
    if (found(1) <= 0.0_rk .or. found(1) < record%at_time) return
    record%at_time = found(1)
    record%time = abs(found(2))
    record%history = found(3)
  end subroutine note_time_error

  !> Takes the dual solution, if there is one.
  subroutine note_dual(model, now, costs, dual, stresses, record)
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(ledger), intent(in) :: costs
    real(rk), allocatable, intent(inout) :: dual(:, :) !< (3, nodes) [m/N]; is taken
    type(recovered_fields), intent(inout) :: stresses
    type(motion_error), intent(inout) :: record
    if (.not. allocated(dual)) return
    call costs%start('estimate', 'mesh', 'output')
    call weigh_dual(model, now, dual, stresses, record)
    call costs%stop()
  end subroutine note_dual

  !> The error of the mesh in the largest displacement of a linear static state: the defects of its
  !> stresses and of those under a unit force there, over each other (theory.md, 14.2).
  subroutine weigh_dual(model, now, dual, stresses, record)
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    real(rk), allocatable, intent(inout) :: dual(:, :) !< (3, nodes) [m/N]; is taken
    type(recovered_fields), intent(inout) :: stresses
    type(motion_error), intent(inout) :: record
    type(state), allocatable :: other
    real(rk), allocatable :: defect(:, :, :), energy(:), taken(:, :)
    real(rk) :: largest
    call move_alloc(dual, taken)
    largest = maxval(norm2(now%u, dim=1))
    if (largest <= record%at_dual) return
    call stresses%need_plan(model)
    if (.not. is_reliable(stresses%plan)) return
    call stresses%need_error(model, now)
    defect = stresses%defect
    allocate (other, source=now)
    call move_alloc(taken, other%u)
    call stresses%invalidate()
    call stresses%need_error(model, other)
    allocate (energy(size(defect, 3)))
    call energy_of_stresses(model, stresses%plan, stresses%smoothing, defect, stresses%defect, &
                            energy)
    call stresses%invalidate()
    record%at_dual = largest
    record%mesh = abs(sum(energy))
  end subroutine weigh_dual

  !> Whether all solids are C3D8 or C3D8B: with other elements the estimate is 0.3 to 100 times the
  !> error (verification.md).
  logical function is_reliable(plan)
    type(recovery_plan), intent(in) :: plan
    integer :: i
    is_reliable = .true.
    do i = 1, size(plan%formulations)
      is_reliable = is_reliable .and. any(plan%formulations(i)%item%name == ['C3D8 ', 'C3D8B'])
    end do
  end function is_reliable
end module motion_errors
