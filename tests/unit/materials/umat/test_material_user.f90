!> A law made of a loaded UMAT, called as the structure calls it: blocks of points, histories,
!> tangents, energies. The UMAT is linear hardening in shear written here, so its answers are known.
program test_material_user
  use errors, only: error_type
  use kinds, only: rk
  use material_law, only: start_points
  use material_points, only: consistent_tangent, fracture_energy, point_set, point_state, &
                             secant_tangent, stored_energy, time_increment, update_report
  use material_user, only: find_stiffness, make_user_law, user_constants, user_law
  use testing, only: check, check_close, check_text, test_log
  use umat_loader, only: open_library, umat_request, user_library
  implicit none
  type(test_log) :: log
  type(user_library), pointer :: library
  type(user_law) :: law
  type(point_set) :: points
  character(*), parameter :: source = 'test_material_user_law.for' !< in the working folder
  real(rk), parameter :: modulus = 100.0_rk, limit = 1.0_rk !< of the test's UMAT

  log%suite = 'material_user'
  allocate (library)
  call write_source()
  call make_law(log)
  call elastic_and_beyond(log)
  call history_is_the_converged_one(log)
  call secant_is_positive(log)
  call wishes_and_faults(log)
  call fields(log)
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> Each component by itself: stress = 100 strain up to 1, then perfectly plastic with DDSDDE zero
  !> there; STATEV counts. A strain above 1 is NaN, one below -1 wants a quarter of the increment.
  subroutine write_source()
    integer :: unit
    open (newunit=unit, file=source, status='replace', action='write')
    write (unit, '(a)', advance='no') 'subroutine umat(s, sv, d, sse, spd, scd, r, a, b, c, st, '
    write (unit, '(a)', advance='no') 'dst, ti, dt, te, dte, pr, dp, name, ndi, nshr, nt, nsv, p, '
    write (unit, '(a)') 'np, x, rot, pnewdt)', &
      '  real*8 s(6), sv(nsv), d(6, 6), dst(6), st(6), p(np), pnewdt', &
      '  do i = 1, 6', &
      '    d(i, i) = p(1)', &
      '    s(i) = s(i) + p(1)*dst(i)', &
      '    if (abs(s(i)) > p(2)) then', &
      '      s(i) = sign(p(2), s(i))', &
      '      d(i, i) = 0', &
      '    end if', &
      '  end do', &
      '  sv(1) = sv(1) + 1', &
      '  if (st(1) + dst(1) > 1) s(3) = sqrt(-p(2))', &
      '  if (st(1) + dst(1) < -1) pnewdt = 0.25', &
      'end'
    close (unit)
  end subroutine write_source

  subroutine make_law(log)
    type(test_log), intent(inout) :: log
    type(umat_request) :: request
    type(user_constants) :: constants
    type(error_type), allocatable :: error
    real(rk) :: d(6, 6)
    integer :: i
    allocate (request%files(1))
    request%files(1)%path = source
    request%flags = ''
    request%target = ''
    call open_library(request, 'test_material_user', '.', library, error)
    call check(log,.not. allocated(error), 'the library is built and loaded')
    if (allocated(error)) write (*, '(a)') error%message
    constants%name = 'STEEL'
    constants%values = [modulus, limit]
    constants%num_variables = 1
    call make_user_law(library, constants, law)
    points%num_points = 2
    points%element = [7, 7]
    points%number = [1, 2]
    points%length = [1.0_rk, 1.0_rk]
    allocate (points%x(3, 2), points%edges(3, 3, 2), source=0.0_rk)
    call find_stiffness(law, points, time_increment(), error)
    call check(log,.not. allocated(error), 'it gives a stiffness')
    call law%elastic_stiffness(d)
    do i = 1, 6
      d(i, i) = d(i, i) - modulus
    end do
    call check(log, maxval(abs(d)) <= 1.0e-12_rk, 'the stiffness is that of DDSDDE')
    call check(log, law%is_serial .and. law%is_nonlinear .and. law%num_state == 4, 'what it needs')
  end subroutine make_law

  !> Work 1/2 s e of the elastic point; the other stores limit^2/2E and dissipates the rest.
  subroutine elastic_and_beyond(log)
    type(test_log), intent(inout) :: log
    type(point_state) :: old, new
    type(update_report) :: report
    real(rk) :: tangent(6, 6, 2)
    call start_points(law, points, old)
    new = old
    new%strain(1, 1) = 0.005_rk
    new%strain(4, 2) = 0.03_rk
    call law%update(points, time_increment(), old, new, tangent, report)
    call check(log, report%failed_point == 0, 'no fault')
    call check_close(log, new%stress(1, 1), 0.5_rk, 1.0e-14_rk, 'elastic stress')
    call check_close(log, new%stress(4, 2), limit, 0.0_rk, 'stress at the limit')
    call check_close(log, tangent(4, 4, 2), 0.0_rk, 0.0_rk, 'tangent at the limit')
    call check_close(log, new%energy(stored_energy, 1), 0.00125_rk, 1.0e-16_rk, 'elastic energy')
    call check_close(log, new%energy(fracture_energy, 1), 0.0_rk, 1.0e-16_rk, 'nothing dissipated')
    call check_close(log, new%energy(stored_energy, 2), 0.005_rk, 1.0e-16_rk, 'stored at the limit')
    ! The work is that of the mean stress, 1/2 (0 + 1) 0.03.
    call check_close(log, new%energy(fracture_energy, 2), 0.01_rk, 1.0e-16_rk, 'dissipated there')
    call check(log,.not. any(new%is_elastic), 'never taken for elastic')
  end subroutine elastic_and_beyond

  !> Two calls from one converged state give the same answer; STATEV counts one.
  subroutine history_is_the_converged_one(log)
    type(test_log), intent(inout) :: log
    type(point_state) :: old, new
    type(update_report) :: report
    real(rk) :: tangent(6, 6, 2)
    integer :: i
    call start_points(law, points, old)
    new = old
    new%strain(2, :) = 0.004_rk
    do i = 1, 3
      call law%update(points, time_increment(), old, new, tangent, report)
    end do
    call check_close(log, new%internal(1, 1), 1.0_rk, 0.0_rk, 'one increment counted')
    call check_close(log, new%stress(2, 1), 0.4_rk, 1.0e-15_rk, 'stress of one increment')
  end subroutine history_is_the_converged_one

  subroutine secant_is_positive(log)
    type(test_log), intent(inout) :: log
    type(point_state) :: old, new
    type(update_report) :: report
    real(rk) :: tangent(6, 6, 2)
    call start_points(law, points, old)
    new = old
    new%strain(4, 2) = 0.03_rk
    call law%update(points, time_increment(tangent=secant_tangent), old, new, tangent, report)
    call check_close(log, tangent(4, 4, 2), modulus, 1.0e-12_rk, &
                     'the stiffness of the start where DDSDDE is singular')
  end subroutine secant_is_positive

  subroutine wishes_and_faults(log)
    type(test_log), intent(inout) :: log
    type(point_state) :: old, new
    type(update_report) :: report
    real(rk) :: tangent(6, 6, 2)
    call start_points(law, points, old)
    new = old
    new%strain(1, 2) = -1.5_rk
    call law%update(points, time_increment(), old, new, tangent, report)
    call check_close(log, report%size_ratio, 0.25_rk, 0.0_rk, 'PNEWDT is passed on')
    call check(log, report%failed_point == 2, 'and its point')
    new%strain(1, 2) = 1.5_rk
    new%stress = 0.0_rk
    call law%update(points, time_increment(tangent=consistent_tangent), old, new, tangent, report)
    call check(log, report%failed_point == 2, 'a NaN fails its point')
    call check_text(log, report%message, 'UMAT: STRESS(3) is not a number', 'message')
    call check_close(log, maxval(abs(new%stress(:, 2))), 0.0_rk, 0.0_rk, 'and goes nowhere')
  end subroutine wishes_and_faults

  !> Results have the state variables without the energies stored after them.
  subroutine fields(log)
    type(test_log), intent(inout) :: log
    type(point_state) :: state
    real(rk), allocatable :: values(:, :)
    call start_points(law, points, state)
    call law%read_field('SDV', state, values)
    call check(log, size(values, 1) == 1 .and. size(values, 2) == 2, 'SDV1 at each point')
    call law%read_field('DAMAGET', state, values)
    call check(log,.not. allocated(values), 'no damage')
  end subroutine fields
end program test_material_user
