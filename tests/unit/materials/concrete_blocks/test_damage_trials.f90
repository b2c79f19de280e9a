!> The elastic check of virgin concrete never accepts an inelastic point, accepts nearly all elastic
!> points, and gives their stress and energy. Trial states of blocks are those of single points.
program test_damage_trials
  use concrete_model, only: table_one
  use damage_model, only: concrete_model, make_concrete_model, stiffness_of
  use damage_increment, only: deviator_of, elastic_stress
  use damage_trials, only: find_trials, screen_points, trial_block
  use damage_yield, only: yield_at, yield_value
  use kinds, only: rk
  use tensor6, only: principal_values, trace, von_mises
  use testing, only: check, check_close, repeat_chance, test_log
  implicit none
  integer, parameter :: num_points = 20000
  type(test_log) :: log
  log%suite = 'damage_trials'
  call random_points()
  call uniaxial_limits()
  call trial_states()
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> Against F itself.
  subroutine random_points()
    type(concrete_model) :: model
    type(yield_value) :: f
    real(rk) :: strain(6, num_points), stress(6, num_points), energy(num_points), d(6, 6)
    real(rk) :: principal(3), worst
    logical :: is_within(num_points), is_elastic
    integer :: i, num_elastic, num_missed
    call make_concrete_model(table_one(), model)
    call stiffness_of(model, d)
    call repeat_chance(1)
    call random_number(strain)
    strain = (strain - 0.5_rk)*6.0e-4_rk
    strain(:3, :) = strain(:3, :) - 0.7e-4_rk
    call screen_points(model, spread(1.0_rk, 1, size(energy)), strain, stress, energy, &
                       is_within)
    num_elastic = 0
    num_missed = 0
    worst = 0.0_rk
    do i = 1, num_points
      worst = max(worst, maxval(abs(stress(:, i) - matmul(d, strain(:, i))))/model%young)
      worst = max(worst, abs(energy(i) - 0.5_rk*dot_product(stress(:, i), strain(:, i))) &
                  /model%young)
      principal = principal_values(stress(:, i))
      f = yield_at(model, von_mises(stress(:, i)), -trace(stress(:, i))/3.0_rk, principal(1), &
                   2.48e6_rk, 30.0e6_rk)
      is_elastic = f%value <= 1.0e-9_rk*30.0e6_rk
      if (is_within(i) .and. .not. is_elastic) call check(log, .false., 'taken for elastic')
      if (is_elastic) num_elastic = num_elastic + 1
      if (is_elastic .and. .not. is_within(i)) num_missed = num_missed + 1
    end do
    write (*, '(2(i0,a))') num_elastic, ' elastic, ', num_missed, ' of them not seen'
    call check(log, num_elastic > num_points/10 .and. num_elastic < 9*num_points/10, &
               'elastic points and others')
    call check(log, 5*num_missed < num_elastic, 'four of five elastic points are seen')
    call check_close(log, worst, 0.0_rk, 1.0e-17_rk, 'stress and energy')
  end subroutine random_points

  !> Uniaxial tension and compression are judged exactly, pressure is never beyond the surface.
  subroutine uniaxial_limits()
    type(concrete_model) :: model
    real(rk) :: strain(6, 6), stress(6, 6), energy(6)
    logical :: is_within(6)
    integer :: i
    call make_concrete_model(table_one(), model)
    strain = 0.0_rk
    strain(1, :) = [2.47e6_rk, 2.49e6_rk, -29.9e6_rk, -30.1e6_rk, -1.0e9_rk, 0.0_rk]/model%young
    do i = 2, 3
      strain(i, :) = -model%poisson*strain(1, :)
    end do
    strain(2:3, 5) = strain(1, 5)
    call screen_points(model, spread(1.0_rk, 1, size(energy)), strain, stress, energy, &
                       is_within)
    call check(log, all(is_within .eqv. [.true., .false., .true., .false., .true., .true.]), &
               'limits')
  end subroutine uniaxial_limits

  !> Random elastic strains and near to them those with two or three equal principal values, against
  !> the procedures for one tensor.
  subroutine trial_states()
    type(concrete_model) :: model
    type(trial_block) :: trials
    real(rk) :: strain(6, num_points), internal(11, num_points), s(6), worst
    integer :: i, points(num_points/2)
    call make_concrete_model(table_one(), model)
    call random_number(strain)
    call random_number(internal)
    strain = (strain - 0.5_rk)*6.0e-4_rk
    internal = internal*1.0e-4_rk
    strain(4:, ::5) = internal(4:6, ::5) ! on the axes
    strain(2, ::15) = strain(1, ::15) + internal(2, ::15) - internal(1, ::15) ! equal values
    strain(:, ::100) = internal(:6, ::100) ! without stress
    points = [(2*i - 1, i=1, size(points))]
    call find_trials(model, points, strain, internal, trials)
    worst = 0.0_rk
    do i = 1, size(points)
      s = elastic_stress(model, strain(:, points(i)) - internal(:6, points(i)))
      worst = max(worst, abs(trials%p(i) + trace(s)/3.0_rk)/model%young)
      s = deviator_of(s)
      worst = max(worst, abs(trials%q(i) - von_mises(s))/model%young)
      worst = max(worst, maxval(abs(trials%deviator(:, i)*trials%q(i) - s))/model%young)
      s(:3) = trials%q(i)*trials%shape(:, i) - principal_values(s)
      worst = max(worst, maxval(abs(s(:3)))/model%young)
    end do
    ! Round-off of stresses up to 1e-3 of E: some ten units of 1e-3*epsilon.
    call check_close(log, worst, 0.0_rk, 4.0e-18_rk, 'trial states')
  end subroutine trial_states
end program test_damage_trials
