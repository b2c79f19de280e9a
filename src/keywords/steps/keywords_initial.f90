!> *INITIAL CONDITIONS.
module keywords_initial
  use deck_card, only: card
  use diagnostics, only: diagnostic_list
  use growing_lists, only: append, make_room
  use keyword_spec, only: keyword, field, kind_choice, kind_integer, kind_real, kind_reference
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
    spec%meaning = 'Displacements or velocities at the start of the analysis. A static '// &
                   'step sets velocities to zero.'
    spec%example = '*INITIAL CONDITIONS, TYPE=VELOCITY'//nl//'ALL, 1, -1.'
    spec%fewest_lines = 1
    allocate (spec%parameters, source=[ &
              field('TYPE', kind_choice, 'kind of the values', is_required=.true., &
                    choices='DISPLACEMENT | VELOCITY')])
    allocate (spec%columns, source=[ &
              field('node', kind_reference, 'the nodes', &
                    is_required=.true.), &
              field('dof', kind_integer, 'degree of freedom', is_required=.true.), &
              field('value', kind_real, 'displacement [m] or velocity [m/s]', default='0')])
    spec%columns(2)%lowest = 1
    spec%columns(2)%highest = 3
  end subroutine describe_initial_conditions

  subroutine read_initial_conditions(this, model, faults)
    type(card), intent(in) :: this
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(initial_value), allocatable :: new(:)
    integer, allocatable :: nodes(:), line_of_node(:), all_nodes(:)
    integer :: line, i, used, num_lines
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
      new(i)%dof = this%integer_at(line_of_node(i), 2)
      new(i)%value = this%real_at(line_of_node(i), 3)
    end do
    model%problem%initial_values = [model%problem%initial_values, new]
  end subroutine read_initial_conditions
end module keywords_initial
