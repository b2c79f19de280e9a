!> A block of the compliance of the joints: jumps of one group of points by forces on another, dense
!> or as a product of two narrow matrices.
!>
!> The product of a block takes the time of reading it. A block of weak coupling is therefore kept
!> in single precision.
!>
!> Groups that do not touch each other see only what is smooth in each other's forces: a block of
!> some hundred rows has the rank of some ten to any accuracy that counts.
module coupling_block
  use, intrinsic :: iso_fortran_env, only: single => real32
  use dense_products, only: single_times_vector, times_vector, transposed_single_times_vector, &
                            transposed_times_vector
  use kinds, only: rk, long
  implicit none
  private
  public :: dense_block, make_block, transpose_block, add_product

  type :: dense_block
    real(rk) :: coupling = 0.0_rk !< size, relative to the own blocks of both groups
    !> One of these is allocated, or none where the block is left out [m/N]
    real(rk), allocatable :: values(:, :)
    real(single), allocatable :: rounded(:, :)
    !> (rows, rank) and (columns, rank): the block is left*transpose(right)
    real(single), allocatable :: left(:, :), right(:, :)
  contains
    procedure :: is_there, add_to, as_values, num_entries
  end type dense_block

  !> From this share of columns with forces on, a product with the whole block is quicker.
  real(rk), parameter :: most_columns = 0.6_rk
  !> Blocks of stronger coupling are those of neighbours, whose rank is high.
  real(rk), parameter :: most_coupling = 1.0e-2_rk
  integer, parameter :: few_steps = 8 !< until lengths that were updated are computed again
  !> What rounding to single precision changes of a block, over its norm: measured 2e-8, with two
  !> narrow matrices 3e-8.
  real(rk), parameter :: rounding = 2.0e-8_rk
  !> Most entries of the two narrow matrices, over those of the block.
  real(rk), parameter :: most_entries = 0.6_rk

  interface
    subroutine dger(m, n, alpha, x, incx, y, incy, a, lda)
      import :: rk
      implicit none
      integer, intent(in) :: m, n, incx, incy, lda
      real(rk), intent(in) :: alpha, x(m), y(n)
      real(rk), intent(inout) :: a(lda, n)
    end subroutine dger
  end interface

contains

  !> A block of given values, narrow where two narrow matrices are smaller and exact to `allowed`.
  subroutine make_block(values, coupling, allowed, block)
    real(rk), intent(in) :: values(:, :) !< [m/N]
    real(rk), intent(in) :: coupling
    real(rk), intent(in) :: allowed !< Frobenius norm of the error; 0 keeps all values [m/N]
    type(dense_block), intent(out) :: block
    block%coupling = coupling
    if (allowed <= 0.0_rk .or. rounding*norm2(values) > allowed) then
      block%values = values
      return
    end if
    if (coupling < most_coupling) call narrow(values, allowed, block)
    if (.not. allocated(block%left)) block%rounded = real(values, single)
  end subroutine make_block

  !> Gram-Schmidt's orthogonalisation of the columns, the longest first, until what is left of all
  !> columns is small. Without result where it needs too many.
  subroutine narrow(values, allowed, block)
    real(rk), intent(in) :: values(:, :), allowed ! [m/N]
    type(dense_block), intent(inout) :: block
    real(rk), allocatable :: rest(:, :), left(:, :), right(:, :)
    real(rk) :: square(size(values, 2)) ! of the lengths of the columns
    integer :: rank, most, c, m, n
    m = size(values, 1)
    n = size(values, 2)
    most = int(most_entries*real(m, rk)*real(n, rk)/real(max(m + n, 1), rk))
    allocate (rest, source=values)
    allocate (left(m, most), right(n, most))
    do rank = 0, most
      if (mod(rank, few_steps) == 0) square = sum(rest**2, 1)
      if (sum(square) <= allowed**2) square = sum(rest**2, 1)
      if (sum(square) <= allowed**2) exit
      if (rank == most) return
      c = maxloc(square, 1)
      left(:, rank + 1) = rest(:, c)/norm2(rest(:, c))
      right(:, rank + 1) = transposed_times_vector(rest, left(:, rank + 1))
      call dger(m, n, -1.0_rk, left(:, rank + 1), 1, right(:, rank + 1), 1, rest, m)
      square = square - right(:, rank + 1)**2
    end do
    block%left = real(left(:, :rank), single)
    block%right = real(right(:, :rank), single)
  end subroutine narrow

  pure logical function is_there(self)
    class(dense_block), intent(in) :: self
    is_there = allocated(self%values) .or. allocated(self%rounded) .or. allocated(self%left)
  end function is_there

  !> The block of the forces on the first group that move the second.
  pure subroutine transpose_block(block, turned)
    type(dense_block), intent(in) :: block
    type(dense_block), intent(out) :: turned
    turned%coupling = block%coupling
    if (allocated(block%values)) turned%values = transpose(block%values)
    if (allocated(block%rounded)) turned%rounded = transpose(block%rounded)
    if (.not. allocated(block%left)) return
    turned%left = block%right
    turned%right = block%left
  end subroutine transpose_block

  !> y = y + A x.
  subroutine add_to(self, x, y)
    class(dense_block), intent(in) :: self
    real(rk), intent(in), contiguous :: x(:) ! [N]
    real(rk), intent(inout), contiguous :: y(:) ! [m]
    if (allocated(self%values)) then
      call add_product(self%values, x, y)
    else if (allocated(self%rounded)) then
      call add_rounded(self%rounded, x, y)
    else if (allocated(self%left)) then
      y = y + single_times_vector(self%left, transposed_single_times_vector(self%right, x))
    end if
  end subroutine add_to

  pure function as_values(self) result(values)
    class(dense_block), intent(in) :: self
    real(rk), allocatable :: values(:, :) !< [m/N]
    if (allocated(self%values)) then
      values = self%values
    else if (allocated(self%rounded)) then
      values = real(self%rounded, rk)
    else
      values = matmul(real(self%left, rk), transpose(real(self%right, rk)))
    end if
  end function as_values

  pure integer(long) function num_entries(self)
    class(dense_block), intent(in) :: self
    num_entries = 0
    if (allocated(self%values)) num_entries = size(self%values, kind=long)
    if (allocated(self%rounded)) num_entries = size(self%rounded, kind=long)
    if (allocated(self%left)) num_entries = size(self%left, kind=long) + size(self%right, kind=long)
  end function num_entries

  !> y = y + A x with the columns whose x is not zero: most points of a joint are often closed.
  subroutine add_product(a, x, y)
    real(rk), intent(in), contiguous :: a(:, :)
    real(rk), intent(in), contiguous :: x(:)
    real(rk), intent(inout), contiguous :: y(:)
    integer :: column(size(x)), num_columns, c, last
    call list_columns(x, column, num_columns)
    if (num_columns == 0) return
    if (num_columns > most_columns*size(x)) then
      y = y + times_vector(a, x)
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

  !> The same with A in single precision.
  subroutine add_rounded(a, x, y)
    real(single), intent(in), contiguous :: a(:, :)
    real(rk), intent(in) :: x(:)
    real(rk), intent(inout) :: y(:)
    integer :: column(size(x)), num_columns, c
    call list_columns(x, column, num_columns)
    if (num_columns > most_columns*size(x)) then
      y = y + single_times_vector(a, x)
      return
    end if
    do c = 1, num_columns
      y = y + x(column(c))*real(a(:, column(c)), rk)
    end do
  end subroutine add_rounded

  !> Columns that x is not zero for.
  pure subroutine list_columns(x, column, num_columns)
    real(rk), intent(in) :: x(:)
    integer, intent(out) :: column(:)
    integer, intent(out) :: num_columns
    integer :: c
    num_columns = 0
    do c = 1, size(x)
      if (.not. abs(x(c)) > 0.0_rk) cycle
      num_columns = num_columns + 1
      column(num_columns) = c
    end do
  end subroutine list_columns
end module coupling_block
