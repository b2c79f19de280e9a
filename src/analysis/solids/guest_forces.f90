!> Forces of guests with a history, except joints and inelastic solids: their initial-stress force
!> K_g u - f at the nodes.
module guest_forces
  use guest_history, only: history_slot
  use kinds, only: rk
  use problem_definition, only: problem
  implicit none
  private
  public :: update_guests, recall_guests, has_histories

contains

  !> Whether any guest has a history.
  pure logical function has_histories(histories) result(has_any)
    type(history_slot), intent(in) :: histories(:)
    integer :: i
    has_any = any([(allocated(histories(i)%item), i=1, size(histories))])
  end function has_histories

  !> Updates all histories for a trial displacement and sums the forces.
  subroutine update_guests(model, u, dt, old, new, excess)
    type(problem), intent(in) :: model
    real(rk), intent(in) :: u(:, :) !< (3, nodes) [m]
    real(rk), intent(in) :: dt !< [s]
    type(history_slot), intent(in) :: old(:) !< (guests) converged
    type(history_slot), intent(inout) :: new(:) !< (guests)
    real(rk), intent(out) :: excess(:, :) !< (3, nodes) [N]
    integer :: i
    excess = 0.0_rk
    do i = 1, size(old)
      if (.not. allocated(old(i)%item)) cycle
      call model%guests(i)%item%update(model%mesh, u, dt, old(i)%item, new(i)%item, excess)
    end do
  end subroutine update_guests

  !> Forces of converged histories at their own displacement.
  subroutine recall_guests(model, u, histories, excess)
    type(problem), intent(in) :: model
    real(rk), intent(in) :: u(:, :) !< (3, nodes) [m]
    type(history_slot), intent(in) :: histories(:) !< (guests)
    real(rk), intent(out) :: excess(:, :) !< (3, nodes) [N]
    type(history_slot) :: copy(size(histories))
    copy = histories
    call update_guests(model, u, 0.0_rk, histories, copy, excess)
  end subroutine recall_guests
end module guest_forces
