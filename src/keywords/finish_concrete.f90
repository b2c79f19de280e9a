!> Makes the laws of concrete when the whole deck is read, and tells what is missing or wrong.
module finish_concrete
  use diagnostics, only: diagnostic_list
  use kinds, only: rk
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
      associate (now => model%scene%materials(model%concretes(i)%material))
        model%concretes(i)%constants%young = now%young
        model%concretes(i)%constants%poisson = now%poisson
      end associate
      call check_members(model%concretes(i), model, faults)
      if (faults%has_errors()) cycle
      call model%cards(model%concretes(i)%plasticity%card)%fault(faults, 'not available yet')
    end do
  end subroutine complete_concretes

  !> The keywords that a concrete cannot be without.
  subroutine check_members(given, model, faults)
    type(concrete_request), intent(in) :: given
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(origin) :: spot
    character(:), allocatable :: name
    spot = first_spot(given)
    if (spot%card == 0) return
    name = "material '"//model%scene%materials(given%material)%name//"' has "
    associate (place => model%cards(spot%card))
      if (given%plasticity%card == 0) then
        call place%fault(faults, name//'no *CONCRETE DAMAGED PLASTICITY', &
                         'it beside the tables of concrete')
      end if
      if (given%constants%young <= 0.0_rk) then
        call place%fault(faults, name//'no *ELASTIC', 'it beside *CONCRETE DAMAGED PLASTICITY')
      end if
      if (given%hardening%card == 0) then
        call place%fault(faults, name//'no *CONCRETE COMPRESSION HARDENING', &
                         'it, with one row for a strength that stays')
      end if
      if (given%stiffening%card == 0) then
        call place%fault(faults, name//'no *CONCRETE TENSION STIFFENING', &
                         'it, with the strength and what remains after cracking')
      end if
    end associate
  end subroutine check_members

  !> The keyword at which to tell what is missing.
  pure type(origin) function first_spot(given)
    type(concrete_request), intent(in) :: given
    first_spot = given%plasticity
    if (first_spot%card == 0) first_spot = given%stiffening
    if (first_spot%card == 0) first_spot = given%hardening
    if (first_spot%card == 0) first_spot = given%tension_damage
    if (first_spot%card == 0) first_spot = given%compression_damage
  end function first_spot
end module finish_concrete
