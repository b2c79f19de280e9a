!> The compliance G = B K_0^-1 B^T of the structure at the points of its joints, in blocks between
!> groups of points (theory.md, 8). Blocks that are too small to matter are left out.
!>
!> Vectors have the rows of all points, in the order of the points.
module block_compliance
  use kinds, only: rk, long
  use point_groups, only: group_list
  implicit none
  private
  public :: compliance_blocks, few_points, take_blocks, add_product, own_size

  !> One thread inverts the dense matrices of so few points in some milliseconds. Threads of LAPACK
  !> would change the last digits of their entries.
  integer, parameter :: few_points = 200

  !> Jumps of one group by forces on another.
  type :: dense_block
    real(rk) :: coupling = 0.0_rk !< size, relative to the own blocks of both groups
    real(rk), allocatable :: values(:, :) !< [m/N]; not allocated where the block is left out
  end type dense_block

  type :: compliance_blocks
    type(group_list) :: groups
    type(dense_block), allocatable :: block(:, :) !< (groups with jumps, groups with forces)
    logical :: is_complete = .true. !< no block is left out
  contains
    procedure :: start, put, product, num_entries, as_dense
  end type compliance_blocks

  !> From this share of columns with forces on, a product with the whole block is quicker.
  real(rk), parameter :: most_columns = 0.6_rk

  interface
    subroutine dgemv(trans, m, n, alpha, a, lda, x, incx, beta, y, incy)
      import :: rk
      implicit none
      character, intent(in) :: trans
      integer, intent(in) :: m, n, lda, incx, incy
      real(rk), intent(in) :: alpha, a(lda, n), x(n), beta
      real(rk), intent(inout) :: y(m)
    end subroutine dgemv
  end interface

contains

  !> Starts without blocks.
  subroutine start(self, groups)
    class(compliance_blocks), intent(inout) :: self
    type(group_list), intent(in) :: groups
    self%groups = groups
    self%is_complete = .false.
    if (allocated(self%block)) deallocate (self%block)
    allocate (self%block(groups%num_groups, groups%num_groups))
  end subroutine start

  !> Puts a block and its transpose.
  subroutine put(self, j, k, coupling, values)
    class(compliance_blocks), intent(inout) :: self
    integer, intent(in) :: j, k !< groups
    real(rk), intent(in) :: coupling
    real(rk), intent(in) :: values(:, :) !< [m/N]
    self%block(j, k)%coupling = coupling
    self%block(j, k)%values = values
    if (j == k) return
    self%block(k, j)%coupling = coupling
    self%block(k, j)%values = transpose(values)
  end subroutine put

  !> Takes the blocks that matter from a dense compliance. A block is compared with what the
  !> structure adds to the springs in the own blocks, spring - G: where springs are stiff, G is
  !> nearly theirs alone.
  subroutine take_blocks(dense, spring, groups, smallest, blocks)
    real(rk), intent(in) :: dense(:, :) !< G (rows, rows) [m/N]
    real(rk), intent(in) :: spring(:) !< (rows) compliance of the joints' own springs [m/N]
    type(group_list), intent(in) :: groups
    real(rk), intent(in) :: smallest !< coupling of a block that is kept
    type(compliance_blocks), intent(out) :: blocks
    real(rk) :: own(groups%num_groups), coupling
    integer :: j, k
    call blocks%start(groups)
    blocks%is_complete = .true.
    do j = 1, groups%num_groups
      associate (rows => rows_of(groups, j))
        own(j) = own_size(dense(rows, rows), spring(rows))
        call blocks%put(j, j, 1.0_rk, dense(rows, rows))
        do k = 1, j - 1
          coupling = norm2(dense(rows, rows_of(groups, k))) &
                     /max(sqrt(own(j))*sqrt(own(k)), tiny(1.0_rk))
          if (coupling >= smallest) then
            call blocks%put(j, k, coupling, dense(rows, rows_of(groups, k)))
          else
            blocks%is_complete = .false.
          end if
        end do
      end associate
    end do
  end subroutine take_blocks

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

  !> Rows of a group.
  pure function rows_of(groups, group) result(rows)
    type(group_list), intent(in) :: groups
    integer, intent(in) :: group
    integer :: rows(groups%first_row(group + 1) - groups%first_row(group))
    rows = groups%row(groups%first_row(group):groups%first_row(group + 1) - 1)
  end function rows_of

  !> y = G x. The sums have a fixed order, whatever the number of threads.
  subroutine product(self, x, y)
    class(compliance_blocks), intent(in) :: self
    real(rk), intent(in) :: x(:) !< (rows) [N]
    real(rk), intent(out) :: y(:) !< (rows) [m]
    real(rk) :: sorted_x(size(x)), sorted_y(size(y))
    integer :: j
    sorted_x = x(self%groups%row)
    !$omp parallel do schedule(dynamic) default(none) shared(self, sorted_x, sorted_y) &
    !$omp if (self%groups%num_groups > 1)
    do j = 1, self%groups%num_groups
      call move_group(self, j, sorted_x, sorted_y)
    end do
    !$omp end parallel do
    y(self%groups%row) = sorted_y
  end subroutine product

  !> Rows of G x of one group; x and y group by group.
  subroutine move_group(self, group, x, y)
    class(compliance_blocks), intent(in) :: self
    integer, intent(in) :: group
    real(rk), intent(in) :: x(:) !< (rows) [N]
    real(rk), intent(inout) :: y(:) !< (rows) [m]
    integer :: k
    associate (first => self%groups%first_row)
      associate (own => y(first(group):first(group + 1) - 1))
        own = 0.0_rk
        do k = 1, self%groups%num_groups
          if (.not. allocated(self%block(group, k)%values)) cycle
          call add_product(self%block(group, k)%values, x(first(k):first(k + 1) - 1), own)
        end do
      end associate
    end associate
  end subroutine move_group

  !> y = y + A x with the columns whose x is not zero: most points of a joint are often closed.
  subroutine add_product(a, x, y)
    real(rk), intent(in), contiguous :: a(:, :)
    real(rk), intent(in), contiguous :: x(:)
    real(rk), intent(inout), contiguous :: y(:)
    integer :: column(size(x)), num_columns, c, last
    num_columns = 0
    do c = 1, size(x)
      if (.not. abs(x(c)) > 0.0_rk) cycle
      num_columns = num_columns + 1
      column(num_columns) = c
    end do
    if (num_columns == 0) return
    if (num_columns > most_columns*size(x)) then
      call dgemv('N', size(a, 1), size(a, 2), 1.0_rk, a, size(a, 1), x, 1, 1.0_rk, y, 1)
      return
    end if
    last = num_columns - mod(num_columns, 4)
    do c = 1, last, 4
      associate (k => column(c:c + 3))
        y = y + (x(k(1))*a(:, k(1)) + x(k(2))*a(:, k(2))) &
            + (x(k(3))*a(:, k(3)) + x(k(4))*a(:, k(4)))
      end associate
    end do
    do c = last + 1, num_columns
      y = y + x(column(c))*a(:, column(c))
    end do
  end subroutine add_product

  !> G with zeros for the blocks that are left out.
  pure function as_dense(self) result(dense)
    class(compliance_blocks), intent(in) :: self
    real(rk), allocatable :: dense(:, :) !< (rows, rows) [m/N]
    integer :: j, k
    allocate (dense(size(self%groups%row), size(self%groups%row)), source=0.0_rk)
    do k = 1, self%groups%num_groups
      do j = 1, self%groups%num_groups
        if (.not. allocated(self%block(j, k)%values)) cycle
        dense(rows_of(self%groups, j), rows_of(self%groups, k)) = self%block(j, k)%values
      end do
    end do
  end function as_dense

  !> Entries of all blocks.
  pure integer(long) function num_entries(self)
    class(compliance_blocks), intent(in) :: self
    integer :: j, k
    num_entries = 0
    do k = 1, size(self%block, 2)
      do j = 1, size(self%block, 1)
        if (.not. allocated(self%block(j, k)%values)) cycle
        num_entries = num_entries + size(self%block(j, k)%values, kind=long)
      end do
    end do
  end function num_entries
end module block_compliance
