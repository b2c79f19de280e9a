!> A material at one point along paths of strains and stresses, against closed forms.
program test_material_path
  use errors, only: error_type
  use kinds, only: rk
  use material_elastic, only: elastic_law
  use material_path, only: path_record, follow_path
  use material_points, only: stored_energy, fracture_energy
  use material_tests, only: material_test, test_leg
  use metal_law, only: metal
  use testing, only: check, check_close, test_log
  implicit none
  type(test_log) :: log

  log%suite = 'material_path'
  call elastic_bar(log)
  call stress_ratio(log)
  call held_components(log)
  call hardening_bar(log)
  call softening_bar(log)
  call stress_beyond_peak(log)
  call strain_that_snaps_back(log)
  call softening_shear(log)
  call small_increments(log)
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> A leg along 11 with free sides.
  pure type(test_leg) function bar_leg(target, num_increments, is_stress)
    real(rk), intent(in) :: target
    integer, intent(in) :: num_increments
    logical, intent(in) :: is_stress
    bar_leg%is_stress = .true.
    bar_leg%is_stress(1) = is_stress
    bar_leg%target(1) = target
    bar_leg%num_increments = num_increments
  end function bar_leg

  !> S11 = E eps, E22 = -nu eps; time and work run on over the legs.
  subroutine elastic_bar(log)
    type(test_log), intent(inout) :: log
    type(material_test) :: test
    type(path_record) :: record
    type(error_type), allocatable :: error
    test%legs = [bar_leg(1.0e-4_rk, 4, .false.), bar_leg(5.0e6_rk, 2, .true.)]
    test%legs(2)%duration = 3.0_rk
    call follow_path(elastic_law(young=25.0e9_rk, poisson=0.2_rk), test, record, error)
    call check(log,.not. allocated(error), 'the path is followed')
    call check(log, record%num_rows == 7 .and. size(record%time) == 7, 'a row each')
    call check_close(log, record%time(6), 2.5_rk, 1.0e-14_rk, 'time')
    call check_close(log, record%state%stress(1, 3), 1.25e6_rk, 1.0e-3_rk, 'E eps')
    call check_close(log, record%state%strain(2, 5), -2.0e-5_rk, 1.0e-16_rk, '-nu eps')
    call check_close(log, record%state%strain(1, 7), 2.0e-4_rk, 1.0e-13_rk, 'stress control')
    call check_close(log, record%work(7), 500.0_rk, 1.0e-6_rk, 'S eps / 2')
    call check_close(log, record%state%energy(stored_energy, 7), 500.0_rk, 1.0e-6_rk, 'stored')
    call check(log, all(record%leg == [0, 1, 1, 1, 1, 2, 2]), 'legs')
  end subroutine elastic_bar

  !> S22 follows S11 by a ratio while E11 is prescribed: eps_11 = (1 - nu r) S11/E.
  subroutine stress_ratio(log)
    type(test_log), intent(inout) :: log
    type(material_test) :: test
    type(path_record) :: record
    type(error_type), allocatable :: error
    test%legs = [bar_leg(-1.0e-3_rk, 3, .false.)]
    test%legs(1)%share(2) = 0.52_rk
    call follow_path(elastic_law(young=25.0e9_rk, poisson=0.2_rk), test, record, error)
    call check_close(log, record%state%stress(1, 4), -25.0e6_rk/(1.0_rk - 0.104_rk), 1.0_rk, &
                     'S11 of a ratio')
    call check_close(log, record%state%stress(2, 4)/record%state%stress(1, 4), 0.52_rk, &
                     1.0e-8_rk, 'the ratio')
  end subroutine stress_ratio

  !> A constant strain and a constant stress keep their values when others change.
  subroutine held_components(log)
    type(test_log), intent(inout) :: log
    type(material_test) :: test
    type(path_record) :: record
    type(error_type), allocatable :: error
    test%legs = [bar_leg(1.0e-4_rk, 1, .false.), bar_leg(0.0_rk, 2, .false.)]
    test%legs(2)%is_stress = [.true., .false., .true., .true., .false., .true.]
    test%legs(2)%is_held = .true.
    test%legs(2)%is_held(5) = .false.
    test%legs(2)%target(5) = 2.0e-4_rk
    call follow_path(elastic_law(young=25.0e9_rk, poisson=0.2_rk), test, record, error)
    call check_close(log, record%state%stress(1, 4), 2.5e6_rk, 1.0e-2_rk, 'held stress')
    call check_close(log, record%state%strain(2, 4), -2.0e-5_rk, 1.0e-16_rk, 'held strain')
    call check_close(log, record%state%stress(5, 4), 2.0e-4_rk*25.0e9_rk/2.4_rk, 1.0e-2_rk, &
                     'G gamma')
  end subroutine held_components

  !> Past yield the slope is E H/(E + H); the work is stored or dissipated. The trapezoidal rule is
  !> exact on straight branches but for the increment with the corner.
  subroutine hardening_bar(log)
    type(test_log), intent(inout) :: log
    type(material_test) :: test
    type(path_record) :: record
    type(error_type), allocatable :: error
    type(metal) :: law
    real(rk) :: young, expected
    law%num_state = 7
    law%is_nonlinear = .true.
    young = law%young()
    test%legs = [bar_leg(0.01_rk, 200, .false.), bar_leg(0.0_rk, 7, .true.), &
                 bar_leg(500.0e6_rk, 50, .true.)]
    call follow_path(law, test, record, error)
    call check(log,.not. allocated(error), 'hardening is followed')
    expected = law%yield + young*law%slope/(young + law%slope)*(0.01_rk - law%yield/young)
    call check_close(log, record%state%stress(1, 201)/expected, 1.0_rk, 1.0e-8_rk, 'hardening')
    call check_close(log, record%state%stress(1, 208)/expected, 0.0_rk, 1.0e-8_rk, 'unloaded')
    call check_close(log, record%state%strain(1, 208), 0.01_rk - expected/young, 1.0e-12_rk, &
                     'what stays')
    expected = 0.01_rk + (500.0e6_rk - expected)*(1.0_rk/young + 1.0_rk/law%slope) + expected/young
    expected = expected - record%state%stress(1, 201)/young
    call check_close(log, record%state%strain(1, 258), expected, 1.0e-10_rk, 'stress control')
    associate (e => record%state%energy)
      call check_close(log, (e(stored_energy, 258) + e(fracture_energy, 258))/record%work(258), &
                       1.0_rk, 1.0e-4_rk, 'energies')
    end associate
  end subroutine hardening_bar

  !> A falling branch under strain control, with free sides.
  subroutine softening_bar(log)
    type(test_log), intent(inout) :: log
    type(material_test) :: test
    type(path_record) :: record
    type(error_type), allocatable :: error
    type(metal) :: law
    real(rk) :: young, expected
    law%num_state = 7
    law%slope = -20.0e9_rk
    young = law%young()
    test%legs = [bar_leg(0.008_rk, 4, .false.)]
    call follow_path(law, test, record, error)
    call check(log,.not. allocated(error), 'softening is followed')
    expected = law%yield + young*law%slope/(young + law%slope)*(0.008_rk - law%yield/young)
    call check_close(log, record%state%stress(1, 5)/expected, 1.0_rk, 1.0e-7_rk, 'softening')
  end subroutine softening_bar

  !> No strain gives a stress above the peak: the rows so far are kept, the message has the way out.
  subroutine stress_beyond_peak(log)
    type(test_log), intent(inout) :: log
    type(material_test) :: test
    type(path_record) :: record
    type(error_type), allocatable :: error
    type(metal) :: law
    law%num_state = 7
    law%slope = -20.0e9_rk
    test%name = 'PULL'
    test%driven = 1
    test%legs = [bar_leg(300.0e6_rk, 30, .true.)]
    call follow_path(law, test, record, error)
    call check(log, allocated(error), 'the path ends')
    call check(log, record%num_rows == 21 .and. size(record%state%stress, 2) == 21, 'rows so far')
    if (.not. allocated(error)) return
    call check(log, index(error%message, 'test PULL stops in leg 1, increment 21 of 30') == 1, &
               'where: '//error%message)
    call check(log, index(error%message, 'CONTROL=STRAIN') > 0, 'the way out')
    test%driven = 0 ! GENERAL
    call follow_path(law, test, record, error)
    if (.not. allocated(error)) return
    call check(log, index(error%message, '(E in place of S') > 0, 'the way out of GENERAL')
  end subroutine stress_beyond_peak

  !> With a slope of -220 GPa, between -E and -3 G, a bar turns back at yield: a strain that grows
  !> finds no stress. A strain is prescribed already, so the message speaks of LENGTH.
  subroutine strain_that_snaps_back(log)
    type(test_log), intent(inout) :: log
    type(material_test) :: test
    type(path_record) :: record
    type(error_type), allocatable :: error
    type(metal) :: law
    law%num_state = 7
    law%slope = -220.0e9_rk
    test%name = 'PULL'
    test%driven = 1
    test%legs = [bar_leg(0.002_rk, 20, .false.)]
    call follow_path(law, test, record, error)
    call check(log, allocated(error), 'the path ends where it turns back')
    if (.not. allocated(error)) return
    call check(log, index(error%message, 'turns back here: take a smaller LENGTH') > 0, &
               'the way out: '//error%message)
    call check(log, index(error%message, 'CONTROL') == 0, 'a strain is prescribed already')
  end subroutine strain_that_snaps_back

  !> A message on a test in shear has gamma and S12; the yield stress in shear is 115.5 MPa.
  subroutine softening_shear(log)
    type(test_log), intent(inout) :: log
    type(material_test) :: test
    type(path_record) :: record
    type(error_type), allocatable :: error
    type(metal) :: law
    law%num_state = 7
    law%slope = -20.0e9_rk
    test%name = 'SHEAR'
    test%driven = 4
    allocate (test%legs(1))
    test%legs(1)%is_stress = .true.
    test%legs(1)%target(4) = 150.0e6_rk
    test%legs(1)%num_increments = 30
    call follow_path(law, test, record, error)
    call check(log, allocated(error), 'shear beyond the peak')
    if (.not. allocated(error)) return
    call check(log, index(error%message, '(gamma 12 0.001443') > 0 .and. &
               index(error%message, ', S12 1.1547e8 before it)') > 0, &
               'components of shear: '//error%message)
  end subroutine softening_shear

  !> Increments are cut on request of a law; the rows are those of the test.
  subroutine small_increments(log)
    type(test_log), intent(inout) :: log
    type(material_test) :: test
    type(path_record) :: record, plain
    type(error_type), allocatable :: error
    type(metal) :: law
    law%num_state = 7
    test%legs = [bar_leg(0.01_rk, 10, .false.)]
    call follow_path(law, test, plain, error)
    law%largest_change = 0.0003_rk
    call follow_path(law, test, record, error)
    call check(log,.not. allocated(error), 'cut and followed')
    call check(log, record%num_rows == 11, 'rows')
    call check(log, sum(record%iterations) > 2*sum(plain%iterations), 'more calls')
    call check_close(log, record%state%stress(1, 11)/plain%state%stress(1, 11), 1.0_rk, &
                     1.0e-8_rk, 'same stress: the path is radial')
    call check_close(log, record%time(11), 1.0_rk, 1.0e-14_rk, 'time')
  end subroutine small_increments
end program test_material_path
