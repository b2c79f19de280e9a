!> Copies of the loops over points of concrete for this processor and for any: the same stresses,
!> histories and elastic points, to round-off of return maps.
program test_damage_loops
  use concrete_model, only: table_one
  use damage_constants, only: concrete_constants
  use damage_loops, only: find_plain_stresses, screen_adjacent
  use damage_model, only: placed_curves
  use damage_stress, only: find_stresses
  use damage_trials, only: screen_points
  use errors, only: error_type
  use kinds, only: rk
  use material_damage_plasticity, only: concrete_law, make_concrete_law
  use material_law, only: start_points
  use material_points, only: point_set, point_state
  use testing, only: check, check_close, repeat_chance, test_log
  implicit none
  integer, parameter :: num_points = 500, num_increments = 4
  !> As in test_damage_stress: both solve F = 0 to the same tolerance.
  real(rk), parameter :: tolerance = 1.0e-9_rk
  type(test_log) :: log
  type(concrete_constants) :: concrete
  type(concrete_law) :: law
  type(error_type), allocatable :: error
  log%suite = 'damage_loops'
  call repeat_chance(1)
  concrete = table_one()
  call make_concrete_law(concrete, law, error)
  if (allocated(error)) error stop 2
  call compare_stresses()
  call compare_screens()
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> Random paths.
  subroutine compare_stresses()
    type(point_set) :: points
    type(point_state) :: old, here, anywhere
    type(placed_curves) :: placed
    real(rk) :: chance(6, num_points)
    logical :: is_found(num_points), is_found_anywhere(num_points)
    integer :: i
    points%num_points = num_points
    allocate (points%edges(3, 3, num_points), source=0.5_rk)
    call start_points(law, points, old)
    do i = 1, num_increments
      call random_number(chance)
      here = old
      here%strain = old%strain + (chance - 0.45_rk)*3.0e-4_rk
      anywhere = here
      is_found = .false.
      is_found_anywhere = .false.
      call find_plain_stresses(law%model, points, old, placed, here, is_found)
      call find_stresses(law%model, points, old, placed, anywhere, is_found_anywhere)
      call check(log, all(is_found .eqv. is_found_anywhere), 'the same points converge')
      call check(log, all(here%is_elastic .eqv. anywhere%is_elastic), 'the same points yield')
      call check_close(log, maxval(abs(here%stress - anywhere%stress))/concrete%tension(1, 1), &
                       0.0_rk, tolerance, 'stress')
      call check_close(log, maxval(abs(here%internal - anywhere%internal)), 0.0_rk, tolerance, &
                       'history')
      old = here
    end do
    call check(log, count(.not. old%is_elastic) > num_points/2, 'points yield')
  end subroutine compare_stresses

  !> Virgin points.
  subroutine compare_screens()
    real(rk) :: strain(6, num_points), stress(6, num_points, 2), energy(num_points, 2)
    real(rk) :: factor(num_points)
    logical :: is_within(num_points, 2)
    call random_number(strain)
    strain = (strain - 0.5_rk)*2.0e-4_rk
    factor = 1.0_rk
    call screen_adjacent(law%model, factor, strain, stress(:, :, 1), energy(:, 1), is_within(:, 1))
    call screen_points(law%model, factor, strain, stress(:, :, 2), energy(:, 2), is_within(:, 2))
    call check(log, any(is_within) .and. .not. all(is_within), 'points within and outside')
    call check(log, all(is_within(:, 1) .eqv. is_within(:, 2)), 'the same points are within')
    call check_close(log, maxval(abs(stress(:, :, 1) - stress(:, :, 2)))/concrete%tension(1, 1), &
                     0.0_rk, tolerance, 'elastic stress')
    call check_close(log, maxval(abs(energy(:, 1) - energy(:, 2)))/maxval(energy), 0.0_rk, &
                     tolerance, 'elastic energy')
  end subroutine compare_screens
end program test_damage_loops
