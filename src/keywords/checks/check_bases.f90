!> Warns of nodes of joint elements without solids that supports do not hold in all directions: they
!> have no unknowns, and stand at their places.
module check_bases
  use diagnostics, only: diagnostic_list
  use model_draft, only: draft
  use node_dofs, only: num_directions
  use write_text, only: as_text
  implicit none
  private
  public :: warn_of_bases

contains

  !> The deck must have no errors.
  subroutine warn_of_bases(model, faults)
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    logical :: is_bare(model%problem%mesh%num_nodes)
    integer :: held(model%problem%mesh%num_nodes)
    integer :: s, k, node
    call find_bare(model, is_bare)
    if (.not. any(is_bare)) return
    do s = 1, size(model%problem%steps)
      held = 0
      associate (fixed => model%problem%steps(s)%fixities)
        do k = 1, size(fixed)
          held(fixed(k)%node) = held(fixed(k)%node) + 1
        end do
      end associate
      ! A node without any support may follow others by an equation.
      node = findloc(is_bare .and. held < num_directions &
                     .and. (held > 0 .or. model%equations%num == 0), .true., 1)
      if (node == 0) cycle
      call model%cards(model%procedure_card(s))%warn( &
        faults, 'node '//as_text(model%problem%mesh%node_id(node))//' belongs to joint '// &
        'elements alone and is not held in all directions: it stands at its place, without '// &
        'reactions', &
        'supports in all directions')
      return
    end do
  end subroutine warn_of_bases

  !> Nodes of joint elements that no solid has, nor a quadrilateral that springs couple to one.
  subroutine find_bare(model, is_bare)
    type(draft), intent(in) :: model
    logical, intent(out) :: is_bare(:) !< (nodes)
    logical :: has_solid(size(is_bare))
    integer :: e, k
    is_bare = .false.
    has_solid = .false.
    associate (mesh => model%problem%mesh)
      do e = 1, mesh%num_elements
        do k = 1, size(mesh%nodes, 1)
          if (mesh%nodes(k, e) == 0) cycle
          if (mesh%element_type(e) == 'JOINT8') is_bare(mesh%nodes(k, e)) = .true.
          if (mesh%material_of_element(e) > 0 .or. mesh%element_type(e) == 'IFACE4') then
            has_solid(mesh%nodes(k, e)) = .true.
          end if
        end do
      end do
    end associate
    is_bare = is_bare .and. .not. has_solid
  end subroutine find_bare
end module check_bases
