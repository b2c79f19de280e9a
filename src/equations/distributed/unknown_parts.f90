!> The unknowns that a rank holds where vectors are divided among the ranks (large_models.md, 2).
!>
!> A rank holds the unknowns of its elements. At the border of two parts both ranks hold the same
!> unknowns, with the same values; unknowns of joints and other effects are on all ranks. One rank
!> owns an unknown: products and norms count it there.
module unknown_parts
  use kinds, only: rk
  use ranks, only: add_over_ranks, exchange, this_rank
  implicit none
  private
  public :: unknown_part, runs_of

  type :: unknown_part
    logical :: is_divided = .false. !< else a rank has all unknowns, and the rest is not allocated
    integer, allocatable :: run(:, :) !< (2, runs) first and last of consecutive own unknowns
    integer, allocatable :: common(:) !< unknowns that all ranks hold, ascending
    integer, allocatable :: neighbour(:) !< ranks that hold unknowns of this one, ascending
    integer, allocatable :: first(:) !< (neighbours + 1) first unknown of each in `border`
    integer, allocatable :: border(:) !< unknowns, ascending for each neighbour
    integer, allocatable :: shared(:) !< the same, each once
  contains
    procedure :: add, owns, runs_within, of_rows
    procedure, private :: add_list, add_table
    generic :: add_shares => add_list, add_table
    procedure, private :: add_borders
  end type unknown_part

contains

  !> The sum of what the ranks have of a vector, which has the same bits on all ranks that hold an
  !> unknown.
  subroutine add(self, x)
    class(unknown_part), intent(in) :: self
    real(rk), contiguous, intent(inout) :: x(:) !< (num_total, or num_free)
    real(rk), allocatable :: values(:)
    integer :: n
    if (.not. self%is_divided) then
      call add_over_ranks(x)
      return
    end if
    n = count(self%common <= size(x))
    values = x(self%common(:n))
    call add_over_ranks(values)
    x(self%common(:n)) = values
    call self%add_borders(x)
  end subroutine add

  !> The sum of small arrays, of which each rank has the share of its own unknowns.
  subroutine add_list(self, x)
    class(unknown_part), intent(in) :: self
    real(rk), contiguous, intent(inout) :: x(:)
    if (self%is_divided) call add_over_ranks(x)
  end subroutine add_list

  !> The same of a table.
  subroutine add_table(self, x)
    class(unknown_part), intent(in) :: self
    real(rk), contiguous, intent(inout) :: x(:, :)
    if (self%is_divided) call add_over_ranks(x)
  end subroutine add_table

  !> Marks the own ones of the first unknowns.
  pure function owns(self, num_unknowns) result(is_own)
    class(unknown_part), intent(in) :: self
    integer, intent(in) :: num_unknowns
    logical :: is_own(num_unknowns)
    integer :: k
    is_own = .not. self%is_divided
    if (.not. self%is_divided) return
    do k = 1, size(self%run, 2)
      is_own(self%run(1, k):min(self%run(2, k), num_unknowns)) = .true.
    end do
  end function owns

  !> Own entries of a vector: first and last place of each run.
  pure function runs_within(self, length, skipped) result(run)
    class(unknown_part), intent(in) :: self
    integer, intent(in) :: length !< of the vector
    integer, intent(in), optional :: skipped !< unknowns before its first entry
    integer, allocatable :: run(:, :) !< (2, runs)
    logical, allocatable :: is_within(:)
    integer :: before, k
    before = 0
    if (present(skipped)) before = skipped
    allocate (run, source=self%run - before)
    is_within = run(2, :) >= 1 .and. run(1, :) <= length
    run = run(:, pack([(k, k=1, size(is_within))], is_within))
    run(1, :) = max(run(1, :), 1)
    run(2, :) = min(run(2, :), length)
  end function runs_within

  !> Which of some unknowns this rank owns: for products and norms of vectors over these unknowns,
  !> not for `add`.
  pure function of_rows(self, rows) result(part)
    class(unknown_part), intent(in) :: self
    integer, intent(in) :: rows(:) !< unknowns, ascending
    type(unknown_part) :: part
    logical, allocatable :: is_own(:)
    part%is_divided = self%is_divided
    if (.not. part%is_divided) return
    is_own = self%owns(maxval([0, rows]))
    part%run = runs_of(is_own(rows))
  end function of_rows

  !> First and last place of each run of marks.
  pure function runs_of(is_marked) result(run)
    logical, intent(in) :: is_marked(:)
    integer, allocatable :: run(:, :) !< (2, runs)
    logical :: starts(size(is_marked)), ends(size(is_marked))
    integer :: k, n
    n = size(is_marked)
    starts = is_marked
    ends = is_marked
    if (n > 1) then
      starts(2:) = starts(2:) .and. .not. is_marked(:n - 1)
      ends(:n - 1) = ends(:n - 1) .and. .not. is_marked(2:)
    end if
    allocate (run(2, count(starts)))
    run(1, :) = pack([(k, k=1, n)], starts)
    run(2, :) = pack([(k, k=1, n)], ends)
  end function runs_of

  !> The sum at the borders, rank by rank, so that all ranks take the same sum.
  subroutine add_borders(self, x)
    class(unknown_part), intent(in) :: self
    real(rk), intent(inout) :: x(:)
    real(rk), allocatable :: own(:), sent(:), received(:)
    integer :: first(size(self%first)), border(size(self%border)), i, n
    logical :: has_own
    n = 0
    first(1) = 1
    do i = 1, size(self%neighbour)
      associate (list => self%border(self%first(i):self%first(i + 1) - 1))
        first(i + 1) = first(i) + count(list <= size(x))
        border(first(i):first(i + 1) - 1) = list(:first(i + 1) - first(i))
      end associate
    end do
    sent = x(border(:first(size(first)) - 1))
    allocate (received, source=sent)
    call exchange(self%neighbour, first, sent, received)
    associate (shared => self%shared(:count(self%shared <= size(x))))
      own = x(shared)
      x(shared) = 0.0_rk
      has_own = .false.
      do i = 1, size(self%neighbour)
        if (.not. has_own .and. self%neighbour(i) > this_rank()) then
          x(shared) = x(shared) + own
          has_own = .true.
        end if
        do n = first(i), first(i + 1) - 1
          x(border(n)) = x(border(n)) + received(n)
        end do
      end do
      if (.not. has_own) x(shared) = x(shared) + own
    end associate
  end subroutine add_borders
end module unknown_parts
