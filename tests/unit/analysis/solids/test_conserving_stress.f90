!> The stress that makes the work of an increment equal to its energies: along random paths of
!> concrete with RECOVERY=ENERGY, and its derivative against differences.
program test_conserving_stress
  use concrete_model, only: table_one
  use conserving_stress, only: correct_stress, point_work
  use damage_constants, only: concrete_constants
  use errors, only: error_type
  use kinds, only: rk
  use material_damage_plasticity, only: concrete_law, make_concrete_law
  use material_law, only: start_points
  use material_points, only: consistent_tangent, point_set, point_state, time_increment, &
                             update_report
  use testing, only: check, check_close, repeat_chance, test_log
  implicit none
  type(test_log) :: log
  type(concrete_law) :: law
  type(point_set) :: points
  real(rk) :: d(6, 6)
  real(rk) :: duration = 0.0_rk !< of an increment, for viscosity [s]
  log%suite = 'conserving_stress'
  call make_law(0.0_rk)
  call work_is_energy()
  call derivative()
  call elastic_increment()
  call small_increments()
  call make_law(1.0_rk)
  duration = 0.5_rk
  call lagging_points()
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> Table 1, one point in a cube of 1 m.
  subroutine make_law(viscosity)
    real(rk), intent(in) :: viscosity !< [s]
    type(concrete_constants) :: concrete
    type(error_type), allocatable :: error
    integer :: i
    call repeat_chance(1)
    concrete = table_one()
    concrete%recovery = 'ENERGY'
    concrete%viscosity = viscosity
    call make_concrete_law(concrete, law, error)
    call check(log,.not. allocated(error), 'law made')
    call law%elastic_stiffness(d)
    points%num_points = 1
    points%element = [1]
    points%number = [1]
    if (.not. allocated(points%x)) allocate (points%x(3, 1), points%edges(3, 3, 1), source=0.0_rk)
    do i = 1, 3
      points%edges(i, i, 1) = 1.0_rk
    end do
    points%widest = [1.0_rk]
    points%length = [1.0_rk]
  end subroutine make_law

  !> A random strain about 1e-4, with more tension than compression.
  function random_strain() result(strain)
    real(rk) :: strain(6)
    call random_number(strain)
    strain = 4.0e-4_rk*(strain - 0.4_rk)
  end function random_strain

  !> The state at a strain, from `old`.
  subroutine move(old, strain, new, tangent)
    type(point_state), intent(in) :: old
    real(rk), intent(in) :: strain(6)
    type(point_state), intent(out) :: new
    real(rk), intent(out) :: tangent(6, 6)
    type(time_increment) :: time
    type(update_report) :: report
    real(rk) :: tangents(6, 6, 1)
    time%tangent = consistent_tangent
    time%size = duration
    new = old
    new%strain(:, 1) = strain
    call law%update(points, time, old, new, tangents, report)
    if (report%failed_point > 0) call check(log, .false., 'the update ends')
    tangent = tangents(:, :, 1)
  end subroutine move

  !> Stored and dissipated energy.
  pure real(rk) function energy_of(state)
    type(point_state), intent(in) :: state
    energy_of = sum(state%energy(:3, 1))
  end function energy_of

  !> The work of an increment.
  pure function work_between(old, new) result(own)
    type(point_state), intent(in) :: old, new
    type(point_work) :: own
    own%moved = new%strain(:, 1) - old%strain(:, 1)
    own%stress(:, 1) = old%stress(:, 1)
    own%stress(:, 2) = new%stress(:, 1)
    own%change = energy_of(new) - energy_of(old)
    own%size = energy_of(new) + energy_of(old)
  end function work_between

  !> Work of mean and correction is the change of energy; it is not without the correction. The
  !> correction is bounded by the elastic stress of the increment: (W - s : de)/(de : D de) is.
  subroutine work_is_energy()
    type(point_state) :: old, new
    type(point_work) :: own
    real(rk) :: tangent(6, 6), stress(6), worst, plain, largest
    integer :: i
    worst = 0.0_rk
    plain = 0.0_rk
    largest = 0.0_rk
    call start_points(law, points, old)
    do i = 1, 10000
      call move(old, random_strain(), new, tangent)
      own = work_between(old, new)
      call correct_stress(d, own, stress)
      associate (mean => 0.5_rk*(own%stress(:, 1) + own%stress(:, 2)))
        plain = max(plain, abs(own%change - dot_product(mean, own%moved))/own%size)
        worst = max(worst, abs(own%change - dot_product(mean + stress, own%moved))/own%size)
      end associate
      largest = max(largest, norm2(stress)/norm2(matmul(d, own%moved)))
      old = new
    end do
    ! smallest_square of the module leaves 1e-10 of the energy.
    call check_close(log, worst, 0.0_rk, 1.0e-9_rk, 'work is energy')
    call check(log, plain > 1.0e-3_rk, 'it is not without the correction')
    call check(log, largest < 1.0_rk, 'a bounded correction')
  end subroutine work_is_energy

  !> The slope along random directions. Kinks between the two points of a difference are rare.
  subroutine derivative()
    type(point_state) :: old, new, above, below
    real(rk), dimension(6) :: strain, h, stress, high, low, gradient, step
    real(rk), dimension(6, 6) :: tangent, slope, unused
    integer :: i, k, num_good
    num_good = 0
    call start_points(law, points, old)
    do i = 1, 1000
      strain = random_strain()
      call move(old, strain, new, tangent)
      do k = 1, 6
        step = 0.0_rk
        step(k) = 1.0e-9_rk
        call move(old, strain + step, above, unused)
        call move(old, strain - step, below, unused)
        gradient(k) = (energy_of(above) - energy_of(below))/(2.0_rk*step(k))
      end do
      call correct_stress(d, work_between(old, new), stress, tangent, gradient, slope)
      h = 1.0e-9_rk*(random_strain()/4.0e-4_rk)
      call move(old, strain + h, above, unused)
      call move(old, strain - h, below, unused)
      call correct_stress(d, work_between(old, above), high)
      call correct_stress(d, work_between(old, below), low)
      if (norm2(matmul(slope, h) - 0.5_rk*(high - low)) < 1.0e-3_rk*norm2(matmul(d, h))) then
        num_good = num_good + 1
      end if
      old = new
    end do
    call check(log, num_good > 980, 'slope by differences')
  end subroutine derivative

  !> Without damage there is nothing to correct.
  subroutine elastic_increment()
    type(point_state) :: old, new
    real(rk) :: tangent(6, 6), stress(6)
    call start_points(law, points, old)
    call move(old, [1.0_rk, -2.0_rk, 3.0_rk, 4.0_rk, -5.0_rk, 6.0_rk]*1.0e-6_rk, new, tangent)
    call correct_stress(d, work_between(old, new), stress)
    call check_close(log, norm2(stress)/norm2(new%stress), 0.0_rk, 1.0e-9_rk, 'elastic')
    call correct_stress(d, work_between(old, old), stress)
    call check_close(log, norm2(stress), 0.0_rk, tiny(1.0_rk), 'no increment')
  end subroutine elastic_increment

  !> Increments down to round-off of a cracked point: the correction stays far below f_t.
  subroutine small_increments()
    type(point_state) :: old, new
    real(rk) :: tangent(6, 6), stress(6), strain(6), worst
    integer :: i
    call start_points(law, points, old)
    call move(old, 5.0e-4_rk*[1.0_rk, 0.0_rk, 0.0_rk, 0.3_rk, 0.0_rk, 0.0_rk], new, tangent)
    old = new
    worst = 0.0_rk
    do i = 6, 20
      strain = old%strain(:, 1) - 10.0_rk**(-i)*[1.0_rk, -0.3_rk, 0.2_rk, 0.5_rk, 0.7_rk, -0.1_rk]
      call move(old, strain, new, tangent)
      call correct_stress(d, work_between(old, new), stress)
      worst = max(worst, norm2(stress)/(25.0e9_rk*10.0_rk**(-i)))
    end do
    call check(log, worst < 1.0_rk, 'no round-off in small increments')
  end subroutine small_increments

  !> Viscous points whose plastic strain goes on to grow while the strain hardly moves, in tension
  !> and after a reversal: the correction stays within the elastic stress of both. Energy that is
  !> missing in the balance makes it grow like the inverse of the strain.
  subroutine lagging_points()
    type(point_state) :: old, new
    real(rk) :: tangent(6, 6), stress(6), flow(6), worst
    integer :: i, num_negative
    worst = 0.0_rk
    num_negative = 0
    call start_points(law, points, old)
    do i = 1, 3000
      call move(old, random_strain(), new, tangent)
      old = new
      call move(old, old%strain(:, 1) + 1.0e-4_rk*random_strain(), new, tangent)
      call correct_stress(d, work_between(old, new), stress)
      flow = new%internal(:6, 1) - old%internal(:6, 1)
      if (sum(new%energy(2:3, 1)) < sum(old%energy(2:3, 1))) num_negative = num_negative + 1
      worst = max(worst, norm2(stress)/norm2(matmul(d, abs(flow) + 1.0e-8_rk)))
    end do
    call check(log, worst < 1.0_rk, 'a bounded correction of points that lag')
    call check(log, num_negative > 100, 'negative plastic work of points that lag')
  end subroutine lagging_points
end program test_conserving_stress
