!> *ELEMENT.
module keywords_elements
  use card_check, only: found_no_integer
  use deck_card, only: card
  use diagnostics, only: diagnostic_list
  use element_advice, only: advise, num_nodes_of_type
  use element_catalogue, only: element_kinds, find_element_kind
  use keyword_spec, only: keyword, field, kind_choice, kind_integer, kind_word
  use keywords_nodes, only: fault_twice, positions
  use kinds, only: rk
  use nearest_words, only: nearest_word
  use model_draft, only: draft
  use write_text, only: as_text
  implicit none
  private
  public :: describe_element, read_elements, make_room_for_elements, trim_mesh

  character, parameter :: nl = new_line('a')
  integer, parameter :: most_nodes = 8 !< of an element
  integer, parameter :: no_section_needed = -1 !< elements of an unknown type

contains

  subroutine describe_element(spec)
    type(keyword), intent(out) :: spec
    character(:), allocatable :: kinds
    integer :: i
    spec%name = 'ELEMENT'
    spec%family = 'mesh'
    spec%place = 'model'
    spec%meaning = 'Elements and their nodes. Solids: 4 corners of one face, then those of the '// &
                   'opposite face above them; repeated nodes make a wedge. C3D8: 2x2x2 points, '// &
                   'as in CalculiX. C3D8B: B-bar (what Abaqus calls C3D8). C3D8I: incompatible '// &
                   'modes. C3D8R: one point with hourglass control. JOINT8: two coincident '// &
                   'faces, nodes 1-4 of the master, 5-8 of the slave. IFACE4: a '// &
                   'quadrilateral with separate nodes for an *INTERFACE.'
    spec%example = '*ELEMENT, TYPE=C3D8I, ELSET=DAM'//nl//'1, 1, 2, 3, 4, 5, 6, 7, 8'
    spec%fewest_lines = 1
    spec%checks_own_data = .true.
    kinds = trim(element_kinds(1)%name)
    do i = 2, size(element_kinds)
      kinds = kinds//' | '//trim(element_kinds(i)%name)
    end do
    allocate (spec%parameters, source=[ &
              field('TYPE', kind_choice, 'linear hexahedron, joint or interface', choices=kinds, &
                    is_required=.true., is_checked_later=.true.), &
              field('ELSET', kind_word, 'an element set to which these elements are added')])
    allocate (spec%columns, source=[ &
              field('id', kind_integer, 'number of the element', is_required=.true., &
                    lowest=1.0_rk), &
              field('nodes', kind_integer, '8 ids of nodes (IFACE4: 4), continued in the '// &
                    'next line if needed', is_required=.true., lowest=1.0_rk)])
  end subroutine describe_element

  !> Allocates the elements, as many as data lines.
  pure subroutine make_room_for_elements(model, most)
    type(draft), intent(inout) :: model
    integer, intent(in) :: most !< data lines of all *ELEMENT cards
    associate (mesh => model%problem%mesh)
      allocate (mesh%element_id(most), mesh%element_type(most), mesh%nodes(most_nodes, most))
      allocate (mesh%material_of_element(most), mesh%section_of_element(most), source=0)
      allocate (model%element_origin(most))
    end associate
    call model%element_position%reserve(most)
  end subroutine make_room_for_elements

  !> Frees the memory that continuation lines left unused.
  pure subroutine trim_mesh(model)
    type(draft), intent(inout) :: model
    integer :: used
    used = model%problem%mesh%num_elements
    associate (mesh => model%problem%mesh)
      if (size(mesh%element_id) > used) then
        mesh%element_id = mesh%element_id(:used)
        mesh%element_type = mesh%element_type(:used)
        mesh%nodes = mesh%nodes(:, :used)
        mesh%material_of_element = mesh%material_of_element(:used)
        mesh%section_of_element = mesh%section_of_element(:used)
      end if
      used = mesh%num_nodes
      if (size(mesh%node_id) > used) then
        mesh%node_id = mesh%node_id(:used)
        mesh%x = mesh%x(:, :used)
      end if
    end associate
  end subroutine trim_mesh

  subroutine read_elements(this, model, faults)
    type(card), intent(in) :: this
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(diagnostic_list) :: dropped
    integer :: kind
    kind = find_element_kind(this%word('TYPE'))
    if (kind > 0) then
      call read_lines(this, element_kinds(kind)%num_nodes, model, faults)
    else
      if (this%has('TYPE')) call fault_type(this, faults)
      ! Their numbers and sets exist, so that no other fault follows from this one.
      call read_lines(this, num_nodes_of_type(this%word('TYPE'), this%num_fields(1) - 1), model, &
                      dropped)
    end if
  end subroutine read_elements

  !> Says what an element of other programs is and what to mesh instead.
  subroutine fault_type(this, faults)
    type(card), intent(in) :: this
    type(diagnostic_list), intent(inout) :: faults
    character(:), allocatable :: what, instead
    integer :: i
    call advise(this%word('TYPE'), what, instead)
    if (what /= '') then
      call this%fault_parameter(faults, 'TYPE', "TYPE: found '"//this%text('TYPE')// &
                                "', "//what, instead)
      return
    end if
    instead = trim(element_kinds(1)%name)
    do i = 2, size(element_kinds)
      instead = instead//', '//trim(element_kinds(i)%name)
    end do
    call this%fault_parameter(faults, 'TYPE', "TYPE: found '"//this%text('TYPE')//"'", &
                              'linear hexahedron, joint or interface, one of '//instead, &
                              nearest_word(this%text('TYPE'), element_kinds%name))
  end subroutine fault_type

  !> The elements of the data lines, and their set.
  subroutine read_lines(this, wanted, model, faults)
    type(card), intent(in) :: this
    integer, intent(in) :: wanted !< nodes of an element
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer :: line, first, next, element, nodes(most_nodes)
    logical :: is_right
    first = model%problem%mesh%num_elements + 1
    line = 1
    do while (line <= this%num_lines)
      call read_nodes_of_element(this, line, wanted, model, faults, nodes, next, is_right)
      if (is_right) call add_element(this, line, nodes, model, faults, element)
      line = next
    end do
    if (this%has('ELSET')) then
      call model%element_sets%add(this%word('ELSET'), &
                                  positions(first, model%problem%mesh%num_elements))
    end if
  end subroutine read_lines

  !> Collects the nodes of the element whose data begin at `line`.
  subroutine read_nodes_of_element(this, line, wanted, model, faults, nodes, next, is_right)
    type(card), intent(in) :: this
    integer, intent(in) :: line
    integer, intent(in) :: wanted !< nodes of the element
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer, intent(out) :: nodes(most_nodes) !< positions, then zeros; the first ones of more
    integer, intent(out) :: next !< the line after the element
    logical, intent(out) :: is_right
    integer :: found, field, node
    found = 0
    nodes = 0
    field = 2
    next = line
    is_right = this%is_integer_at(line, 1)
    if (.not. is_right) call fault_no_integer(this, line, 1, faults)
    do
      do field = field, this%num_fields(next)
        found = found + 1
        if (found > wanted) exit
        call read_node_of_element(this, next, field, model, faults, node, is_right)
        if (found <= most_nodes) nodes(found) = node
      end do
      if (found > wanted) exit
      next = next + 1
      field = 1
      if (found == wanted .or. next > this%num_lines) exit
    end do
    if (found > wanted) then
      call this%fault_at(faults, next, field, 'more than '//as_text(wanted)// &
                         ' nodes on an element', 'an id and '//as_text(wanted)//' nodes')
      next = next + 1
    else if (found < wanted) then
      call this%fault_at(faults, line, 0, 'only '//as_text(found)//' nodes on an element', &
                         'an id and '//as_text(wanted)//' nodes')
    end if
    is_right = is_right .and. found == wanted
  end subroutine read_nodes_of_element

  subroutine read_node_of_element(this, line, field, model, faults, node, is_right)
    type(card), intent(in) :: this
    integer, intent(in) :: line, field
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer, intent(out) :: node !< position, 0 after a fault
    logical, intent(inout) :: is_right !< made false by a fault
    node = 0
    if (this%is_integer_at(line, field)) then
      node = model%node_position%find(this%integer_at(line, field))
      if (node == 0) then
        call this%fault_at(faults, line, field, 'node '//this%text_at(line, field)// &
                           ' does not exist', 'a node of the model')
      end if
    else
      call fault_no_integer(this, line, field, faults)
    end if
    is_right = is_right .and. node > 0
  end subroutine read_node_of_element

  subroutine fault_no_integer(this, line, field, faults)
    type(card), intent(in) :: this
    integer, intent(in) :: line, field
    type(diagnostic_list), intent(inout) :: faults
    call this%fault_at(faults, line, field, found_no_integer(this%text_at(line, field)), &
                       'an id, an integer > 0')
  end subroutine fault_no_integer

  subroutine add_element(this, line, nodes, model, faults, element)
    type(card), intent(in) :: this
    integer, intent(in) :: line, nodes(most_nodes)
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer, intent(out) :: element !< its position
    integer :: earlier, id
    id = this%integer_at(line, 1)
    element = model%problem%mesh%num_elements + 1
    call model%element_position%insert(id, element, earlier)
    if (earlier > 0) then
      call fault_twice(this, line, 'element', model%element_origin(earlier), model, faults)
      return
    end if
    model%problem%mesh%num_elements = element
    model%problem%mesh%element_id(element) = id
    model%problem%mesh%element_type(element) = this%word('TYPE')
    if (find_element_kind(this%word('TYPE')) == 0) then ! reported; a solid avoids more faults
      model%problem%mesh%element_type(element) = element_kinds(1)%name
      model%problem%mesh%section_of_element(element) = no_section_needed
    end if
    model%problem%mesh%nodes(:, element) = nodes
    model%element_origin(element) = model%here(line)
  end subroutine add_element
end module keywords_elements
