!> Points that have parted in the iteration of an increment (theory.md, 2.3).
module joint_parting
  use joint_law, only: is_bare, joint_state, openings_to_part, state_slip, state_stick
  use joint_operator, only: jump_operator
  use joint_points, only: dam_joint
  use kinds, only: rk
  implicit none
  private
  public :: count_parted

contains

  !> How many parted points carry less than their law allows: those that were bonded when the
  !> increment began and, in statics, closed ones without their cohesion. In motion they have it
  !> again in the next increment.
  integer function count_parted(joints, operator, is_static, old, new) result(num_parted)
    type(dam_joint), intent(in) :: joints(:)
    type(jump_operator), intent(in) :: operator
    logical, intent(in) :: is_static
    type(joint_state), intent(in) :: old(:) !< converged histories
    type(joint_state), intent(in) :: new(:) !< of the last evaluation
    real(rk) :: friction, cohesion, strength
    integer :: j, p
    num_parted = 0
    do j = 1, size(joints)
      if (operator%first_point(j + 1) == operator%first_point(j)) cycle
      if (all(new(j)%num_openings < openings_to_part)) cycle
      call joints(j)%law%limits(friction, cohesion, strength)
      do p = 1, size(new(j)%num_openings)
        if (new(j)%num_openings(p) < openings_to_part) cycle
        if (.not. old(j)%is_broken(p)) then
          num_parted = num_parted + 1
        else if (is_static .and. cohesion > 0.0_rk .and. .not. is_bare(old(j), p) .and. &
                 any(new(j)%status(p) == [state_stick, state_slip])) then
          num_parted = num_parted + 1
        end if
      end do
    end do
  end function count_parted
end module joint_parting
