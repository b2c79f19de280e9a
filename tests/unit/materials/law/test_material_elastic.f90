!> Hooke's law against its closed form.
program test_material_elastic
  use kinds, only: rk
  use material_elastic, only: elastic_law
  use material_law, only: start_points
  use material_points, only: point_set, point_state, time_increment, update_report
  use testing, only: check, check_close, test_log
  implicit none
  type(test_log) :: log

  log%suite = 'material_elastic'
  call uniaxial_stress(log)
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> A bar pulled along 1 contracts by nu, and shears with G.
  subroutine uniaxial_stress(log)
    type(test_log), intent(inout) :: log
    type(elastic_law) :: law
    type(point_set) :: points
    type(point_state) :: old, new
    type(update_report) :: report
    real(rk) :: tangent(6, 6, 2)
    law = elastic_law(young=25.0e9_rk, poisson=0.2_rk)
    points%num_points = 2
    call start_points(law, points, old)
    new = old
    new%strain(:, 1) = 1.0e-4_rk*[1.0_rk, -0.2_rk, -0.2_rk, 0.0_rk, 0.0_rk, 0.0_rk]
    new%strain(:, 2) = 1.0e-4_rk*[0.0_rk, 0.0_rk, 0.0_rk, 1.0_rk, 0.0_rk, 0.0_rk]
    call law%update(points, time_increment(), old, new, tangent, report)
    call check_close(log, new%stress(1, 1), 2.5e6_rk, 1.0e-6_rk, 'E eps')
    call check_close(log, maxval(abs(new%stress(2:, 1))), 0.0_rk, 1.0e-6_rk, 'free sides')
    call check_close(log, new%stress(4, 2), 25.0e5_rk/2.4_rk, 1.0e-6_rk, 'G gamma')
    call check(log, report%failed_point == 0 .and. size(new%internal, 1) == 0, 'no history')
    call check_close(log, tangent(4, 4, 2), 25.0e9_rk/2.4_rk, 1.0e-3_rk, 'tangent')
  end subroutine uniaxial_stress
end program test_material_elastic
