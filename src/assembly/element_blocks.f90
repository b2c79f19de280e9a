!> The solid elements of a problem in blocks of one kind, one material and one colour.
!>
!> Elements of one colour share no unknown. Threads may then add their matrices at the same time,
!> and the order of every sum does not depend on the number of threads.
module element_blocks
  use kinds, only: long
  use dam_mesh, only: is_assembled_here
  use problem_definition, only: problem
  use ranks, only: this_rank
  use element_catalogue, only: element_kinds, find_element_kind
  use dof_numbering, only: numbering
  use row_tables, only: group_by_key, row_table
  implicit none
  private
  public :: block_list, list_blocks

  integer, parameter :: largest_block = 48 !< elements; see element_matrices
  integer, parameter :: most_colours = 62 !< one bit a colour; elements left over share the last one

  type :: block_list
    integer :: num_blocks = 0
    integer, allocatable :: first(:) !< (blocks + 1) positions in `element`
    integer, allocatable :: element(:)
    integer :: num_colours = 0
    integer, allocatable :: first_block(:) !< (colours + 1) first block of each colour
    logical :: last_is_serial = .false. !< elements of the last colour share unknowns
  end type block_list

contains

  !> Sorts the elements that have a material by colour, kind and material.
  subroutine list_blocks(model, numbers, blocks)
    type(problem), intent(in) :: model
    type(numbering), intent(in) :: numbers
    type(block_list), intent(out) :: blocks
    integer, allocatable :: colour(:), key(:)
    type(row_table) :: by_key
    integer :: e, num_keys
    call colour_elements(model, numbers, colour)
    blocks%num_colours = maxval([0, colour])
    blocks%last_is_serial = blocks%num_colours > most_colours
    num_keys = size(element_kinds)*size(model%materials)
    allocate (key(model%mesh%num_elements))
    key = 0
    do e = 1, model%mesh%num_elements
      if (colour(e) == 0) cycle
      key(e) = (colour(e) - 1)*num_keys &
               + (find_element_kind(model%mesh%element_type(e)) - 1)*size(model%materials) &
               + model%mesh%material_of_element(e)
    end do
    call group_by_key(key, blocks%num_colours*num_keys, by_key)
    call move_alloc(by_key%item, blocks%element)
    call cut_blocks(colour, key, blocks)
  end subroutine list_blocks

  !> The lowest colour that is free at all unknowns of an element; 0 for elements without material
  !> and for those of other ranks.
  subroutine colour_elements(model, numbers, colour)
    type(problem), intent(in) :: model
    type(numbering), intent(in) :: numbers
    integer, allocatable, intent(out) :: colour(:) !< (elements)
    integer(long), allocatable :: used(:)
    integer(long) :: taken
    integer :: e, rank
    rank = this_rank()
    allocate (colour(model%mesh%num_elements), used(numbers%num_total))
    colour = 0
    used = 0_long
    do e = 1, model%mesh%num_elements
      if (.not. is_assembled_here(model%mesh, rank, e)) cycle
      taken = colours_around(numbers, used, model%mesh%nodes(:, e))
      colour(e) = trailz(not(taken)) + 1
      if (colour(e) > most_colours) then
        colour(e) = most_colours + 1
      else
        call mark_around(numbers, model%mesh%nodes(:, e), colour(e) - 1, used)
      end if
    end do
  end subroutine colour_elements

  !> The colours at the unknowns of some nodes, as bits.
  pure integer(long) function colours_around(numbers, used, nodes) result(taken)
    type(numbering), intent(in) :: numbers
    integer(long), intent(in) :: used(:)
    integer, intent(in) :: nodes(:)
    integer :: a, k
    taken = 0_long
    do a = 1, size(nodes)
      do k = numbers%node_start(nodes(a)), numbers%node_start(nodes(a) + 1) - 1
        taken = ior(taken, used(numbers%unknown(k)))
      end do
    end do
  end function colours_around

  !> Gives a colour to the unknowns of some nodes.
  pure subroutine mark_around(numbers, nodes, bit, used)
    type(numbering), intent(in) :: numbers
    integer, intent(in) :: nodes(:), bit
    integer(long), intent(inout) :: used(:)
    integer :: a, k
    do a = 1, size(nodes)
      do k = numbers%node_start(nodes(a)), numbers%node_start(nodes(a) + 1) - 1
        used(numbers%unknown(k)) = ibset(used(numbers%unknown(k)), bit)
      end do
    end do
  end subroutine mark_around

  !> Starts a block where the key changes and where the last block is full.
  pure subroutine cut_blocks(colour, key, blocks)
    integer, intent(in) :: colour(:), key(:)
    type(block_list), intent(inout) :: blocks
    integer :: k, length
    allocate (blocks%first(size(blocks%element) + 1), blocks%first_block(blocks%num_colours + 1))
    blocks%first_block = 1
    length = 0
    do k = 1, size(blocks%element)
      length = length + 1
      if (k > 1) then
        if (key(blocks%element(k)) == key(blocks%element(k - 1)) &
            .and. length <= largest_block) cycle
      end if
      length = 1
      blocks%num_blocks = blocks%num_blocks + 1
      blocks%first(blocks%num_blocks) = k
      blocks%first_block(colour(blocks%element(k)) + 1) = blocks%num_blocks + 1
    end do
    blocks%first(blocks%num_blocks + 1) = size(blocks%element) + 1
  end subroutine cut_blocks
end module element_blocks
