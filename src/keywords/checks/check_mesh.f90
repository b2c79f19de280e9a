!> Warns of elements on the same nodes, of doubtful shapes, and of C3D8 in a deck for Abaqus.
module check_mesh
  use check_shapes, only: warn_of_shapes
  use deck_scan, only: is_keyword
  use diagnostics, only: diagnostic_list
  use model_draft, only: draft
  use sorted_lists, only: sorted_unique
  use write_text, only: as_text
  implicit none
  private
  public :: warn_of_mesh

contains

  !> The deck must have no errors.
  subroutine warn_of_mesh(model, faults)
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    call warn_of_twins(model, faults)
    call warn_of_shapes(model, faults)
    call warn_of_c3d8(model, faults)
  end subroutine warn_of_mesh

  !> One warning for all elements that have the nodes of another element of their type.
  subroutine warn_of_twins(model, faults)
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer, allocatable :: twin(:)
    character(:), allocatable :: others
    integer :: e
    call find_twins(model, twin)
    e = findloc(twin > 0, .true., dim=1)
    if (e == 0) return
    others = ''
    if (count(twin > 0) > 1) others = '; '//as_text(count(twin > 0))//' elements in all'
    associate (mesh => model%problem%mesh, spot => model%element_origin(e))
      call model%cards(spot%card)%warn_at( &
        faults, spot%line, 1, 'element '//as_text(mesh%element_id(e))//' has the nodes of '// &
        'element '//as_text(mesh%element_id(twin(e)))//': both act'//others)
    end associate
  end subroutine warn_of_twins

  !> For each element an earlier one of its type on the same nodes in any order, 0 for none.
  !> Candidates are elements with the same lowest node.
  subroutine find_twins(model, twin)
    type(draft), intent(in) :: model
    integer, allocatable, intent(out) :: twin(:) !< (elements)
    integer, allocatable :: head(:), next(:)
    integer :: e, other, lowest
    associate (mesh => model%problem%mesh)
      allocate (twin(mesh%num_elements), next(mesh%num_elements), head(mesh%num_nodes), source=0)
      do e = 1, mesh%num_elements
        lowest = minval(mesh%nodes(:, e), mask=mesh%nodes(:, e) > 0)
        other = head(lowest)
        do while (other > 0 .and. twin(e) == 0)
          if (have_same_nodes(e, other)) twin(e) = other
          other = next(other)
        end do
        next(e) = head(lowest)
        head(lowest) = e
      end do
    end associate

  contains

    !> Whether two elements have one type and the same nodes.
    logical function have_same_nodes(a, b) result(is_same)
      integer, intent(in) :: a, b !< positions
      integer, allocatable :: of_a(:), of_b(:)
      associate (mesh => model%problem%mesh)
        is_same = mesh%element_type(a) == mesh%element_type(b) .and. &
                  sum(mesh%nodes(:, a)) == sum(mesh%nodes(:, b))
        if (.not. is_same) return
        of_a = sorted_unique(mesh%nodes(:, a))
        of_b = sorted_unique(mesh%nodes(:, b))
        is_same = size(of_a) == size(of_b)
        if (is_same) is_same = all(of_a == of_b)
      end associate
    end function have_same_nodes
  end subroutine find_twins

  !> C3D8 of Abaqus is C3D8B here. Abaqus/CAE names itself in a comment and writes *PREPRINT.
  subroutine warn_of_c3d8(model, faults)
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    logical :: is_for_abaqus
    integer :: i
    if (model%options%c3d8 /= '') return
    is_for_abaqus = model%is_from_cae
    do i = 1, size(model%cards)
      is_for_abaqus = is_for_abaqus .or. model%cards(i)%keyword == 'PREPRINT'
    end do
    if (.not. is_for_abaqus) return
    do i = 1, size(model%cards)
      if (.not. is_keyword(model%cards(i), 'ELEMENT')) cycle
      if (model%cards(i)%word('TYPE') /= 'C3D8') cycle
      call model%cards(i)%warn(faults, 'the deck was written for Abaqus, whose C3D8 is C3D8B '// &
                               '(B-bar) here; C3D8 has full integration', &
                               'TYPE=C3D8B for the element of Abaqus, or --c3d8=bbar; '// &
                               '--c3d8=full for C3D8 without this remark')
      return
    end do
  end subroutine warn_of_c3d8
end module check_mesh
