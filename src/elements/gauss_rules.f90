!> Gauss rules: two points per direction for elements and faces, up to five on a line.
module gauss_rules
  use kinds, only: rk
  implicit none
  private
  public :: hex_point, quad_point, line2_point, line2_weight, line5_point, line5_weight

  real(rk), parameter :: g = 1.0_rk/sqrt(3.0_rk)

  !> Natural coordinates of the 2 x 2 x 2 points, each of weight 1; the first coordinate runs
  !> fastest, as in Abaqus and CalculiX.
  real(rk), parameter :: hex_point(3, 8) = reshape([-g, -g, -g, g, -g, -g, -g, g, -g, g, g, -g, &
                                                    -g, -g, g, g, -g, g, -g, g, g, g, g, g], [3, 8])

  !> Natural coordinates of the 2 x 2 points of a face, each of weight 1.
  real(rk), parameter :: quad_point(2, 4) = reshape([-g, -g, g, -g, -g, g, g, g], [2, 4])

  !> Two points on the line 0..1, exact to degree 3.
  real(rk), parameter :: line2_point(2) = [0.5_rk*(1.0_rk - g), 0.5_rk*(1.0_rk + g)]
  real(rk), parameter :: line2_weight(2) = [0.5_rk, 0.5_rk]

  real(rk), parameter :: t = sqrt(10.0_rk/7.0_rk)
  real(rk), parameter :: inner = sqrt(5.0_rk - 2.0_rk*t)/3.0_rk
  real(rk), parameter :: outer = sqrt(5.0_rk + 2.0_rk*t)/3.0_rk
  real(rk), parameter :: inner_weight = (322.0_rk + 13.0_rk*sqrt(70.0_rk))/1800.0_rk
  real(rk), parameter :: outer_weight = (322.0_rk - 13.0_rk*sqrt(70.0_rk))/1800.0_rk

  !> Five points on the line 0..1, exact to degree 9.
  real(rk), parameter :: line5_point(5) = 0.5_rk + 0.5_rk*[-outer, -inner, 0.0_rk, inner, outer]
  real(rk), parameter :: line5_weight(5) = [outer_weight, inner_weight, 64.0_rk/225.0_rk, &
                                            inner_weight, outer_weight]
end module gauss_rules
