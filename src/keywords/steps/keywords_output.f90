!> *NODE FILE, *EL FILE, *OUTPUT, *NODE OUTPUT, *ELEMENT OUTPUT, *ENVELOPE, *PREPRINT.
module keywords_output
  use card_reader, only: field_reader
  use card_fields, only: take_fields
  use deck_card, only: card
  use diagnostics, only: diagnostic_list
  use field_table, only: choices_of, ending_of_points, fields_in_words, find_field, list_fields
  use field_type, only: at_points, result_field
  use keyword_spec, only: keyword, field, kind_choice, kind_flag, kind_integer, kind_real, &
                          kind_word, without_effect
  use keywords_other, only: add_idle_parameters
  use keywords_print, only: add_frequency, fields_of, read_histories
  use kinds, only: rk
  use model_draft, only: draft
  use named_things, only: elements_of_set, nodes_of_set
  use step_plan, only: field_name_length, field_request, output_rhythm
  implicit none
  private
  public :: describe_node_file, describe_el_file, describe_output, describe_node_output
  public :: describe_element_output, describe_envelope, describe_preprint
  public :: read_files, read_fields, read_output, read_envelope, fields_of_envelope

  character, parameter :: nl = new_line('a')
  character(*), parameter :: series = ' The fields go to the VTK series (job.pvd) and to '// &
                             'job.h5. The request stays for the next steps until a '// &
                             'step has its own, or an *OUTPUT, FIELD.'
  !> Of *NODE FILE and *EL FILE in CalculiX, of *NODE OUTPUT and *ELEMENT OUTPUT in Abaqus.
  character(16), parameter :: idle_of_files(14) = [ &
                              'NSET            ', 'ELSET           ', 'GLOBAL          ', &
                              'OUTPUT          ', 'OUTPUT ALL      ', 'TOTALS          ', &
                              'TIME POINTS     ', 'LAST ITERATIONS ', 'CONTACT ELEMENTS', &
                              'POSITION        ', 'DIRECTIONS      ', 'FREQUENCYF      ', &
                              'LAST MODE       ', 'MODE            ']
  character(16), parameter :: idle_of_output(8) = [ &
                              'OP              ', 'NAME            ', 'MODE LIST       ', &
                              'TIME MARKS      ', 'FILTER          ', 'SENSOR          ', &
                              'TIME POINTS     ', 'FREQUENCYF      ']

contains

  subroutine describe_node_file(spec)
    type(keyword), intent(out) :: spec
    spec%name = 'NODE FILE'
    spec%meaning = 'Fields of nodes: '//fields_in_words('NODE FILE')//'.'//series
    spec%example = '*NODE FILE, FREQUENCY=10'//nl//'U, OPENING'
    call add_frequency(spec, choices_of('NODE FILE'))
    call add_idle_parameters(spec, idle_of_files)
    spec%checks_own_data = .true.
    spec%asks_for_output = .true.
  end subroutine describe_node_file

  subroutine describe_el_file(spec)
    type(keyword), intent(out) :: spec
    spec%name = 'EL FILE'
    spec%meaning = 'Fields of elements: '//fields_in_words('EL FILE')//'; averaged at nodes '// &
                   'within a section.'//series
    spec%example = '*EL FILE, FREQUENCY=10'//nl//'S, SP, DAMAGET'
    call add_frequency(spec, choices_of('EL FILE'))
    call add_idle_parameters(spec, idle_of_files)
    spec%checks_own_data = .true.
    spec%asks_for_output = .true.
  end subroutine describe_el_file

  subroutine describe_output(spec)
    type(keyword), intent(out) :: spec
    spec%name = 'OUTPUT'
    spec%meaning = 'Opens requests of *NODE OUTPUT and *ELEMENT OUTPUT: FIELD for fields of '// &
                   'the whole model, HISTORY for histories of sets. FIELD, FREQUENCY=0 ends '// &
                   'the fields of earlier steps.'
    spec%example = '*OUTPUT, FIELD, FREQUENCY=10'//nl//'*NODE OUTPUT'//nl//'U'
    call add_frequency(spec, '')
    deallocate (spec%columns)
    allocate (spec%columns(0))
    spec%most_lines = 0
    spec%parameters = [spec%parameters, &
                       field('FIELD', kind_flag, 'fields of the whole model'), &
                       field('HISTORY', kind_flag, 'histories of sets, as *NODE PRINT'), &
                       field('VARIABLE', kind_choice, 'requests at once, with FIELD: U, RF and '// &
                             'S, or all', choices='PRESELECT | ALL'), &
                       field('NUMBER INTERVAL', kind_integer, 'largest number of outputs in a '// &
                             'step, in place of FREQUENCY', lowest=1.0_rk), &
                       field('TIME INTERVAL', kind_real, 'time between outputs, in place of '// &
                             'FREQUENCY', 's', lowest=0.0_rk, excludes_lowest=.true.)]
    call add_idle_parameters(spec, idle_of_output)
    spec%asks_for_output = .true.
  end subroutine describe_output

  subroutine read_output(this, model, faults)
    type(card), intent(in) :: this
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(field_request) :: new
    if (.not. model%is_in_step) call this%warn(faults, 'is outside a step')
    model%rhythm = output_rhythm(this%integer('FREQUENCY'))
    if (this%has('NUMBER INTERVAL')) model%rhythm%most = this%integer('NUMBER INTERVAL')
    if (this%has('TIME INTERVAL')) model%rhythm%interval = this%real('TIME INTERVAL')
    model%output_is_history = this%has('HISTORY')
    if (this%has('FREQUENCY') .and. model%rhythm%frequency == 0 .and. &
        .not. model%output_is_history) call clear_files(model, .true., .true.)
    if (.not. this%has('VARIABLE')) return
    if (model%output_is_history) then
      call this%ignore(faults, 'VARIABLE='//this%word('VARIABLE')//' with HISTORY has no '// &
                       'effect here: a history names its set and its fields')
      return
    end if
    call clear_files(model, .true., .true.)
    new%frequency = model%rhythm%frequency
    new%rhythm = model%rhythm
    new%fields = [character(field_name_length) :: 'U', 'RF']
    if (this%word('VARIABLE') == 'ALL') new%fields = words_of(choices_of('NODE FILE'))
    call add_files(new, model)
    new%is_of_elements = .true.
    new%fields = [character(field_name_length) :: 'S']
    if (this%word('VARIABLE') == 'ALL') new%fields = words_of(choices_of('EL FILE'))
    call add_files(new, model)
  end subroutine read_output

  !> The words of a list 'U | V'.
  pure function words_of(list) result(words)
    character(*), intent(in) :: list
    character(field_name_length), allocatable :: words(:)
    integer :: first, length
    allocate (words(0))
    first = 1
    do while (first <= len(list))
      length = index(list(first:)//' | ', ' | ') - 1
      words = [character(field_name_length) :: words, list(first:first + length - 1)]
      first = first + length + 3
    end do
  end function words_of

  subroutine describe_node_output(spec)
    type(keyword), intent(out) :: spec
    call describe_node_file(spec)
    spec%name = 'NODE OUTPUT'
    spec%example = '*OUTPUT, FIELD, FREQUENCY=10'//nl//'*NODE OUTPUT'//nl//'U, RF'
    call set_parameters(spec, 'NSET')
  end subroutine describe_node_output

  subroutine describe_element_output(spec)
    type(keyword), intent(out) :: spec
    call describe_el_file(spec)
    spec%name = 'ELEMENT OUTPUT'
    spec%example = '*OUTPUT, FIELD, FREQUENCY=10'//nl//'*ELEMENT OUTPUT'//nl//'S'
    call set_parameters(spec, 'ELSET')
  end subroutine describe_element_output

  !> Parameters of a request after *OUTPUT.
  subroutine set_parameters(spec, set)
    type(keyword), intent(inout) :: spec
    character(*), intent(in) :: set !< its parameter
    deallocate (spec%parameters)
    allocate (spec%parameters, source=[ &
              field(set, kind_word, 'the set of a history; fields are those of the whole model'), &
              field('VARIABLE', kind_choice, 'all fields of the keyword, or the usual one', &
                    choices='PRESELECT | ALL')])
    call add_idle_parameters(spec, ['POSITION  ', 'DIRECTIONS', 'EXTERIOR  '])
  end subroutine set_parameters

  !> *NODE OUTPUT and *ELEMENT OUTPUT.
  subroutine read_fields(this, model, faults)
    type(card), intent(in) :: this
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    if (model%output_is_history) then
      call read_histories(this, model, faults)
    else
      call ignore_set(this, model, faults)
      call clear_files(model, .true., .true.)
      call take_files(this, model%rhythm, model, faults)
    end if
  end subroutine read_fields

  !> A set must exist also where it has no effect.
  subroutine ignore_set(this, model, faults)
    type(card), intent(in) :: this
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    character(:), allocatable :: set
    integer, allocatable :: members(:)
    integer :: num_before
    num_before = faults%num_errors
    set = 'ELSET'
    if (this%has('NSET')) set = 'NSET'
    if (.not. this%has(set)) return
    if (set == 'NSET') call nodes_of_set(this, set, model, faults, members)
    if (set == 'ELSET') call elements_of_set(this, set, model, faults, members)
    if (faults%num_errors > num_before) return
    call this%ignore(faults, set//' has no effect here: fields are those of the whole model')
  end subroutine ignore_set

  !> *NODE FILE and *EL FILE.
  subroutine read_files(this, model, faults)
    type(card), intent(in) :: this
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    call take_files(this, output_rhythm(this%integer('FREQUENCY')), model, faults)
  end subroutine read_files

  !> The fields of a card for the files of fields.
  subroutine take_files(this, rhythm, model, faults)
    type(card), intent(in) :: this
    type(output_rhythm), intent(in) :: rhythm
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(field_request) :: new
    character(:), allocatable :: choices, usual
    new%is_of_elements = index(this%spec%name, 'NODE') == 0
    choices = choices_of('EL FILE')
    usual = 'S'
    if (.not. new%is_of_elements) then
      choices = choices_of('NODE FILE')
      usual = 'U'
    end if
    call take_fields(this, choices, usual, faults, new%fields)
    call warn_of_repeats(this, faults)
    if (this%has('VARIABLE')) then
      if (this%word('VARIABLE') == 'ALL') new%fields = words_of(choices)
    end if
    new%frequency = rhythm%frequency
    new%rhythm = rhythm
    if (size(new%fields) > 0) call add_files(new, model)
  end subroutine take_files

  !> Adds a request. The first one of a step for nodes, or for elements, replaces those of earlier
  !> steps.
  subroutine add_files(new, model)
    type(field_request), intent(in) :: new
    type(draft), intent(inout) :: model
    call clear_files(model,.not. new%is_of_elements, new%is_of_elements)
    if (new%frequency > 0) model%now%outputs = [model%now%outputs, new]
  end subroutine add_files

  !> Leaves out requests of earlier steps, once in a step: by *OUTPUT those for nodes and elements.
  subroutine clear_files(model, of_nodes, of_elements)
    type(draft), intent(inout) :: model
    logical, intent(in) :: of_nodes, of_elements
    type(field_request), allocatable :: kept(:)
    logical :: leaves_nodal, leaves_elemental
    leaves_nodal = of_nodes .and. .not. model%has_new_nodal
    leaves_elemental = of_elements .and. .not. model%has_new_elemental
    allocate (kept, source=pack(model%now%outputs, &
                                .not. merge(leaves_elemental, leaves_nodal, &
                                            model%now%outputs%is_of_elements)))
    call move_alloc(kept, model%now%outputs)
    model%has_new_nodal = model%has_new_nodal .or. of_nodes
    model%has_new_elemental = model%has_new_elemental .or. of_elements
  end subroutine clear_files

  subroutine describe_envelope(spec)
    type(keyword), intent(out) :: spec
    spec%name = 'ENVELOPE'
    spec%family = 'output'
    spec%place = 'step'
    spec%meaning = 'Records the extremes over the increments of the step, in *DYNAMIC with the '// &
                   'state at its start: '//fields_in_words('ENVELOPE')// &
                   '. job.json has their place and time, the '// &
                   'results at the end of the step have them as '// &
                   'fields. Without data lines: S1, S3 and, where there are joints, OPENING. '// &
                   'POSITION=POINTS takes the stresses S1 and S3 at the integration points of '// &
                   'materials with a law, where the law bounds them; their results are '// &
                   'named S1_POINT and S3_POINT. S1 and S3 at nodes are extrapolated.'
    spec%example = '*ENVELOPE'//nl//'S1, S3, OPENING, DAMAGET'//nl// &
                   '*ENVELOPE, POSITION=POINTS'//nl//'S1, S3'
    allocate (spec%parameters, source=[ &
              field('POSITION', kind_choice, 'where the fields are taken', default='NODES', &
                    choices='NODES | POINTS')])
    allocate (spec%columns, source=[ &
              field('field', kind_choice, 'a field', &
                    choices=choices_of('ENVELOPE'))])
    spec%repeats_columns = .true.
  end subroutine describe_envelope

  !> Warns of a field that a card names more than once; the field is written once.
  subroutine warn_of_repeats(this, faults)
    type(card), intent(in) :: this
    type(diagnostic_list), intent(inout) :: faults
    type(field_reader) :: reader
    character(field_name_length), allocatable :: seen(:)
    character(field_name_length) :: word
    allocate (seen(0))
    do while (reader%advance(this))
      word = this%word_at(reader%line, reader%field)
      if (word == '') cycle
      if (any(seen == word)) then
        call this%warn(faults, trim(word)//' is named more than once; it is written once')
      else
        seen = [character(field_name_length) :: seen, word]
      end if
    end do
  end subroutine warn_of_repeats

  !> Replaces fields by those of integration points; a fault for a field without such values.
  subroutine take_points(this, fields, faults)
    type(card), intent(in) :: this
    character(field_name_length), intent(inout) :: fields(:)
    type(diagnostic_list), intent(inout) :: faults
    type(result_field), allocatable :: table(:)
    integer :: i, f
    call list_fields(table)
    do i = 1, size(fields)
      if (find_field(table, trim(fields(i))//ending_of_points) > 0) then
        fields(i) = trim(fields(i))//ending_of_points
        cycle
      end if
      f = find_field(table, trim(fields(i)))
      if (f == 0) cycle
      if (table(f)%place == at_points) cycle
      call this%fault(faults, trim(fields(i))//' has no values at integration points', &
                      'S1, S3, DAMAGET or DAMAGEC with POSITION=POINTS')
    end do
  end subroutine take_points

  !> Fields that *ENVELOPE names, or those of a card that names none.
  pure function fields_of_envelope(this) result(fields)
    type(card), intent(in) :: this
    character(field_name_length), allocatable :: fields(:)
    fields = fields_of(this, '')
    if (fields(1) /= '') return
    fields = [character(field_name_length) :: 'S1', 'S3']
    if (this%word('POSITION') /= 'POINTS') fields = [fields, 'OPENING ']
  end function fields_of_envelope

  !> Fields of several cards in a step: each is recorded once.
  subroutine read_envelope(this, model, faults)
    type(card), intent(in) :: this
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    character(field_name_length), allocatable :: fields(:)
    integer :: i
    fields = fields_of_envelope(this)
    call warn_of_repeats(this, faults)
    if (this%word('POSITION') == 'POINTS') call take_points(this, fields, faults)
    model%now%envelope = [character(field_name_length) :: model%now%envelope, &
                          pack(fields, [(all(model%now%envelope /= fields(i)), &
                                         i=1, size(fields))])]
  end subroutine read_envelope

  subroutine describe_preprint(spec)
    type(keyword), intent(out) :: spec
    spec%name = 'PREPRINT'
    spec%family = 'output'
    spec%place = 'anywhere'
    spec%meaning = 'Chooses what Abaqus prints.'
    spec%example = '*PREPRINT, ECHO=NO'
    spec%status = without_effect
    allocate (spec%parameters, source=[ &
              field('ECHO', kind_choice, 'what Abaqus prints', choices='YES | NO'), &
              field('HISTORY', kind_choice, 'what Abaqus prints', choices='YES | NO'), &
              field('MODEL', kind_choice, 'what Abaqus prints', choices='YES | NO'), &
              field('CONTACT', kind_choice, 'what Abaqus prints', choices='YES | NO'), &
              field('PARSUBSTITUTION', kind_choice, 'what Abaqus prints', choices='YES | NO'), &
              field('PARVALUES', kind_choice, 'what Abaqus prints', choices='YES | NO'), &
              field('MASSPROP', kind_choice, 'what Abaqus prints', choices='YES | NO')])
  end subroutine describe_preprint
end module keywords_output
