!> The kernel of concrete at one point: its tangents against central differences.
program test_damage_point
  use concrete_model, only: lee_fenves, table_one
  use damage_constants, only: concrete_constants
  use damage_model, only: concrete_model, make_concrete_model, placed_curves
  use damage_point, only: update_point
  use damage_states, only: point_answer, point_history, point_motion
  use kinds, only: rk
  use testing, only: check_close, repeat_chance, test_log
  implicit none
  !> Of the tangent over E. Central differences with a step of 1e-8: rounding 1e-16 E strain/step =
  !> 1e-11, the end of the return map 1e-13 of the strength over E step = 1e-8, curvature (step over
  !> the strain at which the stress turns, 1e-4) squared = 1e-8.
  real(rk), parameter :: tolerance = 1.0e-6_rk, step = 1.0e-8_rk
  type(test_log) :: log
  type(concrete_constants) :: concrete
  integer :: num_corners = 0, num_yielding = 0
  log%suite = 'damage_point'
  call repeat_chance(1)
  call tangents(table_one(), 'Table 1')
  call tangents(lee_fenves(), 'Lee and Fenves')
  concrete = lee_fenves()
  concrete%recovery = 'SIGN'
  concrete%tension_recovery = 0.5_rk
  call tangents(concrete, 'recovery by sign')
  concrete%recovery = 'LEE-FENVES'
  concrete%compression_recovery = 0.5_rk
  call tangents(concrete, 'recoveries 0.5')
  concrete%viscosity = 2.0_rk
  call tangents(concrete, 'viscosity')
  concrete = lee_fenves()
  concrete%recovery = 'ENERGY'
  call tangents(concrete, 'recovery by energy')
  concrete%compression_recovery = 0.5_rk
  concrete%tension_recovery = 0.5_rk
  concrete%viscosity = 2.0_rk
  call tangents(concrete, 'recovery by energy, recoveries 0.5, viscosity')
  write (*, '(3(a,i0))') 'states at a corner of the law ', num_corners, ', yielding ', num_yielding
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> Random paths of three increments; the tangent of the last.
  subroutine tangents(constants, what)
    type(concrete_constants), intent(in) :: constants
    character(*), intent(in) :: what
    type(concrete_model) :: model
    type(point_motion) :: motion
    type(point_history) :: history, new
    type(point_answer) :: answer
    type(placed_curves) :: placed
    real(rk) :: chance(7), error, worst
    integer :: i, k
    call make_concrete_model(constants, model)
    worst = 0.0_rk
    do i = 1, 300
      history = point_history()
      motion = point_motion(time=1.0_rk)
      do k = 1, 3
        motion%edges(k, k) = 1.0_rk
      end do
      do k = 1, 3
        call random_number(chance)
        motion%before = motion%strain
        motion%strain = motion%strain + (2.0_rk*chance(:6) - 1.0_rk) &
                        *10.0_rk**(-2.5_rk - 2.0_rk*chance(7))
        if (k == 3) exit
        call update_point(model, motion, history, placed, new, answer)
        history = new
      end do
      call compare(model, motion, history, placed, error)
      if (error >= 0.0_rk) worst = max(worst, error)
    end do
    write (*, '(2a,es9.2)') what, ': worst error of the tangent over E ', worst
    call check_close(log, worst, 0.0_rk, tolerance, what)
  end subroutine tangents

  !> Error of one tangent over E; negative at a corner, where the differences of the two sides do
  !> not agree.
  subroutine compare(model, motion, old, placed, error)
    type(concrete_model), intent(in) :: model
    type(point_motion), intent(in) :: motion
    type(point_history), intent(in) :: old
    type(placed_curves), intent(inout) :: placed
    real(rk), intent(out) :: error
    type(point_motion) :: beside
    type(point_history) :: new
    type(point_answer) :: centre, above, below
    real(rk) :: central(6, 6), one_sided(6, 6)
    integer :: j
    call update_point(model, motion, old, placed, new, centre)
    if (.not. centre%is_elastic) num_yielding = num_yielding + 1
    beside = motion
    do j = 1, 6
      beside%strain = motion%strain
      beside%strain(j) = motion%strain(j) + step
      call update_point(model, beside, old, placed, new, above)
      beside%strain(j) = motion%strain(j) - step
      call update_point(model, beside, old, placed, new, below)
      central(:, j) = (above%stress - below%stress)/(2.0_rk*step)
      one_sided(:, j) = (above%stress - 2.0_rk*centre%stress + below%stress)/step
    end do
    error = maxval(abs(central - centre%tangent))/model%young
    ! Of a smooth stress the two sides differ by the curvature, 1e-4 at this step.
    if (maxval(abs(one_sided)) > 1.0e-3_rk*model%young) then
      num_corners = num_corners + 1
      error = -1.0_rk
    end if
  end subroutine compare
end program test_damage_point
