!> Metal plasticity: the return on a curve of three segments, its energies, and its tangent against
!> differences.
program test_material_metal
  use kinds, only: rk
  use material_law, only: start_points
  use material_metal, only: make_metal_law, metal_law
  use material_points, only: consistent_tangent, fracture_energy, no_tangent, point_set, &
                             point_state, secant_tangent, stored_energy, time_increment, &
                             update_report
  use tensor6, only: von_mises
  use testing, only: check, check_close, test_log
  use yield_curve, only: hardening_curve
  implicit none
  real(rk), parameter :: young = 200.0e9_rk, poisson = 0.3_rk
  real(rk), parameter :: shear = young/(2.0_rk*(1.0_rk + poisson))
  real(rk), parameter :: strains(4) = [0.0_rk, 0.001_rk, 0.004_rk, 0.01_rk]
  real(rk), parameter :: stresses(4) = [200.0e6_rk, 300.0e6_rk, 290.0e6_rk, 350.0e6_rk]
  type(test_log) :: log

  log%suite = 'material_metal'
  call areas(log)
  call shear_over_all_segments(log)
  call tangents(log)
  call falling_segment(log)
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  type(metal_law) function steel()
    type(hardening_curve) :: curve
    curve%strain = strains
    curve%stress = stresses
    steel = make_metal_law(young, poisson, curve)
  end function steel

  !> Areas below the curve are sums of trapezoids; past the last row the curve is constant.
  subroutine areas(log)
    type(test_log), intent(inout) :: log
    type(metal_law) :: law
    real(rk), parameter :: to = 0.012_rk
    real(rk) :: whole
    integer :: k
    law = steel()
    whole = (to - strains(4))*stresses(4)
    do k = 1, 3
      whole = whole + 0.5_rk*(stresses(k) + stresses(k + 1))*(strains(k + 1) - strains(k))
    end do
    call check_close(log, law%curve%work_between(0.0_rk, to), whole, 1.0e-14_rk*whole, 'area')
    call check_close(log, law%curve%work_between(0.0_rk, 0.0021_rk) + &
                     law%curve%work_between(0.0021_rk, to), whole, 1.0e-14_rk*whole, 'two areas')
    call check_close(log, law%curve%value_at(0.0025_rk), 295.0e6_rk, 1.0e-6_rk, 'between rows')
    call check_close(log, law%curve%value_at(1.0_rk), 350.0e6_rk, 1.0e-6_rk, 'past the rows')
  end subroutine areas

  !> One increment of pure shear over several segments: sqrt(3) tau is the yield stress at p, and
  !> gamma = tau/G + sqrt(3) p, whichever segment p lies in.
  subroutine shear_over_all_segments(log)
    type(test_log), intent(inout) :: log
    real(rk), parameter :: flows(5) = [0.0005_rk, 0.001_rk, 0.002_rk, 0.007_rk, 0.05_rk]
    type(metal_law) :: law
    type(point_set) :: points
    type(point_state) :: old, new
    type(update_report) :: report
    real(rk) :: tau, tangent(6, 6, 0)
    integer :: i
    law = steel()
    points%num_points = 1
    call start_points(law, points, old)
    do i = 1, size(flows)
      new = old
      tau = law%curve%value_at(flows(i))/sqrt(3.0_rk)
      new%strain(4, 1) = tau/shear + sqrt(3.0_rk)*flows(i)
      call law%update(points, time_increment(tangent=no_tangent), old, new, tangent, report)
      call check_close(log, new%stress(4, 1), tau, 1.0e-12_rk*tau, 'shear stress')
      call check_close(log, new%internal(7, 1), flows(i), 1.0e-12_rk*flows(i), 'plastic strain')
      call check_close(log, new%energy(fracture_energy, 1), &
                       law%curve%work_between(0.0_rk, flows(i)), 1.0_rk, 'plastic work')
      call check_close(log, new%energy(stored_energy, 1), 0.5_rk*tau**2/shear, 1.0e-6_rk, 'stored')
    end do
  end subroutine shear_over_all_segments

  !> The tangent is the derivative of the stress, on the rising segments and past the table. The
  !> central differences of a step of 1e-9 are off by its square over the strains and by round-off
  !> of 1e-16 over 1e-9.
  subroutine tangents(log)
    type(test_log), intent(inout) :: log
    real(rk), parameter :: sizes(4) = [0.0008_rk, 0.0030_rk, 0.0150_rk, 0.0400_rk]
    real(rk), parameter :: ways(6, 2) = reshape([1.0_rk, -0.4_rk, 0.2_rk, 0.3_rk, -0.5_rk, &
                                                 0.7_rk, -0.2_rk, -0.6_rk, 0.5_rk, 0.1_rk, &
                                                 0.9_rk, -0.3_rk], [6, 2])
    type(metal_law) :: law
    real(rk) :: found(6, 6), expected(6, 6), d(6, 6)
    integer :: i, way
    law = steel()
    call law%elastic_stiffness(d)
    do way = 1, 2
      do i = 1, size(sizes)
        call tangent_at(law, sizes(i)*ways(:, way), consistent_tangent, found, expected)
        call check(log, maxval(abs(found - expected)) < 1.0e-5_rk*d(1, 1), 'tangent')
        call check(log, maxval(abs(found - d)) > 0.01_rk*d(1, 1) .or. i == 1, 'it is not elastic')
      end do
    end do
  end subroutine tangents

  !> Tangent after an increment of strain, and the central differences of the stress.
  subroutine tangent_at(law, strain, kind, found, differences)
    type(metal_law), intent(in) :: law
    real(rk), intent(in) :: strain(6)
    integer, intent(in) :: kind
    real(rk), intent(out) :: found(6, 6), differences(6, 6)
    real(rk), parameter :: step = 1.0e-9_rk
    type(point_set) :: points
    type(point_state) :: old, new, left, right
    type(update_report) :: report
    real(rk) :: tangent(6, 6, 1), unused(6, 6, 0)
    integer :: j
    points%num_points = 1
    call start_points(law, points, old)
    new = old
    new%strain(:, 1) = strain
    call law%update(points, time_increment(tangent=kind), old, new, tangent, report)
    found = tangent(:, :, 1)
    do j = 1, 6
      left = new
      right = new
      left%strain(j, 1) = strain(j) - step
      right%strain(j, 1) = strain(j) + step
      call law%update(points, time_increment(tangent=no_tangent), old, left, unused, report)
      call law%update(points, time_increment(tangent=no_tangent), old, right, unused, report)
      differences(:, j) = (right%stress(:, 1) - left%stress(:, 1))/(2.0_rk*step)
    end do
  end subroutine tangent_at

  !> On a falling segment the secant tangent is that of a constant yield stress: not negative along
  !> the flow; the consistent one is.
  subroutine falling_segment(log)
    type(test_log), intent(inout) :: log
    type(metal_law) :: law
    real(rk) :: strain(6), secant(6, 6), consistent(6, 6), unused(6, 6)
    law = steel()
    strain = 0.0_rk
    strain(4) = sqrt(3.0_rk)*0.002_rk + von_mises([0.0_rk, 0.0_rk, 0.0_rk, 297.0e6_rk, 0.0_rk, &
                                                   0.0_rk])/3.0_rk/shear
    call tangent_at(law, strain, secant_tangent, secant, unused)
    call tangent_at(law, strain, consistent_tangent, consistent, unused)
    call check_close(log, secant(4, 4), 0.0_rk, 1.0e-6_rk*shear, 'secant')
    call check(log, consistent(4, 4) < -1.0e-3_rk*shear, 'consistent')
  end subroutine falling_segment
end program test_material_metal
