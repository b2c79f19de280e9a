!> RECOVERY=ENERGY: the split of a stress against the conditions that define its closest point, the
!> stress as the derivative of the free energy, and the work of closed loops of strain.
program test_damage_split
  use concrete_model, only: table_one
  use damage_constants, only: concrete_constants
  use damage_increment, only: elastic_stress
  use damage_model, only: concrete_model, make_concrete_model
  use damage_split, only: energy_split, left_after, nominal_stress, split_stress, &
                          stiffness_left, stiffness_of_split
  use kinds, only: rk
  use tensor6, only: principal_axes
  use testing, only: check, check_close, repeat_chance, test_log
  implicit none
  type(test_log) :: log
  type(concrete_constants) :: concrete
  type(concrete_model) :: model
  real(rk), parameter :: left(2) = [0.1_rk, 0.7_rk]
  log%suite = 'damage_split'
  call repeat_chance(1)
  concrete = table_one()
  concrete%recovery = 'ENERGY'
  concrete%poisson = 0.2_rk
  call make_concrete_model(concrete, model)
  call closest_point(0.2_rk)
  call closest_point(0.0_rk)
  call closest_point(0.45_rk)
  call closest_point(-0.2_rk)
  call make_concrete_model(concrete, model)
  call derivatives()
  call equal_strains()
  call loops()
  call losses()
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> The closest point of a cone: part and rest are orthogonal, the part is a stress without
  !> tension, and the rest is an elastic strain without contraction (the polar cone). A hundred
  !> thousand random strains meet all four cases.
  subroutine closest_point(poisson)
    real(rk), intent(in) :: poisson
    type(concrete_constants) :: own
    type(energy_split) :: split
    real(rk) :: s(3), e(3), rest(3), worst(3), size_of
    integer :: i, cases(0:3)
    own = concrete
    own%poisson = poisson
    call make_concrete_model(own, model)
    worst = 0.0_rk
    cases = 0
    do i = 1, 100000
      call random_number(e)
      e = e - 0.5_rk
      e = e([maxloc(e), 6 - maxloc(e) - minloc(e), minloc(e)])
      s = model%bulk*sum(e) + 2.0_rk*model%shear*(e - sum(e)/3.0_rk)
      call split_stress(model, s, split)
      rest = ((1.0_rk + poisson)*(s - split%pressed) - poisson*sum(s - split%pressed))/model%young
      size_of = model%young
      worst = max(worst, [abs(dot_product(split%pressed, rest)), maxval(split%pressed), &
                          -model%young*minval(rest)]/size_of)
      cases(count(split%pressed >= 0.0_rk)) = cases(count(split%pressed >= 0.0_rk)) + 1
    end do
    ! Strains of about 1; nu 0.45 has a bulk modulus of 3.3 E.
    call check_close(log, maxval(worst), 0.0_rk, 2.0e-15_rk, 'closest point')
    call check(log, all(cases > 0), 'all cases')
  end subroutine closest_point

  !> Stress and free energy psi = left . (psi_t, psi_c) at an elastic strain, and its stiffness.
  subroutine state_of(strain, stress, energy, stiffness)
    real(rk), intent(in) :: strain(6)
    real(rk), intent(out) :: stress(6), energy, stiffness(6, 6)
    type(energy_split) :: split
    real(rk) :: effective(6), s(3), axes(3, 3)
    effective = elastic_stress(model, strain)
    call principal_axes(effective, s, axes)
    call split_stress(model, s, split)
    stress = nominal_stress(effective, axes, split, left)
    energy = dot_product(left, split%energy)
    call stiffness_of_split(model, axes, split, left, stiffness)
  end subroutine state_of

  !> Central differences of the energy give the stress, those of the stress its stiffness, which is
  !> symmetric. Where cases meet within the step the stiffness jumps: such states are left out.
  subroutine derivatives()
    real(rk), parameter :: step = 1.0e-6_rk
    real(rk), dimension(6) :: strain, beside, stress, above, below, slope
    real(rk), dimension(6, 6) :: stiffness, other, central
    real(rk) :: energy, energies(2), worst(3)
    integer :: i, j, num_smooth
    worst = 0.0_rk
    num_smooth = 0
    do i = 1, 1000
      call random_number(strain)
      strain = strain - 0.5_rk
      call state_of(strain, stress, energy, stiffness)
      energy = 0.0_rk
      do j = 1, 6
        beside = strain
        beside(j) = strain(j) + step
        call state_of(beside, above, energies(1), other)
        energy = max(energy, maxval(abs(other - stiffness)))
        beside(j) = strain(j) - step
        call state_of(beside, below, energies(2), other)
        energy = max(energy, maxval(abs(other - stiffness)))
        slope(j) = (energies(1) - energies(2))/(2.0_rk*step)
        central(:, j) = (above - below)/(2.0_rk*step)
      end do
      if (energy > 0.01_rk*model%young) cycle
      num_smooth = num_smooth + 1
      worst = max(worst, [maxval(abs(slope - stress)), maxval(abs(central - stiffness)), &
                          maxval(abs(stiffness - transpose(stiffness)))]/model%young)
    end do
    ! Round-off of the energy, 1e-16 over the step of 1e-6, and the square of the step over the
    ! differences of principal strains.
    call check(log, num_smooth > 900, 'smooth states')
    call check_close(log, worst(1), 0.0_rk, 2.0e-9_rk, 'the stress is the slope of the energy')
    call check_close(log, worst(2), 0.0_rk, 1.0e-5_rk, 'stiffness')
    call check_close(log, worst(3), 0.0_rk, 1.0e-15_rk, 'symmetry')
  end subroutine derivatives

  !> At two and three equal principal strains the stiffness is that of strains that differ by 1e-9.
  subroutine equal_strains()
    real(rk), parameter :: patterns(3, 6) = reshape( &
                           [1.0_rk, 1.0_rk, -1.0_rk, 1.0_rk, 1.0_rk, -0.1_rk, &
                            1.0_rk, -0.3_rk, -0.3_rk, 1.0_rk, -4.0_rk, -4.0_rk, &
                            1.0_rk, 1.0_rk, 1.0_rk, -1.0_rk, -1.0_rk, -1.0_rk], [3, 6])
    real(rk) :: strain(6), stress(6), energy, stiffness(6, 6), beside(6, 6)
    integer :: i
    do i = 1, 6
      strain = 0.0_rk
      strain(1:3) = patterns(:, i)
      call state_of(strain, stress, energy, stiffness)
      strain(1:3) = strain(1:3) + 1.0e-9_rk*[1.0_rk, -2.0_rk, 0.5_rk]
      strain(4:6) = 1.0e-9_rk*[0.3_rk, 0.7_rk, -0.4_rk]
      call state_of(strain, stress, energy, beside)
      call check_close(log, maxval(abs(beside - stiffness))/model%young, 0.0_rk, 1.0e-8_rk, &
                       'equal strains')
    end do
  end subroutine equal_strains

  !> Loops that are ellipses in random planes of strain do no work. The trapezoidal rule with n
  !> points leaves (2 pi/n)^2/12 of the jump in slope at each of a few corners.
  subroutine loops()
    integer, parameter :: num_points = 20000
    real(rk) :: centre(6), plane(6, 2), strain(6), before(6), stress(6), last(6), stiffness(6, 6)
    real(rk) :: work, energy, worst, angle
    integer :: i, k
    worst = 0.0_rk
    do i = 1, 20
      call random_number(centre)
      call random_number(plane)
      centre = 0.2_rk*(centre - 0.5_rk)
      plane = plane - 0.5_rk
      work = 0.0_rk
      do k = 0, num_points
        angle = 2.0_rk*acos(-1.0_rk)*k/num_points
        strain = centre + cos(angle)*plane(:, 1) + sin(angle)*plane(:, 2)
        call state_of(strain, stress, energy, stiffness)
        if (k > 0) work = work + 0.5_rk*dot_product(stress + last, strain - before)
        before = strain
        last = stress
      end do
      worst = max(worst, abs(work)/model%young)
    end do
    call check_close(log, worst, 0.0_rk, 1.0e-8_rk, 'work of a closed loop')
  end subroutine loops

  !> Fractions that damage leaves: derivatives by central differences; more damage leaves less.
  subroutine losses()
    real(rk), parameter :: step = 1.0e-6_rk
    type(concrete_constants) :: own
    type(stiffness_left) :: here, above, below
    real(rk) :: d(2), slope(2, 2)
    integer :: i, k
    do i = 1, 9
      own = concrete
      own%tension_recovery = 0.5_rk*mod(i, 3)
      own%compression_recovery = 0.5_rk*((i - 1)/3)
      call make_concrete_model(own, model)
      call random_number(d)
      d = 0.95_rk*d
      call left_after(model, d(1), d(2), here)
      do k = 1, 2
        d(k) = d(k) + step
        call left_after(model, d(1), d(2), above)
        d(k) = d(k) - 2.0_rk*step
        call left_after(model, d(1), d(2), below)
        d(k) = d(k) + step
        slope(:, k) = (above%value - below%value)/(2.0_rk*step)
      end do
      call check_close(log, maxval(abs(slope - here%by_damage)), 0.0_rk, 1.0e-7_rk, 'slopes')
      call check(log, maxval(here%by_damage) <= 0.0_rk, 'damage takes away')
      call check(log, all(here%value > 0.0_rk .and. here%value <= 1.0_rk), 'between 0 and 1')
    end do
  end subroutine losses
end program test_damage_split
