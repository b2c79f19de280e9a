!> Random strain paths of several concretes: no failure, no NaN, no energy from nothing.
!>
!> usage: test_damage_paths [PATHS] (20 000 unless given, shared between the concretes)
program test_damage_paths
  use concrete_paths, only: path_counts, run_paths
  use concrete_model, only: lee_fenves, table_one
  use damage_constants, only: concrete_constants
  use damage_model, only: concrete_model, largest_safe_dilation, make_concrete_model
  use kinds, only: rk
  use testing, only: check, repeat_chance, test_log
  implicit none
  integer, parameter :: num_concretes = 12
  real(rk), parameter :: degree = acos(-1.0_rk)/180.0_rk
  type(test_log) :: log
  type(concrete_constants) :: concrete
  integer :: num_paths
  log%suite = 'damage_paths'
  num_paths = wanted_paths()/num_concretes
  call repeat_chance(1)
  call try(table_one(), 'Table 1')
  call try(damaged(lee_fenves()), 'damage to 0.99')
  concrete = damaged(lee_fenves())
  concrete%recovery = 'SIGN'
  concrete%tension_recovery = 0.5_rk
  call try(concrete, 'recovery by sign')
  concrete = damaged(lee_fenves())
  concrete%recovery = 'ENERGY'
  call try(concrete, 'recovery by energy')
  concrete = table_one()
  concrete%recovery = 'ENERGY'
  concrete%poisson = 0.3_rk
  call try(concrete, 'recovery by energy, nu 0.3')
  concrete = damaged(lee_fenves())
  concrete%biaxial_ratio = 1.0_rk
  concrete%meridian_ratio = 0.52_rk
  call try(concrete, 'alpha 0, K_c 0.52')
  concrete%biaxial_ratio = 1.3_rk
  concrete%meridian_ratio = 1.0_rk
  concrete%dilation = 25.0_rk
  call try(concrete, 'f_b0/f_c0 1.3, K_c 1')
  concrete = fracture_energy()
  call try(concrete, 'G_f without damage')
  concrete%dilation = 0.1_rk
  concrete%offset = 1.0e-4_rk
  call try(concrete, 'dilation 0.1, offset 1e-4')
  concrete = fracture_energy()
  concrete%tension(2, 1) = 20.0_rk
  call try(concrete, 'band wider than G_f allows')
  concrete = table_one()
  concrete%compression = reshape([30.0e6_rk, 0.0_rk, 0.1e6_rk, 5.0e-3_rk], [2, 2])
  call try(concrete, 'crushed to nothing')
  concrete = pure_damage()
  call try(concrete, 'damage without plastic strain')
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> The number on the command line.
  integer function wanted_paths()
    character(20) :: word
    integer :: status
    wanted_paths = 20000
    call get_command_argument(1, word, status=status)
    if (status == 0) read (word, *) wanted_paths
  end function wanted_paths

  !> Runs and prints.
  subroutine try(constants, what)
    type(concrete_constants), intent(in) :: constants
    character(*), intent(in) :: what
    type(concrete_model) :: model
    type(path_counts) :: counts
    logical :: is_safe
    call make_concrete_model(constants, model)
    is_safe = tan(constants%dilation*degree) <= largest_safe_dilation(constants%biaxial_ratio, &
                                                                      constants%meridian_ratio)
    call run_paths(model, num_paths, counts)
    write (*, '(2a,3(i0,a))') what, ': ', counts%paths, ' paths, ', counts%updates, ' updates, ', &
      counts%yielding, ' yielding'
    write (*, '(6(a,i0))') '  failures ', counts%failures, ', not numbers ', counts%not_numbers, &
      ', off the surface ', counts%off_surface, ', energy gains ', counts%energy_gains, &
      ', work gains ', counts%work_gains, ', bad histories ', counts%bad_histories
    write (*, '(2(a,es8.1))') '  worst residual ', counts%worst_residual, ', worst gain ', &
      counts%worst_gain
    call check(log, counts%failures + counts%not_numbers == 0, what//': each update ends')
    call check(log, counts%off_surface == 0, what//': on the yield surface')
    call check(log, counts%bad_histories == 0, what//': history moves forward')
    call check(log,.not. is_safe .or. counts%energy_gains + counts%work_gains == 0, &
               what//': dissipation')
  end subroutine try

  !> The last damage is 0.99 in tension and in compression.
  pure function damaged(whole) result(concrete)
    type(concrete_constants), intent(in) :: whole
    type(concrete_constants) :: concrete
    real(rk) :: added
    integer :: n
    concrete = whole
    n = size(whole%tension, 2)
    concrete%tension_damage(1, n) = 0.99_rk
    added = 99.0_rk*concrete%tension(1, n)/concrete%young
    concrete%tension(2, n) = concrete%tension(2, n) + added
    concrete%tension_damage(2, n) = concrete%tension(2, n)
    concrete%compression_damage(1, n) = 0.99_rk
    added = 99.0_rk*concrete%compression(1, n)/concrete%young
    concrete%compression(2, n) = concrete%compression(2, n) + added
    concrete%compression_damage(2, n) = concrete%compression(2, n)
  end function damaged

  !> Linear softening in the opening of the crack, no damage.
  pure function fracture_energy() result(concrete)
    type(concrete_constants) :: concrete
    concrete = lee_fenves()
    deallocate (concrete%tension_damage)
    concrete%stiffening = 'GFI'
    concrete%tension = reshape([3.48e6_rk, 150.0_rk], [2, 1])
  end function fracture_energy

  !> All of the cracking strain comes back.
  pure function pure_damage() result(concrete)
    type(concrete_constants) :: concrete
    real(rk) :: elastic(3)
    concrete = table_one()
    concrete%tension = reshape([2.0e6_rk, 0.0_rk, 1.0e6_rk, 1.0e-3_rk, 0.1e6_rk, 5.0e-3_rk], [2, 3])
    concrete%tension_damage = concrete%tension
    elastic = concrete%tension(1, :)/concrete%young
    concrete%tension_damage(1, :) = 1.0_rk - elastic/(elastic + concrete%tension(2, :))
  end function pure_damage
end program test_damage_paths
