!> Curves over plastic strain: the rows of Table 1, openings, snap-back, tables of pure damage.
program test_damage_curves
  use concrete_model, only: lee_fenves, table_one
  use damage_constants, only: concrete_constants
  use damage_curves, only: curve_value, make_compression_curve, make_tension_curve, place_knots, &
                           smallest_strength, strength_curve, value_of_curve
  use kinds, only: rk
  use testing, only: check, check_close, test_log
  implicit none
  real(rk), parameter :: roundoff = 1.0e-13_rk !< a few operations
  type(test_log) :: log
  log%suite = 'damage_curves'
  call rows_of_table_one()
  call slopes()
  call openings()
  call energy_with_damage()
  call steep_between_rows()
  call lowered_strength()
  call united_rows()
  call pure_damage()
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> Plastic strains of Table 1 to the five decimals of paper_notes.md, 11; strength at the rows.
  subroutine rows_of_table_one()
    real(rk), parameter :: plastic(8) = 1.0e-3_rk*[0.0_rk, 0.15578_rk, 0.28843_rk, 0.41757_rk, &
                                                   0.67392_rk, 0.93020_rk, 1.18263_rk, 1.48298_rk]
    type(concrete_constants) :: concrete
    type(strength_curve) :: curve
    type(curve_value) :: value
    real(rk) :: knots(8), factor
    integer :: i, row
    concrete = table_one()
    call make_tension_curve(concrete, curve)
    call place_knots(curve, 1.0_rk, knots, factor)
    row = 1
    do i = 1, 8
      call check_close(log, knots(i), plastic(i), 0.6e-8_rk, 'plastic strain')
      call value_of_curve(curve, knots, factor, knots(i), row, value)
      call check_close(log, value%damage, concrete%tension_damage(1, i), roundoff, 'damage')
      call check_close(log, value%strength*(1.0_rk - value%damage), concrete%tension(1, i), &
                       roundoff*2.48e6_rk, 'nominal strength')
    end do
    call value_of_curve(curve, knots, factor, 1.0_rk, row, value)
    call check_close(log, value%strength, 0.169e6_rk/0.036_rk, 1.0e-6_rk, 'past the last row')
    call check_close(log, value%strength_slope, 0.0_rk, 0.0_rk, 'constant past the last row')
    call value_of_curve(curve, knots, factor, 0.5_rk*knots(2), row, value)
    call check_close(log, value%damage, 0.1795_rk, roundoff, 'damage half-way, going back')
  end subroutine rows_of_table_one

  !> Derivatives against central differences (error of order step^2, here below 1e-7).
  subroutine slopes()
    type(strength_curve) :: curve
    type(curve_value) :: value, above, below
    real(rk) :: factor, plastic, step
    real(rk), allocatable :: knots(:)
    integer :: i, row
    call make_compression_curve(lee_fenves(), curve)
    allocate (knots(size(curve%abscissa)))
    call place_knots(curve, 1.0_rk, knots, factor)
    do i = 1, size(knots) - 1, 7
      plastic = 0.3_rk*knots(i) + 0.7_rk*knots(i + 1)
      step = 1.0e-4_rk*(knots(i + 1) - knots(i))
      row = 1
      call value_of_curve(curve, knots, factor, plastic, row, value)
      call value_of_curve(curve, knots, factor, plastic + step, row, above)
      call value_of_curve(curve, knots, factor, plastic - step, row, below)
      call check_close(log, value%strength_slope, &
                       (above%strength - below%strength)/(2.0_rk*step), &
                       1.0e-7_rk*31.7e9_rk, 'slope of the strength')
      call check_close(log, value%damage_slope, (above%damage - below%damage)/(2.0_rk*step), &
                       1.0e-7_rk*value%damage_slope, 'slope of the damage')
    end do
  end subroutine slopes

  !> Openings are divided by the length, the recoverable part is not.
  subroutine openings()
    type(concrete_constants) :: concrete
    type(strength_curve) :: curve
    real(rk) :: strain_knots(8), factor
    real(rk), allocatable :: knots(:)
    concrete = table_one()
    call make_tension_curve(concrete, curve)
    call place_knots(curve, 1.0_rk, strain_knots, factor)
    concrete%stiffening = 'DISPLACEMENT'
    concrete%tension_damage_type = 'DISPLACEMENT'
    concrete%tension(2, :) = 0.5_rk*concrete%tension(2, :)
    concrete%tension_damage(2, :) = 0.5_rk*concrete%tension_damage(2, :)
    call make_tension_curve(concrete, curve)
    allocate (knots(size(curve%abscissa)))
    call place_knots(curve, 0.5_rk, knots, factor)
    ! Parts of 1/32 of f_t and of a damage of 1 between the rows of Table 1.
    call check(log, size(knots) == 1 + 21 + 9 + 5 + 4 + 2 + 1 + 1, 'knots between the rows')
    call check_close(log, maxval(abs(knots([1, 22, 31, 36, 40, 42, 43, 44]) - strain_knots)), &
                     0.0_rk, roundoff, 'w over l')
    ! 25 GPa: the first branch loses 1.622 MPa over 0.0875 mm.
    call check_close(log, curve%longest, 0.0875e-3_rk*25.0e9_rk/1.622e6_rk, roundoff, 'longest')
    call check(log, curve%steepest <= 22, 'the first branch is the steepest')
  end subroutine openings

  !> Linear softening with damage keeps its fracture energy: work over the openings w = l (eps_pl +
  !> c) from f_t to the end, by the trapezoidal rule in 1000 parts of each interval (error 1e-6).
  subroutine energy_with_damage()
    type(concrete_constants) :: concrete
    type(strength_curve) :: curve
    type(curve_value) :: value
    real(rk), allocatable :: knots(:)
    real(rk) :: factor, length, work, plastic, opening, stress, before(2)
    integer :: i, k, part, row
    concrete = table_one()
    concrete%stiffening = 'GFI'
    concrete%tension_damage_type = 'DISPLACEMENT'
    concrete%tension = reshape([2.48e6_rk, 200.0_rk], [2, 1])
    concrete%tension_damage = reshape([0.0_rk, 0.0_rk, 0.9_rk, 400.0_rk/2.48e6_rk], [2, 2])
    call make_tension_curve(concrete, curve)
    allocate (knots(size(curve%abscissa)))
    do k = 0, 3
      length = 0.5_rk**k*curve%longest
      call place_knots(curve, length, knots, factor)
      row = 1
      work = 0.0_rk
      before = [0.0_rk, 2.48e6_rk]
      do i = 2, size(knots)
        do part = 1, 1000
          plastic = knots(i - 1) + (knots(i) - knots(i - 1))*part/1000
          call value_of_curve(curve, knots, factor, plastic, row, value)
          stress = value%strength*(1.0_rk - value%damage)
          opening = length*(plastic + value%damage*value%strength/concrete%young)
          work = work + 0.5_rk*(stress + before(2))*(opening - before(1))
          before = [opening, stress]
        end do
      end do
      ! Some 30 knots leave up to 0.2 %.
      call check_close(log, work, 200.0_rk, 0.6_rk, 'fracture energy with damage')
    end do
  end subroutine energy_with_damage

  !> In the widest band the curve is straight over the opening, also where d/(1 - d) sigma grows
  !> faster and faster towards a row: E w/(d/(1 - d) sigma) of this row is too wide.
  subroutine steep_between_rows()
    type(concrete_constants) :: concrete
    type(strength_curve) :: curve
    type(curve_value) :: value
    real(rk), allocatable :: knots(:)
    real(rk) :: factor, opening, worst
    integer :: i, row
    concrete = table_one()
    concrete%stiffening = 'DISPLACEMENT'
    concrete%tension_damage_type = 'DISPLACEMENT'
    concrete%tension = reshape([2.5e6_rk, 0.0_rk, 1.0e6_rk, 0.2e-3_rk, 0.0_rk, 0.4e-3_rk], [2, 3])
    concrete%tension_damage = reshape([0.0_rk, 0.0_rk, 0.8_rk, 0.2e-3_rk], [2, 2])
    call make_tension_curve(concrete, curve)
    ! The row: 25 GPa 0.2 mm/4 MPa = 1.25 m. The slope of w/(5/4 0.2 mm - w) (2.5 MPa - 7.5 GPa/m w)
    ! at its end is 70 GPa/m, that of the last of 26 intervals 61.7 GPa/m.
    call check_close(log, curve%longest, 1.25_rk, 1.0e-12_rk, 'the rows alone')
    associate (straight => curve%longest_straight)
      call check_close(log, straight, 25.0_rk/61.6667_rk, 1.0e-5_rk, 'slope before a row')
    end associate
    allocate (knots(size(curve%abscissa)))
    call place_knots(curve, (1.0_rk - 1.0e-6_rk)*curve%longest_straight, knots, factor)
    worst = 0.0_rk
    row = 1
    do i = 1, size(knots)
      if (curve%abscissa(i) > 0.2e-3_rk) exit
      call value_of_curve(curve, knots, factor, knots(i), row, value)
      opening = curve%longest_straight*(knots(i) + value%damage*value%strength/concrete%young)
      worst = max(worst, abs(value%strength*(1.0_rk - value%damage) &
                             - (2.5e6_rk - 7.5e9_rk*opening)))
    end do
    call check_close(log, worst, 0.0_rk, 1.0e-5_rk*2.5e6_rk, 'straight over the opening')
  end subroutine steep_between_rows

  !> Snap-back lengths (verification.md); in a band of four times that length half the strength with
  !> the same energy.
  subroutine lowered_strength()
    type(concrete_constants) :: concrete
    type(strength_curve) :: curve
    type(curve_value) :: value
    real(rk) :: knots(2), factor, energy
    integer :: row
    concrete = table_one()
    deallocate (concrete%tension_damage)
    concrete%stiffening = 'GFI'
    concrete%tension = reshape([2.48e6_rk, 200.0_rk], [2, 1])
    call make_tension_curve(concrete, curve)
    ! 2 E G_f/f_t^2, printed with four digits in verification.md.
    call check_close(log, curve%longest, 1.626_rk, 0.5e-3_rk, 'snap-back length')
    call place_knots(curve, 4.0_rk*curve%longest, knots, factor)
    call check_close(log, factor, 0.5_rk, roundoff, 'half the strength')
    row = 1
    call value_of_curve(curve, knots, factor, 0.0_rk, row, value)
    call check_close(log, value%strength, 1.24e6_rk, 1.0e-6_rk, 'strength')
    ! The straight line ends where it reaches the share s of f_t: (1 - s^2) G_f is under it.
    energy = 0.5_rk*(1.0_rk + smallest_strength)*value%strength*knots(2)*4.0_rk*curve%longest
    call check_close(log, energy, 200.0_rk*(1.0_rk - smallest_strength**2), 1.0e-9_rk, 'energy')
  end subroutine lowered_strength

  !> A row of one table only is a knot of both.
  subroutine united_rows()
    type(concrete_constants) :: concrete
    type(strength_curve) :: curve
    concrete = table_one()
    concrete%tension = concrete%tension(:, [1, 3, 8])
    concrete%tension_damage = concrete%tension_damage(:, [1, 2, 3, 7])
    call make_tension_curve(concrete, curve)
    call check(log, size(curve%abscissa) == 5, 'union of rows')
    call check_close(log, curve%strength(2), 2.48e6_rk - 1.935e6_rk*175.0_rk/324.0_rk, 1.0e-6_rk, &
                     'strength at a row of damage')
    call check_close(log, curve%damage(5), 0.949_rk, 0.0_rk, 'damage past its last row')
  end subroutine united_rows

  !> All inelastic strain comes back: the curve is steep, and met at the rows.
  subroutine pure_damage()
    type(concrete_constants) :: concrete
    type(strength_curve) :: curve
    type(curve_value) :: value
    real(rk) :: knots(3), factor, elastic(3)
    integer :: row
    concrete = table_one()
    concrete%tension = reshape([2.0e6_rk, 0.0_rk, 1.0e6_rk, 1.0e-3_rk, 0.1e6_rk, 5.0e-3_rk], [2, 3])
    concrete%tension_damage = concrete%tension
    elastic = concrete%tension(1, :)/25.0e9_rk
    concrete%tension_damage(1, :) = 1.0_rk - elastic/(elastic + concrete%tension(2, :))
    call make_tension_curve(concrete, curve)
    call place_knots(curve, 1.0_rk, knots, factor)
    call check(log, all(knots(2:) > knots(:2)) .and. knots(3) < 1.0e-7_rk, 'little plastic strain')
    row = 1
    call value_of_curve(curve, knots, factor, knots(2), row, value)
    call check_close(log, value%strength, 26.0e6_rk, 1.0_rk, 'effective strength E eps')
  end subroutine pure_damage
end program test_damage_curves
