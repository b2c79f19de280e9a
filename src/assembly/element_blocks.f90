!> The solid elements of a problem in blocks of one kind and one material.
module element_blocks
  use problem_definition, only: problem
  use element_catalogue, only: element_kinds
  implicit none
  private
  public :: block_list, list_blocks

  integer, parameter :: largest_block = 48 !< elements; see element_matrices

  type :: block_list
    integer :: num_blocks = 0
    integer, allocatable :: first(:) !< (blocks + 1) positions in `element`
    integer, allocatable :: element(:)
  end type block_list

contains

  !> Groups the elements that have a material; in each group they keep the order of the deck.
  subroutine list_blocks(scene, blocks)
    type(problem), intent(in) :: scene
    type(block_list), intent(out) :: blocks
    integer :: kind, material, e, length, num_solids
    num_solids = count(scene%mesh%material_of_element > 0)
    allocate (blocks%element(num_solids), blocks%first(num_solids + 1))
    blocks%first(1) = 1
    length = 0
    do kind = 1, size(element_kinds)
      if (.not. element_kinds(kind)%is_solid) cycle
      if (all(scene%mesh%element_type /= element_kinds(kind)%name)) cycle
      do material = 1, size(scene%materials)
        do e = 1, scene%mesh%num_elements
          if (scene%mesh%material_of_element(e) /= material) cycle
          if (scene%mesh%element_type(e) /= element_kinds(kind)%name) cycle
          length = length + 1
          blocks%element(length) = e
          if (length + 1 - blocks%first(blocks%num_blocks + 1) == largest_block) call close_block()
        end do
        if (length + 1 > blocks%first(blocks%num_blocks + 1)) call close_block()
      end do
    end do
    blocks%first = blocks%first(:blocks%num_blocks + 1)
  contains
    subroutine close_block()
      blocks%num_blocks = blocks%num_blocks + 1
      blocks%first(blocks%num_blocks + 1) = length + 1
    end subroutine close_block
  end subroutine list_blocks
end module element_blocks
