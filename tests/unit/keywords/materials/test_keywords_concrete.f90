!> What the keywords of concrete make of a deck: the constants with their defaults, the law, and the
!> longest elements.
program test_keywords_concrete
  use diagnostics, only: diagnostic_list
  use kinds, only: rk
  use material_damage_plasticity, only: concrete_law
  use problem_definition, only: problem
  use read_deck, only: read_problem
  use testing, only: check, check_close, test_log
  implicit none
  character, parameter :: nl = new_line('a')
  character(*), parameter :: deck_file = 'test_keywords_concrete.inp'
  character(*), parameter :: elastic = '*ELASTIC'//nl//'25e9, 0.167'//nl
  character(*), parameter :: crushing = '*CONCRETE COMPRESSION HARDENING'//nl//'30e6, 0.'//nl
  type(test_log) :: log

  log%suite = 'keywords_concrete'
  call makes_the_law(log)
  call longest_elements(log)
  call lowers_strength(log)
  call wants_its_parts(log)
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> Reads a brick of 1 x 1 x height with a material.
  subroutine read_brick(height, properties, model, faults, echo)
    character(*), intent(in) :: height !< [m], as the deck writes it
    character(*), intent(in) :: properties !< lines of the material
    type(problem), allocatable, intent(out) :: model
    type(diagnostic_list), intent(out) :: faults
    character(:), allocatable, intent(out) :: echo
    integer :: unit
    open (newunit=unit, file=deck_file, status='replace', action='write')
    write (unit, '(a)') '*NODE', '1, 0., 0., 0.', '2, 1., 0., 0.', '3, 1., 1., 0.', &
      '4, 0., 1., 0.', '5, 0., 0., '//height, '6, 1., 0., '//height, '7, 1., 1., '//height, &
      '8, 0., 1., '//height, '*ELEMENT, TYPE=C3D8, ELSET=ALL', '17, 1, 2, 3, 4, 5, 6, 7, 8', &
      '*NSET, NSET=BASE', '1, 2, 3, 4', '*MATERIAL, NAME=CONCRETE'
    write (unit, '(a)', advance='no') properties
    write (unit, '(a)') '*SOLID SECTION, ELSET=ALL, MATERIAL=CONCRETE', '*BOUNDARY', &
      'BASE, 1, 3', '*STEP', '*STATIC', '*CLOAD', '5, 3, 1.', '*END STEP'
    close (unit)
    call read_problem(deck_file, model, faults, echo)
    open (newunit=unit, file=deck_file, status='old')
    close (unit, status='delete')
  end subroutine read_brick

  !> Empty fields take the defaults of Abaqus, and the echo shows them.
  subroutine makes_the_law(log)
    type(test_log), intent(inout) :: log
    type(problem), allocatable :: model
    type(diagnostic_list) :: faults
    character(:), allocatable :: echo
    call read_brick('1.', elastic//'*CONCRETE DAMAGED PLASTICITY'//nl//'36.31,'//nl//crushing// &
                    '*CONCRETE TENSION STIFFENING'//nl//'2.9e6, 0.'//nl//'1e6, 1e-3'//nl, &
                    model, faults, echo)
    call check(log, faults%num_errors == 0, 'no fault')
    if (faults%has_errors()) return
    associate (brick => model%materials(1))
      call check(log, brick%law%is_nonlinear, 'a law that cracks')
      select type (law => brick%law)
      type is (concrete_law)
        call check_close(log, law%model%alpha, 0.16_rk/1.32_rk, 1.0e-14_rk, 'fb0/fc0 1.16')
        call check_close(log, law%model%gamma, 3.0_rk, 1.0e-13_rk, 'Kc 2/3')
      class default
        call check(log, .false., 'the law of concrete')
      end select
    end associate
    call check(log, size(model%inelastic) == 1, 'its elements are in a block')
    call check(log, index(echo, '36.31, 0.1, 1.16, 0.6666666666666667, 0') > 0, 'echo')
  end subroutine makes_the_law

  !> Longest elements (verification.md): E 25 GPa, f_t 2.48 MPa, G_f 100 / 150 / 200 / 300 N/m admit
  !> 0.813 / 1.219 / 1.626 / 2.439 m; half a millimetre more and less is on either side.
  subroutine longest_elements(log)
    type(test_log), intent(inout) :: log
    type(problem), allocatable :: model
    type(diagnostic_list) :: faults
    character(:), allocatable :: echo
    integer :: i
    real(rk), parameter :: energy(3) = [150.0_rk, 200.0_rk, 300.0_rk]
    real(rk), parameter :: longest(3) = [1.219_rk, 1.626_rk, 2.439_rk]
    character(*), parameter :: limits(3) = ['1.2194', '1.6259', '2.4388']
    do i = 1, 3
      call read_brick(number(longest(i) - 1.0e-3_rk), cracking_by(energy(i), ''), model, faults, &
                      echo)
      call check(log, faults%num_errors == 0, 'short enough '//number(longest(i)))
      call read_brick(number(longest(i) + 1.0e-3_rk), cracking_by(energy(i), ''), model, faults, &
                      echo)
      call check(log, faults%num_errors == 1, 'too long '//number(longest(i)))
      if (faults%num_errors /= 1) cycle
      call check(log, index(faults%errors(1)%problem, 'element 17 ') > 0, 'names the element')
      associate (said => faults%errors(1)%expected)
        call check(log, index(said, 'at most '//limits(i)) > 0, said)
      end associate
    end do
  end subroutine longest_elements

  !> 1.219 m written to the millimetre.
  pure function number(length) result(text)
    real(rk), intent(in) :: length !< [m]
    character(:), allocatable :: text
    character(12) :: room
    write (room, '(f0.3)') length
    text = trim(room)
  end function number

  !> The lines of a concrete with f_t 2.48 MPa and a fracture energy.
  pure function cracking_by(energy, option) result(lines)
    real(rk), intent(in) :: energy !< G_f [N/m]
    character(*), intent(in) :: option !< more of the keyword line
    character(:), allocatable :: lines
    character(12) :: room
    write (room, '(f0.1)') energy
    lines = elastic//'*CONCRETE DAMAGED PLASTICITY'//nl//'32.5'//nl//crushing// &
            '*CONCRETE TENSION STIFFENING, TYPE=GFI'//option//nl//'2.48e6, '//trim(room)//nl
  end function cracking_by

  !> Four times too long: half the strength, and a warning that lists the element.
  subroutine lowers_strength(log)
    type(test_log), intent(inout) :: log
    type(problem), allocatable :: model
    type(diagnostic_list) :: faults
    character(:), allocatable :: echo
    call read_brick('6.504', cracking_by(200.0_rk, ', LONG ELEMENTS=LOWER STRENGTH'), model, &
                    faults, echo)
    call check(log, faults%num_errors == 0, 'no error')
    call check(log, faults%num_warnings == 1, 'one warning')
    if (faults%num_warnings /= 1) return
    associate (said => faults%warnings(1)%problem)
      ! 2 E G_f/f_t^2 = 1.62591 m, sqrt(1.62591/6.504) 2.48 MPa = 1.23997 MPa
      call check(log, index(said, 'at a strength of 1.23997e6: elements 17') > 0, said)
    end associate
  end subroutine lowers_strength

  !> All missing data are reported at once.
  subroutine wants_its_parts(log)
    type(test_log), intent(inout) :: log
    type(problem), allocatable :: model
    type(diagnostic_list) :: faults
    character(:), allocatable :: echo
    call read_brick('1.', '*CONCRETE DAMAGED PLASTICITY'//nl//'32.5'//nl, model, faults, echo)
    call check(log, faults%num_errors == 3, 'elasticity and two tables are missing')
    call read_brick('1.', elastic, model, faults, echo)
    call check(log, faults%num_errors == 0, 'elastic as before')
    call check(log, size(model%inelastic) == 0, 'and in no block')
  end subroutine wants_its_parts
end program test_keywords_concrete
