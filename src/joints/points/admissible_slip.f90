!> Small sliding: segments between faces of different meshes are built once, on the undeformed
!> faces. A slip of more than a facet invalidates them, so that the analysis stops.
module admissible_slip
  use kinds, only: rk
  use errors, only: error_type, raise
  use joint_law, only: joint_state
  use joint_points, only: dam_joint
  use write_text, only: as_text
  implicit none
  private
  public :: check_slip

contains

  !> Reports the point with the largest ratio of slip to admissible slip, if above 1.
  subroutine check_slip(joints, states, time, error)
    type(dam_joint), intent(in) :: joints(:)
    type(joint_state), intent(in) :: states(:)
    real(rk), intent(in) :: time !< total time [s]
    type(error_type), allocatable, intent(out) :: error
    real(rk) :: ratio, largest
    integer :: j, p, worst(2)
    largest = 1.0_rk
    worst = 0
    do j = 1, size(joints)
      if (.not. allocated(joints(j)%admissible_slip)) cycle
      do p = 1, joints(j)%num_points
        ratio = slip_at(states(j), p)/joints(j)%admissible_slip(p)
        if (ratio <= largest) cycle
        largest = ratio
        worst = [j, p]
      end do
    end do
    if (worst(1) == 0) return
    associate (joint => joints(worst(1)), p => worst(2))
      call raise(error, 'joint '//joint%name//' has slipped '// &
                 as_text(slip_at(states(worst(1)), p))//' at ('//as_text(joint%x(1, p))//', '// &
                 as_text(joint%x(2, p))//', '//as_text(joint%x(3, p))//') at time '// &
                 as_text(time)//'; joints between different meshes allow small sliding only, '// &
                 as_text(joint%admissible_slip(p))//' at this point (size of a facet)')
    end associate
  end subroutine check_slip

  !> Tangential relative displacement of the faces [m].
  pure real(rk) function slip_at(now, p) result(slip)
    type(joint_state), intent(in) :: now
    integer, intent(in) :: p
    slip = hypot(now%jump(2, p), now%jump(3, p))
  end function slip_at
end module admissible_slip
