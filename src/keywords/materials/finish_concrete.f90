!> Makes the law of a concrete after the whole deck is read; reports missing and wrong data.
module finish_concrete
  use concrete_request, only: concrete_cards
  use concrete_remarks, only: describe_concrete, warn_of_constants
  use concrete_widths, only: check_widths
  use damage_checks, only: compression_damage_table, find_longest_band, find_table_faults, &
                           hardening_table, is_too_long, stiffening_table, table_fault, &
                           tension_damage_table
  use diagnostics, only: diagnostic_list
  use errors, only: error_type
  use kinds, only: rk
  use material_damage_plasticity, only: concrete_law, make_concrete_law
  use model_draft, only: draft, material_request, origin
  use write_text, only: as_text
  implicit none
  private
  public :: concrete_material

  type, extends(material_request) :: concrete_material
    type(concrete_cards) :: given
  contains
    procedure :: complete
    procedure :: check_test
  end type concrete_material

contains

  !> Makes the law of the concrete if its data have no faults.
  subroutine complete(self, model, faults)
    class(concrete_material), intent(inout) :: self
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(concrete_law) :: law
    type(error_type), allocatable :: error
    real(rk) :: smallest, largest
    integer :: num_before
    self%given%material = self%material
    associate (given => self%given, now => model%problem%materials(self%material))
      given%constants%young = now%young
      given%constants%poisson = now%poisson
      num_before = faults%num_errors
      call check_members(given, model, faults)
      if (faults%num_errors > num_before .or. .not. given%is_right) return
      call check_tables(given, model, faults)
      if (faults%num_errors > num_before) return
      call make_concrete_law(given%constants, law, error)
      if (allocated(error)) call model%cards(given%plasticity%card)%fault(faults, error%message)
      if (allocated(now%law)) deallocate (now%law)
      allocate (now%law, source=law)
      call check_widths(given, model, faults, smallest, largest)
      call warn_of_constants(given, model, faults)
      now%remark = describe_concrete(given%constants, smallest, largest)
    end associate
  end subroutine complete

  !> Reports the missing keywords of a concrete.
  subroutine check_members(given, model, faults)
    type(concrete_cards), intent(in) :: given
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(origin) :: spot
    character(:), allocatable :: name
    spot = first_spot(given)
    name = "material '"//model%problem%materials(given%material)%name//"' has no "
    associate (place => model%cards(spot%card))
      if (given%plasticity%card == 0) then
        call place%fault(faults, name//'*CONCRETE DAMAGED PLASTICITY', &
                         'this keyword beside the tables of concrete')
      end if
      if (given%constants%young <= 0.0_rk) then
        call place%fault(faults, name//'*ELASTIC', 'this keyword beside the keywords of '// &
                         'concrete')
      end if
      if (given%hardening%card == 0) then
        call place%fault(faults, name//'*CONCRETE COMPRESSION HARDENING', &
                         'this keyword; one row gives a constant strength')
      end if
      if (given%stiffening%card == 0) then
        call place%fault(faults, name//'*CONCRETE TENSION STIFFENING', &
                         'this keyword, with the strength and the stress after cracking')
      end if
    end associate
  end subroutine check_members

  !> The first keyword of the concrete; missing keywords are reported there.
  pure type(origin) function first_spot(given)
    type(concrete_cards), intent(in) :: given
    first_spot = given%plasticity
    if (first_spot%card == 0) first_spot = given%stiffening
    if (first_spot%card == 0) first_spot = given%hardening
    if (first_spot%card == 0) first_spot = given%tension_damage
    if (first_spot%card == 0) first_spot = given%compression_damage
  end function first_spot

  !> Reports each fault of the tables at its row.
  subroutine check_tables(given, model, faults)
    type(concrete_cards), intent(in) :: given
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(table_fault), allocatable :: found(:)
    type(origin) :: spot
    integer :: i
    call find_table_faults(given%constants, found)
    do i = 1, size(found)
      spot = spot_of_table(given, found(i)%keyword)
      associate (place => model%cards(spot%card))
        if (found(i)%row > 0) then
          call place%fault_at(faults, found(i)%row, found(i)%field, found(i)%problem, &
                              found(i)%expected)
        else
          call place%fault_parameter(faults, 'TYPE', found(i)%problem, found(i)%expected)
        end if
      end associate
    end do
  end subroutine check_tables

  !> The place of a table in the deck.
  type(origin) function spot_of_table(given, keyword) result(spot)
    type(concrete_cards), intent(in) :: given
    character(*), intent(in) :: keyword !< as damage_checks names it
    select case (keyword)
    case (stiffening_table)
      spot = given%stiffening
    case (tension_damage_table)
      spot = given%tension_damage
    case (compression_damage_table)
      spot = given%compression_damage
    case (hardening_table)
      spot = given%hardening
    case default
      error stop 'spot_of_table: unknown table of concrete'
    end select
  end function spot_of_table

  !> Checks LENGTH of a test: tables over openings need a length, and a long cube snaps back.
  subroutine check_test(self, number, model, faults)
    class(concrete_material), intent(in) :: self
    integer, intent(in) :: number !< of the test
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(table_fault) :: limit
    character(:), allocatable :: problem
    real(rk) :: longest
    associate (test => model%problem%tests(number), given => self%given, &
               place => model%cards(model%test_origin(number)%card))
      if (.not. uses_length(given)) return
      if (.not. place%has('LENGTH')) then
        call place%warn(faults, "LENGTH is not given and converts the openings of '"// &
                        model%problem%materials(test%material)%name// &
                        "' into strains: 1 is used", &
                        'LENGTH, the side of an element [m]')
      end if
      call find_longest_band(given%constants, longest, limit)
      if (.not. is_too_long(test%length, longest)) return
      if (given%constants%lowers_strength) then
        call place%warn(faults, 'in a length of '//as_text(test%length)//' the concrete '// &
                        'cracks at a lower strength, with the same energy', &
                        'at most '//as_text(longest)//' for its own strength')
        return
      end if
      problem = 'the concrete snaps back in a length of '
      if (limit%keyword == tension_damage_table) then
        problem = 'the plastic strain decreases in a length of '
      end if
      call place%fault_parameter(faults, 'LENGTH', problem//as_text(test%length), &
                                 'at most '//as_text(longest)//': '//limit%expected)
    end associate
  end subroutine check_test

  !> True if a table of the concrete is over openings or is given by G_f.
  pure logical function uses_length(given)
    type(concrete_cards), intent(in) :: given
    uses_length = given%constants%stiffening /= 'STRAIN' .or. &
                  given%constants%tension_damage_type /= 'STRAIN' .and. &
                  allocated(given%constants%tension_damage)
  end function uses_length
end module finish_concrete
