!> Local axes of a point of a joint, and which normals belong to one plane.
module joint_axes
  use kinds, only: rk
  use small_matrix, only: cross_product
  implicit none
  private
  public :: local_axes, share_a_plane

  !> Facets that share a node make one point of it unless their normals differ by more than 30
  !> degrees.
  real(rk), parameter :: same_plane = 0.5_rk*sqrt(3.0_rk)

  !> A normal this close to the vertical takes slip 1 along x.
  real(rk), parameter :: vertical = 1.0e-6_rk

contains

  !> Rows: normal, slip 1 (horizontal; x when the normal is vertical), slip 2 = normal x slip 1.
  pure function local_axes(direction) result(rotation)
    real(rk), intent(in) :: direction(3) !< along the normal, of any length
    real(rk) :: rotation(3, 3)
    real(rk) :: n(3), s(3)
    n = direction/norm2(direction)
    s = [-n(2), n(1), 0.0_rk]
    if (norm2(s) <= vertical) s = [1.0_rk, 0.0_rk, 0.0_rk] - n(1)*n
    s = s/norm2(s)
    rotation(1, :) = n
    rotation(2, :) = s
    rotation(3, :) = cross_product(n, s)
  end function local_axes

  !> Whether two normals, of any length, are at most 30 degrees apart.
  pure logical function share_a_plane(one, other)
    real(rk), intent(in) :: one(3), other(3)
    share_a_plane = dot_product(one, other) >= same_plane*norm2(one)*norm2(other)
  end function share_a_plane
end module joint_axes
