!> *HEADING, *NODE, and the specification of *INCLUDE, which deck_source reads.
module keywords_nodes
  use deck_card, only: card
  use diagnostics, only: diagnostic_list
  use keyword_spec, only: keyword, field, kind_choice, kind_integer, kind_real, kind_text, &
                          kind_word
  use kinds, only: rk
  use model_draft, only: draft, origin
  implicit none
  private
  public :: describe_heading, describe_include, describe_node
  public :: read_heading, read_nodes
  public :: make_room_for_nodes, fault_twice, positions

  character, parameter :: nl = new_line('a')

contains

  subroutine describe_heading(spec)
    type(keyword), intent(out) :: spec
    spec%name = 'HEADING'
    spec%family = 'mesh'
    spec%place = 'model'
    spec%meaning = 'A title of one or more lines, repeated in the log and in the results.'
    spec%example = '*HEADING'//nl//'Arch dam with two contraction joints'
    spec%checks_own_data = .true.
  end subroutine describe_heading

  subroutine read_heading(this, model, faults)
    type(card), intent(in) :: this
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer :: line, i
    character(:), allocatable :: text
    if (this%num_lines == 0) call this%warn(faults, 'the heading is empty')
    text = model%problem%heading
    do line = 1, this%num_lines
      if (len(text) > 0) text = text//nl
      do i = 1, this%num_fields(line)
        if (i > 1) text = text//', '
        text = text//this%text_at(line, i)
      end do
    end do
    model%problem%heading = text
  end subroutine read_heading

  subroutine describe_include(spec)
    type(keyword), intent(out) :: spec
    spec%name = 'INCLUDE'
    spec%family = 'mesh'
    spec%place = 'anywhere'
    spec%meaning = 'Reads another file in place of this line. Files may include others; a file '// &
                   'that includes itself is an error.'
    spec%example = '*INCLUDE, INPUT=mesh.inc'
    spec%most_lines = 0
    allocate (spec%parameters, source=[ &
              field('INPUT', kind_text, 'the file; its path is relative to the file that names '// &
                    'it', is_required=.true.)])
  end subroutine describe_include

  subroutine describe_node(spec)
    type(keyword), intent(out) :: spec
    spec%name = 'NODE'
    spec%family = 'mesh'
    spec%place = 'model'
    spec%meaning = 'Nodes and their coordinates. Ids may be sparse and in any order.'
    spec%example = '*NODE, NSET=ALL'//nl//'1, 0., 0., 0.'//nl//'2, 10., 0., 0.'
    spec%fewest_lines = 1
    allocate (spec%parameters, source=[ &
              field('NSET', kind_word, 'a node set to which these nodes are added'), &
              field('SYSTEM', kind_choice, 'of Abaqus: rectangular coordinates', default='R', &
                    choices='R', instead='for cylinders and spheres, coordinates along the '// &
                    'axes of the model')])
    allocate (spec%columns, source=[ &
              field('id', kind_integer, 'number of the node', is_required=.true., &
                    lowest=1.0_rk), &
              field('x', kind_real, 'coordinate', 'm', '0'), &
              field('y', kind_real, 'coordinate', 'm', '0'), &
              field('z', kind_real, 'coordinate', 'm', '0')])
  end subroutine describe_node

  !> Allocates the nodes, as many as data lines.
  pure subroutine make_room_for_nodes(model, most)
    type(draft), intent(inout) :: model
    integer, intent(in) :: most !< data lines of all *NODE cards
    associate (mesh => model%problem%mesh)
      allocate (mesh%node_id(most), mesh%x(3, most), model%node_origin(most))
    end associate
    call model%node_position%reserve(most)
  end subroutine make_room_for_nodes

  subroutine read_nodes(this, model, faults)
    type(card), intent(in) :: this
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer :: line, first, node, id, earlier
    first = model%problem%mesh%num_nodes + 1
    do line = 1, this%num_lines
      id = this%integer_at(line, 1)
      if (id <= 0) cycle
      node = model%problem%mesh%num_nodes + 1
      call model%node_position%insert(id, node, earlier)
      if (earlier > 0) then
        call fault_twice(this, line, 'node', model%node_origin(earlier), model, faults)
        cycle
      end if
      model%problem%mesh%num_nodes = node
      model%problem%mesh%node_id(node) = id
      model%problem%mesh%x(1, node) = this%real_at(line, 2)
      model%problem%mesh%x(2, node) = this%real_at(line, 3)
      model%problem%mesh%x(3, node) = this%real_at(line, 4)
      model%node_origin(node) = model%here(line)
    end do
    if (this%has('NSET')) then
      call model%node_sets%add(this%word('NSET'), positions(first, model%problem%mesh%num_nodes))
    end if
  end subroutine read_nodes

  !> first, first + 1, .., last.
  pure function positions(first, last) result(list)
    integer, intent(in) :: first, last
    integer, allocatable :: list(:)
    integer :: i
    allocate (list(max(0, last - first + 1)))
    do i = 1, size(list)
      list(i) = first + i - 1
    end do
  end function positions

  !> Reports an id that is defined twice, with both places.
  subroutine fault_twice(this, line, kind, earlier, model, faults)
    type(card), intent(in) :: this
    integer, intent(in) :: line
    character(*), intent(in) :: kind !< 'node' or 'element'
    type(origin), intent(in) :: earlier
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    call this%fault_at(faults, line, 1, kind//' '//this%text_at(line, 1)// &
                       ' is defined twice', 'an id that is used once', &
                       first=model%cards(earlier%card)%place_at(earlier%line, 1))
  end subroutine fault_twice
end module keywords_nodes
