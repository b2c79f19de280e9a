!> *MODEL CHANGE and *GROUT: a dam that is built in stages.
module keywords_stages
  use card_check, only: longest_name
  use deck_card, only: card
  use diagnostics, only: diagnostic_list
  use element_catalogue, only: is_solid
  use keyword_spec, only: field, keyword, kind_choice, kind_flag, kind_real, kind_reference, &
                          kind_word
  use kinds, only: rk
  use model_draft, only: draft
  use named_things, only: elements_at, joint_names
  use nearest_words, only: nearest_word
  use step_plan, only: grouting
  use write_text, only: as_text
  implicit none
  private
  public :: describe_model_change, read_model_change, describe_grout, read_grout

  character, parameter :: nl = new_line('a')

contains

  subroutine describe_model_change(spec)
    type(keyword), intent(out) :: spec
    spec%name = 'MODEL CHANGE'
    spec%family = 'stages'
    spec%place = 'step'
    spec%meaning = 'Takes solid elements out of the model, or puts them back, at the start of '// &
                   'a static step. All elements are there when the analysis starts: remove '// &
                   'in the first step what is built later. Elements that are added have no '// &
                   'stress in the geometry of this moment, and a new history. The forces '// &
                   'that the change leaves without balance act over the step. Absent '// &
                   'elements have neither weight nor mass, nor loads on their faces; a point '// &
                   'of a joint acts while the elements on both sides of its face are there, '// &
                   'a tied node while all nodes of the tie have an element. ADD alone is '// &
                   'ADD=STRAIN FREE.'
    spec%example = '*MODEL CHANGE, TYPE=ELEMENT, REMOVE'//nl//'LIFT_2, LIFT_3'//nl// &
                   '*MODEL CHANGE, TYPE=ELEMENT, ADD=STRAIN FREE'//nl//'LIFT_2'
    spec%fewest_lines = 1
    spec%repeats_columns = .true.
    allocate (spec%parameters, source=[ &
              field('TYPE', kind_choice, 'what changes', default='ELEMENT', choices='ELEMENT'), &
              field('REMOVE', kind_flag, 'takes the elements out'), &
              field('ADD', kind_choice, 'puts the elements in, without stress', &
                    choices='STRAIN FREE | STRAINFREE', may_be_bare=.true., &
                    instead='elements that are added have no stress')])
    allocate (spec%columns, source=[ &
              field('elements', kind_reference, 'an element or a set', is_required=.true.)])
  end subroutine describe_model_change

  subroutine read_model_change(this, model, faults)
    type(card), intent(in) :: this
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer, allocatable :: elements(:)
    integer :: line, at, step
    if (this%has('REMOVE') .eqv. this%has('ADD')) then
      call this%fault(faults, 'the card does not say whether elements come or go', &
                      'either REMOVE or ADD=STRAIN FREE')
      return
    end if
    step = model%num_steps + 1
    associate (mesh => model%problem%mesh, plan => model%problem%stages)
      if (.not. allocated(plan%is_absent)) then
        allocate (plan%is_absent(mesh%num_elements, size(model%problem%steps)), source=.false.)
      end if
      do line = 1, this%num_lines
        do at = 1, this%num_fields(line)
          if (this%is_empty_at(line, at)) cycle
          call elements_at(this, line, at, model, faults, elements)
          call check_solids(this, line, at, elements, model, faults)
          call warn_of_no_change(this, line, at, elements, plan%is_absent(:, step), model, faults)
          call warn_of_return(this, line, at, elements, step, model, faults)
          plan%is_absent(elements, step:) = this%has('REMOVE')
        end do
      end do
    end associate
  end subroutine read_model_change

  !> Only solids come and go; joints follow the solids behind them.
  subroutine check_solids(this, line, at, elements, model, faults)
    type(card), intent(in) :: this
    integer, intent(in) :: line, at
    integer, intent(in) :: elements(:) !< positions
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer :: k
    associate (mesh => model%problem%mesh)
      k = findloc(is_solid(mesh%element_type(elements)), .false., dim=1)
      if (k == 0) return
      call this%fault_at(faults, line, at, 'element '//as_text(mesh%element_id(elements(k)))// &
                         ' is a '//trim(mesh%element_type(elements(k))), &
                         'solid elements; joints act where the elements behind them are there')
    end associate
  end subroutine check_solids

  !> A set whose elements are already absent, or there.
  subroutine warn_of_no_change(this, line, at, elements, is_absent, model, faults)
    type(card), intent(in) :: this
    integer, intent(in) :: line, at
    integer, intent(in) :: elements(:) !< positions
    logical, intent(in) :: is_absent(:) !< (elements) so far
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer :: k
    k = findloc(is_absent(elements) .eqv. this%has('REMOVE'), .true., dim=1)
    if (k == 0) return
    call this%warn_at(faults, line, at, 'element '// &
                      as_text(model%problem%mesh%element_id(elements(k)))//' is '// &
                      trim(merge('absent', 'there ', this%has('REMOVE')))//' already')
  end subroutine warn_of_no_change

  !> A set that leaves and comes, or comes and leaves, in one step.
  subroutine warn_of_return(this, line, at, elements, step, model, faults)
    type(card), intent(in) :: this
    integer, intent(in) :: line, at
    integer, intent(in) :: elements(:) !< positions
    integer, intent(in) :: step !< number
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    logical :: was_absent(size(elements)), is_absent(size(elements))
    integer :: k
    associate (plan => model%problem%stages)
      was_absent = .false.
      if (step > 1) was_absent = plan%is_absent(elements, step - 1)
      is_absent = plan%is_absent(elements, step)
    end associate
    k = findloc((was_absent .neqv. is_absent) .and. (is_absent .neqv. this%has('REMOVE')), &
                .true., dim=1)
    if (k == 0) return
    call this%warn_at(faults, line, at, 'element '// &
                      as_text(model%problem%mesh%element_id(elements(k)))//' leaves and '// &
                      'comes in one step: that has no effect', &
                      'two steps, where it is to come without stress')
  end subroutine warn_of_return

  subroutine describe_grout(spec)
    type(keyword), intent(out) :: spec
    spec%name = 'GROUT'
    spec%family = 'stages'
    spec%place = 'step'
    spec%meaning = 'Grouts a joint in a static step. Before its first *GROUT in the deck a '// &
                   'joint has contact and friction, without strength and cohesion. From this '// &
                   'step on the present opening is the zero of the law, and strength and '// &
                   'cohesion act. A point that is pressed keeps its pressure. Points that '// &
                   'appear later are not grouted until the next *GROUT of the joint; intact '// &
                   'points stay as they are. With PRESSURE the grout presses the faces apart, '// &
                   'rising over the step, and hardens at its end. Points that are intact at '// &
                   'the start of the step hold no grout, also where they break within it.'
    spec%example = '*GROUT, JOINT=J1'//nl//'*GROUT, JOINT=J2, PRESSURE=3e5'
    spec%most_lines = 0
    allocate (spec%parameters, source=[ &
              field('JOINT', kind_word, 'name of the joint', is_required=.true.), &
              field('PRESSURE', kind_real, 'pressure of the grout', 'Pa', '0')])
    spec%parameters(2)%lowest = 0.0_rk
    allocate (spec%columns(0))
  end subroutine describe_grout

  subroutine read_grout(this, model, faults)
    type(card), intent(in) :: this
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    character(longest_name) :: known(size(model%joints))
    integer :: found
    known = joint_names(model)
    found = findloc(known == this%word('JOINT'), .true., dim=1)
    if (found == 0) then
      call this%fault_parameter(faults, 'JOINT', "there is no joint '"//this%text('JOINT')//"'", &
                                'the name of a *JOINT', nearest_word(this%word('JOINT'), known))
      return
    end if
    if (.not. allocated(model%now%grouts)) allocate (model%now%grouts(0))
    if (any(model%now%grouts%joint == found)) then
      call this%fault_parameter(faults, 'JOINT', 'the joint is grouted twice in this step', &
                                'one *GROUT of a joint in a step')
    end if
    model%now%grouts = [model%now%grouts, grouting(found, this%real('PRESSURE'))]
  end subroutine read_grout
end module keywords_stages
