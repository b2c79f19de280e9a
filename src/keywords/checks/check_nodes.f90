!> Warns of supports, forces, initial values and requests at nodes where they have no effect.
module check_nodes
  use deck_card, only: card
  use deck_scan, only: is_keyword, steps_of_cards
  use diagnostics, only: diagnostic_list
  use kinds, only: rk
  use model_draft, only: draft
  use named_things, only: nodes_at, nodes_of_set
  use write_text, only: as_text
  implicit none
  private
  public :: warn_of_nodes

contains

  !> The deck must have no errors.
  subroutine warn_of_nodes(model, faults)
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer, allocatable :: nodes(:)
    logical, allocatable :: is_held(:, :), is_there(:)
    integer :: step(size(model%cards))
    integer :: i, s
    step = steps_of_cards(model%cards)
    s = 0
    do i = 1, size(step)
      associate (this => model%cards(i))
        if (is_keyword(this, 'NODE PRINT')) then
          if (.not. this%has('NSET')) cycle
          call nodes_of_set(this, 'NSET', model, faults, nodes)
          call warn_of_bare_nodes(this, 0, nodes, model, 'its fields stay zero', faults)
        else if (is_keyword(this, 'BOUNDARY') .or. is_keyword(this, 'INITIAL CONDITIONS') .or. &
                 is_keyword(this, 'CLOAD')) then
          if (max(step(i), 1) /= s) then
            s = max(step(i), 1)
            call mark_held(model, s, is_held)
            is_there = nodes_there(model, s)
          end if
          call warn_of_lines(this, model, is_held, is_there, faults)
        end if
      end associate
    end do
    call warn_of_velocities(model, faults)
    call warn_of_second_values(model, faults)
  end subroutine warn_of_nodes

  !> The nodes that have an element in a step.
  function nodes_there(model, s) result(is_there)
    type(draft), intent(in) :: model
    integer, intent(in) :: s !< step
    logical :: is_there(model%problem%mesh%num_nodes)
    integer :: e, n
    is_there = model%has_element
    if (.not. allocated(model%problem%stages%is_absent)) return
    is_there = .false.
    associate (mesh => model%problem%mesh)
      do e = 1, mesh%num_elements
        if (model%problem%stages%is_absent(e, s)) cycle
        do n = 1, size(mesh%nodes, 1)
          if (mesh%nodes(n, e) > 0) is_there(mesh%nodes(n, e)) = .true.
        end do
      end do
    end associate
  end function nodes_there

  !> The lines of *BOUNDARY, *CLOAD and *INITIAL CONDITIONS.
  subroutine warn_of_lines(this, model, is_held, is_there, faults)
    type(card), intent(in) :: this
    type(draft), intent(in) :: model
    logical, intent(in) :: is_held(:, :) !< (3, nodes) in the step of the card
    logical, intent(in) :: is_there(:) !< (nodes) has an element in this step
    type(diagnostic_list), intent(inout) :: faults
    type(diagnostic_list) :: dropped ! the reader of the card has given these warnings
    integer, allocatable :: nodes(:)
    integer :: line
    do line = 1, this%num_lines
      call nodes_at(this, line, 1, model, dropped, nodes)
      if (is_keyword(this, 'BOUNDARY')) then
        call warn_of_bare_nodes(this, line, nodes, model, 'its support has no effect', faults)
        if (.not. moves(this, line)) cycle
        call warn_of_absence(this, line, nodes, model, is_there, &
                             'its displacement has no effect until the node has one', faults)
      else
        call warn_of_value(this, line, nodes, model, is_held, faults)
        if (.not. is_keyword(this, 'CLOAD')) cycle
        call warn_of_absence(this, line, nodes, model, is_there, &
                             'the force on it has no effect', faults)
      end if
    end do
  end subroutine warn_of_lines

  !> Whether a line of *BOUNDARY prescribes a displacement other than zero.
  pure logical function moves(this, line)
    type(card), intent(in) :: this
    integer, intent(in) :: line
    moves = .false.
    if (this%word('TYPE') /= 'DISPLACEMENT' .or. this%is_empty_at(line, 4)) return
    moves = abs(this%real_at(line, 4)) > 0.0_rk
  end function moves

  !> A force or a displacement on nodes whose elements *MODEL CHANGE has removed.
  subroutine warn_of_absence(this, line, nodes, model, is_there, why, faults)
    type(card), intent(in) :: this
    integer, intent(in) :: line, nodes(:)
    type(draft), intent(in) :: model
    logical, intent(in) :: is_there(:) !< (nodes) has an element in this step
    character(*), intent(in) :: why !< it matters
    type(diagnostic_list), intent(inout) :: faults
    character(:), allocatable :: problem
    integer, allocatable :: absent(:)
    absent = pack(nodes, model%has_element(nodes) .and. .not. is_there(nodes))
    if (size(absent) == 0) return
    problem = 'node '//as_text(model%problem%mesh%node_id(absent(1)))// &
              ' has no element in this step (*MODEL CHANGE): '//why
    if (size(absent) > 1) problem = problem//'; also '//as_text(size(absent) - 1)// &
                                    ' more of the set'
    call this%warn_at(faults, line, 1, problem)
  end subroutine warn_of_absence

  !> Nodes none of which has an element.
  subroutine warn_of_bare_nodes(this, line, nodes, model, why, faults)
    type(card), intent(in) :: this
    integer, intent(in) :: line !< 0: the keyword line
    integer, intent(in) :: nodes(:)
    type(draft), intent(in) :: model
    character(*), intent(in) :: why !< it matters
    type(diagnostic_list), intent(inout) :: faults
    character(:), allocatable :: problem
    if (size(nodes) == 0) return
    if (any(model%has_element(nodes))) return
    problem = 'node '//as_text(model%problem%mesh%node_id(nodes(1)))//' belongs to no element: '// &
              why
    if (size(nodes) > 1) problem = problem//'; also '//as_text(size(nodes) - 1)//' more of the set'
    if (line > 0) call this%warn_at(faults, line, 1, problem)
    if (line == 0) call this%warn(faults, problem)
  end subroutine warn_of_bare_nodes

  !> A force or an initial value at nodes that supports hold.
  subroutine warn_of_value(this, line, nodes, model, is_held, faults)
    type(card), intent(in) :: this
    integer, intent(in) :: line, nodes(:)
    type(draft), intent(in) :: model
    logical, intent(in) :: is_held(:, :) !< (3, nodes) in the step of the card
    type(diagnostic_list), intent(inout) :: faults
    character(:), allocatable :: what
    what = 'the force goes to the support'
    if (is_keyword(this, 'INITIAL CONDITIONS')) then
      what = 'its initial value has no effect'
      call warn_of_bare_nodes(this, line, nodes, model, what, faults)
      if (this%word('TYPE') /= 'VELOCITY') return ! a support begins at a displacement
    end if
    if (size(nodes) == 0 .or. abs(this%real_at(line, 3)) <= 0.0_rk) return
    if (.not. all(is_held(this%integer_at(line, 2), nodes))) return
    call this%warn_at(faults, line, 1, 'node '//as_text(model%problem%mesh%node_id(nodes(1)))// &
                      ' is held in direction '//as_text(this%integer_at(line, 2))//': '//what)
  end subroutine warn_of_value

  !> Degrees of freedom that supports of a step hold.
  pure subroutine mark_held(model, s, is_held)
    type(draft), intent(in) :: model
    integer, intent(in) :: s !< step
    logical, allocatable, intent(out) :: is_held(:, :) !< (3, nodes)
    integer :: i
    allocate (is_held(3, model%problem%mesh%num_nodes), source=.false.)
    associate (supports => model%problem%steps(s)%fixities)
      do i = 1, size(supports)
        is_held(supports(i)%dof, supports(i)%node) = .true.
      end do
    end associate
  end subroutine mark_held

  !> Initial velocities of a model that no step moves; *STATIC has a warning of its own.
  subroutine warn_of_velocities(model, faults)
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer :: i
    if (.not. all(model%problem%steps%procedure%finds_modes)) return
    do i = 1, size(model%cards)
      if (.not. is_keyword(model%cards(i), 'INITIAL CONDITIONS')) cycle
      if (model%cards(i)%word('TYPE') /= 'VELOCITY') cycle
      call model%cards(i)%warn(faults, 'initial velocities have no effect: no step moves the model')
      return
    end do
  end subroutine warn_of_velocities

  !> Two initial values of one degree of freedom.
  subroutine warn_of_second_values(model, faults)
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    real(rk), allocatable :: value(:, :, :) !< (3, nodes, velocity or displacement)
    logical, allocatable :: is_set(:, :, :)
    integer :: i, k, place
    if (size(model%problem%initial_values) == 0) return
    allocate (value(3, model%problem%mesh%num_nodes, 2), source=0.0_rk)
    allocate (is_set(3, model%problem%mesh%num_nodes, 2), source=.false.)
    do i = 1, size(model%problem%initial_values)
      associate (given => model%problem%initial_values(i))
        k = merge(1, 2, given%is_velocity)
        if (is_set(given%dof, given%node, k)) then
          if (abs(value(given%dof, given%node, k) - given%value) > 0.0_rk) exit
        end if
        is_set(given%dof, given%node, k) = .true.
        value(given%dof, given%node, k) = given%value
      end associate
    end do
    if (i > size(model%problem%initial_values)) return
    do place = size(model%cards), 1, -1
      if (.not. is_keyword(model%cards(place), 'INITIAL CONDITIONS')) cycle
      if (model%cards(place)%word('TYPE') == merge('VELOCITY    ', 'DISPLACEMENT', k == 1)) exit
    end do
    associate (given => model%problem%initial_values(i))
      call model%cards(place)%warn( &
        faults, 'node '//as_text(model%problem%mesh%node_id(given%node))//' already has '// &
        'the initial '//trim(merge('velocity    ', 'displacement', k == 1))//' '// &
        as_text(value(given%dof, given%node, k))//' in direction '//as_text(given%dof)// &
        '; the later value '//as_text(given%value)//' is used')
    end associate
  end subroutine warn_of_second_values
end module check_nodes
