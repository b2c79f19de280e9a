!> The histories of a state in one list: joints, blocks of inelastic solids and other guests.
module guest_histories
  use guest_history, only: history, history_slot, stored_work
  use guest_type, only: guest
  use problem_definition, only: problem
  use analysis_state, only: state
  use write_text, only: as_text
  implicit none
  private
  public :: history_reference, list_histories, list_owners, start_histories, sum_work

  !> A history, its name in an archive, and the guest that it belongs to.
  type :: history_reference
    class(history), pointer :: own => null()
    class(guest), pointer :: owner => null() !< null without `list_owners`
    character(:), allocatable :: key
  end type history_reference

contains

  !> The histories that there are. The list points into `now`.
  subroutine list_histories(now, list)
    type(state), intent(in), target :: now
    type(history_reference), allocatable, intent(out) :: list(:)
    integer :: i, n, num_joints, num_blocks
    num_joints = size(now%joints)
    num_blocks = size(now%points)
    allocate (list(num_joints + num_blocks + size(now%guests)))
    do i = 1, num_joints
      list(i)%own => now%joints(i)
      list(i)%key = 'joint_'//as_text(i)
    end do
    do i = 1, num_blocks
      list(num_joints + i)%own => now%points(i)
      list(num_joints + i)%key = 'points_'//as_text(i)
    end do
    do i = 1, size(now%guests)
      n = num_joints + num_blocks + i
      list(n)%own => now%guests(i)%item
      list(n)%key = 'guest_'//as_text(i)
    end do
  end subroutine list_histories

  !> Adds the owners to a list of histories.
  subroutine list_owners(model, list)
    type(problem), intent(in), target :: model
    type(history_reference), intent(inout) :: list(:)
    integer :: i, n, num_joints
    num_joints = size(model%joints)
    n = size(list) - size(model%guests)
    do i = 1, num_joints
      list(i)%owner => model%joints(i)
    end do
    do i = num_joints + 1, n
      list(i)%owner => model%inelastic(i - num_joints)
    end do
    do i = 1, size(model%guests)
      list(n + i)%owner => model%guests(i)%item
    end do
  end subroutine list_owners

  !> The histories of guests at the start of an analysis.
  subroutine start_histories(model, histories)
    type(problem), intent(in) :: model
    type(history_slot), allocatable, intent(out) :: histories(:)
    integer :: i
    allocate (histories(size(model%guests)))
    do i = 1, size(model%guests)
      call model%guests(i)%item%start_history(model%mesh, histories(i)%item)
    end do
  end subroutine start_histories

  !> Energies of all guests that have a history.
  subroutine sum_work(model, now, total)
    type(problem), intent(in), target :: model
    type(state), intent(in), target :: now
    type(stored_work), intent(out) :: total
    type(history_reference), allocatable :: list(:)
    integer :: i
    call list_histories(now, list)
    call list_owners(model, list)
    do i = 1, size(list)
      if (associated(list(i)%own)) call list(i)%owner%add_work(list(i)%own, total)
    end do
  end subroutine sum_work
end module guest_histories
