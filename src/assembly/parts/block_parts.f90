!> Divides the blocks of inelastic elements among the ranks. A rank has the points of its blocks and
!> calls their laws; the first rank has all points, for the results.
!>
!> The loss of stiffness of a block is found where its points are. Where another rank has the
!> stiffness of its elements, both have a part of the same rows.
module block_parts
  use dam_mesh, only: fe_mesh
  use inelastic_blocks, only: inelastic_block
  use ranks, only: is_first_rank, num_ranks
  implicit none
  private
  public :: divide_blocks, choose_ranks, elements_here

contains

  !> Gives each block to a rank that has most of its elements, and about as many blocks to each
  !> rank. All ranks find the same division.
  subroutine divide_blocks(mesh, blocks)
    type(fe_mesh), intent(in) :: mesh !< with a rank for each element
    type(inelastic_block), allocatable, intent(inout) :: blocks(:)
    integer :: i
    if (num_ranks() == 1 .or. .not. allocated(blocks)) return
    call choose_ranks(mesh%rank_of_element, num_ranks(), blocks)
    if (is_first_rank()) return
    do i = 1, size(blocks)
      if (.not. blocks(i)%is_here()) call blocks(i)%forget_points()
    end do
  end subroutine divide_blocks

  !> A block whose rank has its share already goes to the rank with the fewest blocks.
  pure subroutine choose_ranks(rank_of_element, num_parts, blocks)
    integer, intent(in) :: rank_of_element(:) !< (elements) from 0
    integer, intent(in) :: num_parts !< ranks
    type(inelastic_block), intent(inout) :: blocks(:)
    integer :: num_blocks(0:num_parts - 1), num_elements(0:num_parts - 1), share, i, k
    logical :: is_placed(size(blocks))
    share = (size(blocks) + num_parts - 1)/num_parts
    num_blocks = 0
    is_placed = .false.
    do i = 1, size(blocks)
      num_elements = 0
      do k = 1, size(blocks(i)%elements)
        associate (count => num_elements(rank_of_element(blocks(i)%elements(k))))
          count = count + 1
        end associate
      end do
      blocks(i)%rank = maxloc(num_elements, 1) - 1
      is_placed(i) = num_blocks(blocks(i)%rank) < share
      if (is_placed(i)) num_blocks(blocks(i)%rank) = num_blocks(blocks(i)%rank) + 1
    end do
    do i = 1, size(blocks)
      if (is_placed(i)) cycle
      blocks(i)%rank = minloc(num_blocks, 1) - 1
      num_blocks(blocks(i)%rank) = num_blocks(blocks(i)%rank) + 1
    end do
  end subroutine choose_ranks

  !> The elements of the blocks of this rank.
  function elements_here(blocks) result(elements)
    type(inelastic_block), allocatable, intent(in) :: blocks(:)
    integer, allocatable :: elements(:)
    integer :: i, last, n
    last = 0
    if (allocated(blocks)) then
      allocate (elements(sum([(size(blocks(i)%elements), i=1, size(blocks))])))
      do i = 1, size(blocks)
        if (.not. blocks(i)%is_here()) cycle
        n = size(blocks(i)%elements)
        elements(last + 1:last + n) = blocks(i)%elements
        last = last + n
      end do
      elements = elements(:last)
    else
      allocate (elements(0))
    end if
  end function elements_here
end module block_parts
