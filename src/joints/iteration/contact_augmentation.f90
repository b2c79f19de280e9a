!> Contact without penetration: the augmented Lagrangian of the normal law
!> (different_meshes.md, 13.5).
!>
!> A point in contact carries t = min(0, lambda + k_n (v + g)). The history of the joint keeps the
!> multiplier lambda = k_n*shift. After each equilibrium lambda <- t, and the equilibrium is solved
!> again until |v + g| is admissible at all points in contact. Anderson's acceleration combines the
!> multipliers of the last passes with the same points in contact.
module contact_augmentation
  use kinds, only: rk
  use joint_law, only: joint_state, state_slip, state_stick
  use joint_opening, only: opening_of
  use joint_points, only: dam_joint
  use joint_operator, only: jump_operator
  use anderson_mixing, only: mixer
  implicit none
  private
  public :: contact_multiplier, start_multiplier, measure_contact, update_multiplier

  !> Multipliers of an increment, all points of all joints in one row.
  type :: contact_multiplier
    logical :: is_there = .false. !< a law limits the penetration
    real(rk), allocatable :: change(:) !< (points) of the shift, from the last equilibrium [m]
    real(rk), allocatable :: shift(:) !< (points) [m]
    logical, allocatable :: is_closed(:) !< (points) in the last equilibrium
    type(mixer) :: mixer
  end type contact_multiplier

contains

  !> Starts an increment with lambda = t of the last converged state.
  subroutine start_multiplier(joints, old, new, multiplier)
    type(dam_joint), intent(in) :: joints(:)
    type(joint_state), intent(in) :: old(:) !< converged histories
    type(joint_state), intent(inout) :: new(:)
    type(contact_multiplier), intent(out) :: multiplier
    integer :: j
    do j = 1, size(joints)
      new(j)%shift = old(j)%shift
      if (.not. joints(j)%law%penetration > 0.0_rk) cycle
      multiplier%is_there = .true.
      new(j)%shift = traction_shift(old(j))
    end do
  end subroutine start_multiplier

  !> Shift for lambda = t of a state; 0 at open points.
  pure function traction_shift(now) result(shift)
    type(joint_state), intent(in) :: now
    real(rk) :: shift(size(now%gap)) !< [m]
    shift = 0.0_rk
    where (now%status == state_stick .or. now%status == state_slip)
      shift = min(0.0_rk, opening_of(now%jump(1, :), now%gap) + now%shift)
    end where
  end function traction_shift

  !> Largest ratio of |v + g| to its admissible value at points in contact, and its place.
  subroutine measure_contact(joints, operator, states, multiplier, excess, worst_point)
    type(dam_joint), intent(in) :: joints(:)
    type(jump_operator), intent(in) :: operator
    type(joint_state), intent(in) :: states(:) !< in equilibrium
    type(contact_multiplier), intent(inout) :: multiplier
    real(rk), intent(out) :: excess !< at most 1 where all points are admissible
    integer, intent(out) :: worst_point
    logical :: is_closed(operator%num_points)
    real(rk) :: ratio
    integer :: j, p, point
    excess = 0.0_rk
    worst_point = 0
    multiplier%change = spread(0.0_rk, 1, operator%num_points)
    multiplier%shift = multiplier%change
    is_closed = .false.
    do j = 1, size(joints)
      if (.not. joints(j)%law%penetration > 0.0_rk) cycle
      associate (first => operator%first_point(j), last => operator%first_point(j + 1) - 1)
        multiplier%shift(first:last) = states(j)%shift
        multiplier%change(first:last) = traction_shift(states(j)) - states(j)%shift
      end associate
      do p = 1, joints(j)%num_points
        if (states(j)%status(p) /= state_stick .and. states(j)%status(p) /= state_slip) cycle
        point = operator%first_point(j) + p - 1
        is_closed(point) = .true.
        ratio = abs(multiplier%change(point))/joints(j)%law%penetration
        if (ratio <= excess) cycle
        excess = ratio
        worst_point = point
      end do
    end do
    if (allocated(multiplier%is_closed)) then
      if (any(multiplier%is_closed .neqv. is_closed)) call multiplier%mixer%forget()
    end if
    multiplier%is_closed = is_closed
  end subroutine measure_contact

  !> Multipliers of the next pass: lambda <- t + r (v + g); zero at open points. r is the stiffness
  !> of the structure when all points move together, the smallest of all motions.
  subroutine update_multiplier(joints, operator, stiffness_ratio, multiplier, states)
    type(dam_joint), intent(in) :: joints(:)
    type(jump_operator), intent(in) :: operator
    real(rk), intent(in) :: stiffness_ratio(:) !< (points) r over k_n
    type(contact_multiplier), intent(inout) :: multiplier
    type(joint_state), intent(inout) :: states(:)
    integer :: j
    call multiplier%mixer%advance((1.0_rk + stiffness_ratio)*multiplier%change, multiplier%shift)
    do j = 1, size(joints)
      if (.not. joints(j)%law%penetration > 0.0_rk) cycle
      associate (first => operator%first_point(j), last => operator%first_point(j + 1) - 1)
        where (states(j)%status == state_stick .or. states(j)%status == state_slip)
          states(j)%shift = min(0.0_rk, multiplier%shift(first:last))
        else where
          states(j)%shift = 0.0_rk
        end where
      end associate
    end do
  end subroutine update_multiplier
end module contact_augmentation
