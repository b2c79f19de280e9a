!> Reads a deck into the problem, in passes over its cards; all faults are collected.
module read_deck
  use problem_definition, only: problem ! first: gfortran 12 fails to write the module otherwise
  use card_check, only: check_card
  use card_match, only: match_card
  use check_bases, only: warn_of_bases
  use check_histories, only: warn_of_histories
  use check_idle_steps, only: warn_of_idle_steps
  use check_inner_faces, only: warn_of_inner_faces
  use check_loads, only: warn_of_loads
  use check_light_solids, only: warn_of_light_solids
  use check_magnitudes, only: warn_of_magnitudes
  use deck_units, only: note_units
  use check_motions, only: warn_of_motions
  use check_growth, only: warn_of_growth
  use check_pressures, only: warn_of_pressures
  use check_units, only: warn_of_units
  use check_mesh, only: warn_of_mesh
  use card_digests, only: digests_of_cards, list_input_files
  use check_names, only: verify_names
  use check_nodes, only: warn_of_nodes
  use check_repeats, only: warn_of_repeats
  use check_requests, only: warn_of_missing_fields
  use check_steps, only: verify_steps
  use check_unused, only: warn_of_unused
  use check_water, only: warn_of_water
  use choose_c3d8, only: choose_element
  use deck_card, only: card
  use deck_echo, only: echo_of_cards
  use deck_lexer, only: read_cards
  use deck_options, only: reading_options
  use diagnostics, only: diagnostic_list, place, severity_error
  use finish_heat, only: warn_of_heat
  ! gfortran 12 reads finish_model rightly after this module alone.
  use keyword_catalogue, only: list_keywords
  use finish_model, only: complete_model
  use finish_tests, only: complete_tests
  use flatten_assembly, only: flatten
  use leave_out_faces, only: leave_out
  use plain_labels, only: drop_inner_quotes
  use inelastic_blocks, only: list_inelastic_blocks
  use stage_plan, only: classes_of
  use keyword_handler, only: keyword_list, pass_elements, pass_nodes, pass_rest
  use keyword_spec, only: keyword, without_effect
  use keywords_elements, only: make_room_for_elements, trim_mesh
  use keywords_nodes, only: make_room_for_nodes
  use keywords_section, only: echo_mass
  use load_cards, only: list_load_cards, load_card_list
  use model_draft, only: draft
  use umat_loader, only: user_library
  use verify_model, only: verify
  implicit none
  private
  public :: read_problem

contains

  !> Reads and verifies a deck. The problem can be solved if `faults` has no error.
  subroutine read_problem(path, full_problem, faults, echo, options, umat)
    character(*), intent(in) :: path !< of the deck
    type(problem), allocatable, intent(out) :: full_problem
    type(diagnostic_list), intent(inout) :: faults
    character(:), allocatable, intent(out) :: echo !< the deck with every default value
    type(reading_options), intent(in), optional :: options
    type(user_library), pointer, intent(in), optional :: umat !< library of --umat
    type(keyword_list) :: list
    type(draft) :: model
    integer, allocatable :: keyword_of_card(:)
    call list_keywords(list)
    call read_cards(path, list%specs, model%cards, faults, model%is_from_cae)
    if (size(model%cards) == 0 .and. .not. faults%has_errors()) then
      call faults%add(severity_error, place(file=path, keyword='', source=''), &
                      'the deck is empty', 'keywords, lines that begin with *')
    end if
    call open_draft(path, model)
    if (present(options)) model%options = options
    echo = ''
    call make_flat(list, model, faults)
    if (faults%has_errors() .and. size(model%cards) == 0) return
    if (present(umat)) model%problem%umat => umat
    call match_cards(list, model, keyword_of_card, faults)
    call make_room_for_names(list, keyword_of_card, model)
    call handle_cards(list, keyword_of_card, model, faults)
    call trim_lists(model)
    if (model%options%is_for_tests) then
      call complete_tests(model, faults)
    else
      call complete_and_verify(model, faults)
    end if
    call list_input_files(model%cards, model%problem%inputs)
    if (.not. (model%options%is_for_tests .or. faults%has_errors())) then
      call digests_of_cards(model%cards, model%problem%cards)
    end if
    call echo_mass(model)
    call move_alloc(model%problem, full_problem)
    echo = echo_of_cards(model%cards)
  end subroutine read_problem

  !> Completes and verifies the draft of the problem.
  subroutine complete_and_verify(model, faults)
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(load_card_list) :: cards
    call complete_model(model, faults)
    if (.not. faults%has_errors()) call verify(model, faults)
    if (.not. faults%has_errors()) call verify_names(model, faults)
    if (.not. faults%has_errors()) call verify_steps(model, faults)
    if (faults%has_errors()) return
    call note_units(model%problem)
    call warn_of_mesh(model, faults)
    call warn_of_unused(model, faults)
    call list_load_cards(model%cards, cards)
    call warn_of_loads(model, cards, faults)
    call warn_of_pressures(model, cards, faults)
    call warn_of_inner_faces(model, cards, faults)
    call warn_of_units(model, faults)
    call warn_of_magnitudes(model, faults)
    call warn_of_light_solids(model, faults)
    call warn_of_motions(model, cards, faults)
    call warn_of_growth(model, faults)
    call warn_of_heat(model, faults)
    call warn_of_water(model, faults)
    call warn_of_bases(model, faults)
    call warn_of_nodes(model, faults)
    call warn_of_histories(model, faults)
    call warn_of_idle_steps(model, faults)
    call warn_of_repeats(model, faults)
    call list_inelastic(model%problem)
    call warn_of_missing_fields(model, faults)
  end subroutine complete_and_verify

  !> Lists the blocks of inelastic solids; elements that come and go together share blocks.
  subroutine list_inelastic(model)
    type(problem), intent(inout) :: model
    if (allocated(model%stages%is_absent)) then
      call list_inelastic_blocks(model%mesh, model%materials, model%inelastic, &
                                 classes_of(model%stages%is_absent))
    else
      call list_inelastic_blocks(model%mesh, model%materials, model%inelastic)
    end if
  end subroutine list_inelastic

  !> Opens the draft of a problem with empty lists.
  subroutine open_draft(path, model)
    character(*), intent(in) :: path
    type(draft), intent(inout) :: model
    integer :: i
    allocate (model%problem)
    associate (problem => model%problem)
      problem%deck_file = path
      problem%heading = ''
      allocate (problem%joints(0), problem%guests(0), problem%covers(0))
      allocate (problem%loads(0), problem%initial_values(0), problem%tests(0))
      allocate (problem%steps(count([(model%cards(i)%keyword == 'STEP', i=1, size(model%cards))])))
    end associate
    allocate (model%test_origin(0), model%laws(0), model%joints(0))
    allocate (model%material_requests(0), model%procedure_card(0), model%ties(0))
    allocate (model%kept_supports(0))
    allocate (model%interfaces(0), model%interactions(0), model%clearances(0))
  end subroutine open_draft

  !> Cards of a model without parts, without elements of lines and faces, with the meaning of C3D8.
  subroutine make_flat(list, model, faults)
    type(keyword_list), intent(in) :: list
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    call drop_inner_quotes(model%cards)
    call leave_out(model%cards, model%faces, faults)
    associate (problem => model%problem)
      call flatten(model%cards, list%specs, problem%outside, problem%instances, faults)
      call choose_element(model%cards, model%options%c3d8, size(problem%instances) > 0, faults)
    end associate
  end subroutine make_flat

  !> Finds the keyword of each card and checks its place.
  subroutine match_cards(list, model, keyword_of_card, faults)
    type(keyword_list), intent(in) :: list
    type(draft), intent(inout) :: model
    integer, allocatable, intent(out) :: keyword_of_card(:) !< 0: without a handler
    type(diagnostic_list), intent(inout) :: faults
    character(:), allocatable :: where_it_stands
    logical :: is_in_step, is_in_material
    integer :: i, found, last_step
    allocate (keyword_of_card(size(model%cards)), source=0)
    last_step = findloc([(model%cards(i)%keyword == 'STEP', i=1, size(model%cards))], .true., &
                        dim=1, back=.true.)
    is_in_step = .false.
    is_in_material = .false.
    do i = 1, size(model%cards)
      where_it_stands = 'model'
      if (is_in_step) where_it_stands = 'step'
      if (is_in_material) where_it_stands = 'material'
      call match_card(model%cards(i), list%specs, faults, found, where_it_stands)
      if (found == 0) cycle
      associate (spec => list%specs(found))
        call check_place(model, i, spec%place, is_in_step, is_in_material, faults, found)
        if (i > last_step .and. .not. is_in_step) then
          call check_step_follows(model%cards(i), spec, last_step, faults, found)
        end if
        is_in_material = spec%name == 'MATERIAL' .or. is_in_material .and. spec%place == 'material'
        if (spec%name == 'STEP') is_in_step = .true.
        if (spec%name == 'END STEP') is_in_step = .false.
      end associate
      keyword_of_card(i) = found
    end do
  end subroutine match_cards

  !> Step keywords must be in a step, properties in a material; else `found` is set to 0.
  subroutine check_place(model, i, place, is_in_step, is_in_material, faults, found)
    type(draft), intent(in) :: model
    integer, intent(in) :: i !< card
    character(*), intent(in) :: place !< of its keyword
    logical, intent(in) :: is_in_step, is_in_material
    type(diagnostic_list), intent(inout) :: faults
    integer, intent(inout) :: found
    if (place == 'step' .and. .not. is_in_step) then
      call model%cards(i)%fault(faults, 'the keyword is outside a step', &
                                'a place between *STEP and *END STEP')
      found = 0
    else if (place == 'material' .and. .not. is_in_material) then
      call model%cards(i)%fault(faults, 'the keyword is outside a material', &
                                'a place below *MATERIAL and its properties')
      found = 0
    end if
  end subroutine check_place

  !> A keyword that acts from the next step on must have one; else `found` is set to 0. Decks
  !> without steps are those of materials.
  subroutine check_step_follows(this, spec, last_step, faults, found)
    type(card), intent(in) :: this !< below the last *STEP
    type(keyword), intent(in) :: spec !< of its keyword
    integer, intent(in) :: last_step !< card, 0 for none
    type(diagnostic_list), intent(inout) :: faults
    integer, intent(inout) :: found
    if (spec%place /= 'anywhere' .or. spec%status == without_effect .or. last_step == 0) return
    call this%fault(faults, 'no step follows the keyword', &
                    'a place in a step or above the last *STEP')
    found = 0
  end subroutine check_step_follows

  !> Makes room for surfaces, amplitudes, materials and sections.
  subroutine make_room_for_names(list, keyword_of_card, model)
    type(keyword_list), intent(in) :: list
    integer, intent(in) :: keyword_of_card(:)
    type(draft), intent(inout) :: model
    integer :: num
    associate (problem => model%problem)
      num = num_cards('SURFACE')
      allocate (problem%surfaces(num), model%surface_origin(num))
      num = num_cards('AMPLITUDE')
      allocate (problem%amplitudes(num), model%record_factor(num), model%record_unit(num))
      num = num_cards('MATERIAL')
      allocate (problem%materials(num), model%material_origin(num))
      allocate (model%sections(num_cards('SOLID SECTION')))
    end associate

  contains

    !> Number of cards of a keyword.
    pure integer function num_cards(name)
      character(*), intent(in) :: name
      integer :: i
      num_cards = 0
      do i = 1, size(keyword_of_card)
        if (keyword_of_card(i) == 0) cycle
        if (list%specs(keyword_of_card(i))%name == name) num_cards = num_cards + 1
      end do
    end function num_cards
  end subroutine make_room_for_names

  !> Removes the room of cards with faults. Whole lists stay: cutting copies them.
  subroutine trim_lists(model)
    type(draft), intent(inout) :: model
    associate (problem => model%problem, surfaces => model%num_surfaces, &
               steps => model%num_steps, amplitudes => model%num_amplitudes)
      if (steps < size(problem%steps)) problem%steps = problem%steps(:steps)
      if (surfaces < size(problem%surfaces)) problem%surfaces = problem%surfaces(:surfaces)
      if (amplitudes < size(problem%amplitudes)) problem%amplitudes = &
        problem%amplitudes(:amplitudes)
    end associate
  end subroutine trim_lists

  !> Checks and handles the cards pass by pass.
  subroutine handle_cards(list, keyword_of_card, model, faults)
    type(keyword_list), intent(in) :: list
    integer, intent(in) :: keyword_of_card(:)
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(diagnostic_list) :: dropped
    integer :: pass, i
    do pass = pass_nodes, pass_rest
      if (pass == pass_nodes) call make_room_for_nodes(model, count_lines(pass))
      if (pass == pass_elements) call make_room_for_elements(model, count_lines(pass))
      do i = 1, size(keyword_of_card)
        if (keyword_of_card(i) == 0) cycle
        if (list%entries(keyword_of_card(i))%pass /= pass) cycle
        model%current = i
        call handle_card(list, keyword_of_card(i), model, faults, dropped)
      end do
      if (pass == pass_elements) call open_tables(model)
    end do

  contains

    !> Number of data lines of all cards of a pass.
    pure integer function count_lines(wanted) result(num_lines)
      integer, intent(in) :: wanted
      integer :: j
      num_lines = 0
      do j = 1, size(keyword_of_card)
        if (keyword_of_card(j) == 0) cycle
        if (list%entries(keyword_of_card(j))%pass /= wanted) cycle
        num_lines = num_lines + model%cards(j)%num_lines
      end do
    end function count_lines
  end subroutine handle_cards

  !> A faulty card is handled too, so that its definition exists; its further faults are dropped.
  subroutine handle_card(list, number, model, faults, dropped)
    type(keyword_list), intent(in) :: list
    integer, intent(in) :: number !< of the keyword
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(diagnostic_list), intent(inout) :: dropped !< further faults of faulty cards
    call check_card(model%cards(model%current), list%specs(number), faults, model%is_right)
    if (model%is_right) then
      call list%entries(number)%handle(model%cards(model%current), model, faults)
    else
      call list%entries(number)%handle(model%cards(model%current), model, dropped)
    end if
  end subroutine handle_card

  !> Opens the tables by node and element.
  subroutine open_tables(model)
    type(draft), intent(inout) :: model
    call trim_mesh(model)
    call model%supports%prepare(model%problem%mesh%num_nodes)
    call model%point_forces%prepare(model%problem%mesh%num_nodes)
    call mark_nodes_of_elements(model)
    allocate (model%joint_of_element(model%problem%mesh%num_elements), source=0)
    allocate (model%interface_of_element(model%problem%mesh%num_elements), source=0)
  end subroutine open_tables

  !> Marks the nodes that an element has.
  subroutine mark_nodes_of_elements(model)
    type(draft), intent(inout) :: model
    integer :: e, k
    allocate (model%has_element(model%problem%mesh%num_nodes), source=.false.)
    associate (nodes => model%problem%mesh%nodes)
      do e = 1, model%problem%mesh%num_elements
        do k = 1, size(nodes, 1)
          if (nodes(k, e) > 0) model%has_element(nodes(k, e)) = .true.
        end do
      end do
    end associate
  end subroutine mark_nodes_of_elements
end module read_deck
