!> The gaps of a *CONTACT PAIR, and of a *JOINT with CLEARANCE=MEASURED, at the start.
module contact_clearance
  use joint_points, only: dam_joint
  use kinds, only: rk
  use model_draft, only: joint_request
  implicit none
  private
  public :: set_clearance

  !> Gaps and overlaps up to this fraction of a facet are rounding of a mesher, which writes six
  !> digits or more.
  real(rk), parameter :: mesh_rounding = 1.0e-6_rk

  !> Gaps up to this fraction of the largest coordinate are round-off.
  real(rk), parameter :: round_off = 1.0e-12_rk

contains

  !> Applies ADJUST to the distances of the faces in the mesh, and drops rounding of the mesh.
  pure subroutine set_clearance(request, x, joint)
    type(joint_request), intent(in) :: request
    real(rk), intent(in) :: x(:, :) !< (3, nodes) [m]
    type(dam_joint), intent(inout) :: joint !< with its points
    logical, allocatable :: is_adjusted(:)
    real(rk) :: least
    integer :: p
    if (joint%num_points == 0) return
    least = round_off*maxval(abs(x))
    where (abs(joint%clearance) <= max(least, mesh_rounding*joint%admissible_slip))
      joint%clearance = 0.0_rk
    end where
    if (.not. request%is_adjusted) return
    if (allocated(request%adjusted_nodes)) then
      allocate (is_adjusted(size(x, 2)), source=.false.)
      is_adjusted(request%adjusted_nodes) = .true.
      do p = 1, joint%num_points
        if (is_adjusted(joint%node(joint%first(p)))) joint%clearance(p) = 0.0_rk
      end do
    else
      where (joint%clearance <= request%adjust) joint%clearance = 0.0_rk
    end if
  end subroutine set_clearance
end module contact_clearance
