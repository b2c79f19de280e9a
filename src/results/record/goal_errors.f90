!> The errors of the largest displacement and of the largest opening, as far as they are known
!> (theory.md, 14.2-14.3).
module goal_errors
  use kinds, only: rk
  use analysis_state, only: state
  use dual_solutions, only: dual_solution
  use problem_definition, only: problem
  use run_ledger, only: ledger
  use stress_error, only: energy_of_stresses
  use stress_fields, only: recovered_fields
  use stress_recovery, only: recovery_plan
  implicit none
  private
  public :: goal_error, note_time_error, note_duals

  type :: goal_error
    real(rk) :: at_time = 0.0_rk !< result whose error in time is known [m]
    real(rk) :: time = 0.0_rk !< error of the time integration [m]
    real(rk) :: history = -1.0_rk !< of histories, over the largest result; -1: not known
    real(rk) :: at_dual = 0.0_rk !< result that the other errors belong to [m]
    real(rk) :: mesh = -1.0_rk !< error of the mesh; -1: not known [m]
    real(rk) :: joints = -1.0_rk !< error by the springs of closed joints; -1: not known [m]
    real(rk) :: iteration = -1.0_rk !< error by the residual of the iteration; -1: not known [m]
  contains
    procedure :: has_time, has_mesh, has_joints, has_iteration, total
    procedure, private :: is_of
  end type goal_error

  real(rk), parameter :: roundoff = 1.0e-9_rk !< of a result that is computed twice

contains

  !> Whether the error in time of this result is known.
  pure logical function has_time(self, largest)
    class(goal_error), intent(in) :: self
    real(rk), intent(in) :: largest !< of the run [m]
    has_time = self%at_time > 0.0_rk .and. abs(self%at_time - largest) <= roundoff*largest
  end function has_time

  !> Whether the dual solution belongs to this result.
  pure logical function is_of(self, largest)
    class(goal_error), intent(in) :: self
    real(rk), intent(in) :: largest !< of the run [m]
    is_of = self%at_dual > 0.0_rk .and. abs(self%at_dual - largest) <= roundoff*largest
  end function is_of

  !> Whether the error of the mesh in this result is known.
  pure logical function has_mesh(self, largest)
    class(goal_error), intent(in) :: self
    real(rk), intent(in) :: largest !< of the run [m]
    has_mesh = self%is_of(largest) .and. self%mesh >= 0.0_rk
  end function has_mesh

  !> Whether the error by the springs of joints is known.
  pure logical function has_joints(self, largest)
    class(goal_error), intent(in) :: self
    real(rk), intent(in) :: largest !< of the run [m]
    has_joints = self%is_of(largest) .and. self%joints >= 0.0_rk
  end function has_joints

  !> Whether the error by the residual of the iteration is known.
  pure logical function has_iteration(self, largest)
    class(goal_error), intent(in) :: self
    real(rk), intent(in) :: largest !< of the run [m]
    has_iteration = self%is_of(largest) .and. self%iteration >= 0.0_rk
  end function has_iteration

  !> The sum of all errors that are known; -1 where none is.
  pure real(rk) function total(self, largest)
    class(goal_error), intent(in) :: self
    real(rk), intent(in) :: largest !< of the run [m]
    logical :: is_known(4)
    is_known = [self%has_time(largest), self%has_mesh(largest), self%has_joints(largest), &
                self%has_iteration(largest)]
    total = sum([self%time, self%mesh, self%joints, self%iteration], mask=is_known)
    if (.not. any(is_known)) total = -1.0_rk
  end function total

  !> Takes over the estimate of the present step, unless an earlier result was larger.
  subroutine note_time_error(found, record)
    real(rk), intent(in) :: found(3) !< result [m], its error [m], relative error of histories
    type(goal_error), intent(inout) :: record
    if (found(1) <= 0.0_rk .or. found(1) < record%at_time) return
    record%at_time = found(1)
    record%time = abs(found(2))
    record%history = found(3)
  end subroutine note_time_error

  !> Takes the dual solutions, if there are any.
  subroutine note_duals(model, now, costs, duals, stresses, records)
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(ledger), intent(in) :: costs
    type(dual_solution), allocatable, intent(inout) :: duals(:) !< are taken
    type(recovered_fields), intent(inout) :: stresses
    type(goal_error), intent(inout) :: records(:) !< (results)
    type(dual_solution), allocatable :: taken(:)
    integer :: k
    if (.not. allocated(duals)) return
    call costs%start('estimate', 'mesh', 'output')
    call move_alloc(duals, taken)
    do k = 1, size(taken)
      associate (own => records(taken(k)%goal))
        if (taken(k)%value <= own%at_dual) cycle
        own%at_dual = taken(k)%value
        own%mesh = -1.0_rk
        own%joints = taken(k)%joints
        own%iteration = taken(k)%iteration
        call weigh_dual(model, now, taken(k)%u, stresses, own%mesh)
      end associate
    end do
    call costs%stop()
  end subroutine note_duals

  !> The error of the mesh in a result of a linear static state: the defects of its stresses and of
  !> those under a unit force, over each other (theory.md, 14.2).
  subroutine weigh_dual(model, now, dual, stresses, error)
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    real(rk), allocatable, intent(inout) :: dual(:, :) !< (3, nodes) [m/N]; is taken
    type(recovered_fields), intent(inout) :: stresses
    real(rk), intent(inout) :: error !< not changed where the estimate would mislead [m]
    type(state), allocatable :: other
    real(rk), allocatable :: defect(:, :, :), energy(:)
    call stresses%need_plan(model)
    if (.not. is_reliable(stresses%plan)) return
    call stresses%need_error(model, now)
    defect = stresses%defect
    allocate (other, source=now)
    call move_alloc(dual, other%u)
    call stresses%invalidate()
    call stresses%need_error(model, other)
    allocate (energy(size(defect, 3)))
    call energy_of_stresses(model, stresses%plan, stresses%smoothing, defect, stresses%defect, &
                            energy)
    call stresses%invalidate()
    error = abs(sum(energy))
  end subroutine weigh_dual

  !> Whether the estimate says something of all solids: with C3D8R it is up to 100 times the error
  !> (verification.md).
  logical function is_reliable(plan)
    type(recovery_plan), intent(in) :: plan
    integer :: i
    is_reliable = .true.
    do i = 1, size(plan%formulations)
      is_reliable = is_reliable .and. plan%formulations(i)%item%name /= 'C3D8R'
    end do
  end function is_reliable
end module goal_errors
