!> Refuses what several ranks do not work on yet, so that nothing is computed wrongly.
module undivided_effects
  use errors, only: deck_is_wrong, error_type, raise
  use guest_type, only: damping_matrix, guest, mass_matrix, stiffness_matrix
  use problem_definition, only: problem
  use row_tables, only: row_table
  implicit none
  private
  public :: refuse_undivided

  character(*), parameter :: cells_needed = "effects that name no cells of their matrices ('"

contains

  !> Error of the first effect that needs one process.
  subroutine refuse_undivided(model, error)
    type(problem), intent(in) :: model
    type(error_type), allocatable, intent(out) :: error
    character(:), allocatable :: effect
    effect = effect_of_model(model)
    if (effect == '') return
    call raise(error, model%deck_file//': '//effect//' work in one process only; start '// &
               'this deck without mpiexec and --solver (large_models.md)', deck_is_wrong)
  end subroutine refuse_undivided

  !> What the model holds, '' for nothing.
  function effect_of_model(model) result(effect)
    type(problem), intent(in) :: model
    character(:), allocatable :: effect
    integer :: i
    effect = ''
    do i = 1, size(model%guests)
      if (hides_cells(model%guests(i)%item)) effect = cells_needed//model%guests(i)%item%name//"')"
    end do
    do i = 1, size(model%loads)
      if (hides_cells(model%loads(i)%item)) effect = cells_needed//model%loads(i)%item%name//"')"
    end do
  end function effect_of_model

  !> Whether a guest has matrices but does not name the nodes that they have rows for: the matrix of
  !> a rank has no other rows than those of its elements and of such nodes.
  logical function hides_cells(item)
    class(guest), intent(in) :: item
    type(row_table) :: cells
    hides_cells = item%has_matrix(stiffness_matrix) .or. item%has_matrix(mass_matrix) &
                  .or. item%has_matrix(damping_matrix)
    if (.not. hides_cells) return
    call item%add_cells(cells)
    call cells%finish()
    hides_cells = cells%num_rows() == 0
  end function hides_cells
end module undivided_effects
