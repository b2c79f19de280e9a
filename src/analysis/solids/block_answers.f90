!> Answers of blocks of inelastic elements, and what ranks exchange of them. Each rank calls the
!> laws of its blocks; the first rank takes all states for the results.
module block_answers
  use kinds, only: rk
  use inelastic_blocks, only: inelastic_block
  use material_points, only: point_state, update_report
  use ranks, only: add_over_ranks, gather_on_first_rank, is_first_rank, largest_of_ranks, &
                   num_ranks, text_of_rank, this_rank
  use shape_hex8, only: hex8_dofs
  implicit none
  private
  public :: block_answer, open_answers, gather_points, share_failure

  integer, parameter :: batch = 512 !< blocks whose states are sent at a time, some 15 MB

  !> Forces, tangents and report of the points of a block.
  type :: block_answer
    !> (24, elements) sum w B^T (D eps - sigma), (24, 0) for a block of another rank [N]
    real(rk), allocatable :: force(:, :)
    real(rk), allocatable :: tangent(:, :, :) !< (6, 6, points) [Pa], or (6, 6, 0)
    !> (elements) with a point that is not elastic; false for a block of another rank
    logical, allocatable :: has_excess(:)
    !> (elements) Whether an update moves them; the others keep their last strain and stress
    logical, allocatable :: takes_part(:)
    real(rk), allocatable :: lost(:, :) !< (24, elements) lost damping force [N], if any
    real(rk), allocatable :: correction(:, :) !< (24, elements) of the work [N], if any
    type(update_report) :: report
  end type block_answer

contains

  !> Allocates the answers of all blocks.
  subroutine open_answers(blocks, answers)
    type(inelastic_block), intent(in) :: blocks(:)
    type(block_answer), allocatable, intent(out) :: answers(:)
    integer :: i, n
    allocate (answers(size(blocks)))
    do i = 1, size(blocks)
      n = size(blocks(i)%elements)
      allocate (answers(i)%force(hex8_dofs, merge(n, 0, blocks(i)%is_here())), &
                answers(i)%tangent(6, 6, 0))
      allocate (answers(i)%has_excess(n), source=.false.)
      allocate (answers(i)%takes_part(n), source=.true.)
    end do
  end subroutine open_answers

  !> The failure of the first block that has one, of any rank, and the smallest size.
  subroutine share_failure(num_blocks, block, size_ratio, why)
    integer, intent(in) :: num_blocks
    integer, intent(in) :: block !< of this rank, `num_blocks` + 1 for none
    real(rk), intent(inout) :: size_ratio !< requested over present size
    character(:), allocatable, intent(inout) :: why !< unallocated without a failure
    real(rk) :: ratio(0:num_ranks() - 1)
    character(:), allocatable :: own
    integer :: first, from
    if (num_ranks() == 1) return
    ratio = 0.0_rk
    ratio(this_rank()) = size_ratio
    call add_over_ranks(ratio)
    size_ratio = minval(ratio)
    first = -largest_of_ranks(-block)
    if (first > num_blocks) return
    from = largest_of_ranks(merge(this_rank(), -1, block == first))
    own = ''
    if (allocated(why)) own = why
    why = text_of_rank(from, own)
  end subroutine share_failure

  !> Gives the states of all blocks to the first rank.
  subroutine gather_points(blocks, states)
    type(inelastic_block), intent(in) :: blocks(:)
    type(point_state), intent(inout) :: states(:) !< (blocks)
    integer :: first, last
    if (num_ranks() == 1) return
    do first = 1, size(blocks), batch
      last = min(first + batch - 1, size(blocks))
      call gather_batch(blocks(first:last), states(first:last))
    end do
  end subroutine gather_points

  !> Gives the states of some blocks to the first rank, which has its own ones. A rank has no
  !> numbers of blocks that are elsewhere.
  subroutine gather_batch(blocks, states)
    type(inelastic_block), intent(in) :: blocks(:)
    type(point_state), intent(inout) :: states(:) !< (blocks)
    real(rk), allocatable :: sent(:), received(:)
    integer :: first(num_ranks() + 1), next(0:num_ranks() - 1), i, last
    next = 0
    do i = 1, size(blocks)
      associate (rank => blocks(i)%rank)
        if (rank > 0) next(rank) = next(rank) + num_values(states(i))
      end associate
    end do
    first(1) = 0
    do i = 1, num_ranks()
      first(i + 1) = first(i) + next(i - 1)
    end do
    next = first(:num_ranks())
    if (.not. is_first_rank()) then
      allocate (sent(first(num_ranks() + 1)), received(0))
      call pack_blocks(states, sent)
    else
      allocate (sent(0), received(first(num_ranks() + 1)))
    end if
    call gather_on_first_rank(sent, first, received)
    if (.not. is_first_rank()) return
    do i = 1, size(blocks)
      associate (rank => blocks(i)%rank)
        if (rank == 0) cycle
        last = next(rank) + num_values(states(i))
        call unpack_block(received(next(rank) + 1:last), states(i))
        next(rank) = last
      end associate
    end do
  end subroutine gather_batch

  !> Writes the numbers of the blocks that this rank has, one after the other.
  subroutine pack_blocks(states, values)
    type(point_state), intent(in) :: states(:) !< (blocks)
    real(rk), intent(out) :: values(:)
    integer :: i, last, n
    last = 0
    do i = 1, size(states)
      n = num_values(states(i))
      if (n > 0) call pack_block(states(i), values(last + 1:last + n))
      last = last + n
    end do
  end subroutine pack_blocks

  !> Numbers of a block that are exchanged. The first rank finds temperatures and thermal strains
  !> for itself.
  pure integer function num_values(own)
    type(point_state), intent(in) :: own
    num_values = size(own%strain) + size(own%stress) + size(own%internal) + size(own%energy) &
                 + size(own%gradient) + size(own%is_elastic)
  end function num_values

  !> Writes the numbers of a block.
  pure subroutine pack_block(own, values)
    type(point_state), intent(in) :: own
    real(rk), intent(out) :: values(:)
    values = [reshape(own%strain, [size(own%strain)]), &
              reshape(own%stress, [size(own%stress)]), &
              reshape(own%internal, [size(own%internal)]), &
              reshape(own%energy, [size(own%energy)]), &
              reshape(own%gradient, [size(own%gradient)]), &
              merge(1.0_rk, 0.0_rk, own%is_elastic)]
  end subroutine pack_block

  !> Reads the numbers of a block.
  pure subroutine unpack_block(values, own)
    real(rk), intent(in) :: values(:)
    type(point_state), intent(inout) :: own
    integer :: last
    last = 0
    own%strain = reshape(values(last + 1:last + size(own%strain)), shape(own%strain))
    last = last + size(own%strain)
    own%stress = reshape(values(last + 1:last + size(own%stress)), shape(own%stress))
    last = last + size(own%stress)
    own%internal = reshape(values(last + 1:last + size(own%internal)), shape(own%internal))
    last = last + size(own%internal)
    own%energy = reshape(values(last + 1:last + size(own%energy)), shape(own%energy))
    last = last + size(own%energy)
    own%gradient = reshape(values(last + 1:last + size(own%gradient)), shape(own%gradient))
    last = last + size(own%gradient)
    own%is_elastic = values(last + 1:last + size(own%is_elastic)) > 0.5_rk
  end subroutine unpack_block
end module block_answers
