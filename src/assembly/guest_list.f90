!> Guests of a model and of a step, in the order of the loops.
module guest_list
  use kinds, only: rk
  use dam_mesh, only: node_tie
  use dof_numbering, only: numbering
  use guest_type, only: guest, guest_reference, guest_slot
  use matrix_pattern, only: pattern
  use problem_definition, only: problem
  use ranks, only: num_ranks, this_rank
  use row_tables, only: row_table
  use run_ledger, only: ledger
  use step_plan, only: step
  implicit none
  private
  public :: guests_of_model, guests_of_step, list_guest_cells, add_guest_matrices, any_has_matrix
  public :: supports_of_step, ties_of, bonds_of_model, is_guest_here

contains

  !> Joints, and other guests of every step. The list points into `model`, which must be a target
  !> in the caller.
  subroutine guests_of_model(model, list)
    type(problem), intent(in), target :: model
    type(guest_reference), allocatable, intent(out) :: list(:)
    integer :: i, num_joints
    num_joints = size(model%joints)
    allocate (list(num_joints + size(model%guests)))
    do i = 1, num_joints
      list(i)%item => model%joints(i)
    end do
    do i = 1, size(model%guests)
      list(num_joints + i)%item => model%guests(i)%item
    end do
  end subroutine guests_of_model

  !> Guests of the model, and the loads of a step, each once.
  subroutine guests_of_step(model, plan, list)
    type(problem), intent(in), target :: model
    type(step), intent(in) :: plan
    type(guest_reference), allocatable, intent(out) :: list(:)
    type(guest_reference), allocatable :: permanent(:)
    integer, allocatable :: loads(:)
    integer :: i
    call guests_of_model(model, permanent)
    loads = pack(plan%loads%load, abs(plan%loads%end_factor) > 0.0_rk)
    allocate (list(size(permanent) + size(loads)))
    list(:size(permanent)) = permanent
    do i = 1, size(loads)
      list(size(permanent) + i)%item => model%loads(loads(i))%item
    end do
  end subroutine guests_of_step

  !> Whether the matrices of a guest are assembled by this rank. A guest is whole on one rank.
  logical function is_guest_here(guest)
    integer, intent(in) :: guest !< position in the list of the step; joints come first
    is_guest_here = mod(guest - 1, num_ranks()) == this_rank()
  end function is_guest_here

  !> Cells of the guests of this rank: nodes that a guest couples.
  subroutine list_guest_cells(guests, cells)
    type(guest_reference), intent(in) :: guests(:)
    type(row_table), intent(inout) :: cells
    integer :: i
    do i = 1, size(guests)
      if (is_guest_here(i)) call guests(i)%item%add_cells(cells)
    end do
  end subroutine list_guest_cells

  !> Groups of nodes that guests connect with each other; joints included.
  subroutine bonds_of_model(model, groups)
    type(problem), intent(in), target :: model
    type(row_table), intent(out) :: groups
    type(guest_reference), allocatable :: guests(:)
    integer :: i
    call guests_of_model(model, guests)
    do i = 1, size(guests)
      call guests(i)%item%add_bonds(groups)
    end do
    call groups%finish()
  end subroutine bonds_of_model

  !> Relations between displacements that guests impose.
  subroutine ties_of(guests, ties)
    type(guest_slot), intent(in) :: guests(:)
    type(node_tie), allocatable, intent(out) :: ties(:)
    integer :: i, used
    allocate (ties(size(guests)))
    used = 0
    do i = 1, size(guests)
      call guests(i)%item%add_ties(ties, used)
    end do
    ties = ties(:used)
  end subroutine ties_of

  !> Whether any guest adds to a matrix.
  pure logical function any_has_matrix(guests, kind)
    type(guest_reference), intent(in) :: guests(:)
    integer, intent(in) :: kind !< of guest_type
    integer :: i
    any_has_matrix = .false.
    do i = 1, size(guests)
      any_has_matrix = any_has_matrix .or. guests(i)%item%has_matrix(kind)
    end do
  end function any_has_matrix

  !> Adds the matrices of the guests; the ledger books each of them.
  subroutine add_guest_matrices(guests, kind, model, numbers, matrix, values, costs)
    type(guest_reference), intent(in) :: guests(:)
    integer, intent(in) :: kind !< of guest_type
    type(problem), intent(in) :: model
    type(numbering), intent(in) :: numbers
    type(pattern), intent(in) :: matrix
    real(rk), intent(inout) :: values(:)
    type(ledger), intent(in) :: costs
    integer :: i
    do i = 1, size(guests)
      associate (item => guests(i)%item)
        if (.not. (item%has_matrix(kind) .and. is_guest_here(i))) cycle
        call costs%start('assemble', item%name, item%kind)
        call item%add_matrix(kind, model%mesh, numbers, matrix, values)
        call costs%stop()
      end associate
    end do
  end subroutine add_guest_matrices

  !> Displacements that *BOUNDARY or a guest prescribes in a step.
  subroutine supports_of_step(model, plan, node, direction)
    type(problem), intent(in), target :: model
    type(step), intent(in) :: plan
    integer, allocatable, intent(out) :: node(:) !< positions in the mesh
    integer, allocatable, intent(out) :: direction(:) !< 1..3
    type(guest_reference), allocatable :: guests(:)
    integer :: i
    node = plan%fixities%node
    direction = plan%fixities%dof
    call guests_of_model(model, guests)
    do i = 1, size(guests)
      call guests(i)%item%add_supports(node, direction)
    end do
  end subroutine supports_of_step
end module guest_list
