!> A wider pattern for the plan of a factor: unknowns that follow others get their couplings.
!>
!> A jump is coupled with one side of its joint, the displacement that it adds to with both. With
!> the couplings of both sides the factor has places for pairs of jumps of neighbouring joints.
module wider_pattern
  use sorted_lists, only: sorted_unique
  implicit none
  private
  public :: widen_pattern

contains

  !> Adds couplings to the lower triangle of a pattern.
  subroutine widen_pattern(start, used, row, leader, follower, wide_start, wide_row)
    integer, intent(in) :: start(:), used(:) !< (n + 1) first entry, (n) entries of each column
    integer, intent(in) :: row(:) !< counted from 1, the diagonal first
    integer, intent(in) :: leader(:), follower(:) !< (pairs) unknowns
    integer, allocatable, intent(out) :: wide_start(:) !< (n + 1)
    integer, allocatable, intent(out) :: wide_row(:) !< ascending, without gaps
    integer, allocatable :: first(:), item(:), extra_start(:), extra(:), merged(:), last(:)
    integer :: n, j, room
    n = size(used)
    call sort_pairs(n, leader, follower, first, item)
    allocate (extra_start(n + 1), source=0)
    allocate (extra(0))
    call list_couplings(.false.)
    call accumulate(extra_start)
    deallocate (extra)
    allocate (extra(extra_start(n + 1) - 1), last(n))
    last = extra_start(:n)
    call list_couplings(.true.)
    room = sum(used) + size(extra)
    allocate (wide_start(n + 1), wide_row(room))
    wide_start(1) = 1
    do j = 1, n
      associate (own => row(start(j):start(j) + used(j) - 1))
        if (extra_start(j + 1) == extra_start(j)) then
          merged = own
        else
          merged = sorted_unique([own, extra(extra_start(j):extra_start(j + 1) - 1)])
        end if
      end associate
      wide_start(j + 1) = wide_start(j) + size(merged)
      wide_row(wide_start(j):wide_start(j + 1) - 1) = merged
    end do
    wide_row = wide_row(:wide_start(n + 1) - 1)
  contains
    !> Counts or stores the couplings of followers.
    subroutine list_couplings(stores)
      logical, intent(in) :: stores
      integer :: column, k, a, b
      do column = 1, n
        do k = start(column), start(column) + used(column) - 1
          do a = first(row(k)), first(row(k) + 1) - 1
            call add(column, item(a), stores)
            do b = first(column), first(column + 1) - 1
              call add(item(b), item(a), stores)
            end do
          end do
          do b = first(column), first(column + 1) - 1
            call add(row(k), item(b), stores)
          end do
        end do
      end do
    end subroutine list_couplings

    !> One coupling.
    subroutine add(i, k, stores)
      integer, intent(in) :: i, k !< unknowns
      logical, intent(in) :: stores
      associate (column => min(i, k))
        if (stores) then
          extra(last(column)) = max(i, k)
          last(column) = last(column) + 1
        else
          extra_start(column) = extra_start(column) + 1
        end if
      end associate
    end subroutine add
  end subroutine widen_pattern

  !> Followers of each leader.
  pure subroutine sort_pairs(n, leader, follower, first, item)
    integer, intent(in) :: n, leader(:), follower(:)
    integer, allocatable, intent(out) :: first(:) !< (n + 1)
    integer, allocatable, intent(out) :: item(:)
    integer :: k, next(n)
    allocate (first(n + 1), source=0)
    allocate (item(size(leader)))
    do k = 1, size(leader)
      first(leader(k)) = first(leader(k)) + 1
    end do
    call accumulate(first)
    next = first(:n)
    do k = 1, size(leader)
      item(next(leader(k))) = follower(k)
      next(leader(k)) = next(leader(k)) + 1
    end do
  end subroutine sort_pairs

  !> From counts to the first place of each.
  pure subroutine accumulate(counts)
    integer, intent(inout) :: counts(:) !< the last entry is no count
    integer :: k, place, length
    place = 1
    do k = 1, size(counts)
      length = counts(k)
      counts(k) = place
      place = place + length
    end do
  end subroutine accumulate
end module wider_pattern
