!> Cheap elastic check of concrete points that have never yielded, which are most points of a dam.
!>
!> Principal stresses cost more than all other operations at an elastic point. An upper bound of the
!> largest one is enough: s_1 = -p + 2/3 q cos(theta), cos(3 theta) = x = 27/2 J_3/q^3, and
!> cos(acos(x)/3) <= min(1, 1/2 + sqrt((1 + x)/6)), exact in uniaxial tension and compression.
module damage_screen
  use damage_model, only: concrete_model
  use kinds, only: rk
  implicit none
  private
  public :: screen_points

contains

  !> Elastic stress and energy of virgin points, and whether they are certainly elastic.
  pure subroutine screen_points(model, factor, strain, stress, energy, is_within)
    type(concrete_model), intent(in) :: model
    !> (points) The least one of the strength in tension, that of the widest band (see place_knots)
    real(rk), intent(in) :: factor(:)
    real(rk), intent(in), contiguous :: strain(:, :) !< (6, points)
    real(rk), intent(inout), contiguous :: stress(:, :) !< (6, points) [Pa]
    real(rk), intent(out) :: energy(:) !< (points) stored [J/m3]
    logical, intent(out) :: is_within(:) !< (points) inside the virgin surface; false: unknown
    real(rk) :: lame, shear, volume, p, s1, s2, s3, square, third, q, largest, excess
    real(rk) :: slope, limit
    integer :: i
    lame = model%bulk - 2.0_rk/3.0_rk*model%shear
    shear = model%shear
    limit = (1.0_rk - model%alpha)*model%compression%strength(1)
    !$omp simd private(volume, p, s1, s2, s3, square, third, q, largest, excess, slope)
    do i = 1, size(strain, 2)
      volume = strain(1, i) + strain(2, i) + strain(3, i)
      stress(1, i) = lame*volume + 2.0_rk*shear*strain(1, i)
      stress(2, i) = lame*volume + 2.0_rk*shear*strain(2, i)
      stress(3, i) = lame*volume + 2.0_rk*shear*strain(3, i)
      stress(4, i) = shear*strain(4, i)
      stress(5, i) = shear*strain(5, i)
      stress(6, i) = shear*strain(6, i)
      p = -model%bulk*volume
      s1 = stress(1, i) + p
      s2 = stress(2, i) + p
      s3 = stress(3, i) + p
      square = 0.5_rk*(s1**2 + s2**2 + s3**2) &
               + stress(4, i)**2 + stress(5, i)**2 + stress(6, i)**2
      third = s1*(s2*s3 - stress(6, i)**2) - s2*stress(5, i)**2 - s3*stress(4, i)**2 &
              + 2.0_rk*stress(4, i)*stress(5, i)*stress(6, i)
      energy(i) = 0.5_rk*square/shear + 0.5_rk*model%bulk*volume**2
      q = sqrt(3.0_rk*square)
      excess = max(0.0_rk, 1.0_rk + 13.5_rk*third/(q**3 + tiny(q)))
      largest = 2.0_rk/3.0_rk*q*min(1.0_rk, 0.5_rk + sqrt(excess/6.0_rk)) - p
      ! beta of Eq. 23, not negative by the checks of the tables.
      slope = limit/(factor(i)*model%tension%strength(1)) - (1.0_rk + model%alpha)
      is_within(i) = q - 3.0_rk*model%alpha*p + slope*max(0.0_rk, largest) &
                     - model%gamma*max(0.0_rk, -largest) <= limit
    end do
  end subroutine screen_points
end module damage_screen
