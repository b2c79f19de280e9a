!> Lists that grow by doubling: the mean cost of an entry does not depend on the length.
!>
!> A list is an allocatable array of which the first `used` entries are in use. Short lists of
!> derived types (one entry per keyword) are written `list = [list, new]` instead.
module growing_lists
  use kinds, only: rk
  implicit none
  private
  public :: append, make_room

  !> Adds one or several entries after those in use.
  interface append
    module procedure :: append_integer, append_integers, append_real
  end interface append

  !> Lengthens a list so that more entries fit after those in use; allocates a new list.
  interface make_room
    module procedure :: lengthen_integers, lengthen_reals, lengthen_columns
  end interface make_room

  integer, parameter :: fewest = 16 !< entries of a new list

contains

  pure subroutine append_integer(list, used, entry)
    integer, allocatable, intent(inout) :: list(:)
    integer, intent(inout) :: used !< entries in use
    integer, intent(in) :: entry
    call make_room(list, used, 1)
    used = used + 1
    list(used) = entry
  end subroutine append_integer

  pure subroutine append_integers(list, used, entries)
    integer, allocatable, intent(inout) :: list(:)
    integer, intent(inout) :: used !< entries in use
    integer, intent(in) :: entries(:)
    call make_room(list, used, size(entries))
    list(used + 1:used + size(entries)) = entries
    used = used + size(entries)
  end subroutine append_integers

  pure subroutine append_real(list, used, entry)
    real(rk), allocatable, intent(inout) :: list(:)
    integer, intent(inout) :: used !< entries in use
    real(rk), intent(in) :: entry
    call make_room(list, used, 1)
    used = used + 1
    list(used) = entry
  end subroutine append_real

  pure subroutine lengthen_integers(list, used, more)
    integer, allocatable, intent(inout) :: list(:)
    integer, intent(in) :: used !< entries in use
    integer, intent(in) :: more !< entries to come
    integer, allocatable :: longer(:)
    if (.not. allocated(list)) allocate (list(max(fewest, more)))
    if (used + more <= size(list)) return
    allocate (longer(2*(used + more)))
    longer(:used) = list(:used)
    call move_alloc(longer, list)
  end subroutine lengthen_integers

  pure subroutine lengthen_reals(list, used, more)
    real(rk), allocatable, intent(inout) :: list(:)
    integer, intent(in) :: used !< entries in use
    integer, intent(in) :: more !< entries to come
    real(rk), allocatable :: longer(:)
    if (.not. allocated(list)) allocate (list(max(fewest, more)))
    if (used + more <= size(list)) return
    allocate (longer(2*(used + more)))
    longer(:used) = list(:used)
    call move_alloc(longer, list)
  end subroutine lengthen_reals

  !> The same for a table whose columns are the entries; the table must be allocated.
  pure subroutine lengthen_columns(table, used, more)
    real(rk), allocatable, intent(inout) :: table(:, :)
    integer, intent(in) :: used !< columns in use
    integer, intent(in) :: more !< columns to come
    real(rk), allocatable :: longer(:, :)
    if (used + more <= size(table, 2)) return
    allocate (longer(size(table, 1), 2*(used + more)))
    longer(:, :used) = table(:, :used)
    call move_alloc(longer, table)
  end subroutine lengthen_columns
end module growing_lists
