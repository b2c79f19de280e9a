!> Updates of many points at once give the stresses, histories and energies of updates with
!> tangents, which take one point after the other: random paths of blocks of points. Energies that
!> are completed later are the same. Points that stay keep their answer to the last bit.
program test_damage_stress
  use concrete_model, only: table_one
  use damage_constants, only: concrete_constants
  use errors, only: error_type
  use kinds, only: rk
  use material_damage_plasticity, only: concrete_law, make_concrete_law
  use material_law, only: start_points
  use material_points, only: created_energy, crushing_energy, no_tangent, point_set, &
                             point_state, secant_tangent, time_increment, update_report
  use testing, only: check, check_close, repeat_chance, test_log
  implicit none
  integer, parameter :: num_points = 2000, num_increments = 8
  !> Both solve F = 0 to the same tolerance, from principal values that differ by round-off. Where
  !> the strength has nearly gone the root is known to fewer digits.
  real(rk), parameter :: tolerance = 1.0e-9_rk
  type(test_log) :: log
  type(concrete_constants) :: concrete
  real(rk), allocatable :: strength(:)
  log%suite = 'damage_stress'
  call repeat_chance(1)
  call follow(table_one(), .false., 'Table 1')
  concrete = table_one()
  concrete%stiffening = 'GFI'
  concrete%tension_damage_type = 'DISPLACEMENT'
  concrete%tension = reshape([2.48e6_rk, 200.0_rk], [2, 1])
  concrete%tension_damage = reshape([0.0_rk, 0.0_rk, 0.9_rk, 1.6e-4_rk], [2, 2])
  call follow(concrete, .false., 'G_f and damage')
  strength = concrete%compression(1, :)
  concrete%compression(1, :) = 0.15_rk*strength
  call follow(concrete, .true., 'weak in compression')
  concrete%compression(1, :) = strength
  concrete%recovery = 'SIGN'
  call follow(concrete, .false., 'RECOVERY=SIGN')
  concrete%recovery = 'ENERGY'
  call follow(concrete, .false., 'RECOVERY=ENERGY')
  call follow(concrete, .false., 'RECOVERY=ENERGY, axial', is_axial=.true.)
  concrete%compression(1, :) = 0.15_rk*strength
  call follow(concrete, .true., 'RECOVERY=ENERGY, weak in compression')
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> Random increments of all points; axial ones have two equal principal stresses.
  subroutine follow(constants, crushes, what, is_axial)
    type(concrete_constants), intent(in) :: constants
    logical, intent(in) :: crushes !< some point
    character(*), intent(in) :: what
    logical, intent(in), optional :: is_axial
    type(concrete_law) :: law
    type(point_set) :: points
    type(point_state) :: old, full, bare
    type(time_increment) :: time
    type(update_report) :: report
    type(error_type), allocatable :: error
    real(rk) :: unused(6, 6, 0), tangent(6, 6, num_points), chance(6, num_points)
    real(rk) :: stress, history, energy
    integer :: i
    call make_concrete_law(constants, law, error)
    if (allocated(error)) error stop 2
    call place_points(points)
    call start_points(law, points, old)
    full = old
    bare = old
    stress = 0.0_rk
    history = 0.0_rk
    energy = 0.0_rk
    do i = 1, num_increments
      call random_number(chance)
      if (present(is_axial)) then
        chance(3, :) = chance(2, :)
        chance(4:, :) = 0.45_rk ! no shear
      end if
      full%strain = old%strain + (chance - 0.45_rk)*3.0e-4_rk
      bare%strain = full%strain
      time%wants_energy = .true.
      time%tangent = secant_tangent
      call law%update(points, time, old, full, tangent, report)
      time%tangent = no_tangent
      call law%update(points, time, old, bare, unused, report)
      energy = max(energy, maxval(abs(full%energy - bare%energy)))
      time%wants_energy = .false.
      call law%update(points, time, old, bare, unused, report)
      stress = max(stress, maxval(abs(full%stress - bare%stress)))
      history = max(history, maxval(abs(full%internal - bare%internal)))
      call check(log, all(full%is_elastic .eqv. bare%is_elastic), what//': the same points yield')
      call repeat_some(law, points, old, bare, what)
      time%wants_energy = .true.
      time%is_updated = .true.
      call law%update(points, time, old, bare, unused, report)
      time%is_updated = .false.
      energy = max(energy, maxval(abs(full%energy - bare%energy)))
      old = full
    end do
    call check(log, count(.not. old%is_elastic) > num_points/2, what//': points yield')
    call check_close(log, max(stress/constants%tension(1, 1), history), 0.0_rk, tolerance, &
                     what//': stress and history')
    call check(log, any(old%energy(created_energy, :) > 0.0_rk) .neqv. law%model%splits_energy, &
               what//': stiffness comes back')
    call check(log, any(old%energy(crushing_energy, :) > 0.0_rk) .eqv. crushes, &
               what//': points crush')
    call check_close(log, energy*constants%young/constants%tension(1, 1)**2, 0.0_rk, tolerance, &
                     what//': energy')
  end subroutine follow

  !> Moves every third point, in runs of one and of two that stay, and moves it back.
  subroutine repeat_some(law, points, old, bare, what)
    type(concrete_law), intent(in) :: law
    type(point_set), intent(in) :: points
    type(point_state), intent(in) :: old, bare
    character(*), intent(in) :: what
    type(point_state) :: moved
    type(time_increment) :: time
    type(update_report) :: report
    real(rk) :: unused(6, 6, 0)
    integer :: i
    time%tangent = no_tangent
    time%wants_energy = .false.
    time%stays = [(mod(i, 3) > 0, i=1, num_points)]
    moved = bare
    moved%strain(:, 3::3) = 2.0_rk*moved%strain(:, 3::3)
    call law%update(points, time, old, moved, unused, report)
    moved%strain = bare%strain
    call law%update(points, time, old, moved, unused, report)
    call check(log, all(abs(moved%stress - bare%stress) <= 0.0_rk) &
               .and. all(abs(moved%internal - bare%internal) <= 0.0_rk) &
               .and. all(moved%is_elastic .eqv. bare%is_elastic), what//': points stay')
  end subroutine repeat_some

  !> Bricks of different sides.
  subroutine place_points(points)
    type(point_set), intent(out) :: points
    integer :: i
    points%num_points = num_points
    allocate (points%element(num_points), points%number(num_points), source=1)
    allocate (points%edges(3, 3, num_points), points%x(3, num_points), source=0.0_rk)
    allocate (points%length(num_points), source=0.4_rk)
    allocate (points%widest(num_points), source=0.6_rk)
    do i = 1, 3
      points%edges(i, i, :) = 0.2_rk*i
    end do
  end subroutine place_points
end program test_damage_stress
