!> A block of the compliance of the joints: jumps of one group of points by forces on another, dense
!> or as a product of two narrow matrices.
!>
!> The product of a block takes the time of reading it. A block of weak coupling is therefore kept
!> in single precision, and once for both directions: A x are the jumps of the first group, A^T x
!> those of the second by forces of the first.
!>
!> Groups that do not touch each other see only what is smooth in each other's forces: a block of
!> some hundred rows has the rank of some ten to any accuracy that counts.
module coupling_block
  use, intrinsic :: iso_fortran_env, only: single => real32
  use dense_products, only: add_single_times_vector, add_times_vector, &
                            add_transposed_single_times, add_transposed_times, &
                            single_times_vector, transposed_single_times_vector, &
                            transposed_times_vector
  use kinds, only: rk, long
  implicit none
  private
  public :: dense_block, make_block, add_product

  type :: dense_block
    real(rk) :: coupling = 0.0_rk !< size, relative to the own blocks of both groups
    !> One of these is allocated, or none where the block is left out [m/N]
    real(rk), allocatable :: values(:, :)
    real(single), allocatable :: rounded(:, :)
    !> (rows, rank) and (columns, rank): the block is left*transpose(right). Beside values it is so
    !> roughly.
    real(single), allocatable :: left(:, :), right(:, :)
    integer :: rough_rank = 0 !< of so many columns it is so roughly
  contains
    procedure :: is_there, add_to, add_transposed_to, as_values, num_entries
    procedure, private :: rank_of_product
  end type dense_block

  !> Columns or rows without forces between others that a product takes along.
  integer, parameter :: longest_gap = 4, longest_gap_of_rows = 12
  !> Blocks of stronger coupling are those of neighbours, whose rank is high.
  real(rk), parameter :: most_coupling = 1.0e-2_rk
  integer, parameter :: few_steps = 8 !< until lengths that were updated are computed again
  !> What rounding to single precision changes of a block, over its norm: measured 2e-8, with two
  !> narrow matrices 3e-8.
  real(rk), parameter :: rounding = 2.0e-8_rk
  !> Error of a rough block, over its norm: equations are solved with it to three digits.
  real(rk), parameter :: rough_error = 1.0e-4_rk
  !> Most entries of the two narrow matrices, over those of the block.
  real(rk), parameter :: most_entries = 0.6_rk

  interface
    subroutine dgemm(form_a, form_b, m, n, k, alpha, a, lda, b, ldb, beta, c, ldc)
      import :: rk
      implicit none
      character, intent(in) :: form_a, form_b
      integer, intent(in) :: m, n, k, lda, ldb, ldc
      real(rk), intent(in) :: alpha, beta, a(lda, k), b(ldb, k)
      real(rk), intent(inout) :: c(ldc, n)
    end subroutine dgemm

    pure function ddot(n, x, incx, y, incy)
      import :: rk
      implicit none
      integer, intent(in) :: n, incx, incy
      real(rk), intent(in) :: x(n), y(n)
      real(rk) :: ddot
    end function ddot
  end interface

contains

  !> A block of given values, narrow where two narrow matrices are smaller and exact to `allowed`.
  subroutine make_block(values, coupling, allowed, block)
    real(rk), intent(in) :: values(:, :) !< [m/N]
    real(rk), intent(in) :: coupling
    real(rk), intent(in) :: allowed !< Frobenius norm of the error; 0 keeps all values [m/N]
    type(dense_block), intent(out) :: block
    real(rk) :: length
    logical :: may_be_rounded, is_narrow
    block%coupling = coupling
    length = norm2(values)
    may_be_rounded = allowed > 0.0_rk .and. rounding*length <= allowed
    is_narrow = .false.
    if (allowed > 0.0_rk) then
      call narrow(values, merge(allowed, 0.0_rk, may_be_rounded .and. coupling < most_coupling), &
                  rough_error*length, block, is_narrow)
    end if
    if (is_narrow) return
    if (may_be_rounded) then
      block%rounded = real(values, single)
    else
      block%values = values
    end if
  end subroutine make_block

  !> Gram-Schmidt's orthogonalisation of the columns, the longest first, until what is left of all
  !> columns is small. Without result where it needs too many.
  !>
  !> What is left of the columns is computed for several steps at once.
  subroutine narrow(values, allowed, rough, block, is_exact)
    real(rk), intent(in) :: values(:, :) !< [m/N]
    real(rk), intent(in) :: allowed !< norm of the error; 0: a rough block is enough [m/N]
    real(rk), intent(in) :: rough !< norm of the error of a rough block [m/N]
    type(dense_block), intent(inout) :: block
    logical, intent(out) :: is_exact !< to `allowed`
    real(rk), allocatable :: rest(:, :), left(:, :), right(:, :)
    real(rk) :: square(size(values, 2)) ! of the lengths of the columns
    integer :: rank, most, done, m, n
    m = size(values, 1)
    n = size(values, 2)
    most = int(most_entries*real(m, rk)*real(n, rk)/real(max(m + n, 1), rk))
    allocate (rest, source=values)
    allocate (left(m, most), right(n, most))
    is_exact = .false.
    done = 0 ! columns of left and right that `rest` is without
    square = squares_of(rest)
    do rank = 0, most
      if (rank - done == few_steps .or. sum(square) <= max(allowed, rough)**2) then
        call take_away(left(:, done + 1:rank), right(:, done + 1:rank), rest, square)
        done = rank
      end if
      if (block%rough_rank == 0 .and. sum(square) <= rough**2) block%rough_rank = rank
      is_exact = allowed > 0.0_rk .and. sum(square) <= allowed**2
      if (is_exact .or. rank == most) exit
      if (block%rough_rank > 0 .and. allowed <= 0.0_rk) exit
      call add_column(rest, square, left(:, done + 1:rank + 1), right(:, done + 1:rank + 1))
      square = square - right(:, rank + 1)**2
    end do
    if (.not. is_exact) rank = block%rough_rank
    if (.not. is_exact .and. rank == 0) return
    block%left = real(left(:, :rank), single)
    block%right = real(right(:, :rank), single)
  end subroutine narrow

  !> rest = rest - left*transpose(right), and the squares of the lengths of its columns.
  subroutine take_away(left, right, rest, square)
    real(rk), intent(in), contiguous :: left(:, :), right(:, :)
    real(rk), intent(inout), contiguous :: rest(:, :)
    real(rk), intent(out) :: square(:)
    integer :: m, n
    m = size(rest, 1)
    n = size(rest, 2)
    if (size(left, 2) > 0) then
      call dgemm('N', 'T', m, n, size(left, 2), -1.0_rk, left, m, right, n, 1.0_rk, rest, m)
    end if
    square = squares_of(rest)
  end subroutine take_away

  !> Squares of the lengths of columns.
  pure function squares_of(columns) result(square)
    real(rk), intent(in), contiguous :: columns(:, :)
    real(rk) :: square(size(columns, 2))
    integer :: j, m
    m = size(columns, 1)
    do j = 1, size(columns, 2)
      square(j) = ddot(m, columns(:, j), 1, columns(:, j), 1)
    end do
  end function squares_of

  !> The last columns of left and right: the direction of the longest column that is left, and how
  !> much of it all columns have. The other columns of left and right are not yet taken from `rest`.
  subroutine add_column(rest, square, left, right)
    real(rk), intent(in), contiguous :: rest(:, :)
    real(rk), intent(in) :: square(:) !< of the lengths of the columns that are left
    real(rk), intent(inout), contiguous :: left(:, :), right(:, :)
    integer :: c, k, r
    r = size(left, 2)
    c = maxloc(square, 1)
    left(:, r) = rest(:, c)
    do k = 1, r - 1
      left(:, r) = left(:, r) - right(c, k)*left(:, k)
    end do
    left(:, r) = left(:, r)/norm2(left(:, r))
    right(:, r) = transposed_times_vector(rest, left(:, r))
    do k = 1, r - 1
      right(:, r) = right(:, r) - dot_product(left(:, k), left(:, r))*right(:, k)
    end do
  end subroutine add_column

  pure logical function is_there(self)
    class(dense_block), intent(in) :: self
    is_there = allocated(self%values) .or. allocated(self%rounded) .or. allocated(self%left)
  end function is_there

  !> y = y + A x, to some digits in the shortest time where that is enough.
  subroutine add_to(self, x, y, is_rough)
    class(dense_block), intent(in) :: self
    real(rk), intent(in), contiguous :: x(:) ! [N]
    real(rk), intent(inout), contiguous :: y(:) ! [m]
    logical, intent(in) :: is_rough
    integer :: rank
    rank = self%rank_of_product(is_rough)
    if (rank > 0) then
      y = y + single_times_vector(self%left(:, :rank), &
                                  transposed_single_times_vector(self%right(:, :rank), x))
    else if (allocated(self%values)) then
      call add_product(self%values, x, .false., y)
    else if (allocated(self%rounded)) then
      call add_rounded(self%rounded, x, .false., y)
    end if
  end subroutine add_to

  !> y = y + A^T x, to some digits in the shortest time where that is enough.
  subroutine add_transposed_to(self, x, y, is_rough)
    class(dense_block), intent(in) :: self
    real(rk), intent(in), contiguous :: x(:) ! [N]
    real(rk), intent(inout), contiguous :: y(:) ! [m]
    logical, intent(in) :: is_rough
    integer :: rank
    rank = self%rank_of_product(is_rough)
    if (rank > 0) then
      y = y + single_times_vector(self%right(:, :rank), &
                                  transposed_single_times_vector(self%left(:, :rank), x))
    else if (allocated(self%values)) then
      call add_product(self%values, x, .true., y)
    else if (allocated(self%rounded)) then
      call add_rounded(self%rounded, x, .true., y)
    end if
  end subroutine add_transposed_to

  !> Columns of the two narrow matrices that a product takes; 0 where it takes all entries.
  pure integer function rank_of_product(self, is_rough) result(rank)
    class(dense_block), intent(in) :: self
    logical, intent(in) :: is_rough
    rank = 0
    if (.not. allocated(self%left)) return
    if (is_rough) then
      rank = self%rough_rank
    else if (.not. (allocated(self%values) .or. allocated(self%rounded))) then
      rank = size(self%left, 2)
    end if
  end function rank_of_product

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
    if (.not. allocated(self%left)) return
    num_entries = num_entries + size(self%left, kind=long) + size(self%right, kind=long)
  end function num_entries

  !> y = y + A x with the columns whose x is not zero, or y = y + A^T x with such rows: most points
  !> of a joint are often closed.
  subroutine add_product(a, x, is_transposed, y)
    real(rk), intent(in), contiguous :: a(:, :)
    real(rk), intent(in), contiguous :: x(:)
    logical, intent(in) :: is_transposed
    real(rk), intent(inout), contiguous :: y(:)
    integer :: first, last
    last = 0
    do
      call find_forces(x, merge(longest_gap_of_rows, longest_gap, is_transposed), last, first)
      if (first > last) exit
      if (is_transposed) then
        call add_transposed_times(size(a, 1), a, first, x(first:last), y)
      else
        call add_times_vector(a(:, first:last), x(first:last), y)
      end if
    end do
  end subroutine add_product

  !> The same with A and the sums in single precision.
  subroutine add_rounded(a, x, is_transposed, y)
    real(single), intent(in), contiguous :: a(:, :)
    real(rk), intent(in), contiguous :: x(:)
    logical, intent(in) :: is_transposed
    real(rk), intent(inout), contiguous :: y(:)
    real(single) :: forces(size(x)), sums(size(y))
    integer :: first, last
    forces = real(x, single)
    sums = 0.0_single
    last = 0
    do
      call find_forces(x, merge(longest_gap_of_rows, longest_gap, is_transposed), last, first)
      if (first > last) exit
      if (is_transposed) then
        call add_transposed_single_times(size(a, 1), a, first, forces(first:last), sums)
      else
        call add_single_times_vector(a(:, first:last), forces(first:last), sums)
      end if
    end do
    y = y + real(sums, rk)
  end subroutine add_rounded

  !> The next forces that are not zero and have no long gaps between them; none where first > last.
  pure subroutine find_forces(x, longest, last, first)
    real(rk), intent(in) :: x(:)
    integer, intent(in) :: longest !< gap
    integer, intent(inout) :: last !< of the forces before, 0 at the beginning
    integer, intent(out) :: first
    integer :: c
    do first = last + 1, size(x)
      if (abs(x(first)) > 0.0_rk) exit
    end do
    if (first > size(x)) return
    last = first
    do c = first + 1, size(x)
      if (c - last > longest) exit
      if (abs(x(c)) > 0.0_rk) last = c
    end do
  end subroutine find_forces
end module coupling_block
