!> *EQUATION and *MPC: linear relations between displacements.
module keywords_equation
  use deck_card, only: card
  use diagnostics, only: diagnostic_list
  use keyword_spec, only: field, keyword, kind_text
  use keywords_other, only: add_refused_parameter
  use kinds, only: rk
  use model_draft, only: draft
  use named_things, only: nodes_in_order_at
  use node_dofs, only: num_directions
  use write_text, only: as_text
  implicit none
  private
  public :: describe_equation, describe_mpc, read_equation, read_mpc

  character, parameter :: nl = new_line('a')
  character(*), parameter :: without_remove = '*EQUATION without REMOVE: equations stay '// &
                             'in all steps'

  !> A term of an equation: for all nodes of a set, in the order of their ids.
  type :: term
    integer, allocatable :: nodes(:)
    integer :: direction = 0
    real(rk) :: coefficient = 0.0_rk
  end type term

contains

  subroutine describe_equation(spec)
    type(keyword), intent(out) :: spec
    spec%name = 'EQUATION'
    spec%family = 'joint'
    spec%place = 'model'
    spec%meaning = 'Linear equations between displacements: the sum of coefficient times '// &
                   'displacement is zero in all steps. For each equation a line with the '// &
                   'number of its terms, then the terms, any number a line. The '// &
                   'first term depends on the others: no support, tie or other equation '// &
                   'may hold it. Other terms may '// &
                   'be supported or depend on further ones. Node sets of one size stand for '// &
                   'one equation for each node, in the order of the ids, or in that of the '// &
                   'deck for sets with UNSORTED; a single node goes with all of them. '// &
                   'A node without elements is an unknown of its own in the '// &
                   'directions of its terms (different_meshes.md, 13.10).'
    spec%example = '*EQUATION'//nl//'3'//nl//'12, 1, 1., 47, 1, -0.5, 53, 1, -0.5'
    spec%checks_own_data = .true.
    spec%repeats_columns = .true.
    call add_refused_parameter(spec, 'REMOVE', without_remove)
    call add_refused_parameter(spec, 'REMOVE ALL', without_remove)
    allocate (spec%columns, source=[ &
              field('node', kind_text, 'a node or a node set'), &
              field('direction', kind_text, '1 to 3'), &
              field('coefficient', kind_text, 'a number')])
  end subroutine describe_equation

  subroutine read_equation(this, model, faults)
    type(card), intent(in) :: this
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(term), allocatable :: terms(:)
    integer :: line, start, num_terms, num_before
    if (this%has('REMOVE') .or. this%has('REMOVE ALL')) return ! reported
    if (this%num_lines < 2) then
      call this%fault(faults, 'found no whole equation', &
                      'at least 2 data lines: the number of terms, then the terms')
      return
    end if
    num_before = faults%num_errors
    call check_step(this, model, faults)
    line = 1
    do while (line <= this%num_lines .and. faults%num_errors == num_before)
      start = line
      call read_count(this, line, faults, num_terms)
      if (num_terms == 0) return
      allocate (terms(num_terms))
      call read_terms(this, line, model, faults, terms)
      if (faults%num_errors == num_before) call add_equations(this, start, terms, model, faults)
      deallocate (terms)
    end do
  end subroutine read_equation

  !> Equations act in all steps.
  subroutine check_step(this, model, faults)
    type(card), intent(in) :: this
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    if (model%num_steps == 0) return
    call this%fault(faults, 'an equation holds in all steps', 'a place above the first *STEP')
  end subroutine check_step

  !> The number of terms of an equation; 0 after a fault.
  subroutine read_count(this, line, faults, num_terms)
    type(card), intent(in) :: this
    integer, intent(inout) :: line !< the next one on return
    type(diagnostic_list), intent(inout) :: faults
    integer, intent(out) :: num_terms
    integer :: k, num_fields
    num_terms = 0
    if (this%is_integer_at(line, 1) .and. this%num_fields(line) == 1) then
      num_terms = this%integer_at(line, 1)
    end if
    num_fields = 0
    do k = line + 1, this%num_lines
      if (num_fields/3 >= num_terms) exit
      num_fields = num_fields + this%num_fields(k)
    end do
    if (num_terms < 2) then
      num_terms = 0
      call this%fault_at(faults, line, 1, "found '"//this%text_at(line, 1)//"'", &
                         'the number of terms of an equation, 2 or more, on a line of its own')
    else if (num_terms > num_fields/3) then
      call this%fault_at(faults, line, 1, 'the equation has '//as_text(num_fields/3)// &
                         ' terms', as_text(num_terms)//' terms: node, direction, coefficient')
      num_terms = 0
    end if
    line = line + 1
  end subroutine read_count

  !> The terms of an equation.
  subroutine read_terms(this, line, model, faults, terms)
    type(card), intent(in) :: this
    integer, intent(inout) :: line !< the next one on return
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(term), intent(inout) :: terms(:)
    integer :: k, i
    k = 0
    do while (k < size(terms) .and. line <= this%num_lines)
      if (mod(this%num_fields(line), 3) /= 0 .or. k + this%num_fields(line)/3 > size(terms)) then
        call this%fault_at(faults, line, 0, 'found '//as_text(this%num_fields(line))//' fields', &
                           as_text(size(terms) - k)//' more terms: node, direction, coefficient')
        return
      end if
      do i = 1, this%num_fields(line), 3
        k = k + 1
        call read_term(this, line, i, model, faults, terms(k))
      end do
      line = line + 1
    end do
    if (k < size(terms)) then
      call this%fault_at(faults, this%num_lines, 0, 'the equation has '//as_text(k)//' terms', &
                         as_text(size(terms))//' terms: node, direction, coefficient')
    else if (.not. abs(terms(1)%coefficient) > 0.0_rk .and. allocated(terms(1)%nodes)) then
      call this%fault_at(faults, line - 1, 0, 'the coefficient of the first term is zero', &
                         'a first term that depends on the others')
    end if
  end subroutine read_terms

  !> Three fields.
  subroutine read_term(this, line, first, model, faults, new)
    type(card), intent(in) :: this
    integer, intent(in) :: line, first
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(term), intent(inout) :: new
    call nodes_in_order_at(this, line, first, model, faults, new%nodes)
    if (this%is_integer_at(line, first + 1)) new%direction = this%integer_at(line, first + 1)
    if (new%direction < 1 .or. new%direction > num_directions) then
      call this%fault_at(faults, line, first + 1, "found '"//this%text_at(line, first + 1)//"'", &
                         'a direction, 1 to 3 (solids have no rotations)')
    end if
    if (this%is_real_at(line, first + 2)) then
      new%coefficient = this%real_at(line, first + 2)
    else
      call this%fault_at(faults, line, first + 2, "found '"//this%text_at(line, first + 2)//"'", &
                         'a coefficient, a number')
    end if
  end subroutine read_term

  !> One equation for each node of the sets.
  subroutine add_equations(this, line, terms, model, faults)
    type(card), intent(in) :: this
    integer, intent(in) :: line !< where the equation begins
    type(term), intent(in) :: terms(:)
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer :: nodes(size(terms)), i, k, num
    num = size(terms(1)%nodes)
    do k = 2, size(terms)
      if (size(terms(k)%nodes) == num .or. size(terms(k)%nodes) == 1) cycle
      call this%fault_at(faults, line, 0, 'the first term has '//as_text(num)//' nodes, term '// &
                         as_text(k)//' has '//as_text(size(terms(k)%nodes)), &
                         'as many nodes as the first term, or one')
      return
    end do
    do i = 1, num
      nodes = [(terms(k)%nodes(min(i, size(terms(k)%nodes))), k=1, size(terms))]
      call model%equations%add(nodes, terms%direction, terms%coefficient, model%current, line)
      model%has_element(nodes) = .true.
    end do
  end subroutine add_equations

  subroutine describe_mpc(spec)
    type(keyword), intent(out) :: spec
    spec%name = 'MPC'
    spec%family = 'joint'
    spec%place = 'model'
    spec%meaning = 'Constraints between nodes, as equations. TIE and PIN: the first node has '// &
                   'the displacements of the second. LINEAR: the first node lies between the '// &
                   'two others and moves with the line between them. Node sets of one size '// &
                   'stand for their nodes in the order of the ids, or in that of the deck for '// &
                   'sets with UNSORTED.'
    spec%example = '*MPC'//nl//'TIE, 12, 47'
    spec%fewest_lines = 1
    spec%checks_own_data = .true.
    allocate (spec%parameters(0))
    allocate (spec%columns, source=[ &
              field('type', kind_text, 'TIE, PIN or LINEAR'), &
              field('dependent', kind_text, 'a node or a node set'), &
              field('node', kind_text, 'a node or a node set'), &
              field('second', kind_text, 'a node or a node set, of LINEAR')])
  end subroutine describe_mpc

  subroutine read_mpc(this, model, faults)
    type(card), intent(in) :: this
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer :: line, num_nodes
    call check_step(this, model, faults)
    do line = 1, this%num_lines
      select case (this%word_at(line, 1))
      case ('TIE', 'PIN')
        num_nodes = 2
      case ('LINEAR')
        num_nodes = 3
      case default
        call this%fault_at(faults, line, 1, "found '"//this%text_at(line, 1)//"'", &
                           'TIE, PIN or LINEAR; *EQUATION for other linear constraints')
        cycle
      end select
      if (this%num_fields(line) /= num_nodes + 1) then
        call this%fault_at(faults, line, 0, 'found '//as_text(this%num_fields(line))//' fields', &
                           this%word_at(line, 1)//' and '//as_text(num_nodes)//' nodes')
        cycle
      end if
      call add_constraint(this, line, num_nodes, model, faults)
    end do
  end subroutine read_mpc

  !> The equations of one line of *MPC.
  subroutine add_constraint(this, line, num_nodes, model, faults)
    type(card), intent(in) :: this
    integer, intent(in) :: line, num_nodes
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(term) :: terms(num_nodes)
    integer :: nodes(num_nodes), k, i, direction, num_before
    num_before = faults%num_errors
    do k = 1, num_nodes
      call nodes_in_order_at(this, line, k + 1, model, faults, terms(k)%nodes)
      if (faults%num_errors > num_before) cycle
      if (size(terms(k)%nodes) == size(terms(1)%nodes) .or. size(terms(k)%nodes) == 1) cycle
      call this%fault_at(faults, line, k + 1, 'found '//as_text(size(terms(k)%nodes))//' nodes', &
                         'as many nodes as the first set, or one')
    end do
    if (faults%num_errors > num_before) return
    do i = 1, size(terms(1)%nodes)
      nodes = [(terms(k)%nodes(min(i, size(terms(k)%nodes))), k=1, num_nodes)]
      do direction = 1, num_directions
        call model%equations%add(nodes, spread(direction, 1, num_nodes), &
                                 [1.0_rk, -weights(model%problem%mesh%x(:, nodes))], &
                                 model%current, line)
      end do
      model%has_element(nodes) = .true.
    end do
  end subroutine add_constraint

  !> Weights of the nodes that the first one follows, by its place between them.
  pure function weights(x) result(weight)
    real(rk), intent(in) :: x(:, :) !< (3, nodes) [m]
    real(rk) :: weight(size(x, 2) - 1)
    real(rk) :: along(3)
    weight = 1.0_rk
    if (size(weight) == 1) return
    along = x(:, 3) - x(:, 2)
    weight(2) = dot_product(x(:, 1) - x(:, 2), along)/max(sum(along**2), tiny(1.0_rk))
    weight(1) = 1.0_rk - weight(2)
  end function weights
end module keywords_equation
