!> The law of plastic-damage concrete at one point against closed forms: tables returned, recovery
!> of stiffness, biaxial and triaxial strength, apex, crack band, viscosity, cycles, energy.
program test_material_damage_plasticity
  use concrete_model, only: lee_fenves, table_one
  use damage_constants, only: concrete_constants
  use errors, only: error_type
  use kinds, only: rk
  use material_damage_plasticity, only: concrete_law, make_concrete_law
  use material_law, only: start_points
  use material_points, only: crushing_energy, fracture_energy, no_tangent, point_set, &
                             point_state, stored_energy, time_increment, update_report
  use testing, only: check, check_close, test_log
  implicit none
  real(rk), parameter :: alpha = 0.1_rk, gamma = 3.0_rk !< of Table 1's concrete
  real(rk), parameter :: one(3) = [1.0_rk, 1.0_rk, 1.0_rk]

  !> A law, one point of it and its state.
  type :: specimen
    type(concrete_law) :: law
    type(point_set) :: points
    type(point_state) :: state
  end type specimen

  type(test_log) :: log
  log%suite = 'material_damage_plasticity'
  call rows_of_table_one('LEE-FENVES')
  call rows_of_table_one('ENERGY')
  call recovery(0.0_rk, 1.0_rk, 'LEE-FENVES')
  call recovery(0.0_rk, 0.0_rk, 'LEE-FENVES')
  call recovery(0.5_rk, 0.5_rk, 'LEE-FENVES')
  call recovery(1.0_rk, 1.0_rk, 'LEE-FENVES')
  call recovery(0.0_rk, 1.0_rk, 'ENERGY')
  call recovery(0.0_rk, 0.0_rk, 'ENERGY')
  call recovery(0.0_rk, 0.5_rk, 'ENERGY')
  call biaxial_strength()
  call triaxial_strength()
  call apex()
  call crack_bands()
  call relaxation()
  call cycles('LEE-FENVES')
  call cycles('ENERGY')
  call energy('LEE-FENVES')
  call energy('ENERGY')
  call what_it_reports()
  call held_switch()
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> One point with a brick of these edges around it [m].
  subroutine make_point(concrete, edges, body)
    type(concrete_constants), intent(in) :: concrete
    real(rk), intent(in) :: edges(3)
    type(specimen), intent(out) :: body
    type(error_type), allocatable :: error
    integer :: i
    call make_concrete_law(concrete, body%law, error)
    call check(log,.not. allocated(error), 'law made')
    associate (points => body%points)
      points%num_points = 1
      points%element = [1]
      points%number = [1]
      allocate (points%x(3, 1), points%edges(3, 3, 1), source=0.0_rk)
      do i = 1, 3
        points%edges(i, i, 1) = edges(i)
      end do
      points%widest = [maxval(edges)]
      points%length = [product(edges)**(1.0_rk/3.0_rk)]
    end associate
    call start_points(body%law, body%points, body%state)
  end subroutine make_point

  !> An increment of a second that ends at this strain.
  subroutine move(body, strain)
    type(specimen), intent(inout) :: body
    real(rk), intent(in) :: strain(6)
    type(point_state) :: new
    type(time_increment) :: time
    type(update_report) :: report
    real(rk) :: tangent(6, 6, 0)
    time%tangent = no_tangent
    new = body%state
    new%strain(:, 1) = strain
    call body%law%update(body%points, time, body%state, new, tangent, report)
    if (report%failed_point > 0) call check(log, .false., 'the update ends')
    body%state = new
  end subroutine move

  !> An increment to a strain along the first one or two axes with no stress along the others, whose
  !> strain is found by bisection.
  subroutine pull(body, strain, num_axes)
    type(specimen), intent(inout) :: body
    real(rk), intent(in) :: strain
    integer, intent(in) :: num_axes
    type(specimen) :: trial
    real(rk) :: low, high, strains(6)
    integer :: i
    low = -0.05_rk
    high = 0.05_rk
    strains = 0.0_rk
    strains(:num_axes) = strain
    do i = 1, 120
      strains(num_axes + 1:3) = 0.5_rk*(low + high)
      if (strains(3) <= low .or. strains(3) >= high) exit
      trial = body
      call move(trial, strains)
      if (trial%state%stress(3, 1) > 0.0_rk) then
        high = strains(3)
      else
        low = strains(3)
      end if
    end do
    body = trial
  end subroutine pull

  !> A bar torn in eight steps returns the rows of Table 1; bisection leaves 1e-18 of strain, far
  !> below a pascal.
  subroutine rows_of_table_one(closing)
    character(*), intent(in) :: closing !< RECOVERY
    type(concrete_constants) :: concrete
    type(specimen) :: body
    integer :: i
    concrete = table_one()
    concrete%recovery = closing
    call make_point(concrete, one, body)
    do i = 1, 8
      call pull(body, concrete%tension(2, i) + concrete%tension(1, i)/concrete%young, 1)
      call check_close(log, body%state%stress(1, 1), concrete%tension(1, i), 1.0_rk, &
                       'row of Table 1, '//closing)
      call check_close(log, body%state%internal(9, 1), concrete%tension_damage(1, i), 1.0e-9_rk, &
                       'its damage')
    end do
  end subroutine rows_of_table_one

  !> Slopes in unloading, in compression after cracking and in tension after crushing (Eqs. 15-16):
  !> differences of two elastic states, exact. With RECOVERY=ENERGY the last is exact for w_t = 0.
  subroutine recovery(w_t, w_c, closing)
    real(rk), intent(in) :: w_t, w_c
    character(*), intent(in) :: closing !< RECOVERY
    type(concrete_constants) :: concrete
    type(specimen) :: body
    real(rk) :: d_t, d_c, e, rest
    concrete = lee_fenves()
    concrete%recovery = closing
    concrete%tension_recovery = w_t
    concrete%compression_recovery = w_c
    e = concrete%young
    call make_point(concrete, one, body)
    call pull(body, 1.0e-3_rk, 1)
    d_t = body%state%internal(9, 1)
    call check(log, d_t > 0.15_rk, 'cracked')
    rest = body%state%internal(1, 1)
    call check_close(log, body%state%stress(1, 1), (1.0_rk - d_t)*e*(1.0e-3_rk - rest), &
                     1.0_rk, 'stress at the turn')
    call pull(body, rest + 1.0e-5_rk, 1)
    call check_close(log, body%state%stress(1, 1), (1.0_rk - d_t)*e*1.0e-5_rk, 1.0e-2_rk, &
                     'unloading')
    call pull(body, rest - 1.0e-5_rk, 1)
    call check_close(log, body%state%stress(1, 1), &
                     -(1.0_rk - (1.0_rk - w_c)*d_t)*e*1.0e-5_rk, 1.0e-2_rk, 'closed crack')
    call pull(body, -2.0e-3_rk, 1)
    d_c = body%state%internal(10, 1)
    call check(log, d_c > 0.2_rk, 'crushed')
    call check_close(log, body%state%internal(9, 1), d_t, 1.0e-12_rk, 'no more cracking')
    rest = body%state%internal(1, 1)
    call pull(body, rest - 1.0e-5_rk, 1)
    call check_close(log, body%state%stress(1, 1), &
                     -(1.0_rk - (1.0_rk - w_c)*d_t)*(1.0_rk - d_c)*e*1.0e-5_rk, 1.0e-2_rk, &
                     'unloading from compression')
    call pull(body, rest + 1.0e-5_rk, 1)
    call check_close(log, body%state%stress(1, 1), &
                     (1.0_rk - d_t)*(1.0_rk - (1.0_rk - w_t)*d_c)*e*1.0e-5_rk, 1.0e-2_rk, &
                     'tension after crushing')
  end subroutine recovery

  !> f_b0 = 1.125 f_c0 in equal biaxial compression, f_c0 in one direction.
  subroutine biaxial_strength()
    type(specimen) :: body
    call make_point(table_one(), one, body)
    call pull(body, -3.0e-3_rk, 1)
    call check_close(log, body%state%stress(1, 1), -30.0e6_rk, 1.0_rk, 'f_c0')
    call make_point(table_one(), one, body)
    call pull(body, -3.0e-3_rk, 2)
    call check_close(log, body%state%stress(1, 1), -1.125_rk*30.0e6_rk, 1.0_rk, 'f_b0')
    call check_close(log, body%state%stress(2, 1), -1.125_rk*30.0e6_rk, 1.0_rk, 'both ways')
  end subroutine biaxial_strength

  !> q over p on both meridians, Eq. 19 with s_1 < 0: s_1 = -p + q/3 in triaxial compression (two
  !> equal larger values), -p + 2 q/3 in triaxial extension.
  subroutine triaxial_strength()
    type(specimen) :: body
    real(rk) :: p, q, axial, lateral
    integer :: i
    do i = 1, 2
      call make_point(table_one(), one, body)
      axial = merge(-8.0e-3_rk, 2.0e-3_rk, i == 1)
      lateral = merge(1.0e-3_rk, -3.0e-3_rk, i == 1)
      call move(body, [axial, lateral, lateral, 0.0_rk, 0.0_rk, 0.0_rk])
      p = -sum(body%state%stress(1:3, 1))/3.0_rk
      q = abs(body%state%stress(1, 1) - body%state%stress(2, 1))
      call check(log, maxval(body%state%stress(1:3, 1)) < -1.0e6_rk, 'compression all round')
      call check_close(log, q*(1.0_rk + i*gamma/3.0_rk), &
                       (3.0_rk*alpha + gamma)*p + (1.0_rk - alpha)*30.0e6_rk, 1.0e-2_rk, 'meridian')
    end do
  end subroutine triaxial_strength

  !> Hydrostatic tension of concrete that does not soften: (1 - alpha) c/(3 alpha + beta), beta by
  !> Eq. 23; all that is more is plastic strain, equal in all directions, and stays so in large
  !> increments and with a touch of shear.
  subroutine apex()
    type(concrete_constants) :: concrete
    type(specimen) :: body
    real(rk) :: limit, beta, elastic
    concrete = table_one()
    deallocate (concrete%tension_damage)
    concrete%tension = concrete%tension(:, :1)
    beta = 30.0_rk/2.48_rk*(1.0_rk - alpha) - (1.0_rk + alpha)
    limit = (1.0_rk - alpha)*30.0e6_rk/(3.0_rk*alpha + beta)
    elastic = limit*(1.0_rk - 2.0_rk*concrete%poisson)/concrete%young
    call make_point(concrete, one, body)
    call move(body, [1.0e-3_rk, 1.0e-3_rk, 1.0e-3_rk, 0.0_rk, 0.0_rk, 0.0_rk])
    call check_close(log, maxval(abs(body%state%stress(1:3, 1) - limit)), 0.0_rk, 1.0e-2_rk, 'apex')
    call check_close(log, maxval(abs(body%state%internal(1:3, 1) - 1.0e-3_rk + elastic)), 0.0_rk, &
                     1.0e-12_rk, 'plastic strain at the apex')
    call move(body, [2.0e-2_rk, 2.0e-2_rk, 2.0e-2_rk, 1.0e-9_rk, 0.0_rk, 0.0_rk])
    call check_close(log, body%state%stress(1, 1), limit, 1.0e-4_rk*limit, 'beside the apex')
  end subroutine apex

  !> The width of the band is the edge across the crack: a brick of 0.3 x 0.3 x 0.8 m.
  subroutine crack_bands()
    type(concrete_constants) :: concrete
    type(specimen) :: body
    concrete = table_one()
    deallocate (concrete%tension_damage)
    concrete%stiffening = 'GFI'
    concrete%tension = reshape([2.48e6_rk, 150.0_rk], [2, 1])
    call make_point(concrete, [0.8_rk, 0.3_rk, 0.3_rk], body)
    call pull(body, 0.5e-4_rk, 1)
    call check_close(log, body%state%internal(11, 1), 0.0_rk, 0.0_rk, 'no band before the crack')
    ! Linear softening: sigma = f_t (1 - w/w_u), w = l eps_p, and eps = sigma/E + eps_p.
    call pull(body, 1.1e-4_rk, 1)
    call check_close(log, body%state%internal(11, 1), 0.8_rk, 1.0e-12_rk, 'the long edge')
    call check_close(log, body%state%stress(1, 1), softened(0.8_rk), 1.0_rk, 'along the brick')
    call make_point(concrete, [0.3_rk, 0.3_rk, 0.8_rk], body)
    call pull(body, 1.1e-4_rk, 1)
    call check_close(log, body%state%internal(11, 1), 0.3_rk, 1.0e-12_rk, 'the short edge')
    call check_close(log, body%state%stress(1, 1), softened(0.3_rk), 1.0_rk, 'across the brick')
  end subroutine crack_bands

  !> Stress of linear softening at a strain of 1.1e-4 in a band of this width; the line ends at
  !> w_u = 2 G_f/f_t.
  pure real(rk) function softened(width)
    real(rk), intent(in) :: width
    real(rk), parameter :: f = 2.48e6_rk, opening = 2.0_rk*150.0_rk/f
    softened = (f - f*width/opening*1.1e-4_rk)/(1.0_rk - f*width/opening/25.0e9_rk)
  end function softened

  !> With viscosity: the first increment takes a share dt/(eta + dt) of the plastic strain; at rest
  !> the stress falls to the law without viscosity by the factor eta/(eta + dt) each time.
  subroutine relaxation()
    type(concrete_constants) :: concrete
    type(specimen) :: body, quick
    real(rk) :: strain(6), excess(2)
    integer :: i
    concrete = table_one()
    strain = [4.0e-4_rk, -1.0e-5_rk, 0.0_rk, 1.0e-5_rk, 0.0_rk, 0.0_rk]
    call make_point(concrete, one, quick)
    call move(quick, strain)
    concrete%viscosity = 3.0_rk
    call make_point(concrete, one, body)
    call check(log, body%law%num_state == 17, 'a backbone')
    call move(body, strain)
    call check_close(log, maxval(abs(body%state%internal(1:6, 1) &
                                     - 0.25_rk*quick%state%internal(1:6, 1))), 0.0_rk, 1.0e-15_rk, &
                     'a quarter of the plastic strain')
    call check_close(log, body%state%internal(9, 1), 0.25_rk*quick%state%internal(9, 1), &
                     1.0e-12_rk, 'a quarter of the damage')
    excess(1) = body%state%internal(1, 1) - quick%state%internal(1, 1)
    do i = 1, 10
      call move(body, strain)
    end do
    excess(2) = body%state%internal(1, 1) - quick%state%internal(1, 1)
    call check_close(log, excess(2), 0.75_rk**10*excess(1), 1.0e-15_rk, 'relaxation')
  end subroutine relaxation

  !> A hundred cycles between a crack and compression below the strength: after the first nothing
  !> changes.
  subroutine cycles(closing)
    character(*), intent(in) :: closing !< RECOVERY
    type(concrete_constants) :: concrete
    type(specimen) :: body
    real(rk) :: first(2), last(2)
    integer :: i
    concrete = table_one()
    concrete%recovery = closing
    call make_point(concrete, one, body)
    do i = 1, 100
      call pull(body, 5.0e-4_rk, 1)
      last(1) = body%state%stress(1, 1)
      call pull(body, -5.0e-4_rk, 1)
      last(2) = body%state%stress(1, 1)
      if (i == 1) first = last
    end do
    call check(log, first(1) > 0.0_rk .and. first(2) < -1.0e6_rk, 'tension and compression')
    call check_close(log, maxval(abs(last/first - 1.0_rk)), 0.0_rk, 1.0e-9_rk, 'drift')
  end subroutine cycles

  !> Energy of a bar torn in 400 increments: stored and dissipated are the work done, by the
  !> trapezoidal rule 2e-4 of it; the rule for the work of damage is of second order too.
  subroutine energy(closing)
    character(*), intent(in) :: closing !< RECOVERY
    type(concrete_constants) :: concrete
    type(specimen) :: body
    real(rk) :: work, before
    integer :: i
    concrete = table_one()
    concrete%recovery = closing
    call make_point(concrete, one, body)
    work = 0.0_rk
    do i = 1, 400
      before = body%state%stress(1, 1)
      call pull(body, 1.6e-3_rk*i/400, 1)
      work = work + 0.5_rk*(before + body%state%stress(1, 1))*1.6e-3_rk/400
    end do
    associate (found => body%state%energy(:, 1))
      call check_close(log, sum(found), work, 2.0e-3_rk*work, 'work is stored or dissipated')
      call check_close(log, found(stored_energy), 0.5_rk*body%state%stress(1, 1) &
                       *(1.6e-3_rk - body%state%internal(1, 1)), 1.0e-6_rk, 'stored')
      call check(log, found(crushing_energy) < 1.0e-9_rk*found(fracture_energy), 'all by cracking')
    end associate
  end subroutine energy

  !> Flags, fields, and an error for tables at fault.
  subroutine what_it_reports()
    type(concrete_constants) :: concrete
    type(specimen) :: body
    type(error_type), allocatable :: error
    real(rk), allocatable :: field(:, :)
    call make_point(table_one(), one, body)
    call pull(body, 0.9e-4_rk, 1)
    call check(log, body%state%is_elastic(1), 'elastic before the peak')
    call pull(body, 2.0e-4_rk, 1)
    call check(log,.not. body%state%is_elastic(1), 'not behind it')
    call pull(body, 0.0_rk, 1)
    call check(log,.not. body%state%is_elastic(1), 'nor when unloaded')
    call body%law%read_field('DAMAGET', body%state, field)
    call check_close(log, field(1, 1), body%state%internal(9, 1), 0.0_rk, 'DAMAGET')
    call body%law%read_field('PE', body%state, field)
    call check(log, size(field, 1) == 6 .and. field(1, 1) > 1.0e-5_rk, 'PE')
    call body%law%read_field('OTHER', body%state, field)
    call check(log,.not. allocated(field), 'no other field')
    concrete = table_one()
    concrete%tension(1, 1) = -1.0_rk
    call make_concrete_law(concrete, body%law, error)
    call check(log, allocated(error), 'tables at fault')
  end subroutine what_it_reports

  !> Cracked, then pressed in one go: with w_c = 1 the switch of Eq. 17 gives back E_0 at once;
  !> held, it leaves (1 - d_t) of the same effective stress for this increment. An undamaged point
  !> does not hold it.
  subroutine held_switch()
    type(concrete_constants) :: concrete
    type(specimen) :: body
    type(point_state) :: closed, held
    type(time_increment) :: time
    type(update_report) :: report
    real(rk) :: tangent(6, 6, 0), cracked(6), pressed(6), left
    concrete = table_one()
    concrete%recovery = 'SIGN'
    call make_point(concrete, one, body)
    call check(log, body%law%has_switch, 'the law has a switch')
    cracked = [4.0e-4_rk, 0.0_rk, 0.0_rk, 0.0_rk, 0.0_rk, 0.0_rk]
    pressed = -0.25_rk*cracked
    time%tangent = no_tangent
    time%holds_switches = .true.
    held = body%state
    held%strain(:, 1) = cracked
    call body%law%update(body%points, time, body%state, held, tangent, report)
    call move(body, cracked)
    call check_close(log, held%stress(1, 1), body%state%stress(1, 1), 0.0_rk, &
                     'undamaged at the start')
    left = 1.0_rk - body%state%internal(9, 1)
    held = body%state
    held%strain(:, 1) = pressed
    call body%law%update(body%points, time, body%state, held, tangent, report)
    time%holds_switches = .false.
    closed = body%state
    closed%strain(:, 1) = pressed
    call body%law%update(body%points, time, body%state, closed, tangent, report)
    call check(log, left < 0.5_rk .and. closed%stress(1, 1) < -1.0e6_rk, 'cracked and pressed')
    call check_close(log, held%stress(1, 1), left*closed%stress(1, 1), 1.0e-6_rk, 'held')
  end subroutine held_switch
end program test_material_damage_plasticity
