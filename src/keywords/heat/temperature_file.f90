!> Files of temperatures that *TEMPERATURE names (deck.md): a row for each node or node set, a
!> column for each time.
module temperature_file
  use deck_card, only: card
  use deck_file, only: first_letter, load_text, path_of_named
  use deck_words, only: next_word, strip_quotes
  use diagnostics, only: diagnostic_list, place, severity_error
  use growing_lists, only: make_room
  use heat_plan, only: heat_rule
  use instance_list, only: find_flat_node
  use kinds, only: rk
  use model_draft, only: draft
  use plain_labels, only: plain_label
  use parse_text, only: largest_number, parse_real, upper_case
  use write_text, only: as_text
  implicit none
  private
  public :: read_temperature_file

  character, parameter :: nl = new_line('a'), tab = achar(9), return = achar(13)

  !> The file while it is read.
  type :: table_reader
    type(place) :: spot !< of the present line
    character(:), allocatable :: line
    integer, allocatable :: first(:), last(:) !< words of the line, between commas
    logical :: has_rows = .false.
    integer :: used = 0 !< nodes so far
    integer, allocatable :: nodes(:)
    real(rk), allocatable :: value(:, :) !< (times, nodes) [K]
    real(rk), allocatable :: time(:) !< of the columns [s]
    integer :: num_columns = 1 !< with temperatures; 0 after a fault of the header
  end type table_reader

contains

  !> Reads the file of INPUT into a rule.
  subroutine read_temperature_file(this, model, faults, rule)
    type(card), intent(in) :: this
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(heat_rule), intent(inout) :: rule
    type(table_reader) :: reader
    character(:), allocatable :: text, reason
    integer :: first, length
    reader%spot = this%place_of('INPUT')
    reader%spot%file = path_of_named(reader%spot%file, this%text('INPUT'))
    call load_text(reader%spot%file, text, reason)
    if (len(reason) > 0) then
      call this%fault_parameter(faults, 'INPUT', &
                                "cannot read '"//reader%spot%file//"': "//reason)
      return
    end if
    allocate (reader%nodes(0), reader%value(1, 0), reader%time(0))
    reader%spot%line = 0
    first = first_letter(text)
    do while (first <= len(text))
      length = index(text(first:), nl) - 1
      if (length < 0) length = len(text) - first + 1
      reader%line = text(first:first + length - 1)
      reader%spot%line = reader%spot%line + 1
      first = first + length + 1
      if (length > 0) then
        if (reader%line(length:) == return) reader%line = reader%line(:length - 1)
      end if
      call take_line(reader, model, faults)
      if (reader%num_columns == 0) return ! without a header that is right no row is
    end do
    if (reader%used == 0 .and. .not. reader%has_rows) then
      call this%fault_parameter(faults, 'INPUT', 'the file has no temperatures', &
                                'rows: node or node set, temperature')
    end if
    rule%nodes = reader%nodes(:reader%used)
    rule%value = reader%value(:, :reader%used)
    rule%time = reader%time
  end subroutine read_temperature_file

  !> One line: a comment, the header or a row.
  subroutine take_line(reader, model, faults)
    type(table_reader), intent(inout) :: reader
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer :: first
    first = verify(reader%line, ' '//tab)
    if (first == 0) return
    if (index('*#', reader%line(first:first)) > 0) return
    call split_words(reader)
    if (.not. reader%has_rows .and. upper_case(word(reader, 1)) == 'NODE') then
      call take_header(reader, faults)
    else
      call take_row(reader, model, faults)
    end if
  end subroutine take_line

  !> The words between commas as in data lines of a deck: without blanks and quotes around them, and
  !> without empty words at the end.
  pure subroutine split_words(reader)
    type(table_reader), intent(inout) :: reader
    integer :: most, used, number, position
    associate (line => reader%line)
      most = count([(line(position:position) == ',', position=1, len(line))]) + 1
      if (allocated(reader%first)) deallocate (reader%first, reader%last)
      allocate (reader%first(most), reader%last(most))
      used = 1
      position = 1
      do number = 1, most
        call next_word(line, position, reader%first(number), reader%last(number))
        if (position > len(line) + 1) exit
      end do
      do number = 1, min(number, most)
        call strip_quotes(line, reader%first(number), reader%last(number))
        if (reader%first(number) <= reader%last(number)) used = number
      end do
    end associate
    reader%first = reader%first(:used)
    reader%last = reader%last(:used)
  end subroutine split_words

  !> A word of the line. A name may have quotes inside: "Part 1-1".Set.
  pure function word(reader, number)
    type(table_reader), intent(in) :: reader
    integer, intent(in) :: number
    character(:), allocatable :: word
    word = plain_label(reader%line(reader%first(number):reader%last(number)))
  end function word

  !> 'node, 0, 30, 60': the times of the columns. One column may have any name.
  subroutine take_header(reader, faults)
    type(table_reader), intent(inout) :: reader
    type(diagnostic_list), intent(inout) :: faults
    logical :: is_number
    integer :: i, n
    n = size(reader%first) - 1
    if (n < 1) call fault(reader, 1, 'a header without columns', 'node, time, time, ..', faults)
    reader%num_columns = n
    if (n == 1) return
    deallocate (reader%value, reader%time)
    allocate (reader%value(n, 0), reader%time(n))
    do i = 1, n
      call parse_real(word(reader, i + 1), reader%time(i), is_number)
      if (.not. is_number) then
        call fault(reader, i + 1, "found '"//word(reader, i + 1)//"'", 'a time, a number [s]', &
                   faults)
      else if (i > 1) then
        if (reader%time(i) > reader%time(i - 1)) cycle
        call fault(reader, i + 1, 'time '//as_text(reader%time(i))//' after '// &
                   as_text(reader%time(i - 1)), 'times that ascend', faults)
      else
        cycle
      end if
      reader%num_columns = 0
      return
    end do
  end subroutine take_header

  !> 'node or set, temperature, ..'.
  subroutine take_row(reader, model, faults)
    type(table_reader), intent(inout) :: reader
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer, allocatable :: nodes(:)
    real(rk) :: values(reader%num_columns)
    logical :: is_number
    integer :: i
    reader%has_rows = .true.
    call find_nodes(reader, model, faults, nodes)
    if (size(reader%first) /= reader%num_columns + 1) then
      call fault(reader, min(size(reader%first), reader%num_columns + 2), &
                 'found '//as_text(size(reader%first) - 1)//' temperatures', &
                 as_text(reader%num_columns)//', one for each time of the header', faults)
      return
    end if
    do i = 1, reader%num_columns
      call parse_real(word(reader, i + 1), values(i), is_number)
      if (is_number .and. abs(values(i)) <= largest_number) cycle
      call fault(reader, i + 1, "found '"//word(reader, i + 1)//"'", &
                 'a temperature, a number [K]', faults)
      return
    end do
    do i = 1, size(nodes)
      call add_node(reader, nodes(i), values)
    end do
  end subroutine take_row

  !> The node, or the nodes of the set, that the first word names; empty after a fault.
  subroutine find_nodes(reader, model, faults, nodes)
    type(table_reader), intent(in) :: reader
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer, allocatable, intent(out) :: nodes(:)
    character(:), allocatable :: expected
    integer :: id, found
    logical :: is_node
    call find_flat_node(model%problem%outside, model%problem%instances, word(reader, 1), id, &
                        is_node)
    if (is_node) then
      found = model%node_position%find(id)
      nodes = pack([found], [found > 0])
      if (found > 0) return
      expected = 'a node of the model'
      if (size(model%problem%instances) > 0) expected = 'a node outside the instances, INSTANCE.12'
      call fault(reader, 1, 'node '//word(reader, 1)//' does not exist', expected, faults)
      return
    end if
    found = model%node_sets%find(upper_case(word(reader, 1)))
    if (found > 0) then
      nodes = model%node_sets%sets(found)%members
    else
      allocate (nodes(0))
      call fault(reader, 1, "there is no node set '"//word(reader, 1)//"' above this line", &
                 'the id of one node or the name of a set defined above', faults)
    end if
  end subroutine find_nodes

  !> Adds a node with its temperatures.
  subroutine add_node(reader, node, values)
    type(table_reader), intent(inout) :: reader
    integer, intent(in) :: node
    real(rk), intent(in) :: values(:) !< (times) [K]
    real(rk), allocatable :: longer(:, :)
    call make_room(reader%nodes, reader%used, 1)
    reader%used = reader%used + 1
    reader%nodes(reader%used) = node
    if (size(reader%value, 2) < reader%used) then
      allocate (longer(size(values), max(64, 2*size(reader%value, 2))))
      longer(:, :reader%used - 1) = reader%value(:, :reader%used - 1)
      call move_alloc(longer, reader%value)
    end if
    reader%value(:, reader%used) = values
  end subroutine add_node

  !> A fault at a word of the present line.
  subroutine fault(reader, number, problem, expected, faults)
    type(table_reader), intent(in) :: reader
    integer, intent(in) :: number !< of the word
    character(*), intent(in) :: problem, expected
    type(diagnostic_list), intent(inout) :: faults
    type(place) :: spot
    spot = reader%spot
    spot%column = reader%first(number)
    spot%length = max(1, reader%last(number) - reader%first(number) + 1)
    spot%source = reader%line
    call faults%add(severity_error, spot, problem, expected)
  end subroutine fault
end module temperature_file
