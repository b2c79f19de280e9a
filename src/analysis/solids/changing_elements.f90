!> Elements that take part in the iteration of an increment: those with a point that has yielded,
!> and their neighbours. All others stay elastic, which is checked before the increment is accepted.
!> They have no initial-stress force, so that iterations need neither their laws nor their unknowns
!> (theory.md, 12).
!>
!> The first update of an increment is that of elements which are not elastic at its start, and of
!> their neighbours; the choice for the iterations includes what this update has changed.
module changing_elements
  use inelastic_forces, only: block_answer, has_many_elements
  use kinds, only: rk
  use material_points, only: point_state
  use problem_definition, only: problem
  use ranks, only: add_over_ranks, num_ranks
  implicit none
  private
  public :: element_choice

  type :: element_choice
    logical :: is_made = .false. !< false: all inelastic elements take part
    logical, allocatable :: takes_part(:) !< (elements of the mesh)
  contains
    procedure :: release => release_elements
    procedure :: choose => choose_elements
    procedure :: extend => extend_choice
    procedure :: ask_others
    procedure, private :: add_near, tell_blocks
  end type element_choice

contains

  !> All elements take part.
  subroutine release_elements(self, answers)
    class(element_choice), intent(inout) :: self
    type(block_answer), intent(inout) :: answers(:) !< (blocks)
    integer :: i
    if (.not. self%is_made) return
    self%is_made = .false.
    do i = 1, size(answers)
      answers(i)%takes_part(:) = .true.
    end do
  end subroutine release_elements

  !> Chooses the elements that are not elastic at the start of the increment or after the last
  !> update, and those that share a node with them, where a crack may grow.
  subroutine choose_elements(self, model, old, wants_all, answers)
    class(element_choice), intent(inout) :: self
    type(problem), intent(in) :: model
    type(point_state), intent(in) :: old(:) !< (blocks) converged
    logical, intent(in) :: wants_all !< all inelastic elements
    type(block_answer), intent(inout) :: answers(:) !< (blocks)
    logical :: is_near(model%mesh%num_nodes)
    integer :: i, e, n
    if (.not. allocated(self%takes_part)) allocate (self%takes_part(model%mesh%num_elements))
    self%is_made = .true.
    self%takes_part(:) = .false.
    is_near = wants_all
    do i = 1, size(answers)
      if (.not. model%inelastic(i)%is_here()) cycle
      associate (part => model%inelastic(i), report => answers(i)%report)
        n = part%points_of_element
        do e = 1, size(part%elements)
          if (answers(i)%has_excess(e) .or. report%failed_point > 0 &
              .or. report%size_ratio < 1.0_rk &
              .or. .not. all(old(i)%is_elastic((e - 1)*n + 1:e*n))) then
            is_near(model%mesh%nodes(:, part%elements(e))) = .true.
          end if
        end do
      end associate
    end do
    call mark_on_all_ranks(is_near)
    call self%add_near(model, answers, is_near)
    call self%tell_blocks(model, answers)
  end subroutine choose_elements

  !> Marks what any rank has marked.
  subroutine mark_on_all_ranks(is_marked)
    logical, intent(inout) :: is_marked(:)
    real(rk) :: number(size(is_marked))
    if (num_ranks() == 1) return
    number = merge(1.0_rk, 0.0_rk, is_marked)
    call add_over_ranks(number)
    is_marked = number > 0.5_rk
  end subroutine mark_on_all_ranks

  !> The next update is that of the elements that take no part.
  subroutine ask_others(self, answers)
    class(element_choice), intent(in) :: self
    type(block_answer), intent(inout) :: answers(:) !< (blocks)
    integer :: i
    if (.not. self%is_made) return
    do i = 1, size(answers)
      answers(i)%takes_part(:) = .not. answers(i)%takes_part
    end do
  end subroutine ask_others

  !> Adds elements that are no longer elastic after an update of the others, and those that share a
  !> node with them.
  subroutine extend_choice(self, model, answers, has_grown)
    class(element_choice), intent(inout) :: self
    type(problem), intent(in) :: model
    type(block_answer), intent(inout) :: answers(:) !< (blocks)
    logical, intent(out) :: has_grown
    logical :: is_near(model%mesh%num_nodes)
    integer :: i, e
    is_near = .false.
    do i = 1, size(answers)
      do e = 1, size(answers(i)%has_excess)
        associate (element => model%inelastic(i)%elements(e))
          if (.not. answers(i)%has_excess(e) .or. self%takes_part(element)) cycle
          is_near(model%mesh%nodes(:, element)) = .true.
        end associate
      end do
    end do
    call mark_on_all_ranks(is_near)
    has_grown = any(is_near)
    if (has_grown) call self%add_near(model, answers, is_near)
    call self%tell_blocks(model, answers)
  end subroutine extend_choice

  !> Adds the elements with a node that is marked.
  subroutine add_near(self, model, answers, is_near)
    class(element_choice), intent(inout) :: self
    type(problem), intent(in) :: model
    type(block_answer), intent(in) :: answers(:) !< (blocks)
    logical, intent(in) :: is_near(:) !< (nodes)
    integer :: i, e
    !$omp parallel do default(none) shared(self, model, answers, is_near) private(e) &
    !$omp schedule(dynamic, 16) if (has_many_elements(answers))
    do i = 1, size(answers)
      do e = 1, size(model%inelastic(i)%elements)
        associate (element => model%inelastic(i)%elements(e))
          self%takes_part(element) = self%takes_part(element) .or. &
                                     any(is_near(model%mesh%nodes(:, element)))
        end associate
      end do
    end do
    !$omp end parallel do
  end subroutine add_near

  !> The next updates are those of the elements that take part.
  subroutine tell_blocks(self, model, answers)
    class(element_choice), intent(in) :: self
    type(problem), intent(in) :: model
    type(block_answer), intent(inout) :: answers(:) !< (blocks)
    integer :: i
    do i = 1, size(answers)
      answers(i)%takes_part(:) = self%takes_part(model%inelastic(i)%elements)
    end do
  end subroutine tell_blocks
end module changing_elements
