!> Answers of blocks of inelastic elements, and their exchange: each rank calls the laws of its
!> blocks, and all ranks have the states of all points.
module block_answers
  use kinds, only: rk
  use inelastic_blocks, only: inelastic_block
  use material_points, only: point_state, update_report
  use ranks, only: add_over_ranks, num_ranks, this_rank
  use shape_hex8, only: hex8_dofs
  implicit none
  private
  public :: block_answer, open_answers, share_points

  !> Forces, tangents and report of the points of a block.
  type :: block_answer
    real(rk), allocatable :: force(:, :) !< (24, elements) sum w B^T (D eps - sigma) [N]
    real(rk), allocatable :: tangent(:, :, :) !< (6, 6, points) [Pa], or (6, 6, 0)
    logical, allocatable :: has_excess(:) !< (elements) with a point that is not elastic
    !> (elements) Whether an update moves them; the others keep their last strain and stress
    logical, allocatable :: takes_part(:)
    real(rk), allocatable :: lost(:, :) !< (24, elements) lost damping force [N], if any
    real(rk), allocatable :: correction(:, :) !< (24, elements) of the work [N], if any
    type(update_report) :: report
    logical :: is_here = .true. !< this rank calls the law of the block
  end type block_answer

contains

  !> Allocates the answers of all blocks. Ranks take blocks in turn.
  subroutine open_answers(blocks, answers)
    type(inelastic_block), intent(in) :: blocks(:)
    type(block_answer), allocatable, intent(out) :: answers(:)
    integer :: i
    allocate (answers(size(blocks)))
    do i = 1, size(blocks)
      allocate (answers(i)%force(hex8_dofs, size(blocks(i)%elements)), &
                answers(i)%has_excess(size(blocks(i)%elements)), answers(i)%tangent(6, 6, 0))
      allocate (answers(i)%takes_part(size(blocks(i)%elements)), source=.true.)
      answers(i)%is_here = mod(i - 1, num_ranks()) == this_rank()
    end do
  end subroutine open_answers

  !> Gives what the laws have found to all ranks.
  subroutine share_points(is_updated, new, answers)
    logical, intent(in) :: is_updated(:) !< (blocks) the same on all ranks
    type(point_state), intent(inout) :: new(:) !< (blocks)
    type(block_answer), intent(inout) :: answers(:) !< (blocks)
    real(rk), allocatable :: values(:)
    integer :: first(size(new) + 1), i
    if (num_ranks() == 1) return
    first(1) = 1
    do i = 1, size(new)
      first(i + 1) = first(i)
      if (is_updated(i)) first(i + 1) = first(i) + num_values(new(i), answers(i))
    end do
    allocate (values(first(size(new) + 1) - 1), source=0.0_rk)
    do i = 1, size(new)
      if (.not. (is_updated(i) .and. answers(i)%is_here)) cycle
      call pack_block(new(i), answers(i), values(first(i):first(i + 1) - 1))
    end do
    call add_over_ranks(values)
    do i = 1, size(new)
      if (.not. is_updated(i) .or. answers(i)%is_here) cycle
      call unpack_block(values(first(i):first(i + 1) - 1), new(i), answers(i))
    end do
  end subroutine share_points

  !> Numbers of a block that are exchanged.
  pure integer function num_values(new, answer)
    type(point_state), intent(in) :: new
    type(block_answer), intent(in) :: answer
    num_values = size(new%stress) + size(new%internal) + size(new%energy) &
                 + size(new%is_elastic) + size(answer%tangent) + 2
  end function num_values

  !> Writes the numbers of a block.
  pure subroutine pack_block(new, answer, values)
    type(point_state), intent(in) :: new
    type(block_answer), intent(in) :: answer
    real(rk), intent(out) :: values(:)
    values = [reshape(new%stress, [size(new%stress)]), &
              reshape(new%internal, [size(new%internal)]), &
              reshape(new%energy, [size(new%energy)]), &
              merge(1.0_rk, 0.0_rk, new%is_elastic), &
              reshape(answer%tangent, [size(answer%tangent)]), &
              answer%report%size_ratio, real(answer%report%failed_point, rk)]
  end subroutine pack_block

  !> Reads the numbers of a block.
  pure subroutine unpack_block(values, new, answer)
    real(rk), intent(in) :: values(:)
    type(point_state), intent(inout) :: new
    type(block_answer), intent(inout) :: answer
    integer :: last
    last = 0
    new%stress = reshape(values(last + 1:last + size(new%stress)), shape(new%stress))
    last = last + size(new%stress)
    new%internal = reshape(values(last + 1:last + size(new%internal)), shape(new%internal))
    last = last + size(new%internal)
    new%energy = reshape(values(last + 1:last + size(new%energy)), shape(new%energy))
    last = last + size(new%energy)
    new%is_elastic = values(last + 1:last + size(new%is_elastic)) > 0.5_rk
    last = last + size(new%is_elastic)
    answer%tangent = reshape(values(last + 1:last + size(answer%tangent)), shape(answer%tangent))
    last = last + size(answer%tangent)
    answer%report%size_ratio = values(last + 1)
    answer%report%failed_point = nint(values(last + 2))
  end subroutine unpack_block
end module block_answers
