!> The pattern of all matrices of a step, by columns, free unknowns first.
!>
!> Stiffness, mass and damping share one pattern; each is an array of values. Symmetric matrices
!> keep the lower triangle; an unsymmetric tangent has a separate full pattern.
module matrix_pattern
  use kinds, only: rk
  use symmetric_product, only: keyway_multiply_one
  use unknown_layout, only: row_layout
  use unknown_parts, only: unknown_part
  implicit none
  private
  public :: pattern, position_of, add_block, add_triples, multiply, diagonal, full_pattern
  public :: spread_values, drop_zeros, add_thin

  type :: pattern
    integer :: num_free = 0 !< free unknowns come first
    integer :: num_total = 0 !< free and prescribed
    integer :: num_last = 0 !< last of the free ones, also last in a factor
    !> (num_free) group of unknowns that are eliminated together, 0 for none; not allocated: the
    !> last unknowns are a group at the end
    integer, allocatable :: group(:)
    !> Pairs of unknowns: a jump, and a displacement that it adds to; allocated with `group`
    integer, allocatable :: jump(:), joined(:)
    !> Unknowns of joints are too many for the end of a factor and stand anywhere: none is last
    logical :: orders_freely = .false.
    logical :: is_symmetric = .true. !< lower triangle only
    integer, allocatable :: column_start(:) !< (num_total + 1), 1-based
    integer, allocatable :: row(:) !< ascending in each column (symmetric: the diagonal first)
    integer, allocatable :: free_entries(:) !< entries of each column in rows <= num_free
    !> Number of columns from each column on with the same rows below them, in a symmetric pattern.
    integer, allocatable :: alike(:)
    logical :: is_shared = .false. !< values are the part of this rank in a sum over all ranks
    type(row_layout), allocatable :: layout !< of the distributed matrix, where one is shared
    type(unknown_part) :: part !< unknowns of this rank, where vectors are divided
  end type pattern

contains

  !> Position of an entry of a column, 0 if the pattern has no such entry.
  pure integer function position_of(matrix, row, column) result(found)
    type(pattern), intent(in) :: matrix
    integer, intent(in) :: row, column !< symmetric: row >= column
    integer :: low, high
    low = matrix%column_start(column)
    high = matrix%column_start(column + 1) - 1
    found = 0
    if (low > high) return
    do while (low < high)
      found = (low + high)/2
      if (matrix%row(found) < row) then
        low = found + 1
      else
        high = found
      end if
    end do
    found = merge(low, 0, matrix%row(low) == row)
  end function position_of

  !> Adds a small dense matrix; the pattern must hold its entries. In a symmetric pattern only the
  !> lower triangle of the block is added.
  pure subroutine add_block(matrix, unknown, block, values)
    type(pattern), intent(in) :: matrix
    integer, intent(in) :: unknown(:) !< ascending, each once
    real(rk), intent(in) :: block(:, :) !< (unknowns, unknowns)
    real(rk), intent(inout) :: values(:)
    integer :: i, j, k, first
    do j = 1, size(unknown)
      first = merge(j, 1, matrix%is_symmetric)
      k = position_of(matrix, unknown(first), unknown(j))
      values(k) = values(k) + block(first, j)
      do i = first + 1, size(unknown)
        ! Unknowns of one node follow each other: try the next entry before searching.
        k = k + 1
        if (matrix%row(k) /= unknown(i)) k = position_of(matrix, unknown(i), unknown(j))
        values(k) = values(k) + block(i, j)
      end do
    end do
  end subroutine add_block

  !> Adds a symmetric matrix of triples of unknowns to a symmetric pattern. The three columns of a
  !> triple are alike, so that one search serves nine entries.
  pure subroutine add_triples(matrix, first, place, block, values)
    type(pattern), intent(in) :: matrix !< symmetric; `alike` is 3 or more at each first unknown
    integer, intent(in) :: first(:) !< first unknown of each triple, ascending
    integer, intent(in) :: place(:) !< of the triple in the block: 1, 2, ...
    real(rk), intent(in) :: block(:, :) !< (3 triples, 3 triples)
    real(rk), intent(inout) :: values(:)
    integer :: a, b, i, j, k(3)
    do b = 1, size(first)
      j = 3*place(b) - 2
      k = matrix%column_start(first(b):first(b) + 2)
      values(k(1):k(1) + 2) = values(k(1):k(1) + 2) + block(j:j + 2, j)
      values(k(2):k(2) + 1) = values(k(2):k(2) + 1) + block(j + 1:j + 2, j + 1)
      values(k(3)) = values(k(3)) + block(j + 2, j + 2)
      do a = b + 1, size(first)
        i = 3*place(a) - 2
        k(1) = next_position(matrix%row, k(1) + 1, matrix%column_start(first(b) + 1) - 1, first(a))
        k(2) = matrix%column_start(first(b) + 1) + k(1) - matrix%column_start(first(b)) - 1
        k(3) = matrix%column_start(first(b) + 2) + k(1) - matrix%column_start(first(b)) - 2
        values(k(1):k(1) + 2) = values(k(1):k(1) + 2) + block(i:i + 2, j)
        values(k(2):k(2) + 2) = values(k(2):k(2) + 2) + block(i:i + 2, j + 1)
        values(k(3):k(3) + 2) = values(k(3):k(3) + 2) + block(i:i + 2, j + 2)
      end do
    end do
  end subroutine add_triples

  !> Position of a row that stands between two positions of a list in ascending order.
  pure integer function next_position(rows, first, last, row) result(low)
    integer, intent(in) :: rows(:)
    integer, intent(in) :: first, last, row
    integer :: high, middle
    low = first
    high = last
    do while (low < high)
      middle = (low + high)/2
      if (rows(middle) < row) then
        low = middle + 1
      else
        high = middle
      end if
    end do
  end function next_position

  !> y = A q over all unknowns, prescribed ones included.
  pure subroutine multiply(matrix, values, q, y)
    type(pattern), intent(in) :: matrix
    real(rk), intent(in) :: values(:)
    real(rk), intent(in) :: q(:) !< (num_total)
    real(rk), intent(out) :: y(:) !< (num_total)
    integer :: j, k
    if (matrix%is_symmetric) then
      call keyway_multiply_one(matrix%num_total, size(values), matrix%column_start, matrix%alike, &
                               matrix%row, values, q, y)
      return
    end if
    y = 0.0_rk
    do j = 1, matrix%num_total
      do k = matrix%column_start(j), matrix%column_start(j + 1) - 1
        y(matrix%row(k)) = y(matrix%row(k)) + values(k)*q(j)
      end do
    end do
  end subroutine multiply

  !> The diagonal.
  pure subroutine diagonal(matrix, values, d)
    type(pattern), intent(in) :: matrix
    real(rk), intent(in) :: values(:)
    real(rk), intent(out) :: d(:) !< (num_total)
    integer :: j
    do j = 1, matrix%num_total
      d(j) = values(position_of(matrix, j, j))
    end do
  end subroutine diagonal

  !> Removes the zeros of a symmetric matrix, for products.
  pure subroutine drop_zeros(matrix, values, thin, thin_values)
    type(pattern), intent(in) :: matrix !< symmetric
    real(rk), intent(in) :: values(:)
    type(pattern), intent(out) :: thin !< with the diagonal
    real(rk), allocatable, intent(out) :: thin_values(:)
    logical :: is_kept(size(values))
    integer :: j
    is_kept = abs(values) > 0.0_rk
    is_kept(matrix%column_start(:matrix%num_total)) = .true.
    thin%num_free = matrix%num_free
    thin%num_total = matrix%num_total
    thin%num_last = matrix%num_last
    thin%is_shared = matrix%is_shared
    thin%part = matrix%part
    thin%row = pack(matrix%row, is_kept)
    thin_values = pack(values, is_kept)
    allocate (thin%column_start(matrix%num_total + 1), source=1)
    allocate (thin%alike(matrix%num_total), source=1)
    do j = 1, matrix%num_total
      associate (column => is_kept(matrix%column_start(j):matrix%column_start(j + 1) - 1))
        thin%column_start(j + 1) = thin%column_start(j) + count(column)
      end associate
    end do
    allocate (thin%free_entries(matrix%num_total), source=0)
    do j = 1, matrix%num_total
      thin%free_entries(j) = count_free(thin, j)
    end do
  end subroutine drop_zeros

  !> Adds a multiple of a matrix without its zeros, as `drop_zeros` makes it.
  pure subroutine add_thin(factor, thin, thin_values, matrix, values)
    real(rk), intent(in) :: factor
    type(pattern), intent(in) :: thin !< its entries are some of `matrix`
    real(rk), intent(in) :: thin_values(:)
    type(pattern), intent(in) :: matrix
    real(rk), intent(inout) :: values(:)
    integer :: j, k, t
    do j = 1, thin%num_total
      k = matrix%column_start(j)
      do t = thin%column_start(j), thin%column_start(j + 1) - 1
        do while (matrix%row(k) < thin%row(t))
          k = k + 1
        end do
        values(k) = values(k) + factor*thin_values(t)
      end do
    end do
  end subroutine add_thin

  !> The full pattern (both triangles) of a symmetric one.
  pure subroutine full_pattern(lower, full)
    type(pattern), intent(in) :: lower !< symmetric
    type(pattern), intent(out) :: full
    integer :: j, k, i
    integer, allocatable :: next(:)
    full%num_free = lower%num_free
    full%num_total = lower%num_total
    full%num_last = lower%num_last
    full%is_symmetric = .false.
    full%is_shared = lower%is_shared
    full%part = lower%part
    if (allocated(lower%layout)) full%layout = lower%layout
    allocate (full%column_start(lower%num_total + 1), next(lower%num_total))
    allocate (full%row(2*size(lower%row) - lower%num_total))
    next = lower%column_start(2:) - lower%column_start(:lower%num_total) - 1
    do k = 1, size(lower%row)
      next(lower%row(k)) = next(lower%row(k)) + 1
    end do
    full%column_start(1) = 1
    do j = 1, lower%num_total
      full%column_start(j + 1) = full%column_start(j) + next(j)
    end do
    next = full%column_start(:lower%num_total)
    ! Column j of the lower triangle is row j of the upper one. Columns are passed in ascending
    ! order, so that rows above the diagonal arrive before j's own and all stay ascending.
    do j = 1, lower%num_total
      do k = lower%column_start(j), lower%column_start(j + 1) - 1
        i = lower%row(k)
        full%row(next(j)) = i
        next(j) = next(j) + 1
        if (i == j) cycle
        full%row(next(i)) = j
        next(i) = next(i) + 1
      end do
    end do
    full%free_entries = [(count_free(full, j), j=1, full%num_total)]
  end subroutine full_pattern

  !> Entries of a column in free rows.
  pure integer function count_free(matrix, column)
    type(pattern), intent(in) :: matrix
    integer, intent(in) :: column
    count_free = count(matrix%row(matrix%column_start(column): &
                                  matrix%column_start(column + 1) - 1) <= matrix%num_free)
  end function count_free

  !> Writes the values of a symmetric matrix into the full pattern.
  pure subroutine spread_values(lower, values, full, full_values)
    type(pattern), intent(in) :: lower, full
    real(rk), intent(in) :: values(:)
    real(rk), intent(out) :: full_values(:)
    integer :: i, j, k
    integer, allocatable :: next(:)
    allocate (next, source=full%column_start(:full%num_total))
    do j = 1, lower%num_total
      do k = lower%column_start(j), lower%column_start(j + 1) - 1
        i = lower%row(k)
        full_values(next(j)) = values(k)
        next(j) = next(j) + 1
        if (i == j) cycle
        full_values(next(i)) = values(k)
        next(i) = next(i) + 1
      end do
    end do
  end subroutine spread_values
end module matrix_pattern
