!> Points that have parted in the iteration of an increment (theory.md, 2.3).
module joint_parting
  use joint_iteration, only: joint_increment
  use joint_law, only: is_bare, openings_to_part, state_slip, state_stick
  use kinds, only: rk
  implicit none
  private
  public :: count_parted

contains

  !> How many parted points carry less than their law allows: those that were bonded when the
  !> increment began and, in statics, closed ones without their cohesion. In motion they have it
  !> again in the next increment.
  integer function count_parted(now) result(num_parted)
    type(joint_increment), intent(in) :: now
    real(rk) :: friction, cohesion, strength
    integer :: j, p
    num_parted = 0
    do j = 1, size(now%joints)
      associate (old => now%old(j), new => now%new(j))
        if (now%operator%first_point(j + 1) == now%operator%first_point(j)) cycle
        if (all(new%num_openings < openings_to_part)) cycle
        call now%joints(j)%law%limits(friction, cohesion, strength)
        do p = 1, size(new%num_openings)
          if (new%num_openings(p) < openings_to_part) cycle
          if (.not. old%is_broken(p)) then
            num_parted = num_parted + 1
          else if (now%field%is_static .and. cohesion > 0.0_rk .and. .not. is_bare(old, p) .and. &
                   any(new%status(p) == [state_stick, state_slip])) then
            num_parted = num_parted + 1
          end if
        end do
      end associate
    end do
  end function count_parted
end module joint_parting
