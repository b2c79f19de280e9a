!> *CLOAD, *DLOAD, *DSLOAD.
module keywords_loads
  use applied_load, only: load
  use deck_card, only: card
  use diagnostics, only: diagnostic_list
  use element_catalogue, only: is_solid
  use enter_load, only: put_load
  use keyword_spec, only: keyword, field, kind_choice, kind_integer, kind_real, kind_reference, &
                          kind_word
  use kinds, only: rk
  use load_gravity, only: gravity_load
  use load_pressure, only: face_of_word, faces_of_elements, pressure_load
  use model_draft, only: draft
  use named_things, only: elements_at, find_amplitude, find_surface_at, nodes_at
  use nearest_words, only: nearest_choice
  use write_text, only: as_text
  implicit none
  private
  public :: describe_cload, describe_dload, describe_dsload, read_cload, read_dload, read_dsload

  character, parameter :: nl = new_line('a')
  character(*), parameter :: labels = 'GRAV | P1 | P2 | P3 | P4 | P5 | P6 | HP1 | HP2 | HP3 | '// &
                             'HP4 | HP5 | HP6'

contains

  !> OP and AMPLITUDE, which all loads have.
  subroutine add_load_parameters(spec)
    type(keyword), intent(inout) :: spec
    allocate (spec%parameters, source=[ &
              field('OP', kind_choice, 'keep the loads of earlier steps, or clear them', &
                    default='MOD', choices='MOD | NEW'), &
              field('AMPLITUDE', kind_word, 'history that scales the loads')])
    spec%family = 'load'
    spec%place = 'step'
    spec%fewest_lines = 1
    spec%new_clears = .true.
  end subroutine add_load_parameters

  subroutine describe_cload(spec)
    type(keyword), intent(out) :: spec
    call add_load_parameters(spec)
    spec%name = 'CLOAD'
    spec%meaning = 'Forces at nodes. Forces given twice in one step add up; a force of a '// &
                   'later step replaces the earlier one.'
    spec%example = '*CLOAD'//nl//'TIP, 3, -1000.'
    allocate (spec%columns, source=[ &
              field('node', kind_reference, 'the nodes', &
                    is_required=.true.), &
              field('dof', kind_integer, 'direction', is_required=.true., &
                    lowest=1.0_rk, highest=3.0_rk), &
              field('force', kind_real, 'force on each node', 'N', is_required=.true.)])
  end subroutine describe_cload

  subroutine read_cload(this, model, faults)
    type(card), intent(in) :: this
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer, allocatable :: nodes(:)
    integer :: line, history
    call find_amplitude(this, model, faults, history)
    if (this%word('OP') == 'NEW') call model%point_forces%clear_old()
    do line = 1, this%num_lines
      call nodes_at(this, line, 1, model, faults, nodes)
      if (this%integer_at(line, 2) < 1 .or. this%integer_at(line, 2) > 3) cycle ! reported already
      call check_nodes(this, line, nodes, model, faults)
      associate (table => model%point_forces, dof => this%integer_at(line, 2))
        if (any(table%is_new(dof, nodes) .and. table%history(dof, nodes) /= history)) then
          call this%fault_at(faults, line, 1, 'a force with another amplitude acts there', &
                             'one amplitude for the forces of a degree of freedom in a step')
        end if
        call table%add(nodes, dof, this%real_at(line, 3), history)
      end associate
    end do
  end subroutine read_cload

  !> A force needs an element that takes it.
  subroutine check_nodes(this, line, nodes, model, faults)
    type(card), intent(in) :: this
    integer, intent(in) :: line, nodes(:)
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    character(:), allocatable :: problem
    integer :: num_bare, i
    num_bare = count(.not. model%has_element(nodes))
    if (num_bare == 0 .or. faults%has_errors()) return ! the elements may have faults
    i = nodes(findloc(model%has_element(nodes), .false., dim=1))
    problem = 'node '//as_text(model%problem%mesh%node_id(i))// &
              ' belongs to no element: the force on it has no effect'
    if (num_bare == size(nodes)) then
      call this%fault_at(faults, line, 1, problem, 'nodes of elements')
    else
      if (num_bare > 1) problem = problem//'; also '//as_text(num_bare - 1)//' more of the set'
      call this%warn_at(faults, line, 1, problem)
    end if
  end subroutine check_nodes

  subroutine describe_dload(spec)
    type(keyword), intent(out) :: spec
    call add_load_parameters(spec)
    spec%name = 'DLOAD'
    spec%meaning = 'Weight and pressures on elements. GRAV, g, x, y, z: an acceleration along '// &
                   '(x, y, z), a vector of any length. P1..P6, p: pressure on a face, '// &
                   'positive towards the element. HP1..HP6, p, z_top, z_ref: hydrostatic along '// &
                   'axis 3, zero at z_top and above, p at z_ref.'
    spec%example = '*DLOAD'//nl//'DAM, GRAV, 9.81, 0., 0., -1.'//nl//'UPSTREAM, P3, 1e5'//nl// &
                   'UPSTREAM, HP3, 1.03e6, 105., 0.'
    spec%checks_own_data = .true.
    allocate (spec%columns, source=[ &
              field('element', kind_reference, 'the elements'), &
              field('label', kind_choice, 'what acts', is_required=.true., choices=labels), &
              field('magnitude', kind_real, 'acceleration [m/s2] or pressure [Pa]', &
                    is_required=.true.), &
              field('x or z_top', kind_real, 'direction, or height of pressure zero [m]'), &
              field('y or z_ref', kind_real, 'direction, or height of pressure p [m]'), &
              field('z', kind_real, 'direction')])
  end subroutine describe_dload

  subroutine read_dload(this, model, faults)
    type(card), intent(in) :: this
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer, allocatable :: elements(:)
    integer :: line, history, num_before
    call find_amplitude(this, model, faults, history)
    if (this%word('OP') == 'NEW') call model%active_loads%clear_old('DLOAD')
    do line = 1, this%num_lines
      num_before = faults%num_errors
      call elements_at(this, line, 1, model, faults, elements)
      call check_label(this, line, faults)
      if (faults%num_errors > num_before) cycle
      if (this%word_at(line, 2) == 'GRAV') then
        call put_gravity(this, line, elements, history, model, faults)
      else
        call put_pressure(this, line, elements, history, model, faults)
      end if
    end do
  end subroutine read_dload

  !> The label and its numbers.
  subroutine check_label(this, line, faults)
    type(card), intent(in) :: this
    integer, intent(in) :: line
    type(diagnostic_list), intent(inout) :: faults
    character(:), allocatable :: label, expected
    integer :: num_numbers, i
    label = this%word_at(line, 2)
    if (index(' | '//labels//' | ', ' | '//label//' | ') == 0 .or. label == '') then
      call this%fault_at(faults, line, 2, "found '"//this%text_at(line, 2)//"'", &
                         'GRAV, P1..P6 or HP1..HP6', nearest_choice(label, labels))
      return
    end if
    num_numbers = 1
    expected = 'a pressure [Pa]'
    if (label(1:1) == 'H') num_numbers = 3
    if (label(1:1) == 'H') expected = 'p [Pa], z_top, z_ref [m]'
    if (label == 'GRAV') num_numbers = 4
    if (label == 'GRAV') expected = 'g [m/s2] and the direction x, y, z'
    if (this%num_fields(line) > num_numbers + 2) then
      call this%fault_at(faults, line, num_numbers + 3, 'too many numbers', expected)
    end if
    if (label == 'GRAV' .and. any(this%num_fields(line) == [4, 5])) then
      call this%fault_at(faults, line, this%num_fields(line) + 1, 'the direction of gravity '// &
                         'has '//as_text(this%num_fields(line) - 3)//' of 3 components', expected)
      return
    end if
    do i = 3, num_numbers + 2
      if (this%is_real_at(line, i)) cycle
      if (label == 'GRAV' .and. this%is_empty_at(line, i) .and. i > 3) cycle
      call this%fault_at(faults, line, i, "found '"//this%text_at(line, i)//"'", expected)
      return
    end do
  end subroutine check_label

  subroutine put_gravity(this, line, elements, history, model, faults)
    type(card), intent(in) :: this
    integer, intent(in) :: line, elements(:), history
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(gravity_load) :: weight
    class(load), allocatable :: item
    real(rk) :: direction(3)
    direction = [this%real_at(line, 4), this%real_at(line, 5), this%real_at(line, 6)]
    if (norm2(direction) <= 0.0_rk) then
      call this%fault_at(faults, line, 4, 'gravity without a direction', &
                         'x, y, z of the direction')
      return
    end if
    direction = direction/norm2(direction)
    weight%kind = 'gravity'
    weight%elements = elements
    weight%acceleration = direction
    allocate (item, source=weight)
    call put_load(model, item, 'gravity '//this%word_at(line, 1), 'DLOAD', &
                  this%word_at(line, 1)//' GRAV', pattern_of(direction), &
                  this%real_at(line, 3), history)
  end subroutine put_gravity

  subroutine put_pressure(this, line, elements, history, model, faults)
    type(card), intent(in) :: this
    integer, intent(in) :: line, elements(:), history
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(pressure_load) :: push
    class(load), allocatable :: item
    character(:), allocatable :: label
    real(rk) :: heights(2)
    label = this%word_at(line, 2)
    if (.not. all(is_solid(model%problem%mesh%element_type(elements)))) then
      call this%fault_at(faults, line, 1, 'pressure on an element that is not a solid', &
                         'solid elements')
      return
    end if
    push%kind = 'pressure'
    push%faces = faces_of_elements(elements, face_of_word(label))
    push%pressure = 1.0_rk
    push%is_hydrostatic = label(1:1) == 'H'
    heights = 0.0_rk
    if (push%is_hydrostatic) then
      heights = [this%real_at(line, 4), this%real_at(line, 5)]
      if (heights(2) >= heights(1)) then
        call this%fault_at(faults, line, 5, "found '"//this%text_at(line, 5)//"'", &
                           'z_ref below z_top, '//this%text_at(line, 4)//' m')
        return
      end if
      push%top = heights(1)
      push%reference = heights(2)
    end if
    allocate (item, source=push)
    call put_load(model, item, 'pressure '//this%word_at(line, 1)//' '//label, 'DLOAD', &
                  this%word_at(line, 1)//' '//label, pattern_of(heights), &
                  this%real_at(line, 3), history)
  end subroutine put_pressure

  !> Numbers as a text to compare: equal texts mean equal patterns.
  pure function pattern_of(numbers) result(text)
    real(rk), intent(in) :: numbers(:)
    character(24*size(numbers)) :: text
    write (text, '(*(es24.16e3))') numbers
  end function pattern_of

  subroutine describe_dsload(spec)
    type(keyword), intent(out) :: spec
    call add_load_parameters(spec)
    spec%name = 'DSLOAD'
    spec%meaning = 'Pressure on a surface, positive towards the solid.'
    spec%example = '*DSLOAD, AMPLITUDE=FILLING'//nl//'UPSTREAM, P, 1e5'
    allocate (spec%columns, source=[ &
              field('surface', kind_word, 'name of a surface', is_required=.true.), &
              field('label', kind_choice, 'what acts', is_required=.true., choices='P'), &
              field('magnitude', kind_real, 'pressure', 'Pa', is_required=.true.)])
  end subroutine describe_dsload

  subroutine read_dsload(this, model, faults)
    type(card), intent(in) :: this
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(pressure_load) :: push
    class(load), allocatable :: item
    integer :: line, history, found
    push%kind = 'pressure'
    push%pressure = 1.0_rk
    call find_amplitude(this, model, faults, history)
    if (this%word('OP') == 'NEW') call model%active_loads%clear_old('DSLOAD')
    do line = 1, this%num_lines
      call find_surface_at(this, line, model, faults, found)
      if (found == 0) cycle
      push%faces = model%problem%surfaces(found)
      allocate (item, source=push)
      call put_load(model, item, 'pressure '//this%word_at(line, 1), 'DSLOAD', &
                    this%word_at(line, 1), '', this%real_at(line, 3), history)
    end do
  end subroutine read_dsload
end module keywords_loads
