!> Adds the load of a card to the problem and to the list of active loads.
module enter_load
  use applied_load, only: load
  use kinds, only: rk
  use model_draft, only: add_load, draft
  implicit none
  private
  public :: put_load

contains

  !> Adds a load; if an equal load is active, only its factor changes.
  subroutine put_load(model, item, name, family, target, pattern, factor, history)
    type(draft), intent(inout) :: model
    class(load), allocatable, intent(inout) :: item !< pattern of forces at factor 1; taken over
    character(*), intent(in) :: name !< for the log and the list of effects
    character(*), intent(in) :: family !< its keyword
    character(*), intent(in) :: target !< what the load acts on
    character(*), intent(in) :: pattern !< all other data of the load but the factor
    real(rk), intent(in) :: factor
    integer, intent(in) :: history !< amplitude, 0 for none
    integer :: known
    call model%active_loads%take_over(family, target, pattern, factor, history, known)
    if (known > 0) return
    call add_load(model, item, name, family, target)
    call model%active_loads%enter(family, target, pattern, factor, history, model%num_loads)
  end subroutine put_load
end module enter_load
