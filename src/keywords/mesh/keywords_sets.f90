!> *NSET, *ELSET, *SURFACE.
module keywords_sets
  use card_check, only: check_lines
  use dam_mesh, only: surface
  use deck_card, only: card
  use diagnostics, only: diagnostic_list
  use element_catalogue, only: is_solid
  use growing_lists, only: append, make_room
  use id_map, only: position_table
  use keyword_spec, only: keyword, field, kind_choice, kind_flag, kind_reference, kind_word
  use mesh_faces, only: count_corners, face_nodes
  use model_draft, only: draft
  use named_things, only: elements_at, nodes_at, nodes_in_order_at, with_article
  use surface_of_faces, only: find_set_faces
  use surface_of_nodes, only: find_faces
  use write_text, only: as_text
  implicit none
  private
  public :: describe_nset, describe_elset, describe_surface
  public :: read_nset, read_elset, read_surface

  character, parameter :: nl = new_line('a')

contains

  subroutine describe_nset(spec)
    type(keyword), intent(out) :: spec
    call describe_set(spec, 'NSET', 'node')
    spec%example = '*NSET, NSET=CREST'//nl//'12, 13, 27'//nl//'*NSET, NSET=BASE, GENERATE'//nl// &
                   '1, 101, 10'
  end subroutine describe_nset

  subroutine describe_elset(spec)
    type(keyword), intent(out) :: spec
    call describe_set(spec, 'ELSET', 'element')
    spec%example = '*ELSET, ELSET=DAM'//nl//'BLOCK1, BLOCK2, 405'
  end subroutine describe_elset

  subroutine describe_set(spec, name, kind)
    type(keyword), intent(out) :: spec
    character(*), intent(in) :: name !< 'NSET' or 'ELSET'
    character(*), intent(in) :: kind !< 'node' or 'element'
    character(:), allocatable :: order
    order = 'nodes keep the order of the deck where *EQUATION and *MPC pair them'
    if (kind == 'element') order = 'of Abaqus: elements need no order'
    spec%name = name
    spec%family = 'mesh'
    spec%place = 'model'
    spec%meaning = 'A set of '//kind//'s, from ids and sets defined above. A second card '// &
                   'with the same name adds members.'
    spec%checks_own_data = .true.
    spec%fewest_lines = 1
    spec%repeats_columns = .true.
    allocate (spec%parameters, source=[ &
              field(name, kind_word, 'name of the set', is_required=.true.), &
              field('GENERATE', kind_flag, 'each line holds: first, last, step (1)'), &
              field('INSTANCE', kind_word, 'in an *ASSEMBLY: instance of the ids and sets'), &
              field('INTERNAL', kind_flag, 'a set that Abaqus/CAE has named, a set like others'), &
              field('UNSORTED', kind_flag, order)])
    allocate (spec%columns, source=[ &
              field('member', kind_reference, 'id of '//with_article(kind)//' or name '// &
                    'of a set, any number in a line')])
  end subroutine describe_set

  subroutine read_nset(this, model, faults)
    type(card), intent(in) :: this
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer, allocatable :: members(:)
    call collect_members(this, 'node', model, faults, members)
    if (this%has('UNSORTED')) call model%node_sets%keep_order(this%word('NSET'))
    call model%node_sets%add(this%word('NSET'), members)
  end subroutine read_nset

  subroutine read_elset(this, model, faults)
    type(card), intent(in) :: this
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer, allocatable :: members(:)
    call collect_members(this, 'element', model, faults, members)
    call model%element_sets%add(this%word('ELSET'), members)
  end subroutine read_elset

  !> All members of the card; an empty card is a fault.
  subroutine collect_members(this, kind, model, faults, members)
    type(card), intent(in) :: this
    character(*), intent(in) :: kind !< 'node' or 'element'
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer, allocatable, intent(out) :: members(:)
    integer, allocatable :: some(:)
    integer :: line, i, used
    used = 0
    call make_room(members, used, 0)
    do line = 1, this%num_lines
      if (this%has('GENERATE')) then
        if (kind == 'node') call generate(this, line, kind, model%node_position, faults, some)
        if (kind == 'element') call generate(this, line, kind, model%element_position, faults, some)
        call append(members, used, some)
        cycle
      end if
      do i = 1, this%num_fields(line)
        if (this%is_empty_at(line, i)) then
          call this%fault_at(faults, line, i, 'found an empty field', &
                             'the id of '//with_article(kind)//' or the name of a set')
          cycle
        end if
        if (kind == 'node' .and. this%has('UNSORTED')) then
          call nodes_in_order_at(this, line, i, model, faults, some)
        else if (kind == 'node') then
          call nodes_at(this, line, i, model, faults, some)
        end if
        if (kind == 'element') call elements_at(this, line, i, model, faults, some)
        call append(members, used, some)
      end do
    end do
    members = members(:used)
    if (this%num_lines == 0) then ! sets without members by a fault are reported there
      call this%fault(faults, 'the set is empty', 'at least one '//kind)
    end if
  end subroutine collect_members

  !> first, last, step of GENERATE.
  subroutine generate(this, line, kind, table, faults, members)
    type(card), intent(in) :: this
    integer, intent(in) :: line
    character(*), intent(in) :: kind
    type(position_table), intent(in) :: table
    type(diagnostic_list), intent(inout) :: faults
    integer, allocatable, intent(out) :: members(:)
    integer :: range(3), id, i, num_ids
    allocate (members(0))
    range = [0, 0, 1]
    do i = 1, min(3, this%num_fields(line))
      range(i) = this%integer_at(line, i)
      if (this%is_integer_at(line, i) .and. range(i) > 0) cycle
      call this%fault_at(faults, line, i, "found '"//this%text_at(line, i)//"'", &
                         'first, last, step: integers > 0')
      return
    end do
    if (this%num_fields(line) < 2 .or. this%num_fields(line) > 3 .or. range(2) < range(1)) then
      call this%fault_at(faults, line, 0, 'no range of '//kind//'s', &
                         'first, last, step: integers > 0 with first <= last')
      return
    end if
    ! The range ends at the first missing id: more than all ids are never looked at.
    num_ids = 1 + (range(2) - range(1))/range(3)
    members = spread(0, 1, min(num_ids, table%num_ids() + 1))
    do i = 1, size(members)
      id = range(1) + (i - 1)*range(3)
      members(i) = table%find(id)
      if (members(i) > 0) cycle
      call this%fault_at(faults, line, 0, kind//' '//as_text(id)//' does not exist', &
                         'a range in which every '//kind//' exists')
      members = members(:i - 1)
      return
    end do
    if (id == range(2)) return
    call this%warn_at(faults, line, 2, 'the range ends at '//kind//' '//as_text(id)// &
                      ': steps of '//as_text(range(3))//' do not meet '//as_text(range(2)))
  end subroutine generate

  subroutine describe_surface(spec)
    type(keyword), intent(out) :: spec
    spec%name = 'SURFACE'
    spec%family = 'mesh'
    spec%place = 'model'
    spec%meaning = 'A surface made of faces of solid elements. S1 has the corners 1-2-3-4, S2 '// &
                   '5-8-7-6, S3 1-5-6-2, S4 2-6-7-3, S5 3-7-8-4, S6 4-8-5-1. TYPE=NODE or '// &
                   'NODES: the outer faces of the solids all of whose corners are among the '// &
                   'nodes of the card; a node without such a face is an error. TYPE=ELEMENT '// &
                   'SET: the outer faces of solids on which the elements of a set lie, quads '// &
                   'and triangles beside the solids (CPS4, S4, CPS3), one set a line.'
    spec%example = '*SURFACE, NAME=UPSTREAM, TYPE=ELEMENT'//nl//'UPSTREAM_ELEMENTS, S3'
    spec%fewest_lines = 1
    spec%checks_own_data = .true.
    allocate (spec%parameters, source=[ &
              field('NAME', kind_word, 'name of the surface', is_required=.true.), &
              field('TYPE', kind_choice, 'what it is made of', default='ELEMENT', &
                    choices='ELEMENT | NODE | NODES | ELEMENT SET'), &
              field('INTERNAL', kind_flag, 'a surface that Abaqus/CAE has named')])
    allocate (spec%columns, source=[ &
              field('element', kind_reference, 'the elements', &
                    is_required=.true.), &
              field('face', kind_choice, 'a face', choices='S1 | S2 | S3 | S4 | S5 | S6', &
                    is_required=.true.)])
  end subroutine describe_surface

  subroutine read_surface(this, model, faults)
    type(card), intent(in) :: this
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(surface) :: new
    integer :: earlier
    earlier = model%surface_of_name%find(this%word('NAME'))
    if (earlier > 0) then
      call this%fault_parameter(faults, 'NAME', "surface '"//this%text('NAME')// &
                                "' is defined twice", 'a name that is used once', &
                                first=model%cards(model%surface_origin(earlier)%card)%place())
      return
    end if
    new%name = this%word('NAME')
    select case (this%word('TYPE'))
    case ('NODE', 'NODES')
      call find_faces(this, model, faults, new)
    case ('ELEMENT SET')
      call find_set_faces(this, model, faults, new)
    case default
      call list_faces(this, model, faults, new)
    end select
    call model%surface_of_name%find_or_add(new%name, model%num_surfaces)
    model%problem%surfaces(model%num_surfaces) = new
    model%surface_origin(model%num_surfaces) = model%here(0)
  end subroutine read_surface

  !> The faces of a card with elements and faces.
  subroutine list_faces(this, model, faults, new)
    type(card), intent(in) :: this
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(surface), intent(inout) :: new
    integer, allocatable :: members(:), seen(:)
    integer :: line, face, i, used, num_before
    num_before = faults%num_errors
    call check_lines(this, faults)
    allocate (seen(model%problem%mesh%num_elements), source=0)
    used = 0
    call make_room(new%element, used, 0)
    call make_room(new%face, used, 0)
    do line = 1, merge(this%num_lines, 0, faults%num_errors == num_before)
      call elements_at(this, line, 1, model, faults, members)
      face = index('S1S2S3S4S5S6', this%word_at(line, 2))/2 + 1
      call check_faces(this, line, members, face, model, faults)
      call drop_repeats(this, line, face, model, seen, members, faults)
      i = used
      call append(new%element, used, members)
      call append(new%face, i, spread(face, 1, size(members)))
    end do
    new%element = new%element(:used)
    new%face = new%face(:used)
  end subroutine list_faces

  !> Removes repeated faces, since a face counts once.
  subroutine drop_repeats(this, line, face, model, seen, members, faults)
    type(card), intent(in) :: this
    integer, intent(in) :: line
    integer, intent(in) :: face !< 1..6
    type(draft), intent(in) :: model
    integer, intent(inout) :: seen(:) !< (elements) bits 1..6: faces in the surface
    integer, allocatable, intent(inout) :: members(:) !< positions of elements
    type(diagnostic_list), intent(inout) :: faults
    logical :: is_new(size(members))
    integer :: i
    do i = 1, size(members)
      is_new(i) = .not. btest(seen(members(i)), face)
      seen(members(i)) = ibset(seen(members(i)), face)
    end do
    if (all(is_new)) return
    i = findloc(is_new, .false., dim=1)
    call this%warn_at(faults, line, 1, 'face '//this%text_at(line, 2)//' of element '// &
                      as_text(model%problem%mesh%element_id(members(i)))// &
                      trim(merge(' is in the surface twice; it counts once              ', &
                                 ' and others are in the surface twice; they count once ', &
                                 count(.not. is_new) == 1)))
    members = pack(members, is_new)
  end subroutine drop_repeats

  !> Checks that each face belongs to a solid and has an area.
  subroutine check_faces(this, line, members, face, model, faults)
    type(card), intent(in) :: this
    integer, intent(in) :: line
    integer, intent(in) :: members(:) !< positions of elements
    integer, intent(in) :: face !< 1..6
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer :: i
    associate (mesh => model%problem%mesh)
      do i = 1, size(members)
        if (.not. is_solid(mesh%element_type(members(i)))) then
          call this%fault_at(faults, line, 1, 'element '// &
                             as_text(mesh%element_id(members(i)))//' is a '// &
                             trim(mesh%element_type(members(i)))//', which has no faces', &
                             'solid elements')
          return
        else if (count_corners(face_nodes(mesh, members(i), face)) < 3) then
          call this%fault_at(faults, line, 2, 'face '//this%text_at(line, 2)//' of element '// &
                             as_text(mesh%element_id(members(i)))//' has no area', &
                             'a face that has not collapsed')
          return
        end if
      end do
    end associate
  end subroutine check_faces
end module keywords_sets
