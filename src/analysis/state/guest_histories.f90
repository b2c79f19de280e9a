!> The histories of a state in one list: joints, blocks of inelastic solids and other guests.
module guest_histories
  use guest_history, only: history, history_slot, stored_work
  use guest_type, only: guest
  use inelastic_blocks, only: fewest_blocks
  use problem_definition, only: problem
  use analysis_state, only: state
  use kinds, only: rk
  use ranks, only: add_over_ranks, num_ranks
  implicit none
  private
  public :: history_reference, list_histories, start_histories, sum_work

  !> A history, and the guest that it belongs to.
  type :: history_reference
    class(history), pointer :: own => null()
    class(guest), pointer :: owner => null() !< null where the list is made without the model
    character(6) :: kind = '' !< 'joint', 'points' or 'guest'
    integer :: number = 0 !< among those of its kind
  end type history_reference

contains

  !> The histories that there are, with their owners where the model is given. The list points into
  !> `now` and `model`. Blocks of points that another rank alone has are null.
  subroutine list_histories(now, list, model)
    type(state), intent(in), target :: now
    type(history_reference), allocatable, intent(out) :: list(:)
    type(problem), intent(in), target, optional :: model
    integer :: i, n
    allocate (list(size(now%joints) + size(now%points) + size(now%guests)))
    do i = 1, size(now%joints)
      list(i)%own => now%joints(i)
      list(i)%kind = 'joint'
      list(i)%number = i
      if (present(model)) list(i)%owner => model%joints(i)
    end do
    n = size(now%joints)
    do i = 1, size(now%points)
      list(n + i)%kind = 'points'
      if (.not. now%points(i)%is_elsewhere()) list(n + i)%own => now%points(i)
      list(n + i)%number = i
      if (present(model)) list(n + i)%owner => model%inelastic(i)
    end do
    n = n + size(now%points)
    do i = 1, size(now%guests)
      list(n + i)%own => now%guests(i)%item
      list(n + i)%kind = 'guest'
      list(n + i)%number = i
      if (present(model)) list(n + i)%owner => model%guests(i)%item
    end do
  end subroutine list_histories

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
    type(stored_work), allocatable :: part(:)
    integer :: i
    call list_histories(now, list, model)
    allocate (part(size(list)))
    !$omp parallel do default(none) shared(list, part) schedule(dynamic, 8) &
    !$omp if (size(list) > fewest_blocks)
    do i = 1, size(list)
      if (associated(list(i)%own)) call list(i)%owner%add_work(list(i)%own, part(i))
    end do
    !$omp end parallel do
    call share_work(list, part)
    ! In the order of the list: the same sum for any number of threads.
    do i = 1, size(list)
      total%stored = total%stored + part(i)%stored
      total%friction = total%friction + part(i)%friction
      total%fracture = total%fracture + part(i)%fracture
      total%crushing = total%crushing + part(i)%crushing
    end do
  end subroutine sum_work

  !> Gives the energies of blocks, which one rank has each, to all ranks; those of other guests all
  !> ranks have.
  subroutine share_work(list, part)
    type(history_reference), intent(in) :: list(:)
    type(stored_work), intent(inout) :: part(:)
    real(rk), allocatable :: values(:, :)
    integer, allocatable :: blocks(:)
    integer :: i
    if (num_ranks() == 1) return
    blocks = pack([(i, i=1, size(list))], list%kind == 'points')
    values = reshape([part(blocks)%stored, part(blocks)%fracture, part(blocks)%crushing], &
                     [size(blocks), 3])
    call add_over_ranks(values)
    part(blocks)%stored = values(:, 1)
    part(blocks)%fracture = values(:, 2)
    part(blocks)%crushing = values(:, 3)
  end subroutine share_work
end module guest_histories
