!> Makes the laws of concrete when the whole deck is read, and tells what is missing or wrong.
module finish_concrete
  use concrete_remarks, only: describe_concrete, warn_of_constants
  use concrete_widths, only: check_widths
  use damage_checks, only: compression_damage_table, find_table_faults, hardening_table, &
                           stiffening_table, table_fault, tension_damage_table
  use diagnostics, only: diagnostic_list
  use errors, only: error_type
  use kinds, only: rk
  use material_damage_plasticity, only: concrete_law, make_concrete_law
  use model_draft, only: concrete_request, draft, origin
  implicit none
  private
  public :: complete_concretes

contains

  !> Gives every concrete of the deck its law.
  subroutine complete_concretes(model, faults)
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer :: i
    do i = 1, size(model%concretes)
      call complete_concrete(i, model, faults)
    end do
  end subroutine complete_concretes

  !> The law of one concrete, if nothing is wrong with it.
  subroutine complete_concrete(i, model, faults)
    integer, intent(in) :: i !< position in model%concretes
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(concrete_law) :: law
    type(error_type), allocatable :: error
    real(rk) :: smallest, largest
    integer :: num_before
    associate (given => model%concretes(i), &
               now => model%scene%materials(model%concretes(i)%material))
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
  end subroutine complete_concrete

  !> The keywords that a concrete cannot be without.
  subroutine check_members(given, model, faults)
    type(concrete_request), intent(in) :: given
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(origin) :: spot
    character(:), allocatable :: name
    spot = first_spot(given)
    name = "material '"//model%scene%materials(given%material)%name//"' has no "
    associate (place => model%cards(spot%card))
      if (given%plasticity%card == 0) then
        call place%fault(faults, name//'*CONCRETE DAMAGED PLASTICITY', &
                         'it beside the tables of concrete')
      end if
      if (given%constants%young <= 0.0_rk) then
        call place%fault(faults, name//'*ELASTIC', 'it beside the keywords of concrete')
      end if
      if (given%hardening%card == 0) then
        call place%fault(faults, name//'*CONCRETE COMPRESSION HARDENING', &
                         'it, with one row for a strength that stays')
      end if
      if (given%stiffening%card == 0) then
        call place%fault(faults, name//'*CONCRETE TENSION STIFFENING', &
                         'it, with the strength and what remains after cracking')
      end if
    end associate
  end subroutine check_members

  !> The first of the keywords there are, where to tell what is missing.
  pure type(origin) function first_spot(given)
    type(concrete_request), intent(in) :: given
    first_spot = given%plasticity
    if (first_spot%card == 0) first_spot = given%stiffening
    if (first_spot%card == 0) first_spot = given%hardening
    if (first_spot%card == 0) first_spot = given%tension_damage
    if (first_spot%card == 0) first_spot = given%compression_damage
  end function first_spot

  !> Every fault of the tables, at its row.
  subroutine check_tables(given, model, faults)
    type(concrete_request), intent(in) :: given
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

  !> Where a table stands.
  type(origin) function spot_of_table(given, keyword) result(spot)
    type(concrete_request), intent(in) :: given
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
      error stop 'spot_of_table: a table that concrete does not have'
    end select
  end function spot_of_table
end module finish_concrete
