!> *NODE PRINT, *EL PRINT, *JOINT PRINT: histories in CSV files.
module keywords_print
  use card_fields, only: take_fields
  use deck_card, only: card
  use diagnostics, only: diagnostic_list
  use element_catalogue, only: is_solid
  use field_table, only: choices_of, columns_of_joints, fields_in_words
  use keyword_spec, only: keyword, field, kind_choice, kind_integer, kind_word
  use kinds, only: rk
  use model_draft, only: draft
  use keywords_other, only: add_idle_parameters
  use named_things, only: elements_of_set, joint_names, nodes_of_set
  use nearest_words, only: nearest_word
  use print_kinds, only: file_pattern, kinds_of_prints, prints_of_elements, prints_of_joints, &
                         prints_of_nodes
  use step_plan, only: field_name_length, output_rhythm, print_request
  implicit none
  private
  public :: describe_node_print, describe_el_print, describe_joint_print
  public :: read_node_print, read_el_print, read_joint_print
  public :: add_frequency, fields_of, read_histories

  character, parameter :: nl = new_line('a')

contains

  !> Adds the entries that all requests share: frequency and fields.
  subroutine add_frequency(spec, choices)
    type(keyword), intent(inout) :: spec
    character(*), intent(in) :: choices !< fields, 'U | V'
    type(field) :: how_often
    how_often = field('FREQUENCY', kind_integer, 'number of increments between outputs; with '// &
                      '*CONTROLS, ACCURACY, from 2 on, of first increments in time; 0 for '// &
                      'no output', &
                      default='1', lowest=0.0_rk)
    if (allocated(spec%parameters)) then
      spec%parameters = [spec%parameters, how_often]
    else
      allocate (spec%parameters(1), source=how_often)
    end if
    allocate (spec%columns, source=[ &
              field('field', kind_choice, 'a field', choices=choices)])
    spec%repeats_columns = .true.
    spec%family = 'output'
    spec%place = 'step'
  end subroutine add_frequency

  !> The fields a card names, each once; `default` when it names none.
  pure function fields_of(this, default) result(fields)
    type(card), intent(in) :: this
    character(*), intent(in) :: default
    character(field_name_length), allocatable :: fields(:)
    character(field_name_length) :: new
    integer :: line, i
    allocate (fields(0))
    do line = 1, this%num_lines
      do i = 1, this%num_fields(line)
        if (this%is_empty_at(line, i)) cycle
        new = this%word_at(line, i)
        if (.not. any(fields == new)) fields = [character(field_name_length) :: fields, new]
      end do
    end do
    if (size(fields) == 0) fields = [character(field_name_length) :: default]
  end function fields_of

  !> Name of the keyword; for its meaning, the file and what the file holds.
  subroutine open_print(spec, kind)
    type(keyword), intent(inout) :: spec
    integer, intent(in) :: kind !< position in `kinds_of_prints`
    associate (item => kinds_of_prints(kind))
      spec%name = trim(item%keyword)
      if (item%has_all_fields) then
        spec%meaning = file_pattern(item)//': '//columns_of_joints()
      else
        spec%meaning = file_pattern(item)//': '//fields_in_words(spec%name)
      end if
    end associate
  end subroutine open_print

  subroutine describe_node_print(spec)
    type(keyword), intent(out) :: spec
    call open_print(spec, prints_of_nodes)
    spec%meaning = 'History of nodes in '//spec%meaning// &
                   '. U, V and A are relative to the base. The last increment of a step is '// &
                   'always written. The request stays for the next steps until a step has its '// &
                   'own.'
    spec%example = '*NODE PRINT, NSET=CREST, FREQUENCY=2'//nl//'U, A'
    allocate (spec%parameters, source=[ &
              field('NSET', kind_word, 'the nodes; without it nothing is printed')])
    call add_frequency(spec, choices_of(spec%name))
    call add_idle_parameters(spec, ['GLOBAL     ', 'TOTALS     ', 'SUMMARY    ', 'TIME POINTS', &
                                    'FREQUENCYF '])
    spec%checks_own_data = .true.
    spec%asks_for_output = .true.
  end subroutine describe_node_print

  subroutine read_node_print(this, model, faults)
    type(card), intent(in) :: this
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    call add_nodes(this, output_rhythm(this%integer('FREQUENCY')), model, faults)
  end subroutine read_node_print

  !> The history of a set of nodes.
  subroutine add_nodes(this, rhythm, model, faults)
    type(card), intent(in) :: this
    type(output_rhythm), intent(in) :: rhythm
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(print_request) :: new
    if (.not. this%has('NSET')) then
      call this%ignore(faults, 'has no effect: there is no NSET')
      return
    end if
    new%kind = prints_of_nodes
    new%name = this%word('NSET')
    new%frequency = rhythm%frequency
    new%rhythm = rhythm
    call nodes_of_set(this, 'NSET', model, faults, new%members)
    call take_fields(this, choices_of('NODE PRINT'), 'U', faults, new%fields)
    if (size(new%fields) > 0) call add_request(new, model)
  end subroutine add_nodes

  !> The requests of *NODE OUTPUT and *ELEMENT OUTPUT after *OUTPUT, HISTORY.
  subroutine read_histories(this, model, faults)
    type(card), intent(in) :: this
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    if (this%spec%name == 'NODE OUTPUT') then
      call add_nodes(this, model%rhythm, model, faults)
    else
      call add_elements(this, model%rhythm, model, faults)
    end if
  end subroutine read_histories

  subroutine describe_el_print(spec)
    type(keyword), intent(out) :: spec
    call open_print(spec, prints_of_elements)
    spec%meaning = 'History of elements at their integration points in '//spec%meaning//'.'
    spec%example = '*EL PRINT, ELSET=HEEL'//nl//'S'
    allocate (spec%parameters, source=[ &
              field('ELSET', kind_word, 'the elements; without it nothing is printed')])
    call add_frequency(spec, choices_of(spec%name))
    call add_idle_parameters(spec, ['POSITION   ', 'TOTALS     ', 'SUMMARY    ', 'GLOBAL     ', &
                                    'TIME POINTS', 'FREQUENCYF '])
    spec%checks_own_data = .true.
    spec%asks_for_output = .true.
  end subroutine describe_el_print

  subroutine read_el_print(this, model, faults)
    type(card), intent(in) :: this
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    call add_elements(this, output_rhythm(this%integer('FREQUENCY')), model, faults)
  end subroutine read_el_print

  !> The history of a set of elements.
  subroutine add_elements(this, rhythm, model, faults)
    type(card), intent(in) :: this
    type(output_rhythm), intent(in) :: rhythm
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(print_request) :: new
    if (.not. this%has('ELSET')) then
      call this%ignore(faults, 'has no effect: there is no ELSET')
      return
    end if
    new%kind = prints_of_elements
    new%name = this%word('ELSET')
    new%frequency = rhythm%frequency
    new%rhythm = rhythm
    call elements_of_set(this, 'ELSET', model, faults, new%members)
    if (.not. all(is_solid(model%problem%mesh%element_type(new%members)))) then
      call this%fault_parameter(faults, 'ELSET', 'the set contains elements that are not '// &
                                'solids', &
                                'solid elements; for joints *JOINT PRINT')
    end if
    call take_fields(this, choices_of('EL PRINT'), 'S', faults, new%fields)
    if (size(new%fields) > 0) call add_request(new, model)
  end subroutine add_elements

  subroutine describe_joint_print(spec)
    type(keyword), intent(out) :: spec
    call open_print(spec, prints_of_joints)
    spec%meaning = 'History of the points of a joint in '//spec%meaning// &
                   ' (0 open, 1 stick, 2 slip, 3 bonded). The file '// &
                   'always has all columns, whichever fields the card '// &
                   'names. With the normal n from the master to the slave, slip1 '// &
                   'and t1 are along e3 x n (along x where n is along z), slip2 and t2 '// &
                   'along the product of n and that axis; e3 is the z axis of the deck, '// &
                   'whatever UP and the weight are. Where z points up, slip1 is horizontal '// &
                   'and slip2 up the joint; in a level joint both are horizontal.'
    spec%example = '*JOINT PRINT, JOINT=J1, NSET=CREST'
    allocate (spec%parameters, source=[ &
              field('JOINT', kind_word, 'name of the joint', is_required=.true.), &
              field('NSET', kind_word, 'only the points nearest to these nodes')])
    call add_frequency(spec, choices_of(spec%name))
  end subroutine describe_joint_print

  subroutine read_joint_print(this, model, faults)
    type(card), intent(in) :: this
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(print_request) :: new
    integer :: i
    new%kind = prints_of_joints
    new%name = this%word('JOINT')
    allocate (new%members(0), new%near_nodes(0), new%fields(0))
    do i = 1, size(model%joints)
      if (model%joints(i)%name == new%name) new%members = [i]
    end do
    if (size(new%members) == 0) then
      call this%fault_parameter(faults, 'JOINT', "there is no joint '"//this%text('JOINT')// &
                                "' above this line", 'the name of a *JOINT', &
                                nearest_word(new%name, joint_names(model)))
    end if
    if (this%has('NSET')) call nodes_of_set(this, 'NSET', model, faults, new%near_nodes)
    new%frequency = this%integer('FREQUENCY')
    call add_request(new, model)
  end subroutine read_joint_print

  !> Adds a request. The first request of a kind in a step replaces those of earlier steps.
  subroutine add_request(new, model)
    type(print_request), intent(in) :: new
    type(draft), intent(inout) :: model
    type(print_request), allocatable :: kept(:)
    integer, allocatable :: members(:)
    logical :: stays(size(model%now%prints))
    integer :: i, used
    stays = model%prints_given(new%kind) .or. model%now%prints%kind /= new%kind
    model%prints_given(new%kind) = .true.
    if (all(stays) .and. new%frequency == 0) return
    allocate (kept(count(stays) + merge(1, 0, new%frequency > 0)))
    used = 0
    do i = 1, size(stays)
      if (.not. stays(i)) cycle
      used = used + 1
      call move_alloc(model%now%prints(i)%members, members) ! long lists are moved, not copied
      kept(used) = model%now%prints(i)
      call move_alloc(members, kept(used)%members)
    end do
    if (new%frequency > 0) kept(size(kept)) = new
    call move_alloc(kept, model%now%prints)
  end subroutine add_request
end module keywords_print
