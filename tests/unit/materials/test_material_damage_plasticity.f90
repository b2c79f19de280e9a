!> The law of plastic-damage concrete at one point: closed forms in one direction, recovery, apex,
!> repeated values, cycles, energies.
program test_material_damage_plasticity
  use concrete_scene, only: table_one
  use damage_constants, only: concrete_constants
  use errors, only: error_type
  use kinds, only: rk
  use material_damage_plasticity, only: concrete_law, make_concrete_law
  use material_law, only: start_points
  use material_points, only: no_tangent, &
                             point_set, point_state, time_increment, update_report
  use testing, only: check, check_close, test_log
  implicit none
  type(test_log) :: log
  type(error_type), allocatable :: error
  log%suite = 'material_damage_plasticity'
  call rows_of_table_one()
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> One point with a cube of 1 m around it.
  subroutine make_point(concrete, law, points, state)
    type(concrete_constants), intent(in) :: concrete
    type(concrete_law), intent(out) :: law
    type(point_set), intent(out) :: points
    type(point_state), intent(out) :: state
    integer :: i
    call make_concrete_law(concrete, law, error)
    call check(log,.not. allocated(error), 'law made')
    points%num_points = 1
    points%element = [1]
    points%number = [1]
    allocate (points%x(3, 1), points%edges(3, 3, 1), source=0.0_rk)
    do i = 1, 3
      points%edges(i, i, 1) = 1.0_rk
    end do
    points%length = [1.0_rk]
    call start_points(law, points, state)
  end subroutine make_point

  !> An increment that ends at this strain.
  subroutine move(law, points, strain, state)
    type(concrete_law), intent(in) :: law
    type(point_set), intent(in) :: points
    real(rk), intent(in) :: strain(6)
    type(point_state), intent(inout) :: state
    type(point_state) :: new
    type(time_increment) :: time
    type(update_report) :: report
    real(rk) :: tangent(6, 6, 0)
    time%tangent = no_tangent
    new = state
    new%strain(:, 1) = strain
    call law%update(points, time, state, new, tangent, report)
    call check(log, report%failed_point == 0, 'converged')
    state = new
  end subroutine move

  !> An increment to this strain along 1 with no stress across: secant iteration on the lateral
  !> strain, which is the same in both directions.
  subroutine pull(law, points, strain, state)
    type(concrete_law), intent(in) :: law
    type(point_set), intent(in) :: points
    real(rk), intent(in) :: strain
    type(point_state), intent(inout) :: state
    type(point_state) :: start
    real(rk) :: low, high, lateral, before(2), stress
    integer :: i
    start = state
    lateral = -0.167_rk*strain
    before = 0.0_rk
    low = min(0.0_rk, -10.0_rk*strain)
    high = max(0.0_rk, -10.0_rk*strain)
    low = low - 1.0e-2_rk
    high = high + 1.0e-2_rk
    do i = 1, 200
      state = start
      lateral = 0.5_rk*(low + high)
      call move(law, points, [strain, lateral, lateral, 0.0_rk, 0.0_rk, 0.0_rk], state)
      stress = state%stress(2, 1)
      if (stress > 0.0_rk) then
        high = lateral
      else
        low = lateral
      end if
      if (high - low <= 1.0e-18_rk) exit
    end do
  end subroutine pull

  !> A bar torn in eight steps returns the rows of Table 1 exactly: the strains are those of the
  !> table plus sigma/E.
  subroutine rows_of_table_one()
    type(concrete_constants) :: concrete
    type(concrete_law) :: law
    type(point_set) :: points
    type(point_state) :: state
    integer :: i
    concrete = table_one()
    call make_point(concrete, law, points, state)
    do i = 1, 8
      call pull(law, points, concrete%tension(2, i) + concrete%tension(1, i)/concrete%young, state)
      call check_close(log, state%stress(1, 1), concrete%tension(1, i), 1.0_rk, 'row of Table 1')
      call check_close(log, state%internal(9, 1), concrete%tension_damage(1, i), 1.0e-6_rk, &
                       'damage')
    end do
  end subroutine rows_of_table_one
end program test_material_damage_plasticity
