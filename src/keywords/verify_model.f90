!> Checks before the analysis: shape of elements, mass where it is needed, supports.
module verify_model
  use body_parts, only: find_bodies, free_motion
  use diagnostics, only: diagnostic_list
  use guest_list, only: bonds_of_model, supports_of_step
  use kinds, only: rk
  use load_gravity, only: gravity_load
  use model_draft, only: draft
  use row_tables, only: row_table
  use sorted_lists, only: contains_position
  use verify_blocks, only: verify_free_blocks
  use verify_elements, only: refuse_inverted, warn_of_corners
  use verify_precision, only: verify_precisions
  use verify_reduced, only: verify_reduced_steps
  use verify_ties, only: verify_tied_parts
  use write_text, only: as_text
  implicit none
  private
  public :: verify

contains

  !> Reports all faults of the complete model.
  subroutine verify(model, faults)
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    call refuse_inverted(model, faults) ! once more: ties and clearances have moved nodes
    call warn_of_corners(model, faults)
    call verify_mass(model, faults)
    call verify_modes(model, faults)
    call verify_velocities(model, faults)
    call verify_reduced_steps(model, faults)
    call verify_precisions(model, faults)
    if (.not. faults%has_errors()) call verify_weight(model, faults)
    if (.not. faults%has_errors()) call verify_supports(model, faults)
    if (.not. faults%has_errors()) call verify_tied_parts(model, faults)
    if (.not. faults%has_errors()) call verify_free_blocks(model, faults)
  end subroutine verify

  !> Dynamic and frequency steps need a mass.
  subroutine verify_mass(model, faults)
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer :: i
    if (any(model%problem%materials%density > 0.0_rk)) return
    do i = 1, size(model%problem%steps)
      if (model%problem%steps(i)%procedure%is_static()) cycle
      call model%cards(model%procedure_card(i))%fault( &
        faults, 'no material has a mass', '*DENSITY in a *MATERIAL')
      return
    end do
  end subroutine verify_mass

  !> A model has no more modes than free degrees of freedom. Those without mass, and those that ties
  !> and equations hold, are known when the step is built.
  subroutine verify_modes(model, faults)
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer :: i, num_free
    do i = 1, size(model%problem%steps)
      associate (plan => model%problem%steps(i), this => model%cards(model%procedure_card(i)))
        if (.not. plan%procedure%finds_modes .or. this%num_lines == 0) cycle
        num_free = 3*count(model%has_element) - &
                   count(model%has_element(plan%fixities%node))
        if (plan%num_modes <= num_free) cycle
        call this%fault_at(faults, 1, 1, "found '"//this%text_at(1, 1)//"'", &
                           'at most '//as_text(num_free)//' modes: the model has no more free '// &
                           'degrees of freedom')
      end associate
    end do
  end subroutine verify_modes

  !> Gravity on a model without mass is reported at its first card.
  subroutine verify_weight(model, faults)
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    logical :: is_told(size(model%problem%loads))
    integer :: s, i
    is_told = .false.
    do s = 1, size(model%problem%steps)
      do i = 1, size(model%problem%steps(s)%loads)
        associate (number => model%problem%steps(s)%loads(i)%load)
          if (is_told(number)) cycle
          is_told(number) = .true.
          select type (weight => model%problem%loads(number)%item)
          type is (gravity_load)
            if (has_mass(model, weight%elements)) cycle
            call model%cards(model%procedure_card(s))%warn( &
              faults, weight%name//' has no effect: none of its elements has a *DENSITY')
          end select
        end associate
      end do
    end do
  end subroutine verify_weight

  pure logical function has_mass(model, elements)
    type(draft), intent(in) :: model
    integer, intent(in) :: elements(:) !< positions
    integer :: i, number
    has_mass = .false.
    do i = 1, size(elements)
      number = model%problem%mesh%material_of_element(elements(i))
      if (number == 0) cycle
      has_mass = model%problem%materials(number)%density > 0.0_rk
      if (has_mass) return
    end do
  end function has_mass

  !> Initial velocities need a dynamic first step.
  subroutine verify_velocities(model, faults)
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer :: i
    if (.not. any(model%problem%initial_values%is_velocity)) return
    do i = 1, size(model%problem%steps)
      if (model%problem%steps(i)%procedure%has_inertia) return
      if (.not. model%problem%steps(i)%procedure%is_static()) cycle
      call model%cards(model%procedure_card(i))%warn( &
        faults, 'a static step sets the initial velocities (*INITIAL CONDITIONS) to zero')
      return
    end do
  end subroutine verify_velocities

  !> In static and frequency steps supports must prevent all rigid motions of each body.
  subroutine verify_supports(model, faults)
    type(draft), intent(in), target :: model
    type(diagnostic_list), intent(inout) :: faults
    type(row_table) :: groups
    integer, allocatable :: body(:), example(:), node(:), direction(:)
    integer :: i, b
    logical, allocatable :: is_in_equation(:) !< (bodies)
    integer :: num_before
    call bonds_of_model(model%problem, groups)
    call find_bodies(model%problem%mesh, groups, body, example)
    allocate (is_in_equation(size(example)), source=.false.)
    if (model%equations%num > 0) then
      do i = 1, model%equations%first(model%equations%num + 1) - 1
        b = body(model%equations%node(i))
        if (b > 0) is_in_equation(b) = .true.
      end do
    end if
    num_before = faults%num_errors
    do i = 1, size(model%problem%steps)
      associate (step => model%problem%steps(i), place => model%cards(model%procedure_card(i)))
        if (step%procedure%has_inertia) cycle
        call supports_of_step(model%problem, step, node, direction)
        if (size(node) == 0) then
          call place%fault(faults, 'the model has no supports in this step', '*BOUNDARY')
        else
          do b = 1, size(example)
            if (is_in_equation(b)) cycle ! equations may hold what no support holds
            call verify_body(model, i, pack(node, body(node) == b), &
                             pack(direction, body(node) == b), example(b), faults)
          end do
        end if
      end associate
      if (faults%num_errors > num_before) return
    end do
  end subroutine verify_supports

  subroutine verify_body(model, number, nodes, dofs, example, faults)
    type(draft), intent(in) :: model
    integer, intent(in) :: number !< of the step
    integer, intent(in) :: nodes(:), dofs(:) !< supports of the body
    integer, intent(in) :: example !< an element of it
    type(diagnostic_list), intent(inout) :: faults
    character(:), allocatable :: motion
    motion = free_motion(model%problem%mesh%x(:, nodes), dofs)
    if (motion == '') return
    call model%cards(model%procedure_card(number))%fault( &
      faults, 'the body with element '//as_text(model%problem%mesh%element_id(example))// &
      set_of_element(model, example)//' is not held: the body can '//motion, &
      'supports (*BOUNDARY), or a joint to a supported body')
  end subroutine verify_body

  !> ' of set DAM', or '' when the element is in no set.
  function set_of_element(model, element) result(text)
    type(draft), intent(in) :: model
    integer, intent(in) :: element !< position
    character(:), allocatable :: text
    integer :: i
    text = ''
    do i = 1, size(model%problem%element_sets)
      if (.not. contains_position(model%problem%element_sets(i)%members, element)) cycle
      text = ' of set '//model%problem%element_sets(i)%name
      return
    end do
  end function set_of_element
end module verify_model
