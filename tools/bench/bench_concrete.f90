!> Time of the law of concrete per point, in blocks as in an analysis, on one thread.
program bench_concrete
  use concrete_model, only: lee_fenves, table_one
  use damage_constants, only: concrete_constants
  use errors, only: error_type
  use kinds, only: rk
  use material_damage_plasticity, only: concrete_law, make_concrete_law
  use material_law, only: start_points
  use material_points, only: consistent_tangent, no_tangent, point_set, point_state, &
                             secant_tangent, time_increment, update_report
  use testing, only: repeat_chance
  implicit none
  integer, parameter :: block = 128 !< points of 16 elements
  integer, parameter :: repeats = 4000
  type(concrete_constants) :: concrete
  real(rk) :: checksum
  checksum = 0.0_rk
  call repeat_chance(1)
  call measure(table_one(), 0.2e-4_rk, 0.0_rk, 'Table 1, virgin, elastic')
  call measure(table_one(), 4.0e-4_rk, -0.3e-4_rk, 'Table 1, cracked, unloading')
  call measure(table_one(), 4.0e-4_rk, 0.3e-4_rk, 'Table 1, cracking')
  call measure(lee_fenves(), -3.0e-3_rk, -1.0e-4_rk, '60 rows, crushing')
  call measure(lee_fenves(), 2.0e-3_rk, 1.0e-4_rk, '60 rows, cracking')
  concrete = table_one()
  concrete%stiffening = 'GFI'
  concrete%tension_damage_type = 'DISPLACEMENT'
  concrete%tension = reshape([2.48e6_rk, 200.0_rk], [2, 1])
  concrete%tension_damage = reshape([0.0_rk, 0.0_rk, 0.9_rk, 1.6e-4_rk], [2, 2])
  call measure(concrete, 1.0e-4_rk, 0.2e-4_rk, 'G_f and damage, cracking')
  concrete%viscosity = 1.0e-3_rk
  call measure(concrete, 1.0e-4_rk, 0.2e-4_rk, 'the same with viscosity')
  if (abs(checksum) > huge(checksum)) error stop 1

contains

  !> Loads a block in random directions near tension (compression) along 1, then times one further
  !> increment: the stress alone, with energies, with each tangent.
  subroutine measure(constants, first, second, what)
    type(concrete_constants), intent(in) :: constants
    real(rk), intent(in) :: first, second !< strains of the loading and of the increment timed
    character(*), intent(in) :: what
    integer, parameter :: kinds_of_tangent(4) = [no_tangent, no_tangent, secant_tangent, &
                                                 consistent_tangent]
    type(concrete_law) :: law
    type(point_set) :: points
    type(point_state) :: old, new
    type(time_increment) :: time
    type(update_report) :: report
    type(error_type), allocatable :: error
    real(rk) :: tangent(6, 6, block), direction(6, block), seconds(4)
    integer :: i, k
    call make_concrete_law(constants, law, error)
    if (allocated(error)) error stop 2
    call place_points(points)
    call start_points(law, points, old)
    call random_number(direction)
    direction = 0.3_rk*(direction - 0.5_rk)
    direction(1, :) = direction(1, :) + 1.0_rk
    do i = 2, 3
      direction(i, :) = direction(i, :) - 0.15_rk
    end do
    call start_points(law, points, new)
    new%strain = first*direction
    call law%update(points, time, old, new, tangent, report)
    old = new
    new%strain = (first + second)*direction
    do k = 1, 4
      time%wants_energy = k > 1
      time%tangent = kinds_of_tangent(k)
      call repeat_update(law, points, time, old, new, tangent, seconds(k))
    end do
    i = count(any(abs(new%internal(7:8, :) - old%internal(7:8, :)) > 0.0_rk, 1))
    write (*, '(a28,4(a,f8.1),a,i4,a)') what, ':', 1.0e9_rk*seconds(1)/block, ' ns a point,', &
      1.0e9_rk*seconds(2)/block, ' with energies,', 1.0e9_rk*seconds(3)/block, &
      ' with secant,', 1.0e9_rk*seconds(4)/block, ' with consistent tangent;', i, ' of 128 yield'
  end subroutine measure

  !> Cubes of 0.5 m.
  subroutine place_points(points)
    type(point_set), intent(out) :: points
    integer :: i
    points%num_points = block
    allocate (points%element(block), points%number(block), source=1)
    allocate (points%x(3, block), points%edges(3, 3, block), source=0.0_rk)
    allocate (points%length(block), source=0.5_rk)
    allocate (points%widest(block), source=0.5_rk)
    do i = 1, 3
      points%edges(i, i, :) = 0.5_rk
    end do
  end subroutine place_points

  !> Seconds of one update of the block, the least of ten samples.
  subroutine repeat_update(law, points, time, old, new, tangent, seconds)
    type(concrete_law), intent(in) :: law
    type(point_set), intent(in) :: points
    type(time_increment), intent(in) :: time
    type(point_state), intent(in) :: old
    type(point_state), intent(inout) :: new
    real(rk), intent(inout) :: tangent(:, :, :)
    real(rk), intent(out) :: seconds
    type(update_report) :: report
    real(rk) :: start, now
    integer :: r, sample
    seconds = huge(seconds)
    do sample = 1, 10
      call cpu_time(start)
      do r = 1, repeats/10
        call law%update(points, time, old, new, tangent, report)
        checksum = checksum + new%stress(1, block) + tangent(1, 1, block)
      end do
      call cpu_time(now)
      seconds = min(seconds, (now - start)/(repeats/10))
    end do
    if (report%failed_point > 0) error stop 3
  end subroutine repeat_update
end program bench_concrete
