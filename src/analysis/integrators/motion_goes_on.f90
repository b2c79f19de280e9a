!> A dynamic step after another dynamic step: the motion goes on (theory.md, 7.1).
!>
!> At the end of an increment the acceleration does not balance the forces of that instant, but
!> weighted ones (7.1), and joints by the traction t* of their impulse (7.3). Both therefore pass to
!> the next step. Only what changes between the steps changes the acceleration: loads, damping and
!> mass.
module motion_goes_on
  use analysis_state, only: motion, state
  use global_vectors, only: largest_entry
  use kinds, only: rk
  use ranks, only: is_true_everywhere
  use step_plan, only: step
  use unknown_parts, only: unknown_part
  implicit none
  private
  public :: keep_joints, keep_accelerations, has_same_unknowns, unbalanced_force

  !> Difference of unknowns that are the same, over the largest.
  real(rk), parameter :: same_share = 1.0e-6_rk

contains

  !> Takes over the tractions t* and the rates of the jumps, where the joints are the same.
  subroutine keep_joints(last, plan, num_points, now)
    type(motion), intent(in) :: last !< at the end of the step before
    type(step), intent(in) :: plan
    integer, intent(in) :: num_points !< of the joints
    type(state), intent(inout) :: now !< at the start of the step
    if (plan%changes_stage .or. .not. allocated(last%carried)) return
    if (size(last%carried, 2) /= num_points) return
    now%motion%carried = last%carried
    now%motion%jump_rate = last%jump_rate
  end subroutine keep_joints

  !> Whether accelerations and forces of the step before are those of the same unknowns: of a step
  !> with all its unknowns, no reduced model.
  logical function has_same_unknowns(last, plan, part, own) result(is_same)
    type(motion), intent(in) :: last !< at the end of the step before
    type(step), intent(in) :: plan
    type(unknown_part), intent(in) :: part
    type(motion), intent(in) :: own !< at the start of the step
    is_same = .false.
    if (plan%changes_stage .or. .not. allocated(last%viscous_rate)) return
    if (.not. is_true_everywhere(size(last%q) == size(own%q))) return
    is_same = are_equal(part, last%q, own%q)
    if (is_same) is_same = are_equal(part, last%v, own%v)
    if (is_same) is_same = are_equal(part, last%a, own%a)
  end function has_same_unknowns

  !> Whether two vectors differ by round-off alone.
  logical function are_equal(part, x, y)
    type(unknown_part), intent(in) :: part
    real(rk), intent(in) :: x(:), y(:)
    are_equal = largest_entry(part, abs(x - y)) <= same_share*largest_entry(part, abs(x))
  end function are_equal

  !> Takes over what belongs to the accelerations.
  subroutine keep_accelerations(last, own)
    type(motion), intent(in) :: last !< at the end of the step before
    type(motion), intent(inout) :: own !< at the start of the step
    if (allocated(last%carried_correction)) own%carried_correction = last%carried_correction
    if (allocated(last%residual)) own%residual = last%residual
    if (allocated(last%last_a)) own%last_a = last%last_a
    own%acceleration_ratio = last%acceleration_ratio
    own%last_ratio = last%last_ratio
  end subroutine keep_accelerations

  !> Forces that the inertia balances [N], joints by their laws.
  pure function unbalanced_force(own) result(force)
    type(motion), intent(in) :: own
    real(rk) :: force(size(own%q))
    force = own%external - own%internal - own%viscous - own%contact
  end function unbalanced_force
end module motion_goes_on
