!> The data lines of *MATERIAL TEST: legs of a path.
module material_test_legs
  use deck_card, only: card
  use diagnostics, only: diagnostic_list
  use kinds, only: rk
  use material_tests, only: test_leg
  use write_text, only: as_text
  implicit none
  private
  public :: read_legs

  integer, parameter :: num_components = 6

  integer, parameter :: most_increments = 1000000 !< of a leg, as of INCREMENTS

  !> Far beyond small strains. Larger numbers are stresses, or have a wrong exponent.
  real(rk), parameter :: largest_strain = 10.0_rk

contains

  !> All legs of a test, its cycles one after the other.
  subroutine read_legs(this, faults, legs)
    type(card), intent(in) :: this
    type(diagnostic_list), intent(inout) :: faults
    type(test_leg), allocatable, intent(out) :: legs(:)
    type(test_leg), allocatable :: once(:)
    type(test_leg) :: confining
    integer :: line, i
    allocate (once(this%num_lines))
    do line = 1, this%num_lines
      if (this%word('TYPE') == 'GENERAL') then
        call read_general_leg(this, line, faults, once)
      else
        call read_named_leg(this, line, faults, once(line))
      end if
    end do
    legs = [(once, i=1, max(1, this%integer('CYCLES')))]
    if (this%word('TYPE') /= 'TRIAXIAL') return
    confining%is_stress = .true.
    confining%target(1:3) = -this%real('CONFINEMENT')
    confining%num_increments = this%integer('INCREMENTS')
    confining%duration = this%real('TIME')
    legs = [confining, legs]
  end subroutine read_legs

  !> target, increments, time of a test that has a name.
  subroutine read_named_leg(this, line, faults, leg)
    type(card), intent(in) :: this
    integer, intent(in) :: line
    type(diagnostic_list), intent(inout) :: faults
    type(test_leg), intent(out) :: leg
    real(rk) :: target
    integer :: driven
    call check_count(this, line, 3, 'target, increments, time', faults)
    target = number_at(this, line, 1, 'target', faults)
    driven = 1
    leg%is_stress = .true.
    select case (this%word('TYPE'))
    case ('BIAXIAL')
      leg%share(2) = this%real('RATIO')
    case ('TRIAXIAL')
      leg%target(2:3) = -this%real('CONFINEMENT')
    case ('OEDOMETER')
      leg%is_stress = .false.
    case ('SHEAR')
      driven = 4
    case ('HYDROSTATIC')
      leg%is_stress = .false.
      leg%is_stress(1:3) = this%word('CONTROL') == 'STRESS'
      leg%target(1:3) = target
    case default ! UNIAXIAL: all sides are free
    end select
    leg%is_stress(driven) = this%word('CONTROL') == 'STRESS'
    leg%target(driven) = target
    if (.not. leg%is_stress(driven)) call check_strain(this, line, 1, target, faults)
    call read_pace(this, line, 2, faults, leg)
  end subroutine read_named_leg

  !> control, six targets, increments, time.
  subroutine read_general_leg(this, line, faults, legs)
    type(card), intent(in) :: this
    integer, intent(in) :: line
    type(diagnostic_list), intent(inout) :: faults
    type(test_leg), intent(inout) :: legs(:) !< those before are done
    character(:), allocatable :: control
    integer :: i
    call check_count(this, line, num_components + 3, &
                     'control, 11, 22, 33, 12, 13, 23, increments, time', faults)
    control = this%word_at(line, 1)
    if (control == '' .and. line > 1) then
      legs(line)%is_stress = legs(line - 1)%is_stress
    else if (len(control) /= num_components .or. verify(control, 'ES') > 0) then
      call this%fault_at(faults, line, 1, "found '"//this%text_at(line, 1)//"'", &
                         'six letters, E for a strain and S for a stress, as ESSSSS')
    else
      legs(line)%is_stress = [(control(i:i) == 'S', i=1, num_components)]
    end if
    do i = 1, num_components
      legs(line)%is_held(i) = this%is_empty_at(line, i + 1)
      if (legs(line)%is_held(i)) cycle
      legs(line)%target(i) = number_at(this, line, i + 1, 'target', faults)
      if (legs(line)%is_stress(i)) cycle
      call check_strain(this, line, i + 1, legs(line)%target(i), faults)
    end do
    call read_pace(this, line, num_components + 2, faults, legs(line))
  end subroutine read_general_leg

  !> Reports a number that is no strain: with it no law finds a stress in reasonable time.
  subroutine check_strain(this, line, field, strain, faults)
    type(card), intent(in) :: this
    integer, intent(in) :: line, field
    real(rk), intent(in) :: strain
    type(diagnostic_list), intent(inout) :: faults
    character(:), allocatable :: for_stress
    if (abs(strain) <= largest_strain) return
    for_stress = 'CONTROL=STRESS'
    if (this%word('TYPE') == 'GENERAL') for_stress = 'S in the control'
    call this%fault_at(faults, line, field, "found '"//this%text_at(line, field)//"'", &
                       'a strain from -10 to 10, or '//for_stress//' for a stress')
  end subroutine check_strain

  !> increments, time.
  subroutine read_pace(this, line, field, faults, leg)
    type(card), intent(in) :: this
    integer, intent(in) :: line, field !< of the increments
    type(diagnostic_list), intent(inout) :: faults
    type(test_leg), intent(inout) :: leg
    leg%num_increments = this%integer('INCREMENTS')
    leg%duration = this%real('TIME')
    if (.not. this%is_empty_at(line, field)) then
      leg%num_increments = this%integer_at(line, field)
      if (.not. this%is_integer_at(line, field) .or. leg%num_increments < 1 .or. &
          leg%num_increments > most_increments) then
        call this%fault_at(faults, line, field, "found '"//this%text_at(line, field)//"'", &
                           'number of increments, an integer from 1 to '// &
                           as_text(most_increments))
      end if
    end if
    if (.not. this%is_empty_at(line, field + 1)) then
      leg%duration = number_at(this, line, field + 1, 'time', faults)
      if (.not. leg%duration > 0.0_rk .and. this%is_real_at(line, field + 1)) then
        call this%fault_at(faults, line, field + 1, "found '"//this%text_at(line, field + 1)// &
                           "'", 'time of the leg, a number > 0 [s]')
      end if
    end if
  end subroutine read_pace

  !> The number in a field; zero after a fault.
  real(rk) function number_at(this, line, field, meaning, faults) result(number)
    type(card), intent(in) :: this
    integer, intent(in) :: line, field
    character(*), intent(in) :: meaning
    type(diagnostic_list), intent(inout) :: faults
    number = 0.0_rk
    if (this%is_real_at(line, field)) then
      number = this%real_at(line, field)
    else if (this%is_empty_at(line, field)) then
      call this%fault_at(faults, line, field, meaning//' is missing', 'a number')
    else
      call this%fault_at(faults, line, field, "found '"//this%text_at(line, field)//"'", &
                         meaning//', a number')
    end if
  end function number_at

  !> Reports a line with too many fields.
  subroutine check_count(this, line, most, names, faults)
    type(card), intent(in) :: this
    integer, intent(in) :: line, most
    character(*), intent(in) :: names
    type(diagnostic_list), intent(inout) :: faults
    if (this%num_fields(line) <= most) return
    call this%fault_at(faults, line, most + 1, 'found '//as_text(this%num_fields(line))// &
                       ' fields', 'at most '//as_text(most)//': '//names)
  end subroutine check_count
end module material_test_legs
