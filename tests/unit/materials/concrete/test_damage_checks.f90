!> Faults of the tables of concrete: each is found, in its table and row, and good tables have none.
program test_damage_checks
  use concrete_model, only: lee_fenves, table_one
  use damage_checks, only: compression_damage_table, find_longest_band, find_table_faults, &
                           hardening_table, stiffening_table, table_fault, tension_damage_table
  use damage_constants, only: concrete_constants
  use kinds, only: rk
  use testing, only: check, check_close, test_log
  implicit none
  type(test_log) :: log
  log%suite = 'damage_checks'
  call good_tables()
  call bad_strengths()
  call bad_damages()
  call bad_together()
  call bands()
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> The one fault of the constants is this.
  subroutine expect(concrete, keyword, row, part, what)
    type(concrete_constants), intent(in) :: concrete
    character(*), intent(in) :: keyword
    integer, intent(in) :: row
    character(*), intent(in) :: part !< of the text
    character(*), intent(in) :: what
    type(table_fault), allocatable :: faults(:)
    call find_table_faults(concrete, faults)
    call check(log, size(faults) == 1, what//': one fault')
    if (size(faults) /= 1) return
    call check(log, faults(1)%keyword == keyword .and. faults(1)%row == row, what//': its place')
    associate (said => faults(1)%problem//'; expected '//faults(1)%expected)
      call check(log, index(said, part) > 0, what//': '//said)
    end associate
  end subroutine expect

  !> Nothing to say.
  subroutine good_tables()
    type(table_fault), allocatable :: faults(:)
    call find_table_faults(table_one(), faults)
    call check(log, size(faults) == 0, 'Table 1')
    call find_table_faults(lee_fenves(), faults)
    call check(log, size(faults) == 0, 'Lee and Fenves')
  end subroutine good_tables

  !> Strengths and their abscissae.
  subroutine bad_strengths()
    type(concrete_constants) :: concrete
    concrete = table_one()
    concrete%tension(1, 1) = 0.0_rk
    call expect(concrete, stiffening_table, 1, 'found 0; expected a first strength > 0', &
                'no strength')
    concrete = table_one()
    concrete%tension(1, 4) = -1.0_rk
    call expect(concrete, stiffening_table, 4, 'found -1', 'negative strength')
    concrete = table_one()
    concrete%tension(2, 1) = 1.0e-5_rk
    call expect(concrete, stiffening_table, 1, 'expected 0 in', 'starts late')
    concrete = table_one()
    concrete%tension(2, 3) = concrete%tension(2, 2)
    call expect(concrete, stiffening_table, 3, 'more than 1.75e-4', 'the same strain twice')
    concrete = table_one()
    concrete%stiffening = 'GFI'
    deallocate (concrete%tension_damage)
    concrete%tension = reshape([2.0e6_rk, 0.0_rk], [2, 1])
    call expect(concrete, stiffening_table, 1, 'G_f > 0', 'no energy')
  end subroutine bad_strengths

  !> Damages.
  subroutine bad_damages()
    type(concrete_constants) :: concrete
    concrete = table_one()
    concrete%tension_damage(1, 8) = 1.0_rk
    call expect(concrete, tension_damage_table, 8, 'below 1', 'damage of 1')
    concrete = table_one()
    concrete%tension_damage(1, 5) = 0.7_rk
    call expect(concrete, tension_damage_table, 5, '0.7 after 0.756', 'damage decreases')
    concrete = table_one()
    concrete%tension_damage(1, 1) = 0.1_rk
    call expect(concrete, tension_damage_table, 1, 'first damage of 0', 'damage at once')
    concrete = lee_fenves()
    concrete%compression_damage(1, 1) = -0.1_rk
    call expect(concrete, compression_damage_table, 1, 'first damage of 0', 'in compression')
  end subroutine bad_damages

  !> What only the tables together show.
  subroutine bad_together()
    type(concrete_constants) :: concrete
    concrete = table_one()
    concrete%compression(1, 1) = 3.0e6_rk
    ! (3 b - 2)/b = 1.2222 times 2.48 MPa
    call expect(concrete, hardening_table, 1, 'at least 3.03111e6', 'weak in compression')
    concrete = table_one()
    concrete%tension_damage(1, 6:8) = 0.9999_rk
    call expect(concrete, tension_damage_table, 6, 'does not decrease', 'plastic strain decreases')
    concrete = table_one()
    concrete%stiffening = 'DISPLACEMENT'
    call expect(concrete, tension_damage_table, 0, 'TYPE=DISPLACEMENT', 'strain and opening mixed')
  end subroutine bad_together

  !> The widest band, with the row that limits it.
  subroutine bands()
    type(concrete_constants) :: concrete
    type(table_fault) :: limit
    real(rk) :: longest
    concrete = table_one()
    call find_longest_band(concrete, longest, limit)
    call check(log, longest > 1.0e300_rk, 'no limit over strain')
    concrete%stiffening = 'DISPLACEMENT'
    concrete%tension_damage_type = 'DISPLACEMENT'
    call find_longest_band(concrete, longest, limit)
    call check_close(log, longest, 0.175e-3_rk*25.0e9_rk/1.622e6_rk, 1.0e-12_rk, 'longest')
    call check(log, limit%row == 2, 'its row')
  end subroutine bands
end program test_damage_checks
