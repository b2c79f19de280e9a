!> *TEMPERATURE, and the temperatures of *INITIAL CONDITIONS.
module keywords_temperature
  use deck_card, only: card
  use diagnostics, only: diagnostic_list
  use growing_lists, only: append
  use heat_plan, only: heat_rule
  use keyword_spec, only: keyword, field, kind_choice, kind_real, kind_reference, kind_text, &
                          kind_word
  use kinds, only: rk
  use model_draft, only: draft
  use named_things, only: find_amplitude, nodes_at
  use temperature_file, only: read_temperature_file
  implicit none
  private
  public :: describe_temperature, read_temperature, read_initial_temperatures
  public :: keep_heats, forget_heats

  character, parameter :: nl = new_line('a')

contains

  subroutine describe_temperature(spec)
    type(keyword), intent(out) :: spec
    spec%name = 'TEMPERATURE'
    spec%family = 'load'
    spec%place = 'step'
    spec%meaning = 'Temperatures of nodes. In a static step they go linearly from those at '// &
                   'its start to the given ones, in a dynamic step they act in its first '// &
                   'increment; with AMPLITUDE they are the value times the history. Of two '// &
                   'values of a node the last one acts. Nodes that a step does not name keep '// &
                   'their temperature; histories over total time go on. INPUT names a file '// &
                   'with a row for each node or set and a column for each time of its header '// &
                   'line, "node, time, time, ..", linear between the times, constant outside.'
    spec%example = '*TEMPERATURE'//nl//'ALL, 4.'//nl//'CREST, -2.'//nl// &
                   '*TEMPERATURE, INPUT=winter.csv, TIME=TOTAL TIME'
    spec%new_clears = .true.
    allocate (spec%parameters, source=[ &
              field('OP', kind_choice, 'keep temperatures of earlier steps, or let all nodes '// &
                    'that the step does not name return to their initial temperature', &
                    default='MOD', choices='MOD | NEW'), &
              field('AMPLITUDE', kind_word, 'history that the temperatures are multiplied with'), &
              field('INPUT', kind_text, 'file with the temperatures, relative to the deck'), &
              field('TIME', kind_choice, 'clock of the times of a file', default='STEP TIME', &
                    choices='STEP TIME | TOTAL TIME')])
    allocate (spec%columns, source=[ &
              field('node', kind_reference, 'the nodes', is_required=.true.), &
              field('temperature', kind_real, 'temperature', 'K', is_required=.true.)])
    spec%no_further = 'solids have one temperature at a node'
  end subroutine describe_temperature

  subroutine read_temperature(this, model, faults)
    type(card), intent(in) :: this
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(heat_rule) :: rule
    call find_amplitude(this, model, faults, rule%amplitude)
    if (.not. allocated(model%now%heats)) allocate (model%now%heats(0))
    if (this%word('OP') == 'NEW') call clear_heats(model)
    if (.not. this%has('INPUT') .and. this%num_lines == 0) then
      if (this%word('OP') == 'NEW') return
      call this%fault(faults, 'the card has no temperatures', &
                      'data lines (node, temperature) or a file (INPUT)')
      return
    end if
    rule%uses_total_time = this%word('TIME') == 'TOTAL TIME'
    rule%step = model%num_steps + 1
    if (this%has('INPUT')) then
      call read_temperature_file(this, model, faults, rule)
      if (.not. allocated(rule%time)) return ! its faults are reported
      call check_clock(this, rule, faults)
      model%now%heats = [model%now%heats, rule]
    end if
    if (this%num_lines == 0) return
    if (this%has('TIME') .and. .not. this%has('INPUT')) then
      call this%fault_parameter(faults, 'TIME', 'TIME without a file', &
                                'INPUT, or an AMPLITUDE with a clock of its own')
    end if
    call read_lines(this, 1, 2, model, faults, rule)
    model%now%heats = [model%now%heats, rule]
  end subroutine read_temperature

  !> Forgets the rules of earlier steps that go on; those of this step stay.
  subroutine clear_heats(model)
    type(draft), intent(inout) :: model
    type(heat_rule), allocatable :: kept(:)
    if (model%now%restores_temperature) return
    model%now%restores_temperature = .true.
    call find_kept(model, kept)
    model%now%heats = model%now%heats(size(kept) + 1:)
  end subroutine clear_heats

  !> A table over time follows the times of its file alone.
  subroutine check_clock(this, rule, faults)
    type(card), intent(in) :: this
    type(heat_rule), intent(in) :: rule
    type(diagnostic_list), intent(inout) :: faults
    if (size(rule%time) > 0 .and. this%has('AMPLITUDE')) then
      call this%fault_parameter(faults, 'AMPLITUDE', 'a history for a file that has times', &
                                'a file with one column, or no AMPLITUDE')
    else if (size(rule%time) == 0 .and. this%has('TIME')) then
      call this%fault_parameter(faults, 'TIME', 'TIME has no effect: the file has no times', &
                                'a header line: node, time, time, ..')
    end if
  end subroutine check_clock

  !> Nodes and values of the data lines.
  subroutine read_lines(this, first, value, model, faults, rule)
    type(card), intent(in) :: this
    integer, intent(in) :: first, value !< columns
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(heat_rule), intent(inout) :: rule
    integer, allocatable :: nodes(:), all_nodes(:), line_of_node(:)
    integer :: line, used, num_lines, i
    used = 0
    num_lines = 0
    allocate (all_nodes(this%num_lines), line_of_node(this%num_lines))
    do line = 1, this%num_lines
      call nodes_at(this, line, first, model, faults, nodes)
      call append(line_of_node, num_lines, spread(line, 1, size(nodes)))
      call append(all_nodes, used, nodes)
    end do
    rule%nodes = all_nodes(:used)
    rule%value = reshape([(this%real_at(line_of_node(i), value), i=1, used)], [1, used])
    rule%time = [real(rk) ::]
  end subroutine read_lines

  !> *INITIAL CONDITIONS, TYPE=TEMPERATURE: node, temperature.
  subroutine read_initial_temperatures(this, model, faults)
    type(card), intent(in) :: this
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(heat_rule) :: rule
    integer :: line
    do line = 1, this%num_lines
      if (this%num_fields(line) <= 2) cycle
      call this%fault_at(faults, line, 3, "found '"//this%text_at(line, 3)//"'", &
                         'node, temperature alone')
      return
    end do
    call read_lines(this, 1, 2, model, faults, rule)
    associate (heat => model%problem%heat)
      if (.not. allocated(heat%initial)) then
        allocate (heat%initial(model%problem%mesh%num_nodes), source=0.0_rk)
      end if
      heat%initial(rule%nodes) = rule%value(1, :)
    end associate
  end subroutine read_initial_temperatures

  !> The rules of the step before that go on in the step that is opened.
  subroutine keep_heats(model)
    type(draft), intent(inout) :: model
    type(heat_rule), allocatable :: kept(:)
    call find_kept(model, kept)
    if (size(kept) > 0) call move_alloc(kept, model%now%heats)
  end subroutine keep_heats

  !> Leaves the cards of a step that finds modes without effect: the rules of the step before go on.
  subroutine forget_heats(model)
    type(draft), intent(inout) :: model
    model%now%restores_temperature = .false.
    if (allocated(model%now%heats)) deallocate (model%now%heats)
    call keep_heats(model)
  end subroutine forget_heats

  !> The rules of the step before whose clock is the total time, without the nodes to which a later
  !> rule of that step has given a temperature that stays.
  subroutine find_kept(model, kept)
    type(draft), intent(in) :: model
    type(heat_rule), allocatable, intent(out) :: kept(:)
    integer :: i
    allocate (kept(0))
    if (model%num_steps == 0) return
    associate (before => model%problem%steps(model%num_steps))
      if (.not. allocated(before%heats)) return
      do i = 1, size(before%heats)
        if (.not. before%heats(i)%goes_on(model%problem%amplitudes)) cycle
        kept = [kept, without_settled(model, before%heats(i), before%heats(i + 1:))]
      end do
    end associate
  end subroutine find_kept

  !> A rule without the nodes of later rules whose temperature stays.
  function without_settled(model, rule, later) result(rest)
    type(draft), intent(in) :: model
    type(heat_rule), intent(in) :: rule, later(:)
    type(heat_rule) :: rest
    logical :: is_settled(model%problem%mesh%num_nodes)
    integer :: i
    is_settled = .false.
    do i = 1, size(later)
      if (.not. later(i)%goes_on(model%problem%amplitudes)) is_settled(later(i)%nodes) = .true.
    end do
    rest = rule
    rest%nodes = pack(rule%nodes,.not. is_settled(rule%nodes))
    rest%value = rule%value(:, pack([(i, i=1, size(rule%nodes))],.not. is_settled(rule%nodes)))
  end function without_settled
end module keywords_temperature
