!> A law for tests: von Mises plasticity with linear hardening or softening, by radial return.
module metal_law
  use kinds, only: rk
  use material_law, only: stress_law
  use material_points, only: point_set, point_state, time_increment, update_report, &
                             no_tangent, stored_energy, fracture_energy
  use tensor6, only: trace, von_mises
  implicit none
  private
  public :: metal

  !> Internal variables: plastic strain (6, shear as gamma) and its equivalent.
  type, extends(stress_law) :: metal
    real(rk) :: shear = 80.0e9_rk, bulk = 160.0e9_rk !< [Pa]
    real(rk) :: yield = 200.0e6_rk !< first yield stress [Pa]
    real(rk) :: slope = 10.0e9_rk !< of the yield stress over the equivalent plastic strain [Pa]
    real(rk) :: largest_change = huge(1.0_rk) !< of a strain; above it a cut is requested
  contains
    procedure :: elastic_stiffness
    procedure :: update
    procedure :: young
  end type metal

contains

  !> E of K and G [Pa].
  pure real(rk) function young(self)
    class(metal), intent(in) :: self
    young = 9.0_rk*self%bulk*self%shear/(3.0_rk*self%bulk + self%shear)
  end function young

  pure subroutine elastic_stiffness(self, d)
    class(metal), intent(in) :: self
    real(rk), intent(out) :: d(6, 6)
    integer :: i
    d = 0.0_rk
    d(1:3, 1:3) = self%bulk - 2.0_rk*self%shear/3.0_rk
    do i = 1, 3
      d(i, i) = self%bulk + 4.0_rk*self%shear/3.0_rk
      d(i + 3, i + 3) = self%shear
    end do
  end subroutine elastic_stiffness

  subroutine update(self, points, time, old, new, tangent, report)
    class(metal), intent(in) :: self
    type(point_set), intent(in) :: points
    type(time_increment), intent(in) :: time
    type(point_state), intent(in) :: old
    type(point_state), intent(inout) :: new
    real(rk), intent(inout) :: tangent(:, :, :)
    type(update_report), intent(out) :: report
    real(rk) :: d(6, 6), deviator(6), normal(6), flow(6), q, excess, slip, change
    integer :: i
    call self%elastic_stiffness(d)
    new%internal = old%internal
    do i = 1, points%num_points
      change = maxval(abs(new%strain(:, i) - old%strain(:, i)))
      if (change > self%largest_change) report%size_ratio = self%largest_change/change
      new%stress(:, i) = matmul(d, new%strain(:, i) - old%internal(:6, i))
      if (time%tangent /= no_tangent) tangent(:, :, i) = d
      q = von_mises(new%stress(:, i))
      excess = q - max(self%yield + self%slope*old%internal(7, i), 0.0_rk)
      new%energy(:, i) = old%energy(:, i)
      if (excess > 0.0_rk) then
        slip = excess/(3.0_rk*self%shear + self%slope)
        deviator = new%stress(:, i)
        deviator(1:3) = deviator(1:3) - trace(deviator)/3.0_rk
        normal = 1.5_rk*deviator/q
        flow = normal
        flow(4:6) = 2.0_rk*normal(4:6)
        new%internal(:6, i) = old%internal(:6, i) + slip*flow
        new%internal(7, i) = old%internal(7, i) + slip
        new%stress(:, i) = matmul(d, new%strain(:, i) - new%internal(:6, i))
        if (time%tangent /= no_tangent) call add_plastic_part(tangent(:, :, i))
        new%energy(fracture_energy, i) = old%energy(fracture_energy, i) + &
                                         slip*0.5_rk*(von_mises(old%stress(:, i)) + &
                                                      von_mises(new%stress(:, i)))
      end if
      new%energy(stored_energy, i) = 0.5_rk*dot_product( &
                                     new%stress(:, i), new%strain(:, i) - new%internal(:6, i))
    end do

  contains

    !> Loss of stiffness by yielding.
    pure subroutine add_plastic_part(matrix)
      real(rk), intent(inout) :: matrix(6, 6)
      real(rk) :: project(6, 6), g
      integer :: a, b
      g = self%shear
      project = 0.0_rk
      project(1:3, 1:3) = -1.0_rk/3.0_rk
      do a = 1, 3
        project(a, a) = 2.0_rk/3.0_rk
        project(a + 3, a + 3) = 0.5_rk
      end do
      do b = 1, 6
        do a = 1, 6
          matrix(a, b) = matrix(a, b) - 6.0_rk*g**2*slip/q*project(a, b) &
                         + 4.0_rk*g**2*(slip/q - 1.0_rk/(3.0_rk*g + self%slope))* &
                         normal(a)*normal(b)
        end do
      end do
    end subroutine add_plastic_part
  end subroutine update
end module metal_law
