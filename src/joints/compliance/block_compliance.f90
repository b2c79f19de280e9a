!> The compliance G = B K_0^-1 B^T of the structure at the points of its joints, in blocks between
!> groups of points (theory.md, 8). Blocks that are too small to matter are left out.
!>
!> Vectors have the rows of all points, in the order of the points. On several ranks each rank holds
!> the rows of its own groups, and the couplings of all.
module block_compliance
  use coupling_block, only: dense_block, make_block
  use errors, only: error_type
  use kinds, only: rk, long
  use learned_response, only: response_memory
  use point_groups, only: group_list
  use ranks, only: add_over_ranks
  implicit none
  private
  public :: compliance_blocks, exact_response, few_points, take_blocks, own_size

  !> One thread inverts the dense matrices of so few points in some milliseconds. Threads of LAPACK
  !> would change the last digits of their entries.
  integer, parameter :: few_points = 200

  !> The whole compliance as an operator, for blocks that leave too much of it out.
  type, abstract :: exact_response
    type(error_type), allocatable :: failure !< of a product; products are zero from then on
  contains
    procedure(respond), deferred :: respond
  end type exact_response

  abstract interface
    !> y = G x.
    subroutine respond(self, x, y)
      import :: exact_response, rk
      implicit none
      class(exact_response), intent(inout) :: self
      real(rk), intent(in) :: x(:) !< (rows) [N]
      real(rk), intent(out) :: y(:) !< (rows) [m]
    end subroutine respond
  end interface

  type :: compliance_blocks
    type(group_list) :: groups
    !> (groups with jumps, groups with forces). Where one of (j, k) and (k, j) is not there, it is
    !> the other one transposed: each block between groups is read for both directions.
    type(dense_block), allocatable :: block(:, :)
    !> Largest coupling that is left out, in blocks or in their accuracy; huge if it is not known
    real(rk) :: left_out = 0.0_rk
    type(response_memory) :: learned !< of what is left out
    class(exact_response), pointer :: exact => null() !< in the place of products with the blocks
  contains
    procedure :: start, put, put_coupling, has_block, add_block, product, couple, learn, has_more
    procedure :: num_entries, as_dense
  end type compliance_blocks

contains

  !> Starts without blocks.
  subroutine start(self, groups)
    class(compliance_blocks), intent(inout) :: self
    type(group_list), intent(in) :: groups
    self%groups = groups
    self%left_out = huge(1.0_rk)
    call self%learned%forget()
    if (allocated(self%block)) deallocate (self%block)
    allocate (self%block(groups%num_groups, groups%num_groups))
  end subroutine start

  !> Puts a block if groups are coupled by it.
  subroutine put_coupling(self, j, k, scale, values, smallest)
    class(compliance_blocks), intent(inout) :: self
    integer, intent(in) :: j, k !< groups
    real(rk), intent(in) :: scale !< geometric mean of the sizes of both own blocks [m/N]
    real(rk), intent(in) :: values(:, :) !< [m/N]
    real(rk), intent(in) :: smallest !< coupling of a block that is kept
    real(rk) :: size_of_both, coupling
    size_of_both = max(scale, tiny(1.0_rk))
    coupling = norm2(values)/size_of_both
    if (coupling >= smallest) call self%put(j, k, coupling, values, smallest*size_of_both)
  end subroutine put_coupling

  !> Puts a block, which is there for both directions.
  subroutine put(self, j, k, coupling, values, allowed)
    class(compliance_blocks), intent(inout) :: self
    integer, intent(in) :: j, k !< groups
    real(rk), intent(in) :: coupling
    real(rk), intent(in) :: values(:, :) !< [m/N]
    real(rk), intent(in) :: allowed !< norm of the error; 0 for none [m/N]
    call make_block(values, coupling, allowed, self%block(j, k))
    self%block(k, j)%coupling = coupling
  end subroutine put

  !> Takes the blocks that matter from a dense compliance, to the accuracy that matters. A block is
  !> compared with what the structure adds to the springs in the own blocks, spring - G: where
  !> springs are stiff, G is nearly theirs alone.
  subroutine take_blocks(dense, spring, groups, smallest, blocks, place)
    real(rk), intent(in) :: dense(:, :) !< G (rows, rows) [m/N]
    real(rk), intent(in) :: spring(:) !< (rows) compliance of the joints' own springs [m/N]
    type(group_list), intent(in) :: groups
    real(rk), intent(in) :: smallest !< coupling of a block that is kept
    type(compliance_blocks), intent(out) :: blocks
    integer, intent(in), optional :: place(:) !< (rows) of each row in `dense`; else all in order
    real(rk) :: own(groups%num_groups)
    real(rk), allocatable :: values(:, :)
    integer :: where_is(size(spring)), j, k
    where_is = [(j, j=1, size(spring))]
    if (present(place)) where_is = place
    call blocks%start(groups)
    do j = 1, groups%num_groups
      values = dense(where_is(groups%rows(j)), where_is(groups%rows(j)))
      own(j) = own_size(values, spring(groups%rows(j)))
      call blocks%put(j, j, 1.0_rk, values, 0.0_rk)
    end do
    !$omp parallel do schedule(dynamic) default(none) if (groups%num_groups > 1) &
    !$omp shared(dense, where_is, groups, smallest, own, blocks)
    do j = 2, groups%num_groups
      call take_row(dense, where_is, groups, j, smallest, own, blocks)
    end do
    !$omp end parallel do
    blocks%left_out = 0.0_rk
    do j = 1, groups%num_groups
      do k = 1, j
        if (.not. allocated(blocks%block(j, k)%values)) blocks%left_out = smallest
      end do
    end do
  end subroutine take_blocks

  !> Takes the blocks of a group with those before it.
  subroutine take_row(dense, place, groups, j, smallest, own, blocks)
    real(rk), intent(in) :: dense(:, :) !< G (rows, rows) [m/N]
    integer, intent(in) :: place(:) !< (rows) of each row in `dense`
    type(group_list), intent(in) :: groups
    integer, intent(in) :: j !< the group
    real(rk), intent(in) :: smallest !< coupling of a block that is kept
    real(rk), intent(in) :: own(:) !< (groups) sizes of the own blocks [m/N]
    type(compliance_blocks), intent(inout) :: blocks
    real(rk), allocatable :: values(:, :)
    integer :: k
    do k = 1, j - 1
      values = dense(place(groups%rows(j)), place(groups%rows(k)))
      call blocks%put_coupling(j, k, sqrt(own(j))*sqrt(own(k)), values, smallest)
    end do
  end subroutine take_row

  !> Norm of spring - G.
  pure real(rk) function own_size(block, spring)
    real(rk), intent(in) :: block(:, :), spring(:) ! [m/N]
    real(rk) :: rest(size(spring), size(spring))
    integer :: i
    rest = block
    do i = 1, size(spring)
      rest(i, i) = rest(i, i) - spring(i)
    end do
    own_size = norm2(rest)
  end function own_size

  !> Whether there is a block between two groups.
  pure logical function has_block(self, j, k)
    class(compliance_blocks), intent(in) :: self
    integer, intent(in) :: j, k !< groups
    has_block = self%block(j, k)%is_there() .or. self%block(k, j)%is_there()
  end function has_block

  !> Adds the jumps of group j by forces on group k.
  subroutine add_block(self, j, k, x, y, is_rough)
    class(compliance_blocks), intent(in) :: self
    integer, intent(in) :: j, k !< groups
    real(rk), intent(in), contiguous :: x(:) !< (rows of k) [N]
    real(rk), intent(inout), contiguous :: y(:) !< (rows of j) [m]
    logical, intent(in) :: is_rough !< some digits are enough
    if (self%block(j, k)%is_there()) then
      call self%block(j, k)%add_to(x, y, is_rough)
    else
      call self%block(k, j)%add_transposed_to(x, y, is_rough)
    end if
  end subroutine add_block

  !> y = G x: exactly, or with what is known of the blocks that are left out.
  subroutine product(self, x, y)
    class(compliance_blocks), intent(in) :: self
    real(rk), intent(in) :: x(:) !< (rows) [N]
    real(rk), intent(out) :: y(:) !< (rows) [m]
    if (associated(self%exact)) then
      call self%exact%respond(x, y)
      return
    end if
    call multiply_blocks(self, x, y)
    call self%learned%add_to(x, y)
  end subroutine product

  !> Whether products contain more than the blocks.
  pure logical function has_more(self)
    class(compliance_blocks), intent(in) :: self
    has_more = associated(self%exact) .or. self%learned%num_kept > 0
  end function has_more

  !> Learns from the exact jumps y by forces x what the blocks leave out.
  subroutine learn(self, x, y)
    class(compliance_blocks), intent(inout) :: self
    real(rk), intent(in) :: x(:) !< (rows) [N]
    real(rk), intent(in) :: y(:) !< (rows) [m]
    real(rk) :: known(size(y))
    call multiply_blocks(self, x, known)
    call self%learned%learn(x, y - known)
  end subroutine learn

  !> y = G x with the blocks alone.
  subroutine multiply_blocks(self, x, y)
    class(compliance_blocks), intent(in) :: self
    real(rk), intent(in) :: x(:) !< (rows) [N]
    real(rk), intent(out) :: y(:) !< (rows) [m]
    logical :: all_parts(self%groups%num_groups, self%groups%num_groups)
    all_parts = .true.
    call multiply_some(self, all_parts, .false., x, y)
  end subroutine multiply_blocks

  !> y = G x roughly, with some of the blocks.
  subroutine couple(self, takes_part, x, y)
    class(compliance_blocks), intent(in) :: self
    logical, intent(in) :: takes_part(:, :) !< (groups with jumps, groups with forces)
    real(rk), intent(in) :: x(:) !< (rows) [N]
    real(rk), intent(out) :: y(:) !< (rows) [m]
    call multiply_some(self, takes_part, .true., x, y)
  end subroutine couple

  !> y = G x with some of the blocks. The sums have a fixed order, whatever the number of threads.
  subroutine multiply_some(self, takes_part, is_rough, x, y)
    class(compliance_blocks), intent(in) :: self
    logical, intent(in) :: takes_part(:, :) !< (groups with jumps, groups with forces)
    logical, intent(in) :: is_rough !< some digits are enough
    real(rk), intent(in) :: x(:) !< (rows) [N]
    real(rk), intent(out) :: y(:) !< (rows) [m]
    real(rk) :: sorted_x(size(x)), sorted_y(size(y))
    integer :: j
    sorted_x = x(self%groups%row)
    if (self%groups%is_divided()) sorted_y = 0.0_rk
    !$omp parallel do schedule(dynamic) default(none) &
    !$omp shared(self, takes_part, is_rough, sorted_x, sorted_y) &
    !$omp if (self%groups%are_worth_threads())
    do j = 1, self%groups%num_groups
      if (self%groups%is_here(j)) then
        call move_group(self, j, takes_part(j, :), is_rough, sorted_x, sorted_y)
      end if
    end do
    !$omp end parallel do
    if (self%groups%is_divided()) call add_over_ranks(sorted_y)
    y(self%groups%row) = sorted_y
  end subroutine multiply_some

  !> Rows of G x of one group, with some of the blocks; x and y group by group.
  subroutine move_group(self, group, takes_part, is_rough, x, y)
    class(compliance_blocks), intent(in) :: self
    integer, intent(in) :: group
    logical, intent(in) :: takes_part(:) !< (groups with forces)
    logical, intent(in) :: is_rough !< some digits are enough
    real(rk), intent(in) :: x(:) !< (rows) [N]
    real(rk), intent(inout) :: y(:) !< (rows) [m]
    integer :: k
    associate (first => self%groups%first_row)
      associate (moved => y(first(group):first(group + 1) - 1))
        moved = 0.0_rk
        do k = 1, self%groups%num_groups
          if (.not. takes_part(k)) cycle
          call self%add_block(group, k, x(first(k):first(k + 1) - 1), moved, is_rough)
        end do
      end associate
    end associate
  end subroutine move_group

  !> G with zeros for the blocks that are left out.
  pure function as_dense(self) result(dense)
    class(compliance_blocks), intent(in) :: self
    real(rk), allocatable :: dense(:, :) !< (rows, rows) [m/N]
    integer :: j, k
    allocate (dense(size(self%groups%row), size(self%groups%row)), source=0.0_rk)
    do k = 1, self%groups%num_groups
      do j = 1, self%groups%num_groups
        if (self%block(j, k)%is_there()) then
          dense(self%groups%rows(j), self%groups%rows(k)) = self%block(j, k)%as_values()
        else if (self%block(k, j)%is_there()) then
          dense(self%groups%rows(j), self%groups%rows(k)) = transpose(self%block(k, j)%as_values())
        end if
      end do
    end do
  end function as_dense

  !> Entries of all blocks that are kept.
  pure integer(long) function num_entries(self)
    class(compliance_blocks), intent(in) :: self
    integer :: j, k
    num_entries = 0
    do k = 1, size(self%block, 2)
      do j = 1, size(self%block, 1)
        num_entries = num_entries + self%block(j, k)%num_entries()
      end do
    end do
  end function num_entries
end module block_compliance
