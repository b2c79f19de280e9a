!> Unknowns that the iterations on inelastic solids change and need: those of inelastic elements and
!> of joints. All other parts of the model are linear.
module active_unknowns
  use dof_numbering, only: numbering
  use node_dofs, only: num_directions
  use problem_definition, only: problem
  implicit none
  private
  public :: find_active

contains

  !> The free ones, in ascending order; of some elements or of all inelastic ones.
  function find_active(model, numbers, takes_part) result(active)
    type(problem), intent(in) :: model
    type(numbering), intent(in) :: numbers
    logical, intent(in), optional :: takes_part(:) !< (elements of the mesh)
    integer, allocatable :: active(:)
    logical :: is_active(numbers%num_total)
    integer :: i, e, k
    is_active = .false.
    do i = 1, size(model%inelastic)
      associate (elements => model%inelastic(i)%elements)
        do e = 1, size(elements)
          if (present(takes_part)) then
            if (.not. takes_part(elements(e))) cycle
          end if
          call mark_element(model%mesh%nodes(:, elements(e)), numbers, is_active)
        end do
      end associate
    end do
    is_active(numbers%num_free - numbers%num_last + 1:numbers%num_free) = .true.
    active = pack([(k, k=1, numbers%num_free)], is_active(:numbers%num_free))
  end function find_active

  !> Marks the unknowns of an element.
  pure subroutine mark_element(nodes, numbers, is_marked)
    integer, intent(in) :: nodes(:)
    type(numbering), intent(in) :: numbers
    logical, intent(inout) :: is_marked(:) !< (unknowns)
    integer :: k, t, direction, dof
    do k = 1, size(nodes)
      do direction = 1, num_directions
        dof = numbers%dofs%dof_of(nodes(k), direction)
        do t = numbers%row_start(dof), numbers%row_start(dof + 1) - 1
          is_marked(numbers%unknown(t)) = .true.
        end do
      end do
    end do
  end subroutine mark_element
end module active_unknowns
