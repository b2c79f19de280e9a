!> *INITIAL CONDITIONS.
module keywords_initial
  use deck_card, only: card
  use diagnostics, only: diagnostic_list
  use growing_lists, only: append, make_room
  use keyword_spec, only: keyword, field, kind_choice, kind_real, kind_reference
  use keywords_temperature, only: read_initial_temperatures
  use kinds, only: rk
  use model_draft, only: draft
  use named_things, only: nodes_at
  use step_plan, only: initial_value
  implicit none
  private
  public :: describe_initial_conditions, read_initial_conditions

  character, parameter :: nl = new_line('a')

contains

  subroutine describe_initial_conditions(spec)
    type(keyword), intent(out) :: spec
    spec%name = 'INITIAL CONDITIONS'
    spec%family = 'step'
    spec%place = 'model'
    spec%meaning = 'Displacements, velocities or temperatures at the start of the analysis. A '// &
                   'static step sets velocities to zero. Temperatures stand behind the node: '// &
                   'node, temperature [K]; nodes that the deck does not name start at 0.'
    spec%example = '*INITIAL CONDITIONS, TYPE=VELOCITY'//nl//'ALL, 1, -1.'//nl// &
                   '*INITIAL CONDITIONS, TYPE=TEMPERATURE'//nl//'ALL, 8.'
    spec%fewest_lines = 1
    allocate (spec%parameters, source=[ &
              field('TYPE', kind_choice, 'kind of the values', is_required=.true., &
                    choices='DISPLACEMENT | VELOCITY | TEMPERATURE', rules_lines=.true., &
                    instead='for stresses, a first step *STATIC with the weight and the water')])
    allocate (spec%columns, source=[ &
              field('node', kind_reference, 'the nodes', &
                    is_required=.true.), &
              field('dof', kind_real, 'degree of freedom, 1 to 3, or the temperature', &
                    is_required=.true.), &
              field('value', kind_real, 'displacement [m] or velocity [m/s]', default='0')])
  end subroutine describe_initial_conditions

  subroutine read_initial_conditions(this, model, faults)
    type(card), intent(in) :: this
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(initial_value), allocatable :: new(:)
    integer, allocatable :: nodes(:), line_of_node(:), all_nodes(:)
    integer :: line, i, used, num_lines
    if (this%word('TYPE') == 'TEMPERATURE') then
      call read_initial_temperatures(this, model, faults)
      return
    end if
    call check_dofs(this, faults)
    used = 0
    num_lines = 0
    call make_room(all_nodes, used, this%num_lines)
    call make_room(line_of_node, used, this%num_lines)
    do line = 1, this%num_lines
      call nodes_at(this, line, 1, model, faults, nodes)
      call append(line_of_node, num_lines, spread(line, 1, size(nodes)))
      call append(all_nodes, used, nodes)
    end do
    allocate (new(used))
    new%is_velocity = this%word('TYPE') == 'VELOCITY'
    do i = 1, used
      new(i)%node = all_nodes(i)
      new(i)%dof = nint(max(1.0_rk, min(3.0_rk, this%real_at(line_of_node(i), 2))))
      new(i)%value = this%real_at(line_of_node(i), 3)
    end do
    model%problem%initial_values = [model%problem%initial_values, new]
  end subroutine read_initial_conditions

  !> Displacements and velocities have a direction.
  subroutine check_dofs(this, faults)
    type(card), intent(in) :: this
    type(diagnostic_list), intent(inout) :: faults
    integer :: line
    do line = 1, this%num_lines
      if (this%is_empty_at(line, 2)) cycle ! reported
      if (any(this%real_at(line, 2) <= [1.0_rk, 2.0_rk, 3.0_rk] .and. &
              this%real_at(line, 2) >= [1.0_rk, 2.0_rk, 3.0_rk])) cycle
      call this%fault_at(faults, line, 2, "found '"//this%text_at(line, 2)//"'", &
                         'a degree of freedom, an integer from 1 to 3')
    end do
  end subroutine check_dofs
end module keywords_initial
