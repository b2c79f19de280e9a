!> Puts a load that a card gives into the problem and into the book of what is at work.
module enter_load
  use applied_load, only: load
  use kinds, only: rk
  use model_draft, only: add_load, draft
  implicit none
  private
  public :: put_load

contains

  !> A load like one that is at work only changes its factor; another one is added.
  subroutine put_load(model, item, name, family, target, pattern, factor, history)
    type(draft), intent(inout) :: model
    class(load), allocatable, intent(inout) :: item !< pattern of forces at factor 1; taken over
    character(*), intent(in) :: name !< for the log and the list of effects
    character(*), intent(in) :: family !< its keyword
    character(*), intent(in) :: target !< what it acts on
    character(*), intent(in) :: pattern !< all else that shapes it but the factor
    real(rk), intent(in) :: factor
    integer, intent(in) :: history !< amplitude, 0 for none
    integer :: known
    call model%loads_at_work%take_over(family, target, pattern, factor, history, known)
    if (known > 0) return
    call add_load(model, item, name, family, target)
    call model%loads_at_work%enter(family, target, pattern, factor, history, model%num_loads)
  end subroutine put_load
end module enter_load
