!> The errors of the largest displacement and of the largest opening, as far as they are known
!> (theory.md, 14.2-14.4).
module goal_errors
  use kinds, only: rk
  use analysis_state, only: state
  use dual_solutions, only: dual_solution, of_displacement, of_opening
  use dual_weighting, only: weigh_defects, weigh_own_defects
  use problem_definition, only: problem
  use run_ledger, only: ledger
  use stress_fields, only: recovered_fields
  use recovery_plans, only: recovery_plan
  implicit none
  private
  public :: cause_of_stray, goal_error, note_motion_errors, note_duals, find_stiffening

  type :: goal_error
    real(rk) :: at_time = 0.0_rk !< result whose error in time is known [m]
    real(rk) :: time = 0.0_rk !< error of the time integration [m]
    real(rk) :: history = -1.0_rk !< of histories, over the largest result; -1: not known
    real(rk) :: at_dual = 0.0_rk !< result whose other errors are known [m]
    real(rk) :: mesh = -1.0_rk !< error of the mesh; -1: not known [m]
    real(rk) :: joints = -1.0_rk !< error by the springs of closed joints; -1: not known [m]
    real(rk) :: iteration = -1.0_rk !< error by the residual of the iteration; -1: not known [m]
    real(rk) :: at_stray = 0.0_rk !< result that does not follow the modes of its step [m]
  contains
    procedure :: has_time, has_mesh, has_joints, has_iteration, is_soft, is_stray, total
    procedure, private :: is_of
  end type goal_error

  !> Why a result does not follow the modes of its step, so that its errors are not known.
  character(*), parameter :: cause_of_stray = 'bodies rock or slide, joints lose their '// &
                             'strength, or openings do not follow the modes'
  !> Of a result: what springs of joints may contribute as an error.
  real(rk), parameter :: largest_share = 0.25_rk
  real(rk), parameter :: roundoff = 1.0e-9_rk !< of a result that is computed twice

contains

  !> Whether the error in time of this result is known.
  pure logical function has_time(self, largest)
    class(goal_error), intent(in) :: self
    real(rk), intent(in) :: largest !< of the run [m]
    has_time = self%at_time > 0.0_rk .and. abs(self%at_time - largest) <= roundoff*largest
  end function has_time

  !> Whether this result has no error in time because it does not follow the modes: a body rocks or
  !> slides.
  pure logical function is_stray(self, largest)
    class(goal_error), intent(in) :: self
    real(rk), intent(in) :: largest !< of the run [m]
    is_stray = self%at_stray > 0.0_rk .and. abs(self%at_stray - largest) <= roundoff*largest
  end function is_stray

  !> Whether the errors other than that in time belong to this result.
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
    has_joints = self%is_of(largest) .and. self%joints >= 0.0_rk .and. .not. self%is_soft(largest)
  end function has_joints

  !> Whether the springs of joints are too soft to be an error: they are meant, and a first order
  !> says little of rigid ones.
  pure logical function is_soft(self, largest)
    class(goal_error), intent(in) :: self
    real(rk), intent(in) :: largest !< of the run [m]
    is_soft = self%is_of(largest) .and. self%joints > largest_share*self%at_dual
  end function is_soft

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

  !> Takes over the estimates of the present dynamic step, unless an earlier result was larger.
  subroutine note_motion_errors(displacement, opening, mesh, records)
    !> Result [m], its error in time [m], that of histories over the result
    real(rk), intent(in) :: displacement(3), opening(3)
    real(rk), intent(in) :: mesh(:) !< (results) error of the mesh; -1: not known [m]
    type(goal_error), intent(inout) :: records(:) !< (results)
    call note(displacement, mesh(of_displacement), records(of_displacement))
    call note(opening, mesh(of_opening), records(of_opening))
  contains
    !> One result.
    subroutine note(found, of_mesh, record)
      real(rk), intent(in) :: found(3), of_mesh
      type(goal_error), intent(inout) :: record
      if (found(1) <= 0.0_rk .or. found(1) < max(record%at_time, record%at_stray)) return
      record%at_time = 0.0_rk
      record%history = -1.0_rk
      record%at_stray = merge(found(1), 0.0_rk, found(2) < 0.0_rk .and. found(3) < 0.0_rk)
      if (record%at_stray > 0.0_rk) return
      record%at_time = found(1)
      record%time = abs(found(2))
      record%history = found(3)
      if (of_mesh < 0.0_rk .or. found(1) < record%at_dual) return
      record%at_dual = found(1)
      record%mesh = of_mesh
      record%joints = -1.0_rk
      record%iteration = -1.0_rk
    end subroutine note
  end subroutine note_motion_errors

  !> Takes the dual solutions, if there are any.
  subroutine note_duals(model, now, costs, duals, stresses, records)
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(ledger), intent(in) :: costs
    type(dual_solution), allocatable, intent(inout) :: duals(:) !< are taken
    type(recovered_fields), intent(inout) :: stresses
    type(goal_error), intent(inout) :: records(:) !< (results)
    type(dual_solution), allocatable :: taken(:)
    real(rk), allocatable :: error(:)
    integer :: k
    if (.not. allocated(duals)) return
    call costs%start('estimate', 'mesh', 'output')
    call move_alloc(duals, taken)
    allocate (error(size(taken)))
    call weigh_duals(model, now, stresses, taken, error)
    do k = 1, size(taken)
      associate (own => records(taken(k)%goal))
        if (taken(k)%value <= own%at_dual) cycle
        own%at_dual = taken(k)%value
        own%mesh = error(k)
        own%joints = taken(k)%joints
        own%iteration = taken(k)%iteration
      end associate
    end do
    call costs%stop()
  end subroutine note_duals

  !> The error of the mesh in each result (theory.md, 14.2).
  subroutine weigh_duals(model, now, stresses, duals, error)
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(recovered_fields), intent(inout) :: stresses
    type(dual_solution), intent(in) :: duals(:)
    real(rk), intent(out) :: error(:) !< (duals) -1: not known [m]
    real(rk), allocatable :: u(:, :, :)
    logical :: is_known(size(duals))
    integer :: k
    call stresses%need_smoothing(model)
    allocate (u(3, size(now%u, 2), 1 + size(duals)))
    u(:, :, 1) = now%u
    do k = 1, size(duals)
      u(:, :, k + 1) = duals(k)%u
    end do
    call weigh_defects(model, stresses%plan, stresses%smoothing, u, duals%goal == of_displacement, &
                       error, is_known)
    error = merge(abs(error), -1.0_rk, is_known)
    if (has_reduced(stresses%plan)) where (duals%goal == of_opening) error = -1.0_rk
  end subroutine weigh_duals

  !> How much stiffer the mesh makes each mode (theory.md, 14.5): its squared circular frequency is
  !> a largest displacement under its own forces.
  subroutine find_stiffening(model, stresses, shape, stiffening)
    type(problem), intent(in) :: model
    type(recovered_fields), intent(inout) :: stresses
    real(rk), intent(in) :: shape(:, :, :) !< (3, nodes, modes) unit modal mass
    !> (modes) [1/s2]; not allocated where that of a mode is not known
    real(rk), allocatable, intent(out) :: stiffening(:)
    logical :: is_known(size(shape, 3))
    call stresses%need_smoothing(model)
    allocate (stiffening(size(shape, 3)))
    call weigh_own_defects(model, stresses%plan, stresses%smoothing, shape, stiffening, is_known)
    if (.not. all(is_known)) deallocate (stiffening)
  end subroutine find_stiffening

  !> Whether solids have one point: estimates of openings are up to 60 times the error
  !> (verification.md).
  logical function has_reduced(plan)
    type(recovery_plan), intent(in) :: plan
    integer :: i
    has_reduced = .false.
    do i = 1, size(plan%formulations)
      has_reduced = has_reduced .or. plan%formulations(i)%item%num_points == 1
    end do
  end function has_reduced
end module goal_errors
