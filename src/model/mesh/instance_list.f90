!> Instances of parts that the deck has: what of the numbers of its nodes and elements is theirs.
module instance_list
  use parse_text, only: parse_integer, upper_case
  use write_text, only: as_text
  implicit none
  private
  public :: mesh_instance, find_flat_node, own_name_of_node

  !> A part in its place; with the name '', what stands outside the instances.
  type :: mesh_instance
    character(:), allocatable :: name, part !< upper case
    integer :: first_node = 1, last_node = huge(1) !< range of the numbers of nodes in the part
    logical :: has_members = .false. !< nodes or elements
    integer :: nodes_added = 0 !< to the numbers of nodes in the part
    integer :: elements_added = 0 !< to the numbers of elements in the part
  end type mesh_instance

contains

  !> The node of a word: 12 is outside the instances, INSTANCE.12 of one of them.
  pure subroutine find_flat_node(outside, instances, word, id, is_node)
    type(mesh_instance), intent(in) :: outside, instances(:)
    character(*), intent(in) :: word
    integer, intent(out) :: id !< in the flat model; 0: not in the range of the instance
    logical, intent(out) :: is_node !< else the word may be the name of a set
    type(mesh_instance) :: owner
    integer :: dot, k
    owner = outside
    dot = 0
    do k = 1, size(instances)
      associate (prefix => instances(k)%name//'.')
        if (len(word) <= len(prefix) .or. len(prefix) <= dot) cycle
        if (upper_case(word(:len(prefix))) /= prefix) cycle
        owner = instances(k)
        dot = len(prefix)
      end associate
    end do
    call parse_integer(word(dot + 1:), id, is_node)
    if (id < owner%first_node .or. id > owner%last_node) then
      id = 0
    else
      id = id + owner%nodes_added
    end if
  end subroutine find_flat_node

  !> What a node is called in the deck: ' (node 12 of P-1)', ' (node 2 of the assembly)'; '' in a
  !> deck without instances.
  pure function own_name_of_node(outside, instances, id) result(text)
    type(mesh_instance), intent(in) :: outside
    type(mesh_instance), allocatable, intent(in) :: instances(:)
    integer, intent(in) :: id !< in the flat model
    character(:), allocatable :: text
    integer :: k
    text = ''
    if (.not. allocated(instances)) return
    if (size(instances) == 0) return
    if (has_node(outside, id)) then
      text = ' (node '//as_text(id - outside%nodes_added)//' of the assembly)'
    end if
    do k = 1, size(instances)
      if (.not. has_node(instances(k), id)) cycle
      text = ' (node '//as_text(id - instances(k)%nodes_added)//' of '//instances(k)%name//')'
    end do
  end function own_name_of_node

  !> Whether a number of the flat model is in the range of an instance.
  pure logical function has_node(one, id)
    type(mesh_instance), intent(in) :: one
    integer, intent(in) :: id
    has_node = id - one%nodes_added >= one%first_node .and. id - one%nodes_added <= one%last_node
  end function has_node
end module instance_list
