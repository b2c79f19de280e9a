!> *CLOAD, *DLOAD, *DSLOAD.
module keywords_loads
  use applied_load, only: load
  use deck_card, only: card
  use decimal_commas, only: with_hint_of_point
  use diagnostics, only: diagnostic_list
  use dload_labels, only: choices_of_labels, dload_label, find_label, in_place_of, &
                          labels_in_words, list_labels, meaning_of_labels, num_labels, pattern_of
  use element_catalogue, only: is_solid
  use enter_load, only: put_load
  use keyword_spec, only: keyword, field, kind_choice, kind_integer, kind_real, kind_reference, &
                          kind_word
  use keywords_other, only: add_idle_parameters, add_refused_parameter, shifted_history
  use kinds, only: rk
  use load_pressure, only: pressure_load
  use model_draft, only: draft
  use named_things, only: elements_at, find_amplitude, find_surface_at, nodes_at
  use nearest_words, only: nearest_choice
  use write_text, only: as_text
  implicit none
  private
  public :: describe_cload, describe_dload, describe_dsload, read_cload, read_dload, read_dsload

  character, parameter :: nl = new_line('a')

contains

  !> OP and AMPLITUDE, which all loads have.
  subroutine add_load_parameters(spec)
    type(keyword), intent(inout) :: spec
    allocate (spec%parameters, source=[ &
              field('OP', kind_choice, 'keep the loads of earlier steps, or clear them', &
                    default='MOD', choices='MOD | NEW'), &
              field('AMPLITUDE', kind_word, 'history that scales the loads')])
    call add_idle_parameters(spec, ['FOLLOWER          ', 'CONSTANT RESULTANT'])
    call add_refused_parameter(spec, 'TIME DELAY', shifted_history)
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
                             'one amplitude for the forces of a degree of freedom in a step: '// &
                             'an *AMPLITUDE with the sum of these histories, and the force 1')
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
    spec%meaning = 'Weight and pressures on elements. '//meaning_of_labels()
    spec%example = '*DLOAD'//nl//'DAM, GRAV, 9.81, 0., 0., -1.'//nl//'UPSTREAM, P3, 1e5'//nl// &
                   'UPSTREAM, HP3, 1.03e6, 105., 0.'
    spec%checks_own_data = .true.
    allocate (spec%columns, source=[ &
              field('element', kind_reference, 'the elements; GRAV without them: all solids'), &
              field('label', kind_choice, 'what acts', is_required=.true., &
                    choices=choices_of_labels()), &
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
    type(dload_label) :: labels(num_labels)
    integer, allocatable :: elements(:)
    integer :: line, history, num_before, found
    call list_labels(labels)
    call find_amplitude(this, model, faults, history)
    if (this%word('OP') == 'NEW') call model%active_loads%clear_old('DLOAD')
    do line = 1, this%num_lines
      num_before = faults%num_errors
      call find_elements(this, line, model, faults, elements)
      call check_label(this, line, labels, found, faults)
      if (faults%num_errors > num_before) cycle
      call labels(found)%put(this, line, elements, history, model, faults)
    end do
  end subroutine read_dload

  !> Elements of a line; gravity without elements acts on all solids.
  subroutine find_elements(this, line, model, faults, elements)
    type(card), intent(in) :: this
    integer, intent(in) :: line
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer, allocatable, intent(out) :: elements(:) !< positions
    integer :: e
    if (this%is_empty_at(line, 1) .and. this%word_at(line, 2) == 'GRAV') then
      associate (mesh => model%problem%mesh)
        elements = pack([(e, e=1, mesh%num_elements)], is_solid(mesh%element_type))
      end associate
    else
      call elements_at(this, line, 1, model, faults, elements)
    end if
  end subroutine find_elements

  !> Checks the label of a line and its numbers.
  subroutine check_label(this, line, labels, found, faults)
    type(card), intent(in) :: this
    integer, intent(in) :: line
    type(dload_label), intent(in) :: labels(:)
    integer, intent(out) :: found !< position of the label, 0 when there is none
    type(diagnostic_list), intent(inout) :: faults
    character(:), allocatable :: choices, instead
    integer :: i
    found = find_label(labels, this%word_at(line, 2))
    if (found == 0) then
      choices = choices_of_labels()
      instead = in_place_of(this%word_at(line, 2))
      if (len(instead) == 0) then
        call this%fault_at(faults, line, 2, "found '"//this%text_at(line, 2)//"'", &
                           labels_in_words(), nearest_choice(this%word_at(line, 2), choices))
      else
        call this%fault_at(faults, line, 2, "found '"//this%text_at(line, 2)//"'", instead)
      end if
      return
    end if
    associate (label => labels(found))
      if (this%num_fields(line) > label%num_numbers + 2) then
        call this%fault_at(faults, line, label%num_numbers + 3, 'too many numbers', &
                           with_hint_of_point(label%expected, this%line_as_written(line)))
      end if
      do i = 3, label%num_numbers + 2
        if (this%is_real_at(line, i)) cycle
        if (this%is_empty_at(line, i) .and. i > label%fewest_numbers + 2) cycle
        call this%fault_at(faults, line, i, "found '"//this%text_at(line, i)//"'", label%expected)
        return
      end do
    end associate
  end subroutine check_label

  subroutine describe_dsload(spec)
    type(keyword), intent(out) :: spec
    call add_load_parameters(spec)
    spec%name = 'DSLOAD'
    spec%meaning = 'Pressure on a surface, positive towards the solid: P, uniform; HP, p, '// &
                   'z_top, z_ref: hydrostatic along axis 3, zero at z_top and above, p at z_ref.'
    spec%example = '*DSLOAD, AMPLITUDE=FILLING'//nl//'UPSTREAM, P, 1e5'//nl// &
                   'UPSTREAM, HP, 1.03e6, 105., 0.'
    allocate (spec%columns, source=[ &
              field('surface', kind_word, 'name of a surface', is_required=.true.), &
              field('label', kind_choice, 'what acts', is_required=.true., choices='P | HP'), &
              field('magnitude', kind_real, 'pressure', 'Pa', is_required=.true.), &
              field('z_top', kind_real, 'HP: height of pressure zero', 'm'), &
              field('z_ref', kind_real, 'HP: height of the pressure given', 'm')])
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
      call read_variation(this, line, push, faults)
      if (allocated(item)) deallocate (item) ! of a line that changes a load of an earlier step
      allocate (item, source=push)
      call put_load(model, item, 'pressure '//this%word_at(line, 1), 'DSLOAD', &
                    this%word_at(line, 1)//trim(merge(' HP', '   ', push%is_hydrostatic)), &
                    pattern_of([push%top, push%reference], size(push%faces%element)), &
                    this%real_at(line, 3), history)
    end do
  end subroutine read_dsload

  !> Heights of a hydrostatic pressure.
  subroutine read_variation(this, line, push, faults)
    type(card), intent(in) :: this
    integer, intent(in) :: line
    type(pressure_load), intent(inout) :: push
    type(diagnostic_list), intent(inout) :: faults
    integer :: i
    push%is_hydrostatic = this%word_at(line, 2) == 'HP'
    push%top = this%real_at(line, 4)
    push%reference = this%real_at(line, 5)
    if (.not. push%is_hydrostatic) then
      if (this%num_fields(line) > 3) call this%fault_at(faults, line, 4, 'too many numbers', &
                                                        'surface, P, a pressure [Pa]')
      return
    end if
    do i = 4, 5
      if (.not. this%is_empty_at(line, i)) cycle
      call this%fault_at(faults, line, i, 'a height is missing', 'p [Pa], z_top, z_ref [m]')
      return
    end do
    if (push%reference >= push%top) call this%fault_at(faults, line, 5, "found '"// &
                                                       this%text_at(line, 5)//"'", &
                                                       'z_ref below z_top')
  end subroutine read_variation
end module keywords_loads
