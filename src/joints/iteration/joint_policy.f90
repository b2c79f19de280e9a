!> The policy of the iteration on joints, one for all solvers (theory.md, 8).
!>
!> 1. Newton's iteration from the guess.
!> 2. Where that does not converge: sweeps of Gauss-Seidel over the points, and Newton's iteration
!>    from what they find; each time with twice as many sweeps as before.
!> 3. Where that does not converge: the fixed point of Tresca. A pass keeps the limits of friction;
!>    its equilibrium is that of a convex problem, and gives the limits of the next pass. Newton's
!>    iteration with the laws follows when the limits hardly change.
!> 4. Where that does not converge: more sweeps, with the limits of the last pass and then with the
!>    laws. An equilibrium with given limits counts if it is one of the laws, too.
!> 5. From an equilibrium with parted points: Newton's iteration with their full law. What this
!>    finds counts if fewer points have parted.
!>
!> In a static increment it ends as soon as Newton's iteration drives a block away without end, from
!> the guess and from what the sweeps find.
module joint_policy
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use kinds, only: rk
  use block_compliance, only: compliance_blocks
  use contact_scaling, only: contact_scale, open_group
  use anderson_mixing, only: mixer
  use errors, only: error_type
  use global_vectors, only: norm
  use contact_sweeps, only: gather_points, sweep_contacts, swept_points
  use equilibrium, only: balance_outcome, is_dropped
  use joint_forces, only: joint_field
  use joint_iteration, only: joint_increment, linearise, measure_residual
  use joint_law, only: joint_state
  use joint_operator, only: jump_operator
  use joint_parting, only: count_parted
  use tresca_friction, only: update_bound
  implicit none
  private
  public :: joint_process, iterate_joints, run_sweeps, run_passes, jumps_of, share_of

  !> What the policy needs of a solver.
  type, abstract :: joint_process
    real(rk) :: weight = 1.0_rk !< of the joint forces in the balance
    real(rk), allocatable :: k_ref(:, :) !< (3, points) k_ref [Pa/m]
    type(contact_scale) :: scale !< r of the augmented contact
    type(compliance_blocks) :: blocks !< G with closed joints
    type(open_group), allocatable :: opened(:) !< (groups) C with open joints
    real(rk), allocatable :: closed_jump(:, :) !< (3, points) with closed, sticking joints [m]
    real(rk), allocatable :: force(:, :) !< (3, points) of the last iterate, then of sweeps [N]
    real(rk), allocatable :: x(:) !< (all unknowns) of the last iterate, in solvers that have it
    integer, allocatable :: num_sweeps(:) !< before each of Newton's iterations
    type(error_type), allocatable :: failure !< of the linear solver
  contains
    procedure(run_newton), deferred :: run_newton
    procedure(find_response), deferred :: find_response
    procedure(find_closed), deferred :: find_closed
  end type joint_process

  abstract interface
    !> Newton's iteration from the linearised field, until it converges or shall end.
    subroutine run_newton(self, now)
      import :: joint_process, joint_increment
      implicit none
      class(joint_process), intent(inout) :: self
      type(joint_increment), intent(inout) :: now
    end subroutine run_newton

    !> The response to the linearised joints of a field with new jumps.
    subroutine find_response(self, now)
      import :: joint_process, joint_increment
      implicit none
      class(joint_process), intent(in) :: self
      type(joint_increment), intent(inout) :: now
    end subroutine find_response

    !> `closed_jump`, where it is not known yet.
    subroutine find_closed(self, operator)
      import :: joint_process, jump_operator
      implicit none
      class(joint_process), intent(inout) :: self
      type(jump_operator), intent(in) :: operator
    end subroutine find_closed
  end interface

  !> Sweeps before each of Newton's iterations; on the saved problems
  !> (docs/studies/joint_problems.md) 40 sweeps at first need the least work. The last follow where
  !> the passes do not converge.
  integer, parameter :: first_sweeps(3) = [40, 80, 160], last_sweeps(3) = [320, 640, 1280]

  !> Most passes of Tresca's fixed point, and the changes of the limits of friction, over the
  !> limits, at which Newton's iteration with the laws is tried.
  integer, parameter :: most_passes = 30
  real(rk), parameter :: small_changes(3) = [1.0e-1_rk, 1.0e-3_rk, 1.0e-6_rk]

contains

  !> Iterates until the joints are in equilibrium, or every way has failed. On return `jump` and
  !> `iterate` of the field hold the jumps and tractions of the solution, `new` the histories there.
  subroutine iterate_joints(process, now)
    class(joint_process), intent(inout) :: process
    type(joint_increment), intent(inout) :: now !< linearised
    call find_equilibrium(process, now)
    if (.not. now%outcome%has_converged) return
    call try_full_laws(process, now)
  end subroutine iterate_joints

  !> Newton's iteration, sweeps and passes in turn.
  subroutine find_equilibrium(process, now)
    class(joint_process), intent(inout) :: process
    type(joint_increment), intent(inout) :: now !< linearised
    call process%run_newton(now)
    if (is_done(process, now)) return
    call process%find_closed(now%operator)
    now%field%scale = process%scale
    process%num_sweeps = first_sweeps
    call try_sweeps(process, now)
    if (is_done(process, now) .or. now%outcome%is_loose) return
    if (.not. ieee_is_finite(now%outcome%unbalance)) return ! the sweeps diverge
    call run_passes(process, now)
    if (is_done(process, now)) return
    process%num_sweeps = last_sweeps
    call try_sweeps(process, now)
    if (.not. allocated(now%field%tresca%bound)) return
    call judge_by_laws(now)
    if (is_done(process, now)) return
    call linearise_anew(process, now)
    call try_sweeps(process, now)
  end subroutine find_equilibrium

  !> Newton's iteration as if no point had parted, from an equilibrium with parted points and, where
  !> that does not converge in statics, from sweeps: iterates on the way to the equilibrium may have
  !> opened points that stay closed. An equilibrium in which fewer points have parted counts, else
  !> the one before.
  subroutine try_full_laws(process, now)
    class(joint_process), intent(inout) :: process
    type(joint_increment), intent(inout) :: now !< in equilibrium
    type(joint_field) :: kept_field
    type(joint_state), allocatable :: kept_state(:)
    type(balance_outcome) :: kept_outcome
    real(rk), allocatable :: kept_x(:)
    integer :: num_parted
    num_parted = count_parted(now)
    if (num_parted == 0) return
    kept_field = now%field
    kept_state = now%new
    kept_outcome = now%outcome
    if (allocated(process%x)) kept_x = process%x
    now%field%num_openings = 0
    call process%find_closed(now%operator) ! Newton's iteration has not needed them
    call linearise_anew(process, now)
    call process%run_newton(now)
    if (.not. is_done(process, now)) then
      if (now%field%is_static .and. allocated(process%opened)) then
        call process%find_closed(now%operator)
        now%field%scale = process%scale
        now%field%num_openings = 0
        call run_sweeps(process, first_sweeps(1), now)
        call process%run_newton(now)
      end if
    end if
    if (now%outcome%has_converged .and. .not. allocated(process%failure)) then
      if (count_parted(now) < num_parted) return
    end if
    if (allocated(process%failure)) deallocate (process%failure)
    kept_outcome%iterations = now%outcome%iterations
    kept_outcome%sweeps = now%outcome%sweeps
    now%field = kept_field
    now%new = kept_state
    now%outcome = kept_outcome
    if (allocated(process%x)) process%x = kept_x
  end subroutine try_full_laws

  !> Gives up the limits of friction of the last pass. Their equilibrium counts if the laws have the
  !> same tractions there, within the tolerance of the residual.
  subroutine judge_by_laws(now)
    type(joint_increment), intent(inout) :: now
    real(rk) :: linear(3, now%operator%num_points) ! tractions of the equilibrium [Pa]
    linear = now%field%iterate
    deallocate (now%field%tresca%bound)
    if (.not. now%outcome%has_converged) return
    call linearise(now)
    call measure_residual(linear, now)
    now%outcome%has_converged = now%outcome%residual <= now%controls%residual_tolerance
    if (now%outcome%has_converged) now%field%iterate = linear
  end subroutine judge_by_laws

  !> Sweeps and Newton's iteration in turn, until it converges or drives a block away twice.
  subroutine try_sweeps(process, now)
    class(joint_process), intent(inout) :: process
    type(joint_increment), intent(inout) :: now
    logical :: was_loose
    integer :: k
    if (.not. allocated(process%opened)) return
    do k = 1, size(process%num_sweeps)
      was_loose = now%outcome%is_loose
      call run_sweeps(process, process%num_sweeps(k), now)
      call process%run_newton(now)
      if (is_done(process, now) .or. (was_loose .and. now%outcome%is_loose)) return
      now%outcome%is_loose = now%outcome%is_loose .and. k < size(process%num_sweeps)
    end do
  end subroutine try_sweeps

  !> Whether nothing is left to do.
  logical function is_done(process, now)
    class(joint_process), intent(in) :: process
    type(joint_increment), intent(in) :: now
    is_done = now%outcome%has_converged .or. now%outcome%gives_up .or. allocated(process%failure)
    if (.not. is_done) is_done = is_dropped(now%controls)
  end function is_done

  !> Jumps that tractions cause with closed joints.
  function jumps_of(process, area, traction) result(jump)
    class(joint_process), intent(in) :: process
    real(rk), intent(in) :: area(:) !< (points) [m2]
    real(rk), intent(in) :: traction(:, :) !< (3, points) [Pa]
    real(rk) :: jump(3, size(area)) !< [m]
    real(rk) :: force(size(traction)), answer(size(traction))
    force = reshape(process%weight*spread(area, 1, 3)*traction, [size(traction)])
    call process%blocks%product(force, answer)
    jump = reshape(answer, shape(jump))
  end function jumps_of

  !> weight*area of all points, as a table.
  pure function share_of(weight, operator) result(share)
    real(rk), intent(in) :: weight
    type(jump_operator), intent(in) :: operator
    real(rk) :: share(3, operator%num_points) !< [m2]
    share = spread(weight*operator%area, 1, 3)
  end function share_of

  !> Sweeps over the points from the last forces, and linearises the laws at what they find.
  subroutine run_sweeps(process, num_sweeps, now)
    class(joint_process), intent(inout) :: process
    integer, intent(in) :: num_sweeps
    type(joint_increment), intent(inout) :: now
    type(swept_points) :: points
    call gather_points(now, process%weight, points)
    call sweep_contacts(process%blocks, process%opened, points, process%closed_jump, num_sweeps, &
                        process%force, now%field)
    call linearise_anew(process, now)
    now%outcome%sweeps = now%outcome%sweeps + num_sweeps
  end subroutine run_sweeps

  !> Passes with given limits of friction; Newton's iteration with the laws when the limits change
  !> little.
  subroutine run_passes(process, now)
    class(joint_process), intent(inout) :: process
    type(joint_increment), intent(inout) :: now
    type(joint_field) :: last
    type(mixer) :: mixing
    real(rk) :: bound(now%operator%num_points), change
    integer :: pass, next
    call start_passes(process, now)
    next = 1
    do pass = 1, most_passes
      bound = now%field%tresca%bound
      call linearise_anew(process, now)
      call process%run_newton(now)
      now%outcome%passes = now%outcome%passes + 1
      if (allocated(process%failure)) return
      call update_bound(now%field)
      change = norm(now%field%tresca%bound - bound)/max(norm(bound), tiny(1.0_rk))
      now%field%tresca%bound = now%field%tresca%bound - bound
      call mixing%advance(now%field%tresca%bound, bound)
      now%field%tresca%bound = max(bound, 0.0_rk)
      if (.not. now%outcome%has_converged .or. change > small_changes(next)) cycle
      last = now%field
      deallocate (now%field%tresca%bound)
      call linearise_anew(process, now)
      call process%run_newton(now)
      next = next + 1
      if (is_done(process, now) .or. next > size(small_changes)) return
      now%field = last
    end do
    now%outcome%has_converged = .false.
  end subroutine run_passes

  !> Limits of friction of the first pass: those of the last sweeps, else of the last increment.
  subroutine start_passes(process, now)
    class(joint_process), intent(inout) :: process
    type(joint_increment), intent(inout) :: now
    type(swept_points) :: points
    if (allocated(process%opened)) then
      call run_sweeps(process, 1, now)
    else
      now%field%multiplier = now%k_ref*now%field%start_spring
      now%field%jump = now%field%start_jump
    end if
    call gather_points(now, process%weight, points)
    now%field%tresca%friction = points%friction
    now%field%tresca%cohesion = points%cohesion
    now%field%tresca%slip = points%slip
    now%field%tresca%is_bonded = points%is_bonded
    call update_bound(now%field)
  end subroutine start_passes

  !> Linearises at the jumps and tractions of a field that another iteration has found.
  subroutine linearise_anew(process, now)
    class(joint_process), intent(inout) :: process
    type(joint_increment), intent(inout) :: now
    now%field%is_open = .true. ! what others open does not count as an opening of the iteration
    call linearise(now)
    call process%find_response(now)
    now%outcome%has_converged = .false.
    now%outcome%pass_start = now%outcome%iterations
  end subroutine linearise_anew
end module joint_policy
