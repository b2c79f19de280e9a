!> References of a card by id or name: nodes, elements, surfaces, amplitudes. A fault is reported
!> at the place of the reference.
module named_things
  use card_check, only: found_no_integer, is_too_large, longest_name
  use deck_card, only: card
  use diagnostics, only: diagnostic_list, is_shown
  use id_map, only: position_table
  use model_draft, only: draft
  use nearest_words, only: nearest_word
  use set_lists, only: set_list
  use sorted_lists, only: sorted_unique
  use write_text, only: as_text
  implicit none
  private
  public :: nodes_at, nodes_in_order_at, elements_at, elements_of_set, nodes_of_set
  public :: find_surface, find_surface_name, find_surface_at, find_amplitude, find_material
  public :: joint_names, nearest_set, set_names, surface_names, longest_name, with_article

contains

  !> Positions of the node or of the nodes of the set named in a field; empty after a fault.
  subroutine nodes_at(this, line, field, model, faults, members)
    type(card), intent(in) :: this
    integer, intent(in) :: line, field
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer, allocatable, intent(out) :: members(:)
    call members_at(this, line, field, 'node', model%node_position, model%node_sets, faults, &
                    members)
  end subroutine nodes_at

  !> Nodes of a field as *EQUATION and *MPC pair them: those of a set with UNSORTED in the order of
  !> the deck, those of other sets by ascending ids.
  subroutine nodes_in_order_at(this, line, field, model, faults, members)
    type(card), intent(in) :: this
    integer, intent(in) :: line, field
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer, allocatable, intent(out) :: members(:)
    integer :: found
    call nodes_at(this, line, field, model, faults, members)
    found = 0
    if (.not. this%is_integer_at(line, field)) then
      found = model%node_sets%find(this%word_at(line, field))
    end if
    if (found > 0) then
      if (allocated(model%node_sets%sets(found)%in_order)) then
        members = model%node_sets%sets(found)%in_order
        return
      end if
    end if
    call sort_by_id(model, members)
  end subroutine nodes_in_order_at

  !> Sorts the nodes of a set by their ids.
  subroutine sort_by_id(model, nodes)
    type(draft), intent(in) :: model
    integer, intent(inout) :: nodes(:)
    integer, allocatable :: ids(:)
    integer :: k
    ids = sorted_unique(model%problem%mesh%node_id(nodes))
    nodes = [(model%node_position%find(ids(k)), k=1, size(ids))]
  end subroutine sort_by_id

  !> Positions of the element or of the elements of the set named in a field; empty after a fault.
  subroutine elements_at(this, line, field, model, faults, members)
    type(card), intent(in) :: this
    integer, intent(in) :: line, field
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer, allocatable, intent(out) :: members(:)
    call members_at(this, line, field, 'element', model%element_position, model%element_sets, &
                    faults, members)
  end subroutine elements_at

  !> Positions of the node or element, or of the members of the set, named in a field.
  subroutine members_at(this, line, field, kind, position, sets, faults, members)
    type(card), intent(in) :: this
    integer, intent(in) :: line, field
    character(*), intent(in) :: kind !< 'node' or 'element'
    type(position_table), intent(in) :: position !< by the user's ids
    type(set_list), intent(in) :: sets
    type(diagnostic_list), intent(inout) :: faults
    integer, allocatable, intent(out) :: members(:)
    integer :: found
    if (this%is_integer_at(line, field)) then
      found = position%find(this%integer_at(line, field))
      if (found == 0) then
        call fault_unknown_id(this, line, field, kind, sets, faults)
      else if (this%keyword /= 'NSET' .and. this%keyword /= 'ELSET') then
        call warn_of_set(this, line, field, kind, position, sets, faults)
      end if
    else
      found = sets%find(this%word_at(line, field))
      if (found > 0) then
        members = sets%sets(found)%members
        return
      end if
      call fault_unknown_set(this, line, field, kind, sets, faults)
    end if
    members = pack([found], [found > 0])
  end subroutine members_at

  !> Reports an id that does not exist. A set may have this name, while a number is always an id.
  subroutine fault_unknown_id(this, line, field, kind, sets, faults)
    type(card), intent(in) :: this
    integer, intent(in) :: line, field
    character(*), intent(in) :: kind !< 'node' or 'element'
    type(set_list), intent(in) :: sets
    type(diagnostic_list), intent(inout) :: faults
    character(:), allocatable :: wanted
    wanted = with_article(kind)//' of the model'
    if (sets%find(this%word_at(line, field)) > 0) then
      wanted = wanted//", or for the set '"//this%text_at(line, field)//"' a name with a letter"
    end if
    call this%fault_at(faults, line, field, kind//' '//this%text_at(line, field)// &
                       ' does not exist', wanted)
  end subroutine fault_unknown_id

  !> Warns of a number that is the name of a set too: once for the card, with the lines that follow.
  subroutine warn_of_set(this, line, field, kind, position, sets, faults)
    type(card), intent(in) :: this
    integer, intent(in) :: line, field
    character(*), intent(in) :: kind !< 'node' or 'element'
    type(position_table), intent(in) :: position !< by the user's ids
    type(set_list), intent(in) :: sets
    type(diagnostic_list), intent(inout) :: faults
    character(:), allocatable :: problem
    integer :: i, others
    if (.not. is_ambiguous(line)) return
    do i = line - 1, 1, -1 ! the nearest first: all looks back together pass each line once
      if (is_ambiguous(i)) return
    end do
    others = count([(is_ambiguous(i), i=line + 1, this%num_lines)])
    problem = "'"//this%text_at(line, field)//"' is "//kind//' '//this%text_at(line, field)// &
              ' here, not the '//kind//' set of this name'
    if (others == 1) problem = problem//'; also 1 more line of the card'
    if (others > 1) problem = problem//'; also '//as_text(others)//' more lines of the card'
    call this%warn_at(faults, line, field, problem, 'a name with a letter for the set')
  contains
    !> Whether the number in a line names a set with something else than its one member.
    logical function is_ambiguous(i)
      integer, intent(in) :: i !< line
      integer :: found
      is_ambiguous = .false.
      if (field > this%num_fields(i)) return
      ! *EQUATION: a number of terms is no node.
      if (this%num_fields(i) == 1 .and. this%num_fields(line) > 1) return
      if (.not. this%is_integer_at(i, field)) return
      found = position%find(this%integer_at(i, field))
      if (found > 0) is_ambiguous = is_another_set(sets, this%word_at(i, field), found)
    end function is_ambiguous
  end subroutine warn_of_set

  !> 'a node', 'an element'.
  pure function with_article(kind) result(text)
    character(*), intent(in) :: kind !< 'node' or 'element'
    character(:), allocatable :: text
    text = 'a '//kind
    if (kind == 'element') text = 'an '//kind
  end function with_article

  !> Whether a set of this name holds something else than one member.
  pure logical function is_another_set(sets, name, member)
    type(set_list), intent(in) :: sets
    character(*), intent(in) :: name !< upper case
    integer, intent(in) :: member !< position
    integer :: found
    found = sets%find(name)
    is_another_set = found > 0
    if (is_another_set) is_another_set = size(sets%sets(found)%members) /= 1 &
                                         .or. any(sets%sets(found)%members /= member)
  end function is_another_set

  !> Reports a set that is not defined above.
  subroutine fault_unknown_set(this, line, field, kind, sets, faults)
    type(card), intent(in) :: this
    integer, intent(in) :: line, field
    character(*), intent(in) :: kind !< 'node' or 'element'
    type(set_list), intent(in) :: sets
    type(diagnostic_list), intent(inout) :: faults
    character(:), allocatable :: problem
    if (is_too_large(this%text_at(line, field))) then
      call this%fault_at(faults, line, field, found_no_integer(this%text_at(line, field)), &
                         'the id of one '//kind)
      return
    end if
    problem = 'there is no '//kind//" set '"//this%text_at(line, field)//"' above this line"
    call this%fault_at(faults, line, field, problem, &
                       'the id of one '//kind//' or the name of a set defined above', &
                       nearest_set(this%word_at(line, field), sets, problem, faults))
  end subroutine fault_unknown_set

  !> Elements of the set that a parameter names; empty after a fault.
  subroutine elements_of_set(this, parameter, model, faults, members)
    type(card), intent(in) :: this
    character(*), intent(in) :: parameter !< 'ELSET'
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer, allocatable, intent(out) :: members(:)
    call members_of_set(this, parameter, 'element', model%element_sets, faults, members)
  end subroutine elements_of_set

  !> Nodes of the set that a parameter names; empty after a fault.
  subroutine nodes_of_set(this, parameter, model, faults, members)
    type(card), intent(in) :: this
    character(*), intent(in) :: parameter !< 'NSET'
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer, allocatable, intent(out) :: members(:)
    call members_of_set(this, parameter, 'node', model%node_sets, faults, members)
  end subroutine nodes_of_set

  subroutine members_of_set(this, parameter, kind, sets, faults, members)
    type(card), intent(in) :: this
    character(*), intent(in) :: parameter, kind
    type(set_list), intent(in) :: sets
    type(diagnostic_list), intent(inout) :: faults
    integer, allocatable, intent(out) :: members(:)
    character(:), allocatable :: problem
    integer :: found
    found = sets%find(this%word(parameter))
    if (found > 0) then
      members = sets%sets(found)%members
      return
    end if
    allocate (members(0))
    problem = 'there is no '//kind//" set '"//this%text(parameter)//"' above this line"
    call this%fault_parameter(faults, parameter, problem, 'the name of a set defined above', &
                              nearest_set(this%word(parameter), sets, problem, faults))
  end subroutine members_of_set

  !> The set with a name of nearly this spelling, for an error that is shown; '' for another.
  function nearest_set(word, sets, problem, faults) result(nearest)
    character(*), intent(in) :: word !< upper case
    type(set_list), intent(in) :: sets
    character(*), intent(in) :: problem !< of the error
    type(diagnostic_list), intent(in) :: faults
    character(:), allocatable :: nearest
    nearest = ''
    if (is_shown(faults, problem)) nearest = nearest_word(word, set_names(sets))
  end function nearest_set

  !> Position of the surface of that name, 0 when there is none so far.
  pure integer function find_surface_name(model, name) result(found)
    type(draft), intent(in) :: model
    character(*), intent(in) :: name !< upper case
    found = model%surface_of_name%find(name)
  end function find_surface_name

  !> Position of the surface named in a field, by default the first; 0 after a fault.
  subroutine find_surface_at(this, line, model, faults, found, field)
    type(card), intent(in) :: this
    integer, intent(in) :: line
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer, intent(out) :: found
    integer, intent(in), optional :: field
    character(:), allocatable :: problem
    integer :: at
    at = 1
    if (present(field)) at = field
    found = find_surface_name(model, this%word_at(line, at))
    if (found > 0) return
    problem = "there is no surface '"//this%text_at(line, at)//"' above this line"
    call this%fault_at(faults, line, at, problem, 'a surface defined above', &
                       nearest_surface(this%word_at(line, at), model, problem, faults))
  end subroutine find_surface_at

  !> Position of the surface that SURFACE names; 0 after a fault.
  subroutine find_surface(this, model, faults, found)
    type(card), intent(in) :: this
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer, intent(out) :: found
    character(:), allocatable :: problem
    found = find_surface_name(model, this%word('SURFACE'))
    if (found > 0) return
    problem = "there is no surface '"//this%text('SURFACE')//"' above this line"
    call this%fault_parameter(faults, 'SURFACE', problem, 'a surface defined above', &
                              nearest_surface(this%word('SURFACE'), model, problem, faults))
  end subroutine find_surface

  !> The surface with a name of nearly this spelling, for an error that is shown; '' for another.
  function nearest_surface(word, model, problem, faults) result(nearest)
    character(*), intent(in) :: word !< upper case
    type(draft), intent(in) :: model
    character(*), intent(in) :: problem !< of the error
    type(diagnostic_list), intent(in) :: faults
    character(:), allocatable :: nearest
    nearest = ''
    if (is_shown(faults, problem)) nearest = nearest_word(word, surface_names(model))
  end function nearest_surface

  !> Names of surfaces.
  pure function surface_names(model) result(names)
    type(draft), intent(in) :: model
    character(longest_name) :: names(model%num_surfaces)
    integer :: i
    do i = 1, size(names)
      names(i) = model%problem%surfaces(i)%name
    end do
  end function surface_names

  !> Position of the amplitude that AMPLITUDE names; 0 without the parameter or after a fault.
  subroutine find_amplitude(this, model, faults, found)
    type(card), intent(in) :: this
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer, intent(out) :: found
    character(:), allocatable :: problem, nearest
    found = 0
    if (.not. this%has('AMPLITUDE')) return
    found = model%amplitude_of_name%find(this%word('AMPLITUDE'))
    if (found > 0) return
    problem = "there is no amplitude '"//this%text('AMPLITUDE')//"'"
    nearest = ''
    if (is_shown(faults, problem)) then
      nearest = nearest_word(this%word('AMPLITUDE'), amplitude_names(model))
    end if
    call this%fault_parameter(faults, 'AMPLITUDE', problem, 'the name of an *AMPLITUDE', nearest)
  end subroutine find_amplitude

  !> Names of amplitudes.
  pure function amplitude_names(model) result(names)
    type(draft), intent(in) :: model
    character(longest_name) :: names(model%num_amplitudes)
    integer :: i
    do i = 1, size(names)
      names(i) = model%problem%amplitudes(i)%name
    end do
  end function amplitude_names

  !> Position of the material that MATERIAL names; 0 after a fault.
  subroutine find_material(this, model, faults, found)
    type(card), intent(in) :: this
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer, intent(out) :: found
    character(:), allocatable :: problem, nearest
    found = model%material_of_name%find(this%word('MATERIAL'))
    if (found > 0) return
    problem = "there is no material '"//this%text('MATERIAL')//"'"
    nearest = ''
    if (is_shown(faults, problem)) then
      nearest = nearest_word(this%word('MATERIAL'), material_names(model))
    end if
    call this%fault_parameter(faults, 'MATERIAL', problem, 'the name of a *MATERIAL', nearest)
  end subroutine find_material

  !> Names of materials.
  pure function material_names(model) result(names)
    type(draft), intent(in) :: model
    character(longest_name) :: names(model%num_materials)
    integer :: i
    do i = 1, size(names)
      names(i) = model%problem%materials(i)%name
    end do
  end function material_names

  !> Names of joints.
  pure function joint_names(model) result(names)
    type(draft), intent(in) :: model
    character(longest_name) :: names(size(model%joints))
    integer :: i
    do i = 1, size(names)
      names(i) = model%joints(i)%name
    end do
  end function joint_names

  !> Names of sets.
  pure function set_names(sets) result(names)
    type(set_list), intent(in) :: sets
    character(longest_name) :: names(sets%num_sets)
    integer :: i
    do i = 1, sets%num_sets
      names(i) = sets%sets(i)%name
    end do
  end function set_names
end module named_things
