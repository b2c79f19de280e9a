!> Words of a card of an instance, of the assembly or outside, as the flat model has them:
!> INSTANCE.SET for names, numbers with the offset of their instance, coordinates in their place.
module instance_words
  use assembly_structure, only: flat_card, model_structure, number_range
  use card_rewrite, only: card_rewriter
  use deck_card, only: card
  use diagnostics, only: diagnostic_list
  use instance_numbers, only: begins_element
  use instance_placement, only: placed
  use keyword_spec, only: column_of_field, find_spec, keyword, kind_reference
  use kinds, only: rk
  use parse_text, only: parse_integer, upper_case, without_blanks
  use write_text, only: as_text
  implicit none
  private
  public :: rewrite_card

  !> What a word of a card may refer to.
  type :: scope
    integer :: owner = 1 !< instance of plain names and numbers; 1: outside
    logical :: is_element = .false. !< numbers are those of elements, else of nodes
  end type scope

contains

  !> Rewrites the words of a card.
  subroutine rewrite_card(this, where_it_stands, structure, specs, faults)
    type(card), intent(inout) :: this
    type(flat_card), intent(in) :: where_it_stands
    type(model_structure), intent(in) :: structure
    type(keyword), intent(in) :: specs(:)
    type(diagnostic_list), intent(inout) :: faults
    type(card_rewriter) :: words
    integer :: owner, num_before
    num_before = faults%num_errors
    owner = where_it_stands%owner
    this%lines%is_repeat = where_it_stands%is_from_part .and. &
                           structure%instances(owner)%is_repeat
    call words%begin(this)
    if (owner > 1) call rewrite_names(this, words, structure%instances(owner)%name)
    if (this%has('INSTANCE')) call take_instance(this, structure, owner, faults)
    select case (without_blanks(this%keyword))
    case ('NODE')
      call rewrite_nodes(this, words, structure, structure%instances(owner)%nodes, owner)
    case ('ELEMENT')
      call rewrite_elements(this, words, owner, structure, faults)
    case default
      call rewrite_references(this, words, owner, structure, specs, faults)
    end select
    call words%finish(this)
    if (faults%num_errors > num_before) this%lines%is_repeat = .true. ! one error for a word
  end subroutine rewrite_card

  !> Names of sets and surfaces of an instance begin with its name.
  subroutine rewrite_names(this, words, owner)
    type(card), intent(inout) :: this
    type(card_rewriter), intent(inout) :: words
    character(*), intent(in) :: owner !< name of the instance
    integer :: i
    do i = 1, size(this%parameters)
      select case (this%parameters(i)%name)
      case ('NSET', 'ELSET')
      case ('NAME')
        if (this%keyword /= 'SURFACE') cycle
      case default
        cycle
      end select
      call words%put_value(this, i, owner//'.'//this%text(this%parameters(i)%name))
    end do
  end subroutine rewrite_names

  !> INSTANCE=name says whose numbers and names the data lines hold.
  subroutine take_instance(this, structure, owner, faults)
    type(card), intent(in) :: this
    type(model_structure), intent(in) :: structure
    integer, intent(inout) :: owner
    type(diagnostic_list), intent(inout) :: faults
    integer :: found
    found = find_instance(structure, this%word('INSTANCE'))
    if (found == 0) then
      call this%fault_parameter(faults, 'INSTANCE', "there is no instance '"// &
                                this%text('INSTANCE')//"'", 'the name of an *INSTANCE')
    else
      owner = found
    end if
  end subroutine take_instance

  !> Numbers and coordinates of nodes.
  subroutine rewrite_nodes(this, words, structure, range, owner)
    type(card), intent(inout) :: this
    type(card_rewriter), intent(inout) :: words
    type(model_structure), intent(in) :: structure
    type(number_range), intent(in) :: range !< of the nodes
    integer, intent(in) :: owner
    integer :: line
    if (structure%instances(owner)%place%moves) call this%lines%widen(4)
    do line = 1, this%num_lines
      if (range%offset > 0 .and. this%is_integer_at(line, 1)) then
        call words%put_field(this, line, 1, as_text(this%integer_at(line, 1) + range%offset))
      end if
      if (structure%instances(owner)%place%moves) then
        call move_node(this, line, words, structure, owner)
      end if
    end do
  end subroutine rewrite_nodes

  !> Coordinates of a node, with all digits; a faulty line stays as it is, to be reported.
  subroutine move_node(this, line, words, structure, owner)
    type(card), intent(inout) :: this
    integer, intent(in) :: line, owner
    type(card_rewriter), intent(inout) :: words
    type(model_structure), intent(in) :: structure
    character(24) :: digits
    real(rk) :: x(3)
    integer :: i
    x = 0.0_rk
    do i = 1, 3
      if (this%is_empty_at(line, i + 1)) cycle
      if (.not. this%is_real_at(line, i + 1)) return
      x(i) = this%real_at(line, i + 1)
    end do
    x = placed(structure%instances(owner)%place, x)
    do i = 1, 3
      write (digits, '(es24.16e3)') x(i)
      call words%put_field(this, line, i + 1, trim(adjustl(digits)))
    end do
  end subroutine move_node

  !> Numbers of elements and of their nodes.
  subroutine rewrite_elements(this, words, owner, structure, faults)
    type(card), intent(inout) :: this
    type(card_rewriter), intent(inout) :: words
    integer, intent(in) :: owner
    type(model_structure), intent(in) :: structure
    type(diagnostic_list), intent(inout) :: faults
    logical :: begins(this%num_lines)
    integer :: line, field
    begins = begins_element(this)
    do line = 1, this%num_lines
      do field = 1, this%num_fields(line)
        call rewrite_word(this, line, field, words, scope(owner, begins(line) .and. field == 1), &
                          structure, faults)
      end do
    end do
  end subroutine rewrite_elements

  !> References in the data lines of other keywords: plain words in the columns for references,
  !> INSTANCE.12 in all columns.
  subroutine rewrite_references(this, words, owner, structure, specs, faults)
    type(card), intent(inout) :: this
    type(card_rewriter), intent(inout) :: words
    integer, intent(in) :: owner
    type(model_structure), intent(in) :: structure
    type(keyword), intent(in) :: specs(:)
    type(diagnostic_list), intent(inout) :: faults
    integer :: line, field, spec, last
    spec = find_spec(specs, this%keyword)
    if (spec == 0) return
    do line = 1, this%num_lines
      last = this%num_fields(line)
      if (this%has('GENERATE')) last = min(2, last)
      do field = 1, last
        if (is_reference(specs(spec), field)) then
          call rewrite_word(this, line, field, words, &
                            scope(owner, is_of_elements(this, specs(spec))), &
                            structure, faults)
        else if (.not. this%is_real_at(line, field)) then
          call rewrite_label(this, line, field, words, .false., structure, faults)
        end if
      end do
    end do
  end subroutine rewrite_references

  !> Whether a field of the keyword is a number or the name of a set.
  pure logical function is_reference(spec, field)
    type(keyword), intent(in) :: spec
    integer, intent(in) :: field
    integer :: column
    is_reference = .false.
    column = column_of_field(spec, field)
    if (column > 0) is_reference = spec%columns(column)%kind == kind_reference
  end function is_reference

  !> Whether the references of a card are to elements.
  pure logical function is_of_elements(this, spec)
    type(card), intent(in) :: this
    type(keyword), intent(in) :: spec
    integer :: i
    is_of_elements = this%keyword == 'ELSET'
    do i = 1, size(spec%columns)
      if (spec%columns(i)%kind /= kind_reference) cycle
      is_of_elements = is_of_elements .or. index(spec%columns(i)%name, 'element') == 1
    end do
    is_of_elements = is_of_elements .and. index(this%word('TYPE'), 'NODE') == 0
  end function is_of_elements

  !> Rewrites a number, INSTANCE.12, or the name of a set.
  subroutine rewrite_word(this, line, field, words, plain, structure, faults)
    type(card), intent(inout) :: this
    integer, intent(in) :: line, field
    type(card_rewriter), intent(inout) :: words
    type(scope), intent(in) :: plain
    type(model_structure), intent(in) :: structure
    type(diagnostic_list), intent(inout) :: faults
    integer :: dot
    if (this%is_empty_at(line, field)) return
    if (this%is_integer_at(line, field)) then
      call put_number(this, line, field, words, this%integer_at(line, field), plain, structure, &
                      faults)
    else
      dot = prefix_length(structure, this%text_at(line, field))
      if (dot > 0) then
        call rewrite_label(this, line, field, words, plain%is_element, structure, faults)
      else if (plain%owner > 1 .and. .not. this%has('GENERATE')) then
        call words%put_field(this, line, field, structure%instances(plain%owner)%name//'.'// &
                             this%text_at(line, field))
      end if
    end if
  end subroutine rewrite_word

  !> Rewrites INSTANCE.12; other words stay as they are.
  subroutine rewrite_label(this, line, field, words, is_element, structure, faults)
    type(card), intent(inout) :: this
    integer, intent(in) :: line, field
    type(card_rewriter), intent(inout) :: words
    logical, intent(in) :: is_element
    type(model_structure), intent(in) :: structure
    type(diagnostic_list), intent(inout) :: faults
    character(:), allocatable :: word
    integer :: dot, id
    logical :: is_integer
    word = this%word_at(line, field)
    dot = prefix_length(structure, word)
    if (dot == 0) return
    call parse_integer(word(dot + 1:), id, is_integer)
    if (.not. is_integer) return
    call put_number(this, line, field, words, id, &
                    scope(find_instance(structure, word(:dot - 1)), is_element), structure, faults)
  end subroutine rewrite_label

  !> Puts the number that a node or element has in the flat model.
  subroutine put_number(this, line, field, words, id, plain, structure, faults)
    type(card), intent(inout) :: this
    integer, intent(in) :: line, field, id
    type(card_rewriter), intent(inout) :: words
    type(scope), intent(in) :: plain
    type(model_structure), intent(in) :: structure
    type(diagnostic_list), intent(inout) :: faults
    character(:), allocatable :: kind
    type(number_range) :: range
    kind = 'node'
    range = structure%instances(plain%owner)%nodes
    if (plain%is_element) then
      kind = 'element'
      range = structure%instances(plain%owner)%elements
    end if
    if (id >= range%lowest .and. id <= range%highest) then
      if (range%offset > 0 .or. .not. this%is_integer_at(line, field)) then
        call words%put_field(this, line, field, as_text(id + range%offset))
      end if
    else if (plain%owner == 1) then
      call this%fault_at(faults, line, field, 'there is no '//kind//' '//as_text(id)// &
                         ' outside the instances', 'a set, or INSTANCE.'//as_text(id))
    else
      call this%fault_at(faults, line, field, 'instance '//structure%instances(plain%owner)%name// &
                         ' has no '//kind//' '//as_text(id), text_of_range(kind, range))
      if (.not. this%has('GENERATE') .or. range%highest == 0) return
      ! The faulty range ends within the instance, so that no further fault follows.
      call words%put_field(this, line, field, as_text(range%offset + max(range%lowest, &
                                                                         min(range%highest, id))))
    end if
  end subroutine put_number

  !> 'nodes from 1 to 8'.
  pure function text_of_range(kind, range) result(text)
    character(*), intent(in) :: kind !< 'node' or 'element'
    type(number_range), intent(in) :: range
    character(:), allocatable :: text
    text = 'an instance with '//kind//'s'
    if (range%highest > 0) text = kind//'s from '//as_text(range%lowest)//' to '// &
                                  as_text(range%highest)
  end function text_of_range

  !> Position of the dot behind the name of an instance; 0 where a word has no such name.
  pure integer function prefix_length(structure, word) result(dot)
    type(model_structure), intent(in) :: structure
    character(*), intent(in) :: word
    integer :: k
    dot = 0
    do k = 2, size(structure%instances)
      associate (name => structure%instances(k)%name)
        if (len(word) <= len(name)) cycle
        if (word(len(name) + 1:len(name) + 1) /= '.') cycle
        if (upper_case(word(:len(name))) == name) dot = max(dot, len(name) + 1)
      end associate
    end do
  end function prefix_length

  !> Position of the instance of that name, 0 for none.
  pure integer function find_instance(structure, name) result(found)
    type(model_structure), intent(in) :: structure
    character(*), intent(in) :: name !< upper case
    do found = size(structure%instances), 2, -1
      if (structure%instances(found)%name == name) return
    end do
    found = 0
  end function find_instance
end module instance_words
