!> *BOUNDARY.
module keywords_boundary
  use deck_card, only: card
  use diagnostics, only: diagnostic_list
  use field_text, only: with_commas
  use keyword_spec, only: keyword, field, kind_choice, kind_integer, kind_real, kind_reference, &
                          kind_word
  use keywords_other, only: add_refused_parameter, shifted_history
  use kinds, only: rk
  use model_draft, only: draft
  use named_things, only: find_amplitude, nodes_at
  use moved_supports, only: note_acceleration, end_accelerations
  use nearest_words, only: nearest_choice
  use write_text, only: as_text
  implicit none
  private
  public :: describe_boundary, read_boundary, sets_support

  character, parameter :: nl = new_line('a')
  character(*), parameter :: types = 'DISPLACEMENT | ACCELERATION'
  character(*), parameter :: support_names = 'ENCASTRE | PINNED | XSYMM | YSYMM | ZSYMM | '// &
                             'XASYMM | YASYMM | ZASYMM'

contains

  subroutine describe_boundary(spec)
    type(keyword), intent(out) :: spec
    spec%name = 'BOUNDARY'
    spec%family = 'step'
    spec%place = 'anywhere'
    spec%meaning = 'Supports: fix degrees of freedom 1 to 3 or prescribe their displacement. '// &
                   'One dof only: leave the last out. Or a name in place of the dofs: '// &
                   'ENCASTRE, PINNED (1-3), XSYMM (1), YSYMM (2), ZSYMM (3), antisymmetry '// &
                   'XASYMM (2, 3), YASYMM (1, 3), ZASYMM (1, 2). Before the first step the '// &
                   'value is zero.'
    spec%example = '*BOUNDARY'//nl//'BASE, 1, 3'//nl//'CREST, 2, 2, 0.01'//nl//'SIDE, YSYMM'
    spec%fewest_lines = 1
    spec%new_clears = .true.
    spec%checks_own_data = .true.
    allocate (spec%parameters, source=[ &
              field('OP', kind_choice, 'keep supports of earlier steps, or remove them', &
                    default='MOD', choices='MOD | NEW'), &
              field('AMPLITUDE', kind_word, 'history of the values'), &
              field('TYPE', kind_choice, 'what is prescribed; ACCELERATION of all supports of '// &
                    'a direction is the motion of the base, results are relative to it; '// &
                    'OP=NEW ends it, and so do displacements of all these supports in a later '// &
                    'step', &
                    default='DISPLACEMENT', choices=types, is_checked_later=.true.)])
    call add_refused_parameter(spec, 'FIXED', 'the displacement that was reached, as value')
    call add_refused_parameter(spec, 'TIME DELAY', shifted_history)
    allocate (spec%columns, source=[ &
              field('node', kind_reference, 'the nodes', &
                    is_required=.true.), &
              field('first dof', kind_integer, '1 to 3, or a name', is_required=.true., &
                    lowest=1.0_rk, highest=3.0_rk), &
              field('last dof', kind_integer, '1 to 3', default='the first', lowest=1.0_rk, &
                    highest=3.0_rk), &
              field('value', kind_real, 'displacement', 'm', '0')])
  end subroutine describe_boundary

  subroutine read_boundary(this, model, faults)
    type(card), intent(in) :: this
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer, allocatable :: nodes(:), dofs(:)
    integer :: line, i, history
    real(rk) :: value
    call find_amplitude(this, model, faults, history)
    call check_type(this, model, faults)
    if (this%word('OP') == 'NEW') then
      call model%supports%clear_old()
      call end_accelerations(model)
    end if
    do line = 1, this%num_lines
      call nodes_at(this, line, 1, model, faults, nodes)
      call read_dofs(this, line, faults, dofs)
      call read_value(this, line, model%is_in_step, faults, value)
      if (this%word('TYPE') == 'ACCELERATION') then
        do i = 1, size(dofs)
          call note_acceleration(this, line, nodes, dofs(i), value, history, model, faults)
        end do
        cycle
      end if
      call warn_of_second_value(this, line, nodes, dofs, value, history, model, faults)
      do i = 1, size(dofs)
        call model%supports%put(nodes, dofs(i), value, history)
      end do
    end do
  end subroutine read_boundary

  !> Whether a card without faults supports a node in a direction.
  logical function sets_support(this, model, node, dof) result(is_set)
    type(card), intent(in) :: this
    type(draft), intent(in) :: model
    integer, intent(in) :: node !< position
    integer, intent(in) :: dof !< 1..3
    type(diagnostic_list) :: faults
    integer, allocatable :: nodes(:), dofs(:)
    integer :: line
    is_set = .false.
    do line = 1, this%num_lines
      call nodes_at(this, line, 1, model, faults, nodes)
      call read_dofs(this, line, faults, dofs)
      is_set = is_set .or. (any(nodes == node) .and. any(dofs == dof))
    end do
  end function sets_support

  !> What is prescribed.
  subroutine check_type(this, model, faults)
    type(card), intent(in) :: this
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    select case (this%word('TYPE'))
    case ('DISPLACEMENT')
    case ('ACCELERATION')
      call check_acceleration(this, model, faults)
    case default
      call this%fault_parameter(faults, 'TYPE', "TYPE: found '"//this%text('TYPE')//"'", &
                                'DISPLACEMENT, or ACCELERATION of all supports; for '// &
                                'velocities DISPLACEMENT with the integral of their history', &
                                nearest_choice(this%text('TYPE'), types))
    end select
  end subroutine check_type

  !> An acceleration has a history and belongs to a step.
  subroutine check_acceleration(this, model, faults)
    type(card), intent(in) :: this
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    if (.not. this%has('AMPLITUDE')) then
      call this%fault_parameter(faults, 'TYPE', 'an acceleration without a history', 'AMPLITUDE')
    else if (.not. model%is_in_step) then
      call this%fault_parameter(faults, 'TYPE', 'an acceleration before the first step', &
                                'a step *DYNAMIC')
    end if
  end subroutine check_acceleration

  !> Of two displacements of a degree of freedom in one step the last acts.
  subroutine warn_of_second_value(this, line, nodes, dofs, value, history, model, faults)
    type(card), intent(in) :: this
    integer, intent(in) :: line, nodes(:)
    integer, intent(in) :: dofs(:)
    real(rk), intent(in) :: value !< [m]
    integer, intent(in) :: history !< amplitude, 0 for none
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer :: d, i
    associate (table => model%supports)
      do d = 1, size(dofs)
        do i = 1, size(nodes)
          if (.not. table%is_new(dofs(d), nodes(i))) cycle
          if (abs(table%value(dofs(d), nodes(i)) - value) <= 0.0_rk .and. &
              (table%history(dofs(d), nodes(i)) == history .or. abs(value) <= 0.0_rk)) cycle
          call this%warn_at(faults, line, 1, 'node '// &
                            as_text(model%problem%mesh%node_id(nodes(i)))//' already '// &
                            'has the displacement '//as_text(table%value(dofs(d), nodes(i)))// &
                            ' in direction '//as_text(dofs(d))//' in this step; the later '// &
                            'value '//as_text(value)//' is used')
          return
        end do
      end do
    end associate
  end subroutine warn_of_second_value

  !> The degrees of freedom of a line; none after a fault.
  subroutine read_dofs(this, line, faults, dofs)
    type(card), intent(in) :: this
    integer, intent(in) :: line
    type(diagnostic_list), intent(inout) :: faults
    integer, allocatable, intent(out) :: dofs(:)
    integer :: i, highest, last
    allocate (dofs(0))
    if (this%num_fields(line) > 4) then
      call this%fault_at(faults, line, 5, 'too many fields', 'node, first dof, last dof, value')
    end if
    if (.not. this%is_integer_at(line, 2)) then
      call read_support_name(this, line, faults, dofs)
      return
    end if
    highest = 3
    if (abs(this%real_at(line, 4)) <= 0.0_rk .and. this%integer_at(line, 3) > 3) highest = 6
    do i = 2, 3
      if (i == 3 .and. this%is_empty_at(line, i)) cycle
      if (this%integer_at(line, i) >= 1 .and. this%integer_at(line, i) <= highest) cycle
      call this%fault_at(faults, line, i, "found '"//this%text_at(line, i)//"'", &
                         'a degree of freedom, 1 to 3 (solids have no rotations)')
      return
    end do
    last = this%integer_at(line, 2)
    if (.not. this%is_empty_at(line, 3)) last = this%integer_at(line, 3)
    if (last < this%integer_at(line, 2)) then
      call this%fault_at(faults, line, 3, 'the last dof is below the first', &
                         'the smaller one first, as in 1, 3 for all three directions')
    end if
    if (last > 3) call this%ignore(faults, 'dof 4 to 6 have no effect: solids have no rotations')
    dofs = [(i, i=this%integer_at(line, 2), min(last, 3))]
  end subroutine read_dofs

  !> The degrees of freedom of a support that has a name.
  subroutine read_support_name(this, line, faults, dofs)
    type(card), intent(in) :: this
    integer, intent(in) :: line
    type(diagnostic_list), intent(inout) :: faults
    integer, allocatable, intent(inout) :: dofs(:)
    select case (this%word_at(line, 2))
    case ('ENCASTRE', 'PINNED')
      dofs = [1, 2, 3]
    case ('XSYMM')
      dofs = [1]
    case ('YSYMM')
      dofs = [2]
    case ('ZSYMM')
      dofs = [3]
    case ('XASYMM')
      dofs = [2, 3]
    case ('YASYMM')
      dofs = [1, 3]
    case ('ZASYMM')
      dofs = [1, 2]
    case default
      call this%fault_at(faults, line, 2, "found '"//this%text_at(line, 2)//"'", &
                         'a degree of freedom, 1 to 3, or '//with_commas(support_names), &
                         nearest_choice(this%word_at(line, 2), support_names))
      return
    end select
    if (this%num_fields(line) > 2) then
      call this%fault_at(faults, line, first_given(this, line, 3), 'found '// &
                         as_text(this%num_fields(line))//' fields with the name of a support', &
                         '2 fields: node, '//this%word_at(line, 2))
    end if
  end subroutine read_support_name

  !> The first field of a line with a word, from a field on; that field where there is none.
  pure integer function first_given(this, line, first) result(i)
    type(card), intent(in) :: this
    integer, intent(in) :: line, first
    do i = first, this%num_fields(line)
      if (.not. this%is_empty_at(line, i)) return
    end do
    i = first
  end function first_given

  !> The displacement, which must be zero before the first step.
  subroutine read_value(this, line, is_in_step, faults, value)
    type(card), intent(in) :: this
    integer, intent(in) :: line
    logical, intent(in) :: is_in_step
    type(diagnostic_list), intent(inout) :: faults
    real(rk), intent(out) :: value !< [m]
    value = 0.0_rk
    if (this%is_empty_at(line, 4) .or. .not. this%is_integer_at(line, 2)) return
    if (.not. this%is_real_at(line, 4)) then
      call this%fault_at(faults, line, 4, "found '"//this%text_at(line, 4)//"'", &
                         'a displacement, a number [m]')
    end if
    value = this%real_at(line, 4)
    if (is_in_step .or. abs(value) <= 0.0_rk) return
    call this%fault_at(faults, line, 4, 'a displacement before the first step', &
                       'zero; give it in a step')
  end subroutine read_value
end module keywords_boundary
